! SPDX-License-Identifier: MIT
!> Long loops in ranges that threads share. Where ranges begin depends on the length of the loop
!> alone, so that sums over ranges do not depend on the number of threads. A loop over ranges is a
!> `taskloop`: the one thread that does the serial part of a cycle makes the tasks, and those that
!> wait at its barrier help. Where nobody waits it does them all.
module ranges_m
  use kinds_m, only : long
  implicit none
  private
  public :: n_ranges, first_of, last_of, most_ranges

  !> Least length of a range, and most ranges of a loop.
  integer, parameter :: least_length = 128, most_ranges = 64

contains

  !> Number of ranges of a loop; 1: too short to be shared.
  pure function n_ranges(n)
    integer, intent(in) :: n !! length of the loop
    integer :: n_ranges

    n_ranges = max(1, min(n/least_length, most_ranges))
  end function n_ranges

  !> First index of a range.
  pure function first_of(i, n) result(first)
    integer, intent(in) :: i, n !! range, length of the loop
    integer :: first

    first = 1 + int((i - 1)*int(n, long)/n_ranges(n))
  end function first_of

  !> Last index of a range.
  pure function last_of(i, n) result(last)
    integer, intent(in) :: i, n !! range, length of the loop
    integer :: last

    last = first_of(i + 1, n) - 1
  end function last_of

end module ranges_m
