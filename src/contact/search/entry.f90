! SPDX-License-Identifier: MIT
!> How contact begins: a separated point among its candidate pairs. It has come through a face
!> within the step, or it stands behind the closest face although it has not come through it: then
!> it is active up to the depth of a first contact, with an entry offset that takes off the depth
!> that it had before (doc/theory/contact.md, section 3.3).
module entry_m
  use search_state_m, only : contact_status_t, candidates_t, pass_t
  use projection_m, only : projection_t, nearest_projection, penetrated_projection, &
    face_projection, vector_of, turns_gently, side_on, face_on, end_tolerance, round_off
  use geometry_m, only : local_coordinates_t, coordinates_on_segment, local_gap, local_normal, &
    closest_distance, segment_length
  use kinds_m, only : wp
  use surfaces_m, only : surface_t, meets_axis
  implicit none
  private
  public :: found_contact_t, find_contact, contact_gap, is_pair, segments_of, is_opposed

  !> Relative motion that a point without candidates is away from contact, m: any.
  real(wp), parameter :: unpaired = 0.25_wp*huge(1.0_wp)

  !> Sine of the angle by which a direction lies between two others (10 degrees).
  real(wp), parameter :: well_between = 0.17_wp
  !> Times half the thickness of a row of elements, the depth below which a point is in that row and
  !> not on its far side.
  real(wp), parameter :: first_row = 1.99_wp

  !> What is found of a separated point.
  type :: found_contact_t
    type(projection_t) :: projection  !! on the face that it has entered, or the closest; segment 0:
                                      !! none within the search radius
    integer :: nearest = 0            !! candidate
    integer :: behind = 0             !! nearest opposed candidate that it is over and behind
    real(wp) :: depth = huge(1.0_wp)  !! behind that, m
    real(wp) :: lateral = huge(1.0_wp)  !! motion before which it can not have come behind any other
                                      !! candidate from beside, m
    logical :: is_active = .false.
    logical :: is_faced = .false.     !! a point between nodes is behind a face within 60 degrees
    logical :: is_released = .false.  !! it has come to lie deeper than a first contact may be
    real(wp) :: offset = 0.0_wp       !! entry offset, m
    real(wp) :: distance = 0.0_wp     !! relative motion before which it can not touch, m
  end type found_contact_t

