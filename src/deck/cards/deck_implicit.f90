! SPDX-License-Identifier: MIT
!> *CONTROL_IMPLICIT_ cards.
module deck_implicit_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use controls_m, only : implicit_t
  use deck_lines_m, only : deck_t, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : report_field
  use deck_values_m, only : integer_of, real_of
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: take_implicit, take_dynamics, take_solution, take_automatic, settle_scheme, check_scheme

  !> Spectral radius at infinite frequency where the deck gives none.
  real(wp), parameter :: default_radius = 0.8_wp

contains

  !> *CONTROL_IMPLICIT_GENERAL.
  subroutine take_implicit(deck, card, raw)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw

    raw%controls%implicit%is_on = integer_of(card, 'IMFLAG') == 1
    raw%controls%implicit%dt = real_of(card, 'DT0')
    if (raw%controls%implicit%is_on .and. raw%controls%implicit%dt <= 0.0_wp) call report_field( &
      deck, card, 'DT0', 'is not a step (more than 0)')
  end subroutine take_implicit

  !> *CONTROL_IMPLICIT_DYNAMICS: GAMMA and BETA ask for Newmark's method, ALPHA below 0 for HHT;
  !> blank fields leave the generalised-alpha method with its spectral radius.
  subroutine take_dynamics(deck, card, raw)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(raw_t), intent(inout) :: raw
    real(wp), parameter :: most = 10.0_wp
    character(*), parameter :: too_large = 'is not a parameter of Newmark''s method (at most 10)'
    real(wp) :: gamma, beta, alpha

    gamma = real_of(card, 'GAMMA')
    beta = real_of(card, 'BETA')
    alpha = real_of(card, 'ALPHA')
    raw%controls%implicit%is_dynamic = integer_of(card, 'IMASS') == 1
    if (gamma < 0.0_wp .or. (gamma > 0.0_wp .and. gamma < 0.5_wp)) call report_field(deck, &
      card, 'GAMMA', 'is not a stable GAMMA of Newmark''s method (0.5 or more)')
    if (gamma > most) call report_field(deck, card, 'GAMMA', too_large)
    if (beta > most) call report_field(deck, card, 'BETA', too_large)
    if (beta < 0.0_wp .or. (beta > 0.0_wp .and. beta < 0.25_wp)) call report_field(deck, &
      card, 'BETA', 'is not a stable BETA of Newmark''s method (0.25 or more)')
    raw%newmark_line = card%line
    raw%newmark = [gamma, beta]
    raw%hht = -alpha
  end subroutine take_dynamics

  !> *CONTROL_IMPLICIT_SOLUTION. Every iteration forms the tangent anew (full Newton), whatever
  !> ILIMIT.
  subroutine take_solution(card, implicit)
    type(card_t), intent(in) :: card
    type(implicit_t), intent(inout) :: implicit

    implicit%is_linear = integer_of(card, 'NSOLVR') == 1
    implicit%max_iteration = integer_of(card, 'MAXREF')
    implicit%step_tolerance = real_of(card, 'DCTOL')
    implicit%energy_tolerance = real_of(card, 'ECTOL')
    implicit%residual_tolerance = real_of(card, 'RCTOL')
    if (implicit%residual_tolerance >= 1.0e10_wp) implicit%residual_tolerance = 0.0_wp
    implicit%search_tolerance = real_of(card, 'LSTOL')
  end subroutine take_solution

  !> *CONTROL_IMPLICIT_AUTO.
  subroutine take_automatic(deck, card, implicit)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(implicit_t), intent(inout) :: implicit
    integer, parameter :: many = 1000000

    implicit%is_automatic = integer_of(card, 'IAUTO') == 1
    ! Their sum must stay a whole number.
    implicit%best_iterations = min(integer_of(card, 'ITEOPT'), many)
    implicit%iteration_window = min(integer_of(card, 'ITEWIN'), many)
    implicit%dt_least = real_of(card, 'DTMIN')
    implicit%dt_most = real_of(card, 'DTMAX')
    if (implicit%dt_most > 0.0_wp .and. implicit%dt_least > implicit%dt_most) call report_field( &
      deck, card, 'DTMAX', 'is below the smallest step DTMIN = '//to_text(implicit%dt_least))
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
