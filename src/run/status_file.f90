! SPDX-License-Identifier: MIT
!> The file status.out: how far a run is and how long it may take, for scripts and for people who
!> come by. It is replaced as a whole; that it can not be written is no reason to end a run.
module status_file_m
  use clock_m, only : clock_t, elapsed_seconds
  use errors_m, only : error_t
  use files_m, only : rename_file, unfinished
  use text_files_m, only : write_whole
  use kinds_m, only : wp, long
  use log_m, only : to_text
  implicit none
  private
  public :: status_t, keep_status, write_status, done_share, seconds_to_go, &
    duration

  !> Seconds between two files at least.
  real(wp), parameter :: file_interval = 1.0_wp

  !> What the file says.
  type :: status_t
    character(:), allocatable :: path       !! not allocated: no file
    character(:), allocatable :: job
    integer :: cycle = 0
    integer :: end_cycle = 0                !! ENDCYC, 0 = none
    real(wp) :: time = 0.0_wp
    real(wp) :: dt = 0.0_wp
    real(wp) :: ratio = 1.0_wp              !! last energy ratio known
    real(wp) :: end_time = 0.0_wp
    real(wp) :: start_time = 0.0_wp         !! where this run began: not 0 after a restart
    integer :: start_cycle = 0
    real(wp) :: start_seconds = 0.0_wp      !! clock time when its cycles began
    integer(long) :: next_tick = 0          !! clock tick of the next file
  end type status_t

contains

  !> Take new numbers, and write them when the last file is old enough.
  subroutine keep_status(status, clock, cycle, time, dt, ratio)
    type(status_t), intent(inout) :: status
    type(clock_t), intent(in) :: clock
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time, dt, ratio
    integer(long) :: now

    status%cycle = cycle
    status%time = time
    status%dt = dt
    status%ratio = ratio
    call system_clock(now)
    if (now >= status%next_tick) call write_status(status, clock, 'running')
  end subroutine keep_status

  !> Write the file.
  subroutine write_status(status, clock, state)
    type(status_t), intent(inout) :: status
    type(clock_t), intent(in) :: clock
    character(*), intent(in) :: state !! running, or how the run has ended
    type(error_t), allocatable :: error
    integer(long) :: now, rate

    call system_clock(now, rate)
    status%next_tick = now + int(file_interval*real(rate, wp), long)
    if (.not. allocated(status%path)) return
    call write_whole(status%path//unfinished, status_text(status, clock, state), error)
    if (.not. allocated(error)) call rename_file(status%path//unfinished, status%path, error)
  end subroutine write_status

  !> The lines of the file.
  function status_text(status, clock, state) result(text)
    type(status_t), intent(in) :: status
    type(clock_t), intent(in) :: clock
    character(*), intent(in) :: state
    character(:), allocatable :: text
    character(1), parameter :: n = new_line('a')
    real(wp) :: elapsed, to_go
    character(8) :: date
    character(10) :: hour

    elapsed = elapsed_seconds(clock)
    to_go = 0.0_wp
    if (state == 'running') to_go = seconds_to_go(status, elapsed)
    call date_and_time(date, hour)
    text = ' job                              '//status%job//n &
      //' state                            '//state//n &
      //' cycle no.                        '//to_text(status%cycle)//n &
      //' time                             '//to_text(status%time)//n &
      //' termination time                 '//to_text(status%end_time)//n &
      //' time step                        '//to_text(status%dt)//n &
      //' energy ratio                     '//to_text(status%ratio)//n &
      //' elapsed clock time               '//duration(elapsed)//n
    if (to_go >= 0.0_wp) then
      text = text//' estimated total clock time       '//duration(elapsed + to_go)//n &
        //' estimated clock time to complete '//duration(to_go)//n
    else
      text = text//' estimated total clock time       not known yet'//n &
        //' estimated clock time to complete not known yet'//n
    end if
    text = text//' written                          '//date(1:4)//'-'//date(5:6)//'-'//date(7:8) &
      //' '//hour(1:2)//':'//hour(3:4)//':'//hour(5:6)//n
  end function status_text

  !> Share of the run that has been done, by time or by cycles.
  pure function done_share(status) result(share)
    type(status_t), intent(in) :: status
    real(wp) :: share

    share = 0.0_wp
    if (status%end_time > status%start_time) &
      share = (status%time - status%start_time)/(status%end_time - status%start_time)
    if (status%end_cycle > status%start_cycle) share = max(share, &
      real(status%cycle - status%start_cycle, wp)/(status%end_cycle - status%start_cycle))
  end function done_share

  !> Seconds until the end at the pace since this run began; -1 where nothing has been done yet.
  pure function seconds_to_go(status, elapsed) result(seconds)
    type(status_t), intent(in) :: status
    real(wp), intent(in) :: elapsed
    real(wp) :: seconds
    real(wp) :: share

    share = done_share(status)
    seconds = -1.0_wp
    if (share > 0.0_wp) seconds = max(0.0_wp, &
      (elapsed - status%start_seconds)*(1.0_wp - share)/share)
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

end module status_file_m
