! SPDX-License-Identifier: MIT
!> When a run writes restart files and under which names, and the one that it goes on from.
module restart_plan_m
  use archive_m, only : archive_t
  use controls_m, only : output_plan_t
  use kinds_m, only : wp, long
  implicit none
  private
  public :: restarts_t, plan_restarts, dump_path, running_path, wants_dump, wants_running, &
    wants_look

  !> Seconds between two looks for a sense switch, and cycles where no clock is read anyhow.
  real(wp), parameter :: look_interval = 0.5_wp
  integer, parameter :: look_cycles = 64

  !> Restart files of a run.
  type :: restarts_t
    character(:), allocatable :: directory !! where results go, and where d3kil is looked for
    character(:), allocatable :: job       !! stem of the result files
    character(:), allocatable :: prefix    !! directory and job name
    character(:), allocatable :: deck      !! file name of the deck
    character(:), allocatable :: program   !! version and build
    character(:), allocatable :: effective_deck_checksum !! of the file `<prefix>.effective.k`
    integer :: dump_cycles = -1            !! as in output_plan_t
    integer :: running_cycles = 0
    integer :: n_dump = 0                  !! numbered files so far
    integer(long) :: next_look = 0         !! tick of the next look for a sense switch
    logical :: goes_on = .false.           !! the run goes on from `source`
    type(archive_t) :: source
    real(wp), allocatable :: state_times(:) !! of states that the results file had at the restart
    logical :: finds_states = .false.      !! and has still
  end type restarts_t

contains

  !> Take the plan from the deck.
  pure subroutine plan_restarts(restarts, plan)
    type(restarts_t), intent(inout) :: restarts
    type(output_plan_t), intent(in) :: plan

    restarts%dump_cycles = plan%dump_cycles
    restarts%running_cycles = plan%running_cycles
  end subroutine plan_restarts

  !> Path of the numbered file `i`.
  pure function dump_path(restarts, i) result(path)
    type(restarts_t), intent(in) :: restarts
    integer, intent(in) :: i
    character(:), allocatable :: path
    character(12) :: number

    write (number, '(i0.2)') i
    path = restarts%prefix//'.dump'//trim(number)//'.h5'
  end function dump_path

  !> Path of the file that is replaced again and again.
  pure function running_path(restarts) result(path)
    type(restarts_t), intent(in) :: restarts
    character(:), allocatable :: path

    path = restarts%prefix//'.runrsf.h5'
  end function running_path

  !> Whether a numbered file is due before cycle `cycle`: at its interval, and before the last one.
  pure function wants_dump(restarts, cycle, is_last) result(wanted)
    type(restarts_t), intent(in) :: restarts
    integer, intent(in) :: cycle
    logical, intent(in) :: is_last
    logical :: wanted

    wanted = restarts%dump_cycles >= 0 .and. is_last
    if (restarts%dump_cycles > 0) wanted = wanted .or. mod(cycle, restarts%dump_cycles) == 0
  end function wants_dump

  !> Whether the running file is due before cycle `cycle`: at its interval, and before a stop on request.
  pure function wants_running(restarts, cycle, stops) result(wanted)
    type(restarts_t), intent(in) :: restarts
    integer, intent(in) :: cycle
    logical, intent(in) :: stops
    logical :: wanted

    wanted = .false.
    if (restarts%running_cycles > 0) wanted = stops .or. mod(cycle, restarts%running_cycles) == 0
  end function wants_running

  !> Whether it is time to look for a sense switch. `tick` is the last clock tick known; where none is
  !> read in a cycle, one is read now and then.
  subroutine wants_look(restarts, ticks_run, tick, cycle, wanted)
    type(restarts_t), intent(inout) :: restarts
    logical, intent(in) :: ticks_run
    integer(long), intent(in) :: tick
    integer, intent(in) :: cycle
    logical, intent(out) :: wanted
    integer(long) :: now, rate

    now = tick
    if (.not. ticks_run .and. mod(cycle, look_cycles) == 0) call system_clock(now)
    wanted = now >= restarts%next_look
    if (.not. wanted) return
    call system_clock(now, rate)
    restarts%next_look = now + int(look_interval*real(rate, wp), long)
  end subroutine wants_look

end module restart_plan_m
