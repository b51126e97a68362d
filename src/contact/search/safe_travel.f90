! SPDX-License-Identifier: MIT
!> How far the bodies may move before a slave segment can touch the master
!> (doc/theory/contact.md, section 4).
module safe_travel_m
  use grid_m, only : distance_to_others
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, segment_length, closest_distance, sight_of_segment
  use kinds_m, only : wp
  implicit none
  private
  public :: safe_travel

  !> The tracked segment of a spot is its closest one or next to it, and what the search knows of
  !> other segments leaves out the closest and its neighbours: so many on either side.
  integer, parameter :: n_around = 2
  !> Master segments that a slave segment is measured against one by one.
  integer, parameter :: n_window = 16

contains

  !> Travel during which nothing can touch a segment of length L. Two chains that do not cross come
  !> nearest to each other at a node of one of them: at an end of the segment, which the tracking
  !> bounds for all of the master, or at a master node. Of these the master segments near the feet
  !> of the ends are measured; how far the others are is known in two ways, the greater of which
  !> holds: from the distances of the ends, or by a look round the middle.
  pure function safe_travel(contact, memory, ends) result(travel)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    real(wp) :: travel, others
    integer :: k, seen

    travel = huge(1.0_wp)
    seen = 0
    associate (tracking => memory%slave_tracking)
      do k = 1, 2
        if (tracking%segment(ends(k)) > 0) travel = &
          min(travel, tracking%wake(ends(k)) - memory%travel)
      end do
      do k = 1, 2
        if (.not. travel > 0.0_wp) exit
        associate (segment => tracking%segment(ends(k)))
          if (segment == 0 .or. segment == seen) cycle
          travel = min(travel, distance_round(contact, memory, ends, segment))
          seen = segment
        end associate
      end do
    end associate
    if (travel > 0.0_wp) then
      others = travel_to_others(memory, ends)
      if (others < travel) others = max(others, distance_by_window(contact, memory, ends, travel))
      travel = min(travel, others)
    end if
    travel = max(0.0_wp, travel)
  end function safe_travel

  !> The first way: a place on the segment is at least (o_1 + o_2 - L)/2 away from all other master
  !> segments when its ends are o_1 and o_2 away from these. That shrinks by 3/2 of the travel at
  !> most, so that it takes a third of o_1 + o_2 - L.
  pure function travel_to_others(memory, ends) result(travel)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    real(wp) :: travel
    integer :: k

    travel = -segment_length(memory%places(:, ends(1)), memory%places(:, ends(2)))
    associate (tracking => memory%slave_tracking)
      do k = 1, 2
        if (tracking%segment(ends(k)) == 0) then
          travel = travel + tracking%reach + max(0.0_wp, tracking%wake(ends(k)) - memory%travel)
        else
          travel = travel + tracking%recheck(ends(k)) - memory%travel
        end if
      end do
    end associate
    travel = travel/3.0_wp
  end function travel_to_others

  !> The second way, for segments along which ends know little of others (a master with shorter
  !> segments, a search long ago): the least of the distances of the master segments from the foot
  !> of one end to that of the other and `n_around` more on either side, and of that of all other
  !> master segments. No place of the slave segment is farther than L/2 from its middle, so these
  !> are at least as far as they are from the middle, less L/2. Both are distances of present places
  !> and shrink by the travel at most. 0: nothing is known, since an end has no foot or the feet are
  !> far apart.
  pure function distance_by_window(contact, memory, ends, wanted) result(distance)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    real(wp), intent(in) :: wanted !! more is of no use, m
    real(wp) :: distance, half
    integer :: window(n_window), n

    distance = 0.0_wp
    associate (tracking => memory%slave_tracking, one => memory%places(:, ends(1)), &
      two => memory%places(:, ends(2)))
      if (minval(tracking%segment(ends)) == 0) return
      call list_window(contact, tracking%segment(ends(1)), tracking%segment(ends(2)), window, n)
      if (n == 0) return
      half = 0.5_wp*segment_length(one, two)
      distance = distance_to_others(tracking%grid, contact%master, &
        memory%places(:, memory%n_slave + 1:), 0.5_wp*(one + two), memory%travel, half + wanted, &
        window(:n)) - half
      ! So few are all among those round the feet, which have been measured.
      if (n > 2*(n_around + 1)) distance = min(distance, &
        distance_to_run(contact, memory, ends, window(:n)))
    end associate
  end function distance_by_window

  !> Master segments from `n_around` before the foot of the first end of a slave segment, against
  !> the master's direction, to as many behind that of the second.
  pure subroutine list_window(contact, first, last, window, n)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: first, last       !! master segments of the feet
    integer, intent(out) :: window(n_window)
    integer, intent(out) :: n                !! 0: the feet are farther apart
    integer :: segment, i_step, n_left

    segment = first
    do i_step = 1, n_around
      if (contact%master%next(segment) == 0) exit
      segment = contact%master%next(segment)
    end do
    window = 0
    n_left = -1
    do n = 1, n_window
      window(n) = segment
      if (n_left < 0 .and. segment == last .and. any(window(:n) == first)) n_left = n_around
      segment = contact%master%previous(segment)
      if (n_left == 0 .or. (n_left > 0 .and. segment == 0)) return
      if (segment == 0) exit
      n_left = max(-1, n_left - 1)
    end do
    n = 0
  end subroutine list_window

  !> Distance from a slave segment to the master segments round a given one.
  pure function distance_round(contact, memory, ends, segment) result(distance)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(in) :: segment !! of the master
    real(wp) :: distance
    integer :: run(2*n_around + 1), n

    run(1) = segment
    do n = 1, n_around
      if (contact%master%next(run(1)) == 0) exit
      run(1) = contact%master%next(run(1))
    end do
    do n = 1, size(run) - 1
      run(n + 1) = contact%master%previous(run(n))
      if (run(n + 1) == 0) exit
    end do
    distance = distance_to_run(contact, memory, ends, run(:n))
  end function distance_round

  !> Distance from a slave segment to master segments one before the other: that of the nearest node
  !> of these, and 0 where one of them crosses the slave segment. A segment that is crossed although
  !> none of its points is behind the master is never left alone, since no distance of nodes says
  !> when one of them will be.
  pure function distance_to_run(contact, memory, ends, run) result(distance)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(in), contiguous :: run(:) !! each the previous one of that before
    real(wp) :: distance, square, before
    type(sight_t) :: sight
    integer :: k

    associate (nodes => contact%master%segments, chain => memory%places(:, memory%n_slave + 1:), &
      one => memory%places(:, ends(1)), two => memory%places(:, ends(2)))
      sight = sight_of_segment(chain(:, nodes(2, run(1))), one, two)
      square = closest_distance(sight)
      do k = 1, size(run)
        before = sight%across
        sight = sight_of_segment(chain(:, nodes(1, run(k))), one, two)
        square = min(square, closest_distance(sight))
        if ((before < 0.0_wp) .eqv. (sight%across < 0.0_wp)) cycle
        if (divides(chain(:, nodes(1, run(k))), chain(:, nodes(2, run(k))), one, two)) &
          square = 0.0_wp
      end do
    end associate
    distance = sqrt(square)
  end function distance_to_run

  !> Whether two places are on different sides of the line through a and b, or on it.
  pure function divides(a, b, one, two)
    real(wp), dimension(4), intent(in) :: a, b, one, two
    logical :: divides
    type(sight_t) :: of_one, of_two

    of_one = sight_of_segment(one, a, b)
    of_two = sight_of_segment(two, a, b)
    divides = min(of_one%across, of_two%across) <= 0.0_wp .and. max(of_one%across, of_two%across) &
      >= 0.0_wp
  end function divides

end module safe_travel_m
