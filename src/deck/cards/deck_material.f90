! SPDX-License-Identifier: MIT
!> *MAT_ELASTIC, _PLASTIC_KINEMATIC, _NULL, _CRUSHABLE_FOAM, _MOONEY-RIVLIN_RUBBER,
!> _BLATZ-KO_RUBBER and _RIGID, what all materials have, and *EOS_LINEAR_POLYNOMIAL and _GRUNEISEN.
module deck_material_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use parts_m, only : material_t, law_elastic, law_plastic, law_null, law_crushable_foam, &
    law_mooney_rivlin, law_blatz_ko
  use deck_ids_m, only : a_material, an_eos
  use deck_maps_m, only : lose
  use deck_lines_m, only : deck_t, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, first_card, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of, is_bad, place_of, require_id, refuse_negative, &
    refuse_large, refuse_outside, reals_of
  use deck_raw_m, only : raw_t, raw_foam_t
  use eos_m, only : eos_t, eos_by_law, eos_linear_polynomial, eos_gruneisen
  use rubbers_m, only : mooney_rivlin, blatz_ko, blatz_ko_poisson
  implicit none
  private
  public :: read_elastic, read_plastic_kinematic, elastic_constants, append_material, &
    check_tangent_modulus, take_failure, take_cutoff, plastic_modulus, check_shear, read_null, &
    read_crushable_foam, read_mooney_rivlin, read_blatz_ko, read_rigid, read_linear_polynomial, &
    read_gruneisen

  !> A strain at failure from here on means never.
  real(wp), parameter :: never = 1.0e16_wp

  !> Codes of CON1 and CON2: 0 none, 1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7 xyz.
  logical, parameter :: has_x(0:7) = [.false., .true., .false., .false., .true., .false., .true., &
    .true.]
  logical, parameter :: has_y(0:7) = [.false., .false., .true., .false., .true., .true., .false., &
    .true.]
  logical, parameter :: has_z(0:7) = [.false., .false., .false., .true., .false., .true., .true., &
    .true.]

  !> Largest pressure and energy, speed, and pure number that constants may be: below them squares
  !> and cubes stay numbers in any units, and no material is anywhere near.
  real(wp), parameter :: most_pressure = 1.0e30_wp, most_speed = 1.0e12_wp, most_number = 100.0_wp

