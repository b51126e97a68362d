! SPDX-License-Identifier: MIT
!> Cyclic redundancy check CRC-32 of IEEE 802.3 (as in zip and PNG), by zlib: it detects every error
!> burst of up to 32 bits, and any other error with probability 1 - 2^-32.
module checksum_m
  use, intrinsic :: iso_c_binding, only : c_char, c_long, c_size_t
  use kinds_m, only : long
  implicit none
  private
  public :: add_bytes, checksum_text

  interface
    pure function c_crc32(before, bytes, n) bind(c, name='crc32_z') result(crc)
      import :: c_char, c_long, c_size_t
      integer(c_long), value :: before
      character(kind=c_char), intent(in) :: bytes(*)
      integer(c_size_t), value :: n
      integer(c_long) :: crc
    end function c_crc32
  end interface

contains

  !> Update the checksum with more bytes.
  pure subroutine add_bytes(checksum, bytes)
    integer(long), intent(inout) :: checksum   !! 0 of nothing
    character(*), intent(in) :: bytes

    checksum = c_crc32(checksum, bytes, len(bytes, c_size_t))
  end subroutine add_bytes

  !> The checksum as eight hexadecimal digits.
  pure function checksum_text(checksum) result(text)
    integer(long), intent(in) :: checksum
    character(8) :: text

    write (text, '(z8.8)') checksum
  end function checksum_text

end module checksum_m
