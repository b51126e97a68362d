! SPDX-License-Identifier: MIT
!> *MAT_ELASTIC and *MAT_PLASTIC_KINEMATIC, and what all materials have.
module deck_material_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use parts_m, only : material_t, law_elastic, law_plastic
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_parameter_table_m, only : parameters_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: read_elastic, read_plastic_kinematic, elastic_constants, append_material, &
    check_tangent_modulus, check_failure

  !> A strain at failure from here on means never.
  real(wp), parameter :: never = 1.0e19_wp

contains

  !> *MAT_ELASTIC.
  subroutine read_elastic(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, parameters, cursor, 1, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_elastic
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_elastic

  !> *MAT_PLASTIC_KINEMATIC.
  subroutine read_plastic_kinematic(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, rate
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, parameters, cursor, 1, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_plastic
    if (card%r(5) <= 0.0_wp) call report_field(deck, cursor, card, 5, &
      'is not a yield stress (more than 0)')
    call check_tangent_modulus(deck, cursor, card, 'is negative: softening is not part of this law')
    if (card%r(7) < 0.0_wp .or. card%r(7) > 1.0_wp) call report_field(deck, cursor, card, 7, &
      'is not between 0 (kinematic) and 1 (isotropic hardening)')
    material%yield = card%r(5)
    if (.not. any(card%bad)) material%hardening = card%r(3)*card%r(6)/(card%r(3) - card%r(6))
    material%beta = card%r(7)
    call next_card(deck, parameters, cursor, 2, rate)
    call check_failure(deck, cursor, rate, 3)
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_plastic_kinematic

  !> ETAN in field 6, with E in field 3.
  subroutine check_tangent_modulus(deck, cursor, card, negative)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: negative    !! what to say of one below 0

    if (card%r(6) < 0.0_wp) then
      call report_field(deck, cursor, card, 6, negative)
    else if (card%r(6) >= card%r(3) .and. .not. card%bad(3)) then
      call report_field(deck, cursor, card, 6, 'is not below E: the tangent modulus of the ' &
        //'uniaxial stress-strain curve must be')
    end if
  end subroutine check_tangent_modulus

  !> A plastic strain at failure in field `k`.
  subroutine check_failure(deck, cursor, card, k)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k

    if (abs(card%r(k)) > 0.0_wp .and. card%r(k) < never) call report_field(deck, cursor, card, k, &
      'asks for failure at a plastic strain, which this version does not have; leave it 0')
  end subroutine check_failure

  !> MID, RO, E, PR in the first four fields, and what follows from them.
  subroutine elastic_constants(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material

    if (card%i(1) < 1) call report_field(deck, cursor, card, 1, 'is not a number of 1 or more')
    if (card%r(2) <= 0.0_wp) call report_field(deck, cursor, card, 2, &
      'is not a density (more than 0)')
    if (card%r(3) <= 0.0_wp) call report_field(deck, cursor, card, 3, &
      'is not a Young''s modulus (more than 0)')
    if (card%r(4) <= -1.0_wp .or. card%r(4) >= 0.5_wp) call report_field(deck, cursor, card, 4, &
      'is not a Poisson''s ratio (more than -1 and less than 0.5)')
    material%id = card%i(1)
    material%density = card%r(2)
    material%young = card%r(3)
    material%poisson = card%r(4)
    if (any(card%bad(2:4))) return
    if (card%r(3) > 1.0e30_wp .or. card%r(3) < 1.0e-30_wp .or. card%r(2) > 1.0e30_wp &
      .or. card%r(2) < 1.0e-30_wp) then
      call report_field(deck, cursor, card, 3, &
        'with RO "'//to_text(card%r(2))//'" is out of reach (1e-30 to 1e30)')
      return
    end if
    material%bulk = card%r(3)/(3.0_wp*(1.0_wp - 2.0_wp*card%r(4)))
    material%shear = card%r(3)/(2.0_wp*(1.0_wp + card%r(4)))
    material%sound_speed = sqrt((material%bulk + 4.0_wp*material%shear/3.0_wp)/card%r(2))
  end subroutine elastic_constants

  !> One more material.
  subroutine append_material(raw, material, card)
    type(raw_t), intent(inout) :: raw
    type(material_t), intent(in) :: material
    type(card_t), intent(in) :: card

    if (card%bad(1)) raw%lost%materials = .true.
    if (card%bad(1)) return
    raw%materials = [raw%materials, material]
    raw%material_line = [raw%material_line, card%line]
  end subroutine append_material

end module deck_material_m
