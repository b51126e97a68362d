! SPDX-License-Identifier: MIT
!> Logarithm, exponential and power of arrays, to 2 units in the last place (powers: times the
!> logarithm of the result), in vectorised loops: tens of times as fast as library calls.
!> With x = 2^k m, m in [sqrt(1/2), sqrt(2)): ln x = k ln 2 + 2 atanh((m - 1)/(m + 1)), atanh by its
!> series; exp x = 2^k exp(x - k ln 2), the exponential of the remainder by its Taylor series.
module vector_functions_m
  use kinds_m, only : wp, long
  implicit none
  private
  public :: form_logarithms, form_log_ratios, form_exponentials, form_excesses, form_powers

  !> Bits of 1, of sqrt(1/2), of the fraction, and of 2^52, whose last bits are an integer.
  integer(long), parameter :: bits_one = int(z'3FF0000000000000', long), &
    bits_least = int(z'3FE6A09E667F3BCD', long), &
    bits_fraction = int(z'000FFFFFFFFFFFFF', long), bits_whole = int(z'4330000000000000', long)
  integer, parameter :: n_fraction = 52
  real(wp), parameter :: whole = 2.0_wp**n_fraction, bias = 1023.0_wp
  !> ln 2 in two parts: the first has so few digits that its product with k is exact.
  real(wp), parameter :: ln2_high = real(z'3FE62E42FEE00000', wp), &
    ln2_low = real(z'3DEA39EF35793C76', wp), inverse_ln2 = 1.4426950408889634_wp
  !> Adding this number rounds to an integer.
  real(wp), parameter :: rounder = 1.5_wp*whole
  !> Arguments of exp are limited to these bounds, so that results are normal numbers.
  real(wp), parameter :: least_exponent = -708.0_wp, most_exponent = 709.0_wp

contains

  !> ln x of normal numbers x > 0.
  pure subroutine form_logarithms(n, x, y)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n)
    real(wp), intent(out) :: y(n)
    integer :: i

    !$omp simd
    do i = 1, n
      y(i) = logarithm(x(i))
    end do
  end subroutine form_logarithms

  !> ln(1 + s) for s > -1, accurate for small s; 1 + s is a normal number.
  pure subroutine form_log_ratios(n, s, y)
    integer, intent(in) :: n
    real(wp), intent(in) :: s(n)
    real(wp), intent(out) :: y(n)
    real(wp) :: k, m
    integer :: i

    !$omp simd private(k, m)
    do i = 1, n
      call split(1.0_wp + s(i), k, m)
      y(i) = join(k, merge(s(i), m - 1.0_wp, k*k < 0.5_wp), m)
    end do
  end subroutine form_log_ratios

  !> exp x, x limited to the bounds above.
  pure subroutine form_exponentials(n, x, y)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n)
    real(wp), intent(out) :: y(n)
    integer :: i

    !$omp simd
    do i = 1, n
      y(i) = exponential(x(i))
    end do
  end subroutine form_exponentials

  !> exp x - 1, accurate for small x.
  pure subroutine form_excesses(n, x, y)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n)
    real(wp), intent(out) :: y(n)
    real(wp) :: excess, scale
    integer :: i

    !$omp simd private(excess, scale)
    do i = 1, n
      call reduce(x(i), excess, scale)
      y(i) = scale*excess + (scale - 1.0_wp)
    end do
  end subroutine form_excesses

  !> x^a of normal numbers x > 0.
  pure subroutine form_powers(n, x, a, y)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n), a
    real(wp), intent(out) :: y(n)
    integer :: i

    !$omp simd
    do i = 1, n
      y(i) = exponential(a*logarithm(x(i)))
    end do
  end subroutine form_powers

  !> ln x.
  pure elemental function logarithm(x) result(y)
    real(wp), intent(in) :: x
    real(wp) :: y
    real(wp) :: k, m

    call split(x, k, m)
    y = join(k, m - 1.0_wp, m)
  end function logarithm

  !> x = 2^k m.
  pure elemental subroutine split(x, k, m)
    real(wp), intent(in) :: x
    real(wp), intent(out) :: k, m
    integer(long) :: bits

    bits = transfer(x, bits) + (bits_one - bits_least)
    k = transfer(ior(shiftr(bits, n_fraction), bits_whole), k) - (whole + bias)
    m = transfer(iand(bits, bits_fraction) + bits_least, m)
  end subroutine split

  !> k ln 2 + ln m; the terms left out of the series are below round-off.
  pure elemental function join(k, excess, m) result(y)
    real(wp), intent(in) :: k
    real(wp), intent(in) :: excess !! m - 1
    real(wp), intent(in) :: m
    real(wp) :: y
    real(wp) :: z, w

    z = excess/(1.0_wp + m)
    w = z*z
    w = w*(1.0_wp/3.0_wp + w*(1.0_wp/5.0_wp + w*(1.0_wp/7.0_wp + w*(1.0_wp/9.0_wp &
      + w*(1.0_wp/11.0_wp + w*(1.0_wp/13.0_wp + w*(1.0_wp/15.0_wp + w*(1.0_wp/17.0_wp &
      + w*(1.0_wp/19.0_wp + w*(1.0_wp/21.0_wp))))))))))
    y = k*ln2_high + (2.0_wp*z + (2.0_wp*z*w + k*ln2_low))
  end function join

  !> exp x.
  pure elemental function exponential(x) result(y)
    real(wp), intent(in) :: x
    real(wp) :: y
    real(wp) :: excess, scale

    call reduce(x, excess, scale)
    y = scale*(1.0_wp + excess)
  end function exponential

  !> exp x = scale (1 + excess), scale a power of 2.
  pure elemental subroutine reduce(x, excess, scale)
    real(wp), intent(in) :: x
    real(wp), intent(out) :: excess, scale
    real(wp) :: shifted, k, z

    z = max(least_exponent, min(most_exponent, x))
    shifted = z*inverse_ln2 + rounder
    k = shifted - rounder
    z = (z - k*ln2_high) - k*ln2_low
    ! |z| <= ln(2)/2: the first term left out is below 1e-17.
    excess = z + z*z*(1.0_wp/2.0_wp + z*(1.0_wp/6.0_wp + z*(1.0_wp/24.0_wp + z*(1.0_wp/120.0_wp &
      + z*(1.0_wp/720.0_wp + z*(1.0_wp/5040.0_wp + z*(1.0_wp/40320.0_wp + z*(1.0_wp/362880.0_wp &
      + z*(1.0_wp/3628800.0_wp + z*(1.0_wp/39916800.0_wp + z*(1.0_wp/479001600.0_wp &
      + z*(1.0_wp/6227020800.0_wp))))))))))))
    scale = transfer(bits_one + shiftl(transfer(shifted, bits_one), n_fraction), scale)
  end subroutine reduce

end module vector_functions_m
