! SPDX-License-Identifier: MIT
!> Giving back what is not used, by the GNU C library.
module heap_m
  use, intrinsic :: iso_c_binding, only : c_int, c_size_t, c_intptr_t, c_ptr
  implicit none
  private
  public :: give_back_memory, give_back_pages

  !> MADV_DONTNEED of Linux: private pages lose what is in them and take no memory.
  integer(c_int), parameter :: not_needed = 4

  interface
    !> Hand free pages of the heap back to the system, but for so many bytes at its end.
    function c_malloc_trim(pad) bind(c, name='malloc_trim') result(status)
      import :: c_int, c_size_t
      integer(c_size_t), value :: pad
      integer(c_int) :: status
    end function c_malloc_trim

    !> Tell the system what pages are for.
    function c_madvise(address, length, advice) bind(c, name='madvise') result(status)
      import :: c_int, c_size_t, c_intptr_t
      integer(c_intptr_t), value :: address
      integer(c_size_t), value :: length
      integer(c_int), value :: advice
      integer(c_int) :: status
    end function c_madvise

    !> Bytes of a page.
    function c_page_size() bind(c, name='getpagesize') result(n_byte)
      import :: c_int
      integer(c_int) :: n_byte
    end function c_page_size
  end interface

contains

  !> Hand back what has been deallocated: the C library keeps arrays of up to 32 MB for later.
  subroutine give_back_memory()
    integer(c_int) :: status

    status = c_malloc_trim(0_c_size_t)
  end subroutine give_back_memory

  !> Hand back the pages that lie within a part of an array whose values nobody asks for any more.
  !> The part stays allocated: it reads zero, and takes memory again where it is written to.
  subroutine give_back_pages(start, n_byte)
    type(c_ptr), intent(in) :: start      !! of the part
    integer(c_size_t), intent(in) :: n_byte
    integer(c_intptr_t) :: first, last, page
    integer(c_int) :: status

    page = c_page_size()
    first = transfer(start, first)
    last = (first + int(n_byte, c_intptr_t))/page*page
    first = (first + page - 1)/page*page
    if (last > first) status = c_madvise(first, int(last - first, c_size_t), not_needed)
  end subroutine give_back_pages

end module heap_m
