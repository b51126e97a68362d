! SPDX-License-Identifier: MIT
!> Slave segments over their candidates: which may touch and are in contact where their overlaps
!> make points between the slave nodes; the master segments below their ends; how much of the side
!> next to a convex vertex of a closed boundary counts (doc/theory/contact.md, sections 3.3, 3.5
!> and 4).
module slave_segments_m
  use contact_state_m, only : contact_state_t, contact_points_t
  use search_state_m, only : contact_status_t, separated, active
  use contacts_m, only : contact_t
  use geometry_m, only : local_coordinates_t, closest_distance, separation
  use kinds_m, only : wp
  use projection_m, only : projection_t, closest_projection, side_on, side_share, gentle_vertex, &
    slave_side, master_side, local_coordinates, vector_of, turns_gently
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: none_due, search_segments, update_segment_states, note_earliest_search, &
    slave_segment_t, start_segment, closest_candidate, is_opposed_to_contact, sides_part, near_node

  !> Motion by which two segments turn by a small angle together, as a part of that angle times the
  !> product of their lengths over the sum; a little less, as they may get shorter.
  real(wp), parameter :: way_of_turn = 0.9_wp
  !> Part of a segment within which a projection is on its node.
  real(wp), parameter :: near_node = 1.0e-9_wp

  !> A slave segment. Without default values, which would be written before each use.
  type :: slave_segment_t
    integer :: number
    integer :: ends(2)       !! nodes
    logical :: is_active(2)  !! its ends
    logical :: is_on_face(2) !! active ends whose projections are no nodes
    real(wp) :: margins(2)   !! parts of it next to its ends where master nodes are no breakpoints
    integer :: below(2)      !! master segments that its ends have their projections on, 0: none
    real(wp) :: start(4)     !! position of its first end
    real(wp) :: t(2)         !! its vector, m
    real(wp) :: square       !! of its length, m^2
  end type slave_segment_t

