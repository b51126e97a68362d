! SPDX-License-Identifier: MIT
!> Sorting by key and binary search.
module sorting_m
  use kinds_m, only : long
  implicit none
  private
  public :: sorted_order, distinct, index_among

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
    logical :: from_left

    left = low
    right = middle
    do i = low, high - 1
      from_left = right >= high
      if (.not. from_left .and. left < middle) from_left = keys(from(left)) <= keys(from(right))
      if (from_left) then
        order(i) = from(left)
        left = left + 1
      else
        order(i) = from(right)
        right = right + 1
      end if
    end do
  end subroutine merge_runs

  !> The distinct values of a list in increasing order.
  pure function distinct(values) result(rising)
    integer, intent(in) :: values(:)
    integer, allocatable :: rising(:)
    integer, allocatable :: order(:)
    integer :: i, n

    order = sorted_order(int(values, long))
    allocate (rising(size(values)))
    n = 0
    do i = 1, size(values)
      if (i > 1) then
        if (values(order(i)) == values(order(i - 1))) cycle
      end if
      n = n + 1
      rising(n) = values(order(i))
    end do
    rising = rising(:n)
  end function distinct

  !> Index of a value in a list that `order` sorts; 0 where it is not in the list.
  pure function index_among(values, order, value) result(found)
    integer, intent(in) :: values(:), order(:)
    integer, intent(in) :: value
    integer :: found
    integer :: low, high, middle

    low = 1
    high = size(values)
    do while (low < high)
      middle = (low + high)/2
      if (values(order(middle)) < value) then
        low = middle + 1
      else
        high = middle
      end if
    end do
    found = 0
    if (high < 1) return
    if (values(order(low)) == value) found = order(low)
  end function index_among

end module sorting_m
