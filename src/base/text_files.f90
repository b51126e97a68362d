! SPDX-License-Identifier: MIT
!> Text files that are written in whole buffers, line ends included.
module text_files_m
  use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_loc, c_null_char, c_null_ptr, &
    c_ptr, c_size_t
  use c_files_m, only : c_creat, c_write, c_close, c_fopen, c_fileno, c_fclose, c_flock, &
    c_ftruncate, system_reason, system_failure
  use errors_m, only : error_t, raise, status_files
  use file_facts_m, only : file_facts_t, facts_of_name, facts_of_descriptor, what_hinders, &
    is_same_file
  use files_m, only : open_failure
  use kinds_m, only : long
  implicit none
  private
  public :: text_file_t, create_text_file, continue_text_file, empty_text_file, &
    append_text, close_text_file, overwrite_start

  !> Permissions of a new file, before the user's mask: rw for all.
  integer(c_int), parameter :: file_mode = 438_c_int

  !> Of flock: for one alone, without waiting; the number of a refusal (EWOULDBLOCK of Linux).
  integer(c_int), parameter :: lock_alone = 6, is_locked = 11

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path   !! for messages
    integer(c_int) :: descriptor = -1   !! -1 while no file is open
    type(c_ptr) :: stream = c_null_ptr  !! C stream that owns the descriptor, where there is one
    integer(long) :: n_byte = -1        !! length that this program knows of; -1: no matter
  end type text_file_t

contains

  !> Make a text file, empty; one of the same name is emptied. What is no regular file is refused:
  !> to open a pipe could wait for ever, and a link leads elsewhere.
  subroutine create_text_file(file, path, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    file%path = path
    if (len(what_hinders(path)) == 0) file%descriptor = c_creat(path//c_null_char, file_mode)
    if (file%descriptor < 0) call raise(error, 'cannot write '//path//': '// &
      open_failure(path), status_files)
    file%n_byte = 0
  end subroutine create_text_file

  !> Open a text file to write on behind what it holds, for this process alone as long as it is
  !> open; it is made when there is none. The lock ends with the process, however that ends; where
  !> the file system has no locks there is none.
  subroutine continue_text_file(file, path, error)
    type(text_file_t), intent(out) :: file
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(file_facts_t) :: facts

    file%path = path
    if (len(what_hinders(path)) == 0) &
      file%stream = c_fopen(path//c_null_char, 'a'//c_null_char)
    if (.not. c_associated(file%stream)) then
      call raise(error, 'cannot write '//path//': '//open_failure(path), status_files)
      return
    end if
    file%descriptor = c_fileno(file%stream)
    if (c_flock(file%descriptor, lock_alone) /= 0) then
      if (system_failure() == is_locked) call raise(error, 'cannot write '//path//': another ' &
        //'run that is going on has it open; give this one another name (jobid=) or folder (d=)', &
        status_files)
    end if
    facts = facts_of_descriptor(file%descriptor)
    if (facts%is_there) file%n_byte = facts%n_byte
  end subroutine continue_text_file

  !> Take all out of a file that was opened to be continued.
  subroutine empty_text_file(file, error)
    type(text_file_t), intent(inout) :: file
    type(error_t), allocatable, intent(out) :: error

    if (c_ftruncate(file%descriptor, 0_c_size_t) /= 0) then
      call raise(error, 'cannot write '//file%path//': '//system_reason(), status_files)
    else
      file%n_byte = 0
    end if
  end subroutine empty_text_file

  !> Append text as it is, line ends included, with one system call as long as the system takes all.
  !> Fails too where the file is no longer what this program has written.
  subroutine append_text(file, text, error)
    type(text_file_t), intent(inout) :: file
    character(*), intent(in), target :: text
    type(error_t), allocatable, intent(out) :: error
    integer(long) :: n_written, n_taken

    call check_untouched(file, error)
    if (allocated(error)) return
    n_written = 0
    do while (n_written < len(text, long))
      n_taken = int(c_write(file%descriptor, c_loc(text(n_written + 1:n_written + 1)), &
        int(len(text, long) - n_written, c_size_t)), long)
      if (n_taken <= 0) then
        call raise(error, 'cannot write on to '//file%path//': '//system_reason(), status_files)
        exit
      end if
      n_written = n_written + n_taken
    end do
    if (file%n_byte >= 0) file%n_byte = file%n_byte + n_written
  end subroutine append_text

  !> Put text in the place of the first bytes of a file that is there.
  subroutine overwrite_start(path, text, error)
    character(*), intent(in) :: path
    character(*), intent(in) :: text
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: closing
    type(text_file_t) :: file

    file%path = path
    file%stream = c_fopen(path//c_null_char, 'r+'//c_null_char)
    if (.not. c_associated(file%stream)) then
      call raise(error, 'cannot write '//path//': '//open_failure(path), status_files)
      return
    end if
    file%descriptor = c_fileno(file%stream)
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
    if (c_associated(file%stream)) then
      status = c_fclose(file%stream)
    else
      status = c_close(file%descriptor)
    end if
    file%stream = c_null_ptr
    file%descriptor = -1
    if (status /= 0 .and. .not. allocated(error)) call raise(error, 'cannot close '//file%path// &
      ': the file system refused the last bytes', status_files)
  end subroutine close_text_file

end module text_files_m
