! SPDX-License-Identifier: MIT
!> *MAT_JOHNSON_COOK and *MAT_SIMPLIFIED_JOHNSON_COOK.
module deck_johnson_cook_m
  use kinds_m, only : wp
  use johnson_cook_m, only : johnson_cook_t
  use parts_m, only : material_t, law_johnson_cook, law_hot_johnson_cook, spall_pressure, &
    spall_stress
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, place_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field, &
    warn_of_field
  use deck_values_m, only : real_of, reals_of
  use deck_checks_m, only : refuse_negative
  use deck_material_m, only : elastic_constants, append_material, check_shear, take_cutoff, &
    take_failure
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: read_johnson_cook, read_simplified_johnson_cook

  !> How far G may be off E/(2 (1 + PR)) without a word: decks give three digits.
  real(wp), parameter :: same_shear = 0.01_wp

contains

  !> *MAT_SIMPLIFIED_JOHNSON_COOK: neither heat nor damage.
  subroutine read_simplified_johnson_cook(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, stress
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_johnson_cook
    allocate (material%flow)
    call take_rate_form(deck, cursor, card, material%flow)
    call next_card(deck, cursor, 2, stress)
    call take_stress(deck, cursor, stress, material%flow)
    call take_bound(deck, cursor, stress, 'SIGMAX', material%flow%most_static)
    call take_bound(deck, cursor, stress, 'SIGSAT', material%flow%most)
    call take_failure(deck, cursor, stress, 'PSFAIL', material)
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_simplified_johnson_cook

  !> *MAT_JOHNSON_COOK.
  subroutine read_johnson_cook(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, stress, heat, damage
    type(material_t) :: material

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
    call check_shear(deck, cursor, card, material)
    call take_bulk(deck, cursor, card, material)
    material%law = law_hot_johnson_cook
    material%takes_eos = .true.
    allocate (material%flow)
    material%flow%has_memory = .true.
    call take_rate_form(deck, cursor, card, material%flow)
    call next_card(deck, cursor, 2, stress)
    call take_stress(deck, cursor, stress, material%flow)
    call next_card(deck, cursor, 3, heat)
    call take_heat(deck, cursor, stress, heat, material)
    call take_spall(deck, cursor, heat, material)
    call next_card(deck, cursor, 4, damage)
    material%flow%d = [reals_of(heat, 'D1', 'D4'), real_of(damage, 'D5')]
    ! Tension breaks sooner, whichever sign of pressure and D3 the deck has in mind.
    material%flow%d(3) = -abs(material%flow%d(3))
    material%flow%has_damage = any(abs(material%flow%d(1:2)) > 0.0_wp)
    material%flow%keeps_broken = abs(real_of(damage, 'EROD')) > 0.0_wp
    if (any(abs(material%flow%d) > 0.0_wp) .and. .not. material%flow%has_damage) call &
      report_field(deck, cursor, heat, 'D1', 'is 0 as D2 is: the strain at fracture would be 0')
    call refuse_negative(deck, cursor, damage, 'EFMIN')
    material%flow%least = max(real_of(damage, 'EFMIN'), tiny(1.0_wp))
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_johnson_cook

  !> E and PR, where no equation of state gives the pressure: K of K ln(J).
  subroutine take_bulk(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material

    call refuse_negative(deck, cursor, card, 'E')
    if (real_of(card, 'PR') <= -1.0_wp .or. real_of(card, 'PR') >= 0.5_wp) call report_field( &
      deck, cursor, card, 'PR', 'is not a Poisson''s ratio (more than -1 and less than 0.5)')
    material%needs_eos = .not. real_of(card, 'E') > 0.0_wp
    if (any(card%bad) .or. material%needs_eos) return
    associate (shear => real_of(card, 'E')/(2.0_wp*(1.0_wp + real_of(card, 'PR'))))
      if (abs(shear - material%shear) > same_shear*material%shear) call warn_of_field(deck, &
        place_t(card%line, 1, 'G'), 'is not E/(2 (1 + PR)) = '//to_text(shear)//': the deviator ' &
        //'goes with G; E and PR give the bulk modulus where there is no equation of state')
    end associate
    material%bulk = real_of(card, 'E')/(3.0_wp*(1.0_wp - 2.0_wp*real_of(card, 'PR')))
  end subroutine take_bulk

  !> Whose rate counts: 0 the total one, 1 that of the plastic strain.
  subroutine take_rate_form(deck, cursor, card, flow)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(johnson_cook_t), intent(inout) :: flow

    flow%is_viscoplastic = .not. abs(real_of(card, 'VP') - 1.0_wp) > 0.0_wp
    if (abs(real_of(card, 'VP')) > 0.0_wp .and. .not. flow%is_viscoplastic) call report_field( &
      deck, cursor, card, 'VP', 'is not a rate form: 0 counts the total strain rate, 1 that of ' &
      //'the plastic strain')
  end subroutine take_rate_form

  !> A, B, N, C and EPSO.
  subroutine take_stress(deck, cursor, card, flow)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(johnson_cook_t), intent(inout) :: flow

    if (.not. real_of(card, 'A') > 0.0_wp) call report_field(deck, cursor, card, 'A', &
      'is not a yield stress (more than 0)')
    call refuse_negative(deck, cursor, card, 'B')
    call refuse_negative(deck, cursor, card, 'N')
    call refuse_negative(deck, cursor, card, 'C')
    if (.not. real_of(card, 'EPSO') > 0.0_wp) call report_field(deck, cursor, card, 'EPSO', &
      'is not a strain rate (more than 0)')
    flow%a = real_of(card, 'A')
    flow%b = real_of(card, 'B')
    flow%n = real_of(card, 'N')
    flow%c = real_of(card, 'C')
    flow%rate = real_of(card, 'EPSO')
  end subroutine take_stress

  !> A bound on the flow stress; its default is none.
  subroutine take_bound(deck, cursor, card, name, bound)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    real(wp), intent(inout) :: bound

    if (real_of(card, name) < real_of(card, 'A')) then
      call report_field(deck, cursor, card, name, 'is below A: a bound on the flow stress is not')
    else
      bound = real_of(card, name)
    end if
  end subroutine take_bound

  !> CP with M, TM and TR: without a specific heat nothing warms.
  subroutine take_heat(deck, cursor, stress, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: stress, card
    type(material_t), intent(inout) :: material

    call refuse_negative(deck, cursor, card, 'CP')
    material%flow%room = real_of(stress, 'TR')
    if (.not. real_of(card, 'CP') > 0.0_wp) return
    if (.not. real_of(stress, 'M') > 0.0_wp) call report_field(deck, cursor, stress, 'M', &
      'is not an exponent (more than 0) beside a specific heat CP')
    if (.not. real_of(stress, 'TM') > real_of(stress, 'TR')) call report_field(deck, cursor, &
      stress, 'TM', 'is not above TR: it is the temperature of melting')
    if (any(stress%bad) .or. any(card%bad) .or. .not. material%density > 0.0_wp) return
    material%flow%m = real_of(stress, 'M')
    material%flow%span = real_of(stress, 'TM') - real_of(stress, 'TR')
    material%flow%heat = 1.0_wp/(material%density*real_of(card, 'CP'))
  end subroutine take_heat

  !> PC and what it means, SPALL 1, 2 or 3, which count from 1 as the constants do.
  subroutine take_spall(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material
    real(wp) :: kind

    call take_cutoff(deck, cursor, card, material)
    kind = real_of(card, 'SPALL')
    if (all(abs(kind - [1.0_wp, 2.0_wp, 3.0_wp]) > 0.0_wp)) call report_field(deck, cursor, card, &
      'SPALL', 'is not 1 (least pressure), 2 (largest stress) or 3 (largest tension)')
    material%spall = spall_pressure
    if (real_of(card, 'PC') < 0.0_wp) then
      material%spall = nint(kind)
    else if (abs(kind - spall_stress) > 0.0_wp) then
      call warn_of_field(deck, place_t(card%line, 3, 'SPALL'), 'has no effect: PC is 0, so that ' &
        //'nothing breaks by tension')
    end if
  end subroutine take_spall

end module deck_johnson_cook_m
