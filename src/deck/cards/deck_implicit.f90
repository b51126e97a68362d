! SPDX-License-Identifier: MIT
!> *CONTROL_IMPLICIT_ cards, and checks of the deck against the implicit method.
module deck_implicit_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use controls_m, only : implicit_t
  use hardenings_m, only : depends_on_rate
  use model_m, only : model_t
  use deck_control_m, only : control_cards
  use deck_ids_m, only : a_part, a_material
  use deck_lines_m, only : deck_t, blocks_of, line_error, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : report_field
  use deck_values_m, only : integer_of, real_of, is_blank
  implicit none
  private
  public :: read_implicit, check_implicit

  !> Default spectral radius at infinite frequency.
  real(wp), parameter :: default_radius = 0.8_wp

contains

  !> Read the cards of the implicit method and set its time integration.
  subroutine read_implicit(deck, implicit)
    type(deck_t), intent(inout) :: deck
    type(implicit_t), intent(inout) :: implicit
    type(card_t) :: cards(6)
    integer, allocatable :: blocks(:)
    real(wp), parameter :: round_off = 1.0e-9_wp
    real(wp) :: newmark(2), alpha, radius !! 0 = blank; a radius below 0 is not given
    real(wp) :: least
    integer :: i, line                    !! of *CONTROL_IMPLICIT_DYNAMICS

    newmark = 0.0_wp
    alpha = 0.0_wp
    radius = -1.0_wp
    line = 0
    blocks = blocks_of(deck, 'CONTROL_IMPLICIT_')
    do i = 1, size(blocks)
      call control_cards(deck, blocks(i), cards)
      select case (deck%blocks(blocks(i))%name)
      case ('CONTROL_IMPLICIT_GENERAL')
        implicit%is_on = integer_of(cards(1), 'IMFLAG') == 1
        implicit%dt = real_of(cards(1), 'DT0')
        if (implicit%is_on .and. implicit%dt <= 0.0_wp) call report_field(deck, cards(1), 'DT0', &
          'is not a step (more than 0)')
      case ('CONTROL_IMPLICIT_DYNAMICS')
        line = cards(1)%line
        implicit%is_dynamic = integer_of(cards(1), 'IMASS') == 1
        call read_newmark(deck, cards(1), newmark)
        alpha = real_of(cards(1), 'ALPHA')
      case ('CONTROL_IMPLICIT_SPECTRAL_RADIUS')
        radius = real_of(cards(1), 'RHO')
        if (is_blank(cards(1), 'RHO')) call report_field(deck, cards(1), 'RHO', &
          'is not a spectral radius (0 to 1)')
      case ('CONTROL_IMPLICIT_SOLUTION')
        ! Full Newton: a new tangent in every iteration, whatever ILIMIT.
        implicit%is_linear = integer_of(cards(1), 'NSOLVR') == 1
        implicit%max_iteration = integer_of(cards(1), 'MAXREF')
        implicit%step_tolerance = real_of(cards(1), 'DCTOL')
        implicit%energy_tolerance = real_of(cards(1), 'ECTOL')
        implicit%residual_tolerance = real_of(cards(1), 'RCTOL')
        if (implicit%residual_tolerance >= 1.0e10_wp) implicit%residual_tolerance = 0.0_wp
        implicit%search_tolerance = real_of(cards(1), 'LSTOL')
      case ('CONTROL_IMPLICIT_AUTO')
        call read_automatic(deck, cards(1), implicit)
      end select
    end do
    if (.not. implicit%is_on) return
    call set_scheme(newmark, -alpha, radius, implicit)
    ! Only Newmark's method with parameters of the deck can be conditionally stable.
    least = 0.25_wp*(implicit%gamma + 0.5_wp)**2
    if (implicit%is_dynamic .and. implicit%beta < least*(1.0_wp - round_off)) call line_warning( &
      deck, line, 'newmark', 'Newmark''s method with GAMMA '//to_text(implicit%gamma) &
      //' and BETA '//to_text(implicit%beta)//' is conditionally stable; for unconditional ' &
      //'stability BETA must be at least (GAMMA + 1/2)^2/4 = '//to_text(least))
  end subroutine read_implicit

  !> GAMMA and BETA of *CONTROL_IMPLICIT_DYNAMICS: Newmark's method where they are not 0.
  subroutine read_newmark(deck, card, newmark)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    real(wp), intent(out) :: newmark(2)
    character(5), parameter :: names(2) = ['GAMMA', 'BETA '], leasts(2) = ['0.5  ', '0.25 ']
    real(wp), parameter :: least(2) = [0.5_wp, 0.25_wp], most = 10.0_wp
    integer :: k

    do k = 1, 2
      newmark(k) = real_of(card, names(k))
      if (newmark(k) < 0.0_wp .or. (newmark(k) > 0.0_wp .and. newmark(k) < least(k))) call &
        report_field(deck, card, names(k), 'is not a stable '//trim(names(k))//' of Newmark''s ' &
        //'method ('//trim(leasts(k))//' or more)')
      if (newmark(k) > most) call report_field(deck, card, names(k), &
        'is not a parameter of Newmark''s method (at most 10)')
    end do
  end subroutine read_newmark

  !> *CONTROL_IMPLICIT_AUTO.
  subroutine read_automatic(deck, card, implicit)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(implicit_t), intent(inout) :: implicit
    integer, parameter :: many = 1000000

    implicit%is_automatic = integer_of(card, 'IAUTO') == 1
    ! Their sum must not overflow.
    implicit%best_iterations = min(integer_of(card, 'ITEOPT'), many)
    implicit%iteration_window = min(integer_of(card, 'ITEWIN'), many)
    implicit%dt_least = real_of(card, 'DTMIN')
    implicit%dt_most = real_of(card, 'DTMAX')
    if (implicit%dt_most > 0.0_wp .and. implicit%dt_least > implicit%dt_most) call report_field( &
      deck, card, 'DTMAX', 'is below the smallest step DTMIN = '//to_text(implicit%dt_least))
  end subroutine read_automatic

  !> Set the parameters of the time integration (Chung & Hulbert 1993, eqs. 17, 20, 25; HHT with
  !> alpha_f = -ALPHA; Newmark). *CONTROL_IMPLICIT_SPECTRAL_RADIUS prevails.
  subroutine set_scheme(newmark, hht, radius, implicit)
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
  end subroutine set_scheme

  !> Report bulk viscosity, and material laws without a tangent: rate effects, heat, energy,
  !> failure.
  subroutine check_implicit(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    character(:), allocatable :: reason
    integer :: i

    do i = 1, size(model%parts)
      associate (part => model%parts(i))
        if (part%hourglass%quadratic > 0.0_wp .or. part%hourglass%linear > 0.0_wp) &
          call line_error(deck, deck%maps(a_part)%lines(i), 'part '//to_text(part%id)//' has ' &
          //'bulk viscosity (*CONTROL_BULK_VISCOSITY or *HOURGLASS), which the implicit method ' &
          //'does not have')
      end associate
    end do
    do i = 1, size(model%materials)
      associate (material => model%materials(i))
        reason = ''
        if (allocated(material%rubber)) then
          if (material%rubber%n_term > 0) reason = 'the law of Ogden'
        else if (allocated(material%flow)) then
          reason = 'a flow stress of Johnson and Cook'
        else if (material%failure_strain < huge(1.0_wp)) then
          reason = 'a plastic strain at failure'
        else if (material%decay >= 0.0_wp) then
          reason = 'the law of viscoelasticity'
        else if (allocated(material%crush)) then
          reason = 'the law of a crushable foam'
        else if ((allocated(material%eos) .or. material%needs_eos) .and. .not. &
          material%is_plane_stress) then
          reason = 'an equation of state'
        end if
        if (len(reason) > 0) call refuse(reason)
        if (.not. allocated(material%curve)) cycle
        if (depends_on_rate(material%curve)) call refuse( &
          'a yield stress that depends on the strain rate (C, LCSR or a table)')
      end associate
    end do

  contains

    !> Report an error.
    subroutine refuse(what)
      character(*), intent(in) :: what

      call line_error(deck, deck%maps(a_material)%lines(i), 'material ' &
        //to_text(model%materials(i)%id)//' has '//what &
        //', which the implicit method does not have')
    end subroutine refuse

  end subroutine check_implicit

end module deck_implicit_m
