! SPDX-License-Identifier: MIT
!> Type 6, mortar: Gauss points on each whole slave segment, pressure from the slave nodes
!> (doc/theory/contact.md, section 5.6).
module points_mortar_m
  use contact_state_m, only : contact_state_t, contact_status_t, active
  use contacts_m, only : contact_t
  use projection_m, only : projection_t, nearby_projection
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  use overlaps_m, only : closest_candidate, sides_part
  use point_list_m, only : add_point, finish_segment_points
  use surfaces_m, only : surface_t
  use sharp_vertices_m, only : has_folds, find_sharp_vertices, belongs_to
  implicit none
  private
  public :: points_mortar

contains

  !> Generate the points of all segments that share a node with one in contact: these decide on
  !> nodal pressures.
  pure subroutine points_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: s, near, first

    if (memory%slave_status%n_active == 0) return
    if (has_folds(contact)) call find_sharp_vertices(contact%slave, memory)
    call mark_ends(memory%slave_status, size(memory%segment_xi), contact%slave%segments, &
      memory%scratch%segment_near)
    do s = 1, contact%slave%n_segment
      near = max(memory%scratch%segment_near(contact%slave%segments(1, s)), &
        memory%scratch%segment_near(contact%slave%segments(2, s)))
      if (near == 0) cycle
      first = memory%points%n + 1
      call add_segment(contact, s, near, memory)
      if (has_folds(contact)) call move_to_ends(contact%master, first, memory)
      if (memory%slave_status%pass%is_closed) call weigh_sides(contact, s, first, memory)
    end do
    call finish_segment_points(memory%positions, contact%is_round, 1, memory%points)
    memory%scratch%segment_near = 0
  end subroutine points_mortar

  !> Note at both ends of each segment with a point in contact the master segment of the first of
  !> these points.
  pure subroutine mark_ends(status, m, ends, near)
    type(contact_status_t), intent(in) :: status
    integer, intent(in) :: m          !! points of a segment
    integer, intent(in) :: ends(2, *) !! of the slave
    integer, intent(inout) :: near(*) !! (n_slave)
    integer :: k, s, last

    last = 0
    do k = 1, status%n_active
      if (status%active_points(k) <= last) cycle
      s = 1 + (status%active_points(k) - 1)/m
      last = s*m
      near(ends(1, s)) = status%segment(status%active_points(k))
      near(ends(2, s)) = status%segment(status%active_points(k))
    end do
  end subroutine mark_ends

  !> The Gauss points of a segment, with areas as if it were opposed to the master entirely: below
  !> zero of those that are let go or have no projection.
  pure subroutine add_segment(contact, s, near, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s
    integer, intent(in) :: near !! a master segment close by
    type(contact_state_t), intent(inout) :: memory
    type(projection_t) :: projection
    real(wp) :: length
    integer :: ends(2), nodes(2), q, i

    ends = contact%slave%segments(:, s)
    length = segment_length(memory%positions(:, ends(1)), memory%positions(:, ends(2)))
    do q = 1, size(memory%segment_xi)
      i = (s - 1)*size(memory%segment_xi) + q
      associate (status => memory%slave_status)
        if (status%state(i) == active) then
          projection%segment = status%segment(i)
          projection%is_on = .true.
          projection%xi = status%xi(i)
          projection%gap = status%gap(i)
          projection%normal = status%normal(:, i)
        else
          projection = find_projection(contact, memory, s, near, memory%segment_points(:, i))
        end if
      end associate
      nodes = memory%n_slave + contact%master%segments(:, projection%segment)
      call add_point(memory%points, ends, memory%segment_xi(q), nodes, projection, &
        merge(memory%segment_share(q)*length, -1.0_wp, projection%is_on), memory%slave_penalty)
    end do
  end subroutine add_segment

  !> Projection of a separated point: it stands in front of what it is over, if at all.
  pure function find_projection(contact, memory, s, near, point) result(projection)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s          !! slave segment
    integer, intent(in) :: near       !! master segment to start from where there is no candidate
    real(wp), intent(in) :: point(4)
    type(projection_t) :: projection
    integer :: closest

    closest = closest_candidate(contact, memory, s, point, .false.)
    if (closest == 0) closest = near
    projection = nearby_projection(contact%master, memory%positions(:, memory%n_slave + 1:), &
      point, closest)
    projection%is_on = projection%is_on .and. .not. projection%gap < 0.0_wp
  end function find_projection

  !> At the tip of a fold the points at the nodes of a segment take over what the others are to give
  !> way, as far as they have a projection.
  pure subroutine move_to_ends(surface, first, memory)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: first !! of the points of the segment, the last ones on the list
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: part(2), length
    integer :: k, p

    associate (points => memory%points, ends => memory%points%slave_nodes(:, first))
      part = maxval(memory%scratch%nodal(1, ends))
      if (.not. part(1) > 0.0_wp) return
      do k = 1, 2
        p = merge(first, points%n, k == 1)
        if (points%slave_weights(k, p) < 1.0_wp .or. points%area(p) < 0.0_wp &
          .or. belongs_to(surface, ends(k), surface%outgoing(points%master_nodes(1, p) &
          - memory%n_slave), points%master_weights(2, p))) part(k) = 0.0_wp
      end do
      do p = first, points%n
        points%area(p) = points%area(p)*(1.0_wp - dot_product(part, points%slave_weights(:, p)))
      end do
      length = segment_length(memory%positions(:, ends(1)), memory%positions(:, ends(2)))
      if (part(1) > 0.0_wp) points%area(first) = 0.5_wp*part(1)*length
      if (part(2) > 0.0_wp) points%area(points%n) = 0.5_wp*part(2)*length
    end associate
  end subroutine move_to_ends

  !> Let the points of a segment of closed boundaries count less, or not, with the side next to a
  !> convex vertex, as overlaps do.
  pure subroutine weigh_sides(contact, s, first, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s, first !! slave segment, first of its points, the last ones on the list
    type(contact_state_t), intent(inout) :: memory
    integer :: p

    do p = first, memory%points%n
      if (.not. memory%points%area(p) > 0.0_wp) cycle
      memory%points%area(p) = memory%points%area(p)*sides_part(contact, memory, s, &
        contact%master%outgoing(memory%points%master_nodes(1, p) - memory%n_slave))
    end do
  end subroutine weigh_sides

end module points_mortar_m
