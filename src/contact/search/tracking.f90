! SPDX-License-Identifier: MIT
!> Which spot is on which segment: tracked from step to step, searched globally where tracking could
!> miss something, asleep where nothing can touch (doc/theory/contact.md, section 4).
module tracking_m
  use contact_state_m, only : tracking_t, is_free, is_in_front, is_touching, is_behind
  use foot_m, only : foot_t, see_segment, closest_foot, follow_contact, walk_to_closest, &
    is_over_segment, turns_gently, end_tolerance, side_on
  use foot_block_m, only : foot_block_t, n_block, project_block, settle_odd
  use geometry_m, only : sight_t, separation
  use grid_m, only : nearest_t, fill_grid, slip_limit, box_distance, find_nearest
  use kinds_m, only : wp
  use self_search_m, only : find_nearest_other, is_elsewhere, may_meet
  use surfaces_m, only : surface_t
  use waking_m, only : list_waking
  implicit none
  private
  public :: update_tracking, wake_all, forget_pairs, list_touching, most_facing, begin_contact, &
    put_off, measure_depths

contains

  !> Bring the pairs of all spots up to date and list the spots in contact.
  pure subroutine update_tracking(tracking, surface, chain, spots, travel, only_faced, n_released)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface            !! the chain tracked upon
    real(wp), intent(in), contiguous :: chain(:, :)   !! (4, n_node) places of its nodes
    real(wp), intent(in), contiguous :: spots(:, :)   !! (4, n) places of the spots
    real(wp), intent(in) :: travel                    !! relative motion since the start, m
    logical, intent(in) :: only_faced                 !! between outlines: no spot begins contact
                                                      !! with what its own surface does not face
    integer, intent(inout) :: n_released              !! deep first contacts let go
    integer :: n_left, n_due, i, k
    logical :: has_changed, was_free

    n_left = 0
    tracking%n_aside = 0
    if (tracking%n_touching > 0) call keep_contacts(tracking, surface, chain, spots, n_left)
    if (n_left == 0 .and. travel < tracking%next_wake) return
    n_due = n_left
    if (.not. travel < tracking%next_wake) call list_waking(tracking%n_touching, &
      tracking%touching, tracking%n, tracking%wake, travel, tracking%next_wake, tracking%due, n_due)
    has_changed = .false.
    do k = 1, n_due
      i = tracking%due(k)
      was_free = tracking%status(i) == is_free
      call update_spot(tracking, surface, chain, spots, i, travel, only_faced, n_released)
      has_changed = has_changed .or. (tracking%status(i) == is_touching .neqv. k <= n_left)
      if (tracking%status(i) /= is_touching) tracking%next_wake = &
        min(tracking%next_wake, tracking%wake(i))
      if (.not. (was_free .and. tracking%status(i) == is_touching)) cycle
      ! It has not stood before the face. The places of the list up to k are free.
      tracking%n_aside = tracking%n_aside + 1
      tracking%due(tracking%n_aside) = i
    end do
    if (has_changed) call list_touching(tracking)
  end subroutine update_tracking

  !> The common case of spots in contact: still over their segment, behind it, and no nearer to a
  !> neighbour than to it, or behind the node between both. The others are listed in `due`.
  pure subroutine keep_contacts(tracking, surface, chain, spots, n_left)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(out) :: n_left    !! spots that were not kept
    type(foot_block_t) :: block
    integer :: first, i, k

    n_left = 0
    do first = 1, tracking%n_touching, n_block
      block%n = min(n_block, tracking%n_touching - first + 1)
      call see_spots(block%n, tracking%touching(first), tracking%segment, surface%segments, chain, &
        spots, block%segment, block%t, block%d)
      call project_block(block)
      if (block%n_odd > 0) call settle_odd(surface, chain, block)
      i = tracking%touching(first)
      if (tracking%touching(first + block%n - 1) == i + block%n - 1) then
        call store_run(block%n, block%xi, block%gap, block%normal, tracking%xi(i), &
          tracking%gap(i), tracking%normal(1, i))
      else
        do k = 1, block%n
          i = tracking%touching(first + k - 1)
          tracking%xi(i) = block%xi(k)
          tracking%gap(i) = block%gap(k)
          tracking%normal(:, i) = block%normal(:, k)
        end do
      end if
      call take_moved(block, tracking%touching(first), tracking%segment, n_left, tracking%due)
    end do
  end subroutine keep_contacts

  !> The segments of the spots that were settled one by one; those that need a decision are listed.
  pure subroutine take_moved(block, touching, segment, n_left, due)
    type(foot_block_t), intent(in) :: block
    integer, intent(in) :: touching(*)   !! the spots
    integer, intent(inout) :: segment(*) !! of all spots
    integer, intent(inout) :: n_left, due(*)
    integer :: i, k

    do i = 1, block%n_moved
      k = block%moved(i)
      segment(touching(k)) = block%segment(k)
      if (block%gap(k) < 0.0_wp .and. .not. block%odd(k) > 0.0_wp) cycle
      n_left = n_left + 1
      due(n_left) = touching(k)
    end do
  end subroutine take_moved

  !> Vectors of a block of spots.
  pure subroutine see_spots(n, touching, segment, ends, chain, spots, on, t, d)
    integer, intent(in) :: n, touching(n), segment(*), ends(2, *)
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    integer, intent(inout) :: on(n)      !! their segments
    real(wp), intent(inout) :: t(2, n)   !! these, m
    real(wp), intent(inout) :: d(2, n)   !! from the segments' first nodes, m
    real(wp), dimension(4) :: along, across
    integer :: i, k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      i = touching(k)
      on(k) = segment(i)
      a = ends(1, segment(i))
      b = ends(2, segment(i))
      along = chain(:, b) - chain(:, a)
      across = spots(:, i) - chain(:, a)
      t(:, k) = along(1:2) + along(3:4)
      d(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine see_spots

  !> Keep the feet of spots that follow each other.
  pure subroutine store_run(n, xi, gap, normal, kept_xi, kept_gap, kept_normal)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(n), gap(n), normal(2, n)
    real(wp), intent(inout) :: kept_xi(n), kept_gap(n), kept_normal(2, n)

    kept_xi = xi
    kept_gap = gap
    kept_normal = normal
  end subroutine store_run

  !> Any other case, by what the spot was doing.
  pure subroutine update_spot(tracking, surface, chain, spots, i, travel, only_faced, n_released)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i
    real(wp), intent(in) :: travel
    logical, intent(in) :: only_faced
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
        if (foot%is_on .and. foot%gap < 0.0_wp .and. may_begin(tracking, spots, i, foot, &
          only_faced)) then
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
    call find_foot(tracking, surface, chain, spots, i, travel, foot)
    if (foot%segment > 0 .and. foot%is_on .and. foot%gap < 0.0_wp &
      .and. .not. may_begin(tracking, spots, i, foot, only_faced)) then
      call store_foot(tracking, i, foot)
      tracking%status(i) = is_free
      tracking%wake(i) = -huge(1.0_wp)
    else
      call judge_foot(tracking, surface, chain, spots, i, foot, travel, n_released)
    end if
  end subroutine update_spot

  !> Closest foot of a spot that is not in contact: by walking where that is safe, else by the
  !> global search. foot%segment = 0: none within reach.
  pure subroutine find_foot(tracking, surface, chain, spots, i, travel, foot)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i
    real(wp), intent(in) :: travel
    type(foot_t), intent(out) :: foot
    type(nearest_t) :: nearest
    real(wp) :: spot(4)
    integer :: segment

    spot = spots(:, i)
    segment = tracking%segment(i)
    if (segment > 0 .and. travel < tracking%recheck(i) .and. tracking%status(i) /= is_touching) then
      if (walk_to_closest(surface, chain, spot, segment) == segment) then
        foot = closest_foot(surface, chain, spot, segment)
        ! Beyond the reach the spot is let go: then other segments have to be known too. So they
        ! have where one of them may be nearer by now: a place may have come in past its end.
        if (foot%distance <= min(tracking%reach, tracking%recheck(i) - travel) .and. &
          may_meet(tracking, surface, chain, spots, i, segment)) return
        foot = foot_t()
      end if
    end if
    if (.not. tracking%grid%cell > 0.0_wp .or. &
      travel - tracking%grid%filled_at > slip_limit(tracking%grid)) &
      call fill_grid(tracking%grid, surface, chain, travel)
    foot%distance = box_distance(tracking%grid, chain, spot, travel)
    if (foot%distance > tracking%reach) return
    if (tracking%own_spots < 0) then
      call find_nearest(tracking%grid, surface, chain, spot, travel, tracking%reach, nearest)
    else
      call find_nearest_other(tracking, surface, chain, spots, i, travel, .false., nearest)
    end if
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
      ! A face reaches a little beyond its end.
      tracking%wake(i) = travel + safe_motion(tracking, i, min(foot%distance, abs(foot%gap)), &
        travel)
      if (.not. foot%is_on .or. (face > 0 .and. face /= foot%segment)) &
        tracking%wake(i) = -huge(1.0_wp)
    end if
  end subroutine judge_foot

  !> Whether a spot may begin contact at its foot: where only what is faced counts, its own surface
  !> must not stand on that with its side. A wall's node below the corner of a block that slides
  !> down along the wall does not face the block's under side.
  pure function may_begin(tracking, spots, i, foot, only_faced) result(may)
    type(tracking_t), intent(in) :: tracking
    real(wp), intent(in), contiguous :: spots(:, :)
    integer, intent(in) :: i
    type(foot_t), intent(in) :: foot
    logical, intent(in) :: only_faced
    logical :: may
    real(wp) :: t(2)

    may = .true.
    if (.not. only_faced) return
    t = separation(spots(:, tracking%chord(2, i)), spots(:, tracking%chord(1, i)))
    may = t(2)*foot%normal(1) - t(1)*foot%normal(2) <= side_on*norm2(t)
  end function may_begin

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

  !> The alarm of a spot that is not in contact, by where it is now, where its segment still is the
  !> closest.
  pure subroutine put_off(tracking, surface, chain, spot, i, travel)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4) !! place of the spot
    integer, intent(in) :: i        !! its number
    real(wp), intent(in) :: travel
    type(foot_t) :: foot

    if (.not. travel < tracking%recheck(i)) return
    if (walk_to_closest(surface, chain, spot, tracking%segment(i)) /= tracking%segment(i)) return
    foot = closest_foot(surface, chain, spot, tracking%segment(i))
    if (foot%is_on .and. foot%gap >= 0.0_wp) &
      tracking%wake(i) = travel + safe_motion(tracking, i, min(foot%distance, foot%gap), travel)
  end subroutine put_off

  !> Motion during which nothing new can be found for a spot before its closest segment: it does not
  !> reach this one, and no other is the closest of all, or so near that a spot which has come in
  !> past the end of that is caught there.
  pure function safe_motion(tracking, i, distance, travel) result(motion)
    type(tracking_t), intent(in) :: tracking
    integer, intent(in) :: i
    real(wp), intent(in) :: distance, travel !! m
    real(wp) :: motion, others

    others = tracking%recheck(i) - travel
    motion = min(distance, max(0.5_wp*(others - distance), &
      others - min(tracking%spot_depth(i), tracking%deepest)))
  end function safe_motion

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
    ! Where runs meet at a sharp corner either may have been found.
    if (candidates(2) == 0) candidates(2) = surface%incoming(surface%segments(1, foot%segment))
    if (candidates(3) == 0) candidates(3) = surface%outgoing(surface%segments(2, foot%segment))
    is_next_to_corner = foot%xi <= end_tolerance .or. foot%xi >= 1.0_wp - end_tolerance
    t = separation(spots(:, tracking%chord(2, i)), spots(:, tracking%chord(1, i)))
    face = 0
    best = huge(1.0_wp)
    do k = 1, 3
      if (k > 1 .and. .not. is_next_to_corner) exit
      if (candidates(k) == 0) cycle
      if (tracking%own_spots >= 0 .and. k > 1) then
        if (.not. is_elsewhere(tracking, surface, chain, i, candidates(k))) cycle
      end if
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

  !> Largest and smallest depth of first contacts.
  pure subroutine measure_depths(tracking)
    type(tracking_t), intent(inout) :: tracking

    if (allocated(tracking%segment_depth)) tracking%deepest = maxval([0.0_wp, &
      tracking%segment_depth], mask=[0.0_wp, tracking%segment_depth] < huge(1.0_wp))
    if (allocated(tracking%spot_depth)) tracking%shallowest = minval([tracking%spot_depth, &
      tracking%segment_depth])
  end subroutine measure_depths

  !> Start a tracking anew, knowing nothing.
  pure subroutine forget_pairs(tracking)
    type(tracking_t), intent(inout) :: tracking

    tracking%segment = 0
    tracking%n_touching = 0
    tracking%status = is_free
    tracking%grid%cell = 0.0_wp
    call wake_all(tracking)
  end subroutine forget_pairs

  !> List the spots in contact anew.
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

end module tracking_m
