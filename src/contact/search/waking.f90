! SPDX-License-Identifier: MIT
!> Which of the spots that are not in contact have to be looked at: those whose sleep is over
!> (doc/theory/contact.md, section 4). Many are passed at a time.
module waking_m
  use kinds_m, only : wp
  implicit none
  private
  public :: list_waking

  !> Spots passed at a time.
  integer, parameter :: n_passed = 32

contains

  !> List the spots that are not in contact and do not sleep any more: those before, between and
  !> behind the runs of spots in contact.
  pure subroutine list_waking(n_touching, touching, n, wake, travel, next_wake, due, n_due)
    integer, intent(in) :: n_touching, touching(n_touching)
    integer, intent(in) :: n                !! spots
    real(wp), intent(in) :: wake(n), travel
    real(wp), intent(out) :: next_wake      !! of those that sleep
    integer, intent(inout) :: due(n), n_due
    integer :: k, last

    next_wake = huge(1.0_wp)
    last = 0
    k = 0
    do while (k < n_touching)
      call pass_sleeping(last + 1, touching(k + 1) - 1, wake, travel, next_wake, due, n_due)
      k = end_of_run(n_touching, touching, k + 1)
      last = touching(k)
    end do
    call pass_sleeping(last + 1, n, wake, travel, next_wake, due, n_due)
  end subroutine list_waking

  !> The same for spots none of which is in contact. Many that sleep are passed at a time.
  pure subroutine pass_sleeping(first, last, wake, travel, next_wake, due, n_due)
    integer, intent(in) :: first, last
    real(wp), intent(in) :: wake(*), travel
    real(wp), intent(inout) :: next_wake
    integer, intent(inout) :: due(*), n_due
    real(wp) :: least
    integer :: from, to, i

    do from = first, last, n_passed
      to = min(last, from + n_passed - 1)
      least = huge(1.0_wp)
      !$omp simd reduction(min: least)
      do i = from, to
        least = min(least, wake(i))
      end do
      if (travel < least) then
        next_wake = min(next_wake, least)
        cycle
      end if
      do i = from, to
        if (travel < wake(i)) then
          next_wake = min(next_wake, wake(i))
        else
          n_due = n_due + 1
          due(n_due) = i
        end if
      end do
    end do
  end subroutine pass_sleeping

  !> Where a run of spots that follow each other ends on their list.
  pure function end_of_run(n, list, start) result(k)
    integer, intent(in) :: n, list(n), start
    integer :: k

    k = start
    do while (k + n_passed <= n)
      if (list(k + n_passed) /= list(k) + n_passed) exit
      k = k + n_passed
    end do
    do while (k < n)
      if (list(k + 1) /= list(k) + 1) exit
      k = k + 1
    end do
  end function end_of_run

end module waking_m
