! SPDX-License-Identifier: MIT
!> Laws of Johnson and Cook (*MAT_JOHNSON_COOK and _SIMPLIFIED_JOHNSON_COOK), and how materials
!> fail.
module deck_johnson_cook_m
  use kinds_m, only : wp
  use johnson_cook_m, only : johnson_cook_t
  use log_m, only : to_text
  use parts_m, only : material_t, law_johnson_cook, law_hot_johnson_cook, spall_pressure, &
    spall_stress
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, next_card, report_field, warn_of_field
  use deck_values_m, only : real_of, reals_of, place_of
  implicit none
  private
  public :: take_johnson_cook, take_simplified_johnson_cook, take_failure, take_cutoff

  !> A strain at failure from here on means never.
  real(wp), parameter :: never = 1.0e16_wp
  !> How far G may be off E/(2 (1 + PR)) without a word: decks give three digits.
  real(wp), parameter :: same_shear = 0.01_wp

contains

  !> A plastic strain at failure; 0 means never.
  subroutine take_failure(card, name, material)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    type(material_t), intent(inout) :: material

    if (real_of(card, name) > 0.0_wp .and. real_of(card, name) < never) &
      material%failure_strain = real_of(card, name)
  end subroutine take_failure

  !> The cut-off PC of the pressure; 0 means none.
  subroutine take_cutoff(card, material)
    type(card_t), intent(in) :: card
    type(material_t), intent(inout) :: material

    if (real_of(card, 'PC') < 0.0_wp) material%cutoff = real_of(card, 'PC')
  end subroutine take_cutoff

  !> *MAT_SIMPLIFIED_JOHNSON_COOK: neither heat nor damage.
  subroutine take_simplified_johnson_cook(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(in) :: card
    type(material_t), intent(inout) :: material
    type(card_t) :: stress

    material%law = law_johnson_cook
    allocate (material%flow)
    call next_card(deck, cursor, 2, stress)
    call take_stress(card, stress, material%flow)
    call take_bound(deck, stress, 'SIGMAX', material%flow%most_static)
    call take_bound(deck, stress, 'SIGSAT', material%flow%most)
    call take_failure(stress, 'PSFAIL', material)
  end subroutine take_simplified_johnson_cook

  !> *MAT_JOHNSON_COOK.
  subroutine take_johnson_cook(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material
    type(card_t) :: stress, heat, damage

    call take_bulk(deck, card, material)
    material%law = law_hot_johnson_cook
    material%takes_eos = .true.
    allocate (material%flow)
    associate (flow => material%flow)
      flow%has_memory = .true.
      call next_card(deck, cursor, 2, stress)
      call next_card(deck, cursor, 3, heat)
      call next_card(deck, cursor, 4, damage)
      call take_stress(card, stress, flow)
      call take_heat(deck, stress, heat, material)
      call take_spall(deck, heat, material)
      flow%d = [reals_of(heat, 'D1', 'D4'), real_of(damage, 'D5')]
      ! Tension breaks sooner, whichever sign of pressure and D3 the deck has in mind.
      flow%d(3) = -abs(flow%d(3))
      flow%has_damage = any(abs(flow%d(1:2)) > 0.0_wp)
      flow%keeps_broken = abs(real_of(damage, 'EROD')) > 0.0_wp
      if (any(abs(flow%d) > 0.0_wp) .and. .not. flow%has_damage) call report_field(deck, heat, &
        'D1', 'is 0 as D2 is: the strain at fracture would be 0')
      flow%least = max(real_of(damage, 'EFMIN'), tiny(1.0_wp))
    end associate
  end subroutine take_johnson_cook

  !> E and PR, where no equation of state gives the pressure: K of K ln(J).
  subroutine take_bulk(deck, card, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material

    associate (young => real_of(card, 'E'), poisson => real_of(card, 'PR'))
      material%needs_eos = .not. young > 0.0_wp
      if (any(card%bad) .or. material%needs_eos) return
      associate (shear => young/(2.0_wp*(1.0_wp + poisson)))
        if (abs(shear - material%shear) > same_shear*material%shear) call warn_of_field(deck, &
          place_of(card, 'G'), 'is not E/(2 (1 + PR)) = '//to_text(shear)//': the deviator ' &
          //'goes with G; E and PR give the bulk modulus where there is no equation of state')
      end associate
      material%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
    end associate
  end subroutine take_bulk

  !> A, B, N, C and EPSO, and whose rate counts (VP): 0 the total one, 1 that of the plastic strain.
  subroutine take_stress(card, stress, flow)
    type(card_t), intent(in) :: card, stress
    type(johnson_cook_t), intent(inout) :: flow

    flow%is_viscoplastic = real_of(card, 'VP') > 0.0_wp
    flow%a = real_of(stress, 'A')
    flow%b = real_of(stress, 'B')
    flow%n = real_of(stress, 'N')
    flow%c = real_of(stress, 'C')
    flow%rate = real_of(stress, 'EPSO')
  end subroutine take_stress

  !> A bound on the flow stress; its default is none.
  subroutine take_bound(deck, card, name, bound)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    real(wp), intent(inout) :: bound

    if (real_of(card, name) < real_of(card, 'A')) then
      call report_field(deck, card, name, 'is below A: a bound on the flow stress is not')
    else
      bound = real_of(card, name)
    end if
  end subroutine take_bound

  !> CP with M, TM and TR: without a specific heat nothing warms.
  subroutine take_heat(deck, stress, card, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: stress, card
    type(material_t), intent(inout) :: material

    material%flow%room = real_of(stress, 'TR')
    if (.not. real_of(card, 'CP') > 0.0_wp) return
    if (.not. real_of(stress, 'M') > 0.0_wp) call report_field(deck, stress, 'M', &
      'is not an exponent (more than 0) beside a specific heat CP')
    if (.not. real_of(stress, 'TM') > real_of(stress, 'TR')) call report_field(deck, stress, &
      'TM', 'is not above TR: it is the temperature of melting')
    if (any(stress%bad) .or. any(card%bad) .or. .not. material%density > 0.0_wp) return
    material%flow%m = real_of(stress, 'M')
    material%flow%span = real_of(stress, 'TM') - real_of(stress, 'TR')
    material%flow%heat = 1.0_wp/(material%density*real_of(card, 'CP'))
  end subroutine take_heat

  !> PC and what it means, SPALL 1, 2 or 3, which count from 1 as the constants do.
  subroutine take_spall(deck, card, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(material_t), intent(inout) :: material

    call take_cutoff(card, material)
    material%spall = spall_pressure
    if (real_of(card, 'PC') < 0.0_wp) then
      material%spall = nint(real_of(card, 'SPALL'))
    else if (nint(real_of(card, 'SPALL')) /= spall_stress) then
      call warn_of_field(deck, place_of(card, 'SPALL'), 'has no effect: PC is 0, so that ' &
        //'nothing breaks by tension')
    end if
  end subroutine take_spall

end module deck_johnson_cook_m
