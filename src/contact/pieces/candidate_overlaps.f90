! SPDX-License-Identifier: MIT
!> Overlaps of a slave segment with its candidates: both nodes of each opposed master segment are
!> projected on the slave segment and clipped to it. Segments beyond the projection of an end are
!> left out, and the overlap there is extended to the end. Where overlaps of different bodies lie
!> over each other the nearest penetrated one wins (doc/theory/contact.md, section 3.5).
module candidate_overlaps_m
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use foot_m, only : foot_t, closest_foot, side_on, face_on, side_share, round_off
  use geometry_m, only : sight_t, sight_of_segment, separation, closest_distance
  use kinds_m, only : wp
  use piece_table_m, only : piece_table_t, grow_pieces, is_walked_piece
  use opposed_m, only : turns_sharply
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: list_candidate_overlaps, closest_candidate

  !> Deepest middle of an overlap with a master segment that no end of the slave segment is active
  !> on, by the depth of a first contact: deeper ones are the far side of something, or the back of
  !> the own wall.
  real(wp), parameter :: deep = 1.5_wp
  !> Part of a segment within which a projection is on its node.
  real(wp), parameter :: near_node = 1.0e-9_wp
  !> One overlap.
  type :: overlap_t
    integer :: master = 0
    real(wp) :: low = 0.0_wp, high = 0.0_wp !! range of the slave segment, 0 to 1
    integer :: first = 0, last = 0          !! master nodes at its breakpoints, 0: a slave node
    real(wp) :: gap(2) = 0.0_wp             !! of the master at both ends of the slave segment, over
                                            !! that, m
  end type overlap_t

