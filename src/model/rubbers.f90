! SPDX-License-Identifier: MIT
!> Constants of rubbers: W = A (I - 3) + B (II - 3) + U(J), I and II the invariants of C = F^T F.
module rubbers_m
  use kinds_m, only : wp
  implicit none
  private
  public :: rubber_t, mooney_rivlin, blatz_ko, blatz_ko_poisson

  !> Poisson's ratio of the law of Blatz and Ko.
  real(wp), parameter :: blatz_ko_poisson = 0.463_wp

  !> Of one material.
  type :: rubber_t
    real(wp) :: a = 0.0_wp, b = 0.0_wp !! A and B
    real(wp) :: c = 0.0_wp, d = 0.0_wp !! Mooney & Rivlin: U = C (J^-4 - 1) + D (J^2 - 1)^2
    real(wp) :: exponent = 0.0_wp      !! Blatz & Ko: U = 2A (J^-exponent - 1)/exponent
  end type rubber_t

contains

  !> Mooney and Rivlin: C so that the undeformed body is free of stress, D for Poisson's ratio.
  pure function mooney_rivlin(a, b, poisson) result(rubber)
    real(wp), intent(in) :: a, b, poisson
    type(rubber_t) :: rubber

    rubber%a = a
    rubber%b = b
    rubber%c = 0.5_wp*a + b
    rubber%d = (a*(5.0_wp*poisson - 2.0_wp) + b*(11.0_wp*poisson - 5.0_wp)) &
      /(2.0_wp*(1.0_wp - 2.0_wp*poisson))
  end function mooney_rivlin

  !> Blatz and Ko: B = 0.
  pure function blatz_ko(shear) result(rubber)
    real(wp), intent(in) :: shear
    type(rubber_t) :: rubber

    rubber%a = 0.5_wp*shear
    rubber%exponent = 2.0_wp*blatz_ko_poisson/(1.0_wp - 2.0_wp*blatz_ko_poisson)
  end function blatz_ko

end module rubbers_m
