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

  !> How a run says that it ended.
  character(*), parameter :: normal_ending = ' N o r m a l    t e r m i n a t i o n', &
    error_ending = ' E r r o r    t e r m i n a t i o n'

  !> Bytes of lines that wait, at most.
  integer, parameter :: buffer_size = 65536

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path   !! for messages
    integer(c_int) :: descriptor = -1   !! -1 while no file is open
    integer(long) :: n_byte = -1        !! length that this program knows of; -1: no matter
  end type text_file_t

  !> A text file whose whole lines wait for each other: they reach it with one system call, at the
  !> latest a second after they came.
  type :: line_file_t
    logical :: is_open = .false.           !! lines are taken only while open
    type(text_file_t) :: file
    character(:), allocatable :: buffer    !! lines that wait
    integer :: n_pending = 0               !! bytes of them
    integer(long) :: flushed = 0           !! clock tick of the last write
    type(error_t), allocatable :: first_error  !! first failure, which ends the writing
  end type line_file_t

  ! By the C library, and not by a Fortran unit: gfortran's `flush` and `close` report success on a
  ! full disk, and one `write` of whole lines leaves no half line behind when the process is killed.
  interface
    !> Open a file (system.cpp); -1 on failure.
    function c_open(path, mode) bind(c, name='open_file') result(descriptor)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*) !! ends with a null
      character(kind=c_char), intent(in) :: mode    !! w: empty; a: behind what it holds; r: neither
      integer(c_int) :: descriptor
    end function c_open

    !> Take a file for this process alone, without waiting; whether another one has it (system.cpp).
    function c_is_locked(descriptor) bind(c, name='is_locked_by_another') result(is_locked)
      import :: c_bool, c_int
      integer(c_int), value :: descriptor
      logical(c_bool) :: is_locked
    end function c_is_locked

    !> Write; bytes that have been taken (system.cpp).
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

  !> Make a text file, empty; one of the same name is removed before, so that other names of it
  !> (hard links) keep what they have. What is no regular file is refused: to open a pipe could wait
  !> for ever, and a link leads elsewhere.
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

  !> Open a text file to write on behind what it holds, or from its start, for this process alone as
  !> long as it is open; it is made when there is none. A file that holds something is not written
  !> to: a copy, or an empty file, takes its place, so that other names of it keep what they have.
  subroutine continue_text_file(file, path, keeps_content, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    logical, intent(in) :: keeps_content !! what it holds
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
      if (.not. is_read) call raise(error, 'cannot read '//path//', behind which the run would ' &
        //'write', status_files)
    end if
    if (.not. allocated(error)) call rename_file(path//unfinished, path, error)
    if (allocated(error)) call remove_file(path//unfinished, ignored)
    file%path = path
    before%n_byte = -1
    call close_text_file(before, ignored)
  end subroutine continue_text_file

  !> Open a file behind what it holds and lock it; it is made when there is none. The lock ends with
  !> the process, however that ends; where the file system has no locks there is none. A file that
  !> another one has replaced meanwhile is that of a run that has just begun.
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
    if (is_locked) call raise(error, 'cannot write '//path//': another run that is going on has ' &
      //'it open; give this one another name (jobid=) or folder (d=)', status_files)
  end subroutine open_alone

  !> All bytes of a file.
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

  !> Append text as it is, line ends included, with one system call as long as the system takes all.
  !> Fails too where the file is no longer what this program has written.
  subroutine append_text(file, text, error)
    type(text_file_t), intent(inout) :: file
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out) :: error
    integer(long) :: n_written

    call check_untouched(file, error)
    if (allocated(error)) return
    n_written = c_write(file%descriptor, text, len(text, c_size_t))
    if (n_written < len(text, long)) call raise(error, 'cannot write on to '//file%path//': ' &
      //system_reason(), status_files)
    if (file%n_byte >= 0) file%n_byte = file%n_byte + n_written
  end subroutine append_text

  !> Make a text file that holds this text and no more.
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

  !> Put text in the place of the first bytes of a file that is there.
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

  !> Whether the open file still has its name and the length that this program gave it.
  subroutine check_untouched(file, error)
    type(text_file_t), intent(in) :: file
    type(error_t), allocatable, intent(out) :: error
    type(file_facts_t) :: facts

    if (file%n_byte < 0) return
    facts = facts_of_descriptor(file%descriptor)
    if (.not. facts%is_there) return
    if (.not. is_same_file(facts, facts_of_name(file%path))) then
      call raise(error, 'cannot write on to '//file%path//': it has been removed or renamed ' &
        //'during the run', status_files)
    else if (facts%n_byte /= file%n_byte) then
      call raise(error, 'cannot write on to '//file%path//': somebody else has changed it during ' &
        //'the run', status_files)
    end if
  end subroutine check_untouched

  !> Close; nothing happens when no file is open.
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

  !> Make a file of lines, empty.
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

  !> Take text, line ends included; a line is shorter than the buffer.
  subroutine put_lines(lines, text)
    type(line_file_t), intent(inout) :: lines
    character(*), intent(in) :: text

    if (lines%n_pending + len(text) > buffer_size) call write_pending(lines)
    lines%buffer(lines%n_pending + 1:lines%n_pending + len(text)) = text
    lines%n_pending = lines%n_pending + len(text)
  end subroutine put_lines

  !> Write what has waited for a second.
  subroutine flush_due(lines)
    type(line_file_t), intent(inout) :: lines
    integer(long) :: now, rate

    call system_clock(now, rate)
    if (now - lines%flushed > rate) call write_pending(lines)
  end subroutine flush_due

  !> Write what waits. The first failure is remembered and ends the writing.
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

  !> Bring all lines into the file; nothing happens to one that is not open.
  subroutine flush_lines(lines, error)
    type(line_file_t), intent(inout) :: lines
    type(error_t), allocatable, intent(out) :: error

    if (.not. lines%is_open) return
    call write_pending(lines)
    if (allocated(lines%first_error)) error = lines%first_error
  end subroutine flush_lines

  !> Bring all lines into the file and close it.
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

  !> A line (or several, separated by new_line) on standard output.
  subroutine print_line(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out), optional :: error !! absent: a failure is no matter

    call print_text(text//new_line('a'), error)
  end subroutine print_line

  !> Text on standard output, without a line end.
  subroutine print_text(text, error)
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out), optional :: error !! absent: a failure is no matter
    type(error_t), allocatable :: failure
    type(text_file_t) :: screen

    screen = text_file_t('standard output', 1)
    call append_text(screen, text, failure)
    if (present(error) .and. allocated(failure)) call move_alloc(failure, error)
  end subroutine print_text

  !> A line (or several) on standard error.
  subroutine print_error(text)
    character(*), intent(in) :: text
    type(error_t), allocatable :: ignored
    type(text_file_t) :: screen

    screen = text_file_t('standard error', 2)
    call append_text(screen, text//new_line('a'), ignored)
  end subroutine print_error

end module text_files_m