contains

  !> *MAT_ELASTIC.
  subroutine read_elastic(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(material_t) :: material

    call first_card(deck, i_block, cursor, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_elastic
    call append_material(deck, raw, material, card)
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

    call first_card(deck, i_block, cursor, card)
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
    call append_material(deck, raw, material, card)
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
  subroutine append_material(deck, raw, material, card)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(inout) :: raw
    type(material_t), intent(in) :: material
    type(card_t), intent(in) :: card

    if (is_bad(card, 'MID')) call lose(deck, [a_material])
    if (is_bad(card, 'MID')) return
    raw%n_material = raw%n_material + 1
    raw%materials(raw%n_material) = material
    raw%material_line(raw%n_material) = card%line
  end subroutine append_material

  !> A fluid: its pressure comes from an equation of state.
  subroutine read_null(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(material_t) :: material

    call first_card(deck, i_block, cursor, card)
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
    call append_material(deck, raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_null

  !> Elastic up to a curve, which is resolved later, and to TSC in tension.
  subroutine read_crushable_foam(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(material_t) :: material
    type(raw_foam_t) :: foam

    call first_card(deck, i_block, cursor, card)
    call elastic_constants(deck, cursor, card, material)
    if (integer_of(card, 'LCID') < 1) call report_field(deck, cursor, card, 'LCID', &
      'is not the number of a curve: yield stress against volumetric strain 1 - V')
    call refuse_negative(deck, cursor, card, 'TSC')
    material%law = law_crushable_foam
    material%tension = real_of(card, 'TSC')
    if (material%bulk > 0.0_wp) material%eos = eos_t(kind=eos_by_law, stiffness=material%bulk)
    call append_material(deck, raw, material, card)
    call check_rest(deck, cursor)
    if (is_bad(card, 'MID') .or. is_bad(card, 'LCID')) return
    foam%material = raw%n_material
    foam%curve = integer_of(card, 'LCID')
    foam%place = place_of(card, 'LCID')
    raw%n_foam = raw%n_foam + 1
    raw%foams(raw%n_foam) = foam
  end subroutine read_crushable_foam

  !> *MAT_MOONEY-RIVLIN_RUBBER.
  subroutine read_mooney_rivlin(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, fit
    type(material_t) :: material
    real(wp) :: a, b, poisson

    call first_card(deck, i_block, cursor, card)
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
    call append_material(deck, raw, material, card)
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

    call first_card(deck, i_block, cursor, card)
    call check_shear(deck, cursor, card, material)
    material%law = law_blatz_ko
    if (.not. any(card%bad)) then
      material%rubber = blatz_ko(material%shear)
      call settle_moduli(blatz_ko_poisson, material)
    end if
    call append_material(deck, raw, material, card)
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

  !> *MAT_RIGID.
  subroutine read_rigid(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, constraints, axes
    type(material_t) :: material

    call first_card(deck, i_block, cursor, card)
    call elastic_constants(deck, cursor, card, material)
    material%is_rigid = .true.
    call next_card(deck, cursor, 2, constraints)
    call read_constraints(deck, cursor, constraints, material)
    call next_card(deck, cursor, 3, axes)
    call append_material(deck, raw, material, card)
    call check_rest(deck, cursor)
  end subroutine read_rigid

  !> CMO, CON1 and CON2.
  subroutine read_constraints(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material
    character(*), parameter :: no_code = 'is not a code of constraints (0 to 7)'
    integer :: codes(2)

    if (integer_of(card, 'CMO') == -1) then
      call report_field(deck, cursor, card, 'CMO', 'asks for constraints in local axes, which ' &
        //'this version does not have; 1 takes the global ones')
      return
    else if (integer_of(card, 'CMO') /= 0 .and. integer_of(card, 'CMO') /= 1) then
      call report_field(deck, cursor, card, 'CMO', &
        'is not 0 (no constraints) or 1 (constraints in global axes)')
      return
    end if
    call refuse_outside(deck, cursor, card, 'CON1', 0, 7, no_code)
    call refuse_outside(deck, cursor, card, 'CON2', 0, 7, no_code)
    if (is_bad(card, 'CON1') .or. is_bad(card, 'CON2')) return
    codes = [integer_of(card, 'CON1'), integer_of(card, 'CON2')]
    if (integer_of(card, 'CMO') == 1) then
      material%is_fixed = [has_x(codes(1)), has_y(codes(1)), has_z(codes(2))]
    else if (any(codes > 0)) then
      call line_warning(deck, card%line, 'CMO 0', &
        'CON1 and CON2 have no effect while CMO is 0; 1 makes them constraints')
    end if
  end subroutine read_constraints

  !> *EOS_LINEAR_POLYNOMIAL.
  subroutine read_linear_polynomial(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, start
    type(eos_t) :: eos
    integer :: k

    call read_cards(deck, i_block, cursor, card, start)
    do k = 0, 6
      call refuse_large(deck, cursor, card, 'C'//achar(iachar('0') + k), merge(most_pressure, &
        most_number, k < 4))
    end do
    eos%kind = eos_linear_polynomial
    eos%c = reals_of(card, 'C0', 'C6')
    eos%energy = real_of(start, 'E0')
    call refuse_large(deck, cursor, start, 'E0', most_pressure)
    call append_eos(deck, cursor, card, eos, raw)
  end subroutine read_linear_polynomial

  !> *EOS_GRUNEISEN.
  subroutine read_gruneisen(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, start
    type(eos_t) :: eos
    character(5), parameter :: numbers(5) = [character(5) :: 'S1', 'S2', 'S3', 'GAMAO', 'A']
    integer :: k

    call read_cards(deck, i_block, cursor, card, start)
    if (.not. real_of(card, 'C') > 0.0_wp) call report_field(deck, cursor, card, 'C', &
      'is not a speed (more than 0): shocks of no strength run with it')
    call refuse_large(deck, cursor, card, 'C', most_speed)
    call refuse_negative(deck, cursor, card, 'GAMAO')
    do k = 1, size(numbers)
      call refuse_large(deck, cursor, card, trim(numbers(k)), most_number)
    end do
    call refuse_large(deck, cursor, card, 'E0', most_pressure)
    eos%kind = eos_gruneisen
    eos%speed = real_of(card, 'C')
    eos%s = reals_of(card, 'S1', 'S3')
    eos%gamma = real_of(card, 'GAMAO')
    eos%correction = real_of(card, 'A')
    eos%energy = real_of(card, 'E0')
    call append_eos(deck, cursor, card, eos, raw)
  end subroutine read_gruneisen

  !> The two cards that both have: EOSID on the first and V0 on the second. Bodies start with the
  !> density of their material.
  subroutine read_cards(deck, i_block, cursor, card, start)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(cursor_t), intent(out) :: cursor
    type(card_t), intent(out) :: card, start

    call first_card(deck, i_block, cursor, card)
    call require_id(deck, cursor, card, 'EOSID')
    call next_card(deck, cursor, 2, start)
    if (abs(real_of(start, 'V0') - 1.0_wp) > 0.0_wp) call report_field(deck, cursor, start, &
      'V0', 'is a volume at the start that is not that of the density RO, which this version ' &
      //'does not have (0 or 1)')
  end subroutine read_cards

  !> One more equation of state.
  subroutine append_eos(deck, cursor, card, eos, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(in) :: card
    type(eos_t), intent(inout) :: eos
    type(raw_t), intent(inout) :: raw

    call check_rest(deck, cursor)
    if (is_bad(card, 'EOSID')) call lose(deck, [an_eos])
    if (is_bad(card, 'EOSID')) return
    eos%id = integer_of(card, 'EOSID')
    raw%n_equation = raw%n_equation + 1
    raw%equations(raw%n_equation) = eos
    raw%equation_line(raw%n_equation) = card%line
  end subroutine append_eos

end module deck_material_m
