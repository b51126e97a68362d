! SPDX-License-Identifier: MIT
!> Johnson and Cook's flow stress (A + B p^n)(1 + C ln r)(1 - T*^m), r = rate/rate0 not below 1, of
!> the equivalent strain rate sqrt(2/3 d:d) of the step, or of its plastic strain rate: elastic
!> trial stress, then radial return,
!> the plastic strain at the end of the step being that of the flow stress. The heated law keeps a
!> temperature (all plastic work heats) and damage (Johnson & Cook 1985).
module material_johnson_cook_m
  use johnson_cook_m, only : johnson_cook_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_piecewise_m, only : form_trial, return_to_surface
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: update_johnson_cook, update_hot_johnson_cook, flow_stress

contains

  !> Advance a chunk by one step; no heat, no damage.
  pure subroutine update_johnson_cook(shear, flow, chunk, plastic_strain)
    real(wp), intent(in) :: shear                         !! G
    type(johnson_cook_t), intent(in) :: flow
    type(stress_chunk_t), intent(inout) :: chunk          !! increments in, deviator in and out,
                                                          !! work out
    real(wp), intent(inout) :: plastic_strain(chunk_size) !! effective plastic strain
    real(wp), dimension(chunk_size) :: mises, growth
    integer :: i

    call form_trial(shear, chunk, mises)
    growth = 0.0_wp
    ! Neither hardening nor rates lower the flow stress: what is below A is elastic.
    do i = 1, chunk_size
      if (mises(i) > flow%a) growth(i) = plastic_growth(flow, shear, mises(i), plastic_strain(i), &
        1.0_wp, rate_ratio(flow, chunk, i))
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
    real(wp), dimension(chunk_size) :: mises, growth
    real(wp) :: hot, ratio, stress
    integer :: i

    call form_trial(shear, chunk, mises)
    growth = 0.0_wp
    do i = 1, chunk_size
      if (damage(i) >= 1.0_wp) cycle
      hot = min(1.0_wp, rise(i)/flow%span)
      stress = flow%a*softening(flow%m, hot)
      if (mises(i) <= stress) cycle
      ratio = rate_ratio(flow, chunk, i)
      growth(i) = plastic_growth(flow, shear, mises(i), plastic_strain(i), &
        softening(flow%m, hot), ratio)
      if (flow%is_viscoplastic) ratio = max(1.0_wp, ratio*growth(i))
      stress = mises(i) - 3.0_wp*shear*growth(i)
      rise(i) = rise(i) + flow%heat*chunk%ratio(i)*stress*growth(i)
      if (flow%has_damage .and. growth(i) > 0.0_wp) damage(i) = min(1.0_wp, damage(i) &
        + growth(i)/fracture_strain(flow, triaxiality(chunk%mean(i), stress), ratio, hot))
    end do
    call return_to_surface(shear, mises, growth, chunk, plastic_strain)
    do i = 1, chunk_size
      if (damage(i) < 1.0_wp) cycle
      ! The end of the step has no share in the work then.
      chunk%work(i) = chunk%work(i) - 0.5_wp*(chunk%sxx(i)*chunk%dxx(i) &
        + chunk%syy(i)*chunk%dyy(i) + 2.0_wp*chunk%sxy(i)*chunk%dxy(i))
      chunk%sxx(i) = 0.0_wp
      chunk%syy(i) = 0.0_wp
      chunk%sxy(i) = 0.0_wp
    end do
  end subroutine update_hot_johnson_cook

  !> Equivalent strain rate of the step over the reference rate, not below 1; of the viscoplastic
  !> form what the growth of the plastic strain is to be multiplied with.
  pure function rate_ratio(flow, chunk, i) result(ratio)
    type(johnson_cook_t), intent(in) :: flow
    type(stress_chunk_t), intent(in) :: chunk
    integer, intent(in) :: i
    real(wp) :: ratio
    real(wp) :: xx, yy

    if (flow%is_viscoplastic) then
      ratio = 1.0_wp/max(flow%rate*chunk%dt, tiny(1.0_wp))
      return
    end if
    xx = (2.0_wp*chunk%dxx(i) - chunk%dyy(i))/3.0_wp
    yy = (2.0_wp*chunk%dyy(i) - chunk%dxx(i))/3.0_wp
    ratio = sqrt(4.0_wp/3.0_wp*(xx*xx + yy*yy + xx*yy + chunk%dxy(i)**2))
    ratio = max(1.0_wp, ratio/max(flow%rate*chunk%dt, tiny(1.0_wp)))
  end function rate_ratio

  !> 1 + C ln r.
  pure function rate_factor(c, ratio) result(factor)
    real(wp), intent(in) :: c, ratio
    real(wp) :: factor

    factor = 1.0_wp
    if (c > 0.0_wp) factor = 1.0_wp + c*log(ratio)
  end function rate_factor

  !> 1 - T*^m.
  pure function softening(m, hot) result(factor)
    real(wp), intent(in) :: m
    real(wp), intent(in) :: hot !! homologous temperature T*
    real(wp) :: factor

    factor = 1.0_wp
    if (hot > 0.0_wp) factor = 1.0_wp - hot**m
  end function softening

  !> Flow stress at the end of a step, and its slope over the growth of the plastic strain.
  pure subroutine flow_stress(flow, factor, ratio, strain, growth, stress, slope)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in) :: factor !! of temperature
    real(wp), intent(in) :: ratio  !! of rates, or what makes one of the growth
    real(wp), intent(in) :: strain, growth
    real(wp), intent(out) :: stress, slope
    real(wp) :: power, static, speed

    power = flow%b*(strain + growth)**flow%n
    static = factor*min(flow%most_static, flow%a + power)
    slope = 0.0_wp
    if (strain + growth > 0.0_wp .and. flow%a + power < flow%most_static) &
      slope = factor*flow%n*power/(strain + growth)
    if (flow%is_viscoplastic) then
      speed = rate_factor(flow%c, max(1.0_wp, ratio*growth))
      slope = slope*speed
      if (ratio*growth > 1.0_wp) slope = slope + static*flow%c/growth
    else
      speed = rate_factor(flow%c, ratio)
      slope = slope*speed
    end if
    stress = static*speed
    if (stress < flow%most) return
    stress = flow%most
    slope = 0.0_wp
  end subroutine flow_stress

  !> Growth g of the plastic strain: 3G g + sigma(p + g) = q. The left side rises, so that the root
  !> lies between 0 and (q - sigma(p))/3G: Newton's method, and halves where it leaves these bounds.
  pure function plastic_growth(flow, shear, mises, strain, factor, ratio) result(growth)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in) :: shear
    real(wp), intent(in) :: mises  !! q, of the trial stress
    real(wp), intent(in) :: strain !! p
    real(wp), intent(in) :: factor, ratio !! of temperature, of rates
    real(wp) :: growth
    real(wp), parameter :: close = 2.0_wp*epsilon(1.0_wp)
    integer, parameter :: most_rounds = 100
    real(wp) :: low, high, stress, slope, rest, next
    integer :: i

    growth = 0.0_wp
    call flow_stress(flow, factor, ratio, strain, 0.0_wp, stress, slope)
    if (mises <= stress) return
    low = 0.0_wp
    high = (mises - stress)/(3.0_wp*shear)
    growth = high
    do i = 1, most_rounds
      call flow_stress(flow, factor, ratio, strain, growth, stress, slope)
      rest = 3.0_wp*shear*growth + stress - mises
      if (abs(rest) <= close*mises) return
      if (rest > 0.0_wp) then
        high = growth
      else
        low = growth
      end if
      next = growth - rest/(3.0_wp*shear + slope)
      if (.not. (next > low .and. next < high)) next = 0.5_wp*(low + high)
      if (abs(next - growth) <= close*growth) return
      growth = next
    end do
  end function plastic_growth

  !> Mean over von Mises stress, tension positive; molten points have next to no von Mises stress.
  pure function triaxiality(mean, mises) result(share)
    real(wp), intent(in) :: mean, mises
    real(wp) :: share
    real(wp), parameter :: most = 100.0_wp

    share = mean/max(mises, abs(mean)/most, tiny(1.0_wp))
  end function triaxiality

  !> (D1 + D2 exp(D3 sigma_m/sigma)) (1 + D4 ln r) (1 + D5 T*), not below its bound.
  pure function fracture_strain(flow, share, ratio, hot) result(strain)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in) :: share !! triaxiality
    real(wp), intent(in) :: ratio, hot
    real(wp) :: strain

    associate (d => flow%d)
      strain = max(flow%least, (d(1) + d(2)*exp(min(100.0_wp, d(3)*share))) &
        *(1.0_wp + d(4)*log(ratio))*(1.0_wp + d(5)*hot))
    end associate
  end function fracture_strain

end module material_johnson_cook_m
