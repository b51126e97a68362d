! SPDX-License-Identifier: MIT
!> Text to numbers, and letter case.
module text_m
  use, intrinsic :: iso_c_binding, only : c_char, c_double, c_int
  use kinds_m, only : wp, long
  implicit none
  private
  public :: upper_case, read_real, read_integer, text_of, utf8_length, &
    number_good, number_wrong, number_range, number_fraction

  !> Outcome of reading a number: good, not a number, too large, not a whole number.
  integer, parameter :: number_good = 0, number_wrong = 1, number_range = 2, number_fraction = 3

  interface
    pure subroutine c_read_real(text, n, value, status) bind(c, name='real_of_text')
      import :: c_char, c_double, c_int
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int), value :: n
      real(c_double), intent(out) :: value
      integer(c_int), intent(out) :: status   !! one of the first three
    end subroutine c_read_real
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

  !> A real: `1.`, `.5`, `1e-3`, `1.0D0`, `8.9-3`; blanks around it are allowed.
  !> The value is the correctly rounded one. A magnitude of 1e300 and more is `number_range`:
  !> squares of deck values may be the only thing to overflow later.
  pure subroutine read_real(text, value, status)
    character(*), intent(in) :: text
    real(wp), intent(out) :: value
    integer, intent(out) :: status !! one of the `number_` constants

    call c_read_real(text, len(text), value, status)
  end subroutine read_real

  !> A whole number; `3.0` is one, `3.5` is not. Range: plus or minus 2^31 - 1.
  pure subroutine read_integer(text, value, status)
    character(*), intent(in) :: text
    integer, intent(out) :: value
    integer, intent(out) :: status !! one of the `number_` constants
    integer :: i, first, last, digit
    integer(long) :: number
    logical :: negative

    last = len_trim(text)
    first = verify(text(:last), ' ')
    negative = .false.
    number = 0
    value = 0
    status = number_wrong
    if (first == 0) return
    if (text(first:first) == '-' .or. text(first:first) == '+') then
      negative = text(first:first) == '-'
      first = first + 1
    end if
    if (first > last) return
    do i = first, last
      digit = iachar(text(i:i)) - iachar('0')
      if (digit < 0 .or. digit > 9) then
        call read_integral(text, value, status)
        return
      end if
      number = min(10*number + digit, 10_long**12)
    end do
    if (number > huge(value)) then
      status = number_range
      return
    end if
    status = number_good
    value = int(merge(-number, number, negative))
  end subroutine read_integer

  !> A whole number that is written as a real.
  pure subroutine read_integral(text, value, status)
    character(*), intent(in) :: text
    integer, intent(out) :: value
    integer, intent(out) :: status
    real(wp) :: number

    value = 0
    call read_real(text, number, status)
    if (status /= number_good) return
    if (abs(number) > real(huge(value), wp)) then
      status = number_range
    else if (abs(number - anint(number)) > 0.0_wp) then
      status = number_fraction
    else
      value = nint(number)
    end if
  end subroutine read_integral

  !> A text that may be missing.
  pure function text_of(text) result(known)
    character(:), allocatable, intent(in) :: text
    character(:), allocatable :: known

    known = ''
    if (allocated(text)) known = text
  end function text_of

  !> Bytes of the character of UTF-8 (RFC 3629) that a text begins with; 0 when it begins with none:
  !> overlong forms, halves of surrogate pairs and codes beyond 10FFFF are none.
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
