! SPDX-License-Identifier: MIT
!> *MAT_PIECEWISE_LINEAR_PLASTICITY and *MAT_ELASTIC_PLASTIC_HYDRO: a yield stress by points.
module deck_hardening_m
  use kinds_m, only : wp
  use parts_m, only : material_t, law_piecewise
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of, reals_of, is_bad, place_of
  use deck_checks_m, only : refuse_negative
  use deck_material_m, only : elastic_constants, append_material, check_tangent_modulus, &
    take_failure, take_cutoff, plastic_modulus, &
    check_shear
  use deck_raw_m, only : raw_t, raw_hardening_t
  implicit none
  private
  public :: read_piecewise, read_hydro

  !> First and last field of the cards of points.
  character(5), parameter :: strain_ends(2, 2) = reshape(['EPS1 ', 'EPS8 ', 'EPS9 ', 'EPS16'], &
    [2, 2]), stress_ends(2, 2) = reshape(['ES1  ', 'ES8  ', 'ES9  ', 'ES16 '], [2, 2])

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

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
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
    call append_material(raw, material, card)
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

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, cursor, 1, card)
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
    call append_material(raw, material, card)
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

end module deck_hardening_m