contains

  !> Whether no slave segment can touch yet.
  pure function none_due(memory)
    type(contact_state_t), intent(in) :: memory
    logical :: none_due

    none_due = memory%slave_status%n_active == 0 &
      .and. memory%travel + memory%closed_gap + memory%arcs%highest &
      < memory%segments%earliest_search
  end function none_due

  !> Which of a range of slave segments may touch: an end is active, or the next search time has
  !> come and something is behind the segment or behind what it is opposed to. Else that time is put
  !> off.
  pure subroutine search_segments(contact, first, last, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: first, last
    type(contact_state_t), intent(inout) :: memory !! out: `scratch%has_points` of those
    real(wp) :: travel, distance
    integer :: s

    travel = memory%travel + memory%closed_gap + memory%arcs%highest
    do s = first, last
      associate (state => memory%slave_status%state, ends => contact%slave%segments(:, s), &
        is_due => memory%segments%has_points(s))
        is_due = state(ends(1)) == active .or. state(ends(2)) == active
        if (is_due .or. travel < memory%segments%next_search(s)) cycle
        call search_row(contact, memory, s, distance, is_due)
        is_due = is_due .or. distance < memory%closed_gap + memory%arcs%highest
        memory%segments%next_search(s) = memory%travel + distance
        if (is_due) cycle
        memory%segments%state(s) = separated
        memory%segments%gap(s) = distance
      end associate
    end do
  end subroutine search_segments

  !> Relative motion before which a slave segment can not touch a candidate, m, and whether it lies
  !> behind the line of one that is opposed to it, or that behind its own, in part. Two segments
  !> that do not cross are nearest to each other at a node of one of them; those that are not
  !> opposed have to turn first.
  pure subroutine search_row(contact, memory, s, distance, is_behind)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp), intent(out) :: distance
    logical, intent(out) :: is_behind
    real(wp) :: own(2), other(2), a(2), squares(2), lengths(2), across(4)
    real(wp) :: product, turn, least, square
    integer :: nodes(2), j

    least = memory%slave_status%reach**2
    is_behind = .false.
    associate (positions => memory%positions, ends => contact%slave%segments(:, s))
      own = separation(positions(:, ends(2)), positions(:, ends(1)))
      squares(1) = max(own(1)**2 + own(2)**2, tiny(1.0_wp))
      do j = memory%candidates%first(s), memory%candidates%first(s + 1) - 1
        nodes = memory%n_slave + contact%master%segments(:, memory%candidates%items(j))
        other = separation(positions(:, nodes(2)), positions(:, nodes(1)))
        squares(2) = max(other(1)**2 + other(2)**2, tiny(1.0_wp))
        product = own(1)*other(1) + own(2)*other(2)
        turn = 0.0_wp
        if (product >= 0.0_wp .or. product**2 < side_on**2*squares(1)*squares(2)) then
          lengths = sqrt(squares)
          turn = way_of_turn*(product - side_on*lengths(1)*lengths(2))/sum(lengths)
          if (turn**2 >= least) cycle
        end if
        square = huge(1.0_wp)
        a = separation(positions(:, ends(1)), positions(:, nodes(1)))
        call see_node(a, other, squares(2), square, across(1))
        call see_node(a + own, other, squares(2), square, across(2))
        call see_node(-a, own, squares(1), square, across(3))
        call see_node(other - a, own, squares(1), square, across(4))
        if (max(across(1)*across(2), across(3)*across(4)) <= 0.0_wp) square = 0.0_wp
        least = min(least, max(square, turn**2))
        if (.not. turn > 0.0_wp) is_behind = is_behind .or. minval(across) < 0.0_wp
      end do
    end associate
    distance = sqrt(least)
  end subroutine search_row

  !> A node of one segment seen from another one: which side it is on, and its distance to that.
  pure subroutine see_node(d, t, square, least, across)
    real(wp), intent(in) :: d(2), t(2) !! from the first node of the segment, and its vector, m
    real(wp), intent(in) :: square     !! of its length, m^2
    real(wp), intent(inout) :: least   !! square of the smallest distance so far, m^2
    real(wp), intent(out) :: across    !! gap times length
    real(wp) :: along

    along = d(1)*t(1) + d(2)*t(2)
    across = d(1)*t(2) - d(2)*t(1)
    if (along < 0.0_wp) then
      least = min(least, d(1)**2 + d(2)**2)
    else if (along > square) then
      least = min(least, (d(1) - t(1))**2 + (d(2) - t(2))**2)
    else
      least = min(least, across**2/square)
    end if
  end subroutine see_node

  !> Bring the status of the segments that were due up to date by their points, which follow each
  !> other on the list; those that do not count have no area. Points of a segment neither of whose
  !> ends nor any of whose points is in contact are left to its neighbours, like those of a segment
  !> that is not due: so sums over the points of a node do not depend on which segments are due.
  pure subroutine update_segment_states(contact, range, n_before, memory, points, n_released)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: range(2) !! of slave segments
    integer, intent(in) :: n_before !! points on the list before theirs
    type(contact_state_t), intent(inout) :: memory
    type(contact_points_t), intent(inout) :: points
    integer, intent(inout) :: n_released !! first contacts deeper than the limit
    real(wp) :: deepest, limit, gap
    integer :: first, last, s, p
    logical :: has_active_end

    last = n_before
    do s = range(1), range(2)
      if (.not. memory%segments%has_points(s)) cycle
      associate (ends => contact%slave%segments(:, s))
        first = last + 1
        deepest = huge(1.0_wp)
        p = 0
        do last = first, points%n
          if (points%slave_nodes(1, last) /= ends(1)) exit
          if (.not. points%area(last) > 0.0_wp) cycle
          gap = points%gap(last)
          ! Contact of arcs begins above their segments.
          if (memory%has%arcs) gap = gap - (memory%arcs%height(ends(1)) &
            + memory%arcs%height(points%master_nodes(1, last)))
          if (gap >= deepest) cycle
          deepest = gap
          p = last
        end do
        last = last - 1
        has_active_end = memory%slave_status%state(ends(1)) == active &
          .or. memory%slave_status%state(ends(2)) == active
        limit = huge(1.0_wp)
        if (.not. has_active_end .and. p > 0) &
          limit = deepest_first_contact(memory%slave_status, contact%master, ends, &
            points%master_nodes(:, p) - memory%n_slave)
        call update_segment(memory, s, ends, has_active_end, deepest, limit, n_released)
        if (has_active_end) cycle
        if (.not. deepest < memory%closed_gap) memory%segments%has_points(s) = .false.
        if (memory%segments%state(s) == separated) points%area(first:last) = 0.0_wp
      end associate
    end do
  end subroutine update_segment_states

  !> Status of a slave segment by its deepest point. It is due as long as an end is active or a
  !> point of it is behind a face; else `search_segments` has set the time.
  pure subroutine update_segment(memory, segment, ends, has_active_end, deepest, limit, n_released)
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: segment
    integer, intent(in) :: ends(2)     !! its nodes
    logical, intent(in) :: has_active_end
    real(wp), intent(in) :: deepest    !! smallest gap of its points, m
    real(wp), intent(in) :: limit      !! deepest first contact there, m
    integer, intent(inout) :: n_released

    associate (state => memory%segments%state(segment), next_search => &
      memory%segments%next_search(segment))
      if (.not. deepest < memory%closed_gap) then
        state = separated
        if (has_active_end) next_search = memory%travel
      else
        next_search = -huge(1.0_wp)
        if (has_active_end) then
          state = active
        else if (state == separated) then
          call begin_contact(memory%slave_status, ends, memory%segments%gap(segment), &
            -deepest > limit, state, n_released)
        end if
      end if
    end associate
    memory%segments%gap(segment) = deepest
  end subroutine update_segment

  !> A segment neither end of which is active, behind which points have come: in contact if these
  !> have come through it since the last look, and no deeper than a first contact may be unless the
  !> step is an implicit one.
  pure subroutine begin_contact(status, ends, gap_before, is_deeper, state, n_released)
    type(contact_status_t), intent(in) :: status !! of the slave nodes
    integer, intent(in) :: ends(2)               !! of the segment
    real(wp), intent(in) :: gap_before           !! at the last look, m
    logical, intent(in) :: is_deeper !! than a first contact may be
    integer, intent(inout) :: state  !! of the segment
    integer, intent(inout) :: n_released

    if (status%pass%has_history .and. gap_before < 0.0_wp) return
    if (.not. is_deeper .or. (status%pass%has_history .and. status%pass%is_trial)) then
      state = active
    else if (all(status%gap(ends) >= 0.0_wp)) then
      ! Ends that have come as deep have been counted.
      n_released = n_released + 1
    end if
  end subroutine begin_contact

  !> Deepest first contact of a slave segment at a point of it: that of its ends and of the master
  !> segment that the point is on, or of both at its node, m.
  pure function deepest_first_contact(status, master, ends, nodes) result(depth)
    type(contact_status_t), intent(in) :: status !! of the slave nodes
    type(surface_t), intent(in) :: master
    integer, intent(in) :: ends(2)               !! nodes of the slave segment
    integer, intent(in) :: nodes(2)              !! of the master, at the point
    real(wp) :: depth
    integer :: segments(2), k

    segments = [master%outgoing(nodes(1)), master%incoming(nodes(2))]
    depth = minval(status%point_depth(ends))
    do k = 1, 2
      if (segments(k) > 0) depth = min(depth, status%segment_depth(segments(k)))
    end do
  end function deepest_first_contact

  !> After the search of all segments. Not needed as long as something is active.
  pure subroutine note_earliest_search(memory)
    type(contact_state_t), intent(inout) :: memory

    memory%segments%earliest_search = -huge(1.0_wp)
    if (memory%slave_status%n_active == 0) &
      memory%segments%earliest_search = minval(memory%segments%next_search)
  end subroutine note_earliest_search

  !> A slave segment at the present positions.
  pure subroutine start_segment(contact, memory, s, least_part, own)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s           !! its number
    real(wp), intent(in) :: least_part !! margins next to active ends
    type(slave_segment_t), intent(out) :: own
    integer :: k

    own%number = s
    own%ends = contact%slave%segments(:, s)
    own%is_active = memory%slave_status%state(own%ends) == active
    own%is_on_face = own%is_active .and. abs(0.5_wp - abs(memory%slave_status%xi(own%ends) &
      - 0.5_wp)) > near_node
    own%margins = merge(least_part, 0.0_wp, own%is_active)
    own%start = memory%positions(:, own%ends(1))
    own%t = separation(memory%positions(:, own%ends(2)), own%start)
    own%square = max(own%t(1)**2 + own%t(2)**2, tiny(1.0_wp))
    do k = 1, 2
      own%below(k) = segment_below(contact, memory, own, k)
    end do
  end subroutine start_segment

  !> Master segment on which the k-th end of a slave segment has its projection: of an active end
  !> that of its status, else the closest of the candidates if it is over that; 0: none. Of two that
  !> meet where the projection is the outer one, so that their node lies between both ends.
  pure function segment_below(contact, memory, own, k) result(segment)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    integer, intent(in) :: k
    integer :: segment, outer
    real(wp) :: at

    if (own%is_active(k)) then
      segment = memory%slave_status%segment(own%ends(k))
      at = memory%slave_status%xi(own%ends(k))
    else
      call search_below(contact, memory, own%number, own%ends(k), segment, at)
    end if
    if (segment == 0) return
    outer = 0
    if (k == 1 .and. abs(at - 1.0_wp) <= near_node) outer = contact%master%next(segment)
    if (k == 2 .and. abs(at) <= near_node) outer = contact%master%previous(segment)
    if (outer > 0) segment = outer
  end function segment_below

  !> Master segment on which an inactive end of a slave segment has its projection, and where on it.
  pure subroutine search_below(contact, memory, s, node, segment, at)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, node
    integer, intent(out) :: segment
    real(wp), intent(out) :: at !! 0 to 1
    type(projection_t) :: projection
    integer :: beside

    at = 0.5_wp
    segment = closest_candidate(contact, memory, s, memory%positions(:, node), .true.)
    if (segment == 0) return
    associate (polyline => memory%positions(:, memory%n_slave + 1:), point => &
      memory%positions(:, node))
      projection = closest_projection(contact%master, polyline, point, segment)
      segment = merge(projection%segment, 0, projection%is_on)
      if (projection%is_on .and. abs(projection%xi - 0.5_wp) >= 0.5_wp) then
        ! At a vertex: below the end of the slave segment only if the master goes on gently there.
        beside = merge(contact%master%previous(segment), contact%master%next(segment), &
          projection%xi < 0.5_wp)
        if (beside > 0) then
          if (.not. turns_gently(vector_of(contact%master, polyline, segment), &
            vector_of(contact%master, polyline, beside))) segment = 0
        end if
      end if
      at = projection%xi
    end associate
  end subroutine search_below

  !> The candidate of a slave segment that is closest to a position on it; 0: none.
  pure function closest_candidate(contact, memory, s, point, is_opposed) result(closest)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp), intent(in) :: point(4)
    logical, intent(in) :: is_opposed !! only those that are opposed to the segment
    integer :: closest
    real(wp) :: own(2), square, least
    type(local_coordinates_t) :: local
    integer :: j, m

    closest = 0
    least = huge(1.0_wp)
    own = vector_of(contact%slave, memory%positions, s)
    do j = memory%candidates%first(s), memory%candidates%first(s + 1) - 1
      m = memory%candidates%items(j)
      local = local_coordinates(contact%master, memory%positions(:, memory%n_slave + 1:), point, m)
      square = closest_distance(local)
      if (square >= least) cycle
      if (is_opposed) then
        if (.not. are_opposed(own, local%t)) cycle
      end if
      least = square
      closest = m
    end do
  end function closest_candidate

  !> Whether two segments are opposed: their vectors have the cosine of their normals.
  pure function are_opposed(own, other) result(opposed)
    real(wp), intent(in) :: own(2), other(2) !! m
    logical :: opposed
    real(wp) :: product

    product = own(1)*other(1) + own(2)*other(2)
    opposed = product < 0.0_wp .and. product*product > side_on**2*((own(1)*own(1) &
      + own(2)*own(2))*(other(1)*other(1) + other(2)*other(2)))
  end function are_opposed

  !> Whether a slave segment is opposed to the face that one of its ends is active on.
  pure function is_opposed_to_contact(status, own) result(opposed)
    type(contact_status_t), intent(in) :: status !! of the slave nodes
    type(slave_segment_t), intent(in) :: own
    logical :: opposed
    integer :: k

    opposed = .false.
    do k = 1, 2
      if (.not. own%is_active(k)) cycle
      associate (normal => status%normal(:, own%ends(k)))
        opposed = opposed .or. own%t(2)*normal(1) - own%t(1)*normal(2) < side_on*sqrt(own%square)
      end associate
    end do
  end function is_opposed_to_contact

  !> How much of a slave segment counts opposite to a master segment, 0 to 1, where either may be
  !> the side next to a convex vertex of a closed boundary.
  pure function sides_part(contact, positions, s, m) result(part)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    integer, intent(in) :: s, m !! slave and master segment
    real(wp) :: part

    associate (polyline => positions(:, contact%slave%n_node + 1:))
      part = side_part(contact%slave, positions, s, vector_of(contact%master, polyline, m), &
        slave_side)
      if (part > 0.0_wp) part = part*side_part(contact%master, polyline, m, &
        vector_of(contact%slave, positions, s), master_side)
    end associate
  end function sides_part

  !> How much of a segment counts, 0 to 1: less the more a segment next to it at a sharp convex
  !> vertex is opposed to the segment of the other surface than it is itself (see `side_share`).
  pure function side_part(surface, positions, segment, other, range) result(part)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, at least n_node) from this surface on
    integer, intent(in) :: segment
    real(wp), intent(in) :: other(2)                 !! segment of the other surface, m
    real(wp), intent(in) :: range(2)                 !! see `side_share`
    real(wp) :: part
    real(wp) :: own(2), beside(2), turn, squares(2)
    integer :: k, next

    part = 1.0_wp
    own = vector_of(surface, positions, segment)
    squares(1) = own(1)**2 + own(2)**2
    do k = 1, 2
      next = merge(surface%previous(segment), surface%next(segment), k == 1)
      if (next == 0) cycle
      beside = vector_of(surface, positions, next)
      if (merge(-1.0_wp, 1.0_wp, k == 1)*(own(1)*beside(2) - own(2)*beside(1)) <= 0.0_wp) cycle
      squares(2) = beside(1)**2 + beside(2)**2
      turn = (own(1)*beside(1) + own(2)*beside(2))/sqrt(squares(1)*squares(2))
      if (turn >= 1.0_wp - gentle_vertex) cycle
      part = part*side_share(turn, dot_product(own/sqrt(squares(1)) - beside/sqrt(squares(2)), &
        other)/sqrt(other(1)**2 + other(2)**2), range)
    end do
  end function side_part

end module slave_segments_m
