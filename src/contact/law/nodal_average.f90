! SPDX-License-Identifier: MIT
!> Gaps averaged at slave nodes, and what is formed from them there shared out to the points.
module nodal_average_m
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: average_values, share_out

contains

  !> Averages of values of points at the slave nodes, g_A = sum(N_A a g)/sum(N_A a) (Fischer &
  !> Wriggers 2005); 0 where there is no point.
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

  !> Sums of weight times area times value, and of weight times area, by slave node.
  pure subroutine sum_values(n, slave_nodes, slave_weights, area, values, nodal)
    integer, intent(in) :: n, slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), area(*), values(*)
    real(wp), intent(inout) :: nodal(2, *)
    real(wp) :: content(2)
    integer :: p, k

    do p = 1, n
      content = [area(p)*values(p), area(p)]
      do k = 1, n_side
        associate (a => slave_nodes(k, p))
          nodal(:, a) = nodal(:, a) + slave_weights(k, p)*content
        end associate
      end do
    end do
  end subroutine sum_values

end module nodal_average_m
