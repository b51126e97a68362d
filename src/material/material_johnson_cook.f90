! SPDX-License-Identifier: MIT
!> Johnson-Cook flow stress (A + B p^n)(1 + C ln r)(1 - T*^m), r = rate/rate0 not below 1, of the
!> equivalent strain rate sqrt(2/3 d:d) of the step, or of its plastic strain rate: elastic trial
!> stress, then radial return with the plastic strain at the end of the step. The heated law has a
!> temperature (all plastic work heats) and damage (Johnson & Cook 1985). A chunk is processed in
!> pieces of `n_lane` points; a piece in which nothing can yield is skipped.
module material_johnson_cook_m
  use parts_m, only : johnson_cook_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_piecewise_m, only : form_trial, return_to_surface
  use stress_chunk_m, only : stress_chunk_t
  use vector_functions_m, only : form_exponentials, form_logarithms, form_powers
  implicit none
  private
  public :: update_johnson_cook, n_lane, find_growth

  !> Points per piece: a few vectors of any width, few enough to skip most elastic ones.
  integer, parameter :: n_lane = 16
  !> Plastic strain that counts as 0 in powers.
  real(wp), parameter :: least_strain = 1.0e-200_wp
  !> Smallest exponent n whose power alone bounds the growth.
  real(wp), parameter :: least_power = 0.01_wp
  integer, parameter :: most_rounds = 100

  !> State of the search for the growths.
  type :: search_t
    real(wp), dimension(n_lane) :: low, high !! bounds
    real(wp), dimension(n_lane) :: growth    !! estimate between them
    real(wp), dimension(n_lane) :: is_open   !! 1, or 0 where the growth is found
  end type search_t

