! SPDX-License-Identifier: MIT
!> *DAMPING_PART_MASS: a card for each part or part set, with a second one where FLAG asks for it.
module deck_damping_m
  use kinds_m, only : wp
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_row, row_comes, check_rest, &
    report_field
  use deck_fields_m, only : card_t
  use deck_lines_m, only : deck_t, line_text
  use deck_raw_m, only : raw_t, row_t, append_row, row_damping_part, row_damping_part_set, id_fields
  use deck_values_m, only : integer_of, real_of, reals_of, refuse_outside
  implicit none
  private
  public :: read_part_damping

contains

  !> All rows of one keyword.
  subroutine read_part_damping(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    character(*), parameter :: feeds = &
      'is negative: forces that push along with the velocity would feed energy'
    type(cursor_t) :: cursor
    type(card_t) :: card, factors
    type(row_t) :: row
    logical :: found

    call open_cursor(deck, i_block, cursor)
    row%kind = merge(row_damping_part_set, row_damping_part, &
      deck%blocks(i_block)%name == 'DAMPING_PART_MASS_SET')
    do
      call next_row(deck, cursor, 1, card, found)
      if (.not. found) exit
      row%line = card%line
      row%id = integer_of(card, trim(id_fields(row%kind)))
      row%curve = integer_of(card, 'LCID')
      row%scale = real_of(card, 'SF')
      row%factor = 1.0_wp
      if (row%id < 1) call report_field(deck, cursor, card, trim(id_fields(row%kind)), &
        'is not a number of 1 or more')
      if (row%curve < 1) call report_field(deck, cursor, card, 'LCID', &
        'is not a curve number (1 or more); the curve gives the damping over time')
      if (row%scale < 0.0_wp) call report_field(deck, cursor, card, 'SF', feeds)
      call refuse_outside(deck, cursor, card, 'FLAG', 0, 1, &
        'is not 0 or 1 (a second card with factors of the directions)')
      if (integer_of(card, 'FLAG') == 1) then
        call next_card(deck, cursor, 2, factors)
        row%factor = reals_of(factors, 'STX', 'STY')
        if (row%factor(1) < 0.0_wp) call report_field(deck, cursor, factors, 'STX', feeds)
        if (row%factor(2) < 0.0_wp) call report_field(deck, cursor, factors, 'STY', feeds)
      else
        ! A second card of zeros, which common writers put where FLAG is 0 too, is no row: there is
        ! no part 0.
        call row_comes(deck, cursor, found)
        if (found) found = verify(line_text(deck, cursor%line), ' 0.,+-eEdD') == 0
        if (found) cursor%line = cursor%line + 1
      end if
      if (.not. any(card%bad)) call append_row(raw, row)
    end do
    call check_rest(deck, cursor)
  end subroutine read_part_damping

end module deck_damping_m
