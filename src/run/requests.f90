! SPDX-License-Identifier: MIT
!> What someone outside asks of a run while it goes on, by a word in d3kil or by a signal. What
!> needs no more than the files (a line of status, histories brought up to date) is done here;
!> the driver does the rest.
module requests_m
  use errors_m, only : error_t
  use files_m, only : file_exists, is_endless, join_path, remove_file
  use history_file_m, only : flush_histories
  use kinds_m, only : wp, long
  use log_m, only : warn
  use monitor_m, only : monitor_t
  use progress_m, only : show_progress
  use restart_plan_m, only : wants_look
  use state_m, only : state_t
  use system_m, only : stop_requested, is_requested, request_dump, request_plot
  use text_m, only : upper_case
  implicit none
  private
  public :: requests_t, take_requests, echoes_t, hear_signals, drop_echoes, switch_path, &
    take_switch

  !> Longest line that is read, whatever the environment says (GFORTRAN_DEFAULT_RECL).
  integer, parameter :: line_length = 100000

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

    asked%dump = is_requested(request_dump)
    asked%plot = is_requested(request_plot)
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
    character(:), allocatable :: switch

    switch = ''
    looks = steps_are_long
    if (.not. looks) call wants_look(monitor%restarts, monitor%clock%is_on, monitor%clock%last, &
      state%cycle, looks)
    if (looks) call take_switch(monitor%restarts%directory, switch)
    call hear_signals(asked)
    select case (switch)
    case ('')
      continue
    case ('SW1')
      asked%dump = .true.
      asked%stop = .true.
    case ('SW2')
      call show_progress(monitor%progress, monitor%clock, state%cycle, state%time, state%dt, &
        ratio, 'status (sw2)', .true.)
    case ('SW3')
      asked%dump = .true.
    case ('SW4')
      asked%plot = .true.
    case ('STOP')
      asked%stop = .true.
    case ('SWA')
      if (.not. allocated(error)) call flush_histories(monitor%histories, .true., error)
    case default
      call warn(monitor%log, 'd3kil holds none of sw1, sw2, sw3, sw4, swa, stop')
    end select
  end subroutine take_requests

  !> Where a request is looked for.
  pure function switch_path(directory) result(path)
    character(*), intent(in) :: directory !! of the results
    character(:), allocatable :: path

    path = join_path(directory, 'd3kil')
  end function switch_path

  !> The word in the file d3kil of this folder, in capital letters and without the point of `SWA.`,
  !> as old manuals write it; the file is removed. One without a word is left: it may be about to be
  !> written.
  subroutine take_switch(directory, switch)
    character(*), intent(in) :: directory
    character(:), allocatable, intent(out) :: switch  !! empty: none
    type(error_t), allocatable :: ignored
    character(80) :: line
    integer :: unit, status

    switch = ''
    if (.not. file_exists(switch_path(directory))) return
    if (is_endless(switch_path(directory))) return
    open (newunit=unit, file=switch_path(directory), status='old', action='read', &
      recl=line_length, iostat=status)
    if (status /= 0) return
    read (unit, '(a)', iostat=status) line
    close (unit)
    if (status /= 0 .or. len_trim(line) == 0) return
    line = upper_case(adjustl(line))
    if (line(4:) == '.') line(4:) = ''
    switch = trim(line)
    call remove_file(switch_path(directory), ignored)
  end subroutine take_switch

end module requests_m
