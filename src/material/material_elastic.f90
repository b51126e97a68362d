! SPDX-License-Identifier: MIT
!> Elastic deviator: Jaumann rate, s* = Q s Q^T + 2 G dev(D) dt (Kang, Lee & Shin 2023, A4); and the
!> deviator of a fluid.
module material_elastic_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: update_elastic, update_null

contains

  !> Update the deviator of a chunk and its work (trapezoidal rule).
  pure subroutine update_elastic(shear, chunk)
    real(wp), intent(in) :: shear              !! G
    type(stress_chunk_t), intent(inout) :: chunk !! increments in, deviator in and out, work out
    real(wp) :: third, exx, eyy, oxx, oyy, oxy
    integer :: i

    !$omp simd private(third, exx, eyy, oxx, oyy, oxy)
    do i = 1, chunk_size
      third = (1.0_wp/3.0_wp)*(chunk%dxx(i) + chunk%dyy(i))
      exx = chunk%dxx(i) - third
      eyy = chunk%dyy(i) - third
      oxx = chunk%sxx(i)
      oyy = chunk%syy(i)
      oxy = chunk%sxy(i)
      chunk%sxx(i) = oxx + 2.0_wp*shear*exx
      chunk%syy(i) = oyy + 2.0_wp*shear*eyy
      chunk%sxy(i) = oxy + 2.0_wp*shear*chunk%dxy(i)
      ! dev(D) and D do the same work on a deviator; D_zz = 0 spares the zz term.
      chunk%work(i) = 0.5_wp*((chunk%sxx(i) + oxx)*chunk%dxx(i) &
        + (chunk%syy(i) + oyy)*chunk%dyy(i)) + (chunk%sxy(i) + oxy)*chunk%dxy(i)
    end do
  end subroutine update_elastic

  !> Update the deviator of a fluid, 2 mu dev(D); zero without viscosity.
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

end module material_elastic_m
