! SPDX-License-Identifier: MIT
!> Which spot is on which segment: tracked from step to step, searched globally where tracking could
!> miss something, asleep where nothing can touch (doc/theory/contact.md, section 4).
module contact_search_m
  use contact_buckets_m, only : nearest_t, fill_grid, slip_limit, box_distance, find_nearest
  use contact_keeping_m, only : keep_contacts, keep_points, move_points, take_feet
  use contact_lists_m, only : list_touching, list_waking
  use contact_projection_m, only : foot_t, see_segment, closest_foot, follow_contact, &
    walk_to_closest, is_over_segment, turns_gently, end_tolerance, &
    side_on
  use contact_state_m, only : contact_points_t, tracking_t, is_free, is_in_front, is_touching, &
    is_behind
  use geometry_m, only : sight_t, separation
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: update_tracking, wake_all, most_facing, begin_contact

contains

  !> Bring the pairs of all spots up to date and list the spots in contact. Where the list of points
  !> is given, the feet of spots whose points stand on it are brought up to date there, and not in
  !> the tracking.
  pure subroutine update_tracking(tracking, surface, chain, spots, travel, n_released, offset, &
      points)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface            !! the chain tracked upon
    real(wp), intent(in), contiguous :: chain(:, :)   !! (4, n_node) places of its nodes
    real(wp), intent(in), contiguous :: spots(:, :)   !! (4, n) places of the spots
    real(wp), intent(in) :: travel                    !! relative motion since the start, m
    integer, intent(inout) :: n_released              !! deep first contacts let go
    integer, intent(in), optional :: offset           !! local number before the chain's first node
    type(contact_points_t), intent(inout), optional :: points
    integer :: n_left
    logical :: has_changed

    tracking%has_feet = .true.
    if (tracking%n_touching == 0 .and. travel < tracking%next_wake) return
    if (present(points)) tracking%has_feet = tracking%first_point == 0
    if (tracking%has_feet) then
      call keep_contacts(surface%segments, chain, spots, tracking, n_left)
    else
      call keep_points(offset, chain, spots, tracking, points, n_left)
    end if
    if (n_left == 0 .and. travel < tracking%next_wake) return
    call update_others(tracking, surface, chain, spots, travel, n_left, n_released, has_changed)
    if (.not. tracking%has_feet) then
      if (has_changed) then
        call take_feet(points, n_left, tracking)
      else
        call move_points(offset, surface%segments, n_left, tracking, points)
      end if
    end if
    if (has_changed) call list_touching(tracking)
  end subroutine update_tracking

  !> Spots that were not kept; and those that are not in contact, if any of them is due.
  pure subroutine update_others(tracking, surface, chain, spots, travel, n_left, n_released, &
      has_changed)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    real(wp), intent(in) :: travel
    integer, intent(in) :: n_left
    integer, intent(inout) :: n_released
    logical, intent(out) :: has_changed !! the list of spots in contact
    integer :: i, k, n_due

    n_due = n_left
    if (.not. travel < tracking%next_wake) call list_waking(tracking%n_touching, &
      tracking%touching, tracking%n, tracking%wake, travel, tracking%next_wake, tracking%due, n_due)
    has_changed = .false.
    do k = 1, n_due
      i = tracking%due(k)
      if (k <= n_left) i = tracking%touching(i)
      call update_spot(tracking, surface, chain, spots, i, travel, n_released)
      has_changed = has_changed .or. (tracking%status(i) == is_touching .neqv. k <= n_left)
      if (tracking%status(i) /= is_touching) tracking%next_wake = &
        min(tracking%next_wake, tracking%wake(i))
    end do
  end subroutine update_others

  !> Any other case, by what the spot was doing.
  pure subroutine update_spot(tracking, surface, chain, spots, i, travel, n_released)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i
    real(wp), intent(in) :: travel
    integer, intent(inout) :: n_released
    type(foot_t) :: foot
    type(sight_t) :: sight

    select case (tracking%status(i))
    case (is_touching)
      foot = follow_contact(surface, chain, spots(:, i), tracking%segment(i))
      if (foot%is_on .and. foot%gap < 0.0_wp) then
        call store_foot(tracking, i, foot)
        return
      end if
    case (is_in_front)
      sight = see_segment(surface, chain, spots(:, i), tracking%segment(i))
      if (sight%across < 0.0_wp .and. is_over_segment(sight)) then
        foot = follow_contact(surface, chain, spots(:, i), tracking%segment(i))
        if (foot%is_on .and. foot%gap < 0.0_wp) then
          call begin_contact(tracking, i, foot, n_released)
          return
        end if
      end if
    case (is_behind)
      foot = closest_foot(surface, chain, spots(:, i), &
        walk_to_closest(surface, chain, spots(:, i), tracking%segment(i)))
      if (foot%is_on .and. foot%gap < 0.0_wp .and. foot%distance <= tracking%reach) then
        call store_foot(tracking, i, foot)
        return
      end if
    end select
    call find_foot(tracking, surface, chain, spots(:, i), i, travel, foot)
    call judge_foot(tracking, surface, chain, spots, i, foot, travel, n_released)
  end subroutine update_spot

  !> Closest foot of a spot that is not in contact: by walking where that is safe, else by the
  !> global search. foot%segment = 0: none within reach.
  pure subroutine find_foot(tracking, surface, chain, spot, i, travel, foot)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: i
    real(wp), intent(in) :: travel
    type(foot_t), intent(out) :: foot
    type(nearest_t) :: nearest
    integer :: segment

    segment = tracking%segment(i)
    if (segment > 0 .and. travel < tracking%recheck(i) .and. tracking%status(i) /= is_touching) then
      if (walk_to_closest(surface, chain, spot, segment) == segment) then
        foot = closest_foot(surface, chain, spot, segment)
        ! Beyond the reach the spot is let go: then other segments have to be known too.
        if (foot%distance <= tracking%reach) return
        foot = foot_t()
      end if
    end if
    if (.not. tracking%grid%cell > 0.0_wp .or. &
      travel - tracking%grid%filled_at > slip_limit(tracking%grid)) &
      call fill_grid(tracking%grid, surface, chain, travel)
    foot%distance = box_distance(tracking%grid, chain, spot, travel)
    if (foot%distance > tracking%reach) return
    call find_nearest(tracking%grid, surface, chain, spot, travel, tracking%reach, nearest)
    foot%distance = nearest%distance
    if (nearest%segment == 0) return
    foot = closest_foot(surface, chain, spot, nearest%segment)
    tracking%recheck(i) = travel + nearest%other
  end subroutine find_foot

  !> Decide what a spot is doing from its closest foot, and when it must be looked at again.
  pure subroutine judge_foot(tracking, surface, chain, spots, i, foot, travel, n_released)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i
    type(foot_t), intent(in) :: foot
    real(wp), intent(in) :: travel
    integer, intent(inout) :: n_released
    integer :: face, n_deep
    logical :: is_new

    if (foot%segment == 0 .or. foot%distance > tracking%reach) then
      tracking%status(i) = is_free
      tracking%segment(i) = 0
      tracking%wake(i) = travel + (foot%distance - tracking%reach)
    else if (foot%is_on .and. foot%gap < 0.0_wp) then
      n_deep = 0
      is_new = tracking%segment(i) == 0
      call begin_contact(tracking, i, foot, n_deep)
      ! What is found behind at first sight is a deep contact only within the first row of elements;
      ! beyond that it may as well be the far side of a body.
      if (.not. is_new .or. -foot%gap < 2.0_wp*tracking%segment_depth(foot%segment)) &
        n_released = n_released + n_deep
    else
      call store_foot(tracking, i, foot)
      face = most_facing(tracking, surface, chain, spots, i, foot, .false.)
      tracking%status(i) = merge(is_in_front, is_free, face > 0)
      if (face > 0) tracking%segment(i) = face
      tracking%wake(i) = min(travel + foot%distance, tracking%recheck(i))
      if (.not. foot%is_on) tracking%wake(i) = -huge(1.0_wp)
    end if
  end subroutine judge_foot

  !> A spot has come behind a face: contact, unless it is deeper than a first contact may be.
  pure subroutine begin_contact(tracking, i, foot, n_released)
    type(tracking_t), intent(inout) :: tracking
    integer, intent(in) :: i
    type(foot_t), intent(in) :: foot
    integer, intent(inout) :: n_released

    call store_foot(tracking, i, foot)
    tracking%wake(i) = -huge(1.0_wp)
    if (-foot%gap <= min(tracking%spot_depth(i), tracking%segment_depth(foot%segment))) then
      tracking%status(i) = is_touching
    else
      tracking%status(i) = is_behind
      n_released = n_released + 1
    end if
  end subroutine begin_contact

  !> Keep a foot.
  pure subroutine store_foot(tracking, i, foot)
    type(tracking_t), intent(inout) :: tracking
    integer, intent(in) :: i
    type(foot_t), intent(in) :: foot

    tracking%segment(i) = foot%segment
    tracking%xi(i) = foot%xi
    tracking%gap(i) = foot%gap
    tracking%normal(:, i) = foot%normal
  end subroutine store_foot

  !> Face that a spot stands before: its own segment, but next to a sharp corner the one that the
  !> spot's own surface faces most, among those it is over. 0 when it stands before none. Without
  !> this a node at a flush edge belongs to the top or to the side of the other body by round-off.
  !> At time zero (`is_start`) faces that the spot is behind count too, and any depth is next to the
  !> corner where the spot's own surface faces the other face only.
  pure function most_facing(tracking, surface, chain, spots, i, foot, is_start) result(face)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i
    type(foot_t), intent(in) :: foot
    logical, intent(in) :: is_start
    integer :: face
    type(sight_t) :: sight, own
    real(wp) :: t(2), facing, best
    integer :: candidates(3), k
    logical :: is_next_to_corner

    candidates = [foot%segment, surface%previous(foot%segment), surface%next(foot%segment)]
    is_next_to_corner = foot%xi <= end_tolerance .or. foot%xi >= 1.0_wp - end_tolerance
    t = separation(spots(:, tracking%chord(2, i)), spots(:, tracking%chord(1, i)))
    face = 0
    best = huge(1.0_wp)
    do k = 1, 3
      if (k > 1 .and. .not. is_next_to_corner) exit
      if (candidates(k) == 0) cycle
      sight = see_segment(surface, chain, spots(:, i), candidates(k))
      facing = dot_product(t, sight%t)/sqrt(sight%square)
      if (k == 1) then
        own = sight
        if (is_start) is_next_to_corner = is_next_to_corner .or. facing >= 0.0_wp
      else if (turns_gently(own, sight)) then
        cycle
      else if (is_start .and. facing > side_on*norm2(t)) then
        cycle
      end if
      if (.not. is_over_segment(sight)) cycle
      if (sight%across < 0.0_wp .and. .not. is_start) cycle
      if (facing >= best) cycle
      best = facing
      face = candidates(k)
    end do
  end function most_facing

  !> Have every spot that is not in contact searched for globally at the next update.
  pure subroutine wake_all(tracking)
    type(tracking_t), intent(inout) :: tracking

    tracking%wake = -huge(1.0_wp)
    tracking%recheck = -huge(1.0_wp)
    tracking%next_wake = -huge(1.0_wp)
  end subroutine wake_all

end module contact_search_m
