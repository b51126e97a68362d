! SPDX-License-Identifier: MIT
!> *MAT_NULL.
module deck_null_m
  use kinds_m, only : wp
  use parts_m, only : material_t, law_null
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of
  use deck_checks_m, only : require_id, refuse_negative, refuse_large
  use deck_material_m, only : append_material, take_cutoff
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: read_null

contains

  !> A fluid: its pressure comes from an equation of state.
  subroutine read_null(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call require_id(deck, cursor, card, 'MID')
    if (real_of(card, 'RO') <= 0.0_wp .or. real_of(card, 'RO') > 1.0e30_wp) call report_field( &
      deck, cursor, card, 'RO', 'is not a density (more than 0, up to 1e30)')
    call refuse_negative(deck, cursor, card, 'MU')
    call refuse_large(deck, cursor, card, 'MU', 1.0e30_wp)
    material%law = law_null
    material%takes_eos = .true.
    material%needs_eos = .true.
    material%id = integer_of(card, 'MID')
    material%density = real_of(card, 'RO')
    material%viscosity = real_of(card, 'MU')
    call take_cutoff(deck, cursor, card, material)
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_null

end module deck_null_m
