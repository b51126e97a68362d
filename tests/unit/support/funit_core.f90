! SPDX-License-Identifier: MIT
!> The running test, its verdict, and numbers as text: what all assertions of funit share.
!!
!! The counters are module variables because an assertion has no other place to leave its verdict.
module funit_core
  use, intrinsic :: iso_fortran_env, only: output_unit, real64
  implicit none
  private
  public :: dp, SourceLocation, anyExceptions, begin_test, end_test, finish_tests
  public :: fail_test, assertFail, text_i, text_r, text_place, same_shape

  integer, parameter :: dp = real64 !! kind of the reals that are compared

  !> Where an assertion stands.
  type :: SourceLocation
    character(len=80) :: file_name !! file without its folder
    integer :: line !! line number
  end type SourceLocation

  character(len=80) :: current_test = ''
  logical :: current_failed = .false.
  integer :: n_passed = 0
  integer :: n_failed = 0

contains

  !> Start a test; its name is out before it runs, so that a crash is seen to be its own.
  subroutine begin_test(name)
    character(len=*), intent(in) :: name !! name of the test

    current_test = name
    current_failed = .false.
    write (output_unit, '(2a)') 'test ', name
    flush (output_unit)
  end subroutine begin_test

  !> Count the test that ran.
  subroutine end_test()
    if (current_failed) then
      n_failed = n_failed + 1
    else
      n_passed = n_passed + 1
    end if
    current_failed = .false.
  end subroutine end_test

  !> Print the count; exit status 1 if a test failed or none ran.
  subroutine finish_tests()
    write (output_unit, '(i0,a,i0,a)') n_passed, ' passed, ', n_failed, ' failed'
    flush (output_unit)
    if (n_failed > 0 .or. n_passed == 0) stop 1
  end subroutine finish_tests

  !> Whether an assertion of the running test has failed.
  logical function anyExceptions()
    anyExceptions = current_failed
  end function anyExceptions

  !> Note and print a failure.
  subroutine fail_test(text, message, location)
    character(len=*), intent(in) :: text !! what was expected and found
    character(len=*), intent(in), optional :: message !! what the test says about it
    type(SourceLocation), intent(in), optional :: location !! where

    current_failed = .true.
    write (output_unit, '(2a)') 'FAILED ', trim(current_test)
    if (present(location)) then
      write (output_unit, '(2x,a,a,i0,a)', advance='no') trim(location%file_name), ':', &
        location%line, ':'
    end if
    if (present(message)) write (output_unit, '(1x,a)', advance='no') trim(message)
    write (output_unit, '(/,4x,a)') text
    flush (output_unit)
  end subroutine fail_test

  !> Fail whatever is the case.
  subroutine assertFail(message, location)
    character(len=*), intent(in) :: message
    type(SourceLocation), intent(in), optional :: location

    call fail_test('reached a place that fails', message, location)
  end subroutine assertFail

  !> An integer as text.
  pure function text_i(value) result(text)
    integer, intent(in) :: value
    character(len=:), allocatable :: text
    character(len=20) :: buffer

    write (buffer, '(i0)') value
    text = trim(buffer)
  end function text_i

  !> A real as text, with all its digits.
  pure function text_r(value) result(text)
    real(dp), intent(in) :: value
    character(len=:), allocatable :: text
    character(len=40) :: buffer

    write (buffer, '(es25.17e3)') value
    text = trim(adjustl(buffer))
  end function text_r

  !> The subscripts of the element at a position in array order, as text; empty for a scalar.
  pure function text_place(position, extents) result(text)
    integer, intent(in) :: position !! position in array order, from 1
    integer, intent(in) :: extents(:) !! shape of the array
    character(len=:), allocatable :: text
    integer :: i, rest

    text = ''
    rest = position - 1
    do i = 1, size(extents)
      if (i > 1) text = text // ','
      text = text // text_i(mod(rest, extents(i)) + 1)
      rest = rest / extents(i)
    end do
    if (size(extents) > 0) text = ' at (' // text // ')'
  end function text_place

  !> Whether two shapes agree; fails the test if not.
  logical function same_shape(expected, found, message, location)
    integer, intent(in) :: expected(:), found(:) !! the two shapes
    character(len=*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    same_shape = all(expected == found)
    if (.not. same_shape) call fail_test('the shapes differ: expected the extents' &
      // list(expected) // ', found' // list(found), message, location)

  contains

    function list(extents) result(text)
      integer, intent(in) :: extents(:)
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(extents)
        text = text // ' ' // text_i(extents(i))
      end do
    end function list
  end function same_shape

end module funit_core
