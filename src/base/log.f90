! SPDX-License-Identifier: MIT
!> The run log: the model as read, warnings and the summary.
!> Lines written before the file is open are stored and written when it opens, since the job name is
!> known only after the command line has been read. A failure to write does not end the run: the
!> first one is stored in `first_error`.
module log_m
  use errors_m, only : error_t
  use kinds_m, only : wp
  use text_files_m, only : text_file_t, continue_text_file, append_text, close_text_file, &
    print_error
  implicit none
  private
  public :: log_t, open_log, write_log, warn, close_log, clear_pending, to_text, percent, &
    two_decimals

  !> Number as text without surrounding blanks, for messages.
  interface to_text
    module procedure integer_to_text
    module procedure real_to_text
  end interface to_text

  !> One log.
  type :: log_t
    logical :: is_open = .false.
    logical :: is_silent = .false.        !! lines are ignored: they have been written before
    type(text_file_t) :: file
    type(error_t), allocatable :: first_error !! first failure to write
    integer :: n_warning = 0              !! warnings so far
    character(:), allocatable :: pending  !! lines from before the file was open, padded with blanks
    integer :: n_pending = 0              !! characters of these lines
  end type log_t

contains

  !> Open the file, for appending at a restart, and write the pending lines. It is an error when the
  !> file cannot be created or belongs to a running job: the log locks all files of a run, since it
  !> is the first to be opened and the last to be closed.
  subroutine open_log(log, path, is_restart, error)
    type(log_t), intent(inout) :: log
    character(*), intent(in) :: path
    logical, intent(in) :: is_restart
    type(error_t), allocatable, intent(out) :: error

    call continue_text_file(log%file, path, is_restart, error)
    if (allocated(error)) return
    log%is_open = .true.
    if (allocated(log%pending)) then
      call append_text(log%file, log%pending(:log%n_pending), error)
      call clear_pending(log)
    end if
  end subroutine open_log

  !> Write one line (or several, separated by new_line).
  subroutine write_log(log, text)
    type(log_t), intent(inout) :: log
    character(*), intent(in) :: text
    type(error_t), allocatable :: error
    integer :: last

    if (log%is_silent) return
    if (log%is_open) then
      if (allocated(log%first_error)) return
      call append_text(log%file, text//new_line('a'), error)
      if (allocated(error)) call move_alloc(error, log%first_error)
      return
    end if
    last = log%n_pending + len(text) + 1
    if (.not. allocated(log%pending)) log%pending = repeat(' ', last + 4096)
    if (last > len(log%pending)) log%pending = log%pending//repeat(' ', last)
    log%pending(log%n_pending + 1:last) = text//new_line('a')
    log%n_pending = last
  end subroutine write_log

  !> Discard the pending lines.
  subroutine clear_pending(log)
    type(log_t), intent(inout) :: log

    if (allocated(log%pending)) deallocate (log%pending)
    log%n_pending = 0
  end subroutine clear_pending

  !> Count a warning, and write it to the log and to standard error.
  subroutine warn(log, text)
    type(log_t), intent(inout) :: log
    character(*), intent(in) :: text

    if (log%is_silent) return
    log%n_warning = log%n_warning + 1
    call write_log(log, 'warning: '//text)
    call print_error('warning: '//text)
  end subroutine warn

  !> Close the file if one is open; failures are stored in `first_error`.
  subroutine close_log(log)
    type(log_t), intent(inout) :: log
    type(error_t), allocatable :: error

    if (log%is_open) call close_text_file(log%file, error)
    log%is_open = .false.
    if (allocated(error) .and. .not. allocated(log%first_error)) call move_alloc(error, &
      log%first_error)
  end subroutine close_log

  !> Integer as text.
  pure function integer_to_text(number) result(text)
    integer, intent(in) :: number
    character(:), allocatable :: text
    character(12) :: buffer

    write (buffer, '(ss,i0)') number
    text = trim(buffer)
  end function integer_to_text

  !> Real as text with six digits, for messages (files carry full precision).
  pure function real_to_text(number) result(text)
    real(wp), intent(in) :: number
    character(:), allocatable :: text
    character(24) :: buffer

    write (buffer, '(ss,es13.6)') number
    ! That format drops the letter of an exponent of three digits.
    if (index(buffer, 'E') == 0 .and. scan(buffer, '0123456789') > 0) &
      write (buffer, '(ss,es14.6e3)') number
    text = trim(adjustl(buffer))
  end function real_to_text

  !> `part`/`whole` in per cent with two decimals.
  pure function percent(part, whole) result(text)
    real(wp), intent(in) :: part, whole
    character(:), allocatable :: text

    text = 'all'
    if (whole > 0.0_wp) text = two_decimals(100.0_wp*part/whole)//' %'
  end function percent

  !> A number below 10000 with two decimals; others as a power of ten.
  pure function two_decimals(number) result(text)
    real(wp), intent(in) :: number
    character(:), allocatable :: text
    character(24) :: buffer

    write (buffer, '(ss,es10.2)') number
    if (number < 1.0e4_wp) write (buffer, '(ss,f8.2)') number
    text = trim(adjustl(buffer))
  end function two_decimals

end module log_m
