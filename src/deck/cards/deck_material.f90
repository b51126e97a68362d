! SPDX-License-Identifier: MIT
!> *MAT_ELASTIC and *MAT_PLASTIC_KINEMATIC, and what all materials have.
module deck_material_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use parts_m, only : material_t, law_elastic, law_plastic
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of, is_bad
  use deck_checks_m, only : require_id
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: read_elastic, read_plastic_kinematic, elastic_constants, append_material, &
    check_tangent_modulus, take_failure, take_cutoff, plastic_modulus, &
    check_shear

  !> A strain at failure from here on means never.
  real(wp), parameter :: never = 1.0e16_wp

contains

  !> *MAT_ELASTIC.
  subroutine read_elastic(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_elastic
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_elastic

  !> *MAT_PLASTIC_KINEMATIC.
  subroutine read_plastic_kinematic(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, rate
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_plastic
    if (real_of(card, 'SIGY') <= 0.0_wp) call report_field(deck, cursor, card, 'SIGY', &
      'is not a yield stress (more than 0)')
    call check_tangent_modulus(deck, cursor, card, 'is negative: softening is not part of this law')
    material%yield = real_of(card, 'SIGY')
    material%beta = real_of(card, 'BETA')
    if (material%beta < 0.0_wp .or. material%beta > 1.0_wp) call report_field(deck, cursor, card, &
      'BETA', 'is not between 0 (kinematic) and 1 (isotropic hardening)')
    if (.not. any(card%bad)) material%hardening = plastic_modulus(card)
    call next_card(deck, cursor, 2, rate)
    call take_failure(deck, cursor, rate, 'FS', material)
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_plastic_kinematic

  !> Slope of the yield stress over plastic strain from that of the uniaxial curve, ETAN beside E.
  function plastic_modulus(card) result(modulus)
    type(card_t), intent(in) :: card
    real(wp) :: modulus

    associate (young => real_of(card, 'E'), tangent => real_of(card, 'ETAN'))
      modulus = young*tangent/(young - tangent)
    end associate
  end function plastic_modulus

  !> ETAN beside E.
  subroutine check_tangent_modulus(deck, cursor, card, negative)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: negative    !! what to say of one below 0

    if (real_of(card, 'ETAN') < 0.0_wp) then
      call report_field(deck, cursor, card, 'ETAN', negative)
    else if (real_of(card, 'ETAN') >= real_of(card, 'E') .and. .not. is_bad(card, 'E')) then
      call report_field(deck, cursor, card, 'ETAN', 'is not below E: the tangent modulus of the ' &
        //'uniaxial stress-strain curve must be')
    end if
  end subroutine check_tangent_modulus

  !> A plastic strain at failure; 0 means never.
  subroutine take_failure(deck, cursor, card, name, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    type(material_t), intent(inout) :: material

    if (real_of(card, name) < 0.0_wp) call report_field(deck, cursor, card, name, &
      'is negative: a plastic strain at failure is above 0, and 0 means never')
    if (real_of(card, name) > 0.0_wp .and. real_of(card, name) < never) &
      material%failure_strain = real_of(card, name)
  end subroutine take_failure

  !> The cut-off PC of the pressure; 0 means none.
  subroutine take_cutoff(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material

    if (real_of(card, 'PC') > 0.0_wp) call report_field(deck, cursor, card, 'PC', &
      'is above 0: a cut-off is the least pressure, of tension (0 means none)')
    if (real_of(card, 'PC') < 0.0_wp) material%cutoff = real_of(card, 'PC')
  end subroutine take_cutoff

  !> MID, RO and a shear modulus, of laws that get their pressure elsewhere.
  subroutine check_shear(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material

    call require_id(deck, cursor, card, 'MID')
    if (real_of(card, 'RO') <= 0.0_wp) call report_field(deck, cursor, card, 'RO', &
      'is not a density (more than 0)')
    if (real_of(card, 'G') <= 0.0_wp) call report_field(deck, cursor, card, 'G', &
      'is not a shear modulus (more than 0)')
    if (max(real_of(card, 'G'), real_of(card, 'RO')) > 1.0e30_wp) call report_field(deck, cursor, &
      card, 'G', 'with RO "'//to_text(real_of(card, 'RO'))//'" is out of reach (1e30)')
    material%id = integer_of(card, 'MID')
    material%density = real_of(card, 'RO')
    material%shear = real_of(card, 'G')
  end subroutine check_shear

  !> MID, RO, E, PR, which all materials have, and what follows from them.
  subroutine elastic_constants(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material

    call require_id(deck, cursor, card, 'MID')
    if (real_of(card, 'RO') <= 0.0_wp) call report_field(deck, cursor, card, 'RO', &
      'is not a density (more than 0)')
    if (real_of(card, 'E') <= 0.0_wp) call report_field(deck, cursor, card, 'E', &
      'is not a Young''s modulus (more than 0)')
    if (real_of(card, 'PR') <= -1.0_wp .or. real_of(card, 'PR') >= 0.5_wp) call report_field( &
      deck, cursor, card, 'PR', 'is not a Poisson''s ratio (more than -1 and less than 0.5)')
    material%id = integer_of(card, 'MID')
    material%density = real_of(card, 'RO')
    material%young = real_of(card, 'E')
    material%poisson = real_of(card, 'PR')
    if (is_bad(card, 'RO') .or. is_bad(card, 'E') .or. is_bad(card, 'PR')) return
    associate (young => material%young, poisson => material%poisson, density => material%density)
      if (max(young, density) > 1.0e30_wp .or. min(young, density) < 1.0e-30_wp) then
        call report_field(deck, cursor, card, 'E', &
          'with RO "'//to_text(density)//'" is out of reach (1e-30 to 1e30)')
        return
      end if
      material%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
      material%shear = young/(2.0_wp*(1.0_wp + poisson))
      material%sound_speed = sqrt((material%bulk + 4.0_wp*material%shear/3.0_wp)/density)
    end associate
  end subroutine elastic_constants

  !> One more material.
  subroutine append_material(raw, material, card)
    type(raw_t), intent(inout) :: raw
    type(material_t), intent(in) :: material
    type(card_t), intent(in) :: card

    if (is_bad(card, 'MID')) raw%lost%materials = .true.
    if (is_bad(card, 'MID')) return
    raw%n_material = raw%n_material + 1
    raw%materials(raw%n_material) = material
    raw%material_line(raw%n_material) = card%line
  end subroutine append_material

end module deck_material_m
