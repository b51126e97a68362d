! SPDX-License-Identifier: MIT
!> What an interface takes from the mesh in each step and gives back to it: places, a bound on relative motion,
!> forces and their power. Sums and extremes are formed in several lanes: one chain of additions
!> through all nodes takes 4 cycles a node.
module contact_motion_m
  use contact_state_m, only : contact_state_t
  use kinds_m, only : wp
  implicit none
  private
  public :: gather_motion, gather_places, take_force, add_force

  !> Chains of sums kept side by side.
  integer, parameter :: n_lane = 4

contains

  !> Take the present motion into the memory, let its travel grow by a bound on how far any two nodes have
  !> moved relative to each other since the last call, find the power of the last forces and forget these.
  pure subroutine gather_motion(motion, memory, power)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(out) :: power !! of the previous forces with the present velocity, W/m

    power = 0.0_wp
    if (memory%n_active > 0) call take_force(memory%nodes, motion, memory%force, power)
    call gather_places(motion, memory)
  end subroutine gather_motion

  !> The same without forces.
  pure subroutine gather_places(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: spread

    call take_places(memory%nodes, motion, memory%places, spread)
    memory%travel = memory%travel + spread
  end subroutine gather_places

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
    force(:, :size(nodes)) = 0.0_wp
    power = sum(lanes)
  end subroutine take_force

  !> Copy u of the nodes; the diagonal of the box of their changes bounds the relative motion.
  pure subroutine take_places(nodes, motion, places, spread)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: places(4, *)
    real(wp), intent(out) :: spread !! m
    real(wp) :: low(2, n_lane), high(2, n_lane), change(2)
    integer :: i, k

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    do i = n_lane, size(nodes), n_lane
      do k = 1, n_lane
        associate (j => i - n_lane + k)
          change = motion(1:2, nodes(j)) - places(3:4, j)
          places(3:4, j) = motion(1:2, nodes(j))
          low(:, k) = merge(change, low(:, k), change < low(:, k))
          high(:, k) = merge(change, high(:, k), change > high(:, k))
        end associate
      end do
    end do
    do i = size(nodes) - modulo(size(nodes), n_lane) + 1, size(nodes)
      change = motion(1:2, nodes(i)) - places(3:4, i)
      places(3:4, i) = motion(1:2, nodes(i))
      low(:, 1) = merge(change, low(:, 1), change < low(:, 1))
      high(:, 1) = merge(change, high(:, 1), change > high(:, 1))
    end do
    do k = 2, n_lane
      low(:, 1) = merge(low(:, k), low(:, 1), low(:, k) < low(:, 1))
      high(:, 1) = merge(high(:, k), high(:, 1), high(:, k) > high(:, 1))
    end do
    spread = sqrt((high(1, 1) - low(1, 1))**2 + (high(2, 1) - low(2, 1))**2)
  end subroutine take_places

  !> Add the forces of the interface to those of the mesh, and their power to `power`.
  pure subroutine add_force(nodes, contact_force, motion, force, power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: contact_force(2, *), motion(4, *)
    real(wp), intent(inout) :: force(2, *)
    real(wp), intent(inout) :: power
    real(wp) :: lanes(n_lane)
    integer :: i, k

    lanes = 0.0_wp
    do i = n_lane, size(nodes), n_lane
      do k = 1, n_lane
        associate (j => i - n_lane + k)
          call add_to_node(contact_force(1, j), motion(1, nodes(j)), force(1, nodes(j)), lanes(k))
        end associate
      end do
    end do
    do i = size(nodes) - modulo(size(nodes), n_lane) + 1, size(nodes)
      call add_to_node(contact_force(1, i), motion(1, nodes(i)), force(1, nodes(i)), lanes(1))
    end do
    power = power + sum(lanes)
  end subroutine add_force

  !> Add the force of one node, and its power.
  pure subroutine add_to_node(contact_force, motion, force, power)
    real(wp), intent(in) :: contact_force(2), motion(4)
    real(wp), intent(inout) :: force(2), power

    force(1) = force(1) + contact_force(1)
    force(2) = force(2) + contact_force(2)
    power = power + (motion(3)*contact_force(1) + motion(4)*contact_force(2))
  end subroutine add_to_node

end module contact_motion_m
