! SPDX-License-Identifier: MIT
!> Gauss-Legendre quadrature on the unit interval.
module quadrature_m
  use kinds_m, only : wp, pi
  implicit none
  private
  public :: gauss_rule

contains

  !> Points xi (increasing) and weights (sum 1) of the n-point rule on 0 .. 1, n = size(xi): roots
  !> of the Legendre polynomial by Newton's method from the usual cosine estimate.
  pure subroutine gauss_rule(xi, weight)
    real(wp), intent(out) :: xi(:)
    real(wp), intent(out) :: weight(:) !! (size(xi))
    real(wp) :: x, value, slope
    integer :: i, i_step, n

    n = size(xi)
    do i = 1, n
      x = -cos(pi*(i - 0.25_wp)/(n + 0.5_wp))
      do i_step = 1, 8
        call legendre(n, x, value, slope)
        x = x - value/slope
      end do
      call legendre(n, x, value, slope)
      xi(i) = 0.5_wp*(1.0_wp + x)
      weight(i) = 1.0_wp/((1.0_wp - x**2)*slope**2)
    end do
  end subroutine gauss_rule

  !> Legendre polynomial of degree n and its derivative at x inside -1 .. 1 (three-term recursion).
  pure subroutine legendre(n, x, value, slope)
    integer, intent(in) :: n
    real(wp), intent(in) :: x
    real(wp), intent(out) :: value, slope
    real(wp) :: before, after
    integer :: k

    before = 0.0_wp
    value = 1.0_wp
    do k = 1, n
      after = ((2*k - 1)*x*value - (k - 1)*before)/k
      before = value
      value = after
    end do
    slope = n*(before - x*value)/(1.0_wp - x**2)
  end subroutine legendre

end module quadrature_m
