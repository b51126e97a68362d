! SPDX-License-Identifier: MIT
!> Volumetric response sigma_vol = K ln(J) (Kang, Lee & Shin 2023 print the pressure, A1).
module volumetric_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  implicit none
  private
  public :: volumetric_stress, volumetric_energy, log_ratio, atanh_series, largest_size

contains

  !> Largest absolute value of a chunk.
  pure function largest_size(values) result(largest)
    real(wp), intent(in) :: values(chunk_size)
    real(wp) :: largest
    integer :: i

    largest = 0.0_wp
    !$omp simd reduction(max : largest)
    do i = 1, chunk_size
      largest = max(largest, abs(values(i)))
    end do
  end function largest_size

  !> K ln(1 + stretch) for a chunk. ln(J) = 2 atanh(z), z = s/(2 + s), as a series where
  !> |z| <= 0.1 (its truncation is below round-off there), the library's logarithm for a chunk
  !> with any element outside.
  pure subroutine volumetric_stress(bulk, stretch, stress)
    real(wp), intent(in) :: bulk
    real(wp), intent(in) :: stretch(chunk_size)  !! J - 1
    real(wp), intent(out) :: stress(chunk_size)
    real(wp) :: z, largest
    integer :: i

    largest = 0.0_wp
    !$omp simd private(z) reduction(max : largest)
    do i = 1, chunk_size
      z = stretch(i)/(2.0_wp + stretch(i))
      largest = max(largest, abs(z))
      stress(i) = 2.0_wp*bulk*atanh_series(z)
    end do
    if (largest <= 0.1_wp) return
    do i = 1, chunk_size
      stress(i) = bulk*log_ratio(stretch(i))
    end do
  end subroutine volumetric_stress

  !> z + z^3/3 + ... + z^15/15.
  pure elemental function atanh_series(z) result(y)
    !$omp declare simd(atanh_series)
    real(wp), intent(in) :: z
    real(wp) :: y
    real(wp) :: w

    w = z*z
    y = z + z*w*(1.0_wp/3.0_wp + w*(1.0_wp/5.0_wp + w*(1.0_wp/7.0_wp + w*(1.0_wp/9.0_wp &
      + w*(1.0_wp/11.0_wp + w*(1.0_wp/13.0_wp + w*(1.0_wp/15.0_wp)))))))
  end function atanh_series

  !> ln(1 + stretch) to full relative precision; minus the largest number where the volume is gone
  !> (the driver stops on the volume, not on this value).
  pure elemental function log_ratio(stretch) result(y)
    real(wp), intent(in) :: stretch
    real(wp) :: y
    real(wp) :: z

    if (.not. 1.0_wp + stretch > 0.0_wp) then
      y = -huge(1.0_wp)**0.25_wp
      return
    end if
    z = stretch/(2.0_wp + stretch)
    if (abs(z) <= 0.1_wp) then
      y = 2.0_wp*atanh_series(z)
    else
      y = log(1.0_wp + stretch)
    end if
  end function log_ratio

  !> Energy per initial volume of the volumetric stress: K (J ln J - J + 1), the integral of
  !> K ln(J) dJ.
  pure elemental function volumetric_energy(bulk, stretch) result(energy)
    real(wp), intent(in) :: bulk
    real(wp), intent(in) :: stretch
    real(wp) :: energy

    if (abs(stretch) < 1.0e-3_wp) then
      ! Series where the closed form would lose its digits.
      energy = bulk*stretch**2*(1.0_wp/2.0_wp - stretch*(1.0_wp/6.0_wp - stretch*(1.0_wp/12.0_wp &
        - stretch*(1.0_wp/20.0_wp - stretch/30.0_wp))))
    else
      energy = bulk*((1.0_wp + stretch)*log_ratio(stretch) - stretch)
    end if
  end function volumetric_energy

end module volumetric_m
