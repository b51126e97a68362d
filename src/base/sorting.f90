! SPDX-License-Identifier: MIT
!> Sorting by key.
module sorting_m
  use kinds_m, only : long
  implicit none
  private
  public :: sorted_order

contains

  !> Order that sorts `keys`: keys(order(1)) <= keys(order(2)) <= ... Stable, n log n (merge sort).
  pure function sorted_order(keys) result(order)
    integer(long), intent(in) :: keys(:) !! any values
    integer, allocatable :: order(:)     !! (size(keys)) a permutation
    integer, allocatable :: from(:)
    integer :: n, width, low, middle, high, i

    n = size(keys)
    allocate (order(n), from(n))
    do i = 1, n
      order(i) = i
    end do
    width = 1
    do while (width < n)
      from = order
      do low = 1, n, 2*width
        middle = min(low + width, n + 1)
        high = min(middle + width, n + 1)
        call merge_runs(keys, from, low, middle, high, order)
      end do
      if (width > n/2) exit
      width = 2*width
    end do
  end function sorted_order

  !> Merge from(low:middle-1) and from(middle:high-1) into order(low:high-1).
  pure subroutine merge_runs(keys, from, low, middle, high, order)
    integer(long), intent(in) :: keys(:)
    integer, intent(in) :: from(:)
    integer, intent(in) :: low, middle, high
    integer, intent(inout) :: order(:)
    integer :: i, left, right
    logical :: take_left

    left = low
    right = middle
    do i = low, high - 1
      take_left = right >= high
      if (.not. take_left .and. left < middle) take_left = keys(from(left)) <= keys(from(right))
      if (take_left) then
        order(i) = from(left)
        left = left + 1
      else
        order(i) = from(right)
        right = right + 1
      end if
    end do
  end subroutine merge_runs

end module sorting_m
