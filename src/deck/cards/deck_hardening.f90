! SPDX-License-Identifier: MIT
!> Laws with a yield stress of their own form: by points (*MAT_PIECEWISE_LINEAR_PLASTICITY and
!> _ELASTIC_PLASTIC_HYDRO), by Johnson and Cook (*MAT_JOHNSON_COOK and _SIMPLIFIED_JOHNSON_COOK).
module deck_hardening_m
  use kinds_m, only : wp
  use parts_m, only : material_t, law_piecewise, law_johnson_cook, law_hot_johnson_cook, &
    spall_pressure, spall_stress
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, line_warning, place_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, first_card, next_card, check_rest, report_field, warn_of_field
  use deck_values_m, only : integer_of, real_of, reals_of, is_bad, place_of, refuse_negative
  use deck_material_m, only : elastic_constants, append_material, check_tangent_modulus, &
    take_failure, take_cutoff, plastic_modulus, check_shear
  use deck_raw_m, only : raw_t, raw_hardening_t
  use johnson_cook_m, only : johnson_cook_t
  implicit none
  private
  public :: read_piecewise, read_hydro, read_johnson_cook, read_simplified_johnson_cook

  !> First and last field of the cards of points.
  character(5), parameter :: strain_ends(2, 2) = reshape(['EPS1 ', 'EPS8 ', 'EPS9 ', 'EPS16'], &
    [2, 2]), stress_ends(2, 2) = reshape(['ES1  ', 'ES8  ', 'ES9  ', 'ES16 '], [2, 2])

  !> How far G may be off E/(2 (1 + PR)) without a word: decks give three digits.
  real(wp), parameter :: same_shear = 0.01_wp

