! SPDX-License-Identifier: MIT
!> Text files that are written in whole buffers, line ends included; so are standard output and
!> standard error: through Fortran's units they could fail unnoticed, and GFORTRAN_STDOUT_UNIT or
!> GFORTRAN_DEFAULT_RECL in the environment would send them to a file or cut them.
module text_files_m
  use, intrinsic :: iso_c_binding, only : c_bool, c_char, c_int, c_null_char, c_size_t
  use errors_m, only : error_t, raise, status_files
  use files_m, only : file_facts_t, facts_of_name, facts_of_descriptor, write_obstacle, &
    is_same_file, open_failure, remove_file, rename_file, system_reason, unfinished
  use kinds_m, only : long
  implicit none
  private
  public :: text_file_t, create_text_file, continue_text_file, append_text, close_text_file, &
    read_whole, write_whole, overwrite_start, line_file_t, open_lines, put_lines, flush_due, &
    flush_lines, close_lines, print_line, print_text, print_error, normal_ending, error_ending

  !> Last line of a run.
  character(*), parameter :: normal_ending = ' N o r m a l    t e r m i n a t i o n', &
    error_ending = ' E r r o r    t e r m i n a t i o n'

  !> Size of the line buffer, bytes.
  integer, parameter :: buffer_size = 65536

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path   !! for messages
    integer(c_int) :: descriptor = -1   !! -1 while no file is open
    integer(long) :: n_byte = -1        !! expected length; -1: not checked
  end type text_file_t

  !> A text file with a buffer of whole lines, which one system call writes, at most a second later.
  type :: line_file_t
    logical :: is_open = .false.
    type(text_file_t) :: file
    character(:), allocatable :: buffer    !! pending lines
    integer :: n_pending = 0               !! bytes of them
    integer(long) :: flushed = 0           !! clock tick of the last write
    type(error_t), allocatable :: first_error !! nothing is written after it
  end type line_file_t

  ! By the C library, not by a Fortran unit: gfortran's `flush` and `close` report success on a full
  ! disk, and one `write` of whole lines leaves no incomplete line when the process is killed.
  interface
    !> Open a file (system.cpp); -1 on failure.
    function c_open(path, mode) bind(c, name='open_file') result(descriptor)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*) !! ends with a null
      character(kind=c_char), intent(in) :: mode    !! w: truncate; a: append; r: overwrite
      integer(c_int) :: descriptor
    end function c_open

    !> Lock a file without waiting; true where another process has locked it (system.cpp).
    function c_is_locked(descriptor) bind(c, name='is_locked_by_another') result(is_locked)
      import :: c_bool, c_int
      integer(c_int), value :: descriptor
      logical(c_bool) :: is_locked
    end function c_is_locked

    !> Write bytes; the number of bytes written (system.cpp).
    function c_write(descriptor, bytes, n_byte) bind(c, name='write_bytes') result(n_written)
      import :: c_char, c_int, c_size_t
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: bytes(*)
      integer(c_size_t), value :: n_byte
      integer(c_size_t) :: n_written
    end function c_write

    function c_close(descriptor) bind(c, name='close') result(status)
      import :: c_int
      integer(c_int), value :: descriptor
      integer(c_int) :: status
    end function c_close
  end interface

