! SPDX-License-Identifier: MIT
!> Mie and Gruneisen's pressure about a Hugoniot given by the shock velocity
!> U = C + S1 u + S2 (u/U) u + S3 (u/U)^2 u:
!>   mu > 0: A = rho0 C^2 mu (1 + (1 - gamma/2) mu - a/2 mu^2)/d^2,
!>           d = 1 - (S1 - 1) mu - S2 mu^2/(1 + mu) - S3 mu^3/(1 + mu)^2
!>   else:   A = rho0 C^2 mu;   B = gamma + a mu.
module eos_gruneisen_m
  use eos_chunk_m, only : eos_chunk_t
  use eos_m, only : eos_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  implicit none
  private
  public :: form_gruneisen

contains

  !> At v = 1 + stretch.
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

end module eos_gruneisen_m
