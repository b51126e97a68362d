! SPDX-License-Identifier: MIT
!> What the placements share: points at tracked nodes, points on slave segments, competence lengths.
module contact_placing_m
  use contact_projection_m, only : foot_t
  use contact_state_m, only : contact_points_t, tracking_t, n_side
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: add_touching_nodes, add_segment_point, add_plain_point, &
    tracked_foot, place_on_segment, competence_length, put_competence

  !> Most nodes of a list.
  integer, parameter :: n_room = 64

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

  !> Append a point between the nodes of a slave segment; area and stiffness are left to the formulation.
  pure subroutine add_segment_point(master, n_slave, ends, xi, foot, points)
    type(surface_t), intent(in) :: master
    integer, intent(in) :: n_slave    !! local number before the first master node
    integer, intent(in) :: ends(2)    !! nodes of the slave segment
    real(wp), intent(in) :: xi        !! place on it, 0 to 1
    type(foot_t), intent(in) :: foot  !! segment, xi, gap and normal on the master
    type(contact_points_t), intent(inout) :: points

    points%n = points%n + 1
    associate (p => points%n)
      points%slave_nodes(1, p) = ends(1)
      points%slave_nodes(2, p) = ends(2)
      points%slave_weights(1, p) = 1.0_wp - xi
      points%slave_weights(2, p) = xi
      points%master_nodes(1, p) = n_slave + master%segments(1, foot%segment)
      points%master_nodes(2, p) = n_slave + master%segments(2, foot%segment)
      points%master_weights(1, p) = 1.0_wp - foot%xi
      points%master_weights(2, p) = foot%xi
      points%normal(1, p) = foot%normal(1)
      points%normal(2, p) = foot%normal(2)
      points%gap(p) = foot%gap
    end associate
  end subroutine add_segment_point

  !> The same for a foot of which each part is known.
  pure subroutine add_plain_point(ends, xi, nodes, foot, normal, gap, points)
    integer, intent(in) :: ends(2), nodes(2) !! local numbers of slave and master nodes
    real(wp), intent(in) :: xi, foot         !! place on the slave and on the master segment
    real(wp), intent(in) :: normal(2)
    real(wp), intent(in) :: gap              !! m
    type(contact_points_t), intent(inout) :: points
    integer :: p

    p = points%n + 1
    points%n = p
    points%slave_nodes(1, p) = ends(1)
    points%slave_nodes(2, p) = ends(2)
    points%slave_weights(1, p) = 1.0_wp - xi
    points%slave_weights(2, p) = xi
    points%master_nodes(1, p) = nodes(1)
    points%master_nodes(2, p) = nodes(2)
    points%master_weights(1, p) = 1.0_wp - foot
    points%master_weights(2, p) = foot
    points%normal(1, p) = normal(1)
    points%normal(2, p) = normal(2)
    points%gap(p) = gap
  end subroutine add_plain_point

  !> Foot of a spot in contact as the tracking knows it.
  pure function tracked_foot(tracking, i) result(foot)
    type(tracking_t), intent(in) :: tracking
    integer, intent(in) :: i !! spot
    type(foot_t) :: foot

    foot%segment = tracking%segment(i)
    foot%is_on = .true.
    foot%xi = tracking%xi(i)
    foot%gap = tracking%gap(i)
    foot%normal = tracking%normal(:, i)
  end function tracked_foot

  !> Place at `xi` between two nodes.
  pure function place_on_segment(places, ends, xi) result(place)
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n)
    integer, intent(in) :: ends(2)
    real(wp), intent(in) :: xi
    real(wp) :: place(4)

    place = (1.0_wp - xi)*places(:, ends(1)) + xi*places(:, ends(2))
  end function place_on_segment

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

  !> The same for the tracked nodes of some points, one after the other. A segment between two of them is measured once,
  !> and the roots of a list of segments are formed together: node by node it took three times as long.
  pure subroutine put_competence(surface, places, n, nodes, offset, areas)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    integer, intent(in) :: n
    integer, intent(in) :: nodes(n_side, n)  !! local numbers
    integer, intent(in) :: offset            !! local number before the first node of the surface
    real(wp), intent(inout) :: areas(n)
    integer :: first, m

    do first = 1, n, n_room
      m = min(n_room, n - first + 1)
      call add_halves_of_neighbours(m, nodes(1, first), offset, surface%incoming, surface%outgoing, &
        surface%segments, places, areas(first))
    end do
  end subroutine put_competence

  !> The same for a list of them, on arrays of known shape.
  pure subroutine add_halves_of_neighbours(n, nodes, offset, incoming, outgoing, segments, places, areas)
    integer, intent(in) :: n, nodes(n_side, n), offset
    integer, intent(in) :: incoming(*), outgoing(*), segments(2, *) !! of the surface
    real(wp), intent(in) :: places(4, *)
    real(wp), intent(inout) :: areas(n)
    integer, dimension(n_room) :: before, after !! places on the list of segments
    real(wp) :: vectors(2, 2*n_room), halves(2*n_room)
    integer :: p, k, s, last, n_odd

    k = 0
    last = -1
    do p = 1, n
      s = incoming(nodes(1, p) - offset)
      if (s /= last) then
        k = k + 1
        call take_vector(s, segments, places, vectors(1, k))
      end if
      before(p) = k
      last = outgoing(nodes(1, p) - offset)
      k = k + 1
      call take_vector(last, segments, places, vectors(1, k))
      after(p) = k
    end do
    do s = 1, k
      halves(s) = 0.5_wp*sqrt(vectors(1, s)**2 + vectors(2, s)**2)
    end do
    n_odd = 0
    do p = 1, n
      n_odd = n_odd + abs(before(p) - p) + abs(after(p) - p - 1)
    end do
    if (n_odd == 0) then
      ! One run of nodes: nothing to look up.
      do p = 1, n
        areas(p) = halves(p) + halves(p + 1)
      end do
    else
      do p = 1, n
        areas(p) = halves(before(p)) + halves(after(p))
      end do
    end if
  end subroutine add_halves_of_neighbours

  !> Vector of a segment at its present length, m: zero where there is none.
  pure subroutine take_vector(s, segments, places, vector)
    integer, intent(in) :: s, segments(2, *)
    real(wp), intent(in) :: places(4, *)
    real(wp), intent(inout) :: vector(2)
    real(wp) :: along(4)

    if (s > 0) then
      along = places(:, segments(2, s)) - places(:, segments(1, s))
      vector = along(1:2) + along(3:4)
    else
      vector = 0.0_wp
    end if
  end subroutine take_vector

end module contact_placing_m