contains

  !> Update a chunk. The flow stress of the heated law is that of the temperature at the start of
  !> the step; failed points neither flow nor carry stress.
  pure subroutine update_johnson_cook(shear, flow, chunk, plastic_strain, rise, damage)
    real(wp), intent(in) :: shear                         !! G
    type(johnson_cook_t), intent(in) :: flow
    type(stress_chunk_t), intent(inout) :: chunk          !! increments in, deviator in and out,
                                                          !! work out; mean stress and V/V0 of the
                                                          !! heated law
    real(wp), intent(inout) :: plastic_strain(chunk_size) !! effective plastic strain
    real(wp), intent(inout), optional :: rise(chunk_size) !! of the temperature, K: the heated law
    real(wp), intent(inout), optional :: damage(chunk_size) !! of it, 1 = broken
    real(wp), dimension(chunk_size) :: mises, growth, whole
    real(wp), dimension(n_lane) :: hot, factor, ratio, stress
    integer :: i

    call form_trial(shear, chunk, mises)
    growth = 0.0_wp
    whole = mises
    if (present(damage)) whole = merge(mises, 0.0_wp, damage < 1.0_wp)
    factor = 1.0_wp
    do i = 1, chunk_size, n_lane
      if (present(rise)) call soften(flow, rise(i), hot, factor)
      if (is_elastic(flow%a, whole(i), factor)) cycle
      call form_rate_ratio(flow, chunk%dt, chunk%dxx(i), chunk%dyy(i), chunk%dxy(i), ratio)
      call find_growth(flow, shear, whole(i), plastic_strain(i), factor, ratio, growth(i))
      if (.not. (present(rise) .and. present(damage))) cycle
      stress = whole(i:i + n_lane - 1) - 3.0_wp*shear*growth(i:i + n_lane - 1)
      call add_damage(flow, stress, chunk%mean(i), growth(i), hot, ratio, damage(i))
      ! Heating by the flow stress at the end of the step.
      associate (piece => rise(i:i + n_lane - 1))
        piece = piece + flow%heat*chunk%ratio(i:i + n_lane - 1)*stress*growth(i:i + n_lane - 1)
      end associate
    end do
    call return_to_surface(shear, mises, growth, chunk, plastic_strain)
    if (.not. present(damage)) return
    do i = 1, chunk_size
      if (damage(i) < 1.0_wp) cycle
      ! The stress at the end of the step does no work then.
      chunk%work(i) = chunk%work(i) - 0.5_wp*(chunk%sxx(i)*chunk%dxx(i) &
        + chunk%syy(i)*chunk%dyy(i) + 2.0_wp*chunk%sxy(i)*chunk%dxy(i))
      chunk%sxx(i) = 0.0_wp
      chunk%syy(i) = 0.0_wp
      chunk%sxy(i) = 0.0_wp
    end do
  end subroutine update_johnson_cook

  !> Whether nothing yields: neither hardening nor rates reduce the flow stress, so that below A
  !> times the temperature factor all is elastic.
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

  !> Equivalent strain rate of the step over the reference rate, not below 1; in the viscoplastic
  !> form the factor of the growth of the plastic strain.
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

  !> Growth g of the plastic strain p in a step by the flow stress at its end, 3G g + sigma(p + g) =
  !> q, of some points at once for vectorisation. The result of a point does not depend on the
  !> others. The left side rises with g, so that the root lies between 0 and the smallest of the
  !> growths that single terms allow: Newton's method, with bisection where it leaves the bounds.
  pure subroutine find_growth(flow, shear, mises, strain, factor, ratio, growth)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in) :: shear
    real(wp), intent(in), dimension(n_lane) :: mises, strain !! q of the trial stress, p
    real(wp), intent(in) :: factor(n_lane)                   !! 1 - T*^m
    real(wp), intent(in) :: ratio(n_lane) !! r, not below 1; of the viscoplastic form r/g
    real(wp), intent(out) :: growth(n_lane)
    type(search_t) :: search
    real(wp), dimension(n_lane) :: known, logarithm, stress, slope
    real(wp) :: near
    integer :: i_round

    known = factor
    if (flow%c > 0.0_wp .and. .not. flow%is_viscoplastic) then
      call form_logarithms(n_lane, ratio, logarithm)
      known = factor*(1.0_wp + flow%c*logarithm)
    end if
    growth = 0.0_wp
    call form_flow(flow, strain, growth, ratio, known, stress, slope)
    ! Bounds where the trial stress exceeds the flow stress at the start, and the estimate by its
    ! slope.
    search%low = 0.0_wp
    search%high = max(0.0_wp, mises - stress)/(3.0_wp*shear)
    search%growth = max(0.0_wp, mises - stress)/(3.0_wp*shear + slope)
    search%is_open = merge(1.0_wp, 0.0_wp, mises > stress)
    if (.not. any(search%is_open > 0.0_wp)) return
    call bound_by_power(flow, mises, strain, known, search)
    ! At a corner of the flow stress the last Newton step may cross it.
    near = sqrt(epsilon(1.0_wp))
    if (flow%is_viscoplastic .or. flow%most_static < huge(1.0_wp) .or. flow%most < huge(1.0_wp)) &
      near = 1.0e-12_wp
    do i_round = 1, most_rounds
      call form_flow(flow, strain, search%growth, ratio, known, stress, slope)
      call improve(shear, mises, stress, slope, near, search)
      if (.not. any(search%is_open > 0.0_wp)) exit
    end do
    growth = search%growth
  end subroutine find_growth

  !> Flow stress at the end of the step, and its slope over the growth.
  pure subroutine form_flow(flow, strain, growth, ratio, factor, stress, slope)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in), dimension(n_lane) :: strain, growth, ratio
    real(wp), intent(in) :: factor(n_lane) !! of temperature, and of rates that growth is none of
    real(wp), intent(out), dimension(n_lane) :: stress, slope
    real(wp), dimension(n_lane) :: total, power, rate, speed, rise
    real(wp) :: at_rest, static
    integer :: i

    !$omp simd
    do i = 1, n_lane
      total(i) = max(least_strain, strain(i) + growth(i))
    end do
    call form_powers(n_lane, total, flow%n, power)
    ! 1 + C ln r where r goes with the growth, and its slope.
    speed = 1.0_wp
    rise = 0.0_wp
    if (flow%is_viscoplastic .and. flow%c > 0.0_wp) then
      ! By name: the compiler packs an expression into memory of the heap.
      rate = max(1.0_wp, ratio*growth)
      call form_logarithms(n_lane, rate, speed)
      speed = 1.0_wp + flow%c*speed
      rise = merge(flow%c/max(growth, least_strain), 0.0_wp, ratio*growth > 1.0_wp)
    end if
    at_rest = merge(0.0_wp, 1.0_wp, flow%n > 0.0_wp)
    !$omp simd private(static)
    do i = 1, n_lane
      power(i) = flow%b*merge(power(i), at_rest, strain(i) + growth(i) > least_strain)
      static = factor(i)*min(flow%most_static, flow%a + power(i))
      slope(i) = merge(factor(i)*flow%n*power(i)/total(i), 0.0_wp, &
        flow%a + power(i) < flow%most_static)*speed(i) + static*rise(i)
      stress(i) = min(flow%most, static*speed(i))
      slope(i) = merge(0.0_wp, slope(i), static*speed(i) >= flow%most)
    end do
  end subroutine form_flow

  !> Where p may be smaller than g the slope at the start is no estimate: use the growth that B (p +
  !> g)^n alone allows, unless a bound of the flow stress applies before.
  pure subroutine bound_by_power(flow, mises, strain, factor, search)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in), dimension(n_lane) :: mises, strain, factor
    type(search_t), intent(inout) :: search
    real(wp), dimension(n_lane) :: over, under, log_over, log_under, bound
    real(wp), parameter :: base = sqrt(tiny(1.0_wp)), wider = 1.0001_wp !! than round-off
    integer :: i

    if (.not. any(strain < search%high)) return
    bound = search%high + strain
    if (flow%b > 0.0_wp .and. flow%n > least_power) then
      over = max(base, mises - factor*flow%a)
      under = max(base, factor*flow%b)
      call form_logarithms(n_lane, over, log_over)
      call form_logarithms(n_lane, under, log_under)
      call form_exponentials(n_lane, (log_over - log_under)/flow%n, bound)
    end if
    associate (high => search%high)
      !$omp simd
      do i = 1, n_lane
        bound(i) = min(high(i), max(0.0_wp, wider*bound(i) - strain(i)))
        bound(i) = merge(bound(i), high(i), mises(i) <= flow%most &
          .and. mises(i) <= flow%most_static*min(1.0_wp, factor(i)))
        search%growth(i) = merge(bound(i), search%growth(i), strain(i) < high(i))
        high(i) = merge(bound(i), high(i), strain(i) < high(i))
      end do
    end associate
  end subroutine bound_by_power

  !> One Newton step for the open points. Convergence is quadratic, so that the step after one below
  !> `near` g would change no digit.
  pure subroutine improve(shear, mises, stress, slope, near, search)
    real(wp), intent(in) :: shear, near
    real(wp), intent(in), dimension(n_lane) :: mises, stress, slope
    type(search_t), intent(inout) :: search
    real(wp), parameter :: close = 4.0_wp*epsilon(1.0_wp)
    real(wp) :: old, rest, next
    integer :: i

    associate (low => search%low, high => search%high, is_open => search%is_open)
      !$omp simd private(old, rest, next)
      do i = 1, n_lane
        old = search%growth(i)
        rest = 3.0_wp*shear*old + stress(i) - mises(i)
        high(i) = merge(old, high(i), rest > 0.0_wp)
        low(i) = merge(low(i), old, rest > 0.0_wp)
        next = old - rest/(3.0_wp*shear + slope(i))
        next = merge(next, 0.5_wp*(low(i) + high(i)), next > low(i) .and. next < high(i))
        is_open(i) = merge(is_open(i), 0.0_wp, abs(rest) > close*mises(i))
        next = merge(next, old, is_open(i) > 0.0_wp)
        is_open(i) = merge(is_open(i), 0.0_wp, abs(next - old) > near*old)
        search%growth(i) = next
      end do
    end associate
  end subroutine improve

end module material_johnson_cook_m
