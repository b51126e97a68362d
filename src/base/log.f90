! SPDX-License-Identifier: MIT
!> The run log: what was understood, warnings and the summary.
!> Lines that come before the file is open are kept and written when it opens, since the job name
!> is known only after the command line and nothing may be lost of a deck that is refused.
module log_m
  use, intrinsic :: iso_fortran_env, only : error_unit
  use errors_m, only : error_t, raise, status_files
  implicit none
  private
  public :: log_t, open_log, write_log, warn, flush_log, close_log, to_text

  !> Number as text without surrounding blanks, for messages.
  interface to_text
    module procedure integer_to_text
    module procedure real_to_text
  end interface to_text

  !> One log.
  type :: log_t
    logical :: is_open = .false.
    integer :: unit = 0                   !! Fortran unit of the open file (newunit gives negative ones)
    integer :: n_warning = 0              !! warnings so far
    character(:), allocatable :: waiting  !! lines from before the file was open
  end type log_t

contains

  !> Open the file, behind what it holds where a run goes on, and write what has been waiting. Fails when
  !> the file cannot be made.
  subroutine open_log(log, path, goes_on, error)
    type(log_t), intent(inout) :: log
    character(*), intent(in) :: path
    logical, intent(in) :: goes_on
    type(error_t), allocatable, intent(out) :: error
    integer :: status
    character(200) :: reason

    if (goes_on) then
      open (newunit=log%unit, file=path, position='append', action='write', iostat=status, &
        iomsg=reason)
    else
      open (newunit=log%unit, file=path, status='replace', action='write', iostat=status, &
        iomsg=reason)
    end if
    if (status /= 0) then
      call raise(error, 'cannot write the log '//path//': '//trim(reason), status_files)
      return
    end if
    log%is_open = .true.
    if (allocated(log%waiting)) then
      write (log%unit, '(a)', advance='no') log%waiting
      deallocate (log%waiting)
    end if
  end subroutine open_log

  !> Write one line (or several, separated by new_line).
  subroutine write_log(log, text)
    type(log_t), intent(inout) :: log
    character(*), intent(in) :: text

    if (log%is_open) then
      write (log%unit, '(a)') text
    else if (allocated(log%waiting)) then
      log%waiting = log%waiting//text//new_line('a')
    else
      log%waiting = text//new_line('a')
    end if
  end subroutine write_log

  !> A warning: counted, logged and shown on standard error.
  subroutine warn(log, text)
    type(log_t), intent(inout) :: log
    character(*), intent(in) :: text

    log%n_warning = log%n_warning + 1
    call write_log(log, 'warning: '//text)
    write (error_unit, '(a)') 'warning: '//text
  end subroutine warn

  !> Bring what has been written into the file.
  subroutine flush_log(log)
    type(log_t), intent(in) :: log

    if (log%is_open) flush (log%unit)
  end subroutine flush_log

  !> Close the file; safe to call when none is open.
  subroutine close_log(log)
    type(log_t), intent(inout) :: log

    if (log%is_open) close (log%unit)
    log%is_open = .false.
  end subroutine close_log

  !> Integer as text.
  pure function integer_to_text(number) result(text)
    integer, intent(in) :: number
    character(:), allocatable :: text
    character(12) :: buffer

    write (buffer, '(i0)') number
    text = trim(buffer)
  end function integer_to_text

  !> Real as text with six digits, for messages (files carry full precision).
  pure function real_to_text(number) result(text)
    use kinds_m, only : wp
    real(wp), intent(in) :: number
    character(:), allocatable :: text
    character(24) :: buffer

    write (buffer, '(es13.6)') number
    ! Where the exponent takes three digits that form drops the letter.
    if (index(buffer, 'E') == 0 .and. scan(buffer, '0123456789') > 0) &
      write (buffer, '(es14.6e3)') number
    text = trim(adjustl(buffer))
  end function real_to_text

end module log_m
