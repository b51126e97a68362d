! SPDX-License-Identifier: MIT
!> The case of a deck that is run: its keywords are those outside of all subcases and those of its
!> subcases.
module deck_choose_case_m
  use errors_m, only : error_t
  use log_m, only : log_t, to_text, write_log
  use deck_cases_m, only : case_t, read_cases, find_case, cases_text
  use deck_lines_m, only : deck_t, line_error
  use deck_reader_m, only : read_blocks, cut_deck
  use deck_report_m, only : emit_errors
  implicit none
  private
  public :: choose_case, list_cases

contains

  !> Cut a deck anew, for one case; so far it holds what stands outside of all subcases. Mistakes of
  !> cases are told before all others: what they do to the rest of the deck is not known.
  subroutine choose_case(deck, id, log, error)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: id !! 0: none is asked for
    type(log_t), intent(inout) :: log
    type(error_t), allocatable, intent(out) :: error
    type(case_t), allocatable :: cases(:)
    character(:), allocatable :: path, text
    integer :: i, k, n_error

    n_error = deck%report%n_error
    if (deck%cases%wrong) n_error = 0
    call read_cases(deck, cases)
    k = find_case(cases, id)
    if (id == 0 .and. size(cases) > 0) then
      call line_error(deck, 0, 'the deck has cases: say case=ID for one of '//cases_text(cases) &
        //', or case for all')
    else if (size(cases) == 0 .and. .not. deck%cases%wrong) then
      call line_error(deck, 0, 'case='//to_text(id)//': the deck has no *CASE')
    else if (k == 0 .and. size(cases) > 0) then
      call line_error(deck, 0, 'case='//to_text(id)//': expected one of '//cases_text(cases))
    end if
    path = deck%sources(1)%path
    if (deck%report%n_error > n_error) then
      call emit_errors(deck%report, path, error)
      return
    end if
    call move_alloc(deck%sources(1)%text, text)
    deck = deck_t()
    call cut_deck(path, text, deck, cases(k)%sub_cases)
    text = ''
    do i = 1, size(cases(k)%sub_cases)
      text = text//' '//to_text(cases(k)%sub_cases(i))
    end do
    call write_log(log, 'case '//to_text(id)//' of the deck, subcases'//text)
    call read_cases(deck, cases) ! for its warnings
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
