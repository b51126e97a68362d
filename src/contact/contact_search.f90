! SPDX-License-Identifier: MIT
!> Which spot is on which segment: tracked from step to step, searched globally where tracking could
!> miss something, asleep where nothing can touch (doc/theory/contact.md, section 4).
module contact_search_m
  use contact_buckets_m, only : nearest_t, fill_grid, slip_limit, box_distance, find_nearest
  use contact_projection_m, only : foot_t, see_segment, closest_foot, follow_contact, &
    walk_to_closest, is_over_segment, turns_gently, end_tolerance, &
    side_on
  use contact_state_m, only : tracking_t, is_free, is_in_front, is_touching, is_behind
  use geometry_m, only : sight_t, separation
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: update_tracking, wake_all, most_facing, begin_contact

  !> Spots projected together.
  integer, parameter :: block_size = 64
  !> Spots listed together.
  integer, parameter :: n_together = 16

contains

  !> Bring the pairs of all spots up to date and list the spots in contact.
  pure subroutine update_tracking(tracking, surface, chain, spots, travel, n_released)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface            !! the chain tracked upon
    real(wp), intent(in), contiguous :: chain(:, :)   !! (4, n_node) places of its nodes
    real(wp), intent(in), contiguous :: spots(:, :)   !! (4, n) places of the spots
    real(wp), intent(in) :: travel                    !! relative motion since the start, m
    integer, intent(inout) :: n_released              !! deep first contacts let go
    real(wp) :: next_wake
    integer :: i, n_touching

    if (travel < tracking%next_wake) then
      tracking%n_touching = 0
      return
    end if
    call keep_contacts(tracking%touching(:tracking%n_touching), tracking%segment, &
      surface%segments, chain, spots, tracking%xi, tracking%gap, tracking%normal, tracking%is_kept)
    next_wake = huge(1.0_wp)
    n_touching = 0
    i = 0
    do while (i < tracking%n)
      if (i + n_together <= tracking%n) then
        if (all(tracking%is_kept(i + 1:i + n_together))) then
          call list_kept(tracking%touching, tracking%is_kept, i, n_touching)
          next_wake = -huge(1.0_wp)
          cycle
        end if
      end if
      i = i + 1
      if (travel < tracking%wake(i)) then
        next_wake = min(next_wake, tracking%wake(i))
        cycle
      end if
      if (.not. tracking%is_kept(i)) &
        call update_spot(tracking, surface, chain, spots, i, travel, n_released)
      next_wake = min(next_wake, tracking%wake(i))
      tracking%is_kept(i) = .false.
      if (tracking%status(i) /= is_touching) cycle
      n_touching = n_touching + 1
      tracking%touching(n_touching) = i
    end do
    tracking%n_touching = n_touching
    tracking%next_wake = next_wake
  end subroutine update_tracking

  !> Keep spots i + 1 .. i + n_together on the list of those in contact: 0.5 ns a spot, one by one 3.
  pure subroutine list_kept(touching, is_kept, i, n_touching)
    integer, intent(inout), contiguous :: touching(:)
    logical, intent(inout), contiguous :: is_kept(:)
    integer, intent(inout) :: i, n_touching
    integer :: k

    do k = 1, n_together
      touching(n_touching + k) = i + k
      is_kept(i + k) = .false.
    end do
    i = i + n_together
    n_touching = n_touching + n_together
  end subroutine list_kept

  !> The common case of spots in contact: still over their segment, behind it, and no nearer to a
  !> neighbour than to it. Of others nothing is changed. In blocks, so that the roots and quotients
  !> of a block are formed together: 8 ns a spot one by one, 5 ns so.
  pure subroutine keep_contacts(touching, segment, ends, chain, spots, xi, gap, normal, is_kept)
    integer, intent(in), contiguous :: touching(:) !! spots that touched after the last step
    integer, intent(in), contiguous :: segment(:)
    integer, intent(in) :: ends(2, *)
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    real(wp), intent(inout) :: xi(*), gap(*), normal(2, *)
    logical, intent(inout), contiguous :: is_kept(:)
    real(wp), dimension(block_size) :: tx, ty, dx, dy, along, across
    logical :: kept(block_size)
    integer :: first, n, i, k, a, b

    do first = 1, size(touching), block_size
      n = min(block_size, size(touching) - first + 1)
      !GCC$ NOVECTOR
      do k = 1, n
        i = touching(first + k - 1)
        a = ends(1, segment(i))
        b = ends(2, segment(i))
        tx(k) = (chain(1, b) - chain(1, a)) + (chain(3, b) - chain(3, a))
        ty(k) = (chain(2, b) - chain(2, a)) + (chain(4, b) - chain(4, a))
        dx(k) = (spots(1, i) - chain(1, a)) + (spots(3, i) - chain(3, a))
        dy(k) = (spots(2, i) - chain(2, a)) + (spots(4, i) - chain(4, a))
      end do
      call project_block(n, tx, ty, dx, dy, along, across, kept)
      do k = 1, n
        if (.not. kept(k)) cycle
        i = touching(first + k - 1)
        is_kept(i) = .true.
        xi(i) = along(k)
        gap(i) = across(k)
        normal(1, i) = ty(k)
        normal(2, i) = -tx(k)
      end do
    end do
  end subroutine keep_contacts

  !> Projections of a block.
  pure subroutine project_block(n, tx, ty, dx, dy, xi, gap, kept)
    integer, intent(in) :: n
    real(wp), intent(inout) :: tx(block_size), ty(block_size) !! in: segments, m; out: unit tangents
    real(wp), intent(in) :: dx(block_size), dy(block_size)    !! from the segments' first nodes, m
    real(wp), intent(out) :: xi(block_size), gap(block_size)
    logical, intent(out) :: kept(block_size) !! behind the segment, and not nearer to a neighbour
    real(wp) :: square, along, across, inverse
    integer :: k

    do k = 1, n
      square = max(tx(k)*tx(k) + ty(k)*ty(k), tiny(1.0_wp))
      along = dx(k)*tx(k) + dy(k)*ty(k)
      across = dx(k)*ty(k) - dy(k)*tx(k)
      kept(k) = across < 0.0_wp .and. across + along >= 0.0_wp .and. across + square >= along
      inverse = 1.0_wp/sqrt(square)
      xi(k) = along*(inverse*inverse)
      gap(k) = across*inverse
      tx(k) = tx(k)*inverse
      ty(k) = ty(k)*inverse
    end do
  end subroutine project_block

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

  !> Closest foot of a spot that is not in contact: by walking where that is safe, else by the global
  !> search. foot%segment = 0: none within reach.
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
        return
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
      ! What is found behind at first sight is a deep contact only within the first row of elements; beyond
      ! that it may as well be the far side of a body.
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

  !> Face that a spot stands before: its own segment, but next to a sharp corner the one that the spot's own
  !> surface faces most, among those it is over. 0 when it stands before none. Without this a node at a
  !> flush edge belongs to the top or to the side of the other body by round-off. At time zero (`is_start`) faces that the spot is
  !> behind count too, and any depth is next to the corner where the spot's own surface faces the other face only.
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
