! SPDX-License-Identifier: MIT
!> Giving back what is not used, by the GNU C library.
module heap_m
  use, intrinsic :: iso_c_binding, only : c_int, c_size_t
  implicit none
  private
  public :: give_back_memory

  interface
    !> Hand free pages of the heap back to the system, but for so many bytes at its end.
    function c_malloc_trim(pad) bind(c, name='malloc_trim') result(status)
      import :: c_int, c_size_t
      integer(c_size_t), value :: pad
      integer(c_int) :: status
    end function c_malloc_trim
  end interface

contains

  !> Hand back what has been deallocated: the C library keeps arrays of up to 32 MB for later.
  subroutine give_back_memory()
    integer(c_int) :: status

    status = c_malloc_trim(0_c_size_t)
  end subroutine give_back_memory

end module heap_m
