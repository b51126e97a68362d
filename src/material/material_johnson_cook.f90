! SPDX-License-Identifier: MIT
!> Johnson and Cook's flow stress (A + B p^n)(1 + C ln r)(1 - T*^m), r = rate/rate0 not below 1, of
!> the equivalent strain rate sqrt(2/3 d:d) of the step, or of its plastic strain rate: elastic
!> trial stress, then radial return,
!> the plastic strain at the end of the step being that of the flow stress. The heated law keeps a
!> temperature (all plastic work heats) and damage (Johnson & Cook 1985).
!> A chunk goes by in pieces of `n_lane` points; a piece in which nothing can yield is left out.
module material_johnson_cook_m
  use johnson_cook_growth_m, only : n_lane, find_growth
  use johnson_cook_m, only : johnson_cook_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_piecewise_m, only : form_trial, return_to_surface
  use stress_chunk_m, only : stress_chunk_t
  use vector_functions_m, only : form_exponentials, form_logarithms, form_powers
  implicit none
  private
  public :: update_johnson_cook, update_hot_johnson_cook

contains

  !> Advance a chunk by one step; no heat, no damage.
  pure subroutine update_johnson_cook(shear, flow, chunk, plastic_strain)
    real(wp), intent(in) :: shear                         !! G
    type(johnson_cook_t), intent(in) :: flow
    type(stress_chunk_t), intent(inout) :: chunk          !! increments in, deviator in and out,
                                                          !! work out
    real(wp), intent(inout) :: plastic_strain(chunk_size) !! effective plastic strain
    real(wp), dimension(chunk_size) :: mises, growth
    real(wp) :: cold(n_lane), ratio(n_lane)
    integer :: i

    call form_trial(shear, chunk, mises)
    growth = 0.0_wp
    cold = 1.0_wp
    do i = 1, chunk_size, n_lane
      if (is_elastic(flow%a, mises(i), cold)) cycle
      call form_rate_ratio(flow, chunk%dt, chunk%dxx(i), chunk%dyy(i), chunk%dxy(i), ratio)
      call find_growth(flow, shear, mises(i), plastic_strain(i), cold, ratio, growth(i))
    end do
    call return_to_surface(shear, mises, growth, chunk, plastic_strain)
  end subroutine update_johnson_cook

  !> Advance a chunk by one step; the flow stress is that of the temperature at its start.
  pure subroutine update_hot_johnson_cook(shear, flow, chunk, plastic_strain, rise, damage)
    real(wp), intent(in) :: shear
    type(johnson_cook_t), intent(in) :: flow
    type(stress_chunk_t), intent(inout) :: chunk  !! mean stress and V/V0 too
    real(wp), intent(inout), dimension(chunk_size) :: plastic_strain
    real(wp), intent(inout), dimension(chunk_size) :: rise   !! of the temperature, K
    real(wp), intent(inout), dimension(chunk_size) :: damage !! 1 = broken
    real(wp), dimension(chunk_size) :: mises, growth, whole
    real(wp), dimension(n_lane) :: hot, factor, ratio, stress
    integer :: i

    call form_trial(shear, chunk, mises)
    growth = 0.0_wp
    ! What is broken does not flow.
    whole = merge(mises, 0.0_wp, damage < 1.0_wp)
    do i = 1, chunk_size, n_lane
      call soften(flow, rise(i), hot, factor)
      if (is_elastic(flow%a, whole(i), factor)) cycle
      call form_rate_ratio(flow, chunk%dt, chunk%dxx(i), chunk%dyy(i), chunk%dxy(i), ratio)
      call find_growth(flow, shear, whole(i), plastic_strain(i), factor, ratio, growth(i))
      stress = whole(i:i + n_lane - 1) - 3.0_wp*shear*growth(i:i + n_lane - 1)
      call add_damage(flow, stress, chunk%mean(i), growth(i), hot, ratio, damage(i))
      call add_heat(flow%heat, stress, growth(i), chunk%ratio(i), rise(i))
    end do
    call return_to_surface(shear, mises, growth, chunk, plastic_strain)
    if (any(damage >= 1.0_wp)) call drop_stress(damage, chunk)
  end subroutine update_hot_johnson_cook

  !> Whether nothing yields: neither hardening nor rates lower the flow stress, so that below A
  !> times the factor of temperature all is elastic.
  pure function is_elastic(a, mises, factor) result(yes)
    real(wp), intent(in) :: a
    real(wp), intent(in) :: mises(n_lane), factor(n_lane)
    logical :: yes
    real(wp) :: over
    integer :: i

    over = -huge(1.0_wp)
    !$omp simd reduction(max : over)
    do i = 1, n_lane
      over = max(over, mises(i) - a*factor(i))
    end do
    yes = .not. over > 0.0_wp
  end function is_elastic

  !> Equivalent strain rate of the step over the reference rate, not below 1; of the viscoplastic
  !> form what the growth of the plastic strain is to be multiplied with.
  pure subroutine form_rate_ratio(flow, dt, dxx, dyy, dxy, ratio)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in) :: dt
    real(wp), intent(in), dimension(n_lane) :: dxx, dyy, dxy
    real(wp), intent(out) :: ratio(n_lane)
    real(wp) :: xx, yy, inverse
    integer :: i

    inverse = 1.0_wp/max(flow%rate*dt, tiny(1.0_wp))
    ratio = inverse
    if (flow%is_viscoplastic) return
    !$omp simd private(xx, yy)
    do i = 1, n_lane
      xx = (2.0_wp*dxx(i) - dyy(i))*(1.0_wp/3.0_wp)
      yy = (2.0_wp*dyy(i) - dxx(i))*(1.0_wp/3.0_wp)
      ratio(i) = max(1.0_wp, inverse*sqrt(4.0_wp/3.0_wp*(xx*xx + yy*yy + xx*yy + dxy(i)*dxy(i))))
    end do
  end subroutine form_rate_ratio

  !> T* and 1 - T*^m.
  pure subroutine soften(flow, rise, hot, factor)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in) :: rise(n_lane)
    real(wp), intent(out), dimension(n_lane) :: hot, factor
    real(wp), dimension(n_lane) :: safe, power
    integer :: i

    hot = min(1.0_wp, rise/flow%span)
    factor = 1.0_wp
    if (.not. any(hot > 0.0_wp)) return
    safe = max(tiny(1.0_wp), hot)
    call form_powers(n_lane, safe, flow%m, power)
    !$omp simd
    do i = 1, n_lane
      factor(i) = merge(max(0.0_wp, 1.0_wp - power(i)), 1.0_wp, hot(i) > 0.0_wp)
    end do
  end subroutine soften

  !> The work of the flow stress at the end of the step heats.
  pure subroutine add_heat(heat, stress, growth, ratio, rise)
    real(wp), intent(in) :: heat
    real(wp), intent(in), dimension(n_lane) :: stress, growth, ratio !! the last: V/V0
    real(wp), intent(inout) :: rise(n_lane)
    integer :: i

    !$omp simd
    do i = 1, n_lane
      rise(i) = rise(i) + heat*ratio(i)*stress(i)*growth(i)
    end do
  end subroutine add_heat

  !> Damage grows by that of the plastic strain over the strain at fracture
  !> (D1 + D2 exp(D3 sigma_m/sigma)) (1 + D4 ln r) (1 + D5 T*), not below its bound.
  pure subroutine add_damage(flow, stress, mean, growth, hot, ratio, damage)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in), dimension(n_lane) :: stress, mean, growth, hot, ratio
    real(wp), intent(inout) :: damage(n_lane)
    real(wp), parameter :: most_triaxial = 100.0_wp, most_exponent = 100.0_wp
    real(wp), dimension(n_lane) :: exponent, power, rate, logarithm
    real(wp) :: strain
    integer :: i

    if (.not. flow%has_damage) return
    !$omp simd
    do i = 1, n_lane
      ! Molten points have next to no von Mises stress.
      exponent(i) = min(most_exponent, flow%d(3)*mean(i)/max(stress(i), &
        abs(mean(i))/most_triaxial, tiny(1.0_wp)))
      rate(i) = max(1.0_wp, merge(ratio(i)*growth(i), ratio(i), flow%is_viscoplastic))
    end do
    call form_exponentials(n_lane, exponent, power)
    call form_logarithms(n_lane, rate, logarithm)
    !$omp simd private(strain)
    do i = 1, n_lane
      strain = max(flow%least, (flow%d(1) + flow%d(2)*power(i))*(1.0_wp + flow%d(4)*logarithm(i)) &
        *(1.0_wp + flow%d(5)*hot(i)))
      damage(i) = merge(min(1.0_wp, damage(i) + growth(i)/strain), damage(i), growth(i) > 0.0_wp)
    end do
  end subroutine add_damage

  !> Points that are broken carry no stress.
  pure subroutine drop_stress(damage, chunk)
    real(wp), intent(in) :: damage(chunk_size)
    type(stress_chunk_t), intent(inout) :: chunk
    integer :: i

    do i = 1, chunk_size
      if (damage(i) < 1.0_wp) cycle
      ! The end of the step has no share in the work then.
      chunk%work(i) = chunk%work(i) - 0.5_wp*(chunk%sxx(i)*chunk%dxx(i) &
        + chunk%syy(i)*chunk%dyy(i) + 2.0_wp*chunk%sxy(i)*chunk%dxy(i))
      chunk%sxx(i) = 0.0_wp
      chunk%syy(i) = 0.0_wp
      chunk%sxy(i) = 0.0_wp
    end do
  end subroutine drop_stress

end module material_johnson_cook_m
