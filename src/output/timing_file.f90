! SPDX-License-Identifier: MIT
!> The timing file: wall clock of the run by phase, and of the contact
!> phases by interface on request.
module timing_file_m
  use kinds_m, only : wp, long
  use clock_m, only : clock_t, phase_names, n_phase, n_contact_phase, phase_contact_search
  use log_m, only : to_text
  implicit none
  private
  public :: timing_text

contains

  !> The file as text: `phase,seconds,calls,share`, one row per phase and the row `total`, which is
  !> the time from the start to the last lap. Where interfaces are timed, rows such as
  !> `contact_force.2` follow their phase and add up to it. Where no laps are taken there is the
  !> total alone. Seconds are whole nanoseconds with nine decimals, so that the phases add up to the
  !> total to the last digit.
  function timing_text(clock, interfaces) result(text)
    type(clock_t), intent(in) :: clock
    integer, intent(in) :: interfaces(:) !! their ids
    character(:), allocatable :: text
    integer(long) :: nanoseconds(n_phase), total, first, rate
    integer :: i_phase

    call system_clock(first, rate)
    nanoseconds = in_nanoseconds(clock%ticks, rate)
    total = sum(nanoseconds)
    if (.not. clock%is_on) total = in_nanoseconds(clock%last - clock%first, rate)
    text = 'phase,seconds,calls,share'//new_line('a')
    do i_phase = 1, n_phase
      if (.not. clock%is_on) exit
      text = text//timing_row(phase_names(i_phase), nanoseconds(i_phase), clock%calls(i_phase), &
        total)//interface_rows(clock, interfaces, i_phase, rate, total)
    end do
    text = text//timing_row('total', total, 1_long, total)
  end function timing_text

  !> The rows of a contact phase by interface, with its id as in the other tables.
  function interface_rows(clock, interfaces, i_phase, rate, total) result(text)
    type(clock_t), intent(in) :: clock
    integer, intent(in) :: interfaces(:)
    integer, intent(in) :: i_phase
    integer(long), intent(in) :: rate          !! ticks of a second
    integer(long), intent(in) :: total         !! nanoseconds of the whole run
    character(:), allocatable :: text
    integer :: i_row, i

    text = ''
    i_row = i_phase - phase_contact_search + 1
    if (i_row < 1 .or. i_row > n_contact_phase) return
    if (.not. allocated(clock%interface_ticks)) return
    do i = 1, size(interfaces)
      text = text//timing_row(trim(phase_names(i_phase))//'.'//to_text(interfaces(i)), &
        in_nanoseconds(clock%interface_ticks(i_row, i), rate), clock%interface_calls(i_row, i), &
        total)
    end do
  end function interface_rows

  !> Ticks as nanoseconds.
  elemental function in_nanoseconds(ticks, rate) result(nanoseconds)
    integer(long), intent(in) :: ticks, rate
    integer(long) :: nanoseconds

    if (rate == 1000000000_long) then
      nanoseconds = ticks
    else
      nanoseconds = nint(1.0e9_wp*real(ticks, wp)/real(rate, wp), long)
    end if
  end function in_nanoseconds

  !> One row, with its line end.
  pure function timing_row(name, nanoseconds, n_call, total) result(row)
    character(*), intent(in) :: name           !! of the phase
    integer(long), intent(in) :: nanoseconds   !! spent in it
    integer(long), intent(in) :: n_call        !! laps
    integer(long), intent(in) :: total         !! nanoseconds of the whole run
    character(:), allocatable :: row
    character(80) :: buffer

    write (buffer, '(ss,i0, ".", i9.9, ",", i0, ",", f8.6)') nanoseconds/1000000000_long, &
      mod(nanoseconds, 1000000000_long), n_call, real(nanoseconds, wp)/real(max(total, 1_long), wp)
    row = trim(name)//','//trim(buffer)//new_line('a')
  end function timing_row

end module timing_file_m
