! SPDX-License-Identifier: MIT
!> Text files that are written in whole buffers, line ends included.
module text_files_m
  use, intrinsic :: iso_c_binding, only : c_associated, c_int, c_loc, c_null_char, c_null_ptr, &
    c_ptr, c_size_t
  use c_files_m, only : c_creat, c_write, c_close, c_fopen, c_fileno, c_fclose, system_reason
  use errors_m, only : error_t, raise, status_files
  use files_m, only : open_failure
  use kinds_m, only : long
  implicit none
  private
  public :: text_file_t, create_text_file, continue_text_file, append_text, close_text_file

  !> Permissions of a new file, before the user's mask: rw for all.
  integer(c_int), parameter :: file_mode = 438_c_int

  !> An open text file.
  type :: text_file_t
    character(:), allocatable :: path   !! for messages
    integer(c_int) :: descriptor = -1   !! -1 while no file is open
    type(c_ptr) :: stream = c_null_ptr  !! C stream that owns the descriptor, where there is one
  end type text_file_t

contains

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

end module text_files_m
