! SPDX-License-Identifier: MIT
!> Equations of state: pressure p (compression positive) by relative volume v = V/V0 and internal
!> energy per initial volume E, p = A(mu) + B(mu) E with mu = 1/v - 1.
module eos_m
  use kinds_m, only : wp
  implicit none
  private
  public :: eos_t, initial_stiffness, eos_logarithmic, eos_linear_polynomial, eos_gruneisen, &
    eos_by_law

  !> Kinds. Only the dispatcher of the equations of state asks for them.
  !> By law: the law of the material gives the pressure too, of all its strain.
  integer, parameter :: eos_logarithmic = 1, eos_linear_polynomial = 2, eos_gruneisen = 3, &
    eos_by_law = 4

  !> One *EOS, or what stands for it in a material with failure.
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

end module eos_m
