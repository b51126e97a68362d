! SPDX-License-Identifier: MIT
!> Truth, order, relative equality and kinds of numbers.
module funit_order
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
  use funit_core, only: dp, SourceLocation, fail_test, text_i, text_r, text_place, same_shape
  implicit none
  private
  public :: assertTrue, assertFalse, assertIsNaN, assertIsFinite, assertRelativelyEqual
  public :: assertLessThan, assertLessThanOrEqual, assertGreaterThan, assertGreaterThanOrEqual

  interface assertTrue
    module procedure true_0, true_1
  end interface assertTrue

  interface assertFalse
    module procedure false_0, false_1
  end interface assertFalse

  interface assertLessThan
    module procedure less_i, less_r, less_r01
  end interface assertLessThan

  interface assertLessThanOrEqual
    module procedure at_most_i, at_most_r, at_most_r01
  end interface assertLessThanOrEqual

  interface assertGreaterThan
    module procedure greater_i, greater_r, greater_r01
  end interface assertGreaterThan

  interface assertGreaterThanOrEqual
    module procedure at_least_i, at_least_r, at_least_r01
  end interface assertGreaterThanOrEqual

  interface assertRelativelyEqual
    module procedure relative_r00, relative_r11, relative_r01
  end interface assertRelativelyEqual

