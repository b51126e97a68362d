! SPDX-License-Identifier: MIT
!> Status of slave segments whose overlaps make contact points between the slave nodes: what may
!> begin, and which segments are not due (doc/theory/contact.md, sections 3.3 and 4).
module overlap_status_m
  use contact_state_m, only : contact_state_t, contact_points_t, separated, active
  use contacts_m, only : contact_t
  use geometry_m, only : separation
  use kinds_m, only : wp
  use projection_m, only : side_on
  implicit none
  private
  public :: none_due, search_segments, update_segment_states, note_earliest_search

  !> Motion by which two segments turn by a small angle together, as a part of that angle times the
  !> product of their lengths over the sum; a little less, as they may get shorter.
  real(wp), parameter :: way_of_turn = 0.9_wp

contains

  !> Whether no slave segment can touch yet.
  pure function none_due(memory)
    type(contact_state_t), intent(in) :: memory
    logical :: none_due

    none_due = memory%slave_status%n_active == 0 &
      .and. memory%travel + memory%closed_gap < memory%earliest_segment_search
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

    travel = memory%travel + memory%closed_gap
    do s = first, last
      associate (state => memory%slave_status%state, ends => contact%slave%segments(:, s), &
        is_due => memory%scratch%has_points(s))
        is_due = state(ends(1)) == active .or. state(ends(2)) == active
        if (is_due .or. travel < memory%segment_search(s)) cycle
        call search_row(contact, memory, s, distance, is_due)
        is_due = is_due .or. distance < memory%closed_gap
        memory%segment_search(s) = memory%travel + distance
        if (is_due) cycle
        memory%segment_state(s) = separated
        memory%segment_gap(s) = distance
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
    real(wp) :: deepest, limit
    integer :: first, last, s, p
    logical :: has_active_end

    last = n_before
    do s = range(1), range(2)
      if (.not. memory%scratch%has_points(s)) cycle
      associate (ends => contact%slave%segments(:, s))
        first = last + 1
        deepest = huge(1.0_wp)
        p = 0
        do last = first, points%n
          if (points%slave_nodes(1, last) /= ends(1)) exit
          if (.not. points%area(last) > 0.0_wp .or. points%gap(last) >= deepest) cycle
          deepest = points%gap(last)
          p = last
        end do
        last = last - 1
        has_active_end = memory%slave_status%state(ends(1)) == active &
          .or. memory%slave_status%state(ends(2)) == active
        limit = huge(1.0_wp)
        if (.not. has_active_end .and. p > 0) &
          limit = deepest_first_contact(contact, memory, ends, points%master_nodes(:, p))
        call update_segment(memory, s, ends, has_active_end, deepest, limit, n_released)
        if (has_active_end) cycle
        if (.not. deepest < memory%closed_gap) memory%scratch%has_points(s) = .false.
        if (memory%segment_state(s) == separated) points%area(first:last) = 0.0_wp
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

    associate (state => memory%segment_state(segment), next_search => &
      memory%segment_search(segment))
      if (.not. deepest < memory%closed_gap) then
        state = separated
        if (has_active_end) next_search = memory%travel
      else
        next_search = -huge(1.0_wp)
        if (has_active_end) then
          state = active
        else if (state == separated) then
          call begin_contact(memory, segment, ends, -deepest > limit, state, n_released)
        end if
      end if
    end associate
    memory%segment_gap(segment) = deepest
  end subroutine update_segment

  !> A segment neither end of which is active, behind which points have come: in contact if these
  !> have come through it since the last look, and no deeper than a first contact may be unless the
  !> step is an implicit one.
  pure subroutine begin_contact(memory, segment, ends, is_deeper, state, n_released)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: segment, ends(2)
    logical, intent(in) :: is_deeper !! than a first contact may be
    integer, intent(inout) :: state  !! of the segment
    integer, intent(inout) :: n_released
    logical :: is_new, is_deep

    associate (pass => memory%slave_status%pass)
      is_new = .not. pass%has_history .or. memory%segment_gap(segment) >= 0.0_wp
      is_deep = is_deeper .and. .not. (pass%has_history .and. pass%is_trial)
    end associate
    if (.not. is_new) return
    if (is_deep) then
      ! Ends that have come as deep have been counted.
      if (all(memory%slave_status%gap(ends) >= 0.0_wp)) n_released = n_released + 1
    else
      state = active
    end if
  end subroutine begin_contact

  !> Deepest first contact of a slave segment at a point of it: that of its ends and of the master
  !> segment that the point is on, or of both at its node, m.
  pure function deepest_first_contact(contact, memory, ends, master_nodes) result(depth)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2) !! nodes of the slave segment
    integer, intent(in) :: master_nodes(2) !! of the point
    real(wp) :: depth
    integer :: segments(2), k

    associate (nodes => master_nodes - memory%n_slave)
      segments = [contact%master%outgoing(nodes(1)), contact%master%incoming(nodes(2))]
    end associate
    depth = minval(memory%slave_status%point_depth(ends))
    do k = 1, 2
      if (segments(k) > 0) depth = min(depth, memory%slave_status%segment_depth(segments(k)))
    end do
  end function deepest_first_contact

  !> After the search of all segments. Not needed as long as something is active.
  pure subroutine note_earliest_search(memory)
    type(contact_state_t), intent(inout) :: memory

    memory%earliest_segment_search = -huge(1.0_wp)
    if (memory%slave_status%n_active == 0) &
      memory%earliest_segment_search = minval(memory%segment_search)
  end subroutine note_earliest_search

end module overlap_status_m
