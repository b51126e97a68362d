! SPDX-License-Identifier: MIT
!> Powers and functions in expressions of the deck, defined wherever they cannot raise an
!> arithmetic exception.
module deck_functions_m
  use kinds_m, only : wp
  implicit none
  private
  public :: raise_power, apply_function

contains

  !> value = value ** power where that is defined and not too large.
  pure subroutine raise_power(power, value, trouble)
    real(wp), intent(in) :: power
    real(wp), intent(inout) :: value
    character(:), allocatable, intent(out) :: trouble !! empty when all is well
    logical :: whole

    trouble = ''
    whole = abs(power) < 1.0e6_wp
    if (whole) whole = abs(power - anint(power)) <= 0.0_wp
    if (.not. abs(value) > 0.0_wp) then
      if (power < 0.0_wp) trouble = 'division by zero'
      if (abs(power) > 0.0_wp) then
        value = 0.0_wp
      else
        value = 1.0_wp
      end if
    else if (value < 0.0_wp .and. .not. whole) then
      trouble = 'a negative number to a power that is not whole'
    else if (exponent(power) > 60 .or. exponent(value) > 1000) then
      trouble = 'the value is too large'
    else if (power*log(abs(value)) > 690.0_wp) then
      trouble = 'the value is too large'
    else if (power*log(abs(value)) < -700.0_wp) then
      value = 0.0_wp
    else if (whole) then
      value = value**nint(power)
    else
      value = value**power
    end if
  end subroutine raise_power

  !> Value of a function.
  pure subroutine apply_function(word, a, value, trouble)
    character(*), intent(in) :: word
    real(wp), intent(in) :: a(:)
    real(wp), intent(out) :: value
    character(:), allocatable, intent(out) :: trouble !! empty when all is well
    logical :: inside

    trouble = ''
    value = 0.0_wp
    inside = abs(a(1)) < 1.0e15_wp
    select case (word)
    case ('MIN', 'MAX', 'MOD', 'SIGN', 'ATAN2')
      if (size(a) < 2) trouble = word//' needs two arguments'
    case default
      if (size(a) /= 1) trouble = word//' takes one argument'
    end select
    if (len(trouble) > 0) return
    select case (word)
    case ('SIN'); if (inside) value = sin(a(1))
    case ('COS'); if (inside) value = cos(a(1))
    case ('TAN'); if (inside) value = tan(a(1))
    case ('ASIN', 'ACOS')
      inside = abs(a(1)) <= 1.0_wp
      if (inside .and. word == 'ASIN') value = asin(a(1))
      if (inside .and. word == 'ACOS') value = acos(a(1))
    case ('ATAN'); value = atan(a(1)); inside = .true.
    case ('ATAN2')
      inside = abs(a(1)) > 0.0_wp .or. abs(a(2)) > 0.0_wp
      if (inside) value = atan2(a(1), a(2))
    case ('SQRT')
      inside = a(1) >= 0.0_wp
      if (inside) value = sqrt(a(1))
    case ('EXP')
      inside = a(1) <= 690.0_wp
      if (inside .and. a(1) > -700.0_wp) value = exp(a(1))
    case ('LOG', 'LOG10')
      inside = a(1) > 0.0_wp
      if (inside .and. word == 'LOG') value = log(a(1))
      if (inside .and. word == 'LOG10') value = log10(a(1))
    case ('ABS'); value = abs(a(1)); inside = .true.
    case ('INT'); if (inside) value = aint(a(1))
    case ('NINT'); if (inside) value = anint(a(1))
    case ('MOD')
      inside = abs(a(2)) > 0.0_wp .and. exponent(a(1)) - exponent(a(2)) < 52
      if (inside) value = mod(a(1), a(2))
    case ('SIGN'); value = sign(a(1), a(2)); inside = .true.
    case ('MIN'); value = minval(a); inside = .true.
    case ('MAX'); value = maxval(a); inside = .true.
    case default
      trouble = 'there is no function '//word
      return
    end select
    if (.not. inside) trouble = word//' is not defined there'
  end subroutine apply_function

end module deck_functions_m
