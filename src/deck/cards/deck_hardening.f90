! SPDX-License-Identifier: MIT
!> Yield stress and failure of *MAT_PIECEWISE_LINEAR_PLASTICITY, _ELASTIC_PLASTIC_HYDRO,
!> _JOHNSON_COOK and _SIMPLIFIED_JOHNSON_COOK.
module deck_hardening_m
  use kinds_m, only : wp
  use curves_m, only : curve_t
  use hardenings_m, only : make_hardening, depends_on_rate
  use log_m, only : to_text
  use model_m, only : model_t
  use parts_m, only : material_t, law_piecewise, law_johnson_cook, law_hot_johnson_cook, &
    spall_pressure, spall_stress, johnson_cook_t
  use deck_lines_m, only : deck_t, line_error, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, next_card, report_field, warn_of_field
  use deck_curves_m, only : table_t
  use deck_ids_m, only : a_curve, a_table, index_of
  use deck_values_m, only : integer_of, real_of, is_bad, find_id, reals_of, location_of
  implicit none
  private
  public :: read_piecewise, read_hydro, read_tangent_modulus, read_johnson_cook, &
    read_simplified_johnson_cook, read_failure, read_cutoff

  !> Strain at failure from which on there is no failure.
  real(wp), parameter :: never = 1.0e16_wp
  !> Relative difference of G and E/(2 (1 + PR)) without a warning: decks give three digits.
  real(wp), parameter :: same_shear = 0.01_wp

