! SPDX-License-Identifier: MIT
!> Restart of the explicit driver: what a file holds, writing it between two cycles, and taking it up.
!>
!> Between two cycles a run is its state, the plan of its steps, how far its outputs are, and the deck. All of
!> that is written, so that the run that goes on makes the same bits as one that was not interrupted.
module restart_m
  use archive_m, only : archive_t, keep, keep_fixed, keep_text, enter, leave, fail_archive
  use contact_step_limit_m, only : spring_bound_t
  use errors_m, only : error_t, raise, status_files, status_input
  use files_m, only : file_exists, remove_file
  use kinds_m, only : wp, long
  use log_m, only : write_log, warn, to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t
  use progress_m, only : show_note
  use restart_file_m, only : create_restart, finish_restart, open_restart, close_restart, &
    file_checksum, unfinished
  use restart_history_m, only : keep_schedule, keep_histories, keep_times
  use restart_plan_m, only : restarts_t, dump_path, running_path
  use restart_state_m, only : keep_state
  use results_copy_m, only : check_old_results, copy_states
  use results_file_m, only : results_file_t
  use state_m, only : state_t
  use time_step_m, only : step_plan_t, cycles_in
  implicit none
  private
  public :: write_dump, write_running, take_up_file, take_up_results, take_up_state, &
    take_up_outputs, take_up_steps, forget_files

