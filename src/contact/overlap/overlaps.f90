! SPDX-License-Identifier: MIT
!> Overlaps of a slave segment with master segments. Between two active ends on one surface these
!> are the segments from below the one to below the other; else its candidates that are opposed.
!> The nodes of each master segment are projected on the slave segment and clipped to it; where
!> overlaps of different bodies lie over each other the nearest penetrated one wins
!> (doc/theory/contact.md, section 3.5).
module overlaps_m
  use contact_state_m, only : contact_state_t, active
  use contacts_m, only : contact_t
  use projection_m, only : projection_t, closest_projection, side_on, face_on, side_share, &
    gentle_vertex, slave_side, master_side, opposed_share, local_coordinates, vector_of, &
    turns_gently, round_off
  use geometry_m, only : local_coordinates_t, closest_distance
  use kinds_m, only : wp
  use overlap_m, only : overlap_t, gap_at, order_overlaps
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: find_overlaps, n_most_overlaps, room_for_overlaps, closest_candidate, sides_part

  !> Most segments between two active ends that are taken without a look at the candidates, and
  !> number of segments of a closed master up to which the way forwards may be the shorter one.
  integer, parameter :: n_between = 6, short_surface = 2*n_between + 2
  !> Deepest middle of an overlap with a master segment that is not reached from an active end of
  !> the slave segment, by the depth of a first contact: deeper ones are the far side of something,
  !> or the back of the own wall.
  real(wp), parameter :: deep = 1.5_wp
  !> Part of a segment within which a projection is on its node.
  real(wp), parameter :: near_node = 1.0e-9_wp

  !> A slave segment. Without default values, which would be written before each use.
  type :: slave_segment_t
    integer :: number
    integer :: ends(2)       !! nodes
    logical :: is_active(2)  !! its ends
    real(wp) :: margins(2)   !! parts of it next to its ends where master nodes are no breakpoints
    integer :: below(2)      !! master segments that its ends have their projections on, 0: none
    real(wp) :: start(4)     !! position of its first end
    real(wp) :: t(2), square !! its vector, m, and the square of that
  end type slave_segment_t

