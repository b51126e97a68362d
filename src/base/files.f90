! SPDX-License-Identifier: MIT
!> Files and directories: paths, directories with their parents, and text files that are written in
!> whole buffers.
!>
!> Text goes through the C library's `creat` and `write` and not through a Fortran unit, for two
!> reasons that were measured: gfortran's `flush` and `close` report success on a full disk, and one
!> `write` of whole lines leaves no half line behind when the process is killed.
module files_m
  use, intrinsic :: iso_c_binding, only : c_char, c_int, c_size_t, c_ptr, c_loc, c_null_char
  use errors_m, only : error_t, raise, status_files
  use kinds_m, only : long
  implicit none
  private
  public :: join_path, parent_path, file_exists, is_directory, make_directory, &
    remove_file, rename_file, &
    text_file_t, create_text_file, append_text, close_text_file

  !> Permissions of what is made, before the user's mask: rwx for all, rw for all.
  integer(c_int), parameter :: directory_mode = 511_c_int, file_mode = 438_c_int

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path   !! for messages
    integer(c_int) :: descriptor = -1   !! -1 while no file is open
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

    !> C remove; 0 on success.
    function c_remove(path) bind(c, name='remove') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*) !! ends with a null
      integer(c_int) :: status
    end function c_remove

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
    integer(c_int) :: status

    if (is_directory(path)) return
    call make_directory(parent_path(path), error)
    if (allocated(error)) return
    status = c_mkdir(path//c_null_char, directory_mode)
    if (is_directory(path)) return
    if (file_exists(path)) then
      call raise(error, 'cannot make the directory '//path//': a file of this name is in the way', &
        status_files)
    else
      call raise(error, 'cannot make the directory '//path//' (no permission, or no space)', &
        status_files)
    end if
  end subroutine make_directory

  !> Remove a file; nothing happens when there is none.
  subroutine remove_file(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    if (.not. file_exists(path)) return
    status = c_remove(path//c_null_char)
    if (status /= 0) call raise(error, 'cannot replace '//path//': '//open_failure(path), &
      status_files)
  end subroutine remove_file

  !> Give a file another name in the same directory, in one step; a file of that name is replaced.
  subroutine rename_file(old, new, error)
    character(*), intent(in) :: old, new
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    status = c_rename(old//c_null_char, new//c_null_char)
    if (status /= 0) call raise(error, 'cannot rename '//old//' to '//new, status_files)
  end subroutine rename_file

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

  !> Why a file cannot be made, in words.
  function open_failure(path) result(reason)
    character(*), intent(in) :: path
    character(:), allocatable :: reason

    if (is_directory(path)) then
      reason = 'it is a directory'
    else if (.not. is_directory(parent_path(path))) then
      reason = 'its directory does not exist'
    else
      reason = 'no permission, or no space'
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
        call raise(error, 'cannot write on to '//file%path// &
          ': the file system takes no more (is the disk full?)', status_files)
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
    status = c_close(file%descriptor)
    file%descriptor = -1
    if (status /= 0) call raise(error, 'cannot close '//file%path// &
      ': the file system refused the last bytes', status_files)
  end subroutine close_text_file

end module files_m
