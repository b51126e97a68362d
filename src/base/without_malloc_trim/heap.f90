! SPDX-License-Identifier: MIT
!> Stands in where the C library cannot be asked to give back what is not used.
module heap_m
  implicit none
  private
  public :: give_back_memory

contains

  !> The C library keeps or hands back what has been deallocated as it likes.
  subroutine give_back_memory()
  end subroutine give_back_memory

end module heap_m
