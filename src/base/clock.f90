! SPDX-License-Identifier: MIT
!> Wall time per phase of the run. One clock read per change of phase: `lap` adds the time since the
!> last read to the phase that has ended, so that the phases add up to the total exactly. The time
!> of an interface is the increase of the contact phases during its laps.
module clock_m
  use kinds_m, only : wp, long
  implicit none
  private
  public :: clock_t, start_clock, read_clock, lap, track_interfaces, lap_interface, lap_seconds, &
    elapsed_seconds, total_seconds, phase_seconds, phase_names, n_phase, n_contact_phase, &
    phase_elements, phase_contact_search, phase_contact_pairing, phase_contact_force, &
    phase_nodes, phase_output, phase_input, phase_solver

  integer, parameter :: n_phase = 8
  integer, parameter :: phase_elements = 1, phase_contact_search = 2, phase_contact_pairing = 3, &
    phase_contact_force = 4, phase_nodes = 5, phase_output = 6, phase_input = 7, phase_solver = 8
  !> The contact phases follow each other.
  integer, parameter :: n_contact_phase = phase_contact_force - phase_contact_search + 1
  !> Names of the phases in the timing file, in the order of the `phase_` constants.
  character(15), parameter :: phase_names(n_phase) = [character(15) :: 'elements', &
    'contact_search', 'contact_pairing', 'contact_force', 'nodes', 'output', 'input', 'solver']

  !> Accumulated ticks and laps of each phase.
  type :: clock_t
    logical :: is_on = .true.           !! laps are taken; else only the total is known
    integer(long) :: first = 0          !! tick at the start
    integer(long) :: last = 0           !! tick of the last read
    integer(long) :: ticks(n_phase) = 0 !! ticks spent in each phase
    integer(long) :: calls(n_phase) = 0 !! laps of each phase
    !> (n_contact_phase, 0:n_interface) ticks and laps of the contact phases by interface, their
    !> sums in column 0; allocated on request.
    integer(long), allocatable :: interface_ticks(:, :), interface_calls(:, :)
  end type clock_t

contains

  !> Set the clock to zero.
  subroutine start_clock(clock)
    type(clock_t), intent(out) :: clock

    call system_clock(clock%first)
    clock%last = clock%first
  end subroutine start_clock

  !> Add the time since the last lap to `phase`.
  subroutine lap(clock, phase)
    type(clock_t), intent(inout) :: clock
    integer, intent(in) :: phase
    integer(long) :: now

    if (.not. clock%is_on) return
    call system_clock(now)
    clock%ticks(phase) = clock%ticks(phase) + (now - clock%last)
    clock%calls(phase) = clock%calls(phase) + 1
    clock%last = now
  end subroutine lap

  !> Read the clock where no laps are taken: for progress output and for the total at the end.
  subroutine read_clock(clock)
    type(clock_t), intent(inout) :: clock

    if (.not. clock%is_on) call system_clock(clock%last)
  end subroutine read_clock

  !> Record the contact phases by interface from now on.
  pure subroutine track_interfaces(clock, n_interface)
    type(clock_t), intent(inout) :: clock
    integer, intent(in) :: n_interface

    allocate (clock%interface_ticks(n_contact_phase, 0:n_interface), source=0_long)
    allocate (clock%interface_calls(n_contact_phase, 0:n_interface), source=0_long)
  end subroutine track_interfaces

  !> Add the increase of the contact phases since the last call to one interface.
  pure subroutine lap_interface(clock, i_interface)
    type(clock_t), intent(inout) :: clock
    integer, intent(in) :: i_interface

    if (.not. allocated(clock%interface_ticks)) return
    associate (ticks => clock%ticks(phase_contact_search:phase_contact_force), &
      calls => clock%calls(phase_contact_search:phase_contact_force), &
      by_ticks => clock%interface_ticks, by_calls => clock%interface_calls)
      by_ticks(:, i_interface) = by_ticks(:, i_interface) + (ticks - by_ticks(:, 0))
      by_calls(:, i_interface) = by_calls(:, i_interface) + (calls - by_calls(:, 0))
      by_ticks(:, 0) = ticks
      by_calls(:, 0) = calls
    end associate
  end subroutine lap_interface

  !> Cost of one lap on this machine: the minimum of several short series, since other processes
  !> interfere.
  function lap_seconds() result(seconds)
    real(wp) :: seconds
    integer, parameter :: n_series = 20, n_lap = 50
    type(clock_t) :: clock
    integer(long) :: least, rate, first
    integer :: i, j

    least = huge(least)
    call system_clock(first, rate)
    do i = 1, n_series
      call start_clock(clock)
      do j = 1, n_lap
        call lap(clock, phase_nodes)
      end do
      least = min(least, clock%ticks(phase_nodes))
    end do
    seconds = real(least, wp)/real(rate, wp)/n_lap
  end function lap_seconds

  !> Seconds since `start_clock`.
  function elapsed_seconds(clock) result(seconds)
    type(clock_t), intent(in) :: clock
    real(wp) :: seconds
    integer(long) :: now, rate

    call system_clock(now, rate)
    seconds = real(now - clock%first, wp)/real(rate, wp)
  end function elapsed_seconds

  !> Seconds from the start to the last lap.
  function total_seconds(clock) result(seconds)
    type(clock_t), intent(in) :: clock
    real(wp) :: seconds
    integer(long) :: now, rate

    call system_clock(now, rate)
    seconds = real(clock%last - clock%first, wp)/real(rate, wp)
  end function total_seconds

  !> Seconds spent in each phase.
  function phase_seconds(clock) result(seconds)
    type(clock_t), intent(in) :: clock
    real(wp) :: seconds(n_phase)
    integer(long) :: now, rate

    call system_clock(now, rate)
    seconds = real(clock%ticks, wp)/real(rate, wp)
  end function phase_seconds

end module clock_m
