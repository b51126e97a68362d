! SPDX-License-Identifier: MIT
!> The runs that one command line asks for, one after the other.
module case_runs_m
  use arguments_m, only : arguments_t
  use case_plan_m, only : plan_cases, case_name, join_failures
  use contact_dispatch_m, only : contact_kinds
  use deck_lines_m, only : deck_t
  use deck_m, only : deck_request_t, read_deck
  use endings_m, only : error_ending
  use errors_m, only : error_t, raise, status_run
  use files_m, only : join_path
  use log_m, only : log_t, to_text
  use model_m, only : model_t
  use ranks_m, only : ranks_t, share_error
  use restart_plan_m, only : restarts_t
  use result_names_m, only : check_names
  use run_m, only : run_deck
  use screen_m, only : show, complain
  implicit none
  private
  public :: run_cases

contains

  !> Run what the command line asks for. Of several cases none begins where one is refused; after an
  !> error termination the next one begins, but not after a stop on request or trouble with files.
  subroutine run_cases(arguments, ranks, has_ended, error)
    type(arguments_t), intent(in) :: arguments
    type(ranks_t), intent(inout) :: ranks
    logical, intent(out) :: has_ended !! how all has ended has been told
    type(error_t), allocatable, intent(out) :: error
    type(arguments_t), allocatable :: runs(:)
    type(error_t), allocatable :: failure
    type(deck_t), allocatable :: deck
    character(:), allocatable :: failed
    integer :: i, n_failed, status

    has_ended = .false.
    call plan_cases(arguments, ranks, runs, deck, error)
    if (allocated(error)) return
    if (ranks%mine == 0 .and. size(runs) > 1) call read_decks(runs, deck, error)
    call share_error(ranks, error)
    if (allocated(error)) return
    n_failed = 0
    failed = ''
    do i = 1, size(runs)
      if (runs(i)%case > 0 .and. ranks%mine == 0) call show(case_name(runs(i)))
      call run_deck(runs(i), deck, ranks, has_ended, failure)
      if (.not. allocated(failure)) cycle
      if (size(runs) == 1) then
        call move_alloc(failure, error)
        return
      end if
      if (ranks%mine == 0) call tell_failure(runs(i), failure, has_ended)
      n_failed = n_failed + 1
      if (n_failed == 1) status = failure%status
      failed = failed//', '//case_name(runs(i))//' (status '//to_text(failure%status)//')'
      if (failure%status /= status_run) exit
    end do
    if (n_failed == 0) return
    do i = i + 1, size(runs)
      failed = failed//', '//case_name(runs(i))//' not run'
    end do
    has_ended = .false.
    call raise(error, 'of '//to_text(size(runs))//' cases have not ended normally: '//failed(3:), &
      status)
  end subroutine run_cases

  !> Read the decks of all cases, so that the mistakes of all are told before the first one runs.
  subroutine read_decks(runs, deck, error)
    type(arguments_t), intent(in) :: runs(:)
    type(deck_t), allocatable, intent(inout) :: deck !! cut for none of them; the first takes it
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: failures(:), failure
    type(deck_request_t) :: request
    type(log_t) :: unused
    type(model_t) :: model
    character(:), allocatable :: effective
    integer :: i

    unused%is_mute = .true.
    allocate (failures(size(runs)))
    do i = 1, size(runs)
      request%path = runs(i)%deck
      request%overrides = runs(i)%overrides
      request%n_of_case = runs(i)%n_of_case
      request%case = runs(i)%case
      call move_alloc(deck, request%deck)
      if (allocated(request%refusal)) deallocate (request%refusal)
      if (allocated(runs(i)%refusal)) request%refusal = runs(i)%refusal
      call read_deck(request, contact_kinds, unused, model, effective, failure)
      if (.not. allocated(failure)) call check_case(runs(i), model, request%files, failure)
      if (allocated(failure)) failures(i) = failure
    end do
    call join_failures(runs, failures, error)
  end subroutine read_decks

  !> Whether a result of a case has the name of a file that is read.
  subroutine check_case(run, model, files, error)
    type(arguments_t), intent(in) :: run
    type(model_t), intent(in) :: model
    character(*), intent(in) :: files(:) !! that have been read
    type(error_t), allocatable, intent(out) :: error
    type(restarts_t) :: names

    names%directory = run%directory
    names%job = run%job
    names%prefix = join_path(run%directory, run%job)
    allocate (names%inputs, source=files)
    call check_names(names, model%controls%output%dump_cycles >= 0, .true., error)
  end subroutine check_case

  !> Why a case has not ended normally; others may follow.
  subroutine tell_failure(run, failure, has_ended)
    type(arguments_t), intent(in) :: run
    type(error_t), intent(in) :: failure
    logical, intent(in) :: has_ended !! its end has been told

    call complain(case_name(run)//': '//failure%message)
    if (.not. has_ended) call show(error_ending)
  end subroutine tell_failure

end module case_runs_m
