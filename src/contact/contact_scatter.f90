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
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, local nodes) N/m
    integer, intent(out) :: n_active
    real(wp) :: total(2)
    integer :: p, k

    n_active = 0
    do p = 1, points%n
      if (points%pressure(p) > 0.0_wp) n_active = n_active + 1
      total = points%pressure(p)*points%area(p)*points%normal(:, p)
      do k = 1, n_side
        force(:, points%slave_nodes(k, p)) = force(:, points%slave_nodes(k, p)) &
          + points%slave_weights(k, p)*total
        force(:, points%master_nodes(k, p)) = force(:, points%master_nodes(k, p)) &
          - points%master_weights(k, p)*total
      end do
    end do
  end subroutine scatter_points

end module contact_scatter_m
