! SPDX-License-Identifier: MIT
!> Requests to stop from outside (SIGTERM, SIGINT) and the question whether a person watches.
!> A signal handler has no argument to carry a state, so this module holds the only saved variable
!> of the program.
module signals_m
  use, intrinsic :: iso_c_binding, only : c_int, c_intptr_t, c_funptr, c_funloc, c_null_funptr
  implicit none
  private
  public :: catch_stop_signals, stop_requested, output_is_terminal

  integer(c_int), parameter :: signal_interrupt = 2, signal_terminate = 15, signal_cpu_limit = 24, &
    signal_file_limit = 25
  !> The handler that ignores (SIG_IGN of all C libraries).
  integer(c_intptr_t), parameter :: ignore = 1
  !> Signal received, 0 = none.
  integer(c_int), volatile, save :: received = 0

  interface
    !> C library: install a handler.
    function c_signal(number, handler) bind(c, name='signal') result(previous)
      import :: c_int, c_funptr
      integer(c_int), value :: number
      type(c_funptr), value :: handler
      type(c_funptr) :: previous
    end function c_signal

    !> C library: whether a file descriptor is a terminal.
    function c_isatty(descriptor) bind(c, name='isatty') result(answer)
      import :: c_int
      integer(c_int), value :: descriptor
      integer(c_int) :: answer
    end function c_isatty
  end interface

contains

  !> From now on SIGTERM, SIGINT and a used up processor time (SIGXCPU) only ask for a stop, and a file that
  !> reaches the largest size allowed (SIGXFSZ) is a failed write and no end of the process.
  subroutine catch_stop_signals()
    type(c_funptr) :: previous

    previous = c_signal(signal_terminate, c_funloc(note_signal))
    previous = c_signal(signal_interrupt, c_funloc(note_signal))
    previous = c_signal(signal_cpu_limit, c_funloc(note_signal))
    previous = c_signal(signal_file_limit, transfer(ignore, c_null_funptr))
  end subroutine catch_stop_signals

  !> The handler.
  subroutine note_signal(number) bind(c)
    integer(c_int), value :: number

    received = number
  end subroutine note_signal

  !> Whether a stop was asked for.
  function stop_requested() result(requested)
    logical :: requested

    requested = received /= 0
  end function stop_requested

  !> Whether standard output is a terminal.
  function output_is_terminal() result(terminal)
    logical :: terminal

    terminal = c_isatty(1_c_int) == 1
  end function output_is_terminal

end module signals_m
