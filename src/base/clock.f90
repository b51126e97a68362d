! SPDX-License-Identifier: MIT
!> Wall time per phase of the run. One clock read per change of phase: `lap` gives the time since
!> the last read to the phase that just ended, so that the phases add up to the total exactly.
module clock_m
  use kinds_m, only : wp, long
  implicit none
  private
  public :: clock_t, start_clock, lap, elapsed_seconds, phase_seconds, phase_names, n_phase, &
    phase_elements, phase_contact_search, phase_contact_pairing, phase_contact_force, &
    phase_nodes, phase_output, phase_input, phase_solver

  integer, parameter :: n_phase = 8
  integer, parameter :: phase_elements = 1, phase_contact_search = 2, phase_contact_pairing = 3, &
    phase_contact_force = 4, phase_nodes = 5, phase_output = 6, phase_input = 7, phase_solver = 8
  !> Names of the phases in the timing file, in the order of the `phase_` constants.
  character(15), parameter :: phase_names(n_phase) = [character(15) :: 'elements', &
    'contact_search', 'contact_pairing', 'contact_force', 'nodes', 'output', 'input', 'solver']

  !> Accumulated ticks and laps of each phase.
  type :: clock_t
    integer(long) :: first = 0          !! tick at the start
    integer(long) :: last = 0           !! tick of the last lap
    integer(long) :: ticks(n_phase) = 0 !! ticks spent in each phase
    integer(long) :: calls(n_phase) = 0 !! laps given to each phase
  end type clock_t

contains

  !> Set the clock to zero.
  subroutine start_clock(clock)
    type(clock_t), intent(out) :: clock

    call system_clock(clock%first)
    clock%last = clock%first
  end subroutine start_clock

  !> Give the time since the last lap to `phase`.
  subroutine lap(clock, phase)
    type(clock_t), intent(inout) :: clock
    integer, intent(in) :: phase
    integer(long) :: now

    call system_clock(now)
    clock%ticks(phase) = clock%ticks(phase) + (now - clock%last)
    clock%calls(phase) = clock%calls(phase) + 1
    clock%last = now
  end subroutine lap

  !> Seconds since `start_clock`.
  function elapsed_seconds(clock) result(seconds)
    type(clock_t), intent(in) :: clock
    real(wp) :: seconds
    integer(long) :: now, rate

    call system_clock(now, rate)
    seconds = real(now - clock%first, wp)/real(rate, wp)
  end function elapsed_seconds

  !> Seconds spent in each phase.
  function phase_seconds(clock) result(seconds)
    type(clock_t), intent(in) :: clock
    real(wp) :: seconds(n_phase)
    integer(long) :: now, rate

    call system_clock(now, rate)
    seconds = real(clock%ticks, wp)/real(rate, wp)
  end function phase_seconds

end module clock_m
