! SPDX-License-Identifier: MIT
!> Files and directories by name: paths, whether they are there, making, removing and renaming them.
module files_m
  use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_null_char, c_ptr
  use c_files_m, only : c_mkdir, c_rename, c_unlink, c_fopen, c_fileno, c_fclose, c_fsync, &
    c_ftruncate, system_reason
  use errors_m, only : error_t, raise, status_files
  use file_facts_m, only : what_hinders
  use kinds_m, only : long
  implicit none
  private
  public :: join_path, parent_path, folder_of, file_exists, is_directory, make_directory, &
    remove_file, &
    rename_file, force_to_disk, lengthen_file, is_endless, fill_standard_streams, open_failure, &
    unfinished

  !> Behind the name of a file that is not complete: it is written aside and renamed when it is.
  character(*), parameter :: unfinished = '.part'

  !> Permissions of a new directory, before the user's mask: rwx for all.
  integer(c_int), parameter :: directory_mode = 511_c_int

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

  !> The directory that a file lies in, `.` of a bare name.
  pure function folder_of(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder

    folder = parent_path(path)
    if (len(folder) == 0) folder = '.'
  end function folder_of

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

  !> Give a file another name in the same directory, in one step; a file of that name is replaced,
  !> but nothing else.
  subroutine rename_file(old, new, error)
    character(*), intent(in) :: old, new
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    status = -1
    if (len(what_hinders(new)) == 0) status = c_rename(old//c_null_char, new//c_null_char)
    if (status /= 0) call raise(error, 'cannot rename '//old//' to '//new//': ' &
      //open_failure(new), status_files)
  end subroutine rename_file

  !> Bring what has been written to a file onto the disk itself, so that a power
  !> failure does not lose it.
  subroutine force_to_disk(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(c_ptr) :: stream
    integer(c_int) :: status, closing
    character(:), allocatable :: reason

    status = -1
    ! A directory opens for reading alone.
    stream = c_fopen(path//c_null_char, 'r'//c_null_char)
    if (c_associated(stream)) status = c_fsync(c_fileno(stream))
    reason = system_reason()
    closing = 0
    if (c_associated(stream)) closing = c_fclose(stream)
    if (status == 0 .and. closing /= 0) reason = system_reason()
    if (status /= 0 .or. closing /= 0) call raise(error, 'cannot bring '//path &
      //' onto the disk: '//reason, status_files)
  end subroutine force_to_disk

  !> Bring a file to at least a length, with zeros behind what it has.
  subroutine lengthen_file(path, length, is_done)
    character(*), intent(in) :: path
    integer(long), intent(in) :: length !! bytes
    logical, intent(out) :: is_done
    type(c_ptr) :: stream
    integer(long) :: n_byte
    integer(c_int) :: ignored

    inquire (file=path, size=n_byte)
    is_done = n_byte >= length
    if (is_done) return
    stream = c_fopen(path//c_null_char, 'r+'//c_null_char)
    if (.not. c_associated(stream)) return
    is_done = c_ftruncate(c_fileno(stream), length) == 0
    ignored = c_fclose(stream)
  end subroutine lengthen_file

  !> Whether `path` is there and is not a file of known size with something in it: a pipe, a device,
  !> or an empty file. To open a pipe could wait for ever, and a device may have no end.
  function is_endless(path) result(endless)
    character(*), intent(in) :: path
    logical :: endless
    integer(long) :: n_byte

    inquire (file=path, exist=endless, size=n_byte)
    endless = endless .and. n_byte <= 0
    if (endless) endless = .not. is_directory(path)
  end function is_endless

  !> Open the null device in place of standard streams that the caller has closed: a result file
  !> would take their number otherwise, and what is meant for the screen would go into it.
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

  !> Why a file cannot be made, in words; to be asked at once after the failure.
  function open_failure(path) result(reason)
    character(*), intent(in) :: path
    character(:), allocatable :: reason, from_system

    from_system = system_reason()
    reason = what_hinders(path)
    if (len(reason) > 0) return
    if (.not. is_directory(parent_path(path))) then
      reason = 'its directory does not exist'
    else
      reason = from_system
    end if
  end function open_failure

end module files_m
