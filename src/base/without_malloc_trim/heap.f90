! SPDX-License-Identifier: MIT
!> Stands in where the C library cannot be asked to give back what is not used.
module heap_m
  use, intrinsic :: iso_c_binding, only : c_size_t, c_ptr
  implicit none
  private
  public :: give_back_memory, give_back_pages

contains

  !> The C library keeps or hands back what has been deallocated as it likes.
  subroutine give_back_memory()
  end subroutine give_back_memory

  !> Part of an array that nobody asks for any more stays as it is.
  subroutine give_back_pages(start, n_byte)
    type(c_ptr), intent(in) :: start
    integer(c_size_t), intent(in) :: n_byte

    associate (a => start, b => n_byte)
    end associate
  end subroutine give_back_pages

end module heap_m
