! SPDX-License-Identifier: MIT
!> The runs that one command line asks for: one, or one for each case of the deck.
module case_plan_m
  use arguments_m, only : arguments_t, read_arguments
  use deck_cards_m, only : reject_field
  use deck_cases_m, only : case_t, find_case, cases_text
  use deck_choose_case_m, only : list_cases
  use deck_findings_m, only : list_findings
  use deck_lines_m, only : deck_t, line_error
  use deck_report_m, only : emit_errors
  use errors_m, only : error_t, raise
  use log_m, only : to_text
  implicit none
  private
  public :: plan_cases, case_name, join_failures

contains

  !> What each run is asked for. The words of a case (COMMANDS) come before those of the command
  !> line. Where the deck has no cases the word `case` is without effect.
  subroutine plan_cases(arguments, runs, error, findings)
    type(arguments_t), intent(in) :: arguments
    type(arguments_t), allocatable, intent(out) :: runs(:)
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable, intent(out) :: findings !! as `list_findings` has them
    type(deck_t) :: deck
    type(case_t), allocatable :: cases(:)
    integer :: i, k
    integer, allocatable :: chosen(:)

    findings = ''
    runs = [arguments]
    if (.not. (arguments%all_cases .or. size(arguments%cases) > 0)) return
    call list_cases(arguments%deck, deck, cases, error)
    if (allocated(error)) return
    if (arguments%all_cases .and. .not. deck%cases%found) then
      runs(1)%ignored = trim(runs(1)%ignored//' case')
      return
    end if
    chosen = arguments%cases
    if (arguments%all_cases) chosen = [(cases(i)%id, i=1, size(cases))]
    if (size(cases) == 0) then
      call line_error(deck, 0, 'case= is asked for and the deck has no *CASE')
    else
      do i = 1, size(chosen)
        if (find_case(cases, chosen(i)) == 0) call line_error(deck, 0, 'case=' &
          //to_text(chosen(i))//': expected one of '//cases_text(cases))
      end do
    end if
    if (size(chosen) > 1 .and. arguments%job_is_given) call line_error(deck, 0, &
      'jobid= on the command line would be the name of '//to_text(size(chosen)) &
      //' cases: expected one case (case=ID), or JOBID of *CASE')
    deallocate (runs)
    allocate (runs(size(chosen)))
    do i = 1, size(chosen)
      k = find_case(cases, chosen(i))
      if (k > 0) call ask_for(arguments, cases(k), deck, runs(i))
    end do
    call emit_errors(deck%report, arguments%deck, error)
    call list_findings(deck%report, findings)
  end subroutine plan_cases

  !> The run of one case.
  subroutine ask_for(arguments, item, deck, run)
    type(arguments_t), intent(in) :: arguments
    type(case_t), intent(in) :: item
    type(deck_t), intent(inout) :: deck
    type(arguments_t), intent(out) :: run
    type(error_t), allocatable :: error

    call read_arguments(run, error, item%commands)
    if (allocated(error)) call reject_field(deck, item%place, &
      error%message(:index(error%message, new_line('a'), back=.true.) - 1))
    run%case = item%id
    if (.not. arguments%job_is_given .and. .not. allocated(arguments%restart)) run%job = item%job
  end subroutine ask_for

  !> How a case is told of.
  pure function case_name(run) result(name)
    type(arguments_t), intent(in) :: run
    character(:), allocatable :: name

    name = 'case '//to_text(run%case)
    if (allocated(run%job)) name = name//' ('//run%job//')'
  end function case_name

  !> One error of all cases that are refused; a message that several share is told once.
  subroutine join_failures(runs, failures, error)
    type(arguments_t), intent(in) :: runs(:)
    type(error_t), intent(in) :: failures(:) !! without a message: accepted
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text, names
    integer :: i, k, first

    text = ''
    first = 0
    do i = 1, size(runs)
      if (.not. allocated(failures(i)%message)) cycle
      if (first == 0) first = i
      names = ''
      do k = 1, size(runs)
        if (.not. allocated(failures(k)%message)) cycle
        if (failures(k)%message /= failures(i)%message) cycle
        if (k < i) exit
        if (k > i) names = names//', '
        names = names//case_name(runs(k))
      end do
      if (k > size(runs)) text = text//names//':'//new_line('a')//failures(i)%message//new_line('a')
    end do
    if (first == 0) return
    if (runs(1)%case == 0) text = failures(1)%message//new_line('a')
    call raise(error, text(:len(text) - 1), failures(first)%status)
  end subroutine join_failures

end module case_plan_m
