! SPDX-License-Identifier: MIT
!> Equations of state of one chunk, p = A + B E with mu = 1/v - 1, and the energy that goes with
!> them; the one place that asks for their kind.
module eos_dispatch_m
  use eos_m, only : eos_t, eos_logarithmic, eos_linear_polynomial, eos_gruneisen
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use vector_functions_m, only : form_log_ratios
  implicit none
  private
  public :: eos_chunk_t, form_eos, advance_energy, find_stiffness, form_gruneisen, &
    form_linear_polynomial

  !> Of one chunk at one volume.
  type :: eos_chunk_t
    real(wp), dimension(chunk_size) :: a, b             !! A (Pa) and B
    real(wp), dimension(chunk_size) :: a_slope, b_slope !! dA/dmu and dB/dmu
  end type eos_chunk_t

contains

  !> A and B at v = 1 + stretch, and their derivatives.
  pure subroutine form_eos(eos, stretch, state)
    type(eos_t), intent(in) :: eos
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state

    select case (eos%kind)
    case (eos_logarithmic)
      call form_logarithmic(eos%stiffness, stretch, state)
    case (eos_linear_polynomial)
      call form_linear_polynomial(eos%c, stretch, state)
    case (eos_gruneisen)
      call form_gruneisen(eos, stretch, state)
    end select
  end subroutine form_eos

  !> Pressure and energy at the end of a step from v0 to v1, both of the same instant:
  !>   E1 = E0 + heat - (p0 + p1)/2 (v1 - v0),  p1 = A1 + B1 E1,
  !> solved in closed form since p is linear in E. A pressure beyond a bound is the bound.
  pure subroutine advance_energy(state, growth, heat, least, most, energy, pressure)
    type(eos_chunk_t), intent(in) :: state         !! at the end of the step
    real(wp), intent(in) :: growth(chunk_size)     !! v1 - v0
    real(wp), intent(in) :: heat(chunk_size)       !! what else goes in, J per initial volume
    real(wp), intent(in) :: least(chunk_size), most(chunk_size) !! bounds of the pressure
    real(wp), intent(inout) :: energy(chunk_size), pressure(chunk_size)
    real(wp) :: start
    integer :: i

    !$omp simd private(start)
    do i = 1, chunk_size
      start = energy(i) + (heat(i) - 0.5_wp*pressure(i)*growth(i))
      pressure(i) = min(most(i), max(least(i), (state%a(i) + state%b(i)*start) &
        /(1.0_wp + 0.5_wp*state%b(i)*growth(i))))
      energy(i) = start - 0.5_wp*pressure(i)*growth(i)
    end do
  end subroutine advance_energy

  !> Adiabatic bulk modulus -v dp/dv of each slot, with dE = -p dv:
  !> (1 + mu)(A' + B' E + B p v^2); not below 0.
  pure subroutine find_stiffness(state, stretch, energy, pressure, stiffness)
    type(eos_chunk_t), intent(in) :: state
    real(wp), intent(in), dimension(chunk_size) :: stretch, energy, pressure
    real(wp), intent(out) :: stiffness(chunk_size)
    real(wp) :: v
    integer :: i

    !$omp simd private(v)
    do i = 1, chunk_size
      v = 1.0_wp + stretch(i)
      stiffness(i) = max(0.0_wp, (state%a_slope(i) + state%b_slope(i)*energy(i) &
        + state%b(i)*pressure(i)*v*v)/v)
    end do
  end subroutine find_stiffness

  !> Mie and Gruneisen's pressure about a Hugoniot given by the shock velocity
  !> U = C + S1 u + S2 (u/U) u + S3 (u/U)^2 u:
  !>   mu > 0: A = rho0 C^2 mu (1 + (1 - gamma/2) mu - a/2 mu^2)/d^2,
  !>           d = 1 - (S1 - 1) mu - S2 mu^2/(1 + mu) - S3 mu^3/(1 + mu)^2
  !>   else:   A = rho0 C^2 mu;   B = gamma + a mu.
  pure subroutine form_gruneisen(eos, stretch, state)
    type(eos_t), intent(in) :: eos
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state
    real(wp) :: mu, x, y, top, top_slope, low, low_slope, half
    integer :: i

    half = 0.5_wp*eos%correction
    !$omp simd private(mu, x, y, top, top_slope, low, low_slope)
    do i = 1, chunk_size
      mu = -stretch(i)/(1.0_wp + stretch(i))
      ! In expansion x = 0 leaves top = low = 1 and A = rho0 C^2 mu. y = x/(1 + x).
      x = max(0.0_wp, mu)
      y = x/(1.0_wp + x)
      top = 1.0_wp + x*((1.0_wp - 0.5_wp*eos%gamma) - half*x)
      top_slope = (1.0_wp - 0.5_wp*eos%gamma) - eos%correction*x
      low = 1.0_wp - x*((eos%s(1) - 1.0_wp) + y*(eos%s(2) + eos%s(3)*y))
      low_slope = -((eos%s(1) - 1.0_wp) + y*((2.0_wp - y)*eos%s(2) &
        + y*(3.0_wp - 2.0_wp*y)*eos%s(3)))
      state%a(i) = eos%stiffness*mu*top/(low*low)
      state%a_slope(i) = eos%stiffness*(top/(low*low) &
        + x*(top_slope*low - 2.0_wp*top*low_slope)/(low*low*low))
      state%b(i) = eos%gamma + eos%correction*mu
      state%b_slope(i) = eos%correction
    end do
  end subroutine form_gruneisen

  !> p = C0 + C1 mu + C2 mu^2 + C3 mu^3 + (C4 + C5 mu + C6 mu^2) E; C2 and C6 count in compression.
  pure subroutine form_linear_polynomial(c, stretch, state)
    real(wp), intent(in) :: c(0:6)
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state
    real(wp) :: mu, pressed
    integer :: i

    !$omp simd private(mu, pressed)
    do i = 1, chunk_size
      mu = -stretch(i)/(1.0_wp + stretch(i))
      pressed = max(0.0_wp, mu)
      state%a(i) = c(0) + mu*(c(1) + c(2)*pressed + c(3)*mu*mu)
      state%a_slope(i) = c(1) + 2.0_wp*c(2)*pressed + 3.0_wp*c(3)*mu*mu
      state%b(i) = c(4) + mu*(c(5) + c(6)*pressed)
      state%b_slope(i) = c(5) + 2.0_wp*c(6)*pressed
    end do
  end subroutine form_linear_polynomial

  !> p = -K ln(v), without energy: the pressure of laws that have no equation of state.
  pure subroutine form_logarithmic(stiffness, stretch, state)
    real(wp), intent(in) :: stiffness           !! K
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state
    real(wp), parameter :: least = -1.0_wp + epsilon(1.0_wp)
    real(wp), dimension(chunk_size) :: safe, logarithm
    integer :: i

    safe = max(least, stretch)
    call form_log_ratios(chunk_size, safe, logarithm)
    !$omp simd
    do i = 1, chunk_size
      state%a(i) = -stiffness*merge(logarithm(i), -huge(1.0_wp)**0.25_wp, stretch(i) > -1.0_wp)
      state%a_slope(i) = stiffness*(1.0_wp + stretch(i))
      state%b(i) = 0.0_wp
      state%b_slope(i) = 0.0_wp
    end do
  end subroutine form_logarithmic

end module eos_dispatch_m
