! SPDX-License-Identifier: MIT
!> p = -K ln(v), without energy: the pressure of laws that have no equation of state.
module eos_logarithmic_m
  use eos_chunk_m, only : eos_chunk_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use vector_functions_m, only : form_log_ratios
  implicit none
  private
  public :: form_logarithmic

contains

  !> At v = 1 + stretch.
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

end module eos_logarithmic_m
