! SPDX-License-Identifier: MIT
!> Load curves: piecewise linear, constant outside the range of the abscissa.
module curves_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, any_length
  implicit none
  private
  public :: curve_t, curve_value, curve_integral, curve_is_constant

  !> One *DEFINE_CURVE, its scale factors and offsets already applied.
  type, extends(visited_t) :: curve_t
    integer :: id = 0                      !! user id
    real(wp), allocatable :: abscissa(:)   !! increasing, one or more points
    real(wp), allocatable :: ordinate(:)   !! same length
    integer :: phase = 0                   !! SIDR: 0 run, 1 dynamic relaxation, 2 both
    logical :: is_of_time = .true.         !! false for curves of materials
    logical :: is_function = .false.       !! of time, sampled up to the end time
  contains
    procedure :: visit => visit_curve
  end type curve_t

contains

  !> Ordinate at `x`.
  pure function curve_value(curve, x) result(y)
    type(curve_t), intent(in) :: curve
    real(wp), intent(in) :: x
    real(wp) :: y
    integer :: low, high, middle

    high = size(curve%abscissa)
    if (x <= curve%abscissa(1)) then
      y = curve%ordinate(1)
      return
    else if (x >= curve%abscissa(high)) then
      y = curve%ordinate(high)
      return
    end if
    low = 1
    do while (high - low > 1)
      middle = (low + high)/2
      if (curve%abscissa(middle) <= x) then
        low = middle
      else
        high = middle
      end if
    end do
    y = curve%ordinate(low) + (curve%ordinate(high) - curve%ordinate(low)) &
      *((x - curve%abscissa(low))/(curve%abscissa(high) - curve%abscissa(low)))
  end function curve_value

  !> Integral of the curve from a to b, exact (trapezoids from point to point).
  pure function curve_integral(curve, a, b) result(total)
    type(curve_t), intent(in) :: curve
    real(wp), intent(in) :: a, b !! a <= b
    real(wp) :: total
    real(wp) :: x, next
    integer :: i

    total = 0.0_wp
    x = a
    do i = 1, size(curve%abscissa)
      next = min(curve%abscissa(i), b)
      if (next <= x) cycle
      total = total + 0.5_wp*(next - x)*(curve_value(curve, x) + curve_value(curve, next))
      x = next
    end do
    total = total + (b - x)*curve_value(curve, b)
  end function curve_integral

  !> Whether the curve has one value everywhere.
  pure function curve_is_constant(curve) result(constant)
    type(curve_t), intent(in) :: curve
    logical :: constant

    constant = maxval(curve%ordinate) <= minval(curve%ordinate)
  end function curve_is_constant

  !> Visit the components of a curve.
  subroutine visit_curve(self, visitor)
    class(curve_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%visit('abscissa', self%abscissa, any_length)
    call visitor%visit('ordinate', self%ordinate, any_length)
    call visitor%visit('phase', self%phase)
    call visitor%visit('is_of_time', self%is_of_time)
    call visitor%visit('is_function', self%is_function)
  end subroutine visit_curve

end module curves_m
