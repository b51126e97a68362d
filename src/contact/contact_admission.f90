! SPDX-License-Identifier: MIT
!> First contacts of slave segments, for formulations that place points between the slave nodes without following
!> each point: what may be caught, and how long a segment need not be looked at
!> (doc/theory/contact.md, sections 3.3 and 4).
module contact_admission_m
  use contact_state_m, only : contact_state_t, is_free, is_touching, is_behind
  use geometry_m, only : segment_length
  use kinds_m, only : wp
  implicit none
  private
  public :: all_asleep, is_asleep, judge_segment, note_next_wake

contains

  !> Whether no segment can touch yet.
  pure function all_asleep(memory)
    type(contact_state_t), intent(in) :: memory
    logical :: all_asleep

    all_asleep = memory%slave_tracking%n_touching == 0 .and. memory%travel < memory%cover%next_wake
  end function all_asleep

  !> Whether a segment can not touch yet. `ends` are its nodes.
  pure function is_asleep(memory, segment, ends) result(asleep)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: segment
    integer, intent(in) :: ends(2)
    logical :: asleep

    asleep = memory%travel < memory%cover%wake(segment)
    if (asleep) asleep = memory%slave_tracking%status(ends(1)) /= is_touching &
      .and. memory%slave_tracking%status(ends(2)) /= is_touching
  end function is_asleep

  !> Whether the points on a segment count. One that is in contact, or has an end that is, stays; a new one must not be deeper
  !> than a first contact may be, and otherwise is let go until it has been outside.
  pure subroutine judge_segment(memory, segment, ends, deepest, counts)
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: segment
    integer, intent(in) :: ends(2)     !! its nodes
    real(wp), intent(in) :: deepest    !! smallest gap of its points, m
    logical, intent(out) :: counts
    logical :: end_touches

    counts = .true.
    if (deepest >= 0.0_wp) then
      memory%cover%status(segment) = is_free
      memory%cover%wake(segment) = memory%travel + safe_travel(memory, ends)
      return
    end if
    memory%cover%wake(segment) = -huge(1.0_wp)
    associate (status => memory%cover%status(segment), tracking => memory%slave_tracking)
      end_touches = any(tracking%status(ends) == is_touching)
      if (status == is_free .and. .not. end_touches) then
        status = is_behind
        if (-deepest <= deepest_first_contact(memory, ends)) then
          status = is_touching
        else if (all(tracking%status(ends) /= is_behind)) then
          memory%n_released = memory%n_released + 1
        end if
      else if (end_touches) then
        status = is_touching
      end if
      counts = status == is_touching
    end associate
  end subroutine judge_segment

  !> Deepest first contact of a segment: that of its ends over their master segments, m.
  pure function deepest_first_contact(memory, ends) result(depth)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    real(wp) :: depth
    integer :: k

    associate (tracking => memory%slave_tracking)
      depth = minval(tracking%spot_depth(ends))
      do k = 1, 2
        if (tracking%segment(ends(k)) > 0) &
          depth = min(depth, tracking%segment_depth(tracking%segment(ends(k))))
      end do
    end associate
  end function deepest_first_contact

  !> Travel during which nothing can touch a segment of length L with ends at distances d_1 and d_2: a place on
  !> it is at least (d_1 + d_2 - L)/2 away, and each of the three can change by the travel.
  pure function safe_travel(memory, ends)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    real(wp) :: safe_travel
    integer :: k

    safe_travel = -segment_length(memory%places(:, ends(1)), memory%places(:, ends(2)))
    associate (tracking => memory%slave_tracking)
      do k = 1, 2
        safe_travel = safe_travel + max(0.0_wp, tracking%wake(ends(k)) - memory%travel)
        if (tracking%segment(ends(k)) == 0) safe_travel = safe_travel + tracking%reach
      end do
    end associate
    safe_travel = max(0.0_wp, safe_travel/3.0_wp)
  end function safe_travel

  !> After all segments have been looked at.
  pure subroutine note_next_wake(memory)
    type(contact_state_t), intent(inout) :: memory

    memory%cover%next_wake = minval(memory%cover%wake)
  end subroutine note_next_wake

end module contact_admission_m
