! SPDX-License-Identifier: MIT
!> Text to numbers and back, and letter case.
!> Plain numbers are read without the run-time library; where that could miss the correctly rounded
!> value the library reads them.
module text_m
  use kinds_m, only : wp, long
  implicit none
  private
  public :: upper_case, read_real, read_integer, text_of, &
    number_good, number_wrong, number_range, number_fraction

  !> Outcome of reading a number: good, not a number, too large, not a whole number.
  integer, parameter :: number_good = 0, number_wrong = 1, number_range = 2, number_fraction = 3

  !> Largest decimal exponent accepted, far inside the range of the working precision, so that
  !> squares of deck values may be the only thing to overflow later.
  integer, parameter :: largest_exponent = 300
  !> Powers of ten that are exact in the working precision.
  real(wp), parameter :: ten_to(0:22) = [1e0_wp, 1e1_wp, 1e2_wp, 1e3_wp, 1e4_wp, 1e5_wp, 1e6_wp, &
    1e7_wp, 1e8_wp, 1e9_wp, 1e10_wp, 1e11_wp, 1e12_wp, 1e13_wp, 1e14_wp, 1e15_wp, 1e16_wp, &
    1e17_wp, 1e18_wp, 1e19_wp, 1e20_wp, 1e21_wp, 1e22_wp]

  !> A number taken apart: sign * mantissa * 10**exponent.
  type :: parts_t
    logical :: negative = .false.
    integer(long) :: mantissa = 0    !! leading significant digits
    integer :: n_digit = 0           !! significant digits in the mantissa
    integer :: exponent = 0          !! power of ten
    logical :: cut = .false.         !! digits other than zero were left out
    logical :: good = .false.        !! the text is a number
  end type parts_t

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
  !> The value is the correctly rounded one. A magnitude of 1e300 and more is `number_range`.
  pure subroutine read_real(text, value, status)
    character(*), intent(in) :: text
    real(wp), intent(out) :: value
    integer, intent(out) :: status !! one of the `number_` constants
    type(parts_t) :: parts

    value = 0.0_wp
    call split_number(text, parts)
    if (.not. parts%good) then
      status = number_wrong
    else if (parts%mantissa == 0) then
      status = number_good
    else if (parts%n_digit + parts%exponent > largest_exponent) then
      status = number_range
    else if (parts%n_digit + parts%exponent < -330) then
      status = number_good
    else
      status = number_good
      call compose_real(text, parts, value)
    end if
  end subroutine read_real

  !> Take a number apart in one pass.
  pure subroutine split_number(text, parts)
    character(*), intent(in) :: text
    type(parts_t), intent(out) :: parts
    integer :: i, last, digit, n_seen
    logical :: after_point

    last = len_trim(text)
    i = 1
    do while (i <= last)
      if (text(i:i) /= ' ') exit
      i = i + 1
    end do
    if (i > last) return
    if (text(i:i) == '-' .or. text(i:i) == '+') then
      parts%negative = text(i:i) == '-'
      i = i + 1
    end if
    after_point = .false.
    n_seen = 0
    do while (i <= last)
      digit = iachar(text(i:i)) - iachar('0')
      if (digit >= 0 .and. digit <= 9) then
        n_seen = n_seen + 1
        call take_digit(parts, digit, after_point)
      else if (text(i:i) == '.' .and. .not. after_point) then
        after_point = .true.
      else
        exit
      end if
      i = i + 1
    end do
    if (n_seen == 0) return
    parts%good = .true.
    if (i <= last) call take_exponent(text(i:last), parts)
  end subroutine split_number

  !> One more digit of the mantissa.
  pure subroutine take_digit(parts, digit, after_point)
    type(parts_t), intent(inout) :: parts
    integer, intent(in) :: digit
    logical, intent(in) :: after_point !! whether the decimal point has passed

    if (parts%n_digit < 18) then
      parts%mantissa = 10*parts%mantissa + digit
      if (parts%mantissa > 0) parts%n_digit = parts%n_digit + 1
      if (after_point) parts%exponent = parts%exponent - 1
    else
      if (digit > 0) parts%cut = .true.
      if (.not. after_point) parts%exponent = parts%exponent + 1
    end if
  end subroutine take_digit

  !> The exponent: a letter, a sign and digits, or a sign and digits.
  pure subroutine take_exponent(text, parts)
    character(*), intent(in) :: text
    type(parts_t), intent(inout) :: parts
    integer :: i, digit, exponent
    logical :: negative

    parts%good = .false.
    i = 1
    if (scan(text(1:1), 'eEdD') == 1) i = 2
    if (i > len(text)) return
    negative = .false.
    if (text(i:i) == '-' .or. text(i:i) == '+') then
      negative = text(i:i) == '-'
      i = i + 1
    else if (i == 1) then
      return
    end if
    if (i > len(text)) return
    exponent = 0
    do i = i, len(text)
      digit = iachar(text(i:i)) - iachar('0')
      if (digit < 0 .or. digit > 9) return
      exponent = min(10*exponent + digit, 9999)
    end do
    parts%exponent = parts%exponent + merge(-exponent, exponent, negative)
    parts%good = .true.
  end subroutine take_exponent

  !> Value of a number taken apart: exact arithmetic where both factors are exact (one rounding),
  !> the run-time library elsewhere.
  pure subroutine compose_real(text, parts, value)
    character(*), intent(in) :: text
    type(parts_t), intent(in) :: parts
    real(wp), intent(out) :: value
    character(len(text) + 12) :: plain
    integer :: status, n, i

    if (.not. parts%cut .and. parts%mantissa <= 2_long**53 .and. abs(parts%exponent) <= 22) then
      value = real(parts%mantissa, wp)
      if (parts%exponent < 0) then
        value = value/ten_to(-parts%exponent)
      else
        value = value*ten_to(parts%exponent)
      end if
      if (parts%negative) value = -value
      return
    end if
    plain = ''
    n = 0
    do i = 1, len(text)
      select case (text(i:i))
      case ('0':'9', '.')
        call append(plain, n, text(i:i))
      case ('-', '+')
        if (n > 0) then
          if (plain(n:n) /= 'E') call append(plain, n, 'E')
        end if
        call append(plain, n, text(i:i))
      case ('e', 'E', 'd', 'D')
        call append(plain, n, 'E')
      end select
    end do
    value = 0.0_wp
    read (plain(:n), *, iostat=status) value
    if (status /= 0) value = 0.0_wp
  end subroutine compose_real

  !> One more character of a text.
  pure subroutine append(text, n, character_given)
    character(*), intent(inout) :: text
    integer, intent(inout) :: n      !! characters so far
    character, intent(in) :: character_given

    n = n + 1
    text(n:n) = character_given
  end subroutine append

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

end module text_m
