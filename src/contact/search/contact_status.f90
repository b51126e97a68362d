! SPDX-License-Identifier: MIT
!> Status of contact points over the segments of the other surface. An active point is followed from
!> its segment; a separated one is searched among its candidate pairs once it can have come near
!> (doc/theory/contact.md, sections 3 and 4).
module contact_status_m
  use search_state_m, only : contact_status_t, candidates_t, pass_t, separated, active
  use entry_m, only : found_contact_t, find_contact, is_pair, is_opposed, contact_gap
  use projection_m, only : projection_t, follow_contact, gentle_turn
  use projection_block_m, only : projection_block_t, n_block, project_block, resolve_ambiguous
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: update_status, list_active, reset_status

contains

  !> Bring the status of all points up to date and list the active ones.
  pure subroutine update_status(status, own, other, pairs, positions, increments, points)
    type(contact_status_t), intent(inout) :: status
    type(surface_t), intent(in) :: own                  !! of the points
    type(surface_t), intent(in) :: other                !! of the segments
    type(candidates_t), intent(in) :: pairs             !! of the segments of `own`
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    real(wp), intent(in), contiguous :: increments(:, :) !! (2, n_node) displacements of the step, m
    real(wp), intent(in), contiguous :: points(:, :)    !! (4, n) positions of the points
    real(wp) :: travel
    integer :: n_due, k
    logical :: was_active, has_changed

    n_due = 0
    if (status%n_active > 0) call follow_active(status, other, &
      positions(:, status%pass%other_at + 1:), points, n_due)
    ! Distances are to segments; contact begins at the closed gap.
    travel = status%pass%travel + status%pass%closed_gap + status%pass%highest
    if (.not. travel < status%earliest_search) call list_due(status%n, status%next_search, travel, &
      status%earliest_search, status%due, n_due)
    has_changed = .false.
    do k = 1, n_due
      associate (i => status%due(k))
        was_active = status%state(i) == active
        if (was_active) call follow_point(status, own, other, pairs, positions, points(:, i), i)
        if (status%state(i) /= active) call store_found(status, i, find_contact(status, own, &
          other, pairs, positions, increments, points(:, i), i))
        has_changed = has_changed .or. (status%state(i) == active .neqv. was_active)
        status%earliest_search = min(status%earliest_search, status%next_search(i))
      end associate
    end do
    if (has_changed) call list_active(status)
  end subroutine update_status

  !> Append the points whose next search time has come, and find the first one of the others. That
  !> of active points never comes.
  pure subroutine list_due(n, next_search, travel, earliest_search, due, n_due)
    integer, intent(in) :: n
    real(wp), intent(in) :: next_search(n), travel
    real(wp), intent(out) :: earliest_search
    integer, intent(inout) :: due(*), n_due
    integer :: i

    earliest_search = huge(1.0_wp)
    do i = 1, n
      if (travel < next_search(i)) then
        earliest_search = min(earliest_search, next_search(i))
      else
        n_due = n_due + 1
        due(n_due) = i
      end if
    end do
  end subroutine list_due

  !> The common case of active points: still over their segment, behind it, and no nearer to a
  !> neighbour than to it. The others are listed in `due`.
  pure subroutine follow_active(status, surface, polyline, points, n_left)
    type(contact_status_t), intent(inout) :: status
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :), points(:, :)
    integer, intent(out) :: n_left    !! points that were not kept
    type(projection_block_t) :: block
    integer :: first, i, k

    n_left = 0
    do first = 1, status%n_active, n_block
      block%n = min(n_block, status%n_active - first + 1)
      call vectors_to_points(block%n, status%active_points(first), status%segment, &
        surface%segments, polyline, points, block%segment, block%t, block%d)
      call project_block(block)
      if (block%n_ambiguous > 0) call resolve_ambiguous(surface, polyline, block)
      if (block%n_ambiguous > 0 .and. status%pass%has_arcs) &
        call keep_in_front(status%pass, status%active_points(first:), block)
      i = status%active_points(first)
      if (status%active_points(first + block%n - 1) == i + block%n - 1) then
        call store_projections(block%n, block%xi, block%gap, block%normal, status%xi(i), &
          status%gap(i), status%normal(1, i))
      else
        do k = 1, block%n
          i = status%active_points(first + k - 1)
          status%xi(i) = block%xi(k)
          status%gap(i) = block%gap(k)
          status%normal(:, i) = block%normal(:, k)
        end do
      end if
      if (block%n_ambiguous > 0) call list_ambiguous(block%n, block%ambiguous, &
        status%active_points(first), status%due, n_left)
    end do
  end subroutine follow_active

  !> Points in front of their segments, in contact between arcs, stay as those behind do: no
  !> neighbour is nearer.
  pure subroutine keep_in_front(pass, points, block)
    type(pass_t), intent(in) :: pass
    integer, intent(in), contiguous :: points(:) !! at least those of the block
    type(projection_block_t), intent(inout) :: block
    real(wp) :: to_end
    integer :: k

    do k = 1, block%n
      if (.not. block%ambiguous(k) > 0.0_wp .or. block%gap(k) < 0.0_wp) cycle
      to_end = 0.5_wp - abs(block%xi(k) - 0.5_wp)
      if (to_end < 0.0_wp .or. block%gap(k)**2 > to_end**2*(block%t(1, k)**2 + block%t(2, k)**2)) &
        cycle
      if (block%gap(k) < contact_gap(pass, points(k), block%segment(k))) block%ambiguous(k) = 0.0_wp
    end do
    block%n_ambiguous = count(block%ambiguous(:block%n) > 0.0_wp)
  end subroutine keep_in_front

  !> Append the points of a block that need a decision.
  pure subroutine list_ambiguous(n, ambiguous, points, due, n_due)
    integer, intent(in) :: n, points(n)
    real(wp), intent(in) :: ambiguous(n)
    integer, intent(inout) :: due(*), n_due
    integer :: k

    do k = 1, n
      if (.not. ambiguous(k) > 0.0_wp) cycle
      n_due = n_due + 1
      due(n_due) = points(k)
    end do
  end subroutine list_ambiguous

  !> Vectors of a block of points.
  pure subroutine vectors_to_points(n, active, segment, ends, polyline, points, on, t, d)
    integer, intent(in) :: n, active(n), segment(*), ends(2, *)
    real(wp), intent(in) :: polyline(4, *), points(4, *)
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
      along = polyline(:, b) - polyline(:, a)
      across = points(:, i) - polyline(:, a)
      t(:, k) = along(1:2) + along(3:4)
      d(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine vectors_to_points

  !> Store the projections of points that follow each other.
  pure subroutine store_projections(n, xi, gap, normal, kept_xi, kept_gap, kept_normal)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(n), gap(n), normal(2, n)
    real(wp), intent(inout) :: kept_xi(n), kept_gap(n), kept_normal(2, n)

    kept_xi = xi
    kept_gap = gap
    kept_normal = normal
  end subroutine store_projections

  !> An active point that needs a decision: it stays on its face until that ends. Across a sharp
  !> vertex it moves on only where the next face is opposed to it.
  pure subroutine follow_point(status, own, other, pairs, positions, point, i)
    type(contact_status_t), intent(inout) :: status
    type(surface_t), intent(in) :: own, other
    type(candidates_t), intent(in) :: pairs
    real(wp), intent(in), contiguous :: positions(:, :)
    real(wp), intent(in) :: point(4)
    integer, intent(in) :: i
    type(projection_t) :: projection
    logical :: stays

    projection = follow_contact(other, positions(:, status%pass%other_at + 1:), point, &
      status%segment(i))
    stays = projection%is_on .and. projection%gap < contact_gap(status%pass, i, projection%segment)
    if (stays .and. dot_product(projection%normal, status%normal(:, i)) < gentle_turn) &
      stays = is_opposed(status%pass, own, positions, i, projection%normal)
    if (stays .and. status%pass%is_self) &
      stays = is_pair(status%pass, own, pairs, i, projection%segment)
    if (stays) then
      call store_projection(status, i, projection)
    else
      status%state(i) = separated
      if (.not. status%pass%is_trial) status%offset(i) = 0.0_wp
    end if
  end subroutine follow_point

  !> A separated point: it becomes active, or has a next search time.
  pure subroutine store_found(status, i, found)
    type(contact_status_t), intent(inout) :: status
    integer, intent(in) :: i
    type(found_contact_t), intent(in) :: found

    call store_projection(status, i, found%projection)
    if (found%is_released) status%n_released = status%n_released + 1
    if (found%is_active .or. .not. status%pass%is_trial) status%offset(i) = found%offset
    status%has_offset = status%has_offset .or. found%offset > 0.0_wp
    if (found%is_active) then
      status%faded(i) = -found%offset
      status%state(i) = active
      status%next_search(i) = huge(1.0_wp)
    else
      status%state(i) = separated
      status%next_search(i) = status%pass%travel + found%distance
    end if
  end subroutine store_found

  !> Keep a projection.
  pure subroutine store_projection(status, i, projection)
    type(contact_status_t), intent(inout) :: status
    integer, intent(in) :: i
    type(projection_t), intent(in) :: projection

    status%segment(i) = projection%segment
    status%xi(i) = projection%xi
    status%gap(i) = projection%gap
    status%normal(:, i) = projection%normal
  end subroutine store_projection

  !> Start anew: all points are separated and due in the next call.
  pure subroutine reset_status(status)
    type(contact_status_t), intent(inout) :: status

    if (status%n == 0) return
    status%segment = 0
    status%n_active = 0
    status%state = separated
    status%offset = 0.0_wp
    status%has_offset = .false.
    status%next_search = -huge(1.0_wp)
    status%earliest_search = -huge(1.0_wp)
  end subroutine reset_status

  !> List the active points anew.
  pure subroutine list_active(status)
    type(contact_status_t), intent(inout) :: status
    integer :: i

    status%n_active = 0
    do i = 1, status%n
      if (status%state(i) /= active) cycle
      status%n_active = status%n_active + 1
      status%active_points(status%n_active) = i
    end do
  end subroutine list_active

end module contact_status_m