contains

  !> Room for the overlaps of a slave segment.
  pure function n_most_overlaps(memory, s) result(n)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s !! slave segment
    integer :: n

    n = max(n_between, 2*(memory%candidates%first(s + 1) - memory%candidates%first(s)) + 1)
  end function n_most_overlaps

  !> The same for any of a range of them.
  pure function room_for_overlaps(memory, first, last) result(n)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first, last
    integer :: n
    integer :: s

    n = 0
    do s = first, last
      n = max(n, n_most_overlaps(memory, s))
    end do
  end function room_for_overlaps

  !> Overlaps of a slave segment, in order along it.
  pure subroutine find_overlaps(contact, memory, s, is_strict, least_part, overlaps, n)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s         !! slave segment
    logical, intent(in) :: is_strict !! with an end beyond the master it has one without a master
    real(wp), intent(in) :: least_part !! part of the segment next to its active ends where master
                                      !! nodes are no breakpoints
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! with room for
                                      !! `n_most_overlaps`
    integer, intent(out) :: n
    type(slave_segment_t) :: own
    integer :: k

    own%number = s
    own%ends = contact%slave%segments(:, s)
    own%is_active = memory%slave_status%state(own%ends) == active
    own%margins = merge(least_part, 0.0_wp, own%is_active)
    own%start = memory%positions(:, own%ends(1))
    own%t = way_to(own%ends(2), own, memory%positions)
    own%square = max(own%t(1)**2 + own%t(2)**2, tiny(1.0_wp))
    do k = 1, 2
      own%below(k) = segment_below(contact, memory, own, k)
    end do
    n = 0
    if (is_strict .and. any(own%below == 0)) then
      if (.not. is_opposed_to_contact(memory, own)) return
      n = 1
      overlaps(1) = overlap_t(0, 0.0_wp, 1.0_wp, 0, 0, [0.0_wp, 0.0_wp], 1.0_wp, 1.0_wp)
      return
    end if
    if (contact%master%n_segment > short_surface .and. all(own%is_active)) &
      call take_between(own, contact%master%previous, &
      contact%master%segments, memory%n_slave, memory%positions, least_part, overlaps, n)
    if (n == 0) call take_candidates(contact, memory, own, overlaps, n)
    if (memory%slave_status%pass%is_closed) call weigh_sides(contact, memory, own, overlaps(:n))
  end subroutine find_overlaps

  !> Overlaps with the master segments from below one active end to below the other; none where
  !> these are too many or do not follow each other.
  pure subroutine take_between(own, previous, segments, n_slave, positions, least_part, overlaps, n)
    type(slave_segment_t), intent(in) :: own
    integer, intent(in) :: previous(*), segments(2, *) !! of the master
    integer, intent(in) :: n_slave       !! local number before the first master node
    real(wp), intent(in) :: positions(4, *) !! of the interface
    real(wp), intent(in) :: least_part
    type(overlap_t), intent(inout) :: overlaps(*)
    integer, intent(out) :: n
    real(wp) :: d(2), earlier(2), inverse, xi, low
    integer :: k, m, node, first

    n = 0
    m = own%below(1)
    do k = 1, n_between
      if (m == 0) return
      overlaps(k)%master = m
      if (m == own%below(2)) exit
      m = previous(m)
    end do
    if (k > n_between) return
    n = k
    low = 0.0_wp
    first = 0
    inverse = 1.0_wp/own%square
    earlier = way_to(n_slave + segments(2, own%below(1)), own, positions)
    do k = 1, n
      node = segments(1, overlaps(k)%master)
      d = way_to(n_slave + node, own, positions)
      xi = (d(1)*own%t(1) + d(2)*own%t(2))*inverse
      overlaps(k)%low = low
      overlaps(k)%first = first
      overlaps(k)%share = 0.0_wp
      overlaps(k)%part = 1.0_wp
      if (k == n .or. xi >= 1.0_wp - least_part) then
        xi = 1.0_wp
        node = 0
      else if (xi <= max(low, least_part)) then
        xi = low
        node = first
      end if
      overlaps(k)%high = xi
      overlaps(k)%last = node
      if (xi > low) overlaps(k)%share = share_of(own, earlier - d)
      earlier = d
      low = xi
      first = node
    end do
  end subroutine take_between

  !> Vector from the first end of a slave segment to a node, m.
  pure function way_to(node, own, positions) result(d)
    integer, intent(in) :: node          !! local number
    type(slave_segment_t), intent(in) :: own
    real(wp), intent(in) :: positions(4, *) !! of the interface
    real(wp) :: d(2)

    d(1) = (positions(1, node) - own%start(1)) + (positions(3, node) - own%start(3))
    d(2) = (positions(2, node) - own%start(2)) + (positions(4, node) - own%start(4))
  end function way_to

  !> Overlaps with the candidates of a slave segment.
  pure subroutine take_candidates(contact, memory, own, overlaps, n)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    type(overlap_t), intent(inout) :: overlaps(:)
    integer, intent(out) :: n
    integer :: j, n_most
    logical :: may_be_deep

    ! From the start a master node may lie deep behind a segment both ends of which are beside it.
    may_be_deep = .not. contact%is_self .and. .not. any(own%is_active) &
      .and. memory%segment_state(own%number) == active
    n_most = n_most_overlaps(memory, own%number)
    n = 0
    do j = memory%candidates%first(own%number), memory%candidates%first(own%number + 1) - 1
      associate (m => memory%candidates%items(j), overlap => overlaps(n + 1))
        call clip(contact%master, memory, own, m, overlap)
        if (.not. overlap%high > overlap%low) cycle
        if (is_beyond(contact%master, own%below, m, n_most)) cycle
        if (.not. may_be_deep .and. gap_at(overlap, 0.5_wp*(overlap%low + overlap%high)) &
          < -deep*memory%slave_status%segment_depth(m)) then
          if (.not. any(own%is_active .and. own%below == m) &
            .and. .not. is_reached(contact, memory, own, m, n_most)) cycle
        end if
        n = n + 1
      end associate
    end do
    call order_overlaps(overlaps, n)
  end subroutine take_candidates

  !> Whether a master segment is the one that an end of a slave segment is active on, or follows it
  !> towards the other end without a sharp turn (a surface in contact with itself: the back of the
  !> own wall may follow).
  pure function is_reached(contact, memory, own, m, n_most) result(reached)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    integer, intent(in) :: m
    integer, intent(in) :: n_most !! steps along the surface
    logical :: reached
    integer :: k, i, segment, next

    reached = .false.
    associate (master => contact%master, polyline => memory%positions(:, memory%n_slave + 1:))
      do k = 1, 2
        if (.not. own%is_active(k)) cycle
        segment = memory%slave_status%segment(own%ends(k))
        do i = 1, n_most
          reached = reached .or. segment == m
          next = merge(master%previous(segment), master%next(segment), k == 1)
          if (reached .or. next == 0 .or. contact%is_self) exit
          if (.not. turns_gently(vector_of(master, polyline, segment), vector_of(master, polyline, &
            next))) exit
          segment = next
        end do
      end do
    end associate
  end function is_reached

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

  !> The same of an end that is not active, and where on the segment.
  pure subroutine search_below(contact, memory, s, node, segment, at)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, node
    integer, intent(out) :: segment
    real(wp), intent(out) :: at !! 0 to 1
    type(projection_t) :: projection

    at = 0.5_wp
    segment = closest_candidate(contact, memory, s, memory%positions(:, node), .true.)
    if (segment == 0) return
    associate (polyline => memory%positions(:, memory%n_slave + 1:), point => &
      memory%positions(:, node))
      projection = closest_projection(contact%master, polyline, point, segment)
      if (.not. projection%is_on) then
        segment = 0
      else if (abs(projection%xi - 0.5_wp) >= 0.5_wp) then
        ! At a vertex: below the end of the slave segment only if the master goes on gently there.
        segment = merge(projection%segment, 0, goes_on(contact%master, polyline, projection))
      end if
      at = projection%xi
    end associate
  end subroutine search_below

  !> Whether a surface goes on without a sharp turn at the node on which a projection stands.
  pure function goes_on(surface, polyline, projection)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_node) positions
    type(projection_t), intent(in) :: projection
    logical :: goes_on
    integer :: before, behind

    before = projection%segment
    behind = surface%next(projection%segment)
    if (projection%xi < 0.5_wp) then
      before = surface%previous(projection%segment)
      behind = projection%segment
    end if
    goes_on = min(before, behind) == 0
    if (.not. goes_on) goes_on = turns_gently(vector_of(surface, polyline, before), &
      vector_of(surface, polyline, behind))
  end function goes_on

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
        if (.not. looks_against(own, local%t)) cycle
      end if
      least = square
      closest = m
    end do
  end function closest_candidate

  !> Whether two segments are opposed: their vectors have the cosine of their normals.
  pure function looks_against(own, other) result(opposed)
    real(wp), intent(in) :: own(2), other(2) !! m
    logical :: opposed
    real(wp) :: product

    product = own(1)*other(1) + own(2)*other(2)
    opposed = product < 0.0_wp .and. product*product > side_on**2*((own(1)*own(1) &
      + own(2)*own(2))*(other(1)*other(1) + other(2)*other(2)))
  end function looks_against

  !> Let overlaps of closed boundaries with the side next to a convex vertex count less, or not, on
  !> the slave as on the master.
  pure subroutine weigh_sides(contact, memory, own, overlaps)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    type(overlap_t), intent(inout) :: overlaps(:)
    integer :: k

    do k = 1, size(overlaps)
      if (.not. overlaps(k)%share > 0.0_wp) cycle
      overlaps(k)%part = sides_part(contact, memory, own%number, overlaps(k)%master)
      overlaps(k)%share = overlaps(k)%share*overlaps(k)%part
    end do
  end subroutine weigh_sides

  !> How much of a slave segment counts opposite to a master segment, 0 to 1, where either may be
  !> the side next to a convex vertex of a closed boundary.
  pure function sides_part(contact, memory, s, m) result(part)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, m !! slave and master segment
    real(wp) :: part

    associate (master => memory%positions(:, memory%n_slave + 1:))
      part = side_part(contact%slave, memory%positions, s, vector_of(contact%master, master, m), &
        slave_side)
      if (part > 0.0_wp) part = part*side_part(contact%master, master, m, &
        vector_of(contact%slave, memory%positions, s), master_side)
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

  !> Whether a slave segment is opposed to the face that one of its ends is active on.
  pure function is_opposed_to_contact(memory, own) result(opposed)
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    logical :: opposed
    integer :: k

    opposed = .false.
    do k = 1, 2
      if (.not. own%is_active(k)) cycle
      associate (normal => memory%slave_status%normal(:, own%ends(k)))
        opposed = opposed .or. own%t(2)*normal(1) - own%t(1)*normal(2) < side_on*sqrt(own%square)
      end associate
    end do
  end function is_opposed_to_contact

  !> Whether a master segment lies beyond the projection of an end of the slave segment: the slave
  !> runs against the master, so that its first end is followed by what comes before.
  pure function is_beyond(master, below, segment, n_most) result(beyond)
    type(surface_t), intent(in) :: master
    integer, intent(in) :: below(2) !! below the first end and the second, 0: none
    integer, intent(in) :: segment
    integer, intent(in) :: n_most     !! steps along the surface
    logical :: beyond
    integer :: k, up, down, i

    beyond = .false.
    do k = 1, 2
      if (below(k) == 0 .or. below(k) == segment) cycle
      if (master%chain(below(k)) /= master%chain(segment)) cycle
      up = below(k)
      down = below(k)
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
  pure subroutine clip(master, memory, own, m, overlap)
    type(surface_t), intent(in) :: master
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    integer, intent(in) :: m
    type(overlap_t), intent(inout) :: overlap
    real(wp) :: d(2, 2), xi(2), gaps(2)
    integer :: nodes(2), k

    overlap%low = 0.0_wp
    overlap%high = 0.0_wp
    nodes = [master%segments(2, m), master%segments(1, m)]
    do k = 1, 2
      d(:, k) = way_to(memory%n_slave + nodes(k), own, memory%positions)
      xi(k) = (d(1, k)*own%t(1) + d(2, k)*own%t(2))/own%square
    end do
    ! Most candidates lie beyond an end.
    if (.not. any(own%below == m) .and. (xi(2) <= own%margins(1) &
      .or. xi(1) >= 1.0_wp - own%margins(2))) return
    if (.not. looks_against(own%t, d(:, 1) - d(:, 2))) return
    gaps = (d(1, :)*own%t(2) - d(2, :)*own%t(1))/sqrt(own%square)
    overlap%master = m
    overlap%low = merge(0.0_wp, min(xi(1), 1.0_wp), xi(1) <= own%margins(1))
    overlap%high = merge(1.0_wp, max(xi(2), 0.0_wp), xi(2) >= 1.0_wp - own%margins(2))
    overlap%first = merge(nodes(1), 0, overlap%low > 0.0_wp .and. overlap%low < 1.0_wp)
    overlap%last = merge(nodes(2), 0, overlap%high > 0.0_wp .and. overlap%high < 1.0_wp)
    if (own%below(1) == m) then
      overlap%low = 0.0_wp
      overlap%first = 0
    else if (own%below(1) > 0 .and. abs(xi(1)) <= near_node) then
      ! A corner right below an end that is active on another body has a point of its own.
      if (master%next(m) /= own%below(1)) overlap%first = nodes(1)
    end if
    if (own%below(2) == m) then
      overlap%high = 1.0_wp
      overlap%last = 0
    else if (own%below(2) > 0 .and. abs(xi(2) - 1.0_wp) <= near_node) then
      if (master%previous(m) /= own%below(2)) overlap%last = nodes(2)
    end if
    if (overlap%high <= own%margins(1) .or. overlap%low >= 1.0_wp - own%margins(2)) &
      overlap%high = overlap%low
    overlap%gap = 0.0_wp
    if (abs(xi(2) - xi(1)) > round_off) overlap%gap = gaps(1) + (gaps(2) - gaps(1)) &
      *([0.0_wp, 1.0_wp] - xi(1))/(xi(2) - xi(1))
    overlap%share = share_of(own, d(:, 1) - d(:, 2))
    overlap%part = 1.0_wp
  end subroutine clip

  !> How much of an overlap counts: all up to a certain angle between the two segments, none from a
  !> larger one on.
  pure function share_of(own, other) result(share)
    type(slave_segment_t), intent(in) :: own
    real(wp), intent(in) :: other(2) !! vector of the master segment, m
    real(wp) :: share
    real(wp) :: product, squares

    product = own%t(1)*other(1) + own%t(2)*other(2)
    squares = own%square*(other(1)**2 + other(2)**2)
    share = 1.0_wp
    if (product < 0.0_wp .and. product*product >= face_on**2*squares) return
    share = opposed_share(product/sqrt(max(squares, tiny(1.0_wp))))
  end function share_of

end module overlaps_m
