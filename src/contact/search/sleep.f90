! SPDX-License-Identifier: MIT
!> First contacts of slave segments, for formulations that place points between the slave nodes
!> without following each point: what may be caught, and which segments need not be looked at
!> (doc/theory/contact.md, sections 3.3 and 4).
module sleep_m
  use safe_travel_m, only : safe_travel
  use contact_state_m, only : contact_state_t, is_free, is_in_front, is_touching, is_behind
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: all_asleep, is_asleep, keep_segment, judge_segment, note_next_wake

contains

  !> Whether no segment can touch yet.
  pure function all_asleep(memory)
    type(contact_state_t), intent(in) :: memory
    logical :: all_asleep

    associate (tracking => memory%slave_tracking)
      all_asleep = tracking%n_touching == 0 .and. memory%travel < memory%segments%next_wake
      ! An end that has been let go has no alarm.
      if (all_asleep .and. memory%travel >= tracking%next_wake) &
        all_asleep = all(is_outside(tracking%status))
    end associate
  end function all_asleep

  !> Whether a segment can not touch yet. `ends` are its nodes.
  pure function is_asleep(memory, segment, ends) result(asleep)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: segment
    integer, intent(in) :: ends(2)
    logical :: asleep

    asleep = memory%travel < memory%segments%wake(segment)
    if (asleep) asleep = is_outside(memory%slave_tracking%status(ends(1))) &
      .and. is_outside(memory%slave_tracking%status(ends(2)))
  end function is_asleep

  !> Note a segment with both ends in contact: it stays, whatever its gaps. One in contact is awake:
  !> nothing is written again.
  pure subroutine keep_segment(is_deep, travel, status, wake)
    logical, intent(in) :: is_deep   !! some gap of it is closed
    real(wp), intent(in) :: travel   !! m
    integer, intent(inout) :: status !! of the segment
    real(wp), intent(inout) :: wake  !! m

    if (is_deep .and. status == is_touching) return
    status = merge(is_touching, is_free, is_deep)
    wake = merge(-huge(1.0_wp), travel, is_deep)
  end subroutine keep_segment

  !> Whether a spot is neither in contact nor let go.
  elemental function is_outside(status)
    integer, intent(in) :: status
    logical :: is_outside

    is_outside = status == is_free .or. status == is_in_front
  end function is_outside

  !> Whether the points on a segment count. One that is in contact, or has an end that is, stays; a
  !> new one must not be deeper than a first contact may be, and otherwise is let go until it has
  !> been outside.
  pure subroutine judge_segment(contact, memory, segment, ends, deepest, counts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: segment
    integer, intent(in) :: ends(2)     !! its nodes
    real(wp), intent(in) :: deepest    !! smallest gap of its points, m
    logical, intent(out) :: counts
    logical :: end_touches

    counts = .true.
    if (deepest >= memory%closed_gap) then
      memory%segments%status(segment) = is_free
      memory%segments%wake(segment) = memory%travel + safe_travel(contact, memory, ends)
      return
    end if
    memory%segments%wake(segment) = -huge(1.0_wp)
    associate (status => memory%segments%status(segment), tracking => memory%slave_tracking)
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

  !> After all segments have been looked at. Not asked for as long as something touches.
  pure subroutine note_next_wake(memory)
    type(contact_state_t), intent(inout) :: memory

    memory%segments%next_wake = -huge(1.0_wp)
    if (memory%slave_tracking%n_touching == 0) &
      memory%segments%next_wake = minval(memory%segments%wake)
  end subroutine note_next_wake

end module sleep_m
