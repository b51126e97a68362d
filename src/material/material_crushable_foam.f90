! SPDX-License-Identifier: MIT
!> Crushable foam: an elastic step of the whole stress, whose principal values are then limited to
!> the curve of yield stress against 1 - V/V0 in compression and to the cut-off in tension.
module material_crushable_foam_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : material_t
  use stress_chunk_m, only : stress_chunk_t
  use vector_functions_m, only : form_log_ratios
  implicit none
  private
  public :: update_crushable_foam

  !> Largest relative reduction of a volume in a step; the run stops before.
  real(wp), parameter :: least = -1.0_wp + 1.0e-12_wp

contains

  !> Update the stress of a chunk; work of the deviator by the trapezoidal rule.
  pure subroutine update_crushable_foam(material, chunk, mean)
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp), intent(inout) :: mean(chunk_size) !! mean stress of the point, start in, end out
    real(wp), dimension(chunk_size) :: crush, share, growth
    real(wp) :: third, push, oxx, oyy, oxy, middle, root, half, xy, xx, yy, zz
    real(wp) :: width, slope, from
    integer :: i, k

    ! Yield stress: a polygon in 1 - V/V0, end values outside.
    crush = material%crush%ordinate(1)
    do k = 1, size(material%crush%abscissa) - 1
      width = material%crush%abscissa(k + 1) - material%crush%abscissa(k)
      slope = (material%crush%ordinate(k + 1) - material%crush%ordinate(k))/width
      from = material%crush%abscissa(k)
      !$omp simd
      do i = 1, chunk_size
        crush(i) = crush(i) + slope*max(0.0_wp, min(width, -chunk%stretch(i) - from))
      end do
    end do
    ! ln(J1/J0) = ln(1 + (J1 - J0)/J0).
    share = max(least, (chunk%stretch - chunk%start_stretch)/(1.0_wp + chunk%start_stretch))
    call form_log_ratios(chunk_size, share, growth)
    !$omp simd private(third, push, oxx, oyy, oxy, middle, root, half, xy, xx, yy, zz)
    do i = 1, chunk_size
      third = (1.0_wp/3.0_wp)*(chunk%dxx(i) + chunk%dyy(i))
      push = mean(i) + material%bulk*growth(i)
      oxx = chunk%sxx(i)
      oyy = chunk%syy(i)
      oxy = chunk%sxy(i)
      xx = push + oxx + 2.0_wp*material%shear*(chunk%dxx(i) - third)
      yy = push + oyy + 2.0_wp*material%shear*(chunk%dyy(i) - third)
      zz = push - (oxx + oyy) - 2.0_wp*material%shear*third
      xy = oxy + 2.0_wp*material%shear*chunk%dxy(i)
      ! Principal values are limited, their axes stay.
      middle = 0.5_wp*(xx + yy)
      half = 0.5_wp*(xx - yy)
      root = sqrt(half*half + xy*xy)
      xx = max(-crush(i), min(material%tension, middle + root))
      yy = max(-crush(i), min(material%tension, middle - root))
      zz = max(-crush(i), min(material%tension, zz))
      middle = 0.5_wp*(xx + yy)
      root = 0.5_wp*(xx - yy)/max(root, tiny(1.0_wp))
      mean(i) = (xx + yy + zz)*(1.0_wp/3.0_wp)
      chunk%sxx(i) = middle + root*half - mean(i)
      chunk%syy(i) = middle - root*half - mean(i)
      chunk%sxy(i) = root*xy
      chunk%work(i) = 0.5_wp*((chunk%sxx(i) + oxx)*chunk%dxx(i) &
        + (chunk%syy(i) + oyy)*chunk%dyy(i)) + (chunk%sxy(i) + oxy)*chunk%dxy(i)
    end do
    chunk%mean = mean
    chunk%bulk = material%bulk
    chunk%shear = material%shear
  end subroutine update_crushable_foam

end module material_crushable_foam_m