contains

  !> *MAT_PIECEWISE_LINEAR_PLASTICITY.
  subroutine read_piecewise(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, rate, strains(1), stresses(1)
    type(material_t) :: material
    type(raw_hardening_t) :: hardening
    logical :: has_strains, has_points

    call first_card(deck, i_block, cursor, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_piecewise
    call take_failure(deck, cursor, card, 'FAIL', material)
    call next_card(deck, cursor, 2, rate)
    call read_rates(deck, cursor, rate, hardening)
    call next_card(deck, cursor, 3, strains(1))
    call next_card(deck, cursor, 4, stresses(1))
    has_strains = any(abs(reals_of(strains(1), 'EPS1', 'EPS8')) > 0.0_wp)
    has_points = has_strains .or. any(abs(reals_of(stresses(1), 'ES1', 'ES8')) > 0.0_wp)
    if (hardening%curve > 0 .or. has_strains) then
      ! What is not used here must make sense all the same.
      call refuse_negative(deck, cursor, card, 'SIGY')
      call refuse_negative(deck, cursor, card, 'ETAN')
    end if
    if (hardening%curve > 0) then
      if (has_points) call line_warning(deck, strains(1)%line, 'points', &
        'EPS and ES have no effect where LCSS gives the yield stress')
    else if (has_points) then
      call read_points(deck, cursor, strains, stresses, hardening)
    else if (.not. is_bad(rate, 'LCSS')) then
      call read_line(deck, cursor, card, hardening)
    end if
    call append_material(deck, raw, material, card)
    call check_rest(deck, cursor)
    if (is_bad(card, 'MID') .or. is_bad(rate, 'LCSS')) return
    hardening%material = raw%n_material
    raw%n_hardening = raw%n_hardening + 1
    raw%hardenings(raw%n_hardening) = hardening
  end subroutine read_piecewise

  !> C, P, LCSS, LCSR and VP.
  subroutine read_rates(deck, cursor, card, hardening)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_hardening_t), intent(inout) :: hardening

    if (real_of(card, 'C') < 0.0_wp) call report_field(deck, cursor, card, 'C', &
      'is negative: the logarithmic rate effect is not part of this law')
    if (real_of(card, 'C') > 0.0_wp .and. .not. real_of(card, 'P') > 0.0_wp) &
      call report_field(deck, cursor, card, 'P', &
      'is not an exponent (more than 0) for the C beside it')
    call refuse_negative(deck, cursor, card, 'P')
    if (integer_of(card, 'LCSS') < 0) call report_field(deck, cursor, card, 'LCSS', &
      'is not a curve or table number')
    if (integer_of(card, 'LCSR') < 0) call report_field(deck, cursor, card, 'LCSR', &
      'is not a curve number')
    hardening%is_viscoplastic = abs(real_of(card, 'VP') - 1.0_wp) <= 0.0_wp
    if (abs(real_of(card, 'VP')) > 0.0_wp .and. .not. hardening%is_viscoplastic) &
      call report_field(deck, cursor, card, 'VP', &
      'is a rate form that this version does not have (0 scales the yield stress with the ' &
      //'total strain rate)')
    hardening%curve = max(integer_of(card, 'LCSS'), 0)
    hardening%rate_curve = max(integer_of(card, 'LCSR'), 0)
    if (.not. (is_bad(card, 'C') .or. is_bad(card, 'P'))) then
      hardening%rate_constant = real_of(card, 'C')
      hardening%rate_power = real_of(card, 'P')
    end if
    hardening%rate_place = place_of(card, 'C')
    hardening%curve_place = place_of(card, 'LCSS')
    hardening%rate_curve_place = place_of(card, 'LCSR')
    hardening%form_place = place_of(card, 'VP')
  end subroutine read_rates

  !> EPS and ES, eight on a card: as many points as there are up to the last that is not zero.
  subroutine read_points(deck, cursor, strains, stresses, hardening)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: strains(:), stresses(:)
    type(raw_hardening_t), intent(inout) :: hardening
    real(wp), allocatable :: strain(:), stress(:)
    integer :: i, k, n

    allocate (strain(0), stress(0))
    do i = 1, size(strains)
      strain = [strain, reals_of(strains(i), trim(strain_ends(1, i)), trim(strain_ends(2, i)))]
      stress = [stress, reals_of(stresses(i), trim(stress_ends(1, i)), trim(stress_ends(2, i)))]
    end do
    n = 1
    do k = 2, size(strain)
      if (abs(strain(k)) > 0.0_wp .or. abs(stress(k)) > 0.0_wp) n = k
    end do
    if (n < 2) call report_field(deck, cursor, strains(1), 'EPS2', &
      'ends the points, of which there must be two or more')
    if (abs(strain(1)) > 0.0_wp) call report_field(deck, cursor, strains(1), 'EPS1', &
      'is not 0: the first point is the initial yield stress')
    do k = 1, n
      i = (k + 7)/8
      if (.not. stress(k) > 0.0_wp) call report_field(deck, cursor, stresses(i), &
        'ES'//to_text(k), 'is not a yield stress (more than 0)')
    end do
    do k = 2, n
      i = (k + 7)/8
      if (strain(k) <= strain(k - 1)) call report_field(deck, cursor, strains(i), &
        'EPS'//to_text(k), 'is not beyond the point before it: plastic strains must increase')
    end do
    do i = 1, size(strains)
      if (any(strains(i)%bad) .or. any(stresses(i)%bad)) return
    end do
    hardening%points%abscissa = strain(:n)
    hardening%points%ordinate = stress(:n)
  end subroutine read_points

  !> *MAT_ELASTIC_PLASTIC_HYDRO: its pressure comes from an equation of state.
  subroutine read_hydro(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, strains(2), stresses(2)
    type(material_t) :: material
    type(raw_hardening_t) :: hardening
    integer :: k

    call first_card(deck, i_block, cursor, card)
    call check_shear(deck, cursor, card, material)
    material%law = law_piecewise
    material%takes_eos = .true.
    material%needs_eos = .true.
    call take_failure(deck, cursor, card, 'FS', material)
    call take_cutoff(deck, cursor, card, material)
    call refuse_negative(deck, cursor, card, 'SIGY')
    call refuse_negative(deck, cursor, card, 'EH')
    do k = 1, 2
      call next_card(deck, cursor, 1 + k, strains(k))
    end do
    do k = 1, 2
      call next_card(deck, cursor, 3 + k, stresses(k))
    end do
    if (any(abs(reals_of(strains(1), 'EPS1', 'EPS8')) > 0.0_wp) &
      .or. any(abs(reals_of(stresses(1), 'ES1', 'ES8')) > 0.0_wp) &
      .or. any(abs(reals_of(strains(2), 'EPS9', 'EPS16')) > 0.0_wp) &
      .or. any(abs(reals_of(stresses(2), 'ES9', 'ES16')) > 0.0_wp)) then
      call read_points(deck, cursor, strains, stresses, hardening)
    else if (.not. real_of(card, 'SIGY') > 0.0_wp) then
      call report_field(deck, cursor, card, 'SIGY', &
        'is not a yield stress (more than 0), and there are no EPS and ES')
    else
      hardening%points%abscissa = [0.0_wp]
      hardening%points%ordinate = [real_of(card, 'SIGY')]
      hardening%modulus = real_of(card, 'EH')
    end if
    call append_material(deck, raw, material, card)
    call check_rest(deck, cursor)
    if (is_bad(card, 'MID')) return
    hardening%material = raw%n_material
    raw%n_hardening = raw%n_hardening + 1
    raw%hardenings(raw%n_hardening) = hardening
  end subroutine read_hydro

  !> SIGY and ETAN.
  subroutine read_line(deck, cursor, card, hardening)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_hardening_t), intent(inout) :: hardening

    if (real_of(card, 'SIGY') <= 0.0_wp) call report_field(deck, cursor, card, 'SIGY', &
      'is not a yield stress (more than 0), and there is neither LCSS nor EPS and ES')
    call check_tangent_modulus(deck, cursor, card, &
      'is negative: a falling yield stress needs a curve')
    if (any(card%bad)) return
    hardening%points%abscissa = [0.0_wp]
    hardening%points%ordinate = [real_of(card, 'SIGY')]
    hardening%modulus = plastic_modulus(card)
  end subroutine read_line

  !> *MAT_SIMPLIFIED_JOHNSON_COOK: neither heat nor damage.
  subroutine read_simplified_johnson_cook(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, stress
    type(material_t) :: material

    call first_card(deck, i_block, cursor, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_johnson_cook
    allocate (material%flow)
    call take_rate_form(deck, cursor, card, material%flow)
    call next_card(deck, cursor, 2, stress)
    call take_stress(deck, cursor, stress, material%flow)
    call take_bound(deck, cursor, stress, 'SIGMAX', material%flow%most_static)
    call take_bound(deck, cursor, stress, 'SIGSAT', material%flow%most)
    call take_failure(deck, cursor, stress, 'PSFAIL', material)
    call append_material(deck, raw, material, card)
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

    call first_card(deck, i_block, cursor, card)
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
    call append_material(deck, raw, material, card)
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

end module deck_hardening_m
