! SPDX-License-Identifier: MIT
!> From points to nodal forces.
module contact_scatter_m
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: scatter_points

contains

  !> Add the force of each point to its nodes: pressure*area*normal by the weights, slave side with
  !> plus and master side with minus. Counts the points that carry pressure.
  pure subroutine scatter_points(points, force, n_active)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(inout) :: force(2, *) !! by local node, N/m
    integer, intent(out) :: n_active
    real(wp) :: total, fx, fy
    integer :: p, k, node

    n_active = count(points%pressure(:points%n) > 0.0_wp)
    do p = 1, points%n
      total = points%pressure(p)*points%area(p)
      fx = total*points%normal(1, p)
      fy = total*points%normal(2, p)
      do k = 1, n_side
        node = points%master_nodes(k, p)
        force(1, node) = force(1, node) - points%master_weights(k, p)*fx
        force(2, node) = force(2, node) - points%master_weights(k, p)*fy
        if (.not. abs(points%slave_weights(k, p)) > 0.0_wp) cycle
        node = points%slave_nodes(k, p)
        force(1, node) = force(1, node) + points%slave_weights(k, p)*fx
        force(2, node) = force(2, node) + points%slave_weights(k, p)*fy
      end do
    end do
  end subroutine scatter_points

end module contact_scatter_m
