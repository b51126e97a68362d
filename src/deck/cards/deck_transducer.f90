! SPDX-License-Identifier: MIT
!> *CONTACT_2D_FORCE_TRANSDUCER: a surface on which the forces of interfaces are added up.
module deck_transducer_m
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, check_rest, report_field
  use deck_values_m, only : integer_of, is_bad, place_of
  use deck_raw_m, only : raw_t, raw_contact_t
  implicit none
  private
  public :: read_transducer, settle_number

contains

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

end module deck_transducer_m
