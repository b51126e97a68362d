! SPDX-License-Identifier: MIT
!> Edits fields and blocks of a deck before its cards are read. Edited lines are parsed and checked
!> like lines of a file, and are part of the effective deck.
module deck_edits_m
  use text_m, only : read_real, number_good
  use kinds_m, only : wp
  use deck_lines_m, only : deck_t, made_line_t, replace_line, flag_blank
  use deck_cards_m, only : cursor_t, open_cursor
  use deck_fields_m, only : card_spec_t, card_t, cut_card, field_text
  use deck_parameter_table_m, only : look_up
  use deck_reader_m, only : add_line, open_block
  implicit none
  private
  public :: given_number, set_field, rewrite_block, append_block

contains

  !> Value of a field of a keyword with one line for each card, parameters replaced; 0 where it is
  !> blank or not a number.
  subroutine given_number(deck, i_block, name, value)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    character(*), intent(in) :: name              !! of the field
    real(wp), intent(out) :: value
    type(card_spec_t) :: spec
    type(card_t) :: card
    character(:), allocatable :: text
    integer :: line, k, status

    value = 0.0_wp
    call find_field(deck, i_block, name, spec, line, k)
    if (k == 0 .or. line > deck%blocks(i_block)%last) return
    call cut_card(deck, spec, deck%blocks(i_block)%source, line, card)
    text = field_text(deck, card, k)
    if (index(text, '&') > 0) call look_up(deck%parameters, text, deck%blocks(i_block)%source, text)
    call read_real(text, value, status)
    if (status /= number_good) value = 0.0_wp
  end subroutine given_number

  !> Replace the text of a field of a keyword with one line for each card.
  subroutine set_field(deck, i_block, name, text, word)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    character(*), intent(in) :: name              !! of the field
    character(*), intent(in) :: text
    integer, intent(in), optional :: word         !! override that gives it
    type(card_spec_t) :: spec
    type(card_t) :: card
    character(:), allocatable :: new
    integer :: line, k, i, last

    call find_field(deck, i_block, name, spec, line, k)
    if (k == 0) return
    call make_lines(deck, i_block, line - deck%blocks(i_block)%first + 1)
    call find_field(deck, i_block, name, spec, line, k)
    call cut_card(deck, spec, deck%blocks(i_block)%source, line, card)
    last = max(k, findloc(card%blank(:spec%n), .false., 1, back=.true.))
    new = ''
    do i = 1, last
      if (i == k) then
        new = new//text//','
      else
        new = new//field_text(deck, card, i)//','
      end if
    end do
    call replace_line(deck, line, new)
    if (present(word)) deck%made(line - deck%n_written)%words(k) = word
  end subroutine set_field

  !> Card, line and position of a field; position 0: the keyword does not have the field.
  subroutine find_field(deck, i_block, name, spec, line, k)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: i_block
    character(*), intent(in) :: name
    type(card_spec_t), intent(out) :: spec
    integer, intent(out) :: line, k
    type(cursor_t) :: cursor
    integer :: number

    call open_cursor(deck, i_block, cursor)
    line = cursor%line - 1
    if (deck%blocks(i_block)%titled) line = line + 1
    do number = 1, cursor%n_card
      line = line + 1
      spec = cursor%specs(number)
      k = findloc(spec%names(:spec%n), name, 1)
      if (k > 0) return
    end do
    k = 0
  end subroutine find_field

  !> Replace the lines of a block by generated lines, at least `n_least`.
  subroutine make_lines(deck, i_block, n_least)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block, n_least
    integer :: first, i, n

    associate (block => deck%blocks(i_block))
      n = block%last - block%first + 1
      if (block%first > deck%n_written .and. n >= n_least) return
      first = deck%n_line + 1
      do i = block%first, block%last
        call append_line(deck, i_block, deck%number(i))
        deck%first(deck%n_line) = deck%first(i)
        deck%last(deck%n_line) = deck%last(i)
        deck%flags(deck%n_line) = deck%flags(i)
        if (i > deck%n_written) deck%made(deck%n_line - deck%n_written)%words = &
          deck%made(i - deck%n_written)%words
      end do
      do i = n + 1, n_least
        call append_line(deck, i_block, deck%number(max(block%last, block%keyword)))
      end do
      block%first = first
      block%last = deck%n_line
    end associate
  end subroutine make_lines

  !> Append a blank generated line.
  subroutine append_line(deck, i_block, number)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    integer, value :: number !! line number in messages; a copy, since the lists are reallocated
    integer :: n

    if (.not. allocated(deck%made)) then
      allocate (deck%made(64))
      deck%n_written = deck%n_line
    end if
    call add_line(deck, 1, 0, number, flag_blank)
    n = deck%n_line - deck%n_written
    if (n > size(deck%made)) deck%made = [deck%made, deck%made]
    deck%made(n) = made_line_t(block=i_block)
  end subroutine append_line

  !> Replace keyword and lines of a block.
  subroutine rewrite_block(deck, i_block, name, text)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    character(*), intent(in) :: name !! of the keyword, without options
    character(*), intent(in) :: text !! lines with line ends; first the title of a titled block
    integer :: start, next, number

    associate (block => deck%blocks(i_block))
      number = deck%number(block%keyword)
      block%name = name
      block%given = name//trim(merge('_TITLE', '      ', block%titled))
      block%first = deck%n_line + 1
      start = 1
      do while (start <= len(text))
        next = start + index(text(start:), new_line('a'))
        call append_line(deck, i_block, number)
        call replace_line(deck, deck%n_line, text(start:next - 2))
        start = next
      end do
      block%last = deck%n_line
    end associate
  end subroutine rewrite_block

  !> Append a keyword to the deck.
  subroutine append_block(deck, name, text)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: name, text        !! as in `rewrite_block`

    call append_line(deck, deck%n_block + 1, 0)
    call open_block(deck, 1, name)
    call rewrite_block(deck, deck%n_block, name, text)
    deck%blocks(deck%n_block)%is_honoured = .true.
  end subroutine append_block

end module deck_edits_m
