! SPDX-License-Identifier: MIT
!> *CASE: runs of one deck, each of what stands outside of all subcases and of the subcases that the
!> case names. Without a *CASE each subcase is a case of its own number.
module deck_cases_m
  use log_m, only : to_text
  use text_m, only : upper_case
  use deck_lines_m, only : deck_t, place_t, line_text, line_error, line_warning, replace_line, &
    flag_comma, flag_parameter
  use deck_fields_m, only : card_t, field_text
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_row, next_text, report_field, &
    reject_field
  use deck_card_specs_m, only : field_number
  use deck_command_words_m, only : next_word, command_mistake, control_mistake
  use deck_parameter_table_m, only : parameters_t
  use deck_values_m, only : integer_of, is_blank
  use deck_checks_m, only : require_id
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: case_t, read_cases, find_case, cases_text

  !> One case.
  type, extends(visited_t) :: case_t
    integer :: id = 0
    integer :: line = 0                   !! of its keyword
    character(:), allocatable :: job      !! stem of its result files
    character(:), allocatable :: commands !! words of the command line, without those that are
                                          !! wrong
    integer, allocatable :: sub_cases(:)
  contains
    procedure :: visit => visit_case
  end type case_t

contains

  !> All cases of a deck that has been cut, in its order.
  subroutine read_cases(deck, cases)
    type(deck_t), intent(inout) :: deck
    type(case_t), allocatable, intent(out) :: cases(:)
    type(case_t) :: item
    integer :: i

    allocate (cases(0))
    do i = 1, deck%n_block
      if (deck%blocks(i)%name /= 'CASE') cycle
      call read_case(deck, i, item)
      cases = [cases, item]
    end do
    if (size(cases) > 0) then
      call compare_cases(deck, cases)
      call look_for_names(deck, cases)
      return
    end if
    do i = 1, size(deck%cases%all)
      item = case_t(id=deck%cases%all(i), line=deck%cases%places(i), &
        sub_cases=deck%cases%all(i:i))
      item%job = default_job(item%id)
      item%commands = ''
      cases = [cases, item]
    end do
  end subroutine read_cases

  !> The name of the results of a case that has no JOBID.
  pure function default_job(id) result(job)
    integer, intent(in) :: id
    character(:), allocatable :: job

    job = 'case'//to_text(id)
  end function default_job

  !> One *CASE.
  subroutine read_case(deck, i_block, item)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(case_t), intent(out) :: item
    type(parameters_t) :: no_parameters
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: line

    allocate (no_parameters%items(0))
    item%line = deck%blocks(i_block)%keyword
    call open_cursor(deck, i_block, cursor)
    if (cursor%line <= cursor%last) call part_words(deck, cursor%line)
    call next_card(deck, no_parameters, cursor, 1, card)
    call require_id(deck, cursor, card, 'CASEID')
    item%id = integer_of(card, 'CASEID')
    item%job = default_job(item%id)
    if (.not. is_blank(card, 'JOBID')) then
      item%job = field_text(deck, card, field_number(card%names, 'JOBID'))
      if (scan(item%job, ' /') > 0 .or. len(control_mistake(item%job)) > 0) &
        call report_field(deck, cursor, card, 'JOBID', &
        'is no stem of result files: expected a name without blanks and /, ' &
        //'nor control characters')
    end if
    line = cursor%line
    call next_text(deck, cursor, item%commands)
    call check_commands(deck, line, item%commands)
    call read_sub_cases(deck, no_parameters, cursor, item%sub_cases)
  end subroutine read_case

  !> Words that may not stand there, or whose value no deck takes, are told and taken out. What is
  !> left has its mistakes told with the deck that it changes.
  subroutine check_commands(deck, line, commands)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line !! of the card
    character(:), allocatable, intent(inout) :: commands
    character(:), allocatable :: rest, word, mistake

    rest = trim(adjustl(commands))
    commands = ''
    do while (len(rest) > 0)
      call next_word(rest, word)
      mistake = command_mistake(word)
      if (len(mistake) == 0) then
        commands = commands//word//' '
      else
        call reject_field(deck, place_t(line=line, card=2, name='COMMANDS', field=1), mistake)
      end if
    end do
  end subroutine check_commands

  !> The subcases of a case, to the end of its block.
  subroutine read_sub_cases(deck, parameters, cursor, sub_cases)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    type(cursor_t), intent(inout) :: cursor
    integer, allocatable, intent(out) :: sub_cases(:)
    type(card_t) :: card
    integer :: k
    logical :: found

    allocate (sub_cases(0))
    do
      call next_row(deck, parameters, cursor, 3, card, found)
      if (.not. found) exit
      do k = field_number(card%names, 'SCID1'), field_number(card%names, 'SCID8')
        if (card%bad(k) .or. card%i(k) == 0) cycle
        if (any(sub_cases == card%i(k))) then
          call report_field(deck, cursor, card, k, 'is named twice')
        else if (.not. any(deck%cases%all == card%i(k))) then
          call report_field(deck, cursor, card, k, 'is no subcase of this deck: expected n of a ' &
            //'*CASE_BEGIN_n')
        end if
        sub_cases = [sub_cases, card%i(k)]
      end do
    end do
  end subroutine read_sub_cases

  !> A number and a name with a blank between, wherever they stand: LS-DYNA's examples have them not
  !> in their columns. Such a line is read as one with a comma.
  subroutine part_words(deck, line)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    character(:), allocatable :: text
    integer :: n

    if (iand(deck%flags(line), ior(flag_comma, flag_parameter)) /= 0) return
    text = trim(adjustl(line_text(deck, line)))
    n = verify(text, '0123456789')
    if (n < 2) return
    if (text(n:n) == ' ') call replace_line(deck, line, text(:n - 1)//','//adjustl(text(n:)))
  end subroutine part_words

  !> Numbers and names of result files are those of one case.
  subroutine compare_cases(deck, cases)
    type(deck_t), intent(inout) :: deck
    type(case_t), intent(in) :: cases(:)
    integer :: i, k

    do i = 2, size(cases)
      if (cases(i)%id < 1) cycle ! told already
      do k = 1, i - 1
        if (cases(k)%id < 1) cycle
        if (cases(k)%id == cases(i)%id) then
          call line_error(deck, cases(i)%line, 'case '//to_text(cases(i)%id)//' is on line ' &
            //to_text(deck%number(cases(k)%line))//' already')
          exit
        else if (upper_case(cases(k)%job) == upper_case(cases(i)%job)) then
          call line_error(deck, cases(i)%line, 'the results of case '//to_text(cases(i)%id) &
            //' would take the place of those of case '//to_text(cases(k)%id)//': both have the ' &
            //'name "'//cases(i)%job//'"')
          exit
        end if
      end do
    end do
  end subroutine compare_cases

  !> Subcases that no case names are never read.
  subroutine look_for_names(deck, cases)
    type(deck_t), intent(inout) :: deck
    type(case_t), intent(in) :: cases(:)
    integer :: i, k
    logical :: is_named

    do i = 1, size(deck%cases%all)
      is_named = .false.
      do k = 1, size(cases)
        is_named = is_named .or. any(cases(k)%sub_cases == deck%cases%all(i))
      end do
      if (.not. is_named) call line_warning(deck, deck%cases%places(i), 'subcase' &
        //to_text(deck%cases%all(i)), 'no *CASE names subcase '//to_text(deck%cases%all(i)) &
        //': its keywords are never read')
    end do
  end subroutine look_for_names

  !> The position of a case; 0: there is none.
  pure function find_case(cases, id) result(found)
    type(case_t), intent(in) :: cases(:)
    integer, intent(in) :: id
    integer :: found

    do found = size(cases), 1, -1
      if (cases(found)%id == id) return
    end do
  end function find_case

  !> `101 (NAME), 102 (NAME)`, for messages.
  pure function cases_text(cases) result(text)
    type(case_t), intent(in) :: cases(:)
    character(:), allocatable :: text
    integer, parameter :: most = 20
    integer :: i, n

    text = ''
    n = 0
    do i = 1, size(cases)
      if (cases(i)%id < 1) cycle ! what its card has is no number
      n = n + 1
      if (n > most) cycle
      if (n > 1) text = text//', '
      text = text//to_text(cases(i)%id)//' ('//cases(i)%job//')'
    end do
    if (n > most) text = text//' and '//to_text(n - most)//' more'
  end function cases_text

  !> What its run is asked for.
  subroutine visit_case(self, visitor)
    class(case_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%visit('job', self%job)
    call visitor%visit('commands', self%commands)
  end subroutine visit_case

end module deck_cases_m
