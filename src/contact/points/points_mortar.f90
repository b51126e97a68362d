! SPDX-License-Identifier: MIT
!> Types 6 and 7, mortar and segmented mortar: Gauss points on each whole slave segment, or two on
!> each overlap of a slave segment with a master segment; pressure from the slave nodes
!> (doc/theory/contact.md, sections 5.6 and 5.7).
module points_mortar_m
  use contact_state_m, only : contact_state_t, contact_points_t, active
  use contacts_m, only : contact_t
  use projection_block_m, only : n_block, project_block, resolve_ambiguous
  use projection_m, only : projection_t, nearby_projection, stays_over
  use geometry_m, only : segment_length, separation
  use kinds_m, only : wp
  use overlap_status_m, only : none_due, search_segments, update_segment_states, &
    note_earliest_search
  use overlaps_m, only : overlap_t, find_overlaps, room_for_overlaps
  use point_list_m, only : point_block_t, append_block, add_point, known_projection, &
    finish_segment_points
  use sharp_vertices_m, only : has_folds, weight_sharp_vertices
  use slave_segments_m, only : closest_candidate, sides_part
  implicit none
  private
  public :: points_mortar, finish_mortar, points_segmented_mortar, finish_segmented_mortar, &
    gauss_xi, least_part

  !> Gauss points of an overlap.
  integer, parameter :: n_gauss = 2
  !> Where they are on 0 .. 1; both have weight one half. They integrate the product of shape
  !> functions and a linear gap exactly up to the curvature of the surface.
  real(wp), parameter :: gauss_xi(n_gauss) = [0.5_wp - sqrt(1.0_wp/12.0_wp), &
    0.5_wp + sqrt(1.0_wp/12.0_wp)]
  !> Part of a slave segment next to its ends where master nodes do not cut it: the points of an
  !> overlap integrate a kink this close to its end to the square of this part, round-off.
  real(wp), parameter :: least_part = 1.0e-6_wp

