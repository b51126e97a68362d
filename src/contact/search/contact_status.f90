! SPDX-License-Identifier: MIT
!> Status of contact points over the segments of the other surface. An active point is followed from
!> its segment; a separated one is looked for among its candidate pairs once it can have come near
!> (doc/theory/contact.md, sections 3 and 4).
module contact_status_m
  use contact_state_m, only : tracking_t, candidates_t, is_free, is_touching
  use entry_m, only : found_contact_t, find_contact, is_pair, is_opposed
  use foot_m, only : foot_t, follow_contact, gentle_turn
  use foot_block_m, only : foot_block_t, n_block, project_block, settle_odd
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: update_status, list_touching, measure_depths, forget_pairs

contains

  !> Bring the status of all points up to date and list the active ones.
  pure subroutine update_status(tracking, own, other, pairs, places, increments, points)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: own                  !! of the points
    type(surface_t), intent(in) :: other                !! of the segments
    type(candidates_t), intent(in) :: pairs             !! of the segments of `own`
    real(wp), intent(in), contiguous :: places(:, :)    !! (4, n_node) of the interface
    real(wp), intent(in), contiguous :: increments(:, :) !! (2, n_node) displacements of the step, m
    real(wp), intent(in), contiguous :: points(:, :)    !! (4, n) positions of the points
    real(wp) :: travel
    integer :: n_left, n_due, i, k
    logical :: has_changed, was_active

    n_left = 0
    if (tracking%n_touching > 0) call keep_contacts(tracking, other, &
      places(:, tracking%pass%other_at + 1:), points, n_left)
    ! Distances are to segments; contact begins at the closed gap.
    travel = tracking%pass%travel + tracking%pass%closed_gap
    if (n_left == 0 .and. travel < tracking%next_wake) return
    n_due = n_left
    if (.not. travel < tracking%next_wake) call list_due(tracking%n, tracking%wake, travel, &
      tracking%next_wake, tracking%due, n_due)
    has_changed = .false.
    do k = 1, n_due
      i = tracking%due(k)
      was_active = tracking%status(i) == is_touching
      if (was_active) call follow_point(tracking, own, other, pairs, places, points(:, i), i)
      if (tracking%status(i) /= is_touching) &
        call look_at_point(tracking, own, other, pairs, places, increments, points(:, i), i)
      has_changed = has_changed .or. (tracking%status(i) == is_touching .neqv. was_active)
      tracking%next_wake = min(tracking%next_wake, tracking%wake(i))
    end do
    if (has_changed) call list_touching(tracking)
  end subroutine update_status

  !> Append the points whose next search time has come, and find the first one of the others. That
  !> of active points never comes.
  pure subroutine list_due(n, wake, travel, next_wake, due, n_due)
    integer, intent(in) :: n
    real(wp), intent(in) :: wake(n), travel
    real(wp), intent(out) :: next_wake
    integer, intent(inout) :: due(*), n_due
    integer :: i

    next_wake = huge(1.0_wp)
    do i = 1, n
      if (travel < wake(i)) then
        next_wake = min(next_wake, wake(i))
      else
        n_due = n_due + 1
        due(n_due) = i
      end if
    end do
  end subroutine list_due

  !> The common case of active points: still over their segment, behind it, and no nearer to a
  !> neighbour than to it. The others are listed in `due`.
  pure subroutine keep_contacts(tracking, surface, chain, points, n_left)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), points(:, :)
    integer, intent(out) :: n_left    !! points that were not kept
    type(foot_block_t) :: block
    integer :: first, i, k

    n_left = 0
    do first = 1, tracking%n_touching, n_block
      block%n = min(n_block, tracking%n_touching - first + 1)
      call see_points(block%n, tracking%touching(first), tracking%segment, surface%segments, &
        chain, points, block%segment, block%t, block%d)
      call project_block(block)
      if (block%n_odd > 0) call settle_odd(surface, chain, block)
      i = tracking%touching(first)
      if (tracking%touching(first + block%n - 1) == i + block%n - 1) then
        call store_row(block%n, block%xi, block%gap, block%normal, tracking%xi(i), &
          tracking%gap(i), tracking%normal(1, i))
      else
        do k = 1, block%n
          i = tracking%touching(first + k - 1)
          tracking%xi(i) = block%xi(k)
          tracking%gap(i) = block%gap(k)
          tracking%normal(:, i) = block%normal(:, k)
        end do
      end if
      if (block%n_odd > 0) call list_odd(block%n, block%odd, tracking%touching(first), &
        tracking%due, n_left)
    end do
  end subroutine keep_contacts

  !> Append the points of a block that need a decision.
  pure subroutine list_odd(n, odd, points, due, n_due)
    integer, intent(in) :: n, points(n)
    real(wp), intent(in) :: odd(n)
    integer, intent(inout) :: due(*), n_due
    integer :: k

    do k = 1, n
      if (.not. odd(k) > 0.0_wp) cycle
      n_due = n_due + 1
      due(n_due) = points(k)
    end do
  end subroutine list_odd

  !> Vectors of a block of points.
  pure subroutine see_points(n, active, segment, ends, chain, points, on, t, d)
    integer, intent(in) :: n, active(n), segment(*), ends(2, *)
    real(wp), intent(in) :: chain(4, *), points(4, *)
    integer, intent(inout) :: on(n)      !! their segments
    real(wp), intent(inout) :: t(2, n)   !! these, m
    real(wp), intent(inout) :: d(2, n)   !! from the segments' first nodes, m
    real(wp), dimension(4) :: along, across
    integer :: i, k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      i = active(k)
      on(k) = segment(i)
      a = ends(1, segment(i))
      b = ends(2, segment(i))
      along = chain(:, b) - chain(:, a)
      across = points(:, i) - chain(:, a)
      t(:, k) = along(1:2) + along(3:4)
      d(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine see_points

  !> Store the projections of points that follow each other.
  pure subroutine store_row(n, xi, gap, normal, kept_xi, kept_gap, kept_normal)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(n), gap(n), normal(2, n)
    real(wp), intent(inout) :: kept_xi(n), kept_gap(n), kept_normal(2, n)

    kept_xi = xi
    kept_gap = gap
    kept_normal = normal
  end subroutine store_row

  !> An active point that needs a decision: it stays on its face until that ends. Across a sharp
  !> vertex it goes on only where the next face is opposed to it.
  pure subroutine follow_point(tracking, own, other, pairs, places, point, i)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: own, other
    type(candidates_t), intent(in) :: pairs
    real(wp), intent(in), contiguous :: places(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: i
    type(foot_t) :: foot
    logical :: stays

    foot = follow_contact(other, places(:, tracking%pass%other_at + 1:), point, tracking%segment(i))
    stays = foot%is_on .and. foot%gap < tracking%pass%closed_gap
    if (stays .and. dot_product(foot%normal, tracking%normal(:, i)) < gentle_turn) &
      stays = is_opposed(tracking%pass, own, places, i, foot%normal)
    if (stays .and. tracking%pass%is_self) &
      stays = is_pair(tracking%pass, own, pairs, i, foot%segment)
    if (stays) then
      call store_foot(tracking, i, foot)
    else
      tracking%status(i) = is_free
      if (.not. tracking%pass%is_trial) tracking%offset(i) = 0.0_wp
    end if
  end subroutine follow_point

  !> A separated point: it becomes active, or has a next search time.
  pure subroutine look_at_point(tracking, own, other, pairs, places, increments, point, i)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: own, other
    type(candidates_t), intent(in) :: pairs
    real(wp), intent(in), contiguous :: places(:, :), increments(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: i
    type(found_contact_t) :: found

    found = find_contact(tracking, own, other, pairs, places, increments, point, i)
    call store_foot(tracking, i, found%foot)
    if (found%is_released) tracking%n_released = tracking%n_released + 1
    if (found%is_active .or. .not. tracking%pass%is_trial) tracking%offset(i) = found%offset
    tracking%has_offset = tracking%has_offset .or. found%offset > 0.0_wp
    if (found%is_active) then
      tracking%status(i) = is_touching
      tracking%wake(i) = huge(1.0_wp)
    else
      tracking%status(i) = is_free
      tracking%wake(i) = tracking%pass%travel + found%distance
    end if
  end subroutine look_at_point

  !> Keep a projection.
  pure subroutine store_foot(tracking, i, foot)
    type(tracking_t), intent(inout) :: tracking
    integer, intent(in) :: i
    type(foot_t), intent(in) :: foot

    tracking%segment(i) = foot%segment
    tracking%xi(i) = foot%xi
    tracking%gap(i) = foot%gap
    tracking%normal(:, i) = foot%normal
  end subroutine store_foot

  !> Largest and smallest depth of first contacts.
  pure subroutine measure_depths(tracking)
    type(tracking_t), intent(inout) :: tracking

    if (allocated(tracking%segment_depth)) tracking%deepest = maxval([0.0_wp, &
      tracking%segment_depth], mask=[0.0_wp, tracking%segment_depth] < huge(1.0_wp))
    if (allocated(tracking%spot_depth)) tracking%shallowest = minval([tracking%spot_depth, &
      tracking%segment_depth])
  end subroutine measure_depths

  !> Start anew: all points are separated and looked at in the next call.
  pure subroutine forget_pairs(tracking)
    type(tracking_t), intent(inout) :: tracking

    if (tracking%n == 0) return
    tracking%segment = 0
    tracking%n_touching = 0
    tracking%status = is_free
    tracking%offset = 0.0_wp
    tracking%has_offset = .false.
    tracking%wake = -huge(1.0_wp)
    tracking%next_wake = -huge(1.0_wp)
  end subroutine forget_pairs

  !> List the active points anew.
  pure subroutine list_touching(tracking)
    type(tracking_t), intent(inout) :: tracking
    integer :: i

    tracking%n_touching = 0
    do i = 1, tracking%n
      if (tracking%status(i) /= is_touching) cycle
      tracking%n_touching = tracking%n_touching + 1
      tracking%touching(tracking%n_touching) = i
    end do
  end subroutine list_touching

end module contact_status_m