contains

  !> A condition true.
  subroutine true_0(condition, message, location)
    logical, intent(in) :: condition
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. condition) call fail_test('expected true', message, location)
  end subroutine true_0

  !> All of a vector true.
  subroutine true_1(condition, message, location)
    logical, intent(in) :: condition(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. all(condition)) call fail_test('expected true', message, location)
  end subroutine true_1

  !> A condition false.
  subroutine false_0(condition, message, location)
    logical, intent(in) :: condition
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. (.not. condition)) call fail_test('expected false', message, location)
  end subroutine false_0

  !> All of a vector false.
  subroutine false_1(condition, message, location)
    logical, intent(in) :: condition(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. all(.not. condition)) call fail_test('expected false', message, location)
  end subroutine false_1

  !> lhs < rhs, integers.
  subroutine less_i(lhs, rhs, message, location)
    integer, intent(in) :: lhs, rhs
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. lhs < rhs) call fail_test('expected ' // text_i(lhs) // ' < ' // text_i(rhs), &
      message, location)
  end subroutine less_i

  !> lhs < rhs, reals.
  subroutine less_r(lhs, rhs, message, location)
    real(dp), intent(in) :: lhs, rhs
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. lhs < rhs) call fail_test('expected ' // text_r(lhs) // ' < ' // text_r(rhs), &
      message, location)
  end subroutine less_r

  !> lhs < every element of rhs.
  subroutine less_r01(lhs, rhs, message, location)
    real(dp), intent(in) :: lhs, rhs(:)
    integer :: i
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    do i = 1, size(rhs)
      if (lhs < rhs(i)) cycle
      call fail_test('expected ' // text_r(lhs) // ' < ' // text_r(rhs(i)) &
        // text_place(i, shape(rhs)), message, location)
      return
    end do
  end subroutine less_r01

  !> lhs <= rhs, integers.
  subroutine at_most_i(lhs, rhs, message, location)
    integer, intent(in) :: lhs, rhs
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. lhs <= rhs) call fail_test('expected ' // text_i(lhs) // ' <= ' // text_i(rhs), &
      message, location)
  end subroutine at_most_i

  !> lhs <= rhs, reals.
  subroutine at_most_r(lhs, rhs, message, location)
    real(dp), intent(in) :: lhs, rhs
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. lhs <= rhs) call fail_test('expected ' // text_r(lhs) // ' <= ' // text_r(rhs), &
      message, location)
  end subroutine at_most_r

  !> lhs <= every element of rhs.
  subroutine at_most_r01(lhs, rhs, message, location)
    real(dp), intent(in) :: lhs, rhs(:)
    integer :: i
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    do i = 1, size(rhs)
      if (lhs <= rhs(i)) cycle
      call fail_test('expected ' // text_r(lhs) // ' <= ' // text_r(rhs(i)) &
        // text_place(i, shape(rhs)), message, location)
      return
    end do
  end subroutine at_most_r01

  !> lhs > rhs, integers.
  subroutine greater_i(lhs, rhs, message, location)
    integer, intent(in) :: lhs, rhs
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. lhs > rhs) call fail_test('expected ' // text_i(lhs) // ' > ' // text_i(rhs), &
      message, location)
  end subroutine greater_i

  !> lhs > rhs, reals.
  subroutine greater_r(lhs, rhs, message, location)
    real(dp), intent(in) :: lhs, rhs
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. lhs > rhs) call fail_test('expected ' // text_r(lhs) // ' > ' // text_r(rhs), &
      message, location)
  end subroutine greater_r

  !> lhs > every element of rhs.
  subroutine greater_r01(lhs, rhs, message, location)
    real(dp), intent(in) :: lhs, rhs(:)
    integer :: i
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    do i = 1, size(rhs)
      if (lhs > rhs(i)) cycle
      call fail_test('expected ' // text_r(lhs) // ' > ' // text_r(rhs(i)) &
        // text_place(i, shape(rhs)), message, location)
      return
    end do
  end subroutine greater_r01

  !> lhs >= rhs, integers.
  subroutine at_least_i(lhs, rhs, message, location)
    integer, intent(in) :: lhs, rhs
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. lhs >= rhs) call fail_test('expected ' // text_i(lhs) // ' >= ' // text_i(rhs), &
      message, location)
  end subroutine at_least_i

  !> lhs >= rhs, reals.
  subroutine at_least_r(lhs, rhs, message, location)
    real(dp), intent(in) :: lhs, rhs
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. lhs >= rhs) call fail_test('expected ' // text_r(lhs) // ' >= ' // text_r(rhs), &
      message, location)
  end subroutine at_least_r

  !> lhs >= every element of rhs.
  subroutine at_least_r01(lhs, rhs, message, location)
    real(dp), intent(in) :: lhs, rhs(:)
    integer :: i
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    do i = 1, size(rhs)
      if (lhs >= rhs(i)) cycle
      call fail_test('expected ' // text_r(lhs) // ' >= ' // text_r(rhs(i)) &
        // text_place(i, shape(rhs)), message, location)
      return
    end do
  end subroutine at_least_r01

  !> Equal within tolerance * |expected|: vectors.
  subroutine relative_r11(expected, found, tolerance, message, location)
    real(dp), intent(in) :: expected(:), found(:)
    real(dp), intent(in) :: tolerance
    integer :: i
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. same_shape(shape(expected), shape(found), message, location)) return
    if (any(abs(expected) <= 0.0_dp)) then
      call fail_test('a relative comparison with an expected zero', message, location)
      return
    end if
    do i = 1, size(found)
      if (abs(found(i) - expected(i)) <= tolerance * abs(expected(i))) cycle
      call fail_test('expected ' // text_r(expected(i)) // ', found ' // text_r(found(i)) &
        // ', relative difference ' // text_r((found(i) - expected(i)) / expected(i)) &
        // ', tolerance ' // text_r(tolerance) // text_place(i, shape(found)), message, location)
      return
    end do
  end subroutine relative_r11

  !> Equal within tolerance * |expected|.
  subroutine relative_r00(expected, found, tolerance, message, location)
    real(dp), intent(in) :: expected, found, tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call relative_r11([expected], [found], tolerance, message, location)
  end subroutine relative_r00

  !> Equal within tolerance * |expected|: a vector of one value.
  subroutine relative_r01(expected, found, tolerance, message, location)
    real(dp), intent(in) :: expected, found(:), tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call relative_r11(spread(expected, 1, size(found)), found, tolerance, message, location)
  end subroutine relative_r01

  !> Not a number.
  subroutine assertIsNaN(x, message, location)
    real(dp), intent(in) :: x
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. ieee_is_nan(x)) call fail_test('expected NaN, found ' // text_r(x), message, location)
  end subroutine assertIsNaN

  !> Neither infinite nor not a number.
  subroutine assertIsFinite(x, message, location)
    real(dp), intent(in) :: x
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. ieee_is_finite(x)) call fail_test('expected a finite number, found ' // text_r(x), &
      message, location)
  end subroutine assertIsFinite

end module funit_order
