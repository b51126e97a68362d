! SPDX-License-Identifier: MIT
!> Gaps averaged at slave nodes, and what is formed from them there shared out to the points.
module nodal_average_m
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: average_gaps, average_values, average_more, share_out

contains

  !> Averaged gaps of the slave nodes, g_A = sum(N_A a g)/sum(N_A a) (Fischer & Wriggers 2005); 0
  !> where there is no point.
  pure subroutine average_gaps(points, n_slave, nodal)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: n_slave
    real(wp), intent(inout) :: nodal(2, *) !! (2, n_slave or more) out: (1, :) g_A, m

    call average_values(points, points%gap, n_slave, nodal)
  end subroutine average_gaps

  !> The same of any values of points.
  pure subroutine average_values(points, values, n_slave, nodal)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: values(:) !! (points%n or more)
    integer, intent(in) :: n_slave
    real(wp), intent(inout) :: nodal(2, *) !! (2, n_slave or more) out: averages, areas
    integer :: node

    do node = 1, n_slave
      nodal(1, node) = 0.0_wp
      nodal(2, node) = 0.0_wp
    end do
    call sum_values(points%n, points%slave_nodes, points%slave_weights, points%area, values, nodal)
    do node = 1, n_slave
      nodal(1, node) = nodal(1, node)/max(nodal(2, node), tiny(1.0_wp))
    end do
  end subroutine average_values

  !> The same of other values of points, where the areas are known.
  pure subroutine average_more(points, values, n_slave, nodal)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: values(:) !! (points%n or more)
    integer, intent(in) :: n_slave
    real(wp), intent(inout) :: nodal(2, *) !! (2, n_slave or more) out: (1, :); in: (2, :) areas, m
    integer :: node

    do node = 1, n_slave
      nodal(1, node) = 0.0_wp
    end do
    call sum_more(points%n, points%slave_nodes, points%slave_weights, points%area, values, nodal)
    do node = 1, n_slave
      nodal(1, node) = nodal(1, node)/max(nodal(2, node), tiny(1.0_wp))
    end do
  end subroutine average_more

  !> Values of points from those of the slave nodes, by the slave shape functions.
  pure subroutine share_out(n, slave_nodes, slave_weights, at_node, at_point)
    integer, intent(in) :: n, slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), at_node(*)
    real(wp), intent(inout) :: at_point(*)
    integer :: p

    !GCC$ NOVECTOR
    do p = 1, n
      at_point(p) = slave_weights(1, p)*at_node(slave_nodes(1, p)) &
        + slave_weights(2, p)*at_node(slave_nodes(2, p))
    end do
  end subroutine share_out

  !> Sums of weight times area times value, and of weight times area, by slave node. Points of one
  !> segment follow each other and are summed before they are given to the nodes.
  pure subroutine sum_values(n, slave_nodes, slave_weights, area, values, nodal)
    integer, intent(in) :: n, slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), area(*), values(*)
    real(wp), intent(inout) :: nodal(2, *)
    real(wp) :: sum_1, area_1, sum_2, area_2
    integer :: p
    logical :: is_last

    sum_1 = 0.0_wp; area_1 = 0.0_wp; sum_2 = 0.0_wp; area_2 = 0.0_wp
    do p = 1, n
      sum_1 = sum_1 + slave_weights(1, p)*(area(p)*values(p))
      area_1 = area_1 + slave_weights(1, p)*area(p)
      sum_2 = sum_2 + slave_weights(2, p)*(area(p)*values(p))
      area_2 = area_2 + slave_weights(2, p)*area(p)
      is_last = p == n
      if (.not. is_last) is_last = slave_nodes(1, p) /= slave_nodes(1, p + 1) .or. &
        slave_nodes(2, p) /= slave_nodes(2, p + 1)
      if (.not. is_last) cycle
      associate (a => slave_nodes(1, p), b => slave_nodes(2, p))
        nodal(:, a) = nodal(:, a) + [sum_1, area_1]
        nodal(:, b) = nodal(:, b) + [sum_2, area_2]
      end associate
      sum_1 = 0.0_wp; area_1 = 0.0_wp; sum_2 = 0.0_wp; area_2 = 0.0_wp
    end do
  end subroutine sum_values

  !> Sums of weight times area times value alone.
  pure subroutine sum_more(n, slave_nodes, slave_weights, area, values, nodal)
    integer, intent(in) :: n, slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), area(*), values(*)
    real(wp), intent(inout) :: nodal(2, *)
    real(wp) :: sum_1, sum_2
    integer :: p, a, b

    if (n == 0) return
    a = slave_nodes(1, 1); b = slave_nodes(2, 1)
    sum_1 = 0.0_wp; sum_2 = 0.0_wp
    !GCC$ NOVECTOR
    do p = 1, n
      if (slave_nodes(1, p) /= a .or. slave_nodes(2, p) /= b) then
        nodal(1, a) = nodal(1, a) + sum_1
        nodal(1, b) = nodal(1, b) + sum_2
        a = slave_nodes(1, p); b = slave_nodes(2, p)
        sum_1 = 0.0_wp; sum_2 = 0.0_wp
      end if
      sum_1 = sum_1 + slave_weights(1, p)*(area(p)*values(p))
      sum_2 = sum_2 + slave_weights(2, p)*(area(p)*values(p))
    end do
    nodal(1, a) = nodal(1, a) + sum_1
    nodal(1, b) = nodal(1, b) + sum_2
  end subroutine sum_more

end module nodal_average_m
