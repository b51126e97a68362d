! SPDX-License-Identifier: MIT
!> The runs that one command line asks for: one, or one for each case of the deck.
module case_plan_m
  use arguments_m, only : arguments_t, read_arguments
  use deck_cases_m, only : case_t, find_case
  use deck_choose_case_m, only : list_cases
  use deck_lines_m, only : deck_t
  use errors_m, only : error_t, raise
  use freight_m, only : freight_t
  use freight_sharing_m, only : hand, everyone
  use log_m, only : to_text
  use ranks_m, only : ranks_t, share_error
  use visitor_m, only : visited_t, visitor_t, length
  implicit none
  private
  public :: plan_cases, case_name, join_failures

  !> The cases of a deck.
  type, extends(visited_t) :: cases_t
    logical :: found = .false. !! it has some
    type(case_t), allocatable :: list(:)
  contains
    procedure :: visit => visit_cases
  end type cases_t

contains

  !> What each run is asked for. The words of a case (COMMANDS) come before those of the command
  !> line. Where the deck has no cases the word `case` is without effect. Mistakes of the deck are
  !> told by whoever reads all of it.
  subroutine plan_cases(arguments, ranks, runs, deck, error)
    type(arguments_t), intent(in) :: arguments
    type(ranks_t), intent(inout) :: ranks
    type(arguments_t), allocatable, intent(out) :: runs(:)
    type(deck_t), allocatable, intent(out) :: deck !! that has been cut, if it had to be; of
                                                   !! several processes the first one has it
    type(error_t), allocatable, intent(out) :: error
    type(cases_t) :: cases
    type(freight_t) :: freight
    character(:), allocatable :: refusal
    integer :: i, k, n_asked
    integer, allocatable :: chosen(:)

    runs = [arguments]
    if (.not. (arguments%all_cases .or. size(arguments%cases) > 0)) return
    if (ranks%mine == 0) then
      allocate (deck)
      call list_cases(arguments%deck, deck, cases%list, error)
      cases%found = deck%cases%found
    end if
    call share_error(ranks, error)
    if (allocated(error)) return
    if (ranks%n > 1) call hand(ranks, everyone, freight, cases)
    if (arguments%all_cases .and. .not. cases%found) &
      runs(1)%ignored = trim(adjustl(runs(1)%ignored//' case'))
    chosen = arguments%cases
    ! A number that is none is a mistake, which the other cases tell.
    if (arguments%all_cases) chosen = pack([(cases%list(i)%id, i=1, size(cases%list))], &
      [(cases%list(i)%id > 0, i=1, size(cases%list))])
    n_asked = size(chosen)
    if (arguments%all_cases) n_asked = size(cases%list)
    if (n_asked > 1 .and. arguments%job_is_given) refusal = 'jobid= on the command line would be ' &
      //'the name of '//to_text(n_asked)//' cases: expected one case (case=ID), or JOBID of *CASE'
    if (size(chosen) == 0) then
      if (allocated(refusal)) runs(1)%refusal = refusal
      return
    end if
    deallocate (runs)
    allocate (runs(size(chosen)))
    do i = 1, size(chosen)
      runs(i) = arguments
      runs(i)%case = chosen(i)
      k = find_case(cases%list, chosen(i))
      if (k > 0) call ask_for(cases%list(k), allocated(refusal), runs(i))
      if (allocated(refusal)) runs(i)%refusal = refusal
    end do
  end subroutine plan_cases

  !> Its components.
  subroutine visit_cases(self, visitor)
    class(cases_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('found', self%found)
    if (visitor%makes(length(self%list))) allocate (self%list(visitor%n_item))
    call visitor%each('list', self%list)
  end subroutine visit_cases

  !> The run of one case.
  subroutine ask_for(item, is_own_name, run)
    type(case_t), intent(in) :: item
    logical, intent(in) :: is_own_name       !! that of the case, whatever the command line says
    type(arguments_t), intent(inout) :: run  !! as without cases
    type(arguments_t) :: asked
    type(error_t), allocatable :: error

    call read_arguments(asked, error, item%commands)
    if (.not. allocated(error)) run = asked
    run%case = item%id
    if (is_own_name .or. .not. (run%job_is_given .or. allocated(run%restart))) run%job = item%job
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
