! SPDX-License-Identifier: MIT
!> Progress of a run: one updating line on a terminal, DYNA-like lines in a pipe, the file
!> status.out, and the summary at the end. Failures to write to the screen or to status.out do not
!> end a run; the log has the same lines.
module progress_m
  use clock_m, only : clock_t, read_clock, elapsed_seconds, total_seconds, phase_seconds, &
    lap_seconds, phase_names, n_phase, n_contact_phase, phase_contact_search, phase_input, &
    phase_output
  use errors_m, only : error_t
  use files_m, only : rename_file, unfinished
  use kinds_m, only : wp, long
  use log_m, only : log_t, write_log, to_text
  use text_files_m, only : print_line, print_text, normal_ending, error_ending
  use system_m, only : output_is_terminal
  use text_files_m, only : write_whole
  implicit none
  private
  public :: progress_t, start_progress, update_progress, show_progress, show_note, show_end, &
    write_status, timing_text

  !> Cycles between two readings of a clock that takes no laps.
  integer, parameter :: clock_cycles = 64
  !> Seconds between two refreshes on a terminal, and between two lines in a pipe.
  real(wp), parameter :: terminal_interval = 0.25_wp, pipe_interval = 10.0_wp
  !> Largest number of lines in a pipe before the end of a run: thousands of runs may write into one
  !> file.
  integer, parameter :: most_lines = 20
  character(1), parameter :: n = new_line('a')

  !> Least seconds between two status files.
  real(wp), parameter :: file_interval = 1.0_wp

  !> Data of the lines and of the file status.out.
  type :: progress_t
    logical :: terminal = .false.
    logical :: is_quiet = .false.   !! print the end of the run only
    logical :: line_open = .false.  !! an updating line is not finished
    integer :: n_line = 0           !! lines written into a pipe
    integer :: status_interval = 0  !! cycles between lines, 0 = by time only
    integer(long) :: next_tick = 0  !! clock tick of the next line
    integer(long) :: wait = 0       !! ticks between lines
    character(:), allocatable :: path !! of status.out; not allocated: no file
    character(:), allocatable :: job
    integer(long) :: next_file = 0  !! clock tick of the next status file
    integer :: cycle = 0
    integer :: start_cycle = 0      !! cycle at the start: not 0 after a restart
    integer :: end_cycle = 0        !! ENDCYC, 0 = none
    real(wp) :: time = 0.0_wp
    real(wp) :: dt = 0.0_wp
    real(wp) :: ratio = 1.0_wp      !! last known energy ratio
    real(wp) :: start_time = 0.0_wp
    real(wp) :: end_time = 0.0_wp
    real(wp) :: start_seconds = 0.0_wp !! clock time at the start of its cycles
  end type progress_t

