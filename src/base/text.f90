! SPDX-License-Identifier: MIT
!> Numbers as text and text as numbers, by the C++ library (number_text.cpp), and letter case.
module text_m
  use, intrinsic :: iso_c_binding, only : c_char, c_double, c_int
  use kinds_m, only : wp
  implicit none
  private
  public :: upper_case, read_real, read_integer, text_of, utf8_length, &
    number_good, number_wrong, number_range, number_fraction, &
    real_size, integer_size, put_real, put_integer, shortest, es

  !> Outcome of reading a number: good, not a number, too large, not a whole number.
  integer, parameter :: number_good = 0, number_wrong = 1, number_range = 2, number_fraction = 3

  !> Bytes of the longest real and of the longest integer.
  integer, parameter :: real_size = 24, integer_size = 11

  !> A number, or several side by side, as the edit descriptor ESw.d writes them; exponents of three
  !> digits become zero and the largest number of two.
  interface es
    module procedure es_one
    module procedure es_several
  end interface es

  interface
    !> The shortest decimal that reads back as the same number; zero of either sign is 0.
    pure subroutine put_real(value, text, n) bind(c, name='real_text')
      import :: c_char, c_double, c_int
      real(c_double), value :: value
      character(kind=c_char), intent(inout) :: text(*) !! `real_size` bytes or more
      integer(c_int), intent(out) :: n                 !! bytes of it
    end subroutine put_real

    pure subroutine put_integer(value, text, n) bind(c, name='integer_text')
      import :: c_char, c_int
      integer(c_int), value :: value
      character(kind=c_char), intent(inout) :: text(*) !! `integer_size` bytes or more
      integer(c_int), intent(out) :: n                 !! bytes of it
    end subroutine put_integer

    pure subroutine c_scientific(value, width, n_digit, text) bind(c, name='scientific_text')
      import :: c_char, c_double, c_int
      real(c_double), value :: value
      integer(c_int), value :: width, n_digit
      character(kind=c_char), intent(inout) :: text(*) !! `width` bytes
    end subroutine c_scientific

    pure subroutine c_read_real(text, n, value, status) bind(c, name='real_of_text')
      import :: c_char, c_double, c_int
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int), value :: n
      real(c_double), intent(out) :: value
      integer(c_int), intent(out) :: status
    end subroutine c_read_real

    pure subroutine c_read_integer(text, n, value, status) bind(c, name='integer_of_text')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int), value :: n
      integer(c_int), intent(out) :: value, status
    end subroutine c_read_integer
  end interface

contains

  !> The text with letters a to z made upper case.
  pure function upper_case(text) result(upper)
    character(*), intent(in) :: text
    character(len(text)) :: upper
    integer :: i

    do i = 1, len(text)
      if (text(i:i) >= 'a' .and. text(i:i) <= 'z') then
        upper(i:i) = achar(iachar(text(i:i)) - 32)
      else
        upper(i:i) = text(i:i)
      end if
    end do
  end function upper_case

  !> Read a real, correctly rounded: `1.`, `.5`, `1e-3`, `1.0D0`, `8.9-3`, with blanks around it.
  !> The status is `number_range` from 1e300 on.
  pure subroutine read_real(text, value, status)
    character(*), intent(in) :: text
    real(wp), intent(out) :: value
    integer, intent(out) :: status !! one of the `number_` constants

    call c_read_real(text, len(text), value, status)
  end subroutine read_real

  !> Read an integer, `3` or `3.0`, of at most 2^31 - 1 in magnitude.
  pure subroutine read_integer(text, value, status)
    character(*), intent(in) :: text
    integer, intent(out) :: value
    integer, intent(out) :: status !! one of the `number_` constants

    call c_read_integer(text, len(text), value, status)
  end subroutine read_integer

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

    call c_scientific(value, width, n_digit, text)
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

  !> The text, empty where it is not allocated.
  pure function text_of(text) result(known)
    character(:), allocatable, intent(in) :: text
    character(:), allocatable :: known

    known = ''
    if (allocated(text)) known = text
  end function text_of

  !> Bytes of the first UTF-8 character of a text (RFC 3629); 0 where it is not valid: overlong
  !> forms, surrogate halves and codes above 10FFFF.
  pure function utf8_length(text) result(n)
    character(*), intent(in) :: text !! not empty
    integer :: n
    integer :: low, high, i

    n = 1
    low = 128
    high = 191
    select case (iachar(text(1:1)))
    case (0:127); return
    case (194:223); n = 2
    case (224:239); n = 3
    case (240:244); n = 4
    case default; n = 0
    end select
    select case (iachar(text(1:1))) ! bounds of the second byte
    case (224); low = 160
    case (237); high = 159
    case (240); low = 144
    case (244); high = 143
    end select
    if (n > len(text)) n = 0
    do i = 2, n
      if (iachar(text(i:i)) < low .or. iachar(text(i:i)) > high) then
        n = 0
        return
      end if
      low = 128
      high = 191
    end do
  end function utf8_length

end module text_m
