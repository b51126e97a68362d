! SPDX-License-Identifier: MIT
!> Overlaps of a slave segment with master segments. Between two active ends on one surface these
!> are the segments from below the one to below the other; else its candidates that are opposed.
!> The nodes of each master segment are projected on the slave segment and clipped to it; where
!> overlaps of different bodies lie over each other the nearest penetrated one wins
!> (doc/theory/contact.md, section 3.5).
module overlaps_m
  use contact_state_m, only : contact_state_t
  use search_state_m, only : contact_status_t, candidates_t, active
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use projection_m, only : face_on, opposed_share, vector_of, turns_gently, round_off
  use projection_block_m, only : is_straight
  use slave_segments_m, only : slave_segment_t, start_segment, is_opposed_to_contact, sides_part, &
    near_node
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: overlap_t, find_overlaps, n_most_overlaps, room_for_overlaps

  !> Most segments between two active ends that are found without a look at the candidates, and
  !> number of segments of a closed master up to which the way forwards may be the shorter one.
  integer, parameter :: n_between = 6, short_surface = 2*n_between + 2
  !> Deepest middle of an overlap with a master segment that is not reached from an active end of
  !> the slave segment, by the depth of a first contact: deeper ones are the far side of something,
  !> or the back of the own wall.
  real(wp), parameter :: deep = 1.5_wp

  !> One overlap. Without default values, which would be written before each use.
  type :: overlap_t
    integer :: master        !! segment; 0: none
    real(wp) :: low, high    !! range of the slave segment, 0 to 1; not above `low`: empty
    integer :: first, last   !! master nodes at its breakpoints, 0: a slave node
    real(wp) :: gap(2)       !! of the master segment at both ends of the slave segment, m
    real(wp) :: share        !! how much of it counts: 0 where the segments are not opposed
    real(wp) :: part         !! how much of it the sides at vertices leave; in `share` too
  end type overlap_t

  !> A master node on a slave segment. Without default values, too.
  type :: projected_node_t
    integer :: number
    real(wp) :: d(2) !! from the first end of the slave segment, m
    real(wp) :: xi   !! on the slave segment
  end type projected_node_t

