! SPDX-License-Identifier: MIT
!> What someone outside asks of a run while it goes on, by a word in d3kil or by a signal. What
!> needs no more than the files (a line of status, histories brought up to date) is done here;
!> the driver does the rest.
module requests_m
  use errors_m, only : error_t
  use history_file_m, only : flush_histories
  use kinds_m, only : wp, long
  use log_m, only : warn
  use monitor_m, only : monitor_t
  use progress_m, only : show_progress
  use restart_plan_m, only : wants_look
  use sense_switch_m, only : take_switch, switch_none, switch_dump_and_stop, switch_status, &
    switch_dump, switch_plot, switch_stop, switch_flush, switch_unknown
  use signals_m, only : stop_requested, take_signals
  use state_m, only : state_t
  implicit none
  private
  public :: requests_t, take_requests, echoes_t, hear_signals, drop_echoes

  !> What is asked for.
  type :: requests_t
    logical :: dump = .false.      !! a numbered restart file (sw1, sw3, SIGUSR1)
    logical :: plot = .false.      !! a plot state (sw4, SIGUSR2)
    logical :: stop = .false.      !! an end before its time (sw1, stop, SIGTERM, SIGINT, SIGHUP)
    logical :: signalled = .false. !! a signal asks for that end
  end type requests_t

  !> A launcher hands SIGUSR1 and SIGUSR2 to every process of a run, and these hear them in
  !> different cycles: what comes within a second of what was done is not asked again.
  type :: echoes_t
    integer(long) :: done(2) = -huge(1_long) !! tick after the last restart file, plot state
  end type echoes_t

contains

  !> What is asked of a process that has no files: signals alone.
  subroutine hear_signals(asked)
    type(requests_t), intent(out) :: asked

    call take_signals(asked%dump, asked%plot)
    asked%signalled = stop_requested()
    asked%stop = asked%signalled
  end subroutine hear_signals

  !> Leave out what has just been done.
  subroutine drop_echoes(before, echoes, asked)
    type(requests_t), intent(in) :: before    !! done since the last call
    type(echoes_t), intent(inout) :: echoes
    type(requests_t), intent(inout) :: asked
    integer(long) :: now, rate

    if (.not. any([before%dump, before%plot, asked%dump, asked%plot])) return
    call system_clock(now, rate)
    where ([before%dump, before%plot]) echoes%done = now
    asked%dump = asked%dump .and. now - rate > echoes%done(1)
    asked%plot = asked%plot .and. now - rate > echoes%done(2)
  end subroutine drop_echoes

  !> Look whether anything is asked for: for signals always, for d3kil twice a second, or
  !> always where steps are long.
  subroutine take_requests(state, ratio, steps_are_long, monitor, asked, error)
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: ratio          !! last energy ratio known
    logical, intent(in) :: steps_are_long
    type(monitor_t), intent(inout) :: monitor
    type(requests_t), intent(out) :: asked
    type(error_t), allocatable, intent(inout) :: error
    logical :: looks
    integer :: switch

    switch = switch_none
    looks = steps_are_long
    if (.not. looks) call wants_look(monitor%restarts, monitor%clock%is_on, monitor%clock%last, &
      state%cycle, looks)
    if (looks) call take_switch(monitor%restarts%directory, switch)
    call take_signals(asked%dump, asked%plot)
    asked%signalled = stop_requested()
    asked%dump = asked%dump .or. switch == switch_dump_and_stop .or. switch == switch_dump
    asked%plot = asked%plot .or. switch == switch_plot
    asked%stop = asked%signalled .or. switch == switch_dump_and_stop .or. switch == switch_stop
    select case (switch)
    case (switch_status)
      call show_progress(monitor%progress, monitor%clock, state%cycle, state%time, state%dt, &
        ratio, 'status (sw2)', .true.)
    case (switch_flush)
      if (.not. allocated(error)) call flush_histories(monitor%histories, error)
    case (switch_unknown)
      call warn(monitor%log, 'd3kil holds none of sw1, sw2, sw3, sw4, swa, stop')
    end select
  end subroutine take_requests

end module requests_m
