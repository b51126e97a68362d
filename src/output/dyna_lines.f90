! SPDX-License-Identifier: MIT
!> Lines of DYNA's text files, and the numbers in them.
module dyna_lines_m
  use kinds_m, only : wp
  use number_text_m, only : integer_size, put_integer
  implicit none
  private
  public :: line_size, add_line, number

  !> Bytes of the longest line.
  integer, parameter :: line_size = 160

contains

  !> A whole number at the right of `width` columns, or of as many as it needs.
  pure function number(value, width) result(text)
    real(wp), intent(in) :: value
    integer, intent(in) :: width
    character(:), allocatable :: text
    character(integer_size) :: digits
    integer :: n

    call put_integer(nint(value), digits, n)
    text = repeat(' ', max(width - n, 0))//digits(:n)
  end function number

  !> One more line.
  pure subroutine add_line(line, lines, n_line)
    character(*), intent(in) :: line
    character(line_size), intent(inout) :: lines(:)
    integer, intent(inout) :: n_line

    n_line = n_line + 1
    lines(n_line) = line
  end subroutine add_line

end module dyna_lines_m
