! SPDX-License-Identifier: MIT
!> The work of the forces of an interface by the trapezoidal rule: half a step by the former forces,
!> half by the present ones, with the velocity between them. That of damping and of friction is kept
!> apart from that of the springs.
module contact_work_m
  use contact_state_m, only : contact_state_t
  use energy_limit_m, only : follow_largest
  use friction_m, only : set_tractions_aside
  use gather_m, only : take_force, power_of, add_force
  use kinds_m, only : wp
  implicit none
  private
  public :: take_apart, hand_over, count_work, count_step

contains

  !> Power of the former forces of damping and of friction, which are zero then; nothing is left of
  !> the tractions but what friction goes on from.
  pure subroutine take_apart(motion, memory, apart)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(out) :: apart(2) !! W/m

    apart = 0.0_wp
    if (allocated(memory%damping_force)) &
      call take_force(memory%nodes, motion, memory%damping_force, apart(1))
    if (.not. allocated(memory%friction%force)) return
    call take_force(memory%nodes, motion, memory%friction%force, apart(2))
    call set_tractions_aside(memory)
  end subroutine take_apart

  !> Add the forces to those of the mesh and count the work of a step: half of it was done by the
  !> former forces.
  pure subroutine hand_over(dt, motion, former, memory, force)
    real(wp), intent(in) :: dt
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: former(2)             !! power of the former damping and friction, W/m
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)
    real(wp) :: power, apart(2)

    call add_force(memory%nodes, memory%scratch%former_force, memory%force, motion, force, power)
    apart = former
    if (allocated(memory%damping_force)) apart(1) = apart(1) &
      + power_of(memory%nodes, motion, memory%damping_force)
    if (allocated(memory%friction%force)) apart(2) = apart(2) &
      + power_of(memory%nodes, motion, memory%friction%force)
    call count_work(dt, power, apart, memory)
    call follow_largest(memory%energy, memory%limit)
  end subroutine hand_over

  !> Work of half a step, that of damping and of friction apart.
  pure subroutine count_work(dt, power, apart, memory)
    real(wp), intent(in) :: dt
    real(wp), intent(in) :: power, apart(2) !! of all contact forces, and of damping and friction
    type(contact_state_t), intent(inout) :: memory

    memory%energy = memory%energy - 0.5_wp*dt*(power - apart(1) - apart(2))
    memory%damping_work = memory%damping_work - 0.5_wp*dt*apart(1)
    memory%friction%work = memory%friction%work - 0.5_wp*dt*apart(2)
  end subroutine count_work

  !> Work of an implicit step.
  pure subroutine count_step(motion, before, after)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) rows 3, 4: displacement
    type(contact_state_t), intent(in) :: before      !! where the step starts
    type(contact_state_t), intent(inout) :: after    !! where it ends
    real(wp) :: work, rubbed

    work = sum((before%force + after%force)*motion(3:4, after%nodes))
    rubbed = 0.0_wp
    if (allocated(after%friction%force)) rubbed = sum((before%friction%force &
      + after%friction%force)*motion(3:4, after%nodes))
    after%energy = before%energy + (after%interference%work - before%interference%work) &
      - 0.5_wp*(work - rubbed)
    after%friction%work = before%friction%work - 0.5_wp*rubbed
  end subroutine count_step

end module contact_work_m
