! SPDX-License-Identifier: MIT
!> Reads the cards of a block: cards in order, rows of a table, text lines; replaces parameters and
!> reports fields without effect or support.
module deck_cards_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use text_m, only : read_integer, read_real, number_good
  use deck_lines_m, only : deck_t, location_t, line_text, line_error, line_warning, replace_line, &
    flag_blank, flag_comma, flag_parameter, block_of_line, given_by, format_long, max_field
  use deck_offsets_m, only : move_card, move_heading
  use deck_fields_m, only : card_spec_t, make_spec, field_number, card_t, begin_card, cut_card, &
    cut_text, read_numbers, field_text, field_error
  use deck_schema_m, only : table, keyword_cards, refusal_reason, expectations, &
    text_of_field, max_card
  use deck_parameter_table_m, only : look_up
  implicit none
  private
  public :: cursor_t, open_cursor, first_card, skip_title, next_card, next_row, next_of, &
    next_text, next_heading, check_heading, check_rest, report_field, row_comes, reject_field, &
    warn_of_field

  !> Position of the reader in a block.
  type :: cursor_t
    integer :: block = 0
    integer :: source = 0
    integer :: line = 1           !! next line
    integer :: last = 0           !! last line of the block
    integer :: n_card = 0         !! number of cards of the keyword
    character(60) :: options = '' !! of the keyword (`deck_schema_m`)
    type(card_spec_t) :: specs(max_card)
  end type cursor_t

  !> Report an error of a field of a card just read, by its name or its position.
  interface report_field
    module procedure report_name, report_number
  end interface report_field

