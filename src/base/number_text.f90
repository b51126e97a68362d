! SPDX-License-Identifier: MIT
!> Text of numbers for output that has many, by the C++ library (number_text.cpp).
module number_text_m
  use, intrinsic :: iso_c_binding, only : c_char, c_double, c_int
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_is_nan
  use kinds_m, only : wp
  implicit none
  private
  public :: real_size, integer_size, put_real, put_integer, shortest, es

  !> Bytes of the longest real and of the longest integer.
  integer, parameter :: real_size = 24, integer_size = 11

  !> A number, or several side by side, as the edit descriptor ESw.d writes them. Exponents have two
  !> digits, which layouts of fixed width are made for: beyond stand zero and the largest number.
  interface es
    module procedure es_one
    module procedure es_several
  end interface es

  interface
    pure subroutine c_shortest(value, text, n) bind(c, name='shortest_text')
      import :: c_char, c_double, c_int
      real(c_double), value :: value
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_int), intent(out) :: n
    end subroutine c_shortest

    pure subroutine c_scientific(value, n_digit, text, n) bind(c, name='scientific_text')
      import :: c_char, c_double, c_int
      real(c_double), value :: value
      integer(c_int), value :: n_digit
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_int), intent(out) :: n
    end subroutine c_scientific

    pure subroutine c_integer(value, text, n) bind(c, name='integer_text')
      import :: c_char, c_int
      integer(c_int), value :: value
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_int), intent(out) :: n
    end subroutine c_integer
  end interface

contains

  !> The shortest decimal that reads back as the same number; zero of either sign is 0.
  pure subroutine put_real(value, text, n)
    real(wp), intent(in) :: value
    character(real_size), intent(inout) :: text
    integer, intent(out) :: n     !! bytes of it

    if (.not. ieee_is_finite(value)) then
      call put_not_finite(value, text, n)
    else
      call c_shortest(value + 0.0_wp, text, n) ! -0 becomes 0
    end if
  end subroutine put_real

  !> NaN, Infinity or -Infinity.
  pure subroutine put_not_finite(value, text, n)
    real(wp), intent(in) :: value
    character(real_size), intent(inout) :: text
    integer, intent(out) :: n

    if (ieee_is_nan(value)) then
      text = 'NaN'
    else
      text = merge('Infinity ', '-Infinity', value > 0.0_wp)
    end if
    n = len_trim(text)
  end subroutine put_not_finite

  !> An integer.
  pure subroutine put_integer(value, text, n)
    integer, intent(in) :: value
    character(*), intent(inout) :: text   !! `integer_size` bytes or more
    integer, intent(out) :: n             !! bytes of it

    call c_integer(value, text, n)
  end subroutine put_integer

  !> The shortest decimal that reads back as the same number.
  pure function shortest(value) result(text)
    real(wp), intent(in) :: value
    character(:), allocatable :: text
    character(real_size) :: buffer
    integer :: n

    call put_real(value, buffer, n)
    text = buffer(:n)
  end function shortest

  !> One number as ESw.d.
  pure function es_one(value, width, n_digit) result(text)
    real(wp), intent(in) :: value
    integer, intent(in) :: width, n_digit   !! w and d
    character(width) :: text
    real(wp), parameter :: least = 1.0e-99_wp, most = 9.9e99_wp
    character(real_size) :: buffer
    integer :: n

    if (ieee_is_nan(value)) then
      buffer = 'NaN'
      n = 3
    else if (abs(value) < least) then
      call c_scientific(0.0_wp, n_digit, buffer, n)
    else
      call c_scientific(min(max(value, -most), most), n_digit, buffer, n)
    end if
    text = repeat(' ', width - n)//buffer(:n)
  end function es_one

  !> Numbers side by side, each as ESw.d.
  pure function es_several(values, width, n_digit) result(text)
    real(wp), intent(in) :: values(:)
    integer, intent(in) :: width, n_digit   !! w and d of each
    character(width*size(values)) :: text
    integer :: i

    do i = 1, size(values)
      text(width*(i - 1) + 1:width*i) = es_one(values(i), width, n_digit)
    end do
  end function es_several

end module number_text_m
