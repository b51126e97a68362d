! SPDX-License-Identifier: MIT
!> Volumetric response sigma_vol = K ln(J) (Kang, Lee & Shin 2023 print the pressure, A1), and
!> stresses of the rate of deformation: bulk viscosity (von Neumann & Richtmyer 1950, linear term of
!> Landshoff), compression only, and damping in proportion to stiffness (*DAMPING_PART_STIFFNESS):
!> the elastic law with the rate of deformation in place of the strain, times a retardation time of
!> each element, beside the stress (doc/theory/elements.md, "Stiffness damping").
module volumetric_m
  use element_chunk_m, only : element_chunk_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use stress_chunk_m, only : stress_chunk_t, rotate_deviator
  implicit none
  private
  public :: volumetric_stress, volumetric_energy, log_ratio, atanh_series, largest_size, &
    add_bulk_viscosity, viscous_start, add_viscous_deviator, add_viscous_pressure

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

  !> Add q = rho l (Q1 l t^2 - Q2 c t) as a pressure where the volumetric
  !> strain rate t < 0; l = sqrt(A). Its work is that of the mean of it and of the one before: it
  !> acts over half of the step that it was formed from and half of the next, in which the element
  !> may expand.
  pure subroutine add_bulk_viscosity(quadratic, linear, density, sound_speed, dt, chunk, last, work)
    real(wp), intent(in) :: quadratic, linear     !! Q1, Q2
    real(wp), intent(in) :: density               !! initial density
    real(wp), intent(in) :: sound_speed
    real(wp), intent(in) :: dt
    type(element_chunk_t), intent(inout) :: chunk !! pressure in and out
    real(wp), intent(inout) :: last(chunk_size)   !! q of the step before; then the present one
    real(wp), intent(out) :: work                 !! dissipated in the step
    real(wp) :: length, rate, q
    integer :: i

    work = 0.0_wp
    !$omp simd private(length, rate, q) reduction(+ : work)
    do i = 1, chunk_size
      length = sqrt(abs(chunk%area(i)))
      rate = min(0.0_wp, chunk%trace(i))
      q = density/(1.0_wp + chunk%stretch(i))*length*rate &
        *(quadratic*length*rate - linear*sound_speed)
      chunk%pressure(i) = chunk%pressure(i) - q
      work = work - (last(i) + q)*chunk%trace(i)*chunk%mid_area(i)
      last(i) = q
    end do
    work = 0.5_wp*dt*work
  end subroutine add_bulk_viscosity

  !> Where the memory of a chunk and point starts.
  pure function viscous_start(i_chunk, k) result(first)
    integer, intent(in) :: i_chunk, k
    integer :: first

    first = 4*chunk_size*(4*(i_chunk - 1) + (k - 1)) + 1
  end function viscous_start

  !> Add 2 G beta times the deviator of the rate of deformation, and the work of the mean of it and
  !> that of the step before: a force acts over half of the step that it was formed from and half of
  !> the next.
  pure subroutine add_viscous_deviator(shear, times, area, stress, last, work)
    real(wp), intent(in) :: shear                 !! G
    real(wp), intent(in) :: times(chunk_size)     !! beta
    real(wp), intent(in) :: area(chunk_size)      !! mid-step
    type(stress_chunk_t), intent(inout) :: stress
    real(wp), intent(inout) :: last(chunk_size, 3) !! that of the step before; then the present one
    real(wp), intent(inout) :: work
    real(wp) :: factor, third, x, y, shear_part, inverse, sum
    integer :: i

    if (.not. stress%dt > 0.0_wp) return
    inverse = 2.0_wp*shear/stress%dt
    sum = 0.0_wp
    call rotate_deviator(stress%cos2, stress%sin2, last(:, 1), last(:, 2), last(:, 3))
    !$omp simd private(factor, third, x, y, shear_part) reduction(+ : sum)
    do i = 1, chunk_size
      factor = inverse*times(i)
      ! Rates of a round body stand here less the hoop rate, which leaves their deviator.
      third = (stress%dxx(i) + stress%dyy(i))/3.0_wp
      x = stress%dxx(i) - third
      y = stress%dyy(i) - third
      shear_part = stress%dxy(i)
      sum = sum + area(i)*((last(i, 1) + factor*x)*x + (last(i, 2) + factor*y)*y &
        + (last(i, 1) + last(i, 2) + factor*third)*third &
        + 2.0_wp*(last(i, 3) + factor*shear_part)*shear_part)
      last(i, 1) = factor*x
      last(i, 2) = factor*y
      last(i, 3) = factor*shear_part
      stress%sxx(i) = stress%sxx(i) + last(i, 1)
      stress%syy(i) = stress%syy(i) + last(i, 2)
      stress%sxy(i) = stress%sxy(i) + last(i, 3)
    end do
    work = work + 0.5_wp*sum
  end subroutine add_viscous_deviator

  !> Add K beta times the rate of the volume, and its work likewise.
  pure subroutine add_viscous_pressure(bulk, times, trace, area, dt, pressure, last, work)
    real(wp), intent(in) :: bulk                     !! K
    real(wp), intent(in) :: times(chunk_size)        !! beta
    real(wp), intent(in) :: trace(chunk_size)        !! rate of the volume over the volume
    real(wp), intent(in) :: area(chunk_size)         !! mid-step
    real(wp), intent(in) :: dt
    real(wp), intent(inout) :: pressure(chunk_size)  !! tension positive
    real(wp), intent(inout) :: last(chunk_size)      !! that of the step before; then the present
    real(wp), intent(inout) :: work
    real(wp) :: more, sum
    integer :: i

    if (.not. dt > 0.0_wp) return
    sum = 0.0_wp
    !$omp simd private(more) reduction(+ : sum)
    do i = 1, chunk_size
      more = bulk*times(i)*trace(i)
      pressure(i) = pressure(i) + more
      sum = sum + (last(i) + more)*trace(i)*area(i)
      last(i) = more
    end do
    work = work + 0.5_wp*dt*sum
  end subroutine add_viscous_pressure

end module volumetric_m
