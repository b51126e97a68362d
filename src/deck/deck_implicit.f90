! SPDX-License-Identifier: MIT
!> *CONTROL_IMPLICIT_ cards.
module deck_implicit_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use controls_m, only : implicit_t
  use deck_lines_m, only : deck_t, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, report_field
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: take_implicit, take_dynamics, take_spectral_radius, take_solution, take_automatic, &
    settle_scheme, check_scheme

  !> Spectral radius at infinite frequency where the deck gives none.
  real(wp), parameter :: default_radius = 0.8_wp

contains

  !> *CONTROL_IMPLICIT_GENERAL.
  subroutine take_implicit(deck, cursor, card, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw

    if (card%i(1) < 0 .or. card%i(1) > 1) call report_field(deck, cursor, card, 1, &
      'is not a method that this version has (0 explicit, 1 implicit; no switching)')
    raw%controls%implicit%is_on = card%i(1) == 1
    if (card%i(1) == 1 .and. card%r(2) <= 0.0_wp .and. .not. raw%step_given) &
      call report_field(deck, cursor, card, 2, 'is not a step (more than 0)')
    raw%controls%implicit%dt = card%r(2)
  end subroutine take_implicit

  !> *CONTROL_IMPLICIT_DYNAMICS: GAMMA and BETA ask for Newmark's method, ALPHA below 0 for HHT;
  !> blank fields leave the generalised-alpha method with its spectral radius.
  subroutine take_dynamics(deck, cursor, card, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw
    real(wp), parameter :: most = 10.0_wp
    integer :: k

    if (card%i(1) < 0 .or. card%i(1) > 1) call report_field(deck, cursor, card, 1, &
      'is not 0 (static) or 1 (dynamic)')
    raw%controls%implicit%is_dynamic = card%i(1) == 1
    if (card%r(2) < 0.0_wp .or. (card%r(2) > 0.0_wp .and. card%r(2) < 0.5_wp)) call report_field( &
      deck, cursor, card, 2, 'is not a stable GAMMA of Newmark''s method (0.5 or more)')
    do k = 2, 3
      if (card%r(k) > most) call report_field(deck, cursor, card, k, &
        'is not a parameter of Newmark''s method (at most 10)')
    end do
    if (card%r(3) < 0.0_wp .or. (card%r(3) > 0.0_wp .and. card%r(3) < 0.25_wp)) call report_field( &
      deck, cursor, card, 3, 'is not a stable BETA of Newmark''s method (0.25 or more)')
    if (card%r(8) > 0.0_wp .or. card%r(8) < -1.0_wp/3.0_wp) call report_field(deck, cursor, card, &
      8, 'is not ALPHA of the HHT method (-1/3 to 0); Bathe''s method is not supported')
    raw%newmark_line = card%line
    raw%newmark = [card%r(2), card%r(3)]
    raw%hht = -card%r(8)
  end subroutine take_dynamics

  !> *CONTROL_IMPLICIT_SPECTRAL_RADIUS, our own keyword.
  subroutine take_spectral_radius(deck, cursor, card, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw

    if (card%blank(1) .or. card%r(1) < 0.0_wp .or. card%r(1) > 1.0_wp) call report_field(deck, &
      cursor, card, 1, 'is not a spectral radius (0 to 1)')
    raw%spectral_radius = card%r(1)
  end subroutine take_spectral_radius

  !> *CONTROL_IMPLICIT_SOLUTION. Every iteration forms the tangent anew (full
  !> Newton), whatever ILIMIT.
  subroutine take_solution(deck, cursor, card, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw
    integer :: k

    if (card%i(1) /= 1 .and. card%i(1) /= 12 .and. card%i(1) /= 0) call report_field(deck, cursor, &
      card, 1, 'is not a solution method that this version has (1 linear, 12 Newton)')
    if (card%i(3) < 0) call report_field(deck, cursor, card, 3, 'is negative')
    do k = 4, 7
      if (card%r(k) < 0.0_wp) call report_field(deck, cursor, card, k, 'is negative')
    end do
    associate (implicit => raw%controls%implicit)
      implicit%is_linear = card%i(1) == 1
      if (card%i(3) > 0) implicit%max_iteration = card%i(3)
      implicit%step_tolerance = card%r(4)
      if (card%r(5) > 0.0_wp) implicit%energy_tolerance = card%r(5)
      implicit%residual_tolerance = merge(0.0_wp, card%r(6), card%r(6) >= 1.0e10_wp)
      if (card%r(7) > 0.0_wp) implicit%search_tolerance = card%r(7)
    end associate
  end subroutine take_solution

  !> *CONTROL_IMPLICIT_AUTO.
  subroutine take_automatic(deck, cursor, card, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw
    integer, parameter :: many = 1000000

    if (card%i(1) < 0 .or. card%i(1) > 1) call report_field(deck, cursor, card, 1, &
      'is not 0 (constant step) or 1 (automatic)')
    if (card%i(2) < 1) call report_field(deck, cursor, card, 2, 'is not a number of iterations')
    if (card%i(3) < 0) call report_field(deck, cursor, card, 3, 'is negative')
    if (card%r(4) < 0.0_wp) call report_field(deck, cursor, card, 4, 'is negative')
    if (card%r(5) < 0.0_wp) call report_field(deck, cursor, card, 5, &
      'is negative: a curve of largest steps is not supported')
    if (card%r(5) > 0.0_wp .and. card%r(4) > card%r(5)) call report_field(deck, cursor, card, 5, &
      'is below the smallest step DTMIN = '//to_text(card%r(4)))
    associate (implicit => raw%controls%implicit)
      implicit%is_automatic = card%i(1) == 1
      ! Their sum must stay a whole number.
      implicit%best_iterations = min(card%i(2), many)
      implicit%iteration_window = min(card%i(3), many)
      implicit%dt_least = card%r(4)
      implicit%dt_most = card%r(5)
    end associate
  end subroutine take_automatic

  !> Parameters of the time integration from what the cards gave (Chung & Hulbert 1993, eqs. 17, 20,
  !> 25; HHT with alpha_f = -ALPHA; Newmark). A spectral radius of our own keyword comes first.
  subroutine settle_scheme(newmark, hht, radius, implicit)
    real(wp), intent(in) :: newmark(2) !! GAMMA, BETA, 0 where blank
    real(wp), intent(in) :: hht        !! -ALPHA
    real(wp), intent(in) :: radius     !! below 0 where not given
    type(implicit_t), intent(inout) :: implicit
    real(wp) :: rho

    if (radius < 0.0_wp .and. any(newmark > 0.0_wp)) then
      if (newmark(1) > 0.0_wp) implicit%gamma = newmark(1)
      if (newmark(2) > 0.0_wp) implicit%beta = newmark(2)
      implicit%scheme = 'Newmark, gamma '//to_text(implicit%gamma)//', beta ' &
        //to_text(implicit%beta)
      return
    end if
    if (radius < 0.0_wp .and. hht > 0.0_wp) then
      implicit%alpha_m = 0.0_wp
      implicit%alpha_f = hht
      implicit%scheme = 'HHT, alpha '//to_text(-hht)
    else
      rho = merge(radius, default_radius, radius >= 0.0_wp)
      implicit%alpha_m = (2.0_wp*rho - 1.0_wp)/(rho + 1.0_wp)
      implicit%alpha_f = rho/(rho + 1.0_wp)
      implicit%scheme = 'generalised-alpha, spectral radius '//to_text(rho)
    end if
    implicit%gamma = 0.5_wp - implicit%alpha_m + implicit%alpha_f
    implicit%beta = 0.25_wp*(1.0_wp - implicit%alpha_m + implicit%alpha_f)**2
  end subroutine settle_scheme

  !> A scheme that is not stable at every step: beta below (gamma + 1/2)^2/4, which only Newmark's
  !> method with parameters of the deck can have.
  subroutine check_scheme(deck, line, implicit)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line       !! of *CONTROL_IMPLICIT_DYNAMICS
    type(implicit_t), intent(in) :: implicit
    real(wp), parameter :: round_off = 1.0e-9_wp
    real(wp) :: least

    if (.not. (implicit%is_on .and. implicit%is_dynamic)) return
    least = 0.25_wp*(implicit%gamma + 0.5_wp)**2
    if (implicit%beta >= least*(1.0_wp - round_off)) return
    call line_warning(deck, line, 'newmark', 'Newmark''s method with GAMMA ' &
      //to_text(implicit%gamma)//' and BETA '//to_text(implicit%beta)//' is stable for small ' &
      //'steps only: for all steps BETA must be at least (GAMMA + 1/2)^2/4 = '//to_text(least))
  end subroutine check_scheme

end module deck_implicit_m
