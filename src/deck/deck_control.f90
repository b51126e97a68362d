! SPDX-License-Identifier: MIT
!> *CONTROL_ cards.
module deck_control_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use controls_m, only : length_by_side, length_by_diagonal, contact_step_warns, contact_step_rules
  use deck_lines_m, only : deck_t, place_t, line_warning
  use deck_fields_m, only : card_t
  use deck_parameter_table_m, only : parameters_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, check_rest, report_field, reject_field
  use deck_implicit_m, only : take_implicit, take_dynamics, take_spectral_radius, take_solution, &
    take_automatic
  use deck_raw_m, only : raw_t
  use deck_part_m, only : hourglass_form, hourglass_coefficient, check_viscosity
  implicit none
  private
  public :: read_control, check_step

contains

  !> One *CONTROL_ keyword: its cards in order, then what they mean.
  subroutine read_control(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: cards(6)
    integer :: k

    call open_cursor(deck, i_block, cursor)
    do k = 1, cursor%n_card
      if (k == 3 .and. deck%blocks(i_block)%name == 'CONTROL_IMPLICIT_SOLUTION') then
        ! The card of strict tolerances comes with a negative DNORM alone.
        if (cards(2)%i(1) >= 0) cycle
      end if
      call next_card(deck, parameters, cursor, k, cards(k))
    end do
    call check_rest(deck, cursor)
    call warn_of_repetition(deck, i_block)
    select case (deck%blocks(i_block)%name)
    case ('CONTROL_TERMINATION')
      call take_termination(deck, cursor, cards(1), raw)
    case ('CONTROL_TIMESTEP')
      call take_timestep(deck, cursor, cards(1), raw)
    case ('CONTROL_HOURGLASS')
      call hourglass_form(deck, cursor, cards(1), 1, raw%hourglass_default%form)
      call hourglass_coefficient(deck, cursor, cards(1), 2, raw%hourglass_default%coefficient)
    case ('CONTROL_BULK_VISCOSITY')
      call take_bulk_viscosity(deck, cursor, cards(1), raw)
    case ('CONTROL_CONTACT')
      call take_contact(deck, cursor, cards, raw)
    case ('CONTROL_IMPLICIT_GENERAL')
      call take_implicit(deck, cursor, cards(1), raw)
    case ('CONTROL_IMPLICIT_DYNAMICS')
      call take_dynamics(deck, cursor, cards(1), raw)
    case ('CONTROL_IMPLICIT_SPECTRAL_RADIUS')
      call take_spectral_radius(deck, cursor, cards(1), raw)
    case ('CONTROL_IMPLICIT_SOLUTION')
      call take_solution(deck, cursor, cards(1), raw)
    case ('CONTROL_IMPLICIT_AUTO')
      call take_automatic(deck, cursor, cards(1), raw)
    case ('CONTROL_OUTPUT')
      if (cards(1)%i(7) < 0) call report_field(deck, cursor, cards(1), 7, 'is negative')
      raw%controls%output%status_interval = cards(1)%i(7)
    end select
  end subroutine read_control

  !> A control that is given again: the later one counts.
  subroutine warn_of_repetition(deck, i_block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    integer :: i

    do i = 1, i_block - 1
      if (deck%blocks(i)%name /= deck%blocks(i_block)%name) cycle
      call line_warning(deck, deck%blocks(i_block)%keyword, 'again'//to_text(i_block), &
        'is given again; this one counts')
      return
    end do
  end subroutine warn_of_repetition

  !> *CONTROL_TERMINATION.
  subroutine take_termination(deck, cursor, card, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw

    if (card%r(1) <= 0.0_wp .and. .not. raw%end_given) call report_field(deck, cursor, card, 1, &
      'is not an end time (more than 0)')
    if (card%i(2) < 0) call report_field(deck, cursor, card, 2, 'is negative')
    if (card%r(3) < 0.0_wp) call report_field(deck, cursor, card, 3, 'is negative')
    if (card%r(3) > 1.0_wp) call report_field(deck, cursor, card, 3, &
      'is not a share of the first step (at most 1): the run would end at once')
    if (card%r(4) < 0.0_wp) call report_field(deck, cursor, card, 4, 'is negative')
    if (card%i(6) < 0 .or. card%i(6) > 1) call report_field(deck, cursor, card, 6, &
      'is not 0 or 1 (stop after the initialisation)')
    raw%terminated = .true.
    raw%controls%end_time = card%r(1)
    raw%controls%end_cycle = card%i(2)
    raw%controls%dt_floor = card%r(3)
    raw%controls%energy_limit = card%r(4)
    raw%controls%check_only = card%i(6) == 1
  end subroutine take_termination

  !> *CONTROL_TIMESTEP.
  subroutine take_timestep(deck, cursor, card, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw
    logical :: given(6)
    integer :: k

    if (card%r(1) < 0.0_wp) call report_field(deck, cursor, card, 1, 'is negative')
    if (card%r(2) < 0.0_wp .and. .not. raw%scale_given) call report_field(deck, cursor, card, 2, &
      'is negative: the scale of the step is more than 0 (blank and 0 mean 0.9)')
    if (card%i(3) < 0 .or. card%i(3) > 1) call report_field(deck, cursor, card, 3, &
      'is not an element length rule (0 area over longest side, 1 area over longest diagonal)')
    given = [card%r(1) > 0.0_wp, card%r(2) > 0.0_wp, card%i(3) == 1, .false., .false., &
      card%i(6) /= 0]
    do k = 1, 6
      if (given(k)) raw%explicit_only = [raw%explicit_only, place_t(card%line, 1, k)]
    end do
    raw%controls%dt_initial = card%r(1)
    raw%controls%dt_scale = 0.9_wp
    if (card%r(2) > 0.0_wp) raw%controls%dt_scale = card%r(2)
    raw%controls%length_rule = merge(length_by_diagonal, length_by_side, card%i(3) == 1)
    raw%step_line = card%line
    raw%dt_curve = card%i(6)
    raw%dt_curve_place = place_t(line=card%line, card=1, field=6)
  end subroutine take_timestep

  !> Rules of the step, from the card or from the command line.
  subroutine check_step(deck, raw)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw

    if (raw%dt_curve < 0) call reject_field(deck, raw%dt_curve_place, 'is not a curve number')
    if (raw%controls%dt_scale > 1.0_wp .and. .not. raw%controls%implicit%is_on) &
      call line_warning(deck, merge(0, raw%step_line, raw%scale_given), 'tssfac', &
      'TSSFAC'//trim(merge(' on the command line', &
      '                    ', raw%scale_given))//' is above 1: the run may become unstable')
    if (raw%controls%dt_initial > 0.0_wp .and. raw%dt_curve > 0 .and. &
      .not. raw%controls%implicit%is_on) call line_warning(deck, raw%step_line, 'dtinit', &
      'DTINIT has no effect beside '//trim(merge('dt= on the command line', &
      'the curve LCTM         ', raw%step_given)))
  end subroutine check_step

  !> *CONTROL_BULK_VISCOSITY: off without the keyword; blank fields of it are LS-DYNA's defaults.
  subroutine take_bulk_viscosity(deck, cursor, card, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw
    integer :: k

    do k = 1, 2
      call check_viscosity(deck, cursor, card, k)
    end do
    if (card%i(3) < -1 .or. card%i(3) > 1) call report_field(deck, cursor, card, 3, &
      'is not a kind of bulk viscosity that this version has (1 standard)')
    raw%hourglass_default%quadratic = card%r(1)
    raw%hourglass_default%linear = card%r(2)
  end subroutine take_bulk_viscosity

  !> *CONTROL_CONTACT.
  subroutine take_contact(deck, cursor, cards, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    type(raw_t), intent(inout) :: raw

    if (cards(1)%r(1) < 0.0_wp) call report_field(deck, cursor, cards(1), 1, 'is negative')
    raw%controls%penalty_scale = 0.1_wp
    if (cards(1)%r(1) > 0.0_wp) raw%controls%penalty_scale = cards(1)%r(1)
    if (cards(2)%i(7) < contact_step_warns .or. cards(2)%i(7) > contact_step_rules) &
      call report_field(deck, cursor, cards(2), 7, 'is not 0, 1 or 2 (a warning where contact ' &
      //'needs a smaller step, no warning, a step that is stable with contact)')
    raw%controls%contact_step = cards(2)%i(7)
    if (cards(2)%i(7) /= 0) raw%explicit_only = [raw%explicit_only, place_t(cards(2)%line, 2, 7)]
  end subroutine take_contact

end module deck_control_m
