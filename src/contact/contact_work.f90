! SPDX-License-Identifier: MIT
!> The work of the forces of an interface by the trapezoidal rule: half a step by the former forces,
!> half by the present ones, with the velocity between them. That of damping and of friction is kept
!> apart from that of the springs.
module contact_work_m
  use contact_state_m, only : contact_state_t
  use energy_limit_m, only : follow_largest
  use friction_m, only : set_tractions_aside
  use law_state_m, only : friction_memory_t
  use gather_m, only : take_force, power_of, add_force
  use kinds_m, only : wp
  implicit none
  private
  public :: apart_t, take_apart, hand_over, count_step

  !> Of the former forces, what is kept apart from the springs.
  type :: apart_t
    real(wp) :: damping = 0.0_wp    !! power, W/m
    real(wp) :: friction = 0.0_wp   !! power, W/m
    real(wp) :: dissipated = 0.0_wp !! by friction so far, J/m
  end type apart_t

contains

  !> Power of the former forces of damping and of friction, which are zero then; nothing is left of
  !> the tractions but what friction goes on from.
  pure subroutine take_apart(motion, had_force, memory, apart)
    real(wp), intent(in), contiguous :: motion(:, :)
    logical, intent(in) :: had_force !! the former call
    type(contact_state_t), intent(inout) :: memory
    type(apart_t), intent(out) :: apart

    if (memory%has%damping) &
      call take_force(memory%nodes, motion, memory%damping_force, apart%damping)
    if (.not. memory%has%friction) return
    call take_force(memory%nodes, motion, memory%friction%force, apart%friction)
    apart%dissipated = memory%friction%work - memory%friction%stored
    call set_tractions_aside(memory)
    if (.not. had_force) call keep_dissipated(apart%dissipated, memory%friction)
  end subroutine take_apart

  !> Add the forces to those of the mesh and count the work of a step, that of damping and of
  !> friction apart: half of it was done by the former forces.
  pure subroutine hand_over(dt, motion, former, memory, force)
    real(wp), intent(in) :: dt
    real(wp), intent(in), contiguous :: motion(:, :)
    type(apart_t), intent(in) :: former
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)
    real(wp) :: power, damping, friction !! of former and present forces, W/m

    call add_force(memory%nodes, memory%scratch%former_force, memory%force, motion, force, power)
    damping = former%damping
    if (memory%has%damping) damping = damping &
      + power_of(memory%nodes, motion, memory%damping_force)
    friction = former%friction
    if (memory%has%friction) friction = friction &
      + power_of(memory%nodes, motion, memory%friction%force)
    memory%energy = memory%energy - 0.5_wp*dt*(power - damping - friction)
    memory%damping_work = memory%damping_work - 0.5_wp*dt*damping
    if (memory%has%friction) then
      memory%friction%work = memory%friction%work - 0.5_wp*dt*friction
      call keep_dissipated(former%dissipated, memory%friction)
    end if
    call follow_largest(memory%energy, memory%limit)
  end subroutine hand_over

  !> What is dissipated does not come back: tangential springs hold no more than the work that has
  !> been done on them. Where forces are limited or areas change while places stick, the tractions
  !> alone would say more.
  pure subroutine keep_dissipated(dissipated, friction)
    real(wp), intent(in) :: dissipated !! before, J/m
    type(friction_memory_t), intent(inout) :: friction

    friction%stored = min(friction%stored, friction%work - dissipated)
  end subroutine keep_dissipated

  !> Work of an implicit step.
  pure subroutine count_step(motion, before, after)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) rows 3, 4: displacement
    type(contact_state_t), intent(in) :: before      !! where the step starts
    type(contact_state_t), intent(inout) :: after    !! where it ends
    real(wp) :: work, rubbed

    work = sum((before%force + after%force)*motion(3:4, after%nodes))
    rubbed = 0.0_wp
    if (after%has%friction) rubbed = sum((before%friction%force &
      + after%friction%force)*motion(3:4, after%nodes))
    after%energy = before%energy + (after%interference%work - before%interference%work) &
      - 0.5_wp*(work - rubbed)
    if (.not. after%has%friction) return
    after%friction%work = before%friction%work - 0.5_wp*rubbed
    call keep_dissipated(before%friction%work - before%friction%stored, after%friction)
  end subroutine count_step

end module contact_work_m