contains

  !> Set up the lines.
  subroutine start_progress(progress, end_time, status_interval)
    type(progress_t), intent(inout) :: progress
    real(wp), intent(in) :: end_time
    integer, intent(in) :: status_interval
    integer(long) :: now, rate

    progress%terminal = output_is_terminal()
    progress%end_time = end_time
    progress%status_interval = status_interval
    call system_clock(now, rate)
    progress%wait = int(merge(terminal_interval, pipe_interval, progress%terminal)*real(rate, wp), &
      long)
    progress%next_tick = now + progress%wait
  end subroutine start_progress

  !> Print a line or write the status file if one is due by time or cycle. Called in every cycle;
  !> the clock is read rarely where steps are short.
  subroutine update_progress(progress, clock, cycle, steps_are_long, time, dt, ratio)
    type(progress_t), intent(inout) :: progress
    type(clock_t), intent(inout) :: clock
    integer, intent(in) :: cycle
    logical, intent(in) :: steps_are_long
    real(wp), intent(in) :: time, dt, ratio
    logical :: is_due

    if (steps_are_long .or. mod(cycle, clock_cycles) == 0) call read_clock(clock)
    is_due = clock%last >= progress%next_tick
    if (progress%status_interval > 0 .and. .not. progress%terminal) &
      is_due = is_due .or. mod(cycle, progress%status_interval) == 0
    if (is_due) then
      call show_progress(progress, clock, cycle, time, dt, ratio, '')
    else if (clock%last >= progress%next_file) then
      call store_progress(progress, clock, cycle, time, dt, ratio)
    end if
  end subroutine update_progress

  !> Print one line. A pipe gets a line when the next share of the run is done, or on request
  !> (`is_asked`).
  subroutine show_progress(progress, clock, cycle, time, dt, ratio, event, is_asked)
    type(progress_t), intent(inout) :: progress
    type(clock_t), intent(in) :: clock
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time, dt, ratio !! last known energy ratio
    character(*), intent(in) :: event !! what was written, blank for none
    logical, intent(in), optional :: is_asked
    real(wp) :: share, to_go
    integer(long) :: now
    character(120) :: line
    character(:), allocatable :: stamp

    call system_clock(now)
    progress%next_tick = now + progress%wait
    call store_progress(progress, clock, cycle, time, dt, ratio)
    if (progress%is_quiet) return
    if (progress%terminal) then
      share = min(1.0_wp, time/progress%end_time)
      to_go = max(0.0_wp, seconds_to_go(progress, elapsed_seconds(clock)))
      write (line, '(ss,a,es11.4,a,f5.1,a,i0,a,es9.2,a,f8.5,a)') achar(13)//' t', time, '  ', &
        100.0_wp*share, ' %  cycle ', cycle, '  dt', dt, '  energy ratio', ratio, '  to go '
      call print_text(trim(line)//' '//duration(to_go)//'   ')
      progress%line_open = .true.
    else
      if (.not. present(is_asked)) then
        if ((most_lines - 1)*done_share(progress) < progress%n_line) return
      end if
      progress%n_line = progress%n_line + 1
      stamp = time_stamp()
      write (line, '(ss,i10,a,es10.4,a,es8.2,1x,a22,10x,a)') cycle, ' t ', time, ' dt ', dt, &
        event, stamp(6:7)//'/'//stamp(9:10)//'/'//stamp(3:4)//stamp(11:)
      call print_line(trim(line))
    end if
  end subroutine show_progress

  !> Print a line of its own on the screen and in the log: a restart, a restart file.
  subroutine show_note(progress, log, text)
    type(progress_t), intent(inout) :: progress
    type(log_t), intent(inout) :: log
    character(*), intent(in) :: text

    if (progress%line_open) call print_line('')
    progress%line_open = .false.
    call write_log(log, text)
    if (progress%is_quiet .or. (.not. progress%terminal .and. progress%n_line >= most_lines)) return
    progress%n_line = progress%n_line + 1
    call print_line(text)
  end subroutine show_note

  !> Print the end of a run: reason, problem time, cycles, cost and the timing table.
  subroutine show_end(progress, clock, log, normal, reason, cycle, time, n_element)
    type(progress_t), intent(inout) :: progress
    type(clock_t), intent(in) :: clock
    type(log_t), intent(inout) :: log
    logical, intent(in) :: normal
    character(*), intent(in) :: reason !! reason of the end
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time
    integer, intent(in) :: n_element
    real(wp) :: seconds(n_phase), elapsed, cost
    character(:), allocatable :: lines, ending
    character(100) :: line

    if (progress%line_open) call print_line('')
    progress%line_open = .false.
    progress%cycle = cycle
    progress%time = time
    call write_status(progress, clock, trim(merge('normal termination', &
      'error termination ', normal))//': '//reason(:scan(reason//n, n) - 1))
    seconds = phase_seconds(clock)
    elapsed = elapsed_seconds(clock)
    cost = 0.0_wp
    if (cycle > progress%start_cycle) cost = 1.0e9_wp &
      *(total_seconds(clock) - sum(seconds([phase_output, phase_input])))/real(cycle &
      - progress%start_cycle, wp)/n_element
    ending = trim(merge(normal_ending, error_ending//'  ', normal))
    write (line, '(ss,es16.8)') time
    lines = n//' *** '//reason//' ***'//n//ending//n//n &
      //' Problem time        = '//trim(line)//n &
      //' Problem cycle       = '//to_text(cycle)//n &
      //' Elapsed time        = '//fixed(elapsed, 3)//' seconds'//n &
      //' Time per zone cycle = '//fixed(cost, 2)//' nanoseconds (output and input ' &
      //trim(merge('excluded', 'included', clock%is_on))//')'//n &
      //' Warnings            = '//to_text(log%n_warning)//n
    if (clock%is_on) call add_timing(lines, clock, seconds)
    ! One write: separate lines would cost time in small runs.
    lines = lines(:len(lines) - 1)
    if (progress%is_quiet) then
      call print_line(ending)
    else
      call print_line(lines)
    end if
    call write_log(log, lines)
  end subroutine show_end

  !> Add the timing table and the cost of the timing itself.
  subroutine add_timing(lines, clock, seconds)
    character(:), allocatable, intent(inout) :: lines
    type(clock_t), intent(in) :: clock
    real(wp), intent(in) :: seconds(n_phase)
    character(100) :: line
    real(wp) :: total, each
    integer :: i

    total = max(sum(seconds), tiny(1.0_wp))
    lines = lines//n//' T i m i n g   i n f o r m a t i o n      seconds   share %        calls'//n
    do i = 1, n_phase
      if (clock%calls(i) == 0) cycle
      write (line, '(ss,a,a24,f17.4,f10.2,i13)') '  ', phase_names(i), seconds(i), &
        100.0_wp*seconds(i)/total, clock%calls(i)
      lines = lines//trim(line)//n
    end do
    each = lap_seconds()
    write (line, '(ss,a,i0)') ' Clock               = ', sum(clock%calls)
    lines = lines//trim(line)//' readings of '//fixed(1.0e9_wp*each, 1)//' nanoseconds, ' &
      //fixed(100.0_wp*each*sum(clock%calls)/total, 2)//' % of the time'//n
  end subroutine add_timing

  !> A non-negative number with `digits` decimals and at least one digit before the point.
  pure function fixed(number, digits) result(text)
    real(wp), intent(in) :: number
    integer, intent(in) :: digits
    character(:), allocatable :: text
    character(40) :: buffer
    character(12) :: layout

    write (layout, '(ss,a,i0,a)') '(ss,f0.', digits, ')'
    write (buffer, layout) number
    text = trim(buffer)
    if (text(1:1) == '.') text = '0'//text
  end function fixed

  !> Store new values, and write the status file when the last one is old enough.
  subroutine store_progress(progress, clock, cycle, time, dt, ratio)
    type(progress_t), intent(inout) :: progress
    type(clock_t), intent(in) :: clock
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time, dt, ratio
    integer(long) :: now

    progress%cycle = cycle
    progress%time = time
    progress%dt = dt
    progress%ratio = ratio
    call system_clock(now)
    if (now >= progress%next_file) call write_status(progress, clock, 'running')
  end subroutine store_progress

  !> Write the file status.out: progress of the run and estimated time.
  subroutine write_status(progress, clock, state)
    type(progress_t), intent(inout) :: progress
    type(clock_t), intent(in) :: clock
    character(*), intent(in) :: state !! running, or how the run ended
    type(error_t), allocatable :: error
    integer(long) :: now, rate

    call system_clock(now, rate)
    progress%next_file = now + int(file_interval*real(rate, wp), long)
    if (.not. allocated(progress%path)) return
    call write_whole(progress%path//unfinished, status_text(progress, clock, state), error)
    if (.not. allocated(error)) call rename_file(progress%path//unfinished, progress%path, error)
  end subroutine write_status

  !> The lines of the file.
  function status_text(progress, clock, state) result(text)
    type(progress_t), intent(in) :: progress
    type(clock_t), intent(in) :: clock
    character(*), intent(in) :: state
    character(:), allocatable :: text
    real(wp) :: elapsed, to_go

    elapsed = elapsed_seconds(clock)
    to_go = 0.0_wp
    if (state == 'running') to_go = seconds_to_go(progress, elapsed)
    text = ' job                              '//progress%job//n &
      //' state                            '//state//n &
      //' cycle no.                        '//to_text(progress%cycle)//n &
      //' time                             '//to_text(progress%time)//n &
      //' termination time                 '//to_text(progress%end_time)//n &
      //' time step                        '//to_text(progress%dt)//n &
      //' energy ratio                     '//to_text(progress%ratio)//n &
      //' elapsed clock time               '//duration(elapsed)//n
    if (to_go >= 0.0_wp) then
      text = text//' estimated total clock time       '//duration(elapsed + to_go)//n &
        //' estimated clock time to complete '//duration(to_go)//n
    else
      text = text//' estimated total clock time       not known yet'//n &
        //' estimated clock time to complete not known yet'//n
    end if
    text = text//' written                          '//time_stamp()//n
  end function status_text

  !> Share of the run that is done, by time or by cycles.
  pure function done_share(progress) result(share)
    type(progress_t), intent(in) :: progress
    real(wp) :: share

    share = 0.0_wp
    if (progress%end_time > progress%start_time) &
      share = (progress%time - progress%start_time)/(progress%end_time - progress%start_time)
    if (progress%end_cycle > progress%start_cycle) share = max(share, &
      real(progress%cycle - progress%start_cycle, wp)/(progress%end_cycle - progress%start_cycle))
  end function done_share

  !> Estimated seconds to the end; -1 where nothing has been done yet.
  pure function seconds_to_go(progress, elapsed) result(seconds)
    type(progress_t), intent(in) :: progress
    real(wp), intent(in) :: elapsed
    real(wp) :: seconds
    real(wp) :: share

    share = done_share(progress)
    seconds = -1.0_wp
    if (share > 0.0_wp) seconds = max(0.0_wp, &
      (elapsed - progress%start_seconds)*(1.0_wp - share)/share)
  end function seconds_to_go

  !> Seconds as h:mm:ss.
  pure function duration(seconds) result(text)
    real(wp), intent(in) :: seconds
    character(:), allocatable :: text
    character(20) :: buffer
    integer(long) :: whole

    whole = int(min(seconds, 1.0e9_wp), long)
    write (buffer, '(ss,i0,":",i2.2,":",i2.2)') whole/3600, mod(whole/60, 60_long), &
      mod(whole, 60_long)
    text = trim(buffer)
  end function duration

  !> Date and time as yyyy-mm-dd hh:mm:ss.
  function time_stamp() result(text)
    character(19) :: text
    character(8) :: date
    character(10) :: hour

    call date_and_time(date, hour)
    text = date(1:4)//'-'//date(5:6)//'-'//date(7:8)//' '//hour(1:2)//':'//hour(3:4)//':' &
      //hour(5:6)
  end function time_stamp

  !> The timing file: wall clock by phase as `phase,seconds,calls,share`, one row per phase and the
  !> row `total` from the start to the last lap. With timed interfaces rows such as
  !> `contact_force.2` follow their phase and add up to it. Without laps there is the total alone.
  !> Seconds are whole nanoseconds with nine decimals, so that phases add up to the total exactly.
  function timing_text(clock, interfaces) result(text)
    type(clock_t), intent(in) :: clock
    integer, intent(in) :: interfaces(:) !! their ids
    character(:), allocatable :: text
    integer(long) :: nanoseconds(n_phase), total, first, rate
    integer :: i_phase, i_row, i

    call system_clock(first, rate)
    nanoseconds = in_nanoseconds(clock%ticks, rate)
    total = sum(nanoseconds)
    if (.not. clock%is_on) total = in_nanoseconds(clock%last - clock%first, rate)
    text = 'phase,seconds,calls,share'//new_line('a')
    do i_phase = 1, n_phase
      if (.not. clock%is_on) exit
      text = text//timing_row(phase_names(i_phase), nanoseconds(i_phase), clock%calls(i_phase), &
        total)
      ! The rows of a contact phase by interface, with its id as in the other tables.
      i_row = i_phase - phase_contact_search + 1
      if (i_row < 1 .or. i_row > n_contact_phase .or. .not. allocated(clock%interface_ticks)) cycle
      do i = 1, size(interfaces)
        text = text//timing_row(trim(phase_names(i_phase))//'.'//to_text(interfaces(i)), &
          in_nanoseconds(clock%interface_ticks(i_row, i), rate), clock%interface_calls(i_row, i), &
          total)
      end do
    end do
    text = text//timing_row('total', total, 1_long, total)
  end function timing_text

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

end module progress_m
