! SPDX-License-Identifier: MIT
!> Restart: read the data of the run, its state and the progress of its outputs from a restart file,
!> and the files of the run before.
module restart_reading_m
  use archive_m, only : archive_t
  use errors_m, only : error_t, raise, status_input
  use explicit_cycle_m, only : explicit_cycle_t, read_cycle
  use implicit_forces_m, only : start_trial
  use implicit_start_m, only : implicit_memory_t
  use remote_state_m, only : inside_tests_t, remote_t, remote_releases
  use kinds_m, only : wp
  use log_m, only : log_t, warn, to_text
  use model_m, only : model_t
  use history_file_m, only : plan_histories
  use element_erosion_m, only : restore_interfaces
  use monitor_m, only : monitor_t, start_schedules, output_reach
  use progress_m, only : show_note
  use restart_file_m, only : open_restart
  use restart_m, only : visit_run, visit_outputs, check_state
  use restart_plan_m, only : restarts_t, place_text
  use results_file_m, only : check_old_results, copy_states
  use start_m, only : start_state, resume_contacts
  use state_m, only : state_t
  use visitor_m, only : any_length
  implicit none
  private
  public :: read_restart_run, find_restart_states, read_restart_state, check_other_components, &
    restore_outputs

  !> Share of the last step by which an implicit run may exceed its end time; an explicit run may
  !> exceed it by a whole step.
  real(wp), parameter :: round_off = 1.0e-9_wp

contains

  !> Open a restart file and read the data of the run and the deck as run.
  subroutine read_restart_run(path, restarts, effective_deck, error)
    character(*), intent(in) :: path
    type(restarts_t), intent(inout) :: restarts
    character(:), allocatable, intent(out) :: effective_deck
    type(error_t), allocatable, intent(out) :: error

    call open_restart(path, restarts%source, error)
    if (allocated(error)) return
    restarts%is_restart = .true.
    call visit_run(restarts%source, restarts, effective_deck)
    if (allocated(restarts%source%error)) error = restarts%source%error
  end subroutine read_restart_run

  !> Find the results file whose states the run takes over, before any file is written.
  subroutine find_restart_states(restarts, model, path, error)
    type(restarts_t), intent(inout) :: restarts
    type(model_t), intent(in) :: model
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error

    call restarts%source%enter('outputs')
    call restarts%source%visit('state_times', restarts%state_times, any_length)
    call restarts%source%leave()
    if (.not. allocated(restarts%state_times)) allocate (restarts%state_times(0))
    if (allocated(restarts%source%error)) then
      error = restarts%source%error
    else
      call check_old_results(path, model%mesh%n_node, restarts%state_times, &
        restarts%finds_states, error)
    end if
  end subroutine find_restart_states

  !> Read the state into one that is set up from the model, which determines the expected shapes.
  subroutine read_restart_state(source, model, state, error, remote, inside_tests)
    type(archive_t), intent(inout) :: source
    type(model_t), intent(in) :: model
    type(state_t), intent(out) :: state
    type(error_t), allocatable, intent(out) :: error
    type(remote_t), intent(inout), optional :: remote !! nodes and slots of other processes
    type(inside_tests_t), intent(inout), optional :: inside_tests
    type(log_t) :: silence

    silence%is_silent = .true.
    call start_state(model, silence, state, error, remote, inside_tests)
    if (allocated(error)) return
    if (model%controls%implicit%is_on) &
      allocate (state%acceleration(2, model%mesh%n_node), source=0.0_wp)
    if (model%erodes) then
      ! The surfaces of interfaces follow from the status of the elements.
      call source%enter('state')
      call source%enter('elements')
      call source%enter('erosion')
      call source%visit('status', state%elements%erosion%status)
      call source%leave()
      call source%leave()
      call source%leave()
      if (.not. allocated(source%error)) call restore_interfaces(model, state)
    end if
    if (present(remote)) source%releases = remote_releases(remote)
    if (.not. allocated(source%error)) call source%part('state', state)
    if (.not. allocated(source%error)) call check_state(model, state, source)
    if (.not. allocated(source%error)) call resume_contacts(state)
    if (allocated(source%error)) then
      error = source%error
    else if (state%time - model%controls%end_time > merge(round_off, 1.0_wp, &
      model%controls%implicit%is_on)*state%dt_before) then
      call raise(error, 'the restart file '//source%path//' is of time '//to_text(state%time) &
        //', after the end time '//to_text(model%controls%end_time), status_input)
    end if
  end subroutine read_restart_state

  !> Check the components that are read after the files are opened, so that a refused file leaves
  !> all files as they are: progress of the outputs and driver data.
  subroutine check_other_components(source, model, state, error)
    type(archive_t), intent(inout) :: source
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state     !! of the restart file
    type(error_t), allocatable, intent(out) :: error
    type(monitor_t) :: planned
    type(implicit_memory_t) :: memory
    type(explicit_cycle_t) :: cycle

    call plan_histories(planned%histories, model)
    call start_schedules(model, planned)
    call visit_outputs(source, state%time - state%dt_before, &
      output_reach(model%controls, state%dt_before), planned)
    if (model%controls%implicit%is_on) then
      call start_trial(model, state, memory%trial)
      call source%part('driver', memory)
    else if (state%relaxation%n == 0) then
      call read_cycle(model, state, source, cycle)
    end if
    if (allocated(source%error)) error = source%error
  end subroutine check_other_components

  !> Restore the progress of the outputs; rows and states before the restart go into the new files.
  subroutine restore_outputs(model, state, monitor, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error

    call visit_outputs(monitor%restarts%source, state%time - state%dt_before, &
      output_reach(model%controls, state%dt_before), monitor)
    if (allocated(monitor%restarts%source%error)) then
      error = monitor%restarts%source%error
      return
    end if
    if (monitor%ranks%mine > 0) return
    call show_note(monitor%progress, monitor%log, 'restart from '//monitor%restarts%source%path &
      //place_text(state))
    if (.not. monitor%has_plot) return
    associate (restarts => monitor%restarts)
      if (restarts%finds_states) then
        call copy_states(monitor%results, model, restarts%state_times, error)
      else if (size(restarts%state_times) > 0) then
        call warn(monitor%log, 'no results file of the run before the restart was found: the ' &
          //'new one begins at time '//to_text(state%time))
      end if
    end associate
  end subroutine restore_outputs

end module restart_reading_m