contains

  !> Create an empty text file. A file of the same name is removed first, so that its hard links
  !> keep their content. A name of anything but a regular file is an error: opening a pipe may
  !> block, and a link leads elsewhere.
  subroutine create_text_file(file, path, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    if (len(write_obstacle(path)) == 0) call remove_file(path, error)
    if (.not. allocated(error)) call open_stream(file, path, 'w', error)
    file%n_byte = 0
  end subroutine create_text_file

  !> Open a file in a mode of `c_open`.
  subroutine open_stream(file, path, mode, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    character, intent(in) :: mode
    type(error_t), allocatable, intent(out) :: error

    file%path = path
    if (len(write_obstacle(path)) == 0) file%descriptor = c_open(path//c_null_char, mode)
    if (file%descriptor < 0) &
      call raise(error, 'cannot write '//path//': '//open_failure(path), status_files)
  end subroutine open_stream

  !> Open a text file for appending, or empty, and lock it while it is open; it is created when it
  !> does not exist. A copy or an empty file replaces an existing file, so that its hard links keep
  !> their content.
  subroutine continue_text_file(file, path, keeps_content, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    logical, intent(in) :: keeps_content !! append to the present content
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    type(text_file_t) :: before
    type(file_facts_t) :: facts
    character(:), allocatable :: text
    logical :: is_read

    call open_alone(file, path, error)
    if (allocated(error)) return
    facts = facts_of_descriptor(file%descriptor)
    if (facts%is_there .and. facts%n_byte == 0 .and. facts%n_name == 1) return
    before = file
    call remove_file(path//unfinished, error)
    if (.not. allocated(error)) call open_alone(file, path//unfinished, error)
    if (keeps_content .and. .not. allocated(error)) then
      call read_whole(path, text, is_read)
      if (is_read) call append_text(file, text, error)
      if (.not. is_read) call raise(error, 'cannot read '//path//' to append to it', status_files)
    end if
    if (.not. allocated(error)) call rename_file(path//unfinished, path, error)
    if (allocated(error)) call remove_file(path//unfinished, ignored)
    file%path = path
    before%n_byte = -1
    call close_text_file(before, ignored)
  end subroutine continue_text_file

  !> Open a file for appending and lock it; it is created when it does not exist. The lock ends with
  !> the process; file systems without locks have none. A file that has been replaced meanwhile
  !> belongs to a run that has just started.
  subroutine open_alone(file, path, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(file_facts_t) :: facts
    logical :: is_locked

    call open_stream(file, path, 'a', error)
    if (allocated(error)) return
    is_locked = c_is_locked(file%descriptor)
    facts = facts_of_descriptor(file%descriptor)
    if (facts%is_there) then
      file%n_byte = facts%n_byte
      is_locked = is_locked .or. .not. is_same_file(facts, facts_of_name(path))
    end if
    if (is_locked) call raise(error, 'cannot write '//path//': another run in progress has it ' &
      //'open; choose another name (jobid=) or folder (d=)', status_files)
  end subroutine open_alone

  !> Read all bytes of a file.
  subroutine read_whole(path, text, is_read)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    integer(long) :: n_byte
    integer :: unit, status

    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
      action='read', iostat=status)
    if (status == 0) then
      inquire (unit=unit, size=n_byte)
      allocate (character(n_byte) :: text)
      read (unit, iostat=status) text
      close (unit)
    end if
    is_read = status == 0
  end subroutine read_whole

  !> Append text, line ends included, with one system call as long as the system accepts all of it.
  !> It is an error where another program has changed the file.
  subroutine append_text(file, text, error)
    type(text_file_t), intent(inout) :: file
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out) :: error
    integer(long) :: n_written

    call check_untouched(file, error)
    if (allocated(error)) return
    n_written = c_write(file%descriptor, text, len(text, c_size_t))
    if (n_written < len(text, long)) call raise(error, 'cannot append to '//file%path//': ' &
      //system_reason(), status_files)
    if (file%n_byte >= 0) file%n_byte = file%n_byte + n_written
  end subroutine append_text

  !> Create a text file with this content.
  subroutine write_whole(path, text, error)
    character(*), intent(in) :: path, text
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: closing
    type(text_file_t) :: file

    call create_text_file(file, path, error)
    if (allocated(error)) return
    call append_text(file, text, error)
    call close_text_file(file, closing)
    if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
  end subroutine write_whole

  !> Overwrite the first bytes of an existing file.
  subroutine overwrite_start(path, text, error)
    character(*), intent(in) :: path
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: closing
    type(text_file_t) :: file

    call open_stream(file, path, 'r', error)
    if (allocated(error)) return
    call append_text(file, text, error)
    call close_text_file(file, closing)
    if (.not. allocated(error) .and. allocated(closing)) call move_alloc(closing, error)
  end subroutine overwrite_start

  !> Check that the open file still has its name and the expected length.
  subroutine check_untouched(file, error)
    type(text_file_t), intent(in) :: file
    type(error_t), allocatable, intent(out) :: error
    type(file_facts_t) :: facts

    if (file%n_byte < 0) return
    facts = facts_of_descriptor(file%descriptor)
    if (.not. facts%is_there) return
    if (.not. is_same_file(facts, facts_of_name(file%path))) then
      call raise(error, 'cannot append to '//file%path//': it has been removed or renamed ' &
        //'during the run', status_files)
    else if (facts%n_byte /= file%n_byte) then
      call raise(error, 'cannot append to '//file%path//': another program has changed it during ' &
        //'the run', status_files)
    end if
  end subroutine check_untouched

  !> Close the file if it is open.
  subroutine close_text_file(file, error)
    type(text_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(out) :: error
    integer(c_int) :: status

    if (file%descriptor < 0) return
    call check_untouched(file, error)
    status = c_close(file%descriptor)
    file%descriptor = -1
    if (status /= 0 .and. .not. allocated(error)) call raise(error, 'cannot close '//file%path// &
      ': the file system refused the last bytes', status_files)
  end subroutine close_text_file

  !> Create an empty file of lines.
  subroutine open_lines(lines, path, error)
    type(line_file_t), intent(out) :: lines
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    call create_text_file(lines%file, path, error)
    if (allocated(error)) return
    allocate (character(buffer_size) :: lines%buffer)
    lines%is_open = .true.
    call system_clock(lines%flushed)
  end subroutine open_lines

  !> Add text to the buffer, line ends included; a line is shorter than the buffer.
  subroutine put_lines(lines, text)
    type(line_file_t), intent(inout) :: lines
    character(*), intent(in) :: text

    if (lines%n_pending + len(text) > buffer_size) call write_pending(lines)
    lines%buffer(lines%n_pending + 1:lines%n_pending + len(text)) = text
    lines%n_pending = lines%n_pending + len(text)
  end subroutine put_lines

  !> Write the pending lines if the last write was more than a second ago.
  subroutine flush_due(lines)
    type(line_file_t), intent(inout) :: lines
    integer(long) :: now, rate

    call system_clock(now, rate)
    if (now - lines%flushed > rate) call write_pending(lines)
  end subroutine flush_due

  !> Write the pending lines; nothing is written after the first failure.
  subroutine write_pending(lines)
    type(line_file_t), intent(inout) :: lines
    type(error_t), allocatable :: error

    if (lines%n_pending > 0 .and. .not. allocated(lines%first_error)) then
      call append_text(lines%file, lines%buffer(:lines%n_pending), error)
      if (allocated(error)) call move_alloc(error, lines%first_error)
    end if
    lines%n_pending = 0
    call system_clock(lines%flushed)
  end subroutine write_pending

  !> Write all pending lines if the file is open.
  subroutine flush_lines(lines, error)
    type(line_file_t), intent(inout) :: lines
    type(error_t), allocatable, intent(out) :: error

    if (.not. lines%is_open) return
    call write_pending(lines)
    if (allocated(lines%first_error)) error = lines%first_error
  end subroutine flush_lines

  !> Write all pending lines and close the file.
  subroutine close_lines(lines, error)
    type(line_file_t), intent(inout) :: lines
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: closing

    if (.not. lines%is_open) return
    call flush_lines(lines, error)
    call close_text_file(lines%file, closing)
    lines%is_open = .false.
    if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
  end subroutine close_lines

  !> Write a line (or several, separated by new_line) to standard output.
  subroutine print_line(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out), optional :: error !! absent: failures are ignored

    call print_text(text//new_line('a'), error)
  end subroutine print_line

  !> Write text to standard output, without a line end.
  subroutine print_text(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out), optional :: error !! absent: failures are ignored
    type(error_t), allocatable :: failure
    type(text_file_t) :: screen

    screen = text_file_t('standard output', 1)
    call append_text(screen, text, failure)
    if (present(error) .and. allocated(failure)) call move_alloc(failure, error)
  end subroutine print_text

  !> Write a line (or several) to standard error.
  subroutine print_error(text)
    character(*), intent(in) :: text
    type(error_t), allocatable :: ignored
    type(text_file_t) :: screen

    screen = text_file_t('standard error', 2)
    call append_text(screen, text//new_line('a'), ignored)
  end subroutine print_error

end module text_files_m
