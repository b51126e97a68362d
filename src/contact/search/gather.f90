! SPDX-License-Identifier: MIT
!> What an interface takes from the mesh in each step and gives back to it: places, a bound on
!> relative motion, forces and their power. Sums and extremes are formed in several lanes: one chain
!> of additions through all nodes takes 4 cycles a node.
module gather_m
  use contact_state_m, only : contact_state_t
  use kinds_m, only : wp
  implicit none
  private
  public :: gather_places, spread_of, take_force, power_of, keep_former, add_force

  !> Chains of sums kept side by side.
  integer, parameter :: n_lane = 4

contains

  !> Take the present displacements into the memory, and what each node has moved, and let its
  !> travel grow by a bound on how far any two nodes have moved relative to each other since the
  !> last call.
  pure subroutine gather_places(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    associate (n => size(memory%nodes), increment => memory%scratch%increment)
      call take_places(n, memory%nodes, motion, memory%places, increment)
      memory%advance = spread_of(n, increment)
      memory%travel = memory%travel + memory%advance
      ! That of a pause is not that of a step.
      if (memory%is_stale) memory%advance = 0.0_wp
    end associate
  end subroutine gather_places

  !> Set the forces of the last call aside. Both lists trade places: the former forces are zero
  !> since `add_force` has taken them, or there have been none.
  pure subroutine keep_former(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp), allocatable :: spare(:, :)

    call move_alloc(memory%scratch%former_force, spare)
    call move_alloc(memory%force, memory%scratch%former_force)
    call move_alloc(spare, memory%force)
  end subroutine keep_former

  !> Power of nodal forces with the velocities of the nodes; the forces are zero afterwards.
  pure subroutine take_force(nodes, motion, force, power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: force(2, *)
    real(wp), intent(out) :: power
    real(wp) :: lanes(n_lane)
    integer :: i, k

    lanes = 0.0_wp
    do i = n_lane, size(nodes), n_lane
      do k = 1, n_lane
        associate (j => i - n_lane + k)
          lanes(k) = lanes(k) + (motion(3, nodes(j))*force(1, j) + motion(4, nodes(j))*force(2, j))
        end associate
      end do
    end do
    do i = size(nodes) - modulo(size(nodes), n_lane) + 1, size(nodes)
      lanes(1) = lanes(1) + (motion(3, nodes(i))*force(1, i) + motion(4, nodes(i))*force(2, i))
    end do
    call clear(2*size(nodes), force)
    power = sum(lanes)
  end subroutine take_force

  !> Both components of all nodes in one loop: column by column it takes twenty times as long.
  pure subroutine clear(n, values)
    integer, intent(in) :: n
    real(wp), intent(inout) :: values(n)

    values = 0.0_wp
  end subroutine clear

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
  pure subroutine take_places(n, nodes, motion, places, changes)
    integer, intent(in) :: n, nodes(n)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: places(4, n), changes(2, n) !! m
    integer :: i

    !GCC$ NOVECTOR
    do i = 1, n
      changes(:, i) = motion(1:2, nodes(i)) - places(3:4, i)
      places(3:4, i) = motion(1:2, nodes(i))
    end do
  end subroutine take_places

  !> The diagonal of the box of these changes bounds the relative motion.
  pure function spread_of(n, changes) result(spread)
    integer, intent(in) :: n
    real(wp), intent(in) :: changes(2*n) !! x and y of each node, m
    real(wp) :: spread                   !! m
    real(wp) :: low(n_lane), high(n_lane), box(2)
    integer :: i, k

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    do i = 0, 2*n - n_lane, n_lane
      !$omp simd
      do k = 1, n_lane
        low(k) = merge(changes(i + k), low(k), changes(i + k) < low(k))
        high(k) = merge(changes(i + k), high(k), changes(i + k) > high(k))
      end do
    end do
    do i = 2*n - modulo(2*n, n_lane) + 1, 2*n
      k = 2 - modulo(i, 2)
      low(k) = merge(changes(i), low(k), changes(i) < low(k))
      high(k) = merge(changes(i), high(k), changes(i) > high(k))
    end do
    box = [maxval(high(1::2)) - minval(low(1::2)), maxval(high(2::2)) - minval(low(2::2))]
    spread = sqrt(box(1)**2 + box(2)**2)
  end function spread_of

  !> Add the forces of the interface to those of the mesh. Their power and that of the former ones,
  !> with the same velocity, are formed on the way: v is read once. The former ones are zero
  !> afterwards: to clear them here costs less than to go through them once more.
  pure subroutine add_force(nodes, former, present, motion, force, power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: present(2, *), motion(4, *)
    real(wp), intent(inout) :: former(2, *), force(2, *)
    real(wp), intent(out) :: power !! of both, W/m
    real(wp) :: lanes(n_lane)
    integer :: i, k

    lanes = 0.0_wp
    do i = n_lane, size(nodes), n_lane
      !GCC$ UNROLL 4
      do k = 1, n_lane
        associate (j => i - n_lane + k)
          call add_to_node(former(1, j), present(1, j), motion(1, nodes(j)), force(1, nodes(j)), &
            lanes(k))
        end associate
      end do
    end do
    do i = size(nodes) - modulo(size(nodes), n_lane) + 1, size(nodes)
      call add_to_node(former(1, i), present(1, i), motion(1, nodes(i)), force(1, nodes(i)), &
        lanes(1))
    end do
    power = sum(lanes)
  end subroutine add_force

  !> Add the force of one node, and its power.
  pure subroutine add_to_node(former, present, motion, force, power)
    real(wp), intent(in) :: present(2), motion(4)
    real(wp), intent(inout) :: former(2), force(2), power
    real(wp) :: total(2)

    total = force + present
    force = total
    power = power + (motion(3)*(former(1) + present(1)) + motion(4)*(former(2) + present(2)))
    former = 0.0_wp
  end subroutine add_to_node

end module gather_m
