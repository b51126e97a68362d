! SPDX-License-Identifier: MIT
!> Pieces of a slave segment one behind the other, where the master is bent back or another chain
!> begins behind the place where one ends (doc/theory/contact.md, section 3.5).
module piece_order_m
  use kinds_m, only : wp
  implicit none
  private
  public :: level_cuts, name_cuts

contains

  !> Where pieces start and end, from the projections of their nodes, between 0 and 1 and in the
  !> order of the master. Where these go back, the way from the first end would end the pieces
  !> before the fold as late as it can (`most`), the way from the second end would begin those
  !> behind it as early (`least`). They meet half way, which is the same place from either end.
  pure subroutine level_cuts(n, low, high)
    integer, intent(in) :: n
    real(wp), intent(inout) :: low(n), high(n)
    real(wp) :: most(2*n), least(2*n), half_way
    integer :: i, j

    most(1::2) = low
    most(2::2) = high
    least = most
    do i = 2, 2*n
      most(i) = max(most(i), most(i - 1))
    end do
    do i = 2*n - 1, 1, -1
      least(i) = min(least(i), least(i + 1))
    end do
    i = 1
    do while (i <= 2*n)
      j = i
      if (most(i) > least(i)) then
        do while (j < 2*n)
          if (.not. most(j + 1) > least(j + 1) .or. least(j + 1) >= most(j)) exit
          j = j + 1
        end do
        half_way = 0.5_wp*(most(j) + least(i))
        most(i:j) = max(least(i:j), min(most(i:j), half_way))
      end if
      i = j + 1
    end do
    low = most(1::2)
    high = most(2::2)
  end subroutine level_cuts

  !> What stands where one piece ends and the next one that is not empty begins: one node where they
  !> meet in it, two where they are parted, and the other one where that of a piece is beyond an end
  !> of the slave segment (0).
  pure subroutine name_cuts(n, low, high, first_cut, last_cut)
    integer, intent(in) :: n
    real(wp), intent(in) :: low(n), high(n)
    integer, intent(inout) :: first_cut(n), last_cut(n)
    integer :: before, k

    before = 0
    do k = 1, n
      if (.not. high(k) > low(k)) cycle
      if (before > 0) then
        if (last_cut(before) == 0) last_cut(before) = first_cut(k)
        if (first_cut(k) == 0) first_cut(k) = last_cut(before)
      end if
      before = k
    end do
  end subroutine name_cuts

end module piece_order_m
