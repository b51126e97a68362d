! SPDX-License-Identifier: MIT
!> The work of the forces of an interface by the trapezoidal rule: half a step by the previous
!> forces, half by the present ones, with the velocity between them. That of damping and of friction
!> is kept apart from that of the springs. The forces are added to those of the mesh on the way.
module contact_work_m
  use contact_state_m, only : contact_state_t
  use energy_limit_m, only : follow_largest
  use friction_m, only : store_previous_tractions
  use law_state_m, only : friction_memory_t
  use kinds_m, only : wp
  implicit none
  private
  public :: previous_work_t, store_previous, store_previous_work, apply_forces, count_step, &
    clear_force, power_of, add_force

  !> Of the previous forces, what is kept apart from the springs.
  type :: previous_work_t
    real(wp) :: ties = 0.0_wp       !! power, W/m
    real(wp) :: damping = 0.0_wp    !! power, W/m
    real(wp) :: friction = 0.0_wp   !! power, W/m
    real(wp) :: dissipated = 0.0_wp !! by friction so far, J/m
  end type previous_work_t

contains

  !> Power of the previous forces of damping and of friction, which are zero then; nothing is left
  !> of the tractions but what friction goes on from.
  pure subroutine store_previous_work(motion, had_force, memory, previous_work)
    real(wp), intent(in), contiguous :: motion(:, :)
    logical, intent(in) :: had_force !! the previous call
    type(contact_state_t), intent(inout) :: memory
    type(previous_work_t), intent(out) :: previous_work

    if (memory%has%ties) &
      previous_work%ties = power_of(memory%nodes, motion, memory%ties%force)
    if (memory%has%damping) &
      call clear_force(memory%nodes, motion, memory%damping_force, previous_work%damping)
    if (.not. memory%has%friction) return
    call clear_force(memory%nodes, motion, memory%friction%force, previous_work%friction)
    previous_work%dissipated = memory%friction%work - memory%friction%stored
    call store_previous_tractions(memory)
    if (.not. had_force) call store_dissipated(previous_work%dissipated, memory%friction)
  end subroutine store_previous_work

  !> Add the forces to those of the mesh and count the work of a step, that of damping and of
  !> friction apart: half of it was done by the previous forces.
  pure subroutine apply_forces(dt, motion, previous, memory, force)
    real(wp), intent(in) :: dt
    real(wp), intent(in), contiguous :: motion(:, :)
    type(previous_work_t), intent(in) :: previous
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)
    real(wp) :: power, damping, friction !! of previous and present forces, W/m

    call add_force(memory%nodes, memory%scratch%previous_force, memory%force, motion, force, power)
    damping = previous%damping
    if (memory%has%damping) damping = damping &
      + power_of(memory%nodes, motion, memory%damping_force)
    friction = previous%friction
    if (memory%has%friction) friction = friction &
      + power_of(memory%nodes, motion, memory%friction%force)
    memory%energy = memory%energy - 0.5_wp*dt*(power - damping - friction)
    if (memory%has%ties) memory%ties%energy = memory%ties%energy - 0.5_wp*dt*(previous%ties &
      + power_of(memory%nodes, motion, memory%ties%force))
    memory%damping_work = memory%damping_work - 0.5_wp*dt*damping
    if (memory%has%friction) then
      memory%friction%work = memory%friction%work - 0.5_wp*dt*friction
      call store_dissipated(previous%dissipated, memory%friction)
    end if
    call follow_largest(memory%energy - memory%ties%energy, memory%limit)
  end subroutine apply_forces

  !> What is dissipated does not come back: tangential springs hold no more than the work that has
  !> been done on them. Where forces are limited or areas change while positions stick, the
  !> tractions alone would say more.
  pure subroutine store_dissipated(dissipated, friction)
    real(wp), intent(in) :: dissipated !! before, J/m
    type(friction_memory_t), intent(inout) :: friction

    friction%stored = min(friction%stored, friction%work - dissipated)
  end subroutine store_dissipated

  !> Work of an implicit step.
  pure subroutine count_step(motion, before, after)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) rows 3, 4: displacement
    type(contact_state_t), intent(in) :: before      !! where the step starts
    type(contact_state_t), intent(inout) :: after    !! where it ends
    real(wp) :: work, friction_work

    work = sum((before%force + after%force)*motion(3:4, after%nodes))
    friction_work = 0.0_wp
    if (after%has%friction) friction_work = sum((before%friction%force &
      + after%friction%force)*motion(3:4, after%nodes))
    after%energy = before%energy + (after%interference%work - before%interference%work) &
      - 0.5_wp*(work - friction_work)
    if (.not. after%has%friction) return
    after%friction%work = before%friction%work - 0.5_wp*friction_work
    call store_dissipated(before%friction%work - before%friction%stored, after%friction)
  end subroutine count_step

  !> Set the forces of the last call aside. Both lists are exchanged: the previous forces are zero
  !> since `add_force` has taken them, or there have been none.
  pure subroutine store_previous(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp), allocatable :: spare(:, :)

    call move_alloc(memory%scratch%previous_force, spare)
    call move_alloc(memory%force, memory%scratch%previous_force)
    call move_alloc(spare, memory%force)
  end subroutine store_previous

  !> Power of nodal forces with the velocities of the nodes; the forces are zero afterwards.
  pure subroutine clear_force(nodes, motion, force, power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: force(2, *)
    real(wp), intent(out) :: power
    integer :: i

    power = power_of(nodes, motion, force)
    do i = 1, size(nodes)
      force(1, i) = 0.0_wp
      force(2, i) = 0.0_wp
    end do
  end subroutine clear_force

  !> The same for forces that stay.
  pure function power_of(nodes, motion, force) result(power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(in) :: force(2, *)
    real(wp) :: power
    integer :: i

    power = 0.0_wp
    do i = 1, size(nodes)
      power = power + (motion(3, nodes(i))*force(1, i) + motion(4, nodes(i))*force(2, i))
    end do
  end function power_of

  !> Add the forces of the interface to those of the mesh. Their power and that of the previous
  !> ones, with the same velocity, are formed on the way: v is read once. The previous ones are zero
  !> afterwards: to clear them here costs less than to go through them once more. By one thread: a
  !> node may be on both surfaces, and an eroded surface may pass through a node twice.
  pure subroutine add_force(nodes, previous, present, motion, force, power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: present(2, *), motion(4, *)
    real(wp), intent(inout) :: previous(2, *), force(2, *)
    real(wp), intent(out) :: power !! of both, W/m
    integer :: i

    power = 0.0_wp
    do i = 1, size(nodes)
      associate (v => motion(3:4, nodes(i)), total => force(:, nodes(i)))
        total(1) = total(1) + present(1, i)
        total(2) = total(2) + present(2, i)
        power = power + (v(1)*(previous(1, i) + present(1, i)) &
          + v(2)*(previous(2, i) + present(2, i)))
      end associate
      previous(1, i) = 0.0_wp
      previous(2, i) = 0.0_wp
    end do
  end subroutine add_force

end module contact_work_m
