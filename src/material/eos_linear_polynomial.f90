! SPDX-License-Identifier: MIT
!> p = C0 + C1 mu + C2 mu^2 + C3 mu^3 + (C4 + C5 mu + C6 mu^2) E; C2 and C6 count in compression.
module eos_linear_polynomial_m
  use eos_chunk_m, only : eos_chunk_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  implicit none
  private
  public :: form_linear_polynomial

contains

  !> At v = 1 + stretch.
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

end module eos_linear_polynomial_m
