! SPDX-License-Identifier: MIT
!> *MAT_CRUSHABLE_FOAM.
module deck_foam_m
  use kinds_m, only : wp
  use eos_m, only : eos_t, eos_by_law
  use parts_m, only : material_t, law_crushable_foam
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of, is_bad, place_of
  use deck_checks_m, only : refuse_negative
  use deck_material_m, only : elastic_constants, append_material
  use deck_raw_m, only : raw_t, raw_foam_t
  implicit none
  private
  public :: read_crushable_foam

contains

  !> Elastic up to a curve, which is resolved later, and to TSC in tension.
  subroutine read_crushable_foam(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(material_t) :: material
    type(raw_foam_t) :: foam

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call elastic_constants(deck, cursor, card, material)
    if (integer_of(card, 'LCID') < 1) call report_field(deck, cursor, card, 'LCID', &
      'is not the number of a curve: yield stress against volumetric strain 1 - V')
    call refuse_negative(deck, cursor, card, 'TSC')
    material%law = law_crushable_foam
    material%tension = real_of(card, 'TSC')
    if (material%bulk > 0.0_wp) material%eos = eos_t(kind=eos_by_law, stiffness=material%bulk)
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
    if (is_bad(card, 'MID') .or. is_bad(card, 'LCID')) return
    foam%material = raw%n_material
    foam%curve = integer_of(card, 'LCID')
    foam%place = place_of(card, 'LCID')
    raw%n_foam = raw%n_foam + 1
    raw%foams(raw%n_foam) = foam
  end subroutine read_crushable_foam

end module deck_foam_m
