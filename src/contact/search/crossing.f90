! SPDX-License-Identifier: MIT
!> What one long step carries through a surface. In explicit steps nothing comes deeper than the
!> limit for first contacts without having been caught before; an implicit step may lead from
!> outside to any depth, or out at the far side. There the way decides: a spot that goes through a
!> face within the step belongs to that face (doc/theory/contact.md, section 3.6).
module crossing_m
  use foot_m, only : foot_t, follow_contact, is_over_segment, side_on
  use spots_m, only : move_spots
  use contact_state_m, only : contact_state_t, tracking_t, is_free, is_in_front, is_touching, &
    is_behind
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, separation
  use kinds_m, only : wp
  use self_search_m, only : is_elsewhere
  use surfaces_m, only : surface_t
  use tracking_m, only : list_touching
  implicit none
  private
  public :: crossings_t, find_crossings, catch_crossings, crossing_time

  !> Cosine between two outward normals below which they belong to different faces.
  real(wp), parameter :: same_face = 0.5_wp
  !> Part of the square of a segment that counts as no distance.
  real(wp), parameter :: round_off = 1.0e-8_wp

  !> Faces that were gone through in a step, 0 = none. Not allocated where no spot can be too deep.
  type :: crossings_t
    integer, allocatable :: slave(:)  !! (spots) segment of the master
    integer, allocatable :: master(:) !! (master nodes) segment of the slave surface
  end type crossings_t

