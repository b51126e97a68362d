! SPDX-License-Identifier: MIT
!> When a run writes restart files and under which names, and the one that it goes on from.
module restart_plan_m
  use archive_m, only : archive_t
  use kinds_m, only : wp, long
  use log_m, only : to_text
  use state_m, only : state_t
  implicit none
  private
  public :: restarts_t, dump_path, running_path, place_text, wanted_files, &
    numbered_file, running_file, wants_look

  !> Kinds of restart files: those that stay, and the one that is replaced again and again.
  integer, parameter :: numbered_file = 1, running_file = 2

  !> Seconds between two looks for a sense switch, and cycles where no clock is read anyhow.
  real(wp), parameter :: look_interval = 0.5_wp
  integer, parameter :: look_cycles = 64

  !> Restart files of a run.
  type :: restarts_t
    character(:), allocatable :: directory !! where results go, and where d3kil is looked for
    character(:), allocatable :: job       !! stem of the result files
    character(:), allocatable :: prefix    !! directory and job name
    character(:), allocatable :: deck      !! file name of the deck
    character(:), allocatable :: inputs(:) !! paths of the deck and of what it includes
    character(:), allocatable :: program   !! version and build
    character(:), allocatable :: effective_deck_checksum !! of the file `<prefix>.effective.k`
    logical :: is_implicit = .false.       !! method of the run
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

  !> Path of the numbered file `i`.
  pure function dump_path(restarts, i) result(path)
    type(restarts_t), intent(in) :: restarts
    integer, intent(in) :: i
    character(:), allocatable :: path
    character(12) :: number

    write (number, '(ss,i0.2)') i
    path = restarts%prefix//'.dump'//trim(number)//'.h5'
  end function dump_path

  !> Path of the file that is replaced again and again.
  pure function running_path(restarts) result(path)
    type(restarts_t), intent(in) :: restarts
    character(:), allocatable :: path

    path = restarts%prefix//'.runrsf.h5'
  end function running_path

  !> Time and cycle for a message.
  pure function place_text(state) result(text)
    type(state_t), intent(in) :: state
    character(:), allocatable :: text

    text = ' at time '//to_text(state%time)//', cycle '//to_text(state%cycle)
    if (state%relaxation%n > 0) text = ' in dynamic relaxation, after ' &
      //to_text(state%relaxation%n)//' cycles'
  end function place_text

  !> Which kinds of files are due before cycle `cycle`: at their intervals; before the last cycle
  !> the numbered one; before a stop by a signal both that the deck asks for.
  pure function wanted_files(restarts, cycle, asked, is_last, stops) result(wanted)
    type(restarts_t), intent(in) :: restarts
    integer, intent(in) :: cycle
    logical, intent(in) :: asked    !! someone asks for a numbered one
    logical, intent(in) :: is_last  !! that cycle is the last one
    logical, intent(in) :: stops    !! a signal asks for a stop
    logical :: wanted(2)            !! numbered_file, running_file

    wanted(numbered_file) = asked .or. (restarts%dump_cycles >= 0 .and. (is_last .or. stops)) &
      .or. ends_interval(cycle, restarts%dump_cycles)
    wanted(running_file) = (restarts%running_cycles > 0 .and. stops) &
      .or. ends_interval(cycle, restarts%running_cycles)
  end function wanted_files

  !> Whether a file is due at its interval; none at the start, nor where there is no interval.
  pure function ends_interval(cycle, interval) result(ends)
    integer, intent(in) :: cycle, interval
    logical :: ends

    ends = .false.
    if (interval > 0 .and. cycle > 0) ends = mod(cycle, interval) == 0
  end function ends_interval

  !> Whether it is time to look for a sense switch. `tick` is the last clock tick known; where none
  !> is read in a cycle, one is read now and then.
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