contains

  !> Type 6: the points of those of a range of slave segments that have a node in common with a
  !> segment in contact: the pressures of these nodes act on them.
  pure subroutine points_mortar(contact, memory, first, last, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first, last
    type(contact_points_t), intent(inout) :: points
    integer :: s, near

    if (memory%slave_status%n_active == 0) return
    do s = first, last
      near = master_near(contact, memory, s)
      if (near > 0) call points_on_whole_segment(contact, memory, s, near, points)
    end do
    call finish_segment_points(memory%positions, contact%is_axisymmetric, 1, points)
  end subroutine points_mortar

  !> Type 6: areas of the points at sharp vertices.
  pure subroutine finish_mortar(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(inout) :: points

    if (memory%slave_status%n_active == 0) return
    if (has_folds(contact)) call weight_sharp_vertices(contact, memory, points)
  end subroutine finish_mortar

  !> A master segment below a point in contact on a slave segment or one next to it, 0: none.
  pure function master_near(contact, memory, s) result(near)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s !! slave segment
    integer :: near
    integer :: segments(3), m, k, i

    near = 0
    m = size(memory%segment_xi)
    segments = [s, contact%slave%previous(s), contact%slave%next(s)]
    do k = 1, 3
      if (segments(k) == 0) cycle
      do i = (segments(k) - 1)*m + 1, segments(k)*m
        if (memory%slave_status%state(i) /= active) cycle
        near = memory%slave_status%segment(i)
        return
      end do
    end do
  end function master_near

  !> The Gauss points of a segment that have a projection and are not let go, with areas as if they
  !> were opposed to the master entirely. Of closed boundaries the side next to a convex vertex
  !> counts less, or not, as with overlaps.
  pure subroutine points_on_whole_segment(contact, memory, s, near, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer, intent(in) :: near !! a master segment close by
    type(contact_points_t), intent(inout) :: points
    type(projection_t) :: projection
    real(wp) :: length, area
    integer :: ends(2), nodes(2), q, i

    ends = contact%slave%segments(:, s)
    length = segment_length(memory%positions(:, ends(1)), memory%positions(:, ends(2)))
    do q = 1, size(memory%segment_xi)
      area = memory%segment_share(q)*length
      if (.not. area > 0.0_wp) cycle
      i = (s - 1)*size(memory%segment_xi) + q
      if (memory%slave_status%state(i) == active) then
        projection = known_projection(memory%slave_status, i)
      else
        projection = find_projection(contact, memory, s, near, memory%segment_points(:, i))
        if (.not. projection%is_on) cycle
      end if
      if (memory%slave_status%pass%is_closed) &
        area = area*sides_part(contact, memory, s, projection%segment)
      nodes = memory%n_slave + contact%master%segments(:, projection%segment)
      call add_point(points, ends, memory%segment_xi(q), nodes, projection, area, &
        memory%slave_penalty)
    end do
  end subroutine points_on_whole_segment

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

  !> Type 7: the points of those of a range of slave segments that may touch.
  pure subroutine points_segmented_mortar(contact, memory, first, last, points, n_released)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: first, last
    type(contact_points_t), intent(inout) :: points
    integer, intent(inout) :: n_released !! first contacts deeper than the limit
    type(overlap_t), allocatable :: overlaps(:)
    type(point_block_t) :: block
    integer :: s

    if (none_due(memory)) return
    allocate (overlaps(room_for_overlaps(memory, first, last)))
    block%n = 0
    call search_segments(contact, first, last, memory)
    do s = first, last
      if (memory%scratch%has_points(s)) &
        call points_on_overlaps(contact, memory, s, overlaps, block, points)
    end do
    call append_projected(contact, memory, block, points)
    call update_segment_states(contact, [first, last], 0, memory, points, n_released)
    call finish_segment_points(memory%positions, contact%is_axisymmetric, 1, points)
  end subroutine points_segmented_mortar

  !> If any of them touches, add the points of its neighbours that can not: these have a part in the
  !> averaged gaps of common nodes.
  pure subroutine finish_segmented_mortar(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(inout) :: points
    integer :: n

    if (none_due(memory)) return
    call note_earliest_search(memory)
    n = points%n
    if (any(memory%segment_state == active) &
      .or. (has_folds(contact) .and. memory%slave_status%n_active > 0)) then
      call points_at_neighbours(contact, memory, points)
      call finish_segment_points(memory%positions, contact%is_axisymmetric, n + 1, points)
    else
      points%n = 0
    end if
    if (has_folds(contact)) call weight_sharp_vertices(contact, memory, points)
  end subroutine finish_segmented_mortar

  !> Neighbours of segments in contact that have no points yet.
  pure subroutine points_at_neighbours(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(inout) :: points
    type(overlap_t), allocatable :: overlaps(:)
    type(point_block_t) :: block
    integer :: neighbours(2), s, k

    block%n = 0
    do s = 1, contact%slave%n_segment
      if (memory%segment_state(s) /= active) cycle
      neighbours = [contact%slave%previous(s), contact%slave%next(s)]
      do k = 1, 2
        if (neighbours(k) == 0) cycle
        if (memory%scratch%has_points(neighbours(k))) cycle
        memory%scratch%has_points(neighbours(k)) = .true.
        if (.not. allocated(overlaps)) &
          allocate (overlaps(room_for_overlaps(memory, 1, contact%slave%n_segment)))
        call points_on_overlaps(contact, memory, neighbours(k), overlaps, block, points)
      end do
    end do
    call append_projected(contact, memory, block, points)
  end subroutine points_at_neighbours

  !> The points of one slave segment, with areas as if they were opposed to the master entirely;
  !> their projections follow once a block of them is full.
  pure subroutine points_on_overlaps(contact, memory, s, overlaps, block, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    type(point_block_t), intent(inout) :: block
    type(contact_points_t), intent(inout) :: points
    real(wp) :: own(2), other(2), way(2), length
    integer :: ends(2), nodes(2), n, k, q, p

    ends = contact%slave%segments(:, s)
    call find_overlaps(contact, memory, s, .false., least_part, overlaps, n)
    own = separation(memory%positions(:, ends(2)), memory%positions(:, ends(1)))
    length = sqrt(own(1)*own(1) + own(2)*own(2))
    do k = 1, n
      if (.not. overlaps(k)%share > 0.0_wp) cycle
      if (block%n + n_gauss > n_block) call append_projected(contact, memory, block, points)
      nodes = memory%n_slave + contact%master%segments(:, overlaps(k)%master)
      other = separation(memory%positions(:, nodes(2)), memory%positions(:, nodes(1)))
      way = separation(memory%positions(:, ends(1)), memory%positions(:, nodes(1)))
      do q = 1, n_gauss
        p = block%n + q
        associate (xi => block%at(p), part => overlaps(k)%high - overlaps(k)%low)
          xi = overlaps(k)%low + gauss_xi(q)*part
          block%area(p) = 0.5_wp*part*length*overlaps(k)%part
          block%ends(:, p) = ends
          block%nodes(:, p) = nodes
          block%segment(p) = overlaps(k)%master
          block%t(:, p) = other
          block%d(:, p) = way + xi*own
        end associate
      end do
      block%n = block%n + n_gauss
    end do
  end subroutine points_on_overlaps

  !> Project the points of a block on the master segments of their overlaps, or on whatever is
  !> closest there, and append them; those without a projection have no area.
  pure subroutine append_projected(contact, memory, block, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(point_block_t), intent(inout) :: block
    type(contact_points_t), intent(inout) :: points

    if (block%n == 0) return
    call project_block(block%projection_block_t)
    if (block%n_ambiguous > 0) call project_ambiguous(contact, memory, block)
    call append_block(block, memory%slave_penalty, points)
  end subroutine append_projected

  !> Points that may be nearer to a neighbour of the master segment.
  pure subroutine project_ambiguous(contact, memory, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(point_block_t), intent(inout) :: block
    type(projection_t) :: projection
    integer :: p

    associate (polyline => memory%positions(:, memory%n_slave + 1:))
      call resolve_ambiguous(contact%master, polyline, block%projection_block_t)
      do p = 1, block%n
        if (.not. block%ambiguous(p) > 0.0_wp) cycle
        if (block%gap(p) >= 0.0_wp) then
          if (stays_over(contact%master, polyline, block%t(:, p), block%d(:, p), &
            block%segment(p))) cycle
        end if
        associate (ends => block%ends(:, p), xi => block%at(p))
          projection = nearby_projection(contact%master, polyline, (1.0_wp - xi) &
            *memory%positions(:, ends(1)) + xi*memory%positions(:, ends(2)), block%segment(p))
        end associate
        block%nodes(:, p) = memory%n_slave + contact%master%segments(:, projection%segment)
        block%xi(p) = projection%xi
        block%gap(p) = projection%gap
        block%normal(:, p) = projection%normal
        if (.not. projection%is_on) block%area(p) = 0.0_wp
      end do
    end associate
  end subroutine project_ambiguous

end module points_mortar_m