contains

  !> Room for the overlaps of a slave segment.
  pure function n_most_overlaps(candidates, s) result(n)
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: s !! slave segment
    integer :: n

    n = max(n_between, 2*(candidates%first(s + 1) - candidates%first(s)) + 1)
  end function n_most_overlaps

  !> Room for the overlaps of any slave segment of a range.
  pure function room_for_overlaps(candidates, first, last) result(n)
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: first, last
    integer :: n
    integer :: s

    n = 0
    do s = first, last
      n = max(n, n_most_overlaps(candidates, s))
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
    integer :: masters(n_between), k

    call start_segment(contact, memory, s, least_part, own)
    n = 0
    if (is_strict .and. any(own%below == 0)) then
      if (.not. is_opposed_to_contact(memory%slave_status, own)) return
      n = 1
      overlaps(1) = overlap_t(0, 0.0_wp, 1.0_wp, 0, 0, [0.0_wp, 0.0_wp], 1.0_wp, 1.0_wp)
      return
    end if
    if (contact%master%n_segment > short_surface .and. all(own%is_active)) then
      call list_between(own, contact%master%previous, masters, n)
      call clip_masters(contact, memory, own, .true., masters(:n), overlaps, n)
    end if
    if (n == 0) then
      ! The candidates from the last on, as the slave runs against the master.
      associate (first => memory%candidates%first(s), last => memory%candidates%first(s + 1) - 1)
        call clip_masters(contact, memory, own, .false., memory%candidates%items(last:first:-1), &
          overlaps, n)
      end associate
    end if
    if (.not. memory%slave_status%pass%is_closed) return
    do k = 1, n
      overlaps(k)%part = sides_part(contact, memory%positions, s, overlaps(k)%master)
      overlaps(k)%share = overlaps(k)%share*overlaps(k)%part
    end do
  end subroutine find_overlaps

  !> The master segments from below one active end to below the other; none where these are too many
  !> or do not follow each other.
  pure subroutine list_between(own, previous, masters, n)
    type(slave_segment_t), intent(in) :: own
    integer, intent(in) :: previous(*) !! master segment before each
    integer, intent(inout) :: masters(n_between)
    integer, intent(out) :: n
    integer :: m

    n = 0
    m = own%below(1)
    do while (m > 0 .and. n < n_between)
      n = n + 1
      masters(n) = m
      if (m == own%below(2)) return
      m = previous(m)
    end do
    n = 0
  end subroutine list_between

  !> Clip master segments to the slave segment and keep those that have an overlap; candidates only
  !> where they may touch. A node in common to two that follow each other is projected once. Between
  !> two active ends there are none where the surface turns sharply.
  pure subroutine clip_masters(contact, memory, own, is_between, masters, overlaps, n)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    logical, intent(in) :: is_between !! the segments are those between two active ends
    integer, intent(in) :: masters(:)
    type(overlap_t), intent(inout) :: overlaps(:)
    integer, intent(out) :: n
    type(projected_node_t) :: from, to
    type(overlap_t) :: new
    integer :: k

    n = 0
    to%number = 0
    do k = 1, size(masters)
      associate (nodes => contact%master%segments(:, masters(k)), overlap => overlaps(n + 1))
        from = to
        if (from%number /= nodes(2)) from = projected_node(nodes(2), own, &
          memory%positions(:, memory%n_slave + 1:))
        to = projected_node(nodes(1), own, memory%positions(:, memory%n_slave + 1:))
        overlap%master = masters(k)
        call clip(contact%master, memory%positions(:, memory%n_slave + 1:), own, from, to, overlap)
        if (.not. overlap%high > overlap%low) cycle
        if (.not. is_between) then
          overlap%gap = gaps_at_ends(own, from, to)
          if (is_beyond(contact%master, memory%positions(:, memory%n_slave + 1:), own, from, to, &
            overlap%master)) cycle
          if (is_far_side(contact, memory, own, overlap)) cycle
        end if
      end associate
      n = n + 1
      if (n == 1) cycle
      if (overlaps(n - 1)%high <= overlaps(n)%low) cycle
      n = n - 1
      if (.not. is_between) then
        new = overlaps(n + 1)
        call insert_overlap(new, overlaps, n)
      else
        n = 0
        return
      end if
    end do
  end subroutine clip_masters

  !> A master node on a slave segment.
  pure function projected_node(node, own, polyline) result(projected)
    integer, intent(in) :: node            !! of the master
    type(slave_segment_t), intent(in) :: own
    real(wp), intent(in) :: polyline(4, *) !! positions of the master nodes
    type(projected_node_t) :: projected

    projected%number = node
    projected%d(1) = (polyline(1, node) - own%start(1)) + (polyline(3, node) - own%start(3))
    projected%d(2) = (polyline(2, node) - own%start(2)) + (polyline(4, node) - own%start(4))
    projected%xi = (projected%d(1)*own%t(1) + projected%d(2)*own%t(2))/own%square
  end function projected_node

  !> The overlap with one master segment; empty where they are not opposed.
  pure subroutine clip(master, polyline, own, from, to, overlap)
    type(surface_t), intent(in) :: master
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_master) positions
    type(slave_segment_t), intent(in) :: own
    type(projected_node_t), intent(in) :: from, to !! second and first node of the master segment
    type(overlap_t), intent(inout) :: overlap
    integer :: m

    m = overlap%master
    overlap%low = 0.0_wp
    overlap%high = 0.0_wp
    ! Most candidates lie beyond an end.
    if (.not. any(own%below == m) .and. (to%xi <= own%margins(1) &
      .or. from%xi >= 1.0_wp - own%margins(2))) return
    overlap%share = share_of(own, from%d - to%d)
    if (.not. overlap%share > 0.0_wp) return
    overlap%part = 1.0_wp
    if (from%xi > own%margins(1)) overlap%low = min(from%xi, 1.0_wp)
    overlap%high = 1.0_wp
    if (to%xi < 1.0_wp - own%margins(2)) overlap%high = max(to%xi, 0.0_wp)
    overlap%first = merge(from%number, 0, overlap%low > 0.0_wp .and. overlap%low < 1.0_wp)
    overlap%last = merge(to%number, 0, overlap%high > 0.0_wp .and. overlap%high < 1.0_wp)
    if (own%below(1) == m) then
      overlap%low = 0.0_wp
      overlap%first = 0
    else if (own%below(1) > 0 .and. abs(from%xi) <= near_node) then
      ! A corner right below an end that is active on another body has a point of its own.
      if (master%next(m) /= own%below(1)) overlap%first = from%number
    else if (from%xi < 0.0_wp .and. is_past_corner(1, master%next(m))) then
      overlap%first = from%number
    end if
    if (own%below(2) == m) then
      overlap%high = 1.0_wp
      overlap%last = 0
    else if (own%below(2) > 0 .and. abs(to%xi - 1.0_wp) <= near_node) then
      if (master%previous(m) /= own%below(2)) overlap%last = to%number
    else if (to%xi > 1.0_wp .and. is_past_corner(2, master%previous(m))) then
      overlap%last = to%number
    end if
    if (overlap%high <= own%margins(1) .or. overlap%low >= 1.0_wp - own%margins(2)) &
      overlap%high = overlap%low

  contains

    !> Whether the k-th end is past a corner, on the next master segment. The node there, which
    !> projects a little beyond the end, has its half: else the end would have all, with the normal
    !> of one face, and the other one as soon as it passes the corner back.
    pure logical function is_past_corner(k, next) result(is)
      integer, intent(in) :: k, next
      real(wp) :: t(2), other(2)

      is = own%is_on_face(k) .and. next == own%below(k)
      if (.not. is) return
      t = from%d - to%d
      other = vector_of(master, polyline, next)
      is = .not. is_straight(dot_product(t, other), sum(t**2), sum(other**2))
    end function is_past_corner

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

  !> Gaps of a master segment at both ends of the slave segment, m.
  pure function gaps_at_ends(own, from, to) result(gaps)
    type(slave_segment_t), intent(in) :: own
    type(projected_node_t), intent(in) :: from, to !! second and first node of the master segment
    real(wp) :: gaps(2)
    real(wp) :: across(2)

    gaps = 0.0_wp
    if (abs(to%xi - from%xi) <= round_off) return
    across = [from%d(1)*own%t(2) - from%d(2)*own%t(1), to%d(1)*own%t(2) - to%d(2)*own%t(1)] &
      /sqrt(own%square)
    gaps = across(1) + (across(2) - across(1))*([0.0_wp, 1.0_wp] - from%xi)/(to%xi - from%xi)
  end function gaps_at_ends

  !> Whether a master segment lies beyond that on which an end of the slave segment has its
  !> projection, on the same surface: the overlap with the latter reaches to the end.
  pure function is_beyond(master, polyline, own, from, to, m) result(beyond)
    type(surface_t), intent(in) :: master
    real(wp), intent(in) :: polyline(4, *) !! positions of its nodes
    type(slave_segment_t), intent(in) :: own
    type(projected_node_t), intent(in) :: from, to !! second and first node of the master segment
    integer, intent(in) :: m
    logical :: beyond
    type(projected_node_t) :: outer
    integer :: k

    beyond = .false.
    do k = 1, 2
      associate (below => own%below(k))
        if (below == 0 .or. below == m) cycle
        if (master%chain(below) /= master%chain(m)) cycle
        outer = projected_node(master%segments(3 - k, below), own, polyline)
        beyond = beyond .or. merge(to%xi <= outer%xi, from%xi >= outer%xi, k == 1)
      end associate
    end do
  end function is_beyond

  !> Whether an overlap is so deep that it is with the far side of something. From the start a
  !> master node may lie deep behind a segment both ends of which are beside it.
  pure function is_far_side(contact, memory, own, overlap)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(slave_segment_t), intent(in) :: own
    type(overlap_t), intent(in) :: overlap
    logical :: is_far_side

    is_far_side = gap_at(overlap, 0.5_wp*(overlap%low + overlap%high)) &
      < -deep*memory%slave_status%segment_depth(overlap%master)
    if (.not. is_far_side) return
    if (any(own%is_active)) then
      is_far_side = .not. (any(own%is_active .and. own%below == overlap%master) &
        .or. is_reached(contact, memory%slave_status, memory%positions(:, memory%n_slave + 1:), &
        own, overlap%master))
    else
      is_far_side = contact%is_self .or. memory%segments%state(own%number) /= active
    end if
  end function is_far_side

  !> Whether a master segment is the one that an end of a slave segment is active on, or follows it
  !> towards the other end without a sharp turn (a surface in contact with itself: the back of the
  !> own wall may follow).
  pure function is_reached(contact, status, polyline, own, m) result(reached)
    type(contact_t), intent(in) :: contact
    type(contact_status_t), intent(in) :: status       !! of the slave nodes
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_master) positions
    type(slave_segment_t), intent(in) :: own
    integer, intent(in) :: m
    logical :: reached
    integer :: k, i, segment, next

    reached = .false.
    associate (master => contact%master)
      do k = 1, 2
        if (.not. own%is_active(k)) cycle
        segment = status%segment(own%ends(k))
        do i = 1, master%n_segment
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

  !> Insert an overlap in a list of overlaps in order along the slave segment. Of two that lie over
  !> each other the nearest penetrated one keeps the stretch in common.
  pure recursive subroutine insert_overlap(new, overlaps, n)
    type(overlap_t), intent(in) :: new
    type(overlap_t), intent(inout) :: overlaps(:)
    integer, intent(inout) :: n
    type(overlap_t) :: old
    integer :: k, i

    k = n
    do while (k >= 1)
      if (overlaps(k)%high <= new%low) exit
      if (overlaps(k)%low < new%high) then
        old = overlaps(k)
        if (is_nearer(new, old)) then
          n = n - 1
          do i = k, n
            overlaps(i) = overlaps(i + 1)
          end do
          call insert_overlap(new, overlaps, n)
          call insert_remains(old, new, overlaps, n)
        else
          call insert_remains(new, old, overlaps, n)
        end if
        return
      end if
      k = k - 1
    end do
    do i = n, k + 1, -1
      overlaps(i + 1) = overlaps(i)
    end do
    overlaps(k + 1) = new
    n = n + 1
  end subroutine insert_overlap

  !> Insert what an overlap has on both sides of another one.
  pure recursive subroutine insert_remains(overlap, other, overlaps, n)
    type(overlap_t), intent(in) :: overlap, other
    type(overlap_t), intent(inout) :: overlaps(:)
    integer, intent(inout) :: n
    type(overlap_t) :: part

    part = overlap
    part%high = other%low
    part%last = other%first
    if (part%high > part%low) call insert_overlap(part, overlaps, n)
    part = overlap
    part%low = other%high
    part%first = other%last
    if (part%high > part%low) call insert_overlap(part, overlaps, n)
  end subroutine insert_remains

  !> Whether an overlap is the nearest penetrated one of two where they lie over each other, or the
  !> nearest if none is.
  pure function is_nearer(one, other)
    type(overlap_t), intent(in) :: one, other
    logical :: is_nearer
    real(wp) :: middle, gaps(2)

    middle = 0.5_wp*(max(one%low, other%low) + min(one%high, other%high))
    gaps = [gap_at(one, middle), gap_at(other, middle)]
    is_nearer = gaps(1) < gaps(2)
    if (maxval(gaps) < 0.0_wp) is_nearer = gaps(1) > gaps(2)
  end function is_nearer

  !> Gap of the master segment over the slave segment at a local coordinate of that, m.
  pure function gap_at(overlap, xi) result(gap)
    type(overlap_t), intent(in) :: overlap
    real(wp), intent(in) :: xi
    real(wp) :: gap

    gap = (1.0_wp - xi)*overlap%gap(1) + xi*overlap%gap(2)
  end function gap_at

end module overlaps_m
