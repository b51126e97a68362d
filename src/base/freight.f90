! SPDX-License-Identifier: MIT
!> Values of many arrays one behind the other. The same walk along the arrays counts the values,
!> loads them and unloads them.
module freight_m
  use, intrinsic :: iso_fortran_env, only : int16
  use kinds_m, only : wp
  implicit none
  private
  public :: freight_t, start_loading, start_unloading, pass_reals, pass_integers, pass_shorts

  type :: freight_t
    integer :: n = 0                    !! values passed so far
    logical :: unloads = .false.
    real(wp), allocatable :: values(:)  !! not there while they are only counted
  end type freight_t

contains

  !> Once the values are counted: room for them.
  pure subroutine start_loading(freight)
    type(freight_t), intent(inout) :: freight

    allocate (freight%values(freight%n))
    freight%n = 0
  end subroutine start_loading

  !> Back to the first value, to put them into arrays.
  pure subroutine start_unloading(freight)
    type(freight_t), intent(inout) :: freight

    freight%n = 0
    freight%unloads = .true.
  end subroutine start_unloading

  !> A piece of an array of reals.
  pure subroutine pass_reals(n, values, freight)
    integer, intent(in) :: n
    real(wp), intent(inout) :: values(n)
    type(freight_t), intent(inout) :: freight

    if (allocated(freight%values)) then
      if (freight%unloads) then
        values = freight%values(freight%n + 1:freight%n + n)
      else
        freight%values(freight%n + 1:freight%n + n) = values
      end if
    end if
    freight%n = freight%n + n
  end subroutine pass_reals

  !> One of integers.
  pure subroutine pass_integers(n, values, freight)
    integer, intent(in) :: n
    integer, intent(inout) :: values(n)
    type(freight_t), intent(inout) :: freight

    if (allocated(freight%values)) then
      if (freight%unloads) then
        values = nint(freight%values(freight%n + 1:freight%n + n))
      else
        freight%values(freight%n + 1:freight%n + n) = real(values, wp)
      end if
    end if
    freight%n = freight%n + n
  end subroutine pass_integers

  !> One of short integers.
  pure subroutine pass_shorts(n, values, freight)
    integer, intent(in) :: n
    integer(int16), intent(inout) :: values(n)
    type(freight_t), intent(inout) :: freight

    if (allocated(freight%values)) then
      if (freight%unloads) then
        values = nint(freight%values(freight%n + 1:freight%n + n), int16)
      else
        freight%values(freight%n + 1:freight%n + n) = real(values, wp)
      end if
    end if
    freight%n = freight%n + n
  end subroutine pass_shorts

end module freight_m
