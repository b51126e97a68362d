! SPDX-License-Identifier: MIT
!> Lines of DYNA's text files, and the numbers in them.
module dyna_lines_m
  use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
  use kinds_m, only : wp
  implicit none
  private
  public :: line_size, add_line, number, tidy

  !> Bytes of the longest line.
  integer, parameter :: line_size = 160

contains

  !> A whole number at the right of `width` columns, or of as many as it needs.
  pure function number(value, width) result(text)
    real(wp), intent(in) :: value
    integer, intent(in) :: width
    character(:), allocatable :: text
    character(12) :: digits

    write (digits, '(ss,i12)') nint(value)
    text = digits(min(13 - width, verify(digits, ' ')):)
  end function number

  !> One more line.
  pure subroutine add_line(line, lines, n_line)
    character(*), intent(in) :: line
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line

    n_line = n_line + 1
    lines(n_line) = line
  end subroutine add_line

  !> A number whose exponent has two digits, which the columns are made for; NaN stays.
  pure elemental function tidy(value) result(printed)
    real(wp), intent(in) :: value
    real(wp) :: printed
    real(wp), parameter :: least = 1.0e-99_wp, most = 9.9e99_wp

    printed = value
    if (ieee_is_nan(value)) return
    if (abs(value) < least) printed = 0.0_wp
    if (abs(value) > most) printed = sign(most, value)
  end function tidy

end module dyna_lines_m
