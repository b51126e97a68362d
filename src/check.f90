! SPDX-License-Identifier: MIT
!> `slideline check`: errors and warnings of a deck and of the start of its run, without time steps.
!> With d= it writes the state at time zero and the model, for plots; otherwise it writes no file.
module check_m
  use arguments_m, only : arguments_t
  use build_info_m, only : version
  use contact_dispatch_m, only : contact_kinds
  use controls_m, only : is_asked
  use deck_m, only : deck_request_t, read_deck
  use deck_report_m, only : finding_t, add_finding, json_text
  use errors_m, only : error_t, raise, status_files
  use explicit_m, only : advance_explicit
  use files_m, only : join_path, make_directory
  use implicit_m, only : advance_implicit
  use log_m, only : log_t, clear_pending, to_text
  use model_m, only : model_t
  use model_tables_m, only : write_model
  use monitor_m, only : monitor_t
  use renumber_m, only : renumber_model
  use results_file_m, only : open_results, append_state, finish_results, publish, run_info_t
  use text_files_m, only : print_line
  use snapshot_filling_m, only : start_snapshot
  use start_m, only : start_state
  use state_m, only : state_t
  implicit none
  private
  public :: check_deck

contains

  !> Check the deck of the command line and print its findings; `error` is that of a run.
  subroutine check_deck(arguments, error)
    type(arguments_t), intent(in) :: arguments
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: failure
    type(deck_request_t) :: request
    type(model_t) :: model
    type(monitor_t) :: monitor
    type(run_info_t) :: info
    character(:), allocatable :: findings

    request%path = arguments%deck
    request%overrides = arguments%overrides
    call read_deck(request, contact_kinds, monitor%log, model, info%effective_deck, error, findings)
    if (allocated(error)) then
      if (index(findings, '"severity": "error"') == 0) &
        call add_message('error', error%message, findings)
    else
      ! The deck's warnings are findings already.
      call clear_pending(monitor%log)
      call start_run(arguments, info, model, monitor, error)
      call add_warnings(monitor%log, findings)
      if (allocated(error)) call add_message('error', error%message, findings)
    end if
    if (arguments%json) then
      call print_line(findings_text(arguments%deck, findings, allocated(error)), failure)
      ! A failure to print prevails over an error of the deck.
      if (allocated(failure)) call raise(error, failure%message, status_files)
    else if (.not. allocated(error)) then
      call print_line(arguments%deck//': accepted, '//counted(model%mesh%n_element, &
        'element')//', ' &
        //to_text(model%mesh%n_node)//' nodes, '//counted(size(model%contacts), 'interface') &
        //', '//counted(monitor%log%n_warning, 'warning'))
    end if
  end subroutine check_deck

  !> Compute the state at time zero with its warnings; with d= write it and the model to
  !> `<job>.start.vtkhdf`, undeformed where the run cannot start.
  subroutine start_run(arguments, info, model, monitor, error)
    type(arguments_t), intent(in) :: arguments
    type(run_info_t), intent(inout) :: info
    type(model_t), intent(inout) :: model
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: failure
    type(state_t) :: state
    character(:), allocatable :: reason
    logical :: has_history

    monitor%only_checks = .true.
    monitor%clock%is_on = .false.
    monitor%progress%is_quiet = .true.
    monitor%has_plot = allocated(arguments%directory)
    if (monitor%has_plot .and. .not. is_asked(model%controls%output%plot)) &
      model%controls%output%plot%dt = model%controls%end_time
    call renumber_model(model)
    if (monitor%has_plot) then
      info%deck = arguments%deck(index(arguments%deck, '/', back=.true.) + 1:)
      if (allocated(model%controls%title)) info%title = model%controls%title
      info%version = version
      info%options = arguments%line
      call make_directory(arguments%directory, failure)
      if (.not. allocated(failure)) call open_results(monitor%results, &
        join_path(arguments%directory, arguments%job//'.start.vtkhdf'), model, info, .false., &
        failure)
      call write_model(monitor%results%id, model, failure)
      call publish(monitor%results, failure)
    end if
    call start_state(model, monitor%log, state, error)
    has_history = .false.
    if (allocated(state%elements%history)) has_history = size(state%elements%history) > 0
    call start_snapshot(model, has_history, monitor%snapshot)
    if (.not. allocated(error)) then
      if (model%controls%implicit%is_on) then
        call advance_implicit(model, state, monitor, reason, error)
      else
        call advance_explicit(model, 1, state, monitor, reason, error)
      end if
    end if
    if (monitor%results%n_state == 0 .and. .not. allocated(failure)) &
      call append_state(monitor%results, model, monitor%snapshot, failure)
    if (.not. allocated(failure)) &
      call finish_results(monitor%results, monitor%histories, failure)
    if (allocated(failure) .and. .not. allocated(error)) call move_alloc(failure, error)
  end subroutine start_run

  !> Add the pending warnings of a log.
  subroutine add_warnings(log, findings)
    type(log_t), intent(in) :: log
    character(:), allocatable, intent(inout) :: findings
    integer :: start, last

    if (.not. allocated(log%pending)) return
    start = 1
    do while (start <= log%n_pending)
      last = start + index(log%pending(start:), new_line('a')) - 2
      if (index(log%pending(start:last), 'warning: ') == 1) &
        call add_message('warning', log%pending(start + 9:last), findings)
      start = last + 2
    end do
  end subroutine add_warnings

  !> A number with a noun in singular or plural.
  pure function counted(n, name) result(text)
    integer, intent(in) :: n
    character(*), intent(in) :: name
    character(:), allocatable :: text

    text = to_text(n)//' '//name
    if (n /= 1) text = text//'s'
  end function counted

  !> Add a finding without a location.
  subroutine add_message(severity, message, findings)
    character(*), intent(in) :: severity, message
    character(:), allocatable, intent(inout) :: findings
    type(finding_t) :: finding

    finding%message = message
    call add_finding(severity, finding, findings)
  end subroutine add_message

  !> One JSON object with the findings.
  pure function findings_text(path, findings, refused) result(text)
    character(*), intent(in) :: path, findings
    logical, intent(in) :: refused
    character(:), allocatable :: text
    character(1), parameter :: n = new_line('a')

    text = '{'//n//'  "deck": '//json_text(path)//','//n//'  "accepted": ' &
      //trim(merge('false', 'true ', refused))//','//n//'  "findings": ['//n
    if (len(findings) > 0) text = text//findings//n
    text = text//'  ]'//n//'}'
  end function findings_text

end module check_m
