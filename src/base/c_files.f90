! SPDX-License-Identifier: MIT
!> Files and directories as the C library has them. Text goes through its `write`
!> and not through a Fortran unit, for two reasons that were measured: gfortran's `flush` and
!> `close` report success on a full disk, and one `write` of whole lines leaves no half line
!> behind when the process is killed.
module c_files_m
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_loc, c_ptr, c_size_t, c_sizeof
  implicit none
  private
  public :: c_mkdir, c_rename, c_unlink, c_write, c_fopen, c_fileno, c_fclose, c_fsync, &
    c_flock, c_ftruncate, c_memcpy, c_exit, system_reason, system_failure

  interface
    !> POSIX mkdir; 0 on success.
    function c_mkdir(path, mode) bind(c, name='mkdir') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*) !! ends with a null
      integer(c_int), value :: mode                 !! permissions
      integer(c_int) :: status
    end function c_mkdir

    !> C rename; 0 on success.
    function c_rename(old, new) bind(c, name='rename') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: old(*), new(*) !! end with a null
      integer(c_int) :: status
    end function c_rename

    !> POSIX unlink; 0 on success. Unlike `remove` it takes no directories.
    function c_unlink(path) bind(c, name='unlink') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*) !! ends with a null
      integer(c_int) :: status
    end function c_unlink

    !> POSIX write; bytes taken (ssize_t has the width of size_t), or -1.
    function c_write(descriptor, bytes, n_byte) bind(c, name='write') result(n_taken)
      import :: c_int, c_ptr, c_size_t
      integer(c_int), value :: descriptor   !! of the open file
      type(c_ptr), value :: bytes           !! first byte
      integer(c_size_t), value :: n_byte    !! how many
      integer(c_size_t) :: n_taken
    end function c_write

    !> C fopen; null on failure. (POSIX `open` has a varying number of arguments, which Fortran
    !> cannot call.)
    function c_fopen(path, mode) bind(c, name='fopen') result(stream)
      import :: c_char, c_ptr
      character(kind=c_char), intent(in) :: path(*), mode(*) !! end with a null
      type(c_ptr) :: stream
    end function c_fopen

    !> POSIX fileno: descriptor of a stream.
    function c_fileno(stream) bind(c, name='fileno') result(descriptor)
      import :: c_int, c_ptr
      type(c_ptr), value :: stream
      integer(c_int) :: descriptor
    end function c_fileno

    !> C fclose; 0 on success.
    function c_fclose(stream) bind(c, name='fclose') result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_fclose

    !> POSIX fsync; 0 on success.
    function c_fsync(descriptor) bind(c, name='fsync') result(status)
      import :: c_int
      integer(c_int), value :: descriptor   !! of the open file
      integer(c_int) :: status
    end function c_fsync

    !> BSD flock; 0 on success.
    function c_flock(descriptor, operation) bind(c, name='flock') result(status)
      import :: c_int
      integer(c_int), value :: descriptor   !! of the open file
      integer(c_int), value :: operation
      integer(c_int) :: status
    end function c_flock

    !> POSIX ftruncate; 0 on success. (The type of the length, off_t, has the width of size_t.)
    function c_ftruncate(descriptor, length) bind(c, name='ftruncate') result(status)
      import :: c_int, c_size_t
      integer(c_int), value :: descriptor   !! of the open file
      integer(c_size_t), value :: length    !! bytes that stay
      integer(c_int) :: status
    end function c_ftruncate

    !> C library: end the process with a status; handlers of exits are called.
    subroutine c_exit(status) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine c_exit

    !> Where the C library of Linux keeps `errno`.
    function c_errno() bind(c, name='__errno_location') result(place)
      import :: c_ptr
      type(c_ptr) :: place
    end function c_errno

    !> C strerror: a number of `errno` in words.
    function c_strerror(number) bind(c, name='strerror') result(text)
      import :: c_int, c_ptr
      integer(c_int), value :: number
      type(c_ptr) :: text
    end function c_strerror

    !> C strlen.
    function c_strlen(text) bind(c, name='strlen') result(n)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: text
      integer(c_size_t) :: n
    end function c_strlen

    !> C memcpy.
    function c_memcpy(to, from, n_byte) bind(c, name='memcpy') result(same)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: to, from
      integer(c_size_t), value :: n_byte
      type(c_ptr) :: same
    end function c_memcpy
  end interface

contains

  !> Number of the C library's last failure (`errno`).
  function system_failure() result(number)
    integer(c_int), target :: number
    type(c_ptr) :: ignored

    ignored = c_memcpy(c_loc(number), c_errno(), c_sizeof(number))
  end function system_failure

  !> What the C library says of its last failure.
  function system_reason() result(reason)
    character(:), allocatable, target :: reason
    type(c_ptr) :: text, ignored

    text = c_strerror(system_failure())
    allocate (character(c_strlen(text)) :: reason)
    ignored = c_memcpy(c_loc(reason), text, len(reason, c_size_t))
  end function system_reason

end module c_files_m
