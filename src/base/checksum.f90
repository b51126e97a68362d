! SPDX-License-Identifier: MIT
!> The cyclic redundancy check CRC-32 of IEEE 802.3 (that of zip and PNG): every change of up to 32
!> neighbouring bits is noticed, any other with all but one chance in four thousand million.
module checksum_m
  implicit none
  private
  public :: checksum_t, start_checksum, add_bytes, checksum_text

  !> 0xEDB88320, the polynomial with its bits reversed, as a signed integer.
  integer, parameter :: polynomial = -306674912

  !> A checksum that grows with the bytes.
  type :: checksum_t
    integer :: value = -1        !! complement of the checksum so far
    integer :: table(0:255) = 0  !! what a byte does
  end type checksum_t

contains

  !> The checksum of nothing.
  pure subroutine start_checksum(checksum)
    type(checksum_t), intent(out) :: checksum
    integer :: i, k, word

    do i = 0, 255
      word = i
      do k = 1, 8
        if (btest(word, 0)) then
          word = ieor(ishft(word, -1), polynomial)
        else
          word = ishft(word, -1)
        end if
      end do
      checksum%table(i) = word
    end do
  end subroutine start_checksum

  !> Take more bytes.
  pure subroutine add_bytes(checksum, bytes)
    type(checksum_t), intent(inout) :: checksum
    character(*), intent(in) :: bytes
    integer :: i, word

    word = checksum%value
    do i = 1, len(bytes)
      word = ieor(checksum%table(iand(ieor(word, ichar(bytes(i:i))), 255)), ishft(word, -8))
    end do
    checksum%value = word
  end subroutine add_bytes

  !> The checksum as eight hexadecimal digits.
  pure function checksum_text(checksum) result(text)
    type(checksum_t), intent(in) :: checksum
    character(8) :: text

    write (text, '(z8.8)') not(checksum%value)
  end function checksum_text

end module checksum_m
