! SPDX-License-Identifier: MIT
!> Status of the slave segments whose overlaps have made points (types 5 and 7).
module segment_points_m
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use overlap_status_m, only : keep_segment, judge_segment
  implicit none
  private
  public :: judge_segments

contains

  !> Judge the segments that were due by their points, which follow each other on the list; those
  !> that do not count have no area. Points of a segment neither of whose ends nor any of whose
  !> points is in contact are left to its neighbours, like those of a segment that is not due: so
  !> sums over the points of a node do not depend on which segments are due.
  pure subroutine judge_segments(contact, n_before, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: n_before !! points on the list before them
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: deepest
    integer :: first, last, s
    logical :: counts

    last = n_before
    do s = 1, contact%slave%n_segment
      if (.not. memory%scratch%is_placed(s)) cycle
      associate (ends => contact%slave%segments(:, s), points => memory%points)
        first = last + 1
        deepest = huge(1.0_wp)
        do last = first, points%n
          if (points%slave_nodes(1, last) /= ends(1)) exit
          if (points%area(last) > 0.0_wp) deepest = min(deepest, points%gap(last))
        end do
        last = last - 1
        if (all(memory%slave_tracking%status(ends) == is_touching)) then
          call keep_segment(deepest < memory%closed_gap, memory%travel, memory%segment_status(s), &
            memory%segment_wake(s))
          cycle
        end if
        call judge_segment(memory, s, ends, deepest, counts)
        if (counts .and. .not. deepest < memory%closed_gap) then
          counts = any(memory%slave_tracking%status(ends) == is_touching)
          memory%scratch%is_placed(s) = counts
        end if
        if (.not. counts) points%area(first:last) = 0.0_wp
      end associate
    end do
  end subroutine judge_segments

end module segment_points_m