contains

  !> *MAT_PIECEWISE_LINEAR_PLASTICITY.
  subroutine read_piecewise(deck, cursor, card, tables, model, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(inout) :: card
    type(table_t), intent(in) :: tables(:)
    type(model_t), intent(inout) :: model     !! `is_of_time` of its curves is set
    type(material_t), intent(inout) :: material
    type(card_t) :: rate, points(2)

    material%law = law_piecewise
    call read_failure(card, 'FAIL', material)
    call next_card(deck, cursor, 2, rate)
    if (real_of(rate, 'C') > 0.0_wp .and. .not. real_of(rate, 'P') > 0.0_wp) call &
      report_field(deck, rate, 'P', 'is not an exponent (more than 0), which C needs')
    call next_card(deck, cursor, 3, points(1))
    call next_card(deck, cursor, 4, points(2))
    if (integer_of(rate, 'LCSS') > 0) then
      if (has_points(points)) call line_warning(deck, points(1)%line, 'points', &
        'EPS and ES have no effect where LCSS gives the yield stress')
      call read_hardening_curves(deck, card, rate, tables, model, material)
    else if (has_points(points)) then
      call read_hardening_points(deck, card, points, material)
    else if (.not. is_bad(rate, 'LCSS')) then
      if (.not. real_of(card, 'SIGY') > 0.0_wp) call report_field(deck, card, 'SIGY', &
        'is not a yield stress (more than 0), and there is neither LCSS nor EPS and ES')
      call read_tangent_modulus(deck, card, material%hardening)
      if (.not. any(card%bad)) call read_linear_hardening(deck, card, material%hardening, material)
    end if
    call read_rate_effect(deck, rate, model, material)
  end subroutine read_piecewise

  !> *MAT_ELASTIC_PLASTIC_HYDRO, which needs an equation of state.
  subroutine read_hydro(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material
    type(card_t) :: points(4)
    integer :: k

    material%law = law_piecewise
    material%takes_eos = .true.
    material%needs_eos = .true.
    call read_failure(card, 'FS', material)
    call read_cutoff(card, material)
    do k = 1, 4
      call next_card(deck, cursor, 1 + k, points(k))
    end do
    if (has_points(points)) then
      call read_hardening_points(deck, card, points, material)
    else if (.not. real_of(card, 'SIGY') > 0.0_wp) then
      call report_field(deck, card, 'SIGY', &
        'is not a yield stress (more than 0), and there are no EPS and ES')
    else
      call read_linear_hardening(deck, card, real_of(card, 'EH'), material)
    end if
  end subroutine read_hydro

  !> Plastic modulus E_p = E ETAN/(E - ETAN) from the uniaxial tangent modulus.
  subroutine read_tangent_modulus(deck, card, modulus)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    real(wp), intent(inout) :: modulus   !! unchanged where the card has errors

    associate (young => real_of(card, 'E'), tangent => real_of(card, 'ETAN'))
      if (tangent >= young .and. .not. is_bad(card, 'E')) call report_field(deck, card, 'ETAN', &
        'is not below E: the tangent modulus of the uniaxial stress-strain curve must be')
      if (.not. any(card%bad)) modulus = young*tangent/(young - tangent)
    end associate
  end subroutine read_tangent_modulus

  !> Linear hardening from SIGY.
  subroutine read_linear_hardening(deck, card, modulus, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    real(wp), value :: modulus
    type(material_t), intent(inout) :: material
    type(curve_t) :: points(1)

    points(1)%abscissa = [0.0_wp]
    points(1)%ordinate = [real_of(card, 'SIGY')]
    material%curve = make_hardening(points, [0.0_wp])
    material%curve%slope = modulus
    call set_initial_yield(deck, card, material)
  end subroutine read_linear_hardening

  !> Whether cards of EPS and ES have values.
  pure function has_points(cards) result(yes)
    type(card_t), intent(in) :: cards(:)
    logical :: yes
    integer :: i

    yes = any([(any(abs(cards(i)%r(:8)) > 0.0_wp), i=1, size(cards))])
  end function has_points

  !> EPS and ES, eight on a card: points up to the last nonzero one.
  subroutine read_hardening_points(deck, card, cards, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(card_t), intent(inout) :: cards(:)   !! of EPS, then of ES
    type(material_t), intent(inout) :: material
    type(curve_t) :: points(1)
    real(wp), allocatable :: strain(:), stress(:)
    integer :: i, k, n, half

    half = size(cards)/2
    strain = [(cards(i)%r(:8), i=1, half)]
    stress = [(cards(half + i)%r(:8), i=1, half)]
    n = max(1, findloc(abs(strain) > 0.0_wp .or. abs(stress) > 0.0_wp, .true., dim=1, back=.true.))
    if (n < 2) call report_field(deck, cards(1), 'EPS2', &
      'ends the points, of which there must be two or more')
    if (abs(strain(1)) > 0.0_wp) call report_field(deck, cards(1), 'EPS1', &
      'is not 0: the first point is the initial yield stress')
    do k = 1, n
      i = (k + 7)/8
      if (.not. stress(k) > 0.0_wp) call report_field(deck, cards(half + i), k - 8*(i - 1), &
        'is not a yield stress (more than 0)')
      if (k == 1) cycle
      if (strain(k) <= strain(k - 1)) call report_field(deck, cards(i), k - 8*(i - 1), &
        'is not beyond the point before it: plastic strains must increase')
    end do
    if (any([(any(cards(i)%bad), i=1, 2*half)])) return
    points(1)%abscissa = strain(:n)
    points(1)%ordinate = stress(:n)
    material%curve = make_hardening(points, [0.0_wp])
    call set_initial_yield(deck, card, material)
  end subroutine read_hardening_points

  !> LCSS: a curve or a table.
  subroutine read_hardening_curves(deck, card, rate, tables, model, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(card_t), intent(inout) :: rate
    type(table_t), intent(in) :: tables(:)
    type(model_t), intent(inout) :: model
    type(material_t), intent(inout) :: material
    character(:), allocatable :: name
    integer :: i, k, n_before, ends(2)
    real(wp), allocatable :: rates(:)

    n_before = deck%report%n_error
    k = index_of(deck%maps(a_table), integer_of(rate, 'LCSS'))
    if (k > 0) then
      ends = tables(k)%curves
      rates = tables(k)%values
    else
      k = index_of(deck%maps(a_curve), integer_of(rate, 'LCSS'))
      ends = k
      rates = [0.0_wp]
      if (k == 0 .and. .not. (deck%maps(a_curve)%has_refused .or. deck%maps(a_table)%has_refused)) &
        call report_field(deck, rate, 'LCSS', 'matches no curve or table of this deck')
    end if
    if (ends(1) == 0 .or. ends(2) < ends(1)) return
    if (rates(1) < 0.0_wp) call report_field(deck, rate, 'LCSS', 'is a table with negative ' &
      //'values, logarithms of strain rates, which this version does not have')
    do i = ends(1), ends(2)
      model%curves(i)%is_of_time = .false.
      if (deck%maps(a_curve)%has_refused) cycle
      associate (curve => model%curves(i), line => deck%maps(a_curve)%lines(i))
        name = 'curve '//to_text(curve%id) &
          //' is a yield stress against plastic strain (LCSS) and must '
        if (abs(curve%abscissa(1)) > 0.0_wp) call line_error(deck, line, name &
          //'start at plastic strain 0, not '//to_text(curve%abscissa(1)))
        if (.not. minval(curve%ordinate) > 0.0_wp) call line_error(deck, line, name &
          //'be above 0 everywhere')
      end associate
    end do
    if (deck%report%n_error > n_before) return
    material%curve = make_hardening(model%curves(ends(1):ends(2)), rates)
    call set_initial_yield(deck, card, material)
  end subroutine read_hardening_curves

  !> Set the initial yield stress and modulus, and report softening that has no solution.
  subroutine set_initial_yield(deck, card, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(material_t), intent(inout) :: material

    material%yield = material%curve%stress(1, 1)
    material%hardening = material%curve%slope(1, 1)
    if (minval(material%curve%slope) <= -3.0_wp*material%shear .and. material%shear > 0.0_wp) call &
      line_error(deck, card%line, 'the yield stress of material '//to_text(material%id) &
      //' falls faster than 3G: the return mapping would have no solution')
  end subroutine set_initial_yield

  !> Read the rate effect: a table prevails over LCSR, LCSR over C and P.
  subroutine read_rate_effect(deck, card, model, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(inout) :: model
    type(material_t), intent(inout) :: material
    integer :: k
    logical :: has_curve, has_constants

    has_curve = integer_of(card, 'LCSR') > 0
    has_constants = real_of(card, 'C') > 0.0_wp
    k = 0
    if (has_curve) call find_id(deck, a_curve, card, 'LCSR', k)
    if (.not. allocated(material%curve)) return
    if (size(material%curve%rate) > 1) then
      if (has_curve .or. has_constants) call line_warning(deck, card%line, 'rates of a table', &
        'a table (LCSS) gives the rate effect: LCSR, C and P have none')
    else if (k > 0) then
      model%curves(k)%is_of_time = .false.
      if (.not. minval(model%curves(k)%ordinate) > 0.0_wp) call report_field(deck, card, 'LCSR', &
        'is a curve that is not above 0 everywhere: it is a factor on the yield stress')
      if (has_constants) call line_warning(deck, card%line, 'rates of a curve', &
        'LCSR gives the rate effect: C and P have none')
      material%curve%rate_factor = model%curves(k)
    else if (has_constants .and. .not. has_curve .and. .not. is_bad(card, 'P')) then
      material%curve%rate_constant = real_of(card, 'C')
      material%curve%rate_exponent = 1.0_wp/real_of(card, 'P')
    end if
    if (.not. depends_on_rate(material%curve)) then
      if (real_of(card, 'VP') > 0.0_wp) call line_warning(deck, card%line, &
        'form of no rates', 'VP has no effect: the material has no rate effect')
      return
    end if
    if (real_of(card, 'VP') > 0.0_wp) call report_field(deck, card, 'VP', &
      'asks for the viscoplastic rate form, which this version does not have; 0 scales the ' &
      //'yield stress with the total strain rate')
    if (minval(material%curve%slope) < 0.0_wp) call report_field(deck, card, 'C', &
      'begins a card with a rate effect, but the yield stress falls somewhere: this law does ' &
      //'not have both')
  end subroutine read_rate_effect

  !> Read the plastic strain at failure; 0 means no failure.
  subroutine read_failure(card, name, material)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    type(material_t), intent(inout) :: material

    if (real_of(card, name) > 0.0_wp .and. real_of(card, name) < never) &
      material%failure_strain = real_of(card, name)
  end subroutine read_failure

  !> Read the pressure cut-off PC; 0 means none.
  subroutine read_cutoff(card, material)
    type(card_t), intent(in) :: card
    type(material_t), intent(inout) :: material

    if (real_of(card, 'PC') < 0.0_wp) material%cutoff = real_of(card, 'PC')
  end subroutine read_cutoff

  !> *MAT_SIMPLIFIED_JOHNSON_COOK: without heat and damage.
  subroutine read_simplified_johnson_cook(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(in) :: card
    type(material_t), intent(inout) :: material
    type(card_t) :: stress

    material%law = law_johnson_cook
    allocate (material%flow)
    call next_card(deck, cursor, 2, stress)
    call read_flow_stress(card, stress, material%flow)
    call read_stress_bound(deck, stress, 'SIGMAX', material%flow%most_static)
    call read_stress_bound(deck, stress, 'SIGSAT', material%flow%most)
    call read_failure(stress, 'PSFAIL', material)
  end subroutine read_simplified_johnson_cook

  !> *MAT_JOHNSON_COOK.
  subroutine read_johnson_cook(deck, cursor, card, material)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material
    type(card_t) :: stress, heat, damage

    call read_bulk_modulus(deck, card, material)
    material%law = law_hot_johnson_cook
    material%takes_eos = .true.
    allocate (material%flow)
    associate (flow => material%flow)
      flow%has_memory = .true.
      call next_card(deck, cursor, 2, stress)
      call next_card(deck, cursor, 3, heat)
      call next_card(deck, cursor, 4, damage)
      call read_flow_stress(card, stress, flow)
      call read_heat(deck, stress, heat, material)
      ! PC, and SPALL 1, 2 or 3, equal to the `spall_` constants.
      call read_cutoff(heat, material)
      material%spall = spall_pressure
      if (real_of(heat, 'PC') < 0.0_wp) then
        material%spall = nint(real_of(heat, 'SPALL'))
      else if (nint(real_of(heat, 'SPALL')) /= spall_stress) then
        call warn_of_field(deck, location_of(heat, 'SPALL'), 'has no effect without PC: there is ' &
          //'no failure in tension')
      end if
      flow%d = [reals_of(heat, 'D1', 'D4'), real_of(damage, 'D5')]
      ! Tension reduces the failure strain, whatever the sign convention of D3 in the deck.
      flow%d(3) = -abs(flow%d(3))
      flow%has_damage = any(abs(flow%d(1:2)) > 0.0_wp)
      flow%keeps_broken = abs(real_of(damage, 'EROD')) > 0.0_wp
      if (any(abs(flow%d) > 0.0_wp) .and. .not. flow%has_damage) call report_field(deck, heat, &
        'D1', 'is 0 as D2 is: the strain at fracture would be 0')
      flow%least = max(real_of(damage, 'EFMIN'), tiny(1.0_wp))
    end associate
  end subroutine read_johnson_cook

  !> E and PR: bulk modulus where there is no equation of state.
  subroutine read_bulk_modulus(deck, card, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(material_t), intent(inout) :: material

    associate (young => real_of(card, 'E'), poisson => real_of(card, 'PR'))
      material%needs_eos = .not. young > 0.0_wp
      if (any(card%bad) .or. material%needs_eos) return
      associate (shear => young/(2.0_wp*(1.0_wp + poisson)))
        if (abs(shear - material%shear) > same_shear*material%shear) call warn_of_field(deck, &
          location_of(card, 'G'), 'is not E/(2 (1 + PR)) = '//to_text(shear)//'; G gives the ' &
          //'deviatoric stress, E and PR the bulk modulus where there is no equation of state')
      end associate
      material%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
    end associate
  end subroutine read_bulk_modulus

  !> A, B, N, C, EPSO and VP.
  subroutine read_flow_stress(card, stress, flow)
    type(card_t), intent(in) :: card, stress
    type(johnson_cook_t), intent(inout) :: flow

    flow%is_viscoplastic = real_of(card, 'VP') > 0.0_wp
    flow%a = real_of(stress, 'A')
    flow%b = real_of(stress, 'B')
    flow%n = real_of(stress, 'N')
    flow%c = real_of(stress, 'C')
    flow%rate = real_of(stress, 'EPSO')
  end subroutine read_flow_stress

  !> An upper bound of the flow stress; the default is none.
  subroutine read_stress_bound(deck, card, name, bound)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    real(wp), intent(inout) :: bound

    if (real_of(card, name) < real_of(card, 'A')) then
      call report_field(deck, card, name, 'is below A: a bound of the flow stress must not be')
    else
      bound = real_of(card, name)
    end if
  end subroutine read_stress_bound

  !> CP with M, TM and TR: there is no heating without CP.
  subroutine read_heat(deck, stress, card, material)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: stress, card
    type(material_t), intent(inout) :: material

    material%flow%room = real_of(stress, 'TR')
    if (.not. real_of(card, 'CP') > 0.0_wp) return
    if (.not. real_of(stress, 'M') > 0.0_wp) call report_field(deck, stress, 'M', &
      'is not an exponent (more than 0), which CP needs')
    if (.not. real_of(stress, 'TM') > real_of(stress, 'TR')) call report_field(deck, stress, &
      'TM', 'is not above TR: it is the temperature of melting')
    if (any(stress%bad) .or. any(card%bad) .or. .not. material%density > 0.0_wp) return
    material%flow%m = real_of(stress, 'M')
    material%flow%span = real_of(stress, 'TM') - real_of(stress, 'TR')
    material%flow%heat = 1.0_wp/(material%density*real_of(card, 'CP'))
  end subroutine read_heat

end module deck_hardening_m
