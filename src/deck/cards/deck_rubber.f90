! SPDX-License-Identifier: MIT
!> *MAT_MOONEY-RIVLIN_RUBBER and *MAT_BLATZ-KO_RUBBER.
module deck_rubber_m
  use kinds_m, only : wp
  use eos_m, only : eos_t, eos_by_law
  use log_m, only : to_text
  use parts_m, only : material_t, law_mooney_rivlin, law_blatz_ko
  use rubbers_m, only : mooney_rivlin, blatz_ko, blatz_ko_poisson
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of
  use deck_checks_m, only : require_id, refuse_negative
  use deck_material_m, only : append_material, check_shear
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: read_mooney_rivlin, read_blatz_ko

contains

  !> *MAT_MOONEY-RIVLIN_RUBBER.
  subroutine read_mooney_rivlin(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, fit
    type(material_t) :: material
    real(wp) :: a, b, poisson

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call next_card(deck, cursor, 2, fit)
    call require_id(deck, cursor, card, 'MID')
    if (real_of(card, 'RO') <= 0.0_wp .or. real_of(card, 'RO') > 1.0e30_wp) call report_field( &
      deck, cursor, card, 'RO', 'is not a density (more than 0, up to 1e30)')
    poisson = real_of(card, 'PR')
    if (poisson <= 0.0_wp .or. poisson >= 0.5_wp) call report_field(deck, cursor, card, 'PR', &
      'is not a Poisson''s ratio of this law (more than 0 and less than 0.5; 0.49 and more is ' &
      //'usual)')
    a = real_of(card, 'A')
    b = real_of(card, 'B')
    call refuse_negative(deck, cursor, card, 'A')
    call refuse_negative(deck, cursor, card, 'B')
    if (.not. max(a, b) > 0.0_wp) call report_field(deck, cursor, card, 'A', &
      'is 0 as B is: 2 (A + B) is the shear modulus')
    if (max(a, b) > 1.0e30_wp) call report_field(deck, cursor, card, 'A', 'with B "'//to_text(b) &
      //'" is out of reach (1e30)')
    material%law = law_mooney_rivlin
    material%id = integer_of(card, 'MID')
    material%density = real_of(card, 'RO')
    if (.not. any(card%bad)) then
      material%rubber = mooney_rivlin(a, b, poisson)
      material%shear = 2.0_wp*(a + b)
      call settle_moduli(poisson, material)
    end if
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_mooney_rivlin

  !> *MAT_BLATZ-KO_RUBBER.
  subroutine read_blatz_ko(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call check_shear(deck, cursor, card, material)
    material%law = law_blatz_ko
    if (.not. any(card%bad)) then
      material%rubber = blatz_ko(material%shear)
      call settle_moduli(blatz_ko_poisson, material)
    end if
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_blatz_ko

  !> Moduli of small strain.
  pure subroutine settle_moduli(poisson, material)
    real(wp), intent(in) :: poisson
    type(material_t), intent(inout) :: material

    material%poisson = poisson
    material%young = 2.0_wp*material%shear*(1.0_wp + poisson)
    material%bulk = material%young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
    material%eos = eos_t(kind=eos_by_law, stiffness=material%bulk)
    material%sound_speed = sqrt((material%bulk + 4.0_wp*material%shear/3.0_wp)/material%density)
  end subroutine settle_moduli

end module deck_rubber_m
