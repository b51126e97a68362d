! SPDX-License-Identifier: MIT
!> *DATABASE_ cards: what is written and how often; *CONTACT_2D_FORCE_TRANSDUCER: a surface on which
!> the forces of interfaces are added up.
module deck_output_m
  use kinds_m, only : wp
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, &
    check_rest, report_field
  use deck_values_m, only : integer_of, real_of, place_of, is_bad
  use deck_raw_m, only : raw_t, history_t, output_plot, raw_contact_t
  use history_tables_m, only : table_of_keyword
  implicit none
  private
  public :: read_database, read_transducer, settle_number

contains

  !> One *DATABASE_ keyword with an interval.
  subroutine read_database(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, rest
    type(history_t) :: history
    character(4) :: curve
    integer :: file, k

    call open_cursor(deck, i_block, cursor)
    call next_card(deck, cursor, 1, card)
    do k = 2, cursor%n_card
      call next_card(deck, cursor, k, rest)
    end do
    call check_rest(deck, cursor)
    select case (deck%blocks(i_block)%name)
    case ('DATABASE_BINARY_D3PLOT')
      file = output_plot
    case ('DATABASE_BINARY_D3DUMP')
      call take_cycles(deck, cursor, card, raw%controls%output%dump_cycles)
      return
    case ('DATABASE_BINARY_RUNRSF')
      call take_cycles(deck, cursor, card, raw%controls%output%running_cycles)
      return
    case default
      file = table_of_keyword(deck%blocks(i_block)%name)
    end select
    curve = merge('LCDT', 'LCUR', file == output_plot)
    history%dt = real_of(card, 'DT')
    history%curve = integer_of(card, curve)
    history%place = place_of(card, curve)
    if (file == output_plot) then
      history%n_state = max(integer_of(card, 'NPLTC'), 0)
    else
      history%is_text = integer_of(card, 'BINARY') /= 2
      history%is_binout = integer_of(card, 'BINARY') >= 2
    end if
    raw%outputs(file) = history
  end subroutine read_database

  !> Cycles between two restart files.
  subroutine take_cycles(deck, cursor, card, cycles)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(out) :: cycles

    real(wp) :: given

    cycles = 0
    given = real_of(card, 'CYCL')
    if (is_bad(card, 'CYCL')) return
    if (abs(given - anint(given)) > 0.0_wp) then
      call report_field(deck, cursor, card, 'CYCL', 'is not a whole number of cycles')
    else
      cycles = nint(given)
    end if
  end subroutine take_cycles

  !> One transducer.
  subroutine read_transducer(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: cards(2)
    type(raw_contact_t) :: entry
    integer :: k

    call open_cursor(deck, i_block, cursor)
    entry%contact%title = ''
    if (deck%blocks(i_block)%titled) call next_heading(deck, cursor, entry%contact%id, &
      entry%contact%title)
    entry%block = i_block
    call settle_number(raw, entry)
    do k = 1, size(cards)
      call next_card(deck, cursor, k, cards(k))
    end do
    call check_rest(deck, cursor)
    if (integer_of(cards(1), 'SURFA') == 0) call report_field(deck, cursor, cards(1), 'SURFA', &
      'is not a surface (more than 0: part set, less than 0: node set)')
    entry%places(1) = place_of(cards(1), 'SURFA')
    if (.not. is_bad(cards(1), 'SURFA')) entry%sides(1) = integer_of(cards(1), 'SURFA')
    raw%n_transducer = raw%n_transducer + 1
    raw%transducers(raw%n_transducer) = entry
  end subroutine read_transducer

  !> The number of an interface or transducer: its own, or its position in the deck.
  pure subroutine settle_number(raw, entry)
    type(raw_t), intent(in) :: raw
    type(raw_contact_t), intent(inout) :: entry

    if (entry%contact%id == 0) entry%contact%id = raw%n_contact + raw%n_transducer + 1
  end subroutine settle_number

end module deck_output_m
