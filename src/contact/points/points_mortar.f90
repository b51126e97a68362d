! SPDX-License-Identifier: MIT
!> Types 6 and 7, mortar and segmented mortar: Gauss points on each whole slave segment, or two on
!> each overlap of a slave segment with a master segment; pressure from the slave nodes
!> (doc/theory/contact.md, sections 5.6 and 5.7). At a sharp vertex in self contact an average
!> over a slave segment would be open although the vertex has penetrated: there the points of the
!> segment shift their areas to its two nodes (nodal quadrature).
module points_mortar_m
  use contact_state_m, only : contact_state_t, contact_points_t
  use search_state_m, only : active
  use contacts_m, only : contact_t, is_tied
  use projection_block_m, only : n_block, project_block, resolve_ambiguous
  use projection_m, only : projection_t, nearby_projection, stays_over
  use geometry_m, only : segment_length, separation
  use kinds_m, only : wp
  use overlaps_m, only : overlap_t, find_overlaps, room_for_overlaps
  use point_list_m, only : point_block_t, append_block, add_point, known_projection, &
    finish_segment_points
  use slave_segments_m, only : none_due, search_segments, update_segment_states, &
    note_earliest_search, closest_candidate, sides_part
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: points_mortar, finish_mortar, points_segmented_mortar, finish_segmented_mortar, &
    gauss_xi, least_part, resolves_vertices, find_sharp_vertices, belongs_to

  !> Gauss points of an overlap.
  integer, parameter :: n_gauss = 2
  !> Where they are on 0 .. 1; both have weight one half. They integrate the product of shape
  !> functions and a linear gap exactly up to the curvature of the surface.
  real(wp), parameter :: gauss_xi(n_gauss) = [0.5_wp - sqrt(1.0_wp/12.0_wp), &
    0.5_wp + sqrt(1.0_wp/12.0_wp)]
  !> Part of a slave segment next to its ends where master nodes do not cut it: the points of an
  !> overlap integrate a kink this close to its end to the square of this part, round-off.
  real(wp), parameter :: least_part = 1.0e-6_wp
  !> Cosines of the turn at a node up to which averages are kept, and from which on quadrature is
  !> nodal.
  real(wp), parameter :: gentle = 0.99026806874157036_wp, sharp = 0.95105651629515353_wp

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
    if (resolves_vertices(contact)) call weight_sharp_vertices(contact, memory, points)
  end subroutine finish_mortar

  !> A master segment below a point in contact on a slave segment or one next to it, 0: none.
  pure function master_near(contact, memory, s) result(near)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s !! slave segment
    integer :: near
    integer :: segments(3), m, k, i

    near = 0
    m = size(memory%segment_points%xi)
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

  !> The Gauss points of a segment that have a projection and are not excluded, with areas as if
  !> they were opposed to the master entirely. Of closed boundaries the side next to a convex vertex
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
    associate (followed => memory%segment_points, status => memory%slave_status)
      do q = 1, size(followed%xi)
        area = followed%share(q)*length
        if (.not. area > 0.0_wp) cycle
        i = (s - 1)*size(followed%xi) + q
        if (status%state(i) == active) then
          projection = known_projection(status, i)
        else
          projection = find_projection(contact, memory, s, near, followed%positions(:, i))
          if (.not. projection%is_on) cycle
        end if
        if (status%pass%is_closed) &
          area = area*sides_part(contact, memory%positions, s, projection%segment)
        nodes = memory%n_slave + contact%master%segments(:, projection%segment)
        call add_point(points, ends, followed%xi(q), nodes, projection, area, memory%slave_penalty)
      end do
    end associate
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
    allocate (overlaps(room_for_overlaps(memory%candidates, first, last)))
    block%n = 0
    call search_segments(contact, first, last, memory)
    do s = first, last
      if (memory%segments%has_points(s)) &
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
    if (any(memory%segments%state == active) &
      .or. (resolves_vertices(contact) .and. memory%slave_status%n_active > 0)) then
      call points_at_neighbours(contact, memory, points)
      call finish_segment_points(memory%positions, contact%is_axisymmetric, n + 1, points)
    else
      points%n = 0
    end if
    if (resolves_vertices(contact)) call weight_sharp_vertices(contact, memory, points)
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
      if (memory%segments%state(s) /= active) cycle
      neighbours = [contact%slave%previous(s), contact%slave%next(s)]
      do k = 1, 2
        if (neighbours(k) == 0) cycle
        if (memory%segments%has_points(neighbours(k))) cycle
        memory%segments%has_points(neighbours(k)) = .true.
        if (.not. allocated(overlaps)) &
          allocate (overlaps(room_for_overlaps(memory%candidates, 1, contact%slave%n_segment)))
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

  !> Whether sharp vertices have nodal quadrature: in self contact.
  elemental function resolves_vertices(contact)
    type(contact_t), intent(in) :: contact
    logical :: resolves_vertices

    resolves_vertices = contact%is_self .and. .not. is_tied(contact)
  end function resolves_vertices

  !> Let the points of segments at sharp vertices give their areas to their nodes: all points of a
  !> segment follow each other on the list.
  pure subroutine weight_sharp_vertices(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(inout) :: points
    real(wp) :: part
    integer :: first, last, n

    call find_sharp_vertices(contact%slave, memory)
    n = points%n
    last = 0
    do while (last < n)
      first = last + 1
      associate (ends => points%slave_nodes)
        do last = first, n - 1
          if (any(ends(:, last + 1) /= ends(:, first))) exit
        end do
        part = maxval(memory%scratch%nodal(1, ends(:, first)))
      end associate
      if (part > 0.0_wp) call shift_to_nodes(contact, memory, first, last, part, points)
    end do
  end subroutine weight_sharp_vertices

  !> Whether a node of a surface in contact with itself is an end of the segment that it stands
  !> upon, or, where it stands on a node of that, of the next segment there: round-off decides on
  !> which of both a node at a vertex stands.
  pure function belongs_to(surface, node, segment, xi) result(belongs)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: node, segment
    real(wp), intent(in) :: xi !! position on the segment, 0 to 1
    logical :: belongs
    integer :: beside

    belongs = any(surface%segments(:, segment) == node)
    if (abs(xi - 0.5_wp) < 0.5_wp) return
    beside = merge(surface%previous(segment), surface%next(segment), xi < 0.5_wp)
    if (beside > 0) belongs = belongs .or. any(surface%segments(:, beside) == node)
  end function belongs_to

  !> Share of nodal quadrature at each slave node, 0 to 1; kept for the averages. In a trial of an
  !> implicit step that of the start of the step, so that it is no part of the tangent.
  pure subroutine find_sharp_vertices(slave, memory)
    type(surface_t), intent(in) :: slave
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: previous(2, 2), moved(2, 2)
    integer :: node, ends(3), k

    memory%scratch%nodal(1, :memory%n_slave) = 0.0_wp
    do node = 1, memory%n_slave
      if (slave%incoming(node) == 0 .or. slave%outgoing(node) == 0) cycle
      ends = [slave%segments(1, slave%incoming(node)), node, &
        slave%segments(2, slave%outgoing(node))]
      do k = 1, 2
        previous(:, k) = memory%positions(1:2, ends(k + 1)) - memory%positions(1:2, ends(k))
        moved(:, k) = memory%positions(3:4, ends(k + 1)) - memory%positions(3:4, ends(k))
        if (memory%slave_status%pass%is_trial) moved(:, k) = moved(:, k) &
          - (memory%scratch%increment(:, ends(k + 1)) - memory%scratch%increment(:, ends(k)))
      end do
      memory%scratch%nodal(1, node) = sharpness(previous, previous + moved)
    end do
  end subroutine find_sharp_vertices

  !> Share of nodal quadrature at a node, by the segments before and behind it at the start and now:
  !> from the convex turn since the start.
  pure function sharpness(previous, ways) result(part)
    real(wp), intent(in), dimension(2, 2) :: previous, ways !! (x and y, before and behind) m
    real(wp) :: part
    real(wp) :: turn(2), turn_before(2), cosine ! cosine and sine, times lengths

    part = 0.0_wp
    turn = turn_of(ways)
    if (.not. turn(2) > 0.0_wp) return
    turn_before = turn_of(previous)
    if (turn_before(2) > 0.0_wp) turn = turn_of(reshape([turn_before, turn], [2, 2]))
    if (.not. turn(2) > 0.0_wp) return
    cosine = turn(1)/norm2(turn)
    part = min(1.0_wp, max(0.0_wp, (gentle - cosine)/(gentle - sharp)))
    part = part**2*(3.0_wp - 2.0_wp*part)
  end function sharpness

  !> Cosine and sine of the turn from one vector to another, times their lengths.
  pure function turn_of(vectors) result(turn)
    real(wp), intent(in) :: vectors(2, 2)
    real(wp) :: turn(2)

    turn = [dot_product(vectors(:, 1), vectors(:, 2)), &
      vectors(1, 1)*vectors(2, 2) - vectors(2, 1)*vectors(1, 2)]
  end function turn_of

  !> Points at the nodes of a segment take a part of the areas of its points, as these weigh there,
  !> as far as the nodes have a projection.
  pure subroutine shift_to_nodes(contact, memory, first, last, part, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first, last !! points of the segment
    real(wp), intent(in) :: part
    type(contact_points_t), intent(inout) :: points
    type(projection_t) :: projections(2)
    real(wp) :: parts(2), content(2)
    integer :: ends(2), k, p

    ends = points%slave_nodes(:, first)
    do k = 1, 2
      projections(k) = end_projection(contact, memory, points, [first, last], k)
      parts(k) = 0.0_wp
      if (projections(k)%is_on .and. .not. belongs_to(contact%master, ends(k), &
        projections(k)%segment, projections(k)%xi)) parts(k) = part
      content(k) = sum(points%slave_weights(k, first:last)*points%area(first:last))
    end do
    do p = first, last
      points%area(p) = points%area(p)*(1.0_wp - dot_product(parts, points%slave_weights(:, p)))
    end do
    do k = 1, 2
      if (parts(k) > 0.0_wp) call add_point(points, ends, real(k - 1, wp), memory%n_slave &
        + contact%master%segments(:, projections(k)%segment), projections(k), &
        parts(k)*content(k), memory%slave_penalty)
    end do
  end subroutine shift_to_nodes

  !> Projection of the k-th end of a segment: that which is followed, or from the nearest of its
  !> points on.
  pure function end_projection(contact, memory, points, range, k) result(projection)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: range(2) !! of the points of the segment
    integer, intent(in) :: k
    type(projection_t) :: projection
    integer :: node, i, nearest

    node = points%slave_nodes(k, range(1))
    i = node
    ! The first and the last of the points that type 6 follows on a segment are its ends.
    if (memory%has%segment_points) i = merge(1, size(memory%segment_points%xi), k == 1) &
      + size(memory%segment_points%xi)*(contact%slave%outgoing(points%slave_nodes(1, range(1))) - 1)
    if (memory%slave_status%state(i) == active) then
      projection = known_projection(memory%slave_status, i)
    else
      nearest = range(1) - 1 + maxloc(points%slave_weights(k, range(1):range(2)), 1)
      projection = nearby_projection(contact%master, memory%positions(:, memory%n_slave + 1:), &
        memory%positions(:, node), contact%master%outgoing(points%master_nodes(1, nearest) &
        - memory%n_slave))
      ! Excluded points are behind the face.
      if (memory%has%segment_points) &
        projection%is_on = projection%is_on .and. .not. projection%gap < 0.0_wp
    end if
  end function end_projection

end module points_mortar_m