contains

  !> Ways of all spots over the step; call before the search, which forgets where they were.
  pure subroutine find_crossings(contact, motion, memory, crossings)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u, and u minus that of the start
                                                     !! of the step
    type(contact_state_t), intent(in) :: memory      !! places and spots of now, all else of the
                                                     !! start
    type(crossings_t), intent(out) :: crossings
    real(wp), allocatable :: places(:, :), spots(:, :)

    if (.not. relative_motion(motion(3:4, memory%nodes)) > least_depth(memory)) return
    places = memory%places
    places(3:4, :) = places(3:4, :) - motion(3:4, memory%nodes)
    associate (n => memory%n_slave, slave => memory%slave_tracking, &
      master => memory%master_tracking)
      if (allocated(memory%spots)) then
        spots = memory%spots(:, :slave%n)
        call move_spots(contact%slave, places, memory%spot_xi, memory%spot_spread, spots)
        crossings%slave = cross_chain(contact%master, places(:, n + 1:), memory%places(:, n + 1:), &
          spots, memory%spots(:, :slave%n), is_outside(slave), slave, slave%chord)
      else
        crossings%slave = cross_chain(contact%master, places(:, n + 1:), memory%places(:, n + 1:), &
          places(:, :n), memory%places(:, :n), is_outside(slave), slave, slave%chord)
      end if
      if (master%n > 0) then
        crossings%master = cross_chain(contact%slave, places(:, :n), memory%places(:, :n), &
          places(:, n + 1:), memory%places(:, n + 1:), is_outside(master), master, master%chord)
      else if (allocated(memory%segments%status)) then
        crossings%master = cross_chain(contact%slave, places(:, :n), memory%places(:, :n), &
          places(:, n + 1:), memory%places(:, n + 1:), spread(.true., 1, memory%n_master), slave)
      end if
    end associate
  end subroutine find_crossings

  !> Whom the search has let go, or given to another face, although the way led through a face: in
  !> contact with that.
  pure subroutine catch_crossings(contact, crossings, memory)
    type(contact_t), intent(in) :: contact
    type(crossings_t), intent(in) :: crossings
    type(contact_state_t), intent(inout) :: memory
    type(foot_t) :: foot
    integer :: i

    if (.not. allocated(crossings%slave)) return
    associate (slave => memory%places(:, :memory%n_slave), &
      master => memory%places(:, memory%n_slave + 1:))
      if (allocated(memory%spots)) then
        call catch_spots(memory%slave_tracking, contact%master, master, memory%spots, &
          crossings%slave, memory%n_released)
      else
        call catch_spots(memory%slave_tracking, contact%master, master, slave, &
          crossings%slave, memory%n_released)
      end if
      if (memory%master_tracking%n > 0) then
        call catch_spots(memory%master_tracking, contact%slave, slave, master, &
          crossings%master, memory%n_released)
      else if (allocated(crossings%master)) then
        do i = 1, memory%n_master
          if (crossings%master(i) == 0) cycle
          foot = follow_contact(contact%slave, slave, master(:, i), crossings%master(i))
          if (.not. foot%is_on .or. foot%gap >= 0.0_wp) cycle
          if (memory%segments%status(foot%segment) == is_free) &
            memory%segments%status(foot%segment) = is_touching
          memory%segments%wake(foot%segment) = -huge(1.0_wp)
          memory%segments%next_wake = -huge(1.0_wp)
        end do
      end if
    end associate
  end subroutine catch_crossings

  !> The spots of one tracking.
  pure subroutine catch_spots(tracking, surface, chain, spots, crossed, n_released)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :) !! (4, n) places
    integer, intent(in) :: crossed(:)      !! segment gone through, 0 = none
    integer, intent(inout) :: n_released   !! less those of them that the search has let go
    type(foot_t) :: foot
    integer :: i

    do i = 1, tracking%n
      if (crossed(i) > 0) then
        foot = follow_contact(surface, chain, spots(:, i), crossed(i))
        if (foot%is_on .and. foot%gap < 0.0_wp .and. .not. is_held(i, foot)) then
          if (tracking%status(i) == is_behind) n_released = max(0, n_released - 1)
          tracking%segment(i) = foot%segment
          tracking%xi(i) = foot%xi
          tracking%gap(i) = foot%gap
          tracking%normal(:, i) = foot%normal
          tracking%status(i) = is_touching
          tracking%wake(i) = -huge(1.0_wp)
          tracking%next_wake = -huge(1.0_wp)
        end if
      end if
    end do
    call list_touching(tracking)

  contains

    !> Whether the search has found the contact with that face.
    pure function is_held(i, foot)
      integer, intent(in) :: i
      type(foot_t), intent(in) :: foot
      logical :: is_held

      is_held = tracking%status(i) == is_touching
      if (is_held) is_held = dot_product(tracking%normal(:, i), foot%normal) >= same_face
    end function is_held

  end subroutine catch_spots

  !> Which spots have not been caught, nor let go, before the step; those that rest for ever, being
  !> part of no surface, take no part.
  pure function is_outside(tracking)
    type(tracking_t), intent(in) :: tracking
    logical :: is_outside(tracking%n)

    is_outside = (tracking%status(:tracking%n) == is_free .or. tracking%status(:tracking%n) &
      == is_in_front) .and. tracking%wake(:tracking%n) < huge(1.0_wp)
  end function is_outside

  !> Bound on how far any two nodes have moved relative to each other, m.
  pure function relative_motion(increments) result(motion)
    real(wp), intent(in) :: increments(:, :) !! (2, n_node)
    real(wp) :: motion

    motion = norm2(maxval(increments, 2) - minval(increments, 2))
  end function relative_motion

  !> Least of all limits for first contacts, m: what moves less is never let go nor taken for the
  !> far side.
  pure function least_depth(memory) result(depth)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: depth

    depth = min(minval(memory%slave_tracking%spot_depth), &
      minval(memory%slave_tracking%segment_depth))
    if (memory%master_tracking%n > 0) depth = min(depth, &
      minval(memory%master_tracking%spot_depth), minval(memory%master_tracking%segment_depth))
  end function least_depth

  !> The segment of a chain that each spot goes through first, from outside to inside, while chain
  !> and spots move evenly from old to new places.
  pure function cross_chain(surface, old_chain, chain, old_spots, spots, may_cross, tracking, &
      chord) result(crossed)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: old_chain(:, :), chain(:, :) !! (4, n_node)
    real(wp), intent(in), contiguous :: old_spots(:, :), spots(:, :) !! (4, n_spot)
    logical, intent(in) :: may_cross(:)
    type(tracking_t), intent(in) :: tracking !! says whether the chain is the spots' own surface
    integer, intent(in), optional :: chord(:, :) !! (2, n_spot) direction of the spots' own surface
    integer :: crossed(size(spots, 2))
    real(wp) :: boxes(4, surface%n_segment), box(4), time, first
    integer :: i, k

    crossed = 0
    do k = 1, surface%n_segment
      associate (ends => surface%segments(:, k))
        boxes(:, k) = box_of(old_chain(:, ends), chain(:, ends))
      end associate
    end do
    do i = 1, size(crossed)
      if (.not. may_cross(i)) cycle
      box = box_of(old_spots(:, i:i), spots(:, i:i))
      first = huge(1.0_wp)
      do k = 1, surface%n_segment
        if (any(box([1, 2]) > boxes([3, 4], k)) .or. any(box([3, 4]) < boxes([1, 2], k))) cycle
        if (tracking%own_spots >= 0) then
          if (.not. is_elsewhere(tracking, surface, old_chain, i, k)) cycle
        end if
        associate (a => surface%segments(1, k), b => surface%segments(2, k))
          time = crossing_time(sight_of_segment(old_spots(:, i), old_chain(:, a), &
            old_chain(:, b)), sight_of_segment(spots(:, i), chain(:, a), chain(:, b)), &
            own_direction(i))
        end associate
        if (time >= first) cycle
        first = time
        crossed(i) = k
      end do
    end do

  contains

    !> Direction of the surface of spot `i`; zero where none is given.
    pure function own_direction(i) result(t)
      integer, intent(in) :: i
      real(wp) :: t(2)

      t = 0.0_wp
      if (present(chord)) t = separation(spots(:, chord(2, i)), spots(:, chord(1, i)))
    end function own_direction

  end function cross_chain

  !> Box of old and new places, with a margin for the tolerance at ends of segments.
  pure function box_of(before, now) result(box)
    real(wp), intent(in) :: before(:, :), now(:, :) !! (4, n)
    real(wp) :: box(4)                              !! low x, low y, high x, high y, m
    real(wp) :: margin

    box(1:2) = min(minval(before(1:2, :) + before(3:4, :), 2), minval(now(1:2, :) + now(3:4, :), 2))
    box(3:4) = max(maxval(before(1:2, :) + before(3:4, :), 2), maxval(now(1:2, :) + now(3:4, :), 2))
    margin = 0.02_wp*norm2(box(3:4) - box(1:2))
    box = box + [-margin, -margin, margin, margin]
  end function box_of

  !> Part of the step after which a spot goes through a segment from outside, huge when it does not.
  !> Spot and segment move evenly, so that `across` is a polynomial of second degree, a0 + a1 s + a2
  !> s^2; of its roots one leads inwards.
  pure function crossing_time(before, now, direction) result(time)
    type(sight_t), intent(in) :: before, now
    real(wp), intent(in) :: direction(2) !! of the spot's own surface; zero: any
    real(wp) :: time
    real(wp) :: a0, a1, a2, square, moved(2), turned(2)
    type(sight_t) :: sight

    time = huge(1.0_wp)
    moved = now%d - before%d
    turned = now%t - before%t
    a0 = before%across
    if (abs(a0) <= round_off*before%square) a0 = 0.0_wp
    a1 = cross(before%d, turned) + cross(moved, before%t)
    a2 = cross(moved, turned)
    square = a1**2 - 4.0_wp*a0*a2
    if (square < 0.0_wp) return
    if (a1 <= 0.0_wp) then
      if (.not. sqrt(square) - a1 > 0.0_wp) return
      time = 2.0_wp*a0/(sqrt(square) - a1)
    else if (a2 < 0.0_wp) then
      time = -0.5_wp*(a1 + sqrt(square))/a2
    end if
    sight%d = before%d + min(time, 1.0_wp)*moved
    sight%t = before%t + min(time, 1.0_wp)*turned
    sight%square = max(sum(sight%t**2), tiny(1.0_wp))
    sight%along = dot_product(sight%d, sight%t)
    if (time < 0.0_wp .or. time > 1.0_wp .or. .not. is_over_segment(sight)) time = huge(1.0_wp)
    ! Beside its end only a surface that faces the segment goes through it.
    if ((sight%along < 0.0_wp .or. sight%along > sight%square) &
      .and. dot_product(direction, sight%t) > side_on*norm2(direction) &
      *sqrt(sight%square)) time = huge(1.0_wp)

  contains

    !> Twice the area between two vectors, as `across` is formed.
    pure function cross(d, t)
      real(wp), intent(in) :: d(2), t(2)
      real(wp) :: cross

      cross = d(1)*t(2) - d(2)*t(1)
    end function cross

  end function crossing_time

end module crossing_m
