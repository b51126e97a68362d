! SPDX-License-Identifier: MIT
!> J2 plasticity with isotropic hardening by points: elastic trial stress, then radial return. With
!> the trial stress q and the yield stress sigma(p), the plastic strain at the end of the step
!> solves sigma(p) + 3G p = q + 3G p_old. The left side rises from point to point and is linear
!> between them (slopes are above -3G), so that one pass over the points finds the segment and its
!> line the strain, without iteration. A rate effect scales the yield stress with the total strain
!> rate sqrt(D:D) of the step.
module material_piecewise_m
  use curves_m, only : curve_value
  use hardenings_m, only : hardening_t, depends_on_rate
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_j2_m, only : tangent_of_return, trial_mises
  use stress_chunk_m, only : stress_chunk_t, stress_point_t
  use vector_functions_m, only : form_powers
  implicit none
  private
  public :: update_piecewise, tangent_piecewise, form_trial, return_to_surface

contains

  !> Update a chunk by one step.
  pure subroutine update_piecewise(shear, hardening, chunk, plastic_strain)
    real(wp), intent(in) :: shear                         !! G
    type(hardening_t), intent(in) :: hardening
    type(stress_chunk_t), intent(inout) :: chunk          !! increments in, deviator in and out,
                                                          !! work out
    real(wp), intent(inout) :: plastic_strain(chunk_size) !! effective plastic strain
    real(wp), dimension(chunk_size) :: mises, growth, rate, hoop
    real(wp) :: frequency
    integer :: i

    call form_trial(shear, chunk, mises)
    if (depends_on_rate(hardening)) then
      frequency = 0.0_wp
      if (chunk%dt > 0.0_wp) frequency = 1.0_wp/chunk%dt
      hoop = 0.0_wp
      if (chunk%has_hoop) hoop = chunk%hoop
      !$omp simd
      do i = 1, chunk_size
        rate(i) = frequency*sqrt((chunk%dxx(i) + hoop(i))**2 + (chunk%dyy(i) + hoop(i))**2 &
          + hoop(i)**2 + 2.0_wp*chunk%dxy(i)**2)
      end do
      call grow_with_rate(hardening, size(hardening%strain), size(hardening%rate), &
        hardening%stress, hardening%slope, shear, rate, mises, plastic_strain, growth)
    else
      call grow(size(hardening%strain), hardening%strain, hardening%stress, hardening%slope, &
        shear, mises, plastic_strain, growth)
    end if
    call return_to_surface(shear, mises, growth, chunk, plastic_strain)
  end subroutine update_piecewise

  !> Elastic trial stress, its von Mises value, and the work of the old stress.
  pure subroutine form_trial(shear, chunk, mises)
    real(wp), intent(in) :: shear
    type(stress_chunk_t), intent(inout) :: chunk !! trial stress out
    real(wp), intent(out) :: mises(chunk_size)
    real(wp) :: third, exx, eyy, exy, sxx, syy, sxy, double_shear
    integer :: i

    double_shear = 2.0_wp*shear
    !$omp simd private(third, exx, eyy, exy, sxx, syy, sxy)
    do i = 1, chunk_size
      exx = chunk%dxx(i)
      eyy = chunk%dyy(i)
      exy = chunk%dxy(i)
      third = (1.0_wp/3.0_wp)*(exx + eyy)
      sxx = chunk%sxx(i)
      syy = chunk%syy(i)
      sxy = chunk%sxy(i)
      chunk%work(i) = sxx*exx + syy*eyy + 2.0_wp*sxy*exy
      sxx = sxx + double_shear*(exx - third)
      syy = syy + double_shear*(eyy - third)
      sxy = sxy + double_shear*exy
      mises(i) = sqrt(3.0_wp*(sxx*sxx + syy*syy + sxx*syy + sxy*sxy))
      chunk%sxx(i) = sxx
      chunk%syy(i) = syy
      chunk%sxy(i) = sxy
    end do
  end subroutine form_trial

  !> Growth of the plastic strain with the same curve in all slots. The pass ends where no slot goes
  !> further.
  pure subroutine grow(n, strain, stress, slope, shear, mises, plastic_strain, growth)
    integer, intent(in) :: n
    real(wp), intent(in), dimension(n) :: strain, stress, slope !! points of the curve
    real(wp), intent(in) :: shear
    real(wp), intent(in), dimension(chunk_size) :: mises, plastic_strain
    real(wp), intent(out) :: growth(chunk_size)
    real(wp) :: goal(chunk_size), start, foot, inverse, reach
    integer :: i, k

    foot = stress(1) - slope(1)*strain(1)
    inverse = 1.0_wp/(3.0_wp*shear + slope(1))
    reach = 0.0_wp
    !$omp simd reduction(max : reach)
    do i = 1, chunk_size
      goal(i) = mises(i) + 3.0_wp*shear*plastic_strain(i)
      growth(i) = max(0.0_wp, mises(i) - foot - slope(1)*plastic_strain(i))*inverse
      reach = max(reach, goal(i))
    end do
    do k = 2, n
      start = stress(k) + 3.0_wp*shear*strain(k)
      if (reach < start) exit
      foot = stress(k) - slope(k)*strain(k)
      inverse = 1.0_wp/(3.0_wp*shear + slope(k))
      !$omp simd
      do i = 1, chunk_size
        growth(i) = merge(max(0.0_wp, mises(i) - foot - slope(k)*plastic_strain(i))*inverse, &
          growth(i), goal(i) >= start)
      end do
    end do
  end subroutine grow

  !> Growth of the plastic strain where each slot has its own rate: factor on the yield stress and
  !> position between the rates of the table.
  pure subroutine grow_with_rate(hardening, n, n_rate, stress, slope, shear, rate, mises, &
      plastic_strain, growth)
    type(hardening_t), intent(in) :: hardening
    integer, intent(in) :: n, n_rate
    real(wp), intent(in), dimension(n, n_rate) :: stress, slope !! of `hardening`
    real(wp), intent(in) :: shear
    real(wp), intent(in), dimension(chunk_size) :: rate, mises, plastic_strain !! sqrt(D:D) first
    real(wp), intent(out) :: growth(chunk_size)
    real(wp), dimension(chunk_size) :: factor, share, level, rise, place
    real(wp) :: height, tilt
    integer :: low(chunk_size), high(chunk_size), i, k
    logical :: is_beyond

    call find_rows(n_rate, hardening%rate, rate, low, high, share)
    call find_factors(hardening, shear, rate, mises, plastic_strain, factor)
    level = 0.0_wp
    rise = 0.0_wp
    place = 0.0_wp
    do k = 1, n
      !$omp simd private(height, tilt, is_beyond)
      do i = 1, chunk_size
        height = factor(i)*(stress(k, low(i)) + share(i)*(stress(k, high(i)) - stress(k, low(i))))
        tilt = factor(i)*(slope(k, low(i)) + share(i)*(slope(k, high(i)) - slope(k, low(i))))
        is_beyond = k == 1 .or. mises(i) + 3.0_wp*shear*plastic_strain(i) &
          >= height + 3.0_wp*shear*hardening%strain(k)
        level(i) = merge(height, level(i), is_beyond)
        rise(i) = merge(tilt, rise(i), is_beyond)
        place(i) = merge(hardening%strain(k), place(i), is_beyond)
      end do
    end do
    !$omp simd
    do i = 1, chunk_size
      growth(i) = max(0.0_wp, mises(i) - level(i) - rise(i)*(plastic_strain(i) - place(i))) &
        /(3.0_wp*shear + rise(i))
    end do
  end subroutine grow_with_rate

  !> Rows of the table around each slot's rate, and the share of the upper row.
  pure subroutine find_rows(n_rate, rates, rate, low, high, share)
    integer, intent(in) :: n_rate
    real(wp), intent(in) :: rates(n_rate)
    real(wp), intent(in) :: rate(chunk_size)
    integer, intent(out) :: low(chunk_size), high(chunk_size)
    real(wp), intent(out) :: share(chunk_size) !! of the upper row
    integer :: i, k

    low = 1
    high = 1
    share = 0.0_wp
    do k = 1, n_rate - 1
      !$omp simd
      do i = 1, chunk_size
        if (k > 1 .and. rate(i) < rates(k)) cycle
        low(i) = k
        high(i) = k + 1
        share(i) = min(1.0_wp, max(0.0_wp, (rate(i) - rates(k))/(rates(k + 1) - rates(k))))
      end do
    end do
  end subroutine find_rows

  !> Factors on the yield stress: of a curve, or Cowper and Symonds' 1 + (rate/C)**(1/P). The latter
  !> is never below 1 and expensive, so it is evaluated only where the yield stress without it is
  !> exceeded.
  pure subroutine find_factors(hardening, shear, rate, mises, plastic_strain, factor)
    type(hardening_t), intent(in) :: hardening
    real(wp), intent(in) :: shear
    real(wp), intent(in), dimension(chunk_size) :: rate, mises, plastic_strain
    real(wp), intent(out) :: factor(chunk_size)
    real(wp), dimension(chunk_size) :: growth, share, power
    integer :: i

    factor = 1.0_wp
    if (allocated(hardening%rate_factor)) then
      do i = 1, chunk_size
        factor(i) = curve_value(hardening%rate_factor, rate(i))
      end do
    else if (hardening%rate_constant > 0.0_wp) then
      call grow(size(hardening%strain), hardening%strain, hardening%stress, hardening%slope, &
        shear, mises, plastic_strain, growth)
      if (.not. any(growth > 0.0_wp)) return
      share = max(tiny(1.0_wp), rate/hardening%rate_constant)
      call form_powers(chunk_size, share, hardening%rate_exponent, power)
      !$omp simd
      do i = 1, chunk_size
        factor(i) = merge(1.0_wp + power(i), 1.0_wp, growth(i) > 0.0_wp .and. rate(i) > 0.0_wp)
      end do
    end if
  end subroutine find_factors

  !> Scale the trial stress back to the yield surface and complete the work.
  pure subroutine return_to_surface(shear, mises, growth, chunk, plastic_strain)
    real(wp), intent(in) :: shear
    real(wp), intent(in), dimension(chunk_size) :: mises, growth
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp), intent(inout) :: plastic_strain(chunk_size)
    real(wp) :: factor
    integer :: i

    !$omp simd private(factor)
    do i = 1, chunk_size
      factor = 1.0_wp - 3.0_wp*shear*growth(i)/max(mises(i), tiny(1.0_wp))
      chunk%sxx(i) = factor*chunk%sxx(i)
      chunk%syy(i) = factor*chunk%syy(i)
      chunk%sxy(i) = factor*chunk%sxy(i)
      plastic_strain(i) = plastic_strain(i) + growth(i)
      chunk%work(i) = 0.5_wp*(chunk%work(i) + chunk%sxx(i)*chunk%dxx(i) &
        + chunk%syy(i)*chunk%dyy(i) + 2.0_wp*chunk%sxy(i)*chunk%dxy(i))
    end do
  end subroutine return_to_surface

  !> Deviator at the end of a step and its derivative at one point, for the segment on which the
  !> step ends; without rate effect.
  pure subroutine tangent_piecewise(shear, hardening, point)
    real(wp), intent(in) :: shear
    type(hardening_t), intent(in) :: hardening
    type(stress_point_t), intent(inout) :: point !! `stress` and `tangent` out
    real(wp) :: goal
    integer :: k

    goal = trial_mises(shear, point) + 3.0_wp*shear*point%plastic_strain
    do k = size(hardening%strain), 2, -1
      if (goal >= hardening%stress(k, 1) + 3.0_wp*shear*hardening%strain(k)) exit
    end do
    call tangent_of_return(shear, hardening%stress(k, 1) + hardening%slope(k, 1) &
      *(point%plastic_strain - hardening%strain(k)), hardening%slope(k, 1), point)
  end subroutine tangent_piecewise

end module material_piecewise_m
