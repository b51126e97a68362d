! SPDX-License-Identifier: MIT
!> A share in per cent, as the log tells it.
module share_text_m
  use kinds_m, only : wp
  implicit none
  private
  public :: percent

contains

  !> `part` of `whole`, with two decimals.
  pure function percent(part, whole) result(text)
    real(wp), intent(in) :: part, whole
    character(:), allocatable :: text
    character(24) :: buffer

    text = 'all'
    if (.not. whole > 0.0_wp) return
    write (buffer, '(ss,es10.2)') 100.0_wp*part/whole
    if (100.0_wp*part < 1.0e4_wp*whole) write (buffer, '(ss,f8.2)') 100.0_wp*part/whole
    text = trim(adjustl(buffer))//' %'
  end function percent

end module share_text_m