contains

  !> Look at all candidates of a separated point, as they lie now and lay before the step.
  pure function find_contact(status, own, other, pairs, positions, increments, point, &
      i) result(found)
    type(contact_status_t), intent(in) :: status
    type(surface_t), intent(in) :: own                   !! of the points
    type(surface_t), intent(in) :: other                 !! of the segments
    type(candidates_t), intent(in) :: pairs              !! of the segments of `own`
    real(wp), intent(in), contiguous :: positions(:, :)  !! (4, n_node) of the interface
    real(wp), intent(in), contiguous :: increments(:, :) !! (2, n_node) displacements of the step, m
    real(wp), intent(in) :: point(4)                     !! position
    integer, intent(in) :: i                             !! number of the point
    type(found_contact_t) :: found
    type(local_coordinates_t) :: local
    integer :: segments(2), k, j, at, last
    real(wp) :: gap, square, least
    logical :: counts

    least = huge(1.0_wp)
    segments = segments_of(own, status%pass%n_on_segment, i)
    at = 1
    last = 0
    associate (pass => status%pass, nearest => found%nearest)
      do k = 1, merge(1, 2, segments(1) == segments(2))
        if (segments(k) == 0) cycle
        do j = pairs%first(segments(k)), pairs%first(segments(k) + 1) - 1
          ! Rows rise: what the first has had is passed over in the second.
          do while (at <= last)
            if (pairs%items(at) >= pairs%items(j)) exit
            at = at + 1
          end do
          if (at <= last) then
            if (pairs%items(at) == pairs%items(j)) cycle
          end if
          associate (segment => pairs%items(j), ends => other%segments(:, pairs%items(j)))
            ! In self contact an end of the segment is on it.
            if (pass%is_self .and. pass%n_on_segment == 0 .and. any(ends == i)) cycle
            local = coordinates_on_segment(point, positions(:, pass%other_at + ends(1)), &
              positions(:, pass%other_at + ends(2)))
            square = closest_distance(local)
            if (square < least) nearest = segment
            least = min(least, square)
            if (local%across >= 0.0_wp .and. .not. (pass%closed_gap > 0.0_wp .or. pass%has_arcs)) &
              cycle
            gap = local_gap(local)
            if (gap >= contact_gap(pass, i, segment)) cycle
            found%lateral = min(found%lateral, way_in(local))
            if (.not. is_behind(status, own, other, positions, local, i, segment)) cycle
            call weigh_face(status, own, positions, local, i, segment, found, counts)
            if (.not. counts) cycle
            if (has_entered(status, own, other, positions, increments, local, i, segment)) then
              if (found%is_active .and. abs(gap) >= abs(found%projection%gap)) cycle
              found%projection = penetrated_projection(other, positions(:, pass%other_at + 1:), &
                point, segment)
              found%is_active = .true.
            else if (.not. found%is_active .and. abs(gap) < found%depth) then
              found%behind = segment
              found%depth = abs(gap)
            end if
          end associate
        end do
        at = pairs%first(segments(k))
        last = pairs%first(segments(k) + 1) - 1
      end do
    end associate
    if (found%is_active) return
    ! Without candidates the next list is waited for. What lists hold beyond the search radius is a
    ! matter of when they were made.
    found%distance = merge(status%reach, unpaired, found%nearest > 0)
    if (found%nearest == 0 .or. least > status%reach**2) return
    found%projection = nearest_projection(other, positions(:, status%pass%other_at + 1:), point, &
      found%nearest)
    if (status%pass%is_self) then
      if (.not. is_pair(status%pass, own, pairs, i, found%projection%segment)) then
        ! Next to the closest candidate the surface is the point's own.
        found%projection%segment = found%nearest
        found%distance = min(found%distance, sqrt(least), found%lateral)
        return
      end if
    end if
    call search_closest(status, own, other, positions, increments, point, i, found)
  end function find_contact

  !> Gap below which a point makes contact with a segment, m.
  pure function contact_gap(pass, i, segment) result(gap)
    type(pass_t), intent(in) :: pass
    integer, intent(in) :: i       !! point
    integer, intent(in) :: segment !! of the other surface
    real(wp) :: gap

    gap = pass%closed_gap
    if (.not. pass%has_arcs) return
    gap = gap + pass%other_height(segment)
    if (pass%n_on_segment > 0) gap = gap + pass%own_height(1 + (i - 1)/pass%n_on_segment)
  end function contact_gap

  !> Motion that brings a point on the inner side of a segment's line, beyond its ends, over the
  !> segment, m.
  pure function way_in(local) result(way)
    type(local_coordinates_t), intent(in) :: local !! of the point from the segment
    real(wp) :: way
    real(wp) :: beyond

    way = huge(1.0_wp)
    beyond = max(-local%along, local%along - local%square) - end_tolerance*local%square
    if (beyond > 0.0_wp) way = beyond/sqrt(local%square)
  end function way_in

  !> Whether a point on the inner side of a segment is over it, and the face opposed to it.
  pure function is_behind(status, own, other, positions, local, i, segment) result(behind)
    type(contact_status_t), intent(in) :: status
    type(surface_t), intent(in) :: own, other
    real(wp), intent(in), contiguous :: positions(:, :)
    type(local_coordinates_t), intent(in) :: local !! of the point from the segment
    integer, intent(in) :: i, segment
    logical :: behind

    behind = is_over(other, positions(:, status%pass%other_at + 1:), local, segment)
    if (behind) behind = is_opposed(status%pass, own, positions, i, local_normal(local))
  end function is_behind

  !> Whether a face that a point is behind counts: points between nodes may meet faces at up to 84
  !> degrees, but at a corner these leave the point to a face that is opposed to it within 60.
  pure subroutine weigh_face(status, own, positions, local, i, segment, found, counts)
    type(contact_status_t), intent(in) :: status
    type(surface_t), intent(in) :: own
    real(wp), intent(in), contiguous :: positions(:, :)
    type(local_coordinates_t), intent(in) :: local !! of the point from the segment
    integer, intent(in) :: i, segment
    type(found_contact_t), intent(inout) :: found
    logical, intent(out) :: counts
    logical :: is_faced

    counts = .true.
    if (status%pass%n_on_segment == 0) return
    is_faced = is_opposed(status%pass, own, positions, i, local_normal(local), face_on)
    if (is_faced .and. .not. status%pass%is_trial) &
      is_faced = -local_gap(local) <= depth_limit(status, i, segment)
    counts = is_faced .or. .not. found%is_faced
    if (.not. is_faced .or. found%is_faced) return
    found%is_faced = .true.
    found%is_active = .false.
    found%depth = huge(1.0_wp)
  end subroutine weigh_face

  !> Whether a point behind a segment has come through it: it was not behind it before the step, and
  !> is no deeper than a first contact may be unless the step is an implicit one.
  pure function has_entered(status, own, other, positions, increments, local, i, &
      segment) result(entered)
    type(contact_status_t), intent(in) :: status
    type(surface_t), intent(in) :: own, other
    real(wp), intent(in), contiguous :: positions(:, :), increments(:, :)
    type(local_coordinates_t), intent(in) :: local !! of the point from the segment
    integer, intent(in) :: i, segment
    logical :: entered
    type(local_coordinates_t) :: previous

    entered = -local_gap(local) <= depth_limit(status, i, segment)
    if (status%pass%has_history .and. (entered .or. status%pass%is_trial)) then
      previous = previous_coordinates(status%pass, own, other, positions, increments, i, segment)
      entered = previous%across >= 0.0_wp
    end if
  end function has_entered

  !> The projection on what is closest: in front of it the point is separated; behind it, it is
  !> active from now on unless it is too deep, on that or on the nearest face that is opposed to it.
  pure subroutine search_closest(status, own, other, positions, increments, point, i, found)
    type(contact_status_t), intent(in) :: status
    type(surface_t), intent(in) :: own, other
    real(wp), intent(in), contiguous :: positions(:, :), increments(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: i
    type(found_contact_t), intent(inout) :: found
    type(local_coordinates_t) :: previous
    real(wp) :: limit
    integer :: next

    associate (pass => status%pass, projection => found%projection)
      found%distance = min(status%reach, projection%distance, abs(projection%gap), found%lateral)
      if (projection%xi <= 0.0_wp .or. projection%xi >= 1.0_wp) then
        ! A face reaches a little beyond its end.
        associate (ends => pass%other_at + other%segments(:, projection%segment))
          found%distance = max(0.0_wp, min(status%reach, projection%distance, found%lateral) &
            - end_tolerance*segment_length(positions(:, ends(1)), positions(:, ends(2))))
        end associate
      end if
      if (projection%is_on .and. projection%gap < contact_gap(pass, i, projection%segment)) then
        found%distance = 0.0_wp
        if (.not. is_opposed(pass, own, positions, i, projection%normal, merge(face_on, side_on, &
          found%is_faced))) then
          if (found%behind == 0) return
          projection = face_projection(coordinates_on_segment(point, &
            positions(:, pass%other_at + other%segments(1, &
            found%behind)), positions(:, pass%other_at + other%segments(2, found%behind))), &
            found%behind)
        end if
        limit = depth_limit(status, i, projection%segment)
        found%is_active = -projection%gap <= limit
        ! Beyond the first row of elements it may as well be the far side of a body.
        found%is_released = .not. found%is_active &
          .and. -projection%gap < first_row*status%segment_depth(projection%segment)
        if (.not. pass%has_history) return
        previous = previous_coordinates(pass, own, other, positions, increments, i, &
          projection%segment)
        ! In all trials of an implicit step the same.
        if (found%is_active) found%offset = max(0.0_wp, -local_gap(previous))
        ! What lay as deep before is known, behind this segment or the next one.
        if (found%is_released) found%is_released = .not. was_deep(projection%segment, previous)
        if (found%is_released) then
          next = merge(other%previous(projection%segment), other%next(projection%segment), &
            previous%along < 0.5_wp*previous%square)
          if (next > 0) found%is_released = .not. was_deep(next, &
            previous_coordinates(pass, own, other, positions, increments, i, next))
        end if
      end if
    end associate

  contains

    !> Whether the point was behind a segment, deeper than a first contact may be.
    pure logical function was_deep(segment, before)
      integer, intent(in) :: segment
      type(local_coordinates_t), intent(in) :: before

      was_deep = -local_gap(before) > limit &
        .and. is_over(other, positions(:, status%pass%other_at + 1:), before, segment)
    end function was_deep

  end subroutine search_closest

  !> Deepest first contact of a point with a segment, m.
  pure function depth_limit(status, i, segment) result(depth)
    type(contact_status_t), intent(in) :: status
    integer, intent(in) :: i, segment
    real(wp) :: depth

    depth = min(status%point_depth(i), status%segment_depth(segment))
  end function depth_limit

  !> Whether a point is over a segment; beyond an end of an open surface, or a sharp vertex, by a
  !> tolerance of 1 % too.
  pure function is_over(surface, polyline, local, segment) result(over)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_node) positions
    type(local_coordinates_t), intent(in) :: local
    integer, intent(in) :: segment
    logical :: over
    integer :: beside
    real(wp) :: beyond
    logical :: is_first

    is_first = local%along < 0.0_wp
    beyond = max(-local%along, local%along - local%square)
    over = beyond <= round_off*local%square
    if (over) return
    beside = merge(surface%previous(segment), surface%next(segment), is_first)
    if (beside == 0) then
      over = beyond <= end_tolerance*local%square .or. meets_axis(surface, segment, is_first)
    else if (beyond <= end_tolerance*local%square) then
      over = .not. turns_gently(vector_of(surface, polyline, beside), local%t)
    end if
  end function is_over

  !> A point from a segment as both lay before the step.
  pure function previous_coordinates(pass, own, other, positions, increments, i, segment) &
    result(local)
    type(pass_t), intent(in) :: pass
    type(surface_t), intent(in) :: own, other
    real(wp), intent(in), contiguous :: positions(:, :), increments(:, :)
    integer, intent(in) :: i, segment
    type(local_coordinates_t) :: local
    integer :: ends(2), s, q

    ends = pass%other_at + other%segments(:, segment)
    if (pass%n_on_segment == 0) then
      local = coordinates_on_segment(previous(pass%own_at + i), previous(ends(1)), &
        previous(ends(2)))
    else
      s = 1 + (i - 1)/pass%n_on_segment
      q = i - (s - 1)*pass%n_on_segment
      associate (own_ends => pass%own_at + own%segments(:, s))
        local = coordinates_on_segment((1.0_wp - pass%xi(q))*previous(own_ends(1)) &
          + pass%xi(q)*previous(own_ends(2)), previous(ends(1)), previous(ends(2)))
      end associate
    end if

  contains

    !> Position of a node before the step.
    pure function previous(node) result(position)
      integer, intent(in) :: node
      real(wp) :: position(4)

      position(1:2) = positions(1:2, node)
      position(3:4) = positions(3:4, node) - increments(:, node)
    end function previous

  end function previous_coordinates

  !> Whether a point on a surface in contact with itself may be followed to a segment: a candidate,
  !> or none that shares a node or the element behind with the point's own.
  pure function is_pair(pass, own, pairs, i, segment) result(is)
    type(pass_t), intent(in) :: pass
    type(surface_t), intent(in) :: own
    type(candidates_t), intent(in) :: pairs
    integer, intent(in) :: i, segment
    logical :: is
    integer :: segments(2), k
    logical :: is_apart

    is = .false.
    is_apart = .true.
    segments = segments_of(own, pass%n_on_segment, i)
    do k = 1, 2
      if (segments(k) == 0) cycle
      associate (first => pairs%first(segments(k)), last => pairs%first(segments(k) + 1) - 1)
        is = is .or. any(pairs%items(first:last) == segment)
      end associate
      is_apart = is_apart .and. segments(k) /= segment .and. own%previous(segments(k)) /= segment &
        .and. own%next(segments(k)) /= segment &
        .and. own%segment_element(segments(k)) /= own%segment_element(segment)
    end do
    is = is .or. is_apart
  end function is_pair

  !> The segments that a contact point is on: those before and after a node, 0: none there, or one
  !> segment twice.
  pure function segments_of(surface, n_on_segment, i) result(segments)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: n_on_segment !! points of a segment; 0: points at nodes
    integer, intent(in) :: i            !! point
    integer :: segments(2)

    if (n_on_segment == 0) then
      segments = [surface%incoming(i), surface%outgoing(i)]
    else
      segments = 1 + (i - 1)/n_on_segment
    end if
  end function segments_of

  !> Whether a face is opposed to a point: its outward normal is opposite to that of one of the
  !> point's segments within 60 degrees (points between nodes: 84 degrees, or steep flanks would
  !> have none), or lies opposite between both of them at a convex vertex, by 10 degrees at least:
  !> else the nodes of a body that slides on over a ramp would be held by the end face in front of
  !> it. At an end of an open surface the tangent that leads out of it replaces the missing normal
  !> there.
  pure function is_opposed(pass, own, positions, i, normal, largest) result(opposed)
    type(pass_t), intent(in) :: pass
    type(surface_t), intent(in) :: own               !! of the points
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    integer, intent(in) :: i                         !! point
    real(wp), intent(in) :: normal(2)                !! outward, of the face
    real(wp), intent(in), optional :: largest        !! cosine for points between nodes
    logical :: opposed
    real(wp) :: t(2, 2), normals(2, 2), limit
    integer :: segments(2), k

    opposed = .false.
    segments = segments_of(own, pass%n_on_segment, i)
    do k = 1, 2
      if (segments(k) == 0) cycle
      t(:, k) = vector_of(own, positions(:, pass%own_at + 1:), segments(k))
      t(:, k) = t(:, k)/max(sqrt(t(1, k)**2 + t(2, k)**2), tiny(1.0_wp))
      normals(:, k) = [t(2, k), -t(1, k)]
    end do
    if (segments(1) == 0) normals(:, 1) = -t(:, 2)
    if (segments(2) == 0) normals(:, 2) = t(:, 1)
    limit = merge(side_on, face_on, segments(1) == segments(2))
    if (present(largest)) limit = min(limit, largest)
    do k = 1, 2
      if (segments(k) == 0) cycle
      opposed = dot_product(normals(:, k), normal) < limit
      if (opposed) return
    end do
    ! The opposite of the normal turns counter-clockwise from the first to the second of the
    ! normals.
    opposed = cross(normals(:, 1), normals(:, 2)) > 0.0_wp .and. &
      cross(normals(:, 1), -normal) > well_between .and. &
      cross(-normal, normals(:, 2)) > well_between
  end function is_opposed

  !> Sine of the angle from one unit vector to another.
  pure function cross(a, b)
    real(wp), intent(in) :: a(2), b(2)
    real(wp) :: cross

    cross = a(1)*b(2) - a(2)*b(1)
  end function cross

end module entry_m
