! SPDX-License-Identifier: MIT
!> Parts of long arrays whose values nobody asks for any more: their memory goes back to the system,
!> the arrays stay as long as they are.
module pages_m
  use, intrinsic :: iso_c_binding, only : c_loc, c_size_t
  use, intrinsic :: iso_fortran_env, only : int16
  use heap_m, only : give_back_pages
  use kinds_m, only : wp
  implicit none
  private
  public :: forget_reals, forget_integers, forget_shorts

  integer(c_size_t), parameter :: real_bytes = storage_size(1.0_wp)/8, &
    integer_bytes = storage_size(1)/8, short_bytes = storage_size(1_int16)/8

contains

  !> Items of two ranges.
  subroutine forget_reals(items, width, values)
    integer, intent(in) :: items(4)       !! first and last of the one, first and last of the other
    integer, intent(in) :: width          !! values of an item
    real(wp), intent(inout), target :: values(width, *)
    integer :: k

    do k = 1, 3, 2
      if (items(k + 1) >= items(k)) call give_back_pages(c_loc(values(1, items(k))), &
        real_bytes*width*(items(k + 1) - items(k) + 1))
    end do
  end subroutine forget_reals

  !> The same of integers.
  subroutine forget_integers(items, width, values)
    integer, intent(in) :: items(4), width
    integer, intent(inout), target :: values(width, *)
    integer :: k

    do k = 1, 3, 2
      if (items(k + 1) >= items(k)) call give_back_pages(c_loc(values(1, items(k))), &
        integer_bytes*width*(items(k + 1) - items(k) + 1))
    end do
  end subroutine forget_integers

  !> The same of short integers.
  subroutine forget_shorts(items, width, values)
    integer, intent(in) :: items(4), width
    integer(int16), intent(inout), target :: values(width, *)
    integer :: k

    do k = 1, 3, 2
      if (items(k + 1) >= items(k)) call give_back_pages(c_loc(values(1, items(k))), &
        short_bytes*width*(items(k + 1) - items(k) + 1))
    end do
  end subroutine forget_shorts

end module pages_m
