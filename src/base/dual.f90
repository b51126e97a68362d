! SPDX-License-Identifier: MIT
!> Dual numbers: a value and its partial derivatives with respect to a few variables, carried
!> through sums, products, quotients and square roots (forward differentiation).
module dual_m
  use kinds_m, only : wp
  implicit none
  private
  public :: dual_t, n_partial, constant, variable, operator(+), operator(-), operator(*), &
    operator(/), sqrt

  !> Number of partial derivatives.
  integer, parameter :: n_partial = 16

  !> Value and partial derivatives; no default values, whose initialisation would cost time.
  type :: dual_t
    real(wp) :: value
    real(wp) :: slope(n_partial)
  end type dual_t

  interface operator(+)
    module procedure add_duals, add_real
  end interface operator(+)

  interface operator(-)
    module procedure subtract_duals, subtract_from_real, negate
  end interface operator(-)

  interface operator(*)
    module procedure multiply_duals, scale_dual
  end interface operator(*)

  interface operator(/)
    module procedure divide_duals
  end interface operator(/)

  interface sqrt
    module procedure root_of_dual
  end interface sqrt

contains

  !> A constant: all partial derivatives are zero.
  elemental function constant(value) result(c)
    real(wp), intent(in) :: value
    type(dual_t) :: c

    c%value = value
    c%slope = 0.0_wp
  end function constant

  !> The i-th variable.
  elemental function variable(value, i) result(c)
    real(wp), intent(in) :: value
    integer, intent(in) :: i !! 1 to n_partial
    type(dual_t) :: c

    c = constant(value)
    c%slope(i) = 1.0_wp
  end function variable

  !> a + b
  elemental function add_duals(a, b) result(c)
    type(dual_t), intent(in) :: a, b
    type(dual_t) :: c

    c%value = a%value + b%value
    c%slope = a%slope + b%slope
  end function add_duals

  !> a + b, b without slope
  elemental function add_real(a, b) result(c)
    type(dual_t), intent(in) :: a
    real(wp), intent(in) :: b
    type(dual_t) :: c

    c%value = a%value + b
    c%slope = a%slope
  end function add_real

  !> a - b
  elemental function subtract_duals(a, b) result(c)
    type(dual_t), intent(in) :: a, b
    type(dual_t) :: c

    c%value = a%value - b%value
    c%slope = a%slope - b%slope
  end function subtract_duals

  !> a - b, a without slope
  elemental function subtract_from_real(a, b) result(c)
    real(wp), intent(in) :: a
    type(dual_t), intent(in) :: b
    type(dual_t) :: c

    c%value = a - b%value
    c%slope = -b%slope
  end function subtract_from_real

  !> -a
  elemental function negate(a) result(c)
    type(dual_t), intent(in) :: a
    type(dual_t) :: c

    c%value = -a%value
    c%slope = -a%slope
  end function negate

  !> a b
  elemental function multiply_duals(a, b) result(c)
    type(dual_t), intent(in) :: a, b
    type(dual_t) :: c

    c%value = a%value*b%value
    c%slope = a%slope*b%value + a%value*b%slope
  end function multiply_duals

  !> a b, a without slope
  elemental function scale_dual(a, b) result(c)
    real(wp), intent(in) :: a
    type(dual_t), intent(in) :: b
    type(dual_t) :: c

    c%value = a*b%value
    c%slope = a*b%slope
  end function scale_dual

  !> a/b
  elemental function divide_duals(a, b) result(c)
    type(dual_t), intent(in) :: a, b
    type(dual_t) :: c

    c%value = a%value/b%value
    c%slope = (a%slope - c%value*b%slope)/b%value
  end function divide_duals

  !> Square root of a positive number.
  elemental function root_of_dual(a) result(c)
    type(dual_t), intent(in) :: a
    type(dual_t) :: c

    c%value = sqrt(a%value)
    c%slope = a%slope*(0.5_wp/c%value)
  end function root_of_dual

end module dual_m
