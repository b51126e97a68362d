! SPDX-License-Identifier: MIT
!> A fluid: the deviator is that of its viscosity, 2 mu dev(D), and none without.
module material_null_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: update_null

contains

  !> Deviator of the rate of the step.
  pure subroutine update_null(viscosity, chunk)
    real(wp), intent(in) :: viscosity             !! mu, Pa s
    type(stress_chunk_t), intent(inout) :: chunk  !! increments in, deviator and work out
    real(wp) :: factor, third, oxx, oyy, oxy
    integer :: i

    factor = 0.0_wp
    if (chunk%dt > 0.0_wp) factor = 2.0_wp*viscosity/chunk%dt
    !$omp simd private(third, oxx, oyy, oxy)
    do i = 1, chunk_size
      third = (1.0_wp/3.0_wp)*(chunk%dxx(i) + chunk%dyy(i))
      oxx = chunk%sxx(i)
      oyy = chunk%syy(i)
      oxy = chunk%sxy(i)
      chunk%sxx(i) = factor*(chunk%dxx(i) - third)
      chunk%syy(i) = factor*(chunk%dyy(i) - third)
      chunk%sxy(i) = factor*chunk%dxy(i)
      chunk%work(i) = 0.5_wp*((chunk%sxx(i) + oxx)*chunk%dxx(i) &
        + (chunk%syy(i) + oyy)*chunk%dyy(i)) + (chunk%sxy(i) + oxy)*chunk%dxy(i)
    end do
  end subroutine update_null

end module material_null_m
