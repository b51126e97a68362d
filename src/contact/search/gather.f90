! SPDX-License-Identifier: MIT
!> What an interface takes from the mesh in each step and gives back to it: positions, a bound on
!> relative motion, forces and their power.
module gather_m
  use contact_state_m, only : contact_state_t
  use kinds_m, only : wp
  use ranges_m, only : n_ranges, first_of, last_of
  implicit none
  private
  public :: gather_positions, take_force, power_of, store_previous, add_force

contains

  !> Take the present displacements into the memory, and what each node has moved, and let its
  !> travel grow by a bound on how far any two nodes have moved relative to each other since the
  !> last call.
  subroutine gather_positions(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    real(wp) :: boxes(4, n_ranges(size(memory%nodes)))
    integer :: i, n

    n = size(memory%nodes)
    if (n_ranges(n) == 1) then
      call gather_range(1, n, memory%nodes, motion, memory%positions, memory%scratch%increment, &
        boxes(:, 1))
    else
      !$omp taskloop default(shared)
      do i = 1, n_ranges(n)
        call gather_range(first_of(i, n), last_of(i, n), memory%nodes, motion, memory%positions, &
          memory%scratch%increment, boxes(:, i))
      end do
      !$omp end taskloop
    end if
    memory%advance = sqrt((maxval(boxes(3, :)) - minval(boxes(1, :)))**2 &
      + (maxval(boxes(4, :)) - minval(boxes(2, :)))**2)
    memory%travel = memory%travel + memory%advance
    ! That of a pause is not that of a step.
    if (memory%is_stale) memory%advance = 0.0_wp
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

  !> Copy u of a range of nodes; what it has changed by, and the box of these changes: the diagonal
  !> of that of all nodes bounds the relative motion.
  pure subroutine gather_range(first, last, nodes, motion, positions, changes, box)
    integer, intent(in) :: first, last, nodes(*)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: positions(4, *), changes(2, *) !! m
    real(wp), intent(out) :: box(4) !! low x, low y, high x, high y, m
    real(wp), dimension(2) :: low, high, change
    integer :: i

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    !GCC$ NOVECTOR
    do i = first, last
      change = motion(1:2, nodes(i)) - positions(3:4, i)
      positions(3:4, i) = motion(1:2, nodes(i))
      changes(:, i) = change
      low = merge(change, low, change < low)
      high = merge(change, high, change > high)
    end do
    box = [low, high]
  end subroutine gather_range

  !> Add the forces of the interface to those of the mesh. Their power and that of the previous
  !> ones, with the same velocity, are formed on the way: v is read once. The previous ones are zero
  !> afterwards: to clear them here costs less than to go through them once more. Both surfaces may
  !> have nodes in common: one follows the other.
  subroutine add_force(n_slave, nodes, previous, present, motion, force, power)
    integer, intent(in) :: n_slave
    integer, intent(in), contiguous :: nodes(:) !! (n_slave + n_master)
    real(wp), intent(in) :: present(2, *), motion(4, *)
    real(wp), intent(inout) :: previous(2, *), force(2, *)
    real(wp), intent(out) :: power !! of both, W/m
    real(wp) :: powers(n_ranges(size(nodes)))
    integer :: i, k, before, n

    power = 0.0_wp
    before = 0
    do k = 1, 2
      n = merge(n_slave, size(nodes) - n_slave, k == 1)
      if (n_ranges(n) == 1) then
        call add_range(before + 1, before + n, nodes, previous, present, motion, force, powers(1))
      else
        !$omp taskloop default(shared)
        do i = 1, n_ranges(n)
          call add_range(before + first_of(i, n), before + last_of(i, n), nodes, previous, &
            present, motion, force, powers(i))
        end do
        !$omp end taskloop
      end if
      power = power + sum(powers(:n_ranges(n)))
      before = n_slave
    end do
  end subroutine add_force

  !> The same for a range of nodes.
  pure subroutine add_range(first, last, nodes, previous, present, motion, force, power)
    integer, intent(in) :: first, last, nodes(*)
    real(wp), intent(in) :: present(2, *), motion(4, *)
    real(wp), intent(inout) :: previous(2, *), force(2, *)
    real(wp), intent(out) :: power
    integer :: i

    power = 0.0_wp
    do i = first, last
      associate (v => motion(3:4, nodes(i)), total => force(:, nodes(i)))
        total(1) = total(1) + present(1, i)
        total(2) = total(2) + present(2, i)
        power = power + (v(1)*(previous(1, i) + present(1, i)) &
          + v(2)*(previous(2, i) + present(2, i)))
      end associate
      previous(1, i) = 0.0_wp
      previous(2, i) = 0.0_wp
    end do
  end subroutine add_range

end module gather_m
