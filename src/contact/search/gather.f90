! SPDX-License-Identifier: MIT
!> What an interface takes from the mesh in each step and gives back to it: positions, a bound on
!> relative motion, forces and their power.
module gather_m
  use contact_state_m, only : contact_state_t
  use kinds_m, only : wp
  implicit none
  private
  public :: gather_positions, take_force, power_of, store_previous, add_force

contains

  !> Take the present displacements into the memory, and what each node has moved, and let its
  !> travel grow by a bound on how far any two nodes have moved relative to each other since the
  !> last call.
  pure subroutine gather_positions(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    associate (n => size(memory%nodes), increment => memory%scratch%increment)
      call take_positions(n, memory%nodes, motion, memory%positions, increment)
      memory%advance = spread_of(n, increment)
      memory%travel = memory%travel + memory%advance
      ! That of a pause is not that of a step.
      if (memory%is_stale) memory%advance = 0.0_wp
    end associate
  end subroutine gather_positions

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
  pure subroutine take_force(nodes, motion, force, power)
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
  end subroutine take_force

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

  !> Copy u of the nodes; what it has changed by.
  pure subroutine take_positions(n, nodes, motion, positions, changes)
    integer, intent(in) :: n, nodes(n)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: positions(4, n), changes(2, n) !! m
    integer :: i

    !GCC$ NOVECTOR
    do i = 1, n
      changes(:, i) = motion(1:2, nodes(i)) - positions(3:4, i)
      positions(3:4, i) = motion(1:2, nodes(i))
    end do
  end subroutine take_positions

  !> The diagonal of the box of these changes bounds the relative motion.
  pure function spread_of(n, changes) result(spread)
    integer, intent(in) :: n
    real(wp), intent(in) :: changes(2, n) !! m
    real(wp) :: spread                   !! m
    real(wp) :: low(2), high(2)
    integer :: i

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    do i = 1, n
      low = merge(changes(:, i), low, changes(:, i) < low)
      high = merge(changes(:, i), high, changes(:, i) > high)
    end do
    spread = sqrt((high(1) - low(1))**2 + (high(2) - low(2))**2)
  end function spread_of

  !> Add the forces of the interface to those of the mesh. Their power and that of the previous
  !> ones, with the same velocity, are formed on the way: v is read once. The previous ones are zero
  !> afterwards: to clear them here costs less than to go through them once more.
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

end module gather_m
