! SPDX-License-Identifier: MIT
!> From points to nodal forces.
module contact_scatter_m
  use contact_state_m, only : contact_points_t, contact_state_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: scatter_points, add_gap_round_off

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

  !> What the rounding of places, one part in 1/epsilon of them, makes of the nodal forces of all pressed points: a gap along
  !> n is known to n_x X and n_y Y. Times epsilon it is a force.
  pure subroutine add_gap_round_off(memory, total)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(inout), contiguous :: total(:, :) !! (2, n_node of the mesh) N/m
    real(wp) :: force, normal(2)
    integer :: p, k, node

    associate (points => memory%points)
      do p = 1, points%n
        if (.not. points%pressure(p) > 0.0_wp) cycle
        normal = abs(points%normal(:, p))
        node = points%master_nodes(1, p)
        force = points%stiffness(p)*points%area(p)*dot_product(normal, abs(memory%places(1:2, node)))
        do k = 1, n_side
          node = memory%nodes(points%slave_nodes(k, p))
          total(:, node) = total(:, node) + abs(points%slave_weights(k, p))*force*normal
          node = memory%nodes(points%master_nodes(k, p))
          total(:, node) = total(:, node) + abs(points%master_weights(k, p))*force*normal
        end do
      end do
    end associate
  end subroutine add_gap_round_off

end module contact_scatter_m
