! SPDX-License-Identifier: MIT
!> What the placements share: points at tracked nodes and competence lengths.
module contact_placing_m
  use contact_state_m, only : contact_points_t, tracking_t
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: add_touching_nodes, competence_length

contains

  !> Append a point for each tracked node in contact; area and stiffness are left to the formulation.
  !> The tracked node stands on the slave side of the record, whichever surface it belongs to.
  pure subroutine add_touching_nodes(tracking, chain_surface, spot_offset, chain_offset, points)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: chain_surface
    integer, intent(in) :: spot_offset, chain_offset !! local number before the first node of each
    type(contact_points_t), intent(inout) :: points
    integer :: k, i, p, segment

    p = points%n
    do k = 1, tracking%n_touching
      i = tracking%touching(k)
      p = p + 1
      segment = tracking%segment(i)
      points%slave_nodes(1, p) = spot_offset + i
      points%slave_nodes(2, p) = spot_offset + i
      points%slave_weights(1, p) = 1.0_wp
      points%slave_weights(2, p) = 0.0_wp
      points%master_nodes(1, p) = chain_offset + chain_surface%segments(1, segment)
      points%master_nodes(2, p) = chain_offset + chain_surface%segments(2, segment)
      points%master_weights(1, p) = 1.0_wp - tracking%xi(i)
      points%master_weights(2, p) = tracking%xi(i)
      points%normal(1, p) = tracking%normal(1, i)
      points%normal(2, p) = tracking%normal(2, i)
      points%gap(p) = tracking%gap(i)
    end do
    points%n = p
  end subroutine add_touching_nodes

  !> Half of the neighbouring segments of a node at their present length, m.
  pure function competence_length(surface, places, i_node) result(length)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    integer, intent(in) :: i_node
    real(wp) :: length

    length = 0.0_wp
    if (surface%incoming(i_node) > 0) length = length + 0.5_wp*segment_length( &
      places(:, surface%segments(1, surface%incoming(i_node))), places(:, i_node))
    if (surface%outgoing(i_node) > 0) length = length + 0.5_wp*segment_length( &
      places(:, i_node), places(:, surface%segments(2, surface%outgoing(i_node))))
  end function competence_length

end module contact_placing_m