contains

  !> Move to the first data line of a block.
  subroutine open_cursor(deck, i_block, cursor)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: i_block
    type(cursor_t), intent(out) :: cursor
    integer :: k, row

    cursor%block = i_block
    cursor%source = deck%blocks(i_block)%source
    cursor%line = deck%blocks(i_block)%first
    cursor%last = deck%blocks(i_block)%last
    call keyword_cards(deck%blocks(i_block)%name, row, cursor%n_card, cursor%options)
    do k = 1, cursor%n_card
      call make_spec(table(row + k), k, deck%blocks(i_block)%layout, cursor%specs(k))
      cursor%specs(k)%row = row + k
    end do
  end subroutine open_cursor

  !> Read card 1 of a block, after its title.
  subroutine first_card(deck, i_block, cursor, card)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(cursor_t), intent(out) :: cursor
    type(card_t), intent(out) :: card

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
  end subroutine first_card

  !> Read the next line, blank or not, as card `number`; all defaults after the end of the block.
  subroutine next_card(deck, cursor, number, card)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    integer, intent(in) :: number
    type(card_t), intent(out) :: card

    if (cursor%line > cursor%last) then
      call begin_card(cursor%specs(number), deck%blocks(cursor%block)%keyword, card)
      call read_numbers(deck, cursor%specs(number), cursor%source, card)
      return
    end if
    call read_line(deck, cursor, number, card)
  end subroutine next_card

  !> Read the next non-blank line as card `number`; false at the end of the block.
  function next_row(deck, cursor, number, card) result(found)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    integer, intent(in) :: number
    type(card_t), intent(inout) :: card
    logical :: found

    found = row_comes(deck, cursor)
    if (found) call read_line(deck, cursor, number, card)
  end function next_row

  !> Read the next non-blank row, as card 1, of all keywords that begin with `head`; false after the
  !> last row of the last keyword.
  function next_of(deck, head, cursor, card) result(found)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: head
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(inout) :: card
    logical :: found
    integer :: i

    found = next_row(deck, cursor, 1, card)
    i = cursor%block
    do while (.not. found .and. i < deck%n_block)
      i = i + 1
      if (.not. deck%blocks(i)%is_honoured) cycle
      if (deck%blocks(i)%name(:len(head)) /= head) cycle
      call open_cursor(deck, i, cursor)
      call skip_title(deck, cursor)
      found = next_row(deck, cursor, 1, card)
    end do
  end function next_of

  !> Move past blank lines; false at the end of the block.
  function row_comes(deck, cursor) result(found)
    type(deck_t), intent(in) :: deck
    type(cursor_t), intent(inout) :: cursor
    logical :: found

    do while (cursor%line <= cursor%last)
      if (iand(deck%flags(cursor%line), flag_blank) == 0) exit
      cursor%line = cursor%line + 1
    end do
    found = cursor%line <= cursor%last
  end function row_comes

  !> Read the next line as plain text.
  subroutine next_text(deck, cursor, text)
    type(deck_t), intent(in) :: deck
    type(cursor_t), intent(inout) :: cursor
    character(:), allocatable, intent(out) :: text

    text = ''
    if (cursor%line > cursor%last) return
    text = trim(line_text(deck, cursor%line))
    cursor%line = cursor%line + 1
  end subroutine next_text

  !> Read a title line with an optional number in columns 1 to 10 (0: none), then a name. In the
  !> long layout the number has 20 columns; a number in the first ten is accepted there too.
  subroutine next_heading(deck, cursor, number, name)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    integer, intent(out) :: number
    character(:), allocatable, intent(out) :: name
    character(:), allocatable :: text
    integer :: width, status

    if (deck%sources(cursor%source)%is_moved .and. cursor%line <= cursor%last) call move_heading( &
      deck, cursor%block, cursor%line)
    call next_text(deck, cursor, text)
    do width = merge(20, 10, deck%blocks(cursor%block)%layout == format_long), 10, -10
      name = trim(adjustl(text(min(width, len(text)) + 1:)))
      call read_integer(text(:min(width, len(text))), number, status)
      if (status == number_good .and. number > 0) return
    end do
    number = 0
    name = trim(adjustl(text))
  end subroutine next_heading

  !> Move past the title line of a keyword with a title.
  subroutine skip_title(deck, cursor)
    type(deck_t), intent(in) :: deck
    type(cursor_t), intent(inout) :: cursor

    if (deck%blocks(cursor%block)%titled .and. cursor%line <= cursor%last) &
      cursor%line = cursor%line + 1
  end subroutine skip_title

  !> Report a heading without _TITLE or _ID, or one of these without a heading, and read the block
  !> as meant: one error instead of those of its cards.
  subroutine check_heading(deck, i_block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: numbers(2), texts(2)
    logical :: is_card(2)
    integer :: k

    call open_cursor(deck, i_block, cursor)
    if (index(cursor%options, 't') == 0 .or. cursor%specs(1)%kinds(1) == 'a') return
    is_card = .false.
    numbers = 0
    texts = 0
    do k = 1, min(2, cursor%last - cursor%line + 1)
      if (iand(deck%flags(cursor%line + k - 1), flag_parameter) /= 0) return
      call begin_card(cursor%specs(1), cursor%line + k - 1, card)
      call count_fields(line_text(deck, cursor%line + k - 1), cursor%specs(1), &
        iand(deck%flags(cursor%line + k - 1), flag_comma) /= 0, card, numbers(k), texts(k), &
        is_card(k))
    end do
    associate (block => deck%blocks(i_block))
      if (.not. block%titled .and. texts(1) > 0 .and. numbers(1) == 0 .and. is_card(2)) then
        call line_error(deck, cursor%line, 'looks like a heading, which needs _TITLE or _ID ' &
          //'behind the keyword')
        block%titled = .true.
      else if (block%titled .and. is_card(1) .and. .not. is_card(2) .and. (numbers(1) > 0 &
        .or. index(block%given, '_TITLE') > 0)) then
        call line_error(deck, cursor%line, 'looks like card 1, but _TITLE and _ID of the keyword ' &
          //'need a line with a heading before it')
        block%titled = .false.
      end if
    end associate
  end subroutine check_heading

  !> Count the numbers behind the first field of a line and the texts in fields of numbers. A first
  !> card has no such texts and begins with a whole number other than 0.
  pure subroutine count_fields(text, spec, comma, card, n_number, n_text, is_card)
    character(*), intent(in) :: text
    type(card_spec_t), intent(in) :: spec
    logical, intent(in) :: comma
    type(card_t), intent(inout) :: card
    integer, intent(out) :: n_number, n_text
    logical, intent(out) :: is_card
    integer :: k, rest, whole, status
    real(wp) :: value

    call cut_text(text, spec, comma, card, rest)
    n_number = 0
    n_text = 0
    whole = 0
    do k = 1, spec%n
      if (card%blank(k) .or. spec%kinds(k) == 'a') cycle
      call read_real(text(card%first(k):card%last(k)), value, status)
      if (status /= number_good) n_text = n_text + 1
      if (status == number_good .and. k > 1) n_number = n_number + 1
    end do
    if (.not. card%blank(1)) call read_integer(text(card%first(1):card%last(1)), whole, status)
    is_card = n_text == 0 .and. whole /= 0
  end subroutine count_fields

  !> Read the next line as card `number`, with parameters replaced.
  subroutine read_line(deck, cursor, number, card)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    integer, intent(in) :: number
    type(card_t), intent(inout) :: card
    character(:), allocatable :: text
    logical :: bad(max_field)
    integer :: k

    associate (spec => cursor%specs(number))
      call cut_card(deck, spec, cursor%source, cursor%line, card)
      if (iand(deck%flags(cursor%line), flag_parameter) /= 0) then
        call substitute(deck, spec, cursor%source, card, text)
        call replace_line(deck, cursor%line, text)
        bad = card%bad
        call cut_card(deck, spec, cursor%source, cursor%line, card)
        card%bad = bad
      end if
      if (deck%sources(cursor%source)%is_moved) call move_card(deck, spec, &
        trim(deck%blocks(cursor%block)%name), cursor%source, card)
      call read_numbers(deck, spec, cursor%source, card)
      do k = 1, spec%n
        if (spec%treatments(k) == 'h' .or. card%blank(k)) cycle
        if (spec%treatments(k) /= 's') call notice_field(deck, spec, card, k)
      end do
    end associate
    cursor%line = cursor%line + 1
  end subroutine read_line

  !> The line of a card with its parameters replaced, in free format.
  subroutine substitute(deck, spec, source, card, text)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    integer, intent(in) :: source
    type(card_t), intent(inout) :: card
    character(:), allocatable, intent(out) :: text
    character(:), allocatable :: field, value
    integer :: k, last

    last = findloc(card%blank(:spec%n), .false., 1, back=.true.)
    text = ''
    do k = 1, last
      field = field_text(deck, card, k)
      if (index(field, '&') == 1 .or. index(field, '-&') == 1 .or. index(field, '+&') == 1) then
        if (index(field, '&(') == 0) then
          call look_up(deck%parameters, field, source, value)
          if (len(value) == 0 .and. .not. deck%incomplete) call field_error(deck, card, k, &
            'is not defined by any *PARAMETER')
          field = value
        end if
      end if
      text = text//field
      if (k < last .or. last == 1) text = text//','
    end do
  end subroutine substitute

  !> Report a field that is not honoured and neither 0 nor its default.
  subroutine notice_field(deck, spec, card, k)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    character(:), allocatable :: name, effect

    if (card%bad(k)) return
    if (index('if', spec%kinds(k)) > 0 .and. (.not. abs(card%r(k)) > 0.0_wp &
      .or. .not. abs(card%r(k) - spec%defaults(k)) > 0.0_wp)) return
    name = trim(deck%blocks(block_of_line(deck, card%line))%name)
    if (spec%treatments(k) == 'r') then
      call field_error(deck, card, k, refusal_reason(trim(spec%names(k))))
    else
      effect = text_of_field(expectations, name, trim(spec%names(k)))
      if (index(effect, ':') /= 1) effect = ''
      call line_warning(deck, card%line, 'field '//name//' '//spec%names(k)//to_text(spec%number), &
        'card '//to_text(spec%number)//' field '//to_text(k)//' ('//trim(spec%names(k))//'): "' &
        //field_text(deck, card, k)//'" has no effect here'//effect)
    end if
  end subroutine notice_field

  !> Warn of lines after the last card of a keyword.
  subroutine check_rest(deck, cursor)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor

    if (row_comes(deck, cursor)) call line_warning(deck, cursor%line, 'rest' &
      //to_text(cursor%line), 'lines from here to the next keyword are ignored: the keyword has ' &
      //'no further cards')
  end subroutine check_rest

  !> Report an error of a field by its name.
  subroutine report_name(deck, card, name, message)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    character(*), intent(in) :: message

    call report_field(deck, card, field_number(card%names, name), message)
  end subroutine report_name

  !> Report an error of field `k`.
  subroutine report_number(deck, card, k, message)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    character(*), intent(in) :: message

    if (.not. card%bad(k)) call field_error(deck, card, k, message)
  end subroutine report_number

  !> Report an error of a field of a card that was read before, by its location.
  subroutine reject_field(deck, location, message)
    type(deck_t), intent(inout) :: deck
    type(location_t), intent(in) :: location
    character(*), intent(in) :: message
    type(card_t) :: card
    integer :: k

    call reread_card(deck, location, card, k)
    call field_error(deck, card, k, message)
  end subroutine reject_field

  !> Warn of a field of a card that was read before, by its location; equal warnings of fields of
  !> one name are reported once.
  subroutine warn_of_field(deck, location, message)
    type(deck_t), intent(inout) :: deck
    type(location_t), intent(in) :: location
    character(*), intent(in) :: message
    character(:), allocatable :: text
    type(card_t) :: card
    integer :: k

    call reread_card(deck, location, card, k)
    text = given_by(deck, location%line, k)//' '
    if (len(text) == 1) text = 'card '//to_text(card%number)//' field '//to_text(k)//' (' &
      //trim(card%names(k))//'): "'//field_text(deck, card, k)//'" '
    call line_warning(deck, merge(location%line, 0, text(1:1) == 'c'), &
      'field '//trim(card%names(k))//message, text//message)
  end subroutine warn_of_field

  !> Read the card of a location again, with the position of the field.
  subroutine reread_card(deck, location, card, k)
    type(deck_t), intent(inout) :: deck
    type(location_t), intent(in) :: location
    type(card_t), intent(out) :: card
    integer, intent(out) :: k
    type(cursor_t) :: cursor

    call open_cursor(deck, block_of_line(deck, location%line), cursor)
    call cut_card(deck, cursor%specs(location%card), cursor%source, location%line, card)
    k = location%field
    if (len_trim(location%name) > 0) k = field_number(card%names, location%name)
  end subroutine reread_card

end module deck_cards_m
