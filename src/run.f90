! SPDX-License-Identifier: MIT
!> One run: deck, model, state, driver, files.
module run_m
  use, intrinsic :: iso_fortran_env, only : output_unit
  use controls_m, only : is_asked
  use arguments_m, only : arguments_t, file_stem, only_end_time, timing_by_interface, timing_off
  use build_info_m, only : version, build_type, compiler, flags
  use checksum_m, only : add_bytes, checksum_text
  use clock_m, only : lap, start_clock, read_clock, track_interfaces, elapsed_seconds, &
    phase_input, phase_output
  use contact_dispatch_m, only : contact_kinds
  use deck_m, only : deck_request_t, read_deck
  use deck_restart_m, only : merge_decks, is_whole_deck, deck_identity
  use deck_reader_m, only : read_file
  use errors_m, only : error_t, raise, status_input, status_stopped
  use dynain_m, only : write_dynain
  use explicit_m, only : advance_explicit
  use implicit_m, only : advance_implicit
  use files_m, only : make_directory, remove_file, join_path, unfinished
  use history_file_m, only : close_histories
  use text_files_m, only : write_whole
  use remote_state_m, only : inside_tests_t, remote_t
  use kinds_m, only : long
  use log_m, only : log_t, open_log, close_log, write_log, warn, to_text
  use memory_m, only : processor_name
  use model_m, only : model_t
  use monitor_m, only : monitor_t, open_files, start_monitor, finish_monitor
  use progress_m, only : show_end, write_status, timing_text
  use rank_partition_m, only : distribute_model, distribute_start, release_remote
  use ranks_m, only : ranks_t, share_error
  use relaxation_m, only : relax, switch_loads
  use renumber_m, only : renumber_model, release_start_data
  use restart_file_m, only : open_restart
  use restart_m, only : remove_old_files
  use restart_plan_m, only : restarts_t, check_names, switch_path
  use restart_reading_m, only : read_restart_run, read_restart_state, find_restart_states, &
    check_other_components, restore_outputs
  use results_file_m, only : run_info_t
  use system_m, only : catch_stops, release_memory, limit_processor
  use source_version_m, only : source_version
  use start_m, only : start_state
  use state_m, only : state_t
  implicit none
  private
  public :: run_deck