contains

  !> Write the next numbered restart file.
  subroutine write_dump(state, monitor, steps, damping, ratio, error)
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)   !! D per direction of the last cycle
    real(wp), intent(inout) :: ratio        !! last energy ratio known
    type(error_t), allocatable, intent(out) :: error

    monitor%restarts%n_dump = monitor%restarts%n_dump + 1
    call write_file(dump_path(monitor%restarts, monitor%restarts%n_dump), state, monitor, steps, &
      damping, ratio, error)
    if (.not. allocated(error)) call show_note(monitor%progress, monitor%log, 'restart file ' &
      //dump_path(monitor%restarts, monitor%restarts%n_dump)//place_text(state))
  end subroutine write_dump

  !> Write the running restart file, in place of the one before.
  subroutine write_running(state, monitor, steps, damping, ratio, error)
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)   !! D per direction of the last cycle
    real(wp), intent(inout) :: ratio        !! last energy ratio known
    type(error_t), allocatable, intent(out) :: error

    call write_file(running_path(monitor%restarts), state, monitor, steps, damping, ratio, error)
    if (.not. allocated(error)) call write_log(monitor%log, 'restart file ' &
      //running_path(monitor%restarts)//place_text(state))
  end subroutine write_running

  !> Write a restart file.
  subroutine write_file(path, state, monitor, steps, damping, ratio, error)
    character(*), intent(in) :: path
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)
    real(wp), intent(inout) :: ratio
    type(error_t), allocatable, intent(out) :: error
    type(archive_t) :: archive
    character(:), allocatable :: effective_deck

    call create_restart(path, archive)
    call read_effective_deck(monitor%restarts, archive, effective_deck)
    call keep_run(archive, monitor%restarts, effective_deck)
    if (allocated(effective_deck)) deallocate (effective_deck)
    call keep_outputs(archive, state%time, state%dt_before, monitor)
    call keep_steps(archive, steps, damping, ratio)
    call keep_state(archive, state)
    call finish_restart(archive, error)
  end subroutine write_file

  !> Time and cycle for a message.
  pure function place_text(state) result(text)
    type(state_t), intent(in) :: state
    character(:), allocatable :: text

    text = ' at time '//to_text(state%time)//', cycle '//to_text(state%cycle)
  end function place_text

  !> The deck as run, from the file that the run has written at its start: a large one is not kept
  !> in memory.
  subroutine read_effective_deck(restarts, archive, text)
    type(restarts_t), intent(in) :: restarts
    type(archive_t), intent(inout) :: archive
    character(:), allocatable, intent(out) :: text
    character(:), allocatable :: path, checksum, reason
    integer(long) :: length
    integer :: unit, status

    if (allocated(archive%error)) return
    path = restarts%prefix//'.effective.k'
    call file_checksum(path, 0, length, checksum, reason)
    if (.not. allocated(reason)) then
      if (checksum /= restarts%effective_deck_checksum) reason = 'it has been changed'
    end if
    if (.not. allocated(reason)) then
      allocate (character(length) :: text)
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
        action='read', iostat=status)
      if (status == 0) read (unit, iostat=status) text
      if (status == 0) close (unit)
      if (status /= 0) reason = 'it can not be read'
    end if
    if (allocated(reason)) call fail_archive(archive, 'no restart file can be written, since it ' &
      //'would hold the deck as run, '//path//': '//reason, status_files)
  end subroutine read_effective_deck

  !> What is known of the run.
  subroutine keep_run(archive, restarts, effective_deck)
    type(archive_t), intent(inout) :: archive
    type(restarts_t), intent(inout) :: restarts
    character(:), allocatable, intent(inout) :: effective_deck

    call enter(archive, 'run')
    call keep_text(archive, 'effective_deck', effective_deck)
    call keep_text(archive, 'job', restarts%job)
    call keep_text(archive, 'deck', restarts%deck)
    call keep_text(archive, 'program', restarts%program)
    call keep(archive, 'n_dump', restarts%n_dump)
    call leave(archive)
  end subroutine keep_run

  !> How far the outputs are.
  subroutine keep_outputs(archive, time, dt, monitor)
    type(archive_t), intent(inout) :: archive
    real(wp), intent(in) :: time, dt    !! of the state, and the step that led to it
    type(monitor_t), intent(inout) :: monitor
    real(wp), allocatable :: times(:)

    call enter(archive, 'outputs')
    call keep_schedule(archive, 'plot', time, dt, monitor%plot)
    call keep_schedule(archive, 'glstat', time, dt, monitor%glstat)
    call keep_schedule(archive, 'rcforc', time, dt, monitor%rcforc)
    call keep_schedule(archive, 'nodout', time, dt, monitor%nodout)
    call keep_schedule(archive, 'matsum', time, dt, monitor%matsum)
    call keep_schedule(archive, 'rwforc', time, dt, monitor%rwforc)
    call keep_schedule(archive, 'sleout', time, dt, monitor%sleout)
    call keep_schedule(archive, 'spcforc', time, dt, monitor%spcforc)
    call keep_histories(archive, 'histories', monitor%histories)
    if (.not. archive%is_read) call keep_times(archive, 'state_times', monitor%results, times)
    call leave(archive)
  end subroutine keep_outputs

  !> The plan of the steps, and what a cycle hands to the next besides the state.
  subroutine keep_steps(archive, steps, damping, ratio)
    type(archive_t), intent(inout) :: archive
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)
    real(wp), intent(inout) :: ratio

    call enter(archive, 'steps')
    call keep(archive, 'first_dt', steps%first_dt)
    call keep(archive, 'constant', steps%constant)
    call keep(archive, 'start_time', steps%start_time)
    call keep(archive, 'start_cycle', steps%start_cycle)
    call keep(archive, 'n_cycle', steps%n_cycle)
    call keep(archive, 'end_cycle', steps%end_cycle)
    call keep(archive, 'end_time', steps%end_time)
    call keep(archive, 'warned', steps%warned)
    call keep_springs(archive, 'springs', steps%springs)
    call keep_fixed(archive, 'damping', damping)
    call keep(archive, 'ratio', ratio)
    call leave(archive)
  end subroutine keep_steps

  !> Bounds of the contact springs.
  subroutine keep_springs(archive, name, springs)
    type(archive_t), intent(inout) :: archive
    character(*), intent(in) :: name
    type(spring_bound_t), allocatable, intent(inout) :: springs(:)
    integer :: i, n

    n = -1
    if (allocated(springs)) n = size(springs)
    call enter(archive, name)
    call keep(archive, 'n', n)
    if (archive%is_read) then
      if (allocated(springs)) deallocate (springs)
      if (n >= 0) allocate (springs(n))
    end if
    do i = 1, n
      call enter(archive, to_text(i))
      call keep(archive, 'rate', springs(i)%rate)
      call keep(archive, 'damping', springs(i)%damping)
      call keep(archive, 'node', springs(i)%node)
      call leave(archive)
    end do
    call leave(archive)
  end subroutine keep_springs

  !> Open the file to go on from; what it says of the run, and the deck as run.
  subroutine take_up_file(path, restarts, effective_deck, error)
    character(*), intent(in) :: path
    type(restarts_t), intent(inout) :: restarts
    character(:), allocatable, intent(out) :: effective_deck
    type(error_t), allocatable, intent(out) :: error

    call open_restart(path, restarts%source, error)
    if (allocated(error)) return
    restarts%goes_on = .true.
    call keep_run(restarts%source, restarts, effective_deck)
    if (allocated(restarts%source%error)) error = restarts%source%error
  end subroutine take_up_file

  !> Look for the results file whose states the run takes over; before anything is written.
  subroutine take_up_results(restarts, model, path, error)
    type(restarts_t), intent(inout) :: restarts
    type(model_t), intent(in) :: model
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(results_file_t) :: nothing

    call enter(restarts%source, 'outputs')
    call keep_times(restarts%source, 'state_times', nothing, restarts%state_times)
    call leave(restarts%source)
    if (allocated(restarts%source%error)) then
      error = restarts%source%error
    else
      call check_old_results(path, model%mesh%n_node, restarts%state_times, &
        restarts%finds_states, error)
    end if
  end subroutine take_up_results

  !> Read the state.
  subroutine take_up_state(source, model, state, error)
    type(archive_t), intent(inout) :: source
    type(model_t), intent(in) :: model
    type(state_t), intent(out) :: state
    type(error_t), allocatable, intent(out) :: error

    call keep_state(source, state)
    if (allocated(source%error)) then
      error = source%error
    else if (size(state%motion, 2) /= model%mesh%n_node &
      .or. size(state%contacts) /= size(model%contacts)) then
      call raise(error, 'the restart file '//source%path//' is of another model', status_input)
    else if (model%controls%end_time < state%time .and. .not. abs(state%time &
      - model%controls%end_time) <= state%dt_before) then
      call raise(error, 'the restart file '//source%path//' is of time '//to_text(state%time) &
        //', after the end time '//to_text(model%controls%end_time), status_input)
    end if
  end subroutine take_up_state

  !> Read how far the outputs are; the rows and states before the restart go into the new files.
  subroutine take_up_outputs(model, state, monitor, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error

    call keep_outputs(monitor%restarts%source, state%time, state%dt_before, monitor)
    if (allocated(monitor%restarts%source%error)) then
      error = monitor%restarts%source%error
      return
    end if
    call show_note(monitor%progress, monitor%log, 'restart from '//monitor%restarts%source%path &
      //place_text(state))
    if (.not. monitor%has_plot) return
    associate (restarts => monitor%restarts)
      if (restarts%finds_states) then
        call copy_states(monitor%results, model, restarts%state_times, error)
      else if (size(restarts%state_times) > 0) then
        call warn(monitor%log, 'there is no results file of the run before the restart: the new ' &
          //'one has the states from time '//to_text(state%time)//' on')
      end if
    end associate
  end subroutine take_up_outputs

  !> Read the plan of the steps, with the end that the deck gives now, and close the file.
  subroutine take_up_steps(model, source, steps, damping, ratio, error)
    type(model_t), intent(in) :: model
    type(archive_t), intent(inout) :: source
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: damping(2)
    real(wp), intent(inout) :: ratio
    type(error_t), allocatable, intent(out) :: error

    call keep_steps(source, steps, damping, ratio)
    steps%end_time = model%controls%end_time
    steps%end_cycle = model%controls%end_cycle
    if (steps%constant > 0.0_wp) steps%n_cycle = &
      cycles_in(steps%end_time - steps%start_time, steps%constant)
    call close_restart(source, error)
  end subroutine take_up_steps

  !> Remove what an earlier run of this name has left: files that it has not finished, and whole ones too
  !> unless the run goes on.
  subroutine forget_files(restarts, error)
    type(restarts_t), intent(in) :: restarts
    type(error_t), allocatable, intent(out) :: error
    logical :: found
    integer :: i

    call forget_file(running_path(restarts), .not. restarts%goes_on, found, error)
    i = 0
    do while (found .or. i == 0)
      i = i + 1
      if (.not. allocated(error)) &
        call forget_file(dump_path(restarts, i), .not. restarts%goes_on, found, error)
    end do
  end subroutine forget_files

  !> Remove an unfinished file, and a whole one if asked.
  subroutine forget_file(path, whole_too, found, error)
    character(*), intent(in) :: path
    logical, intent(in) :: whole_too
    logical, intent(out) :: found       !! there was one, and nothing stood in the way
    type(error_t), allocatable, intent(out) :: error

    found = file_exists(path)
    if (.not. found) found = file_exists(path//unfinished)
    call remove_file(path//unfinished, error)
    if (whole_too .and. .not. allocated(error)) call remove_file(path, error)
    found = found .and. .not. allocated(error)
  end subroutine forget_file

end module restart_m
