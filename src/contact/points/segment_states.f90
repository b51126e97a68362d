! SPDX-License-Identifier: MIT
!> Status of the slave segments whose overlaps have made points (types 5 and 7).
module segment_states_m
  use contact_state_m, only : contact_state_t, active
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use overlap_status_m, only : store_segment_state, update_segment_state
  implicit none
  private
  public :: update_segment_states

contains

  !> Judge the segments that were due by their points, which follow each other on the list; those
  !> that do not count have no area. Points of a segment neither of whose ends nor any of whose
  !> points is in contact are left to its neighbours, like those of a segment that is not due: so
  !> sums over the points of a node do not depend on which segments are due.
  pure subroutine update_segment_states(contact, n_before, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: n_before !! points on the list before them
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: deepest
    integer :: first, last, s
    logical :: counts

    last = n_before
    do s = 1, contact%slave%n_segment
      if (.not. memory%scratch%has_points(s)) cycle
      associate (ends => contact%slave%segments(:, s), points => memory%points)
        first = last + 1
        deepest = huge(1.0_wp)
        do last = first, points%n
          if (points%slave_nodes(1, last) /= ends(1)) exit
          if (points%area(last) > 0.0_wp) deepest = min(deepest, points%gap(last))
        end do
        last = last - 1
        if (all(memory%slave_status%state(ends) == active)) then
          call store_segment_state(deepest < memory%closed_gap, memory%travel, &
            memory%segment_state(s), memory%segment_search(s))
          cycle
        end if
        call update_segment_state(memory, s, ends, deepest, counts)
        if (counts .and. .not. deepest < memory%closed_gap) then
          counts = any(memory%slave_status%state(ends) == active)
          memory%scratch%has_points(s) = counts
        end if
        if (.not. counts) points%area(first:last) = 0.0_wp
      end associate
    end do
  end subroutine update_segment_states

end module segment_states_m
