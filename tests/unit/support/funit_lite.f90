! SPDX-License-Identifier: MIT
!> Assertions for the unit tests where pFUnit is not installed.
!!
!! Names, argument order and meaning are those of pFUnit 4, for the part that the tests use: an
!! assertion takes what is expected first; a scalar may be expected of a whole array; blanks at both
!! ends of strings are ignored; a real is equal when it is within the absolute tolerance (zero
!! unless given); a relative comparison with zero fails.  What is missing here does not compile.
module funit
  use funit_core, only: SourceLocation, anyExceptions, begin_test, end_test, finish_tests, &
    assertFail
  use funit_equal, only: assertEqual
  use funit_order, only: assertTrue, assertFalse, assertIsNaN, assertIsFinite, &
    assertRelativelyEqual, assertLessThan, assertLessThanOrEqual, assertGreaterThan, &
    assertGreaterThanOrEqual
  implicit none
  public
end module funit
