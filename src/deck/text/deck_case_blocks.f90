! SPDX-License-Identifier: MIT
!> Keywords that belong to subcases: those between *CASE_BEGIN_n and *CASE_END_n, and those with
!> CID=n behind their name. While a deck is cut, those of subcases that are not read become
!> comments, so that the files that they include are not read either.
module deck_case_blocks_m
  use deck_lines_m, only : deck_t, case_blocks_t, line_error
  use log_m, only : to_text
  use text_m, only : upper_case, read_integer, number_good
  implicit none
  private
  public :: start_cases, follow_cases, end_cases

contains

  !> Before the first line.
  pure subroutine start_cases(cases, sub_cases)
    type(case_blocks_t), intent(inout) :: cases
    integer, intent(in), optional :: sub_cases(:) !! that are read; absent: none

    allocate (cases%open(0), cases%begun(0), cases%all(0), cases%places(0))
    if (present(sub_cases)) then
      cases%read = sub_cases
    else
      allocate (cases%read(0))
    end if
  end subroutine start_cases

  !> The last block has just been opened: of subcases that are not read it is a comment. A keyword
  !> between the marks of several subcases belongs to each of them.
  subroutine follow_cases(deck)
    type(deck_t), intent(inout) :: deck
    integer :: cid

    cid = 0
    associate (block => deck%blocks(deck%n_block), cases => deck%cases)
      if (block%name == 'CASE' .or. block%name(:5) == 'CASE_') then
        call follow_mark(deck)
        return
      else if (index(block%rest, '=') > 0 .and. block%name /= 'KEYWORD') then
        call take_option(deck, cid)
      end if
      if ((size(cases%open) == 0 .and. cid == 0) .or. block%name == 'END') return
      if (is_among(cases%read, cid) .or. any_among(cases%open, cases%read)) return
      block%name = 'COMMENT'
    end associate
  end subroutine follow_cases

  !> Whether a list has some member of another.
  pure function any_among(list, other) result(yes)
    integer, intent(in) :: list(:), other(:)
    logical :: yes
    integer :: i

    yes = .false.
    do i = 1, size(list)
      yes = yes .or. is_among(other, list(i))
    end do
  end function any_among

  !> Whether a list has a number.
  pure function is_among(list, number) result(yes)
    integer, intent(in) :: list(:)
    integer, intent(in) :: number
    logical :: yes

    yes = any(list == number)
  end function is_among

  !> CID=n behind the name of a keyword.
  subroutine take_option(deck, cid)
    type(deck_t), intent(inout) :: deck
    integer, intent(out) :: cid !! 0: there is none
    character(:), allocatable :: rest
    integer :: at, n, status

    cid = 0
    rest = ' '//upper_case(deck%blocks(deck%n_block)%rest)
    at = index(rest, ' CID=')
    if (at == 0) return
    rest = rest(at + 5:)
    n = scan(rest, ' ') - 1
    call read_number(rest(:n), cid, status)
    if (status /= number_good) then
      call refuse(deck, deck%n_line, 'CID="'//rest(:n) &
        //'": expected the number of a subcase, 1 or more')
      return
    end if
    if (is_inside(deck)) return
    deck%cases%found = .true.
    call note_sub_case(deck, cid)
  end subroutine take_option

  !> *CASE, *CASE_BEGIN_n or *CASE_END_n; other names are told later.
  subroutine follow_mark(deck)
    type(deck_t), intent(inout) :: deck
    integer, parameter :: n_begin = len('CASE_BEGIN_'), n_end = len('CASE_END_')

    associate (name => deck%blocks(deck%n_block)%name)
      if (name /= 'CASE' .and. index(name, 'CASE_BEGIN') /= 1 .and. index(name, 'CASE_END') /= 1) &
        return
      if (is_inside(deck)) return
      deck%cases%found = .true.
      if (name == 'CASE') then
        if (size(deck%cases%open) > 0) call refuse(deck, deck%n_line, &
          'is inside of '//open_text(deck)//': expected outside of all subcases')
      else if (index(name, 'CASE_BEGIN') == 1) then
        call begin_sub_case(deck, trim(name(n_begin + 1:)))
      else
        call end_sub_case(deck, trim(name(n_end + 1:)))
      end if
    end associate
  end subroutine follow_mark

  !> Cases are told apart in the deck itself alone, as in LS-DYNA.
  function is_inside(deck) result(inside)
    type(deck_t), intent(inout) :: deck
    logical :: inside

    inside = deck%blocks(deck%n_block)%source /= 1
    if (inside) call refuse(deck, deck%n_line, 'cases stand in the deck itself, not in a file ' &
      //'that it includes')
  end function is_inside

  !> *CASE_BEGIN_n.
  subroutine begin_sub_case(deck, text)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: text !! n
    integer :: number, status, k

    call read_number(text, number, status)
    if (status /= number_good) then
      call refuse(deck, deck%n_line, 'expected *CASE_BEGIN_n with the number n of a subcase, ' &
        //'1 or more')
      return
    end if
    k = findloc(deck%cases%open, number, 1)
    if (k > 0) call refuse(deck, deck%n_line, 'subcase '//to_text(number)//' has begun on line ' &
      //to_text(deck%number(deck%cases%begun(k)))//' and has not ended')
    deck%cases%open = [deck%cases%open, number]
    deck%cases%begun = [deck%cases%begun, deck%n_line]
    call note_sub_case(deck, number)
  end subroutine begin_sub_case

  !> *CASE_END_n.
  subroutine end_sub_case(deck, text)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: text !! n
    integer :: number, status, k, n

    call read_number(text, number, status)
    if (status /= number_good) then
      call refuse(deck, deck%n_line, 'expected *CASE_END_n with the number n of a subcase, ' &
        //'1 or more')
      return
    end if
    associate (cases => deck%cases)
      n = size(cases%open)
      k = findloc(cases%open, number, 1, back=.true.)
      if (k == 0) then
        call refuse(deck, deck%n_line, 'subcase '//to_text(number)//' has not begun')
        return
      end if
      if (k < n) call refuse(deck, deck%n_line, 'ends before '//open_text(deck) &
        //', which begins inside of it')
      cases%open = [cases%open(:k - 1), cases%open(k + 1:)]
      cases%begun = [cases%begun(:k - 1), cases%begun(k + 1:)]
    end associate
  end subroutine end_sub_case

  !> The number of a subcase, in digits.
  pure subroutine read_number(text, number, status)
    character(*), intent(in) :: text
    integer, intent(out) :: number
    integer, intent(out) :: status

    number = 0
    status = number_good + 1
    if (len(text) == 0 .or. verify(text, '0123456789') > 0) return
    call read_integer(text, number, status)
    if (number < 1) status = number_good + 1
  end subroutine read_number

  !> The subcase that has begun last, for a message.
  pure function open_text(deck) result(text)
    type(deck_t), intent(in) :: deck
    character(:), allocatable :: text
    integer :: n

    n = size(deck%cases%open)
    text = '*CASE_BEGIN_'//to_text(deck%cases%open(n))//' (line ' &
      //to_text(deck%number(deck%cases%begun(n)))//')'
  end function open_text

  !> Keep that a subcase has keywords, and where the first one is.
  pure subroutine note_sub_case(deck, number)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: number

    if (is_among(deck%cases%all, number)) return
    deck%cases%all = [deck%cases%all, number]
    deck%cases%places = [deck%cases%places, deck%n_line]
  end subroutine note_sub_case

  !> Behind the last line: no subcase may be open.
  subroutine end_cases(deck)
    type(deck_t), intent(inout) :: deck
    integer :: i

    do i = 1, size(deck%cases%open)
      call refuse(deck, deck%cases%begun(i), 'has no *CASE_END_' &
        //to_text(deck%cases%open(i)))
    end do
  end subroutine end_cases

  !> An error of the marks.
  subroutine refuse(deck, line, message)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    character(*), intent(in) :: message

    deck%cases%wrong = .true.
    call line_error(deck, line, message)
  end subroutine refuse

end module deck_case_blocks_m
