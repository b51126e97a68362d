! SPDX-License-Identifier: MIT
!> Growth g of the plastic strain p in a step by the flow stress of Johnson and Cook at its end:
!>   3G g + sigma(p + g) = q,  sigma = (A + B (p + g)^n)(1 + C ln r)(1 - T*^m),
!> of some points side by side, so that the compiler forms vectors of them. What a point gets does
!> not depend on those beside it.
module johnson_cook_growth_m
  use johnson_cook_m, only : johnson_cook_t
  use kinds_m, only : wp
  use vector_functions_m, only : form_logarithms, form_exponentials, form_powers
  implicit none
  private
  public :: n_lane, find_growth

  !> Points side by side: a few vectors of any width, few enough to leave out most elastic ones.
  integer, parameter :: n_lane = 16
  !> Below this a plastic strain counts as 0 in powers.
  real(wp), parameter :: least_strain = 1.0e-200_wp
  !> Least exponent n whose power alone bounds the growth.
  real(wp), parameter :: least_power = 0.01_wp
  integer, parameter :: most_rounds = 100

  !> What is known of the growths.
  type :: search_t
    real(wp), dimension(n_lane) :: low, high !! bounds
    real(wp), dimension(n_lane) :: growth    !! between them
    real(wp), dimension(n_lane) :: is_open   !! 1, or 0 where the growth is found
  end type search_t

contains

  !> The left side rises with g, so that the root lies between 0 and the least of the growths that
  !> its terms alone allow: Newton's method, and halves where it leaves the bounds known so far.
  pure subroutine find_growth(flow, shear, mises, strain, factor, ratio, growth)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in) :: shear
    real(wp), intent(in), dimension(n_lane) :: mises, strain !! q of the trial stress, p
    real(wp), intent(in) :: factor(n_lane)                   !! 1 - T*^m
    real(wp), intent(in) :: ratio(n_lane) !! r, not below 1; of the viscoplastic form r/g
    real(wp), intent(out) :: growth(n_lane)
    type(search_t) :: search
    real(wp), dimension(n_lane) :: known, stress, slope
    real(wp) :: near
    integer :: i_round

    known = factor
    if (.not. flow%is_viscoplastic) call scale_by_rate(flow%c, ratio, known)
    growth = 0.0_wp
    call form_flow(flow, strain, growth, ratio, known, stress, slope)
    call open_search(shear, mises, stress, slope, search)
    if (.not. any(search%is_open > 0.0_wp)) return
    call bound_by_power(flow, mises, strain, known, search)
    near = merge(1.0e-12_wp, sqrt(epsilon(1.0_wp)), has_corners(flow))
    do i_round = 1, most_rounds
      call form_flow(flow, strain, search%growth, ratio, known, stress, slope)
      call improve(shear, mises, stress, slope, near, search)
      if (.not. any(search%is_open > 0.0_wp)) exit
    end do
    growth = search%growth
  end subroutine find_growth

  !> Bounds where the trial stress is above the flow stress at the start, and what the slope there
  !> makes of it.
  pure subroutine open_search(shear, mises, stress, slope, search)
    real(wp), intent(in) :: shear
    real(wp), intent(in), dimension(n_lane) :: mises, stress, slope !! at the start
    type(search_t), intent(inout) :: search
    integer :: i

    !$omp simd
    do i = 1, n_lane
      search%low(i) = 0.0_wp
      search%high(i) = max(0.0_wp, mises(i) - stress(i))/(3.0_wp*shear)
      search%growth(i) = max(0.0_wp, mises(i) - stress(i))/(3.0_wp*shear + slope(i))
      search%is_open(i) = merge(1.0_wp, 0.0_wp, mises(i) > stress(i))
    end do
  end subroutine open_search

  !> Where the flow stress has corners, the last step of Newton's method may cross one.
  pure function has_corners(flow) result(yes)
    type(johnson_cook_t), intent(in) :: flow
    logical :: yes

    yes = flow%is_viscoplastic .or. flow%most_static < huge(1.0_wp) .or. flow%most < huge(1.0_wp)
  end function has_corners

  !> Factor times 1 + C ln r.
  pure subroutine scale_by_rate(c, ratio, factor)
    real(wp), intent(in) :: c
    real(wp), intent(in) :: ratio(n_lane) !! not below 1
    real(wp), intent(inout) :: factor(n_lane)
    real(wp) :: logarithm(n_lane)

    if (.not. c > 0.0_wp) return
    call form_logarithms(n_lane, ratio, logarithm)
    factor = factor*(1.0_wp + c*logarithm)
  end subroutine scale_by_rate

  !> Flow stress at the end of the step, and its slope over the growth.
  pure subroutine form_flow(flow, strain, growth, ratio, factor, stress, slope)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in), dimension(n_lane) :: strain, growth, ratio
    real(wp), intent(in) :: factor(n_lane) !! of temperature, and of rates that growth is none of
    real(wp), intent(out), dimension(n_lane) :: stress, slope
    real(wp), dimension(n_lane) :: total, power, speed, rise
    real(wp) :: at_rest, static
    integer :: i

    !$omp simd
    do i = 1, n_lane
      total(i) = max(least_strain, strain(i) + growth(i))
    end do
    call form_powers(n_lane, total, flow%n, power)
    call form_rate(flow, growth, ratio, speed, rise)
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

  !> 1 + C ln r where r goes with the growth, and its slope; 1 and 0 else.
  pure subroutine form_rate(flow, growth, ratio, speed, rise)
    type(johnson_cook_t), intent(in) :: flow
    real(wp), intent(in), dimension(n_lane) :: growth, ratio
    real(wp), intent(out), dimension(n_lane) :: speed, rise
    real(wp), dimension(n_lane) :: known, logarithm
    integer :: i

    speed = 1.0_wp
    rise = 0.0_wp
    if (.not. (flow%is_viscoplastic .and. flow%c > 0.0_wp)) return
    ! By name: the compiler packs an expression into memory of the heap.
    known = max(1.0_wp, ratio*growth)
    call form_logarithms(n_lane, known, logarithm)
    !$omp simd
    do i = 1, n_lane
      speed(i) = 1.0_wp + flow%c*logarithm(i)
      rise(i) = merge(flow%c/max(growth(i), least_strain), 0.0_wp, ratio(i)*growth(i) > 1.0_wp)
    end do
  end subroutine form_rate

  !> Where p is smaller than g may be the slope at the start says nothing: there the start is what
  !> B (p + g)^n alone allows, if no bound of the flow stress comes before.
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

  !> One step of Newton's method for the points that are still open. It converges by squares, so
  !> that the step after one below `near` g would change no digit.
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

end module johnson_cook_growth_m
