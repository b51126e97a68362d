! SPDX-License-Identifier: MIT
!> The timing file: wall clock of the run by phase.
module timing_file_m
  use kinds_m, only : wp, long
  use clock_m, only : clock_t, phase_names, n_phase
  use errors_m, only : error_t
  use files_m, only : text_file_t, create_text_file, append_text, close_text_file
  implicit none
  private
  public :: write_timing, timing_text

contains

  !> Write `phase,seconds,calls,share`, one row per phase and the row `total`. The total is the time
  !> from the start to the last lap.
  subroutine write_timing(path, clock, error)
    character(*), intent(in) :: path
    type(clock_t), intent(in) :: clock
    type(error_t), allocatable, intent(out) :: error
    type(text_file_t) :: file

    call create_text_file(file, path, error)
    if (allocated(error)) return
    call append_text(file, timing_text(clock), error)
    if (allocated(error)) return
    call close_text_file(file, error)
  end subroutine write_timing

  !> The file as text. Seconds are whole nanoseconds with nine decimals, so that the phases add up
  !> to the total to the last digit.
  function timing_text(clock) result(text)
    type(clock_t), intent(in) :: clock
    character(:), allocatable :: text
    integer(long) :: nanoseconds(n_phase), first, rate
    integer :: i_phase

    call system_clock(first, rate)
    if (rate == 1000000000_long) then
      nanoseconds = clock%ticks
    else
      nanoseconds = nint(1.0e9_wp*real(clock%ticks, wp)/real(rate, wp), long)
    end if
    text = 'phase,seconds,calls,share'//new_line('a')
    do i_phase = 1, n_phase
      text = text//timing_row(phase_names(i_phase), nanoseconds(i_phase), clock%calls(i_phase), &
        sum(nanoseconds))
    end do
    text = text//timing_row('total', sum(nanoseconds), 1_long, sum(nanoseconds))
  end function timing_text

  !> One row, with its line end.
  pure function timing_row(name, nanoseconds, n_call, total) result(row)
    character(*), intent(in) :: name           !! of the phase
    integer(long), intent(in) :: nanoseconds   !! spent in it
    integer(long), intent(in) :: n_call        !! laps
    integer(long), intent(in) :: total         !! nanoseconds of the whole run
    character(:), allocatable :: row
    character(80) :: buffer

    write (buffer, '(i0, ".", i9.9, ",", i0, ",", f8.6)') nanoseconds/1000000000_long, &
      mod(nanoseconds, 1000000000_long), n_call, real(nanoseconds, wp)/real(max(total, 1_long), wp)
    row = trim(name)//','//trim(buffer)//new_line('a')
  end function timing_row

end module timing_file_m
