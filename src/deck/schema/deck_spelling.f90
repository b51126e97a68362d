! SPDX-License-Identifier: MIT
!> Names that are nearly the same.
module deck_spelling_m
  implicit none
  private
  public :: first_too_far, keep_nearer

contains

  !> Letters by which no name differs from one that it is meant for: three, fewer of a short one.
  pure function first_too_far(name) result(letters)
    character(*), intent(in) :: name
    integer :: letters

    letters = min(3, (len(name) + 2)/2)
  end function first_too_far

  !> Take a name in place of the nearest so far where it is nearer to the one given.
  pure subroutine keep_nearer(name, given, least, nearest)
    character(*), intent(in) :: name, given      !! without blanks behind
    integer, intent(inout) :: least              !! distance of the nearest so far
    character(*), intent(inout) :: nearest
    integer :: distance

    if (abs(len(name) - len(given)) >= least) return
    distance = edit_distance(name, given)
    if (distance >= min(least, first_too_far(name))) return
    least = distance
    nearest = name
  end subroutine keep_nearer

  !> Letters to insert, to leave out or to change, or neighbours to swap, that make one name of
  !> another (optimal string alignment).
  pure function edit_distance(a, b) result(distance)
    character(*), intent(in) :: a, b    !! without blanks behind
    integer :: distance
    integer :: cost(0:len(a), 0:len(b)), i, k

    cost = 0
    cost(:, 0) = [(i, i=0, len(a))]
    cost(0, :) = [(k, k=0, len(b))]
    do k = 1, len(b)
      do i = 1, len(a)
        cost(i, k) = min(cost(i - 1, k) + 1, cost(i, k - 1) + 1, &
          cost(i - 1, k - 1) + merge(0, 1, a(i:i) == b(k:k)))
        if (i == 1 .or. k == 1) cycle
        if (a(i:i) == b(k - 1:k - 1) .and. a(i - 1:i - 1) == b(k:k)) &
          cost(i, k) = min(cost(i, k), cost(i - 2, k - 2) + 1)
      end do
    end do
    distance = cost(len(a), len(b))
  end function edit_distance

end module deck_spelling_m
