! SPDX-License-Identifier: MIT
!> The case of a deck that is run: its keywords are those outside of all subcases and those of its
!> subcases.
module deck_choose_case_m
  use errors_m, only : error_t
  use log_m, only : log_t, to_text, write_log
  use deck_cases_m, only : case_t, read_cases, find_case, cases_text
  use deck_lines_m, only : deck_t, line_error
  use deck_reader_m, only : read_blocks, cut_deck
  implicit none
  private
  public :: choose_case, list_cases

contains

  !> Cut a deck anew, for one case; so far it holds what stands outside of all subcases. Where that
  !> case is not there the first one is looked at: what is wrong with it is told too.
  subroutine choose_case(deck, id, refusal, log)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: id                           !! 0: none is asked for
    character(:), allocatable, intent(in) :: refusal    !! why the cases can not run as they are
                                                        !! asked for
    type(log_t), intent(inout) :: log
    type(case_t), allocatable :: cases(:)
    character(:), allocatable :: path, text
    integer :: i, k

    call read_cases(deck, cases)
    k = 0
    if (id > 0) k = find_case(cases, id)
    if (size(cases) > 0) then
      path = deck%sources(1)%path
      call move_alloc(deck%sources(1)%text, text)
      deck = deck_t()
      call cut_deck(path, text, deck, cases(max(k, 1))%sub_cases)
      call read_cases(deck, cases) ! what it tells went with the deck before
      do i = 1, size(cases(max(k, 1))%sub_cases)
        if (any(deck%cases%all == cases(max(k, 1))%sub_cases(i))) cycle
        deck%incomplete = .true.
      end do
    end if
    if (allocated(refusal)) call line_error(deck, 0, refusal)
    deck%incomplete = deck%incomplete .or. deck%cases%wrong
    if (k > 0) then
      text = ''
      do i = 1, size(cases(k)%sub_cases)
        text = text//' '//to_text(cases(k)%sub_cases(i))
      end do
      call write_log(log, 'case '//to_text(id)//' of the deck, subcases'//text)
    else if (id == 0 .and. any(cases%id > 0)) then
      call line_error(deck, 0, 'the deck has cases: say case=ID for one of '//cases_text(cases) &
        //', or case for all')
    else if (any(cases%id > 0)) then
      call line_error(deck, 0, 'case='//to_text(id)//': expected one of '//cases_text(cases))
    else if (size(cases) == 0 .and. .not. deck%cases%wrong) then
      call line_error(deck, 0, 'case= is asked for and the deck has no *CASE')
    end if
  end subroutine choose_case

  !> The cases of a deck, and what is wrong with them in its report.
  subroutine list_cases(path, deck, cases, error)
    character(*), intent(in) :: path
    type(deck_t), intent(inout) :: deck
    type(case_t), allocatable, intent(out) :: cases(:)
    type(error_t), allocatable, intent(out) :: error !! the deck could not be read

    call read_blocks(path, deck, error)
    if (.not. allocated(error)) call read_cases(deck, cases)
  end subroutine list_cases

end module deck_choose_case_m
