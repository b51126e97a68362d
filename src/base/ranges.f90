! SPDX-License-Identifier: MIT
!> Long loops in ranges, one for each thread: a `taskloop` over them in the serial part of a cycle,
!> by the one thread that does that part and those that wait at the barrier behind it. No result
!> may depend on where ranges begin.
module ranges_m
  use kinds_m, only : long
  use omp_lib, only : omp_get_num_threads
  implicit none
  private
  public :: n_ranges, first_of, last_of

contains

  !> Number of ranges of a loop: as many as threads of the team, but none shorter than `least`.
  function n_ranges(n, least)
    integer, intent(in) :: n     !! length of the loop
    integer, intent(in) :: least !! length that is worth a thread
    integer :: n_ranges

    n_ranges = 1
    if (n >= 2*least) n_ranges = min(n/least, omp_get_num_threads())
  end function n_ranges

  !> First index of a range.
  pure function first_of(i, n_range, n) result(first)
    integer, intent(in) :: i       !! range
    integer, intent(in) :: n_range !! number of them
    integer, intent(in) :: n       !! length of the loop
    integer :: first

    first = 1 + int((i - 1)*int(n, long)/n_range)
  end function first_of

  !> Last index of a range.
  pure function last_of(i, n_range, n) result(last)
    integer, intent(in) :: i, n_range, n
    integer :: last

    last = first_of(i + 1, n_range, n) - 1
  end function last_of

end module ranges_m
