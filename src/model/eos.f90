! SPDX-License-Identifier: MIT
!> Equations of state p = A(mu) + B(mu) E: pressure p (compression positive) from mu = 1/v - 1 with
!> the relative volume v = V/V0, and from the internal energy per initial volume E.
module eos_m
  use kinds_m, only : wp
  implicit none
  private
  public :: eos_t, initial_stiffness, initial_pressure, asymptote, &
    eos_logarithmic, eos_linear_polynomial, eos_gruneisen, eos_by_law

  !> Kinds, known to the dispatcher of the equations of state only. By law: the material law gives
  !> stress and pressure from the total strain.
  integer, parameter :: eos_logarithmic = 1, eos_linear_polynomial = 2, eos_gruneisen = 3, &
    eos_by_law = 4

  !> Denominator of Gruneisen's equation from which on its pressure, proportional to the inverse
  !> square, is treated as unbounded.
  real(wp), parameter :: least_denominator = 0.1_wp

  !> One *EOS, or the internal one of a material with failure.
  type :: eos_t
    integer :: id = 0                 !! user id
    integer :: kind = eos_logarithmic !! one of the `eos_` constants
    real(wp) :: c(0:6) = 0.0_wp       !! C0 to C6 of the polynomial
    real(wp) :: stiffness = 0.0_wp    !! K of the logarithm, rho0 C^2 of Gruneisen, Pa
    real(wp) :: speed = 0.0_wp        !! C
    real(wp) :: s(3) = 0.0_wp         !! S1 to S3
    real(wp) :: gamma = 0.0_wp        !! Gruneisen's gamma at the start
    real(wp) :: correction = 0.0_wp   !! a
    real(wp) :: energy = 0.0_wp       !! E at the start, J per initial volume
    real(wp) :: datum = 0.0_wp        !! elastic energy of the initial pressure beyond `energy`, J
                                      !! per initial volume
    real(wp) :: least_ratio = 0.0_wp  !! V/V0 at which the pressure becomes unbounded
  end type eos_t

contains

  !> Adiabatic bulk modulus of the undeformed body: A' + B' E + B p at mu = 0.
  pure function initial_stiffness(eos) result(stiffness)
    type(eos_t), intent(in) :: eos
    real(wp) :: stiffness

    select case (eos%kind)
    case (eos_linear_polynomial)
      stiffness = eos%c(1) + eos%c(5)*eos%energy + eos%c(4)*(eos%c(0) + eos%c(4)*eos%energy)
    case (eos_gruneisen)
      stiffness = eos%stiffness + (eos%correction + eos%gamma**2)*eos%energy
    case default
      stiffness = eos%stiffness
    end select
  end function initial_stiffness

  !> A + B E at mu = 0.
  pure function initial_pressure(eos) result(pressure)
    type(eos_t), intent(in) :: eos
    real(wp) :: pressure

    select case (eos%kind)
    case (eos_linear_polynomial)
      pressure = eos%c(0) + eos%c(4)*eos%energy
    case (eos_gruneisen)
      pressure = eos%gamma*eos%energy
    case default
      pressure = 0.0_wp
    end select
  end function initial_pressure

  !> Volume bound of Gruneisen's equation: V/V0 at the smallest mu > 0 where its denominator
  !> (`form_gruneisen`) vanishes; 0 where it does not. With y = mu/(1 + mu) = 1 - v the denominator
  !> is (1 - S1 y - S2 y^2 - S3 y^3)/(1 - y).
  pure function asymptote(s) result(ratio)
    real(wp), intent(in) :: s(3) !! S1 to S3
    real(wp) :: ratio
    integer, parameter :: n = 10000
    real(wp) :: y
    integer :: i

    ratio = 0.0_wp
    do i = 1, n - 1
      y = real(i, wp)/n
      if (1.0_wp - y*(s(1) + y*(s(2) + y*s(3))) > least_denominator*(1.0_wp - y)) cycle
      ratio = 1.0_wp - y
      return
    end do
  end function asymptote

end module eos_m