contains

  !> Run the deck or restart file of the command line.
  subroutine run_deck(arguments, ranks, has_ended, error)
    type(arguments_t), intent(inout) :: arguments !! gets the job name of a restart file
    type(ranks_t), intent(in) :: ranks
    logical, intent(out) :: has_ended             !! the end of the run has been reported
    type(error_t), allocatable, intent(out) :: error
    type(model_t) :: model
    type(state_t) :: state
    type(monitor_t) :: monitor
    type(run_info_t) :: info
    logical :: has_all   !! each process holds the whole model

    has_ended = .false.
    monitor%ranks = ranks
    monitor%log%is_silent = ranks%mine > 0
    call start_clock(monitor%clock)
    monitor%clock%is_on = arguments%timing /= timing_off
    monitor%progress%is_quiet = arguments%quiet
    call catch_stops()
    if (arguments%cpu_seconds > 0) call limit_processor(arguments%cpu_seconds)
    call write_log(monitor%log, 'slideline '//version//' ('//build_type//', '//compiler &
      //', source '//source_version//')')
    call write_log(monitor%log, 'command line: '//arguments%line)
    if (len(arguments%ignored) > 0) call warn(monitor%log, &
      'without effect on the command line: '//arguments%ignored)
    if (ranks%mine == 0) then
      call read_model(arguments, monitor, model, info%effective_deck, error)
    else if (allocated(arguments%restart)) then
      call open_restart(arguments%restart, monitor%restarts%source, error)
      monitor%restarts%is_restart = .true.
    end if
    call share_error(ranks, error)
    if (allocated(error)) return
    call distribute_model(monitor%ranks, model, has_all)
    if (arguments%timing == timing_by_interface) &
      call track_interfaces(monitor%clock, size(model%contacts))
    monitor%restarts%prefix = ''
    if (ranks%mine == 0) then
      monitor%restarts%directory = arguments%directory
      monitor%restarts%job = arguments%job
      monitor%restarts%prefix = join_path(arguments%directory, arguments%job)
    end if
    if (monitor%restarts%is_restart) then
      call make_state(has_all, model, state, monitor, error)
      if (allocated(error)) return
    end if
    ! Folder of the results, and the log.
    if (ranks%mine == 0) then
      call make_directory(arguments%directory, error)
      if (.not. allocated(error)) call check_names(monitor%restarts, &
        model%controls%output%dump_cycles >= 0, .false., error)
      if (.not. allocated(error)) call open_log(monitor%log, monitor%restarts%prefix//'.log', &
        monitor%restarts%is_restart, error)
    end if
    call share_error(ranks, error)
    if (allocated(error)) return
    call begin_run(arguments, has_all, model, info, state, monitor, error)
    call lap(monitor%clock, phase_input)
    if (allocated(error)) then
      if (ranks%mine == 0) call report_failed_start(model, state, monitor, error)
    else
      call drive(arguments, model, state, monitor, error)
    end if
    has_ended = .true.
    call close_log(monitor%log)
    if (.not. allocated(error) .and. allocated(monitor%log%first_error)) &
      call move_alloc(monitor%log%first_error, error)
    call share_error(ranks, error)
  end subroutine run_deck

  !> Read the deck, in the first process only.
  subroutine read_model(arguments, monitor, model, effective, error)
    type(arguments_t), intent(inout) :: arguments
    type(monitor_t), intent(inout) :: monitor
    type(model_t), intent(out) :: model
    character(:), allocatable, intent(out) :: effective
    type(error_t), allocatable, intent(out) :: error
    type(deck_request_t) :: request

    request%overrides = arguments%overrides
    if (allocated(arguments%restart)) then
      call get_restart_deck(arguments, monitor, request, error)
      if (allocated(error)) return
    else
      request%path = arguments%deck
      monitor%restarts%deck = arguments%deck(index(arguments%deck, '/', back=.true.) + 1:)
    end if
    call read_deck(request, contact_kinds, monitor%log, model, effective, error)
    if (allocated(error)) return
    if (monitor%ranks%n > 1 .and. model%controls%implicit%is_on) then
      call raise(error, 'the deck asks for the implicit method (*CONTROL_IMPLICIT_GENERAL) and ' &
        //'the command line for '//to_text(monitor%ranks%n)//' processes: implicit runs have one ' &
        //'process', status_input)
      return
    end if
    call move_alloc(request%files, monitor%restarts%inputs)
    if (allocated(request%text)) deallocate (request%text)
    if (arguments%no_dump) model%controls%output%dump_cycles = -1
    call renumber_model(model)
  end subroutine read_model

  !> Deck of a restarted run: the deck in the restart file, with the changes of the command line and
  !> of a small deck.
  subroutine get_restart_deck(arguments, monitor, request, error)
    type(arguments_t), intent(inout) :: arguments  !! gets the job name of the restart file
    type(monitor_t), intent(inout) :: monitor
    type(deck_request_t), intent(inout) :: request
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: deck, changes, reason

    call read_restart_run(arguments%restart, monitor%restarts, deck, error)
    if (allocated(error)) return
    call write_log(monitor%log, 'restart from the restart file '//arguments%restart)
    if (monitor%restarts%program /= program_text()) call write_log(monitor%log, 'the restart ' &
      //'file was written by another build ('//monitor%restarts%program//'): results may ' &
      //'differ in their last digits')
    if (.not. allocated(arguments%job)) arguments%job = monitor%restarts%job
    request%path = arguments%restart
    if (allocated(arguments%deck)) then
      allocate (character(len(arguments%deck)) :: request%files(1))
      request%files = arguments%deck
      call read_file(arguments%deck, changes, reason)
      if (allocated(reason)) then
        call raise(error, 'cannot read the deck '//arguments%deck//': '//reason, status_input)
        return
      end if
      if (is_whole_deck(changes)) then
        call check_whole_deck(arguments, deck, monitor%restarts%is_implicit, request, error)
        return
      end if
      call merge_decks(deck, changes, arguments%deck, request%text, error)
      if (allocated(error)) return
    else
      allocate (character(1) :: request%files(0))
      call move_alloc(deck, request%text)
    end if
    if (.not. only_end_time(arguments)) call raise(error, &
      'of the overrides a restart allows the end time only (endtim=)', &
      status_input)
  end subroutine get_restart_deck

  !> Check that a whole deck beside the restart file equals the deck in the file, except for entries
  !> that a restart may change.
  subroutine check_whole_deck(arguments, deck, is_implicit, request, error)
    type(arguments_t), intent(in) :: arguments
    character(*), intent(in) :: deck               !! deck in the restart file
    logical, intent(in) :: is_implicit             !! method of the run that wrote the file
    type(deck_request_t), intent(inout) :: request
    type(error_t), allocatable, intent(out) :: error
    type(deck_request_t) :: whole
    type(log_t) :: unused
    type(model_t) :: model

    whole%path = arguments%deck
    whole%overrides = arguments%overrides
    call read_deck(whole, contact_kinds, unused, model, request%text, error)
    if (allocated(whole%files)) call move_alloc(whole%files, request%files)
    if (allocated(error)) return
    if (model%controls%implicit%is_on .neqv. is_implicit) then
      call raise(error, 'the restart file '//arguments%restart//' is refused: it is of ' &
        //trim(merge('an implicit run', 'an explicit run', is_implicit))//', and '//arguments%deck &
        //' asks for the '//trim(merge('explicit', 'implicit', is_implicit))//' method', &
        status_input)
    else if (deck_identity(request%text) == deck_identity(deck)) then
      deallocate (request%overrides) ! they are in the text
    else
      call raise(error, 'the restart file '//arguments%restart &
        //' is refused: it belongs to another deck (checksum '//deck_identity(deck)//') than ' &
        //arguments%deck//' ('//deck_identity(request%text)//')', status_input)
    end if
  end subroutine check_whole_deck

  !> Make the initial state. The first process comes first: the others hold their own elements only
  !> and need masses from it.
  subroutine make_state(has_all, model, state, monitor, error)
    logical, intent(in) :: has_all
    type(model_t), intent(inout) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    type(remote_t), allocatable :: remote
    type(inside_tests_t), allocatable :: inside_tests

    if (monitor%ranks%mine == 0) then
      if (.not. has_all) allocate (inside_tests)
      call make_own_state()
    end if
    call share_error(monitor%ranks, error)
    if (allocated(error)) return
    if (.not. has_all) call distribute_start(model, monitor%ranks, state, remote, inside_tests)
    if (monitor%ranks%mine > 0) call make_own_state()
    call share_error(monitor%ranks, error)

  contains

    !> State at time zero or of the restart file, the latter with all later components checked
    !> before a file of an earlier run is changed.
    subroutine make_own_state()
      associate (restarts => monitor%restarts)
        if (restarts%is_restart) then
          call read_restart_state(restarts%source, model, state, error, remote, inside_tests)
          if (.not. allocated(error)) call check_other_components(restarts%source, model, state, &
            error)
          if (.not. allocated(error) .and. monitor%ranks%mine == 0) &
            call find_restart_states(restarts, model, restarts%prefix//'.vtkhdf', error)
        else
          call start_state(model, monitor%log, state, error, remote, inside_tests)
        end if
      end associate
    end subroutine make_own_state

  end subroutine make_state

  !> Version and build of the program.
  pure function program_text() result(text)
    character(:), allocatable :: text

    text = version//', '//build_type//', '//compiler//', '//flags
  end function program_text

  !> Open the files, make the initial state and run the dynamic relaxation.
  subroutine begin_run(arguments, has_all, model, info, state, monitor, error)
    type(arguments_t), intent(in) :: arguments
    logical, intent(in) :: has_all
    type(model_t), intent(inout) :: model
    type(run_info_t), intent(inout) :: info
    type(state_t), intent(inout) :: state  !! known already in a restart
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    logical :: relaxes

    if (monitor%ranks%mine == 0) then
      call write_deck(info%effective_deck, monitor%restarts, error)
      ! Data of the run for the results file.
      if (allocated(model%controls%title)) info%title = model%controls%title
      info%deck = monitor%restarts%deck
      info%version = version
      info%build = build_type//', '//compiler//', '//flags
      info%options = arguments%line
      info%source = source_version
      if (is_asked(model%controls%output%plot)) info%machine = processor_name()
      info%checksum = monitor%restarts%effective_deck_checksum
    end if
    if (.not. allocated(error)) then
      call open_files(model, monitor%restarts%prefix, info, monitor, error)
    end if
    call share_error(monitor%ranks, error)
    if (allocated(error)) return
    if (allocated(info%effective_deck)) deallocate (info%effective_deck)
    if (.not. monitor%restarts%is_restart) &
      call make_state(has_all, model, state, monitor, error)
    if (allocated(error)) return
    call start_monitor(model, size(state%elements%history) > 0, monitor)
    relaxes = model%controls%relaxation%is_on .and. .not. model%controls%check_only .and. &
      (state%relaxation%n > 0 .or. .not. monitor%restarts%is_restart)
    if (relaxes) call relax(model, monitor, state, error)
    if (allocated(error)) return
    ! Loads of the relaxation only (SIDR 1) end here.
    if (any(model%curves%phase == 1)) call switch_loads(model, 1)
    call release_start_data(model)
    call release_memory()
    if (monitor%restarts%is_restart) call restore_outputs(model, state, monitor, error)
    ! After relaxation a run begins at time zero, also in a restart.
    if (relaxes) monitor%restarts%is_restart = .false.
    call release_remote(model, monitor%ranks, state)
    call share_error(monitor%ranks, error)
    if (.not. allocated(error) .and. monitor%ranks%mine == 0) &
      call begin_status(model, state, monitor)
  end subroutine begin_run

  !> Write the effective deck, which restart files contain, and remove restart files of an earlier
  !> run of this name.
  subroutine write_deck(effective, restarts, error)
    character(*), intent(in) :: effective
    type(restarts_t), intent(inout) :: restarts
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    integer(long) :: checksum

    restarts%program = program_text()
    checksum = 0
    call add_bytes(checksum, effective)
    restarts%effective_deck_checksum = checksum_text(checksum)
    call remove_file(switch_path(restarts%directory), ignored)
    call remove_old_files(restarts, error)
    if (.not. allocated(error)) call write_whole(restarts%prefix//'.effective.k', &
      effective, error)
  end subroutine write_deck

  !> Begin the file status.out; <job>.status.out where the job has a name of its own (jobid=), as in
  !> LS-DYNA.
  subroutine begin_status(model, state, monitor)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(monitor_t), intent(inout) :: monitor

    associate (status => monitor%progress, restarts => monitor%restarts)
      status%job = restarts%job
      status%path = join_path(restarts%directory, 'status.out')
      if (restarts%job /= file_stem(restarts%deck)) &
        status%path = join_path(restarts%directory, restarts%job//'.status.out')
      status%cycle = state%cycle
      status%start_cycle = state%cycle
      status%end_cycle = model%controls%end_cycle
      status%time = state%time
      status%start_time = state%time
      status%end_time = model%controls%end_time
      status%start_seconds = elapsed_seconds(monitor%clock)
    end associate
    call write_status(monitor%progress, monitor%clock, 'running')
  end subroutine begin_status

  !> Advance to the end, close the files and report the end.
  subroutine drive(arguments, model, state, monitor, error)
    type(arguments_t), intent(in) :: arguments
    type(model_t), intent(inout) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: closing_error
    character(:), allocatable :: reason
    integer :: n_thread
    logical :: stopped

    if (model%controls%check_only) then
      reason = 'model checked, no solution asked for (NOSOL)'
    else if (model%controls%implicit%is_on) then
      call advance_implicit(model, state, monitor, reason, error)
    else
      ! Use only as many threads as have enough elements.
      n_thread = max(1, min(arguments%n_thread, &
        model%mesh%n_element/monitor%ranks%n/arguments%thread_share))
      call advance_explicit(model, n_thread, state, monitor, reason, error)
    end if
    stopped = reason == 'stopped on request'
    if (stopped) reason = reason//' (exit status '//to_text(status_stopped)//') before the ' &
      //'termination time '//to_text(model%controls%end_time)
    if (monitor%ranks%mine == 0) then
      if (model%springback%is_on .and. .not. (stopped .or. allocated(error) .or. &
        model%controls%check_only)) then
        call write_dynain(model, state, monitor%restarts%prefix//'.dynain', error)
        if (.not. allocated(error)) call write_log(monitor%log, 'state for the next stage: ' &
          //monitor%restarts%job//'.dynain')
      end if
      call finish_monitor(monitor, closing_error)
      if (.not. allocated(error) .and. allocated(closing_error)) &
        call move_alloc(closing_error, error)
      call report_end_of_run(model, state, reason, monitor, error)
    end if
    call share_error(monitor%ranks, error)
    if (stopped .and. .not. allocated(error)) call raise(error, &
      'stopped on request at time '//to_text(state%time), status_stopped)
  end subroutine drive

  !> End a run that failed or was stopped before its first state. The results file has no state and
  !> does not get its name, so that the file of a run before a restart keeps its states; status.out
  !> is written anew.
  subroutine report_failed_start(model, state, monitor, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: ignored, stop
    character(:), allocatable :: reason

    call close_histories(monitor%histories, ignored)
    if (allocated(monitor%results%path)) &
      call remove_file(monitor%results%path//unfinished, ignored)
    call begin_status(model, state, monitor)
    reason = ''
    if (error%status == status_stopped) then
      call move_alloc(error, stop)
      reason = stop%message//' (exit status '//to_text(status_stopped)//')'
    end if
    call report_end_of_run(model, state, reason, monitor, error)
    if (allocated(stop) .and. .not. allocated(error)) call move_alloc(stop, error)
  end subroutine report_failed_start

  !> Write the timing file and report the end: by `error`, or else for `reason`.
  subroutine report_end_of_run(model, state, reason, monitor, error)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: reason
    type(state_t), intent(in) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: problem
    character(:), allocatable :: message
    integer, allocatable :: interfaces(:) !! their numbers

    call lap(monitor%clock, phase_output)
    call read_clock(monitor%clock)
    allocate (interfaces(0))
    if (allocated(model%contacts)) interfaces = model%contacts%id
    call write_whole(monitor%restarts%prefix//'.timing.csv', &
      timing_text(monitor%clock, interfaces), problem)
    if (.not. allocated(error) .and. allocated(problem)) call move_alloc(problem, error)
    if (.not. allocated(error) .and. allocated(monitor%log%first_error)) error = &
      monitor%log%first_error
    message = reason
    if (allocated(error)) message = error%message
    call show_end(monitor%progress, monitor%clock, monitor%log, .not. allocated(error), message, &
      state%cycle, state%time, model%mesh%n_element)
  end subroutine report_end_of_run

end module run_m
