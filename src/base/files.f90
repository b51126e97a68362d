! SPDX-License-Identifier: MIT
!> Files and directories: paths, directories with their parents, and text files that are written in
!> whole buffers.
!>
!> Text goes through the C library's `creat` and `write` and not through a Fortran unit, for two
!> reasons that were measured: gfortran's `flush` and `close` report success on a full disk, and one
!> `write` of whole lines leaves no half line behind when the process is killed.
module files_m
  use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_int, c_loc, c_null_char, &
    c_null_ptr, c_ptr, c_size_t, c_sizeof
  use errors_m, only : error_t, raise, status_files
  use kinds_m, only : long
  implicit none
  private
  public :: join_path, parent_path, file_exists, is_directory, make_directory, &
    remove_file, rename_file, force_to_disk, is_endless, &
    fill_standard_streams, &
    text_file_t, create_text_file, continue_text_file, append_text, close_text_file

  !> Permissions of what is made, before the user's mask: rwx for all, rw for all.
  integer(c_int), parameter :: directory_mode = 511_c_int, file_mode = 438_c_int

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path   !! for messages
    integer(c_int) :: descriptor = -1   !! -1 while no file is open
    type(c_ptr) :: stream = c_null_ptr  !! C stream that owns the descriptor, where there is one
  end type text_file_t

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

    !> POSIX creat; a descriptor, or -1.
    function c_creat(path, mode) bind(c, name='creat') result(descriptor)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*) !! ends with a null
      integer(c_int), value :: mode                 !! permissions
      integer(c_int) :: descriptor
    end function c_creat

    !> POSIX write; bytes taken (ssize_t has the width of size_t), or -1.
    function c_write(descriptor, bytes, n_byte) bind(c, name='write') result(n_taken)
      import :: c_int, c_ptr, c_size_t
      integer(c_int), value :: descriptor   !! of the open file
      type(c_ptr), value :: bytes           !! first byte
      integer(c_size_t), value :: n_byte    !! how many
      integer(c_size_t) :: n_taken
    end function c_write

    !> POSIX close; 0 on success.
    function c_close(descriptor) bind(c, name='close') result(status)
      import :: c_int
      integer(c_int), value :: descriptor   !! of the open file
      integer(c_int) :: status
    end function c_close

    !> C fopen; null on failure. (POSIX `open` has a varying number of arguments, which Fortran cannot call.)
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

  !> `directory/name` with one slash between; `name` alone when the directory is empty or `name`
  !> starts at the root.
  pure function join_path(directory, name) result(path)
    character(*), intent(in) :: directory
    character(*), intent(in) :: name
    character(:), allocatable :: path
    integer :: n

    n = len(directory)
    if (n == 0 .or. index(name, '/') == 1) then
      path = name
    else if (directory(n:n) == '/') then
      path = directory//name
    else
      path = directory//'/'//name
    end if
  end function join_path

  !> The directory a path lies in: `/` at the root, empty for a bare name.
  pure function parent_path(path) result(parent)
    character(*), intent(in) :: path
    character(:), allocatable :: parent
    integer :: last

    last = len(path)
    do while (last > 1)
      if (path(last:last) /= '/') exit
      last = last - 1
    end do
    last = index(path(:last), '/', back=.true.)
    do while (last > 1)
      if (path(last:last) /= '/') exit
      last = last - 1
    end do
    parent = path(:last)
  end function parent_path

  !> Whether there is something of this name (a file or a directory). Blanks at the end of the name
  !> are significant to the file system but not to Fortran: they are not seen here.
  function file_exists(path) result(found)
    character(*), intent(in) :: path
    logical :: found

    inquire (file=path, exist=found)
  end function file_exists

  !> Whether `path` is a directory (the empty path is the current one).
  function is_directory(path) result(found)
    character(*), intent(in) :: path
    logical :: found

    if (len(path) == 0) then
      found = .true.
    else
      inquire (file=path//'/.', exist=found)
    end if
  end function is_directory

  !> Make a directory with its parents; nothing happens to one that is there. No shell is
  !> involved, so blanks and quotes in the name are safe.
  recursive subroutine make_directory(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: reason
    integer(c_int) :: status

    if (is_directory(path)) return
    call make_directory(parent_path(path), error)
    if (allocated(error)) return
    status = c_mkdir(path//c_null_char, directory_mode)
    reason = system_reason()
    if (is_directory(path)) return
    if (file_exists(path)) then
      call raise(error, 'cannot make the directory '//path//': a file of this name is in the way', &
        status_files)
    else
      call raise(error, 'cannot make the directory '//path//': '//reason, status_files)
    end if
  end subroutine make_directory

  !> Remove a file; nothing happens when there is none.
  subroutine remove_file(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    if (.not. file_exists(path)) return
    status = c_unlink(path//c_null_char)
    if (status /= 0) call raise(error, 'cannot replace '//path//': '//open_failure(path), &
      status_files)
  end subroutine remove_file

  !> Give a file another name in the same directory, in one step; a file of that name is replaced.
  subroutine rename_file(old, new, error)
    character(*), intent(in) :: old, new
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    status = c_rename(old//c_null_char, new//c_null_char)
    if (status /= 0) call raise(error, 'cannot rename '//old//' to '//new//': '//open_failure(new), &
      status_files)
  end subroutine rename_file

  !> Bring what has been written to a file onto the disk itself, so that a power failure does not lose it.
  subroutine force_to_disk(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(c_ptr) :: stream
    integer(c_int) :: status, ignored
    character(:), allocatable :: reason

    status = -1
    ! A directory opens for reading alone.
    stream = c_fopen(path//c_null_char, 'r'//c_null_char)
    if (c_associated(stream)) status = c_fsync(c_fileno(stream))
    reason = system_reason()
    if (c_associated(stream)) ignored = c_fclose(stream)
    if (status /= 0) call raise(error, 'cannot bring '//path//' onto the disk: '//reason, status_files)
  end subroutine force_to_disk

  !> Whether `path` is there and is not a file of known size with something in it: a pipe, a device, or an empty
  !> file. To open a pipe could wait for ever, and a device may have no end.
  function is_endless(path) result(endless)
    character(*), intent(in) :: path
    logical :: endless
    integer(long) :: n_byte

    inquire (file=path, exist=endless, size=n_byte)
    endless = endless .and. n_byte <= 0
    if (endless) endless = .not. is_directory(path)
  end function is_endless

  !> Open the null device in place of standard streams that the caller has closed: a result file would take
  !> their number otherwise, and what is meant for the screen would go into it.
  subroutine fill_standard_streams()
    type(c_ptr) :: stream
    integer(c_int) :: ignored

    do
      stream = c_fopen('/dev/null'//c_null_char, 'r+'//c_null_char)
      if (.not. c_associated(stream)) exit
      if (c_fileno(stream) > 2) then
        ignored = c_fclose(stream)
        exit
      end if
    end do
  end subroutine fill_standard_streams

  !> What the C library says of its last failure.
  function system_reason() result(reason)
    character(:), allocatable, target :: reason
    integer(c_int), target :: number
    type(c_ptr) :: text, ignored

    ignored = c_memcpy(c_loc(number), c_errno(), c_sizeof(number))
    text = c_strerror(number)
    allocate (character(c_strlen(text)) :: reason)
    ignored = c_memcpy(c_loc(reason), text, len(reason, c_size_t))
  end function system_reason

  !> Make a text file, empty; one of the same name is emptied.
  subroutine create_text_file(file, path, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    file%path = path
    file%descriptor = c_creat(path//c_null_char, file_mode)
    if (file%descriptor < 0) call raise(error, 'cannot write '//path//': '// &
      open_failure(path), status_files)
  end subroutine create_text_file

  !> Open a text file to write on behind what it holds; it is made when there is none.
  subroutine continue_text_file(file, path, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    file%path = path
    file%stream = c_fopen(path//c_null_char, 'a'//c_null_char)
    if (c_associated(file%stream)) then
      file%descriptor = c_fileno(file%stream)
    else
      call raise(error, 'cannot write '//path//': '//open_failure(path), status_files)
    end if
  end subroutine continue_text_file

  !> Why a file cannot be made, in words; to be asked at once after the failure.
  function open_failure(path) result(reason)
    character(*), intent(in) :: path
    character(:), allocatable :: reason, from_system

    from_system = system_reason()
    if (is_directory(path)) then
      reason = 'it is a directory'
    else if (.not. is_directory(parent_path(path))) then
      reason = 'its directory does not exist'
    else
      reason = from_system
    end if
  end function open_failure

  !> Append text as it is, line ends included, with one system call as long as the system takes all.
  subroutine append_text(file, text, error)
    type(text_file_t), intent(in) :: file
    character(*), intent(in), target :: text
    type(error_t), allocatable, intent(out) :: error
    integer(long) :: n_written, n_taken

    n_written = 0
    do while (n_written < len(text, long))
      n_taken = int(c_write(file%descriptor, c_loc(text(n_written + 1:n_written + 1)), &
        int(len(text, long) - n_written, c_size_t)), long)
      if (n_taken <= 0) then
        call raise(error, 'cannot write on to '//file%path//': '//system_reason(), status_files)
        return
      end if
      n_written = n_written + n_taken
    end do
  end subroutine append_text

  !> Close; nothing happens when no file is open.
  subroutine close_text_file(file, error)
    type(text_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    if (file%descriptor < 0) return
    if (c_associated(file%stream)) then
      status = c_fclose(file%stream)
    else
      status = c_close(file%descriptor)
    end if
    file%stream = c_null_ptr
    file%descriptor = -1
    if (status /= 0) call raise(error, 'cannot close '//file%path// &
      ': the file system refused the last bytes', status_files)
  end subroutine close_text_file

end module files_m
