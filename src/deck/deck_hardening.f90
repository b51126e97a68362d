! SPDX-License-Identifier: MIT
!> *MAT_PIECEWISE_LINEAR_PLASTICITY.
module deck_hardening_m
  use kinds_m, only : wp
  use parts_m, only : material_t, law_piecewise
  use deck_lines_m, only : deck_t, place_t, line_warning
  use deck_fields_m, only : card_t
  use deck_parameter_table_m, only : parameters_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_material_m, only : elastic_constants, append_material, check_tangent_modulus, &
    check_failure
  use deck_raw_m, only : raw_t, raw_hardening_t
  implicit none
  private
  public :: read_piecewise

contains

  !> *MAT_PIECEWISE_LINEAR_PLASTICITY.
  subroutine read_piecewise(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, rate, strains, stresses
    type(material_t) :: material
    type(raw_hardening_t) :: hardening
    integer :: k

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, parameters, cursor, 1, card)
    call elastic_constants(deck, cursor, card, material)
    material%law = law_piecewise
    call check_failure(deck, cursor, card, 7)
    call next_card(deck, parameters, cursor, 2, rate)
    call read_rates(deck, cursor, rate, hardening)
    call next_card(deck, parameters, cursor, 3, strains)
    call next_card(deck, parameters, cursor, 4, stresses)
    if (hardening%curve > 0 .or. any(abs(strains%r(:8)) > 0.0_wp)) then
      ! What is not used here must make sense all the same.
      do k = 5, 6
        if (card%r(k) < 0.0_wp) call report_field(deck, cursor, card, k, 'is negative')
      end do
    end if
    if (hardening%curve > 0) then
      if (any(abs(strains%r(:8)) > 0.0_wp) .or. any(abs(stresses%r(:8)) > 0.0_wp)) &
        call line_warning(deck, strains%line, 'points', &
        'EPS and ES have no effect where LCSS gives the yield stress')
    else if (any(abs(strains%r(:8)) > 0.0_wp) .or. any(abs(stresses%r(:8)) > 0.0_wp)) then
      call read_points(deck, cursor, strains, stresses, hardening)
    else if (.not. rate%bad(3)) then
      call read_line(deck, cursor, card, hardening)
    end if
    call append_material(raw, material, card)
    call check_rest(deck, cursor)
    if (card%bad(1) .or. rate%bad(3)) return
    hardening%material = size(raw%materials)
    raw%hardenings = [raw%hardenings, hardening]
  end subroutine read_piecewise

  !> C, P, LCSS, LCSR and VP.
  subroutine read_rates(deck, cursor, card, hardening)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_hardening_t), intent(inout) :: hardening

    if (card%r(1) < 0.0_wp) call report_field(deck, cursor, card, 1, &
      'is negative: the logarithmic rate effect is not part of this law')
    if (card%r(1) > 0.0_wp .and. .not. card%r(2) > 0.0_wp) &
      call report_field(deck, cursor, card, 2, &
      'is not an exponent (more than 0) for the C beside it')
    if (card%r(2) < 0.0_wp) call report_field(deck, cursor, card, 2, 'is negative')
    if (card%i(3) < 0) call report_field(deck, cursor, card, 3, 'is not a curve or table number')
    if (card%i(4) < 0) call report_field(deck, cursor, card, 4, 'is not a curve number')
    hardening%is_viscoplastic = abs(card%r(5) - 1.0_wp) <= 0.0_wp
    if (abs(card%r(5)) > 0.0_wp .and. .not. hardening%is_viscoplastic) &
      call report_field(deck, cursor, card, 5, &
      'is a rate form that this version does not have (0 scales the yield stress with the ' &
      //'total strain rate)')
    hardening%curve = max(card%i(3), 0)
    hardening%rate_curve = max(card%i(4), 0)
    if (.not. any(card%bad(1:2))) then
      hardening%rate_constant = card%r(1)
      hardening%rate_power = card%r(2)
    end if
    hardening%rate_place = place_t(card%line, 2, 1)
    hardening%curve_place = place_t(card%line, 2, 3)
    hardening%rate_curve_place = place_t(card%line, 2, 4)
    hardening%form_place = place_t(card%line, 2, 5)
  end subroutine read_rates

  !> EPS and ES: as many points as there are up to the last that is not zero.
  subroutine read_points(deck, cursor, strains, stresses, hardening)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: strains, stresses
    type(raw_hardening_t), intent(inout) :: hardening
    integer :: k, n

    n = 1
    do k = 2, 8
      if (abs(strains%r(k)) > 0.0_wp .or. abs(stresses%r(k)) > 0.0_wp) n = k
    end do
    if (n < 2) call report_field(deck, cursor, strains, 2, &
      'ends the points, of which there must be two or more')
    if (abs(strains%r(1)) > 0.0_wp) call report_field(deck, cursor, strains, 1, &
      'is not 0: the first point is the initial yield stress')
    do k = 1, n
      if (.not. stresses%r(k) > 0.0_wp) call report_field(deck, cursor, stresses, k, &
        'is not a yield stress (more than 0)')
    end do
    do k = 2, n
      if (strains%r(k) <= strains%r(k - 1)) call report_field(deck, cursor, strains, k, &
        'is not beyond the point before it: plastic strains must increase')
    end do
    if (any(strains%bad) .or. any(stresses%bad)) return
    hardening%points%abscissa = strains%r(:n)
    hardening%points%ordinate = stresses%r(:n)
  end subroutine read_points

  !> SIGY and ETAN.
  subroutine read_line(deck, cursor, card, hardening)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_hardening_t), intent(inout) :: hardening

    if (card%r(5) <= 0.0_wp) call report_field(deck, cursor, card, 5, &
      'is not a yield stress (more than 0), and there is neither LCSS nor EPS and ES')
    call check_tangent_modulus(deck, cursor, card, &
      'is negative: a falling yield stress needs a curve')
    if (any(card%bad)) return
    hardening%points%abscissa = [0.0_wp]
    hardening%points%ordinate = [card%r(5)]
    hardening%modulus = card%r(3)*card%r(6)/(card%r(3) - card%r(6))
  end subroutine read_line

end module deck_hardening_m
