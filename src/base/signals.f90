! SPDX-License-Identifier: MIT
!> Requests from outside (SIGTERM, SIGINT and SIGHUP: stop, SIGUSR1: restart file, SIGUSR2: plot
!> state) and the question whether a person watches. A signal handler has no argument to carry a
!> state, so that it is saved here.
module signals_m
  use, intrinsic :: iso_c_binding, only : c_int, c_intptr_t, c_long, c_funptr, c_funloc, &
    c_null_funptr
  implicit none
  private
  public :: catch_requests, catch_stops, limit_processor, stop_requested, take_signals, &
    output_is_terminal

  !> Numbers of the signals, as Linux has them.
  integer(c_int), parameter :: signal_hang_up = 1, signal_interrupt = 2, signal_user_1 = 10, &
    signal_user_2 = 12, signal_pipe = 13, signal_terminate = 15, signal_cpu_limit = 24, &
    signal_file_limit = 25
  !> The handler that ignores (SIG_IGN of all C libraries).
  integer(c_intptr_t), parameter :: ignore = 1
  !> The resource of limits (RLIMIT_CPU of Linux).
  integer(c_int), parameter :: processor_time = 0
  !> Signals received: a stop, a restart file, a plot state; 0 = none.
  integer(c_int), volatile, save :: received(3) = 0

  interface
    !> C library: install a handler.
    function c_signal(number, handler) bind(c, name='signal') result(previous)
      import :: c_int, c_funptr
      integer(c_int), value :: number
      type(c_funptr), value :: handler
      type(c_funptr) :: previous
    end function c_signal

    !> POSIX getrlimit; 0 on success. A limit is two numbers (struct rlimit): the one that sends a
    !> signal and the one that kills.
    function c_getrlimit(resource, limits) bind(c, name='getrlimit') result(status)
      import :: c_int, c_long
      integer(c_int), value :: resource
      integer(c_long), intent(inout) :: limits(2)
      integer(c_int) :: status
    end function c_getrlimit

    !> POSIX setrlimit; 0 on success.
    function c_setrlimit(resource, limits) bind(c, name='setrlimit') result(status)
      import :: c_int, c_long
      integer(c_int), value :: resource
      integer(c_long), intent(in) :: limits(2)
      integer(c_int) :: status
    end function c_setrlimit

    !> C library: whether a file descriptor is a terminal.
    function c_isatty(descriptor) bind(c, name='isatty') result(answer)
      import :: c_int
      integer(c_int), value :: descriptor
      integer(c_int) :: answer
    end function c_isatty
  end interface

contains

  !> From now on no signal ends the process that is not meant to: SIGUSR1 and SIGUSR2 only ask for
  !> something; a pipe whose reader has gone (SIGPIPE) and a file that reaches the largest size
  !> allowed (SIGXFSZ) are failed writes.
  subroutine catch_requests()
    type(c_funptr) :: previous

    previous = c_signal(signal_user_1, c_funloc(note_signal))
    previous = c_signal(signal_user_2, c_funloc(note_signal))
    previous = c_signal(signal_pipe, transfer(ignore, c_null_funptr))
    previous = c_signal(signal_file_limit, transfer(ignore, c_null_funptr))
  end subroutine catch_requests

  !> From now on SIGTERM, SIGINT, SIGHUP and a used up processor time (SIGXCPU) ask for a stop.
  subroutine catch_stops()
    type(c_funptr) :: previous

    call catch_unless_ignored(signal_hang_up)
    call catch_unless_ignored(signal_interrupt)
    previous = c_signal(signal_terminate, c_funloc(note_signal))
    previous = c_signal(signal_cpu_limit, c_funloc(note_signal))
  end subroutine catch_stops

  !> After so much processor time the system asks for a stop (SIGXCPU); a lower limit that is set
  !> already stays.
  subroutine limit_processor(seconds)
    integer, intent(in) :: seconds
    integer(c_long) :: limits(2)
    integer(c_int) :: ignored

    if (c_getrlimit(processor_time, limits) /= 0) return
    ! No limit is the largest number without sign, which is -1 here.
    if (limits(1) < 0) limits(1) = huge(limits)
    limits(1) = min(limits(1), int(seconds, c_long))
    ignored = c_setrlimit(processor_time, limits)
  end subroutine limit_processor

  !> A signal that was ignored when the program started stays so: SIGHUP under nohup, SIGINT in a
  !> job that a script has put behind itself.
  subroutine catch_unless_ignored(number)
    integer(c_int), intent(in) :: number
    type(c_funptr) :: previous

    previous = c_signal(number, transfer(ignore, c_null_funptr))
    if (transfer(previous, ignore) /= ignore) previous = c_signal(number, c_funloc(note_signal))
  end subroutine catch_unless_ignored

  !> The handler.
  subroutine note_signal(number) bind(c)
    integer(c_int), value :: number

    select case (number)
    case (signal_user_1)
      received(2) = number
    case (signal_user_2)
      received(3) = number
    case default
      received(1) = number
    end select
  end subroutine note_signal

  !> Whether a stop was asked for.
  function stop_requested() result(requested)
    logical :: requested

    requested = received(1) /= 0
  end function stop_requested

  !> Whether a restart file or a plot state has been asked for since the last question.
  subroutine take_signals(dump, plot)
    logical, intent(out) :: dump, plot

    dump = received(2) /= 0
    if (dump) received(2) = 0
    plot = received(3) /= 0
    if (plot) received(3) = 0
  end subroutine take_signals

  !> Whether standard output is a terminal.
  function output_is_terminal() result(terminal)
    logical :: terminal

    terminal = c_isatty(1_c_int) == 1
  end function output_is_terminal

end module signals_m