contains

  !> Append the overlaps of a slave segment to a table.
  pure subroutine list_candidate_overlaps(contact, memory, s, is_strict, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s         !! slave segment
    logical, intent(in) :: is_strict !! with an end beyond the master it has one without a master
    type(piece_table_t), intent(inout) :: table
    type(overlap_t) :: overlaps(2*(memory%candidates%first(s + 1) - memory%candidates%first(s)) + 1)
    integer :: ends(2), anchors(2), j, k, n
    logical :: is_active(2), may_be_deep

    ends = contact%slave%segments(:, s)
    do k = 1, 2
      anchors(k) = segment_below(contact, memory, s, ends, k)
    end do
    if (is_strict .and. any(anchors == 0)) then
      if (is_opposed_to_contact(contact%slave, memory, s)) &
        call append_overlap(ends, overlap_t(high=1.0_wp), table)
      return
    end if
    is_active = memory%slave_tracking%status(ends) == is_touching
    ! From the start a master node may lie deep behind a segment both ends of which are beside it.
    may_be_deep = .not. contact%is_self .and. .not. any(is_active) &
      .and. memory%segment_status(s) == is_touching
    n = 0
    do j = memory%candidates%first(s), memory%candidates%first(s + 1) - 1
      associate (m => memory%candidates%items(j))
        call cut_by(contact, memory, ends, anchors, m, overlaps(n + 1))
        if (.not. overlaps(n + 1)%high > overlaps(n + 1)%low) cycle
        if (is_beyond(contact%master, anchors, m, size(overlaps))) cycle
        if (memory%slave_tracking%pass%is_closed) then
          if (is_side_of_corner(contact, memory, s, m)) cycle
        end if
        if (.not. (may_be_deep .or. any(is_active .and. anchors == m)) .and. &
          middle_gap(overlaps(n + 1)) < -deep*memory%slave_tracking%segment_depth(m)) cycle
        n = n + 1
      end associate
    end do
    call sort_overlaps(overlaps(:n))
    if (any(overlaps(2:n)%low < overlaps(:n - 1)%high)) call resolve_overlaps(overlaps, n)
    do k = 1, n
      call append_overlap(ends, overlaps(k), table)
    end do
  end subroutine list_candidate_overlaps

  !> Master segment on which the k-th end of a slave segment has its projection: of an active end
  !> that of its status, else the closest of the candidates if it is over that; 0: none. Of two that
  !> meet where the projection is the outer one, so that their node lies between both ends.
  pure function segment_below(contact, memory, s, ends, k) result(segment)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, ends(2), k
    integer :: segment, outer
    real(wp) :: at

    if (memory%slave_tracking%status(ends(k)) == is_touching) then
      segment = memory%slave_tracking%segment(ends(k))
      at = memory%slave_tracking%xi(ends(k))
    else
      call look_below(contact, memory, s, ends(k), segment, at)
    end if
    if (segment == 0) return
    outer = 0
    if (k == 1 .and. abs(at - 1.0_wp) <= near_node) outer = contact%master%next(segment)
    if (k == 2 .and. abs(at) <= near_node) outer = contact%master%previous(segment)
    if (outer > 0) segment = outer
  end function segment_below

  !> The same of an end that is not active, and where on the segment.
  pure subroutine look_below(contact, memory, s, node, segment, at)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, node
    integer, intent(out) :: segment
    real(wp), intent(out) :: at !! 0 to 1
    type(foot_t) :: foot

    at = 0.5_wp
    segment = closest_opposed(contact, memory, s, memory%places(:, node))
    if (segment == 0) return
    associate (chain => memory%places(:, memory%n_slave + 1:), point => memory%places(:, node))
      foot = closest_foot(contact%master, chain, point, segment)
      if (.not. foot%is_on) then
        segment = 0
      else if (abs(foot%xi - 0.5_wp) >= 0.5_wp) then
        ! At a vertex: below the end of the slave segment only if the master goes on gently there.
        segment = merge(foot%segment, 0, goes_on(contact%master, chain, foot))
      end if
      at = foot%xi
    end associate
  end subroutine look_below

  !> Whether a surface goes on without a sharp turn at the node on which a projection stands.
  pure function goes_on(surface, chain, foot)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) positions
    type(foot_t), intent(in) :: foot
    logical :: goes_on
    integer :: before, behind

    before = foot%segment
    behind = surface%next(foot%segment)
    if (foot%xi < 0.5_wp) then
      before = surface%previous(foot%segment)
      behind = foot%segment
    end if
    goes_on = min(before, behind) == 0
    if (.not. goes_on) goes_on = .not. turns_sharply(surface, chain, before, behind)
  end function goes_on

  !> The candidate that is opposed to a slave segment and closest to a position on it; 0: none.
  pure function closest_opposed(contact, memory, s, point) result(closest)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp), intent(in) :: point(4)
    integer :: closest
    real(wp) :: own(2), square, least
    type(sight_t) :: sight
    integer :: j

    closest = 0
    least = huge(1.0_wp)
    associate (ends => contact%slave%segments(:, s))
      own = separation(memory%places(:, ends(2)), memory%places(:, ends(1)))
    end associate
    do j = memory%candidates%first(s), memory%candidates%first(s + 1) - 1
      associate (nodes => memory%n_slave + contact%master%segments(:, memory%candidates%items(j)))
        sight = sight_of_segment(point, memory%places(:, nodes(1)), memory%places(:, nodes(2)))
      end associate
      if (.not. dot_product(own, sight%t) < side_on*norm2(own)*sqrt(sight%square)) cycle
      square = closest_distance(sight)
      if (square >= least) cycle
      least = square
      closest = memory%candidates%items(j)
    end do
  end function closest_opposed

  !> Whether a slave segment is the side next to a sharp convex vertex whose other segment is
  !> opposed to a master segment so much more that nothing of the side counts.
  pure function is_side_of_corner(contact, memory, s, m) result(is)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, m
    logical :: is
    real(wp) :: own(2), beside(2), other(2), cosine
    integer :: k, next

    is = .false.
    other = vector(contact%master, memory%places(:, memory%n_slave + 1:), m)
    own = vector(contact%slave, memory%places(:, :memory%n_slave), s)
    cosine = dot_product(own, other)/(norm2(own)*norm2(other))
    if (cosine <= face_on) return
    do k = 1, 2
      next = merge(contact%slave%previous(s), contact%slave%next(s), k == 1)
      if (next == 0) cycle
      beside = vector(contact%slave, memory%places(:, :memory%n_slave), next)
      if (merge(-1.0_wp, 1.0_wp, k == 1)*(own(1)*beside(2) - own(2)*beside(1)) <= 0.0_wp) cycle
      is = is .or. .not. side_share(cosine - dot_product(beside, other) &
        /(norm2(beside)*norm2(other))) > 0.0_wp
    end do
  end function is_side_of_corner

  !> Vector of a segment, m.
  pure function vector(surface, places, segment) result(t)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    integer, intent(in) :: segment
    real(wp) :: t(2)

    t = separation(places(:, surface%segments(2, segment)), &
      places(:, surface%segments(1, segment)))
  end function vector

  !> Whether a slave segment is opposed to the face that one of its ends is active on.
  pure function is_opposed_to_contact(slave, memory, s) result(opposed)
    type(surface_t), intent(in) :: slave
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    logical :: opposed
    real(wp) :: t(2)
    integer :: k

    opposed = .false.
    associate (ends => slave%segments(:, s), tracking => memory%slave_tracking)
      t = separation(memory%places(:, ends(2)), memory%places(:, ends(1)))
      do k = 1, 2
        if (tracking%status(ends(k)) /= is_touching) cycle
        associate (normal => tracking%normal(:, ends(k)))
          opposed = opposed .or. t(2)*normal(1) - t(1)*normal(2) < side_on*norm2(t)
        end associate
      end do
    end associate
  end function is_opposed_to_contact

  !> The candidate of a slave segment that is closest to a position on it; 0: none.
  pure function closest_candidate(master, memory, s, point) result(closest)
    type(surface_t), intent(in) :: master
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp), intent(in) :: point(4)
    integer :: closest
    real(wp) :: square, least
    integer :: j

    closest = 0
    least = huge(1.0_wp)
    do j = memory%candidates%first(s), memory%candidates%first(s + 1) - 1
      associate (ends => memory%n_slave + master%segments(:, memory%candidates%items(j)))
        square = closest_distance(sight_of_segment(point, memory%places(:, ends(1)), &
          memory%places(:, ends(2))))
      end associate
      if (square >= least) cycle
      least = square
      closest = memory%candidates%items(j)
    end do
  end function closest_candidate

  !> Whether a master segment lies beyond the projection of an end of the slave segment: the slave
  !> runs against the master, so that its first end is followed by what comes before.
  pure function is_beyond(master, anchors, segment, n_most) result(beyond)
    type(surface_t), intent(in) :: master
    integer, intent(in) :: anchors(2) !! below the first end and the second, 0: none
    integer, intent(in) :: segment
    integer, intent(in) :: n_most     !! steps along the surface
    logical :: beyond
    integer :: k, up, down, i

    beyond = .false.
    do k = 1, 2
      if (anchors(k) == 0 .or. anchors(k) == segment) cycle
      if (master%chain(anchors(k)) /= master%chain(segment)) cycle
      up = anchors(k)
      down = anchors(k)
      do i = 1, n_most
        if (up > 0) up = master%next(up)
        if (down > 0) down = master%previous(down)
        if (up == segment .or. down == segment) exit
        if (up + down == 0) exit
      end do
      if (up == segment .and. down == segment) cycle
      beyond = beyond .or. (k == 1 .and. up == segment) .or. (k == 2 .and. down == segment)
    end do
  end function is_beyond

  !> The overlap with one master segment; empty where they are not opposed.
  pure subroutine cut_by(contact, memory, ends, anchors, m, overlap)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2), anchors(2), m
    type(overlap_t), intent(out) :: overlap
    type(sight_t) :: sights(2)
    real(wp) :: other(2), xi(2), gaps(2)
    integer :: nodes(2), k

    nodes = [contact%master%segments(2, m), contact%master%segments(1, m)]
    do k = 1, 2
      sights(k) = sight_of_segment(memory%places(:, memory%n_slave + nodes(k)), &
        memory%places(:, ends(1)), memory%places(:, ends(2)))
      xi(k) = sights(k)%along/sights(k)%square
      gaps(k) = sights(k)%across/sqrt(sights(k)%square)
    end do
    other = sights(1)%d - sights(2)%d
    ! Opposed: the tangents have the cosine of the normals.
    if (.not. dot_product(sights(1)%t, other) < side_on*norm2(other)*sqrt(sights(1)%square)) return
    overlap%master = m
    overlap%low = clipped(xi(1))
    overlap%high = clipped(xi(2))
    if (overlap%low > 0.0_wp .and. overlap%low < 1.0_wp) overlap%first = nodes(1)
    if (overlap%high > 0.0_wp .and. overlap%high < 1.0_wp) overlap%last = nodes(2)
    if (anchors(1) == m) then
      overlap%low = 0.0_wp
      overlap%first = 0
    else if (anchors(1) > 0 .and. abs(xi(1)) <= near_node) then
      ! A corner right below an end that is active on another body has a point of its own.
      if (contact%master%next(m) /= anchors(1)) overlap%first = nodes(1)
    end if
    if (anchors(2) == m) then
      overlap%high = 1.0_wp
      overlap%last = 0
    else if (anchors(2) > 0 .and. abs(xi(2) - 1.0_wp) <= near_node) then
      if (contact%master%previous(m) /= anchors(2)) overlap%last = nodes(2)
    end if
    if (abs(xi(2) - xi(1)) > round_off) overlap%gap = gaps(1) + (gaps(2) - gaps(1)) &
      *([0.0_wp, 1.0_wp] - xi(1))/(xi(2) - xi(1))
  end subroutine cut_by

  !> A projection within the slave segment; neighbours share one, whatever round-off is in it.
  pure function clipped(xi) result(at)
    real(wp), intent(in) :: xi
    real(wp) :: at

    at = min(max(xi, 0.0_wp), 1.0_wp)
  end function clipped

  !> Gap in the middle of an overlap, m.
  pure function middle_gap(overlap) result(gap)
    type(overlap_t), intent(in) :: overlap
    real(wp) :: gap

    gap = gap_at(overlap, 0.5_wp*(overlap%low + overlap%high))
  end function middle_gap

  !> Gap of the master segment over the slave segment at a local coordinate of that, m.
  pure function gap_at(overlap, xi) result(gap)
    type(overlap_t), intent(in) :: overlap
    real(wp), intent(in) :: xi
    real(wp) :: gap

    gap = (1.0_wp - xi)*overlap%gap(1) + xi*overlap%gap(2)
  end function gap_at

  !> Order overlaps along the slave segment.
  pure subroutine sort_overlaps(overlaps)
    type(overlap_t), intent(inout) :: overlaps(:)
    type(overlap_t) :: next
    integer :: i, k

    do i = 2, size(overlaps)
      next = overlaps(i)
      k = i - 1
      do while (k >= 1)
        if (overlaps(k)%low <= next%low) exit
        overlaps(k + 1) = overlaps(k)
        k = k - 1
      end do
      overlaps(k + 1) = next
    end do
  end subroutine sort_overlaps

  !> Split overlaps that lie over each other: between any two breakpoints one is left.
  pure subroutine resolve_overlaps(overlaps, n)
    type(overlap_t), intent(inout) :: overlaps(:) !! with room for twice as many
    integer, intent(inout) :: n
    type(overlap_t) :: former(n)
    real(wp) :: points(2*n), low, high
    integer :: nodes(2*n), i, winner, n_former

    n_former = n
    former = overlaps(:n)
    call list_breakpoints(former, points, nodes)
    n = 0
    do i = 1, 2*n_former - 1
      low = points(i)
      high = points(i + 1)
      if (.not. high > low) cycle
      winner = nearest_penetrated(former, low, high)
      if (winner == 0) cycle
      if (n > 0) then
        if (overlaps(n)%master == former(winner)%master .and. .not. low > overlaps(n)%high) then
          overlaps(n)%high = high
          overlaps(n)%last = nodes(i + 1)
          cycle
        end if
      end if
      n = n + 1
      overlaps(n) = former(winner)
      overlaps(n)%low = low
      overlaps(n)%high = high
      overlaps(n)%first = nodes(i)
      overlaps(n)%last = nodes(i + 1)
    end do
  end subroutine resolve_overlaps

  !> All breakpoints in order, with the master nodes that stand there.
  pure subroutine list_breakpoints(overlaps, points, nodes)
    type(overlap_t), intent(in) :: overlaps(:)
    real(wp), intent(out) :: points(2*size(overlaps))
    integer, intent(out) :: nodes(2*size(overlaps))
    real(wp) :: point
    integer :: i, k, node

    do i = 1, 2*size(overlaps)
      associate (overlap => overlaps((i + 1)/2))
        point = merge(overlap%low, overlap%high, modulo(i, 2) == 1)
        node = merge(overlap%first, overlap%last, modulo(i, 2) == 1)
      end associate
      k = i - 1
      do while (k >= 1)
        if (points(k) <= point) exit
        points(k + 1) = points(k)
        nodes(k + 1) = nodes(k)
        k = k - 1
      end do
      points(k + 1) = point
      nodes(k + 1) = node
    end do
  end subroutine list_breakpoints

  !> Of the overlaps that cover a stretch the nearest that is penetrated, or the nearest if none is.
  pure function nearest_penetrated(overlaps, low, high) result(nearest)
    type(overlap_t), intent(in) :: overlaps(:)
    real(wp), intent(in) :: low, high
    integer :: nearest
    real(wp) :: gap, best
    integer :: k

    nearest = 0
    best = 0.0_wp
    do k = 1, size(overlaps)
      if (overlaps(k)%low > low .or. overlaps(k)%high < high) cycle
      gap = gap_at(overlaps(k), 0.5_wp*(low + high))
      if (nearest > 0) then
        if (gap < 0.0_wp .and. best < 0.0_wp) then
          if (gap <= best) cycle
        else if (gap >= best) then
          cycle
        end if
      end if
      nearest = k
      best = gap
    end do
  end function nearest_penetrated

  !> Append an overlap to the table.
  pure subroutine append_overlap(ends, overlap, table)
    integer, intent(in) :: ends(2) !! nodes of the slave segment
    type(overlap_t), intent(in) :: overlap
    type(piece_table_t), intent(inout) :: table

    if (table%n + 1 >= size(table%master)) call grow_pieces(table)
    associate (k => table%n + 1)
      table%ends(:, k) = ends
      table%master(k) = overlap%master
      table%low(k) = overlap%low
      table%high(k) = overlap%high
      table%first_cut(k) = overlap%first
      table%last_cut(k) = overlap%last
      table%kind(k) = is_walked_piece
    end associate
    table%n = table%n + 1
  end subroutine append_overlap

end module candidate_overlaps_m
