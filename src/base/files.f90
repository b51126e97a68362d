! SPDX-License-Identifier: MIT
!> Files and directories: paths, kind, identity and length of a file, create, remove, rename; by the
!> C library, which gives the reason of a failure.
module files_m
  use, intrinsic :: iso_c_binding, only : c_bool, c_char, c_int, c_int64_t, c_null_char, c_size_t
  use errors_m, only : error_t, raise, status_files
  use kinds_m, only : long
  implicit none
  private
  public :: join_path, parent_path, folder_of, file_exists, is_directory, make_directory, &
    remove_file, rename_file, force_to_disk, lengthen_file, is_endless, open_failure, &
    system_reason, unfinished, file_facts_t, facts_of_name, facts_of_target, &
    facts_of_descriptor, write_obstacle, is_same_file

  !> Suffix of an incomplete file; the file is renamed when it is complete.
  character(*), parameter :: unfinished = '.part'

  !> Properties of a file.
  type, bind(c) :: file_facts_t
    logical(c_bool) :: is_there = .false._c_bool
    logical(c_bool) :: is_regular = .false._c_bool
    integer(c_int) :: kind = 0         !! 0 regular file, others: see `write_obstacle`
    integer(c_int64_t) :: device = 0   !! of the file system
    integer(c_int64_t) :: identity = 0 !! inode, unique within a device
    integer(c_int64_t) :: n_name = 0   !! hard links; 0: removed while open
    integer(c_int64_t) :: n_byte = 0   !! length
  end type file_facts_t

  ! Paths end with a null; a status of 0 is success.
  abstract interface
    function call_by_path(path) bind(c) result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function call_by_path
  end interface

  !> Create a directory; remove a file; flush a file or directory to the disk (system.cpp).
  procedure(call_by_path), bind(c, name='make_folder') :: c_mkdir
  procedure(call_by_path), bind(c, name='unlink') :: c_unlink
  procedure(call_by_path), bind(c, name='force_path') :: c_force

  interface
    function c_rename(old, new) bind(c, name='rename') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: old(*), new(*)
      integer(c_int) :: status
    end function c_rename

    !> The type of the length, off_t, has the width of size_t.
    function c_truncate(path, length) bind(c, name='truncate') result(status)
      import :: c_char, c_int, c_size_t
      character(kind=c_char), intent(in) :: path(*)
      integer(c_size_t), value :: length            !! bytes
      integer(c_int) :: status
    end function c_truncate

    !> Properties of an open file or of a path (system.cpp).
    subroutine c_facts(descriptor, path, follows, facts) bind(c, name='find_facts')
      import :: c_bool, c_char, c_int, file_facts_t
      integer(c_int), value :: descriptor           !! below 0: by name
      character(kind=c_char), intent(in) :: path(*)
      logical(c_bool), value :: follows             !! symbolic links
      type(file_facts_t), intent(out) :: facts
    end subroutine c_facts

    !> Reason of the last failure of the system (system.cpp).
    subroutine c_reason(text, n) bind(c, name='reason_text')
      import :: c_char, c_int
      character(kind=c_char), intent(out) :: text(*)
      integer(c_int), value :: n                    !! length of `text`, which blanks fill
    end subroutine c_reason
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

  !> The directory that a file lies in, `.` of a bare name.
  pure function folder_of(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder

    folder = parent_path(path)
    if (len(folder) == 0) folder = '.'
  end function folder_of

  !> Whether a file or directory of this name exists. Trailing blanks of the name, significant to
  !> the file system, are ignored here as in Fortran.
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

  !> Create a directory with its parents, unless it exists. No shell is involved, so blanks and
  !> quotes in the name are safe.
  recursive subroutine make_directory(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: reason
    integer(c_int) :: status

    if (is_directory(path)) return
    call make_directory(parent_path(path), error)
    if (allocated(error)) return
    status = c_mkdir(path//c_null_char)
    reason = system_reason()
    if (is_directory(path)) return
    if (file_exists(path)) then
      call raise(error, 'cannot make the directory '//path//': a file of this name is in the way', &
        status_files)
    else
      call raise(error, 'cannot make the directory '//path//': '//reason, status_files)
    end if
  end subroutine make_directory

  !> Remove a file if it exists.
  subroutine remove_file(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    if (.not. file_exists(path)) return
    status = c_unlink(path//c_null_char)
    if (status /= 0) call raise(error, 'cannot replace '//path//': '//open_failure(path), &
      status_files)
  end subroutine remove_file

  !> Rename a file within its directory, atomically; only a regular file is replaced.
  subroutine rename_file(old, new, error)
    character(*), intent(in) :: old, new
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    status = -1
    if (len(write_obstacle(new)) == 0) status = c_rename(old//c_null_char, new//c_null_char)
    if (status /= 0) call raise(error, 'cannot rename '//old//' to '//new//': ' &
      //open_failure(new), status_files)
  end subroutine rename_file

  !> Flush a file to the disk, so that it survives a power failure.
  subroutine force_to_disk(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    if (c_force(path//c_null_char) /= 0) call raise(error, 'cannot flush '//path &
      //' to the disk: '//system_reason(), status_files)
  end subroutine force_to_disk

  !> Extend a file with zeros to at least a length.
  subroutine lengthen_file(path, length, is_done)
    character(*), intent(in) :: path
    integer(long), intent(in) :: length !! bytes
    logical, intent(out) :: is_done
    integer(long) :: n_byte

    inquire (file=path, size=n_byte)
    is_done = n_byte >= length
    if (.not. is_done) is_done = c_truncate(path//c_null_char, length) == 0
  end subroutine lengthen_file

  !> Whether `path` is a pipe, a device or an empty file: opening a pipe may block, and a device may
  !> have no end.
  function is_endless(path) result(endless)
    character(*), intent(in) :: path
    logical :: endless
    integer(long) :: n_byte

    inquire (file=path, exist=endless, size=n_byte)
    endless = endless .and. n_byte <= 0
    if (endless) endless = .not. is_directory(path)
  end function is_endless

  !> Reason why a file cannot be created; to be called right after the failure.
  function open_failure(path) result(reason)
    character(*), intent(in) :: path
    character(:), allocatable :: reason, from_system

    from_system = system_reason()
    reason = write_obstacle(path)
    if (len(reason) > 0) return
    if (.not. is_directory(parent_path(path))) then
      reason = 'its directory does not exist'
    else
      reason = from_system
    end if
  end function open_failure

  !> Reason of the last failure of the system.
  function system_reason() result(reason)
    character(:), allocatable :: reason
    character(200) :: text

    call c_reason(text, len(text))
    reason = trim(text)
  end function system_reason

  !> Properties of a path; symbolic links are not followed.
  function facts_of_name(path) result(facts)
    character(*), intent(in) :: path
    type(file_facts_t) :: facts

    call c_facts(-1, path//c_null_char, .false._c_bool, facts)
  end function facts_of_name

  !> Properties of a path; symbolic links are followed.
  function facts_of_target(path) result(facts)
    character(*), intent(in) :: path
    type(file_facts_t) :: facts

    call c_facts(-1, path//c_null_char, .true._c_bool, facts)
  end function facts_of_target

  !> Properties of an open file.
  function facts_of_descriptor(descriptor) result(facts)
    integer(c_int), intent(in) :: descriptor
    type(file_facts_t) :: facts

    call c_facts(descriptor, c_null_char, .false._c_bool, facts)
  end function facts_of_descriptor

  !> Why a file of this name cannot be written; empty where the name is free or names a regular
  !> file.
  function write_obstacle(path) result(reason)
    character(*), intent(in) :: path
    character(:), allocatable :: reason
    type(file_facts_t) :: facts

    reason = ''
    facts = facts_of_name(path)
    if (.not. facts%is_there .or. facts%is_regular) return
    select case (facts%kind)
    case (1); reason = 'it is a directory'
    case (2); reason = 'it is a symbolic link, and results are neither written through ' &
      //'links nor put in their place'
    case (3); reason = 'it is a pipe'
    case (4); reason = 'it is a socket'
    case default; reason = 'it is a device'
    end select
  end function write_obstacle

  !> Whether two sets of properties belong to one file.
  pure function is_same_file(a, b) result(same)
    type(file_facts_t), intent(in) :: a, b
    logical :: same

    same = a%is_there .and. b%is_there .and. a%identity == b%identity .and. &
      a%device == b%device
  end function is_same_file

end module files_m
