! SPDX-License-Identifier: MIT
!> Equality of integers, logicals, strings and reals, scalars and arrays.
module funit_equal
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use funit_core, only: dp, SourceLocation, fail_test, text_i, text_r, text_place, same_shape
  implicit none
  private
  public :: assertEqual

  interface assertEqual
    module procedure equal_i00, equal_i11, equal_i22, equal_i01
    module procedure equal_l00, equal_l11
    module procedure equal_c00
    module procedure equal_r00, equal_r11, equal_r22, equal_r01, equal_r02
    module procedure near_r00, near_r11, near_r22, near_r01, near_r02
    module procedure equal_ir00, near_ir00, equal_ir01, near_ir01
  end interface assertEqual

contains

  !> Compare integers in array order.
  subroutine compare_i(expected, found, extents, message, location)
    integer, intent(in) :: expected(:), found(:) !! values
    integer, intent(in) :: extents(:) !! shape they had
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    integer :: i

    do i = 1, size(found)
      if (expected(i) == found(i)) cycle
      call fail_test('expected ' // text_i(expected(i)) // ', found ' // text_i(found(i)) &
        // text_place(i, extents), message, location)
      return
    end do
  end subroutine compare_i

  !> Compare logicals in array order.
  subroutine compare_l(expected, found, extents, message, location)
    logical, intent(in) :: expected(:), found(:) !! values
    integer, intent(in) :: extents(:) !! shape they had
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    integer :: i

    do i = 1, size(found)
      if (expected(i) .eqv. found(i)) cycle
      call fail_test('expected ' // merge('true ', 'false', expected(i)) // ', found ' &
        // trim(merge('true ', 'false', found(i))) // text_place(i, extents), message, location)
      return
    end do
  end subroutine compare_l

  !> Compare reals in array order; equal values pass first, so that infinities can be expected.
  subroutine compare_r(expected, found, tolerance, extents, message, location)
    real(dp), intent(in) :: expected(:), found(:) !! values
    real(dp), intent(in) :: tolerance !! absolute
    integer, intent(in) :: extents(:) !! shape they had
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    integer :: i

    do i = 1, size(found)
      if (.not. (ieee_is_nan(expected(i)) .or. ieee_is_nan(found(i)))) then
        if (expected(i) == found(i)) cycle
        if (abs(found(i) - expected(i)) <= tolerance) cycle
      end if
      call fail_test('expected ' // text_r(expected(i)) // ', found ' // text_r(found(i)) &
        // ', difference ' // text_r(found(i) - expected(i)) // ', tolerance ' &
        // text_r(tolerance) // text_place(i, extents), message, location)
      return
    end do
  end subroutine compare_r

  !> Equal integers.
  subroutine equal_i00(expected, found, message, location)
    integer, intent(in) :: expected, found
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call compare_i([expected], [found], [integer ::], message, location)
  end subroutine equal_i00

  !> Equal integer vectors.
  subroutine equal_i11(expected, found, message, location)
    integer, intent(in) :: expected(:), found(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. same_shape(shape(expected), shape(found), message, location)) return
    call compare_i(expected, found, shape(found), message, location)
  end subroutine equal_i11

  !> Equal integer matrices.
  subroutine equal_i22(expected, found, message, location)
    integer, intent(in) :: expected(:,:), found(:,:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. same_shape(shape(expected), shape(found), message, location)) return
    call compare_i(reshape(expected, [size(expected)]), &
      reshape(found, [size(found)]), shape(found), message, location)
  end subroutine equal_i22

  !> A vector of one integer.
  subroutine equal_i01(expected, found, message, location)
    integer, intent(in) :: expected, found(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call compare_i(spread(expected, 1, size(found)), found, shape(found), message, location)
  end subroutine equal_i01

  !> Equal logicals.
  subroutine equal_l00(expected, found, message, location)
    logical, intent(in) :: expected, found
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call compare_l([expected], [found], [integer ::], message, location)
  end subroutine equal_l00

  !> Equal logical vectors.
  subroutine equal_l11(expected, found, message, location)
    logical, intent(in) :: expected(:), found(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. same_shape(shape(expected), shape(found), message, location)) return
    call compare_l(expected, found, shape(found), message, location)
  end subroutine equal_l11

  !> Equal strings, without the blanks at their ends.
  subroutine equal_c00(expected, found, message, location)
    character(len=*), intent(in) :: expected, found
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (trim(adjustl(expected)) == trim(adjustl(found))) return
    call fail_test('expected "' // trim(expected) // '", found "' // trim(found) // '"', &
      message, location)
  end subroutine equal_c00

  !> Exactly equal: reals.
  subroutine equal_r00(expected, found, message, location)
    real(dp), intent(in) :: expected, found
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(expected, found, 0.0_dp, message, location)
  end subroutine equal_r00

  !> Equal within a tolerance: reals.
  subroutine near_r00(expected, found, tolerance, message, location)
    real(dp), intent(in) :: expected, found
    real(dp), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call compare_r([expected], [found], tolerance, [integer ::], &
      message, location)
  end subroutine near_r00

  !> Exactly equal: vectors.
  subroutine equal_r11(expected, found, message, location)
    real(dp), intent(in) :: expected(:), found(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(expected, found, 0.0_dp, message, location)
  end subroutine equal_r11

  !> Equal within a tolerance: vectors.
  subroutine near_r11(expected, found, tolerance, message, location)
    real(dp), intent(in) :: expected(:), found(:)
    real(dp), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. same_shape(shape(expected), shape(found), message, location)) return
    call compare_r(expected, found, tolerance, shape(found), &
      message, location)
  end subroutine near_r11

  !> Exactly equal: matrices.
  subroutine equal_r22(expected, found, message, location)
    real(dp), intent(in) :: expected(:,:), found(:,:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(expected, found, 0.0_dp, message, location)
  end subroutine equal_r22

  !> Equal within a tolerance: matrices.
  subroutine near_r22(expected, found, tolerance, message, location)
    real(dp), intent(in) :: expected(:,:), found(:,:)
    real(dp), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (.not. same_shape(shape(expected), shape(found), message, location)) return
    call compare_r(reshape(expected, [size(expected)]), &
      reshape(found, [size(found)]), tolerance, shape(found), message, location)
  end subroutine near_r22

  !> Exactly equal: a vector of one value.
  subroutine equal_r01(expected, found, message, location)
    real(dp), intent(in) :: expected, found(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(expected, found, 0.0_dp, message, location)
  end subroutine equal_r01

  !> Equal within a tolerance: a vector of one value.
  subroutine near_r01(expected, found, tolerance, message, location)
    real(dp), intent(in) :: expected, found(:)
    real(dp), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call compare_r(spread(expected, 1, size(found)), found, tolerance, shape(found), &
      message, location)
  end subroutine near_r01

  !> Exactly equal: a matrix of one value.
  subroutine equal_r02(expected, found, message, location)
    real(dp), intent(in) :: expected, found(:,:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(expected, found, 0.0_dp, message, location)
  end subroutine equal_r02

  !> Equal within a tolerance: a matrix of one value.
  subroutine near_r02(expected, found, tolerance, message, location)
    real(dp), intent(in) :: expected, found(:,:)
    real(dp), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call compare_r(spread(expected, 1, size(found)), &
      reshape(found, [size(found)]), tolerance, shape(found), message, location)
  end subroutine near_r02

  !> A whole number expected of a real.
  subroutine equal_ir00(expected, found, message, location)
    integer, intent(in) :: expected
    real(dp), intent(in) :: found
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(real(expected, dp), found, 0.0_dp, message, location)
  end subroutine equal_ir00

  !> A whole number, within a tolerance, expected of a real.
  subroutine near_ir00(expected, found, tolerance, message, location)
    integer, intent(in) :: expected
    real(dp), intent(in) :: found
    real(dp), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(real(expected, dp), found, tolerance, message, location)
  end subroutine near_ir00

  !> A whole number expected of a vector.
  subroutine equal_ir01(expected, found, message, location)
    integer, intent(in) :: expected
    real(dp), intent(in) :: found(:)
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(real(expected, dp), found, 0.0_dp, message, location)
  end subroutine equal_ir01

  !> A whole number, within a tolerance, expected of a vector.
  subroutine near_ir01(expected, found, tolerance, message, location)
    integer, intent(in) :: expected
    real(dp), intent(in) :: found(:)
    real(dp), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    call assertEqual(real(expected, dp), found, tolerance, message, location)
  end subroutine near_ir01

end module funit_equal
