! SPDX-License-Identifier: MIT
!> Memory that the system refuses. The code that the compiler makes for `allocate` looks at the
!> answer; that for assignments which allocate, and for copies of derived types, does not and would
!> write through a null pointer. The linker hands all calls of this program for memory to the
!> procedures below (--wrap), which end it with a message.
module refused_memory_m
  use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_loc, c_ptr, c_size_t
  use c_files_m, only : c_write, c_exit
  implicit none
  private
  public :: expect_refusal, need_memory

  !> Whether the caller looks at the answer himself. A procedure of the C library has no argument to
  !> carry it, so that it is saved here.
  logical, save :: is_expected = .false.

  interface
    !> The C library's own.
    function c_malloc(n_byte) bind(c, name='__real_malloc') result(place)
      import :: c_ptr, c_size_t
      integer(c_size_t), value :: n_byte
      type(c_ptr) :: place
    end function c_malloc

    !> The C library's own.
    function c_calloc(n, n_byte) bind(c, name='__real_calloc') result(place)
      import :: c_ptr, c_size_t
      integer(c_size_t), value :: n, n_byte
      type(c_ptr) :: place
    end function c_calloc

    !> The C library's own.
    function c_realloc(old, n_byte) bind(c, name='__real_realloc') result(place)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: old
      integer(c_size_t), value :: n_byte
      type(c_ptr) :: place
    end function c_realloc

    !> C library: give memory back.
    subroutine c_free(place) bind(c, name='free')
      import :: c_ptr
      type(c_ptr), value :: place
    end subroutine c_free
  end interface

contains

  !> From now on, until told otherwise, an `allocate` with a status gets it.
  subroutine expect_refusal(yes)
    logical, intent(in) :: yes

    is_expected = yes
  end subroutine expect_refusal

  !> End the program here unless so much memory is to be had: before calls of a library that does
  !> not look at the answer.
  subroutine need_memory(n_byte)
    integer(c_size_t), intent(in) :: n_byte
    type(c_ptr) :: place

    place = c_malloc(n_byte)
    if (.not. c_associated(place)) call give_up(n_byte)
    call c_free(place)
  end subroutine need_memory

  !> In the place of malloc.
  function ask_malloc(n_byte) bind(c, name='__wrap_malloc') result(place)
    integer(c_size_t), value :: n_byte
    type(c_ptr) :: place

    place = c_malloc(n_byte)
    if (.not. c_associated(place) .and. n_byte > 0) call give_up(n_byte)
  end function ask_malloc

  !> In the place of calloc.
  function ask_calloc(n, n_byte) bind(c, name='__wrap_calloc') result(place)
    integer(c_size_t), value :: n, n_byte
    type(c_ptr) :: place

    place = c_calloc(n, n_byte)
    if (.not. c_associated(place) .and. n > 0 .and. n_byte > 0) call give_up(n*n_byte)
  end function ask_calloc

  !> In the place of realloc.
  function ask_realloc(old, n_byte) bind(c, name='__wrap_realloc') result(place)
    type(c_ptr), value :: old
    integer(c_size_t), value :: n_byte
    type(c_ptr) :: place

    place = c_realloc(old, n_byte)
    if (.not. c_associated(place) .and. n_byte > 0) call give_up(n_byte)
  end function ask_realloc

  !> Say what was refused and end; the handler of exits gives the status (endings_m). Nothing here
  !> may ask for memory.
  subroutine give_up(n_byte)
    integer(c_size_t), intent(in) :: n_byte
    character(*), parameter :: before = 'the system refuses memory: ', after = ' bytes more'
    character(80), target :: line
    character(20) :: digits
    integer(c_size_t) :: left, ignored
    integer :: i

    if (is_expected) return
    digits = ''
    left = n_byte
    do i = len(digits), 1, -1
      digits(i:i) = achar(iachar('0') + int(modulo(left, 10_c_size_t)))
      left = left/10
      if (left == 0) exit
    end do
    line = before
    line(len(before) + 1:) = digits(max(i, 1):)
    i = len(before) + len(digits) - max(i, 1) + 1
    line(i + 1:) = after//new_line('a')
    ignored = c_write(2_c_int, c_loc(line), int(i + len(after) + 1, c_size_t))
    call c_exit(1_c_int)
  end subroutine give_up

end module refused_memory_m
