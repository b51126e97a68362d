! SPDX-License-Identifier: MIT
!> The one place that asks for the kind of the equation of state, and the energy that goes with it.
module eos_dispatch_m
  use eos_chunk_m, only : eos_chunk_t
  use eos_gruneisen_m, only : form_gruneisen
  use eos_linear_polynomial_m, only : form_linear_polynomial
  use eos_logarithmic_m, only : form_logarithmic
  use eos_m, only : eos_t, eos_logarithmic, eos_linear_polynomial, eos_gruneisen
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  implicit none
  private
  public :: form_eos, advance_energy, find_stiffness

contains

  !> A and B of p = A + B E at v = 1 + stretch, and their derivatives.
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

end module eos_dispatch_m
