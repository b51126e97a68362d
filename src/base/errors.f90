! SPDX-License-Identifier: MIT
!> Errors as values: a procedure that can fail ends with
!> `type(error_t), allocatable, intent(out) :: error` and its caller tests `allocated(error)`.
module errors_m
  implicit none
  private
  public :: error_t, raise, status_normal, status_input, status_run, status_files, status_stopped

  !> Exit statuses of the program.
  integer, parameter :: status_normal = 0, status_input = 1, status_run = 2, status_files = 3, &
    status_stopped = 4

  !> Message to the user and exit status.
  type :: error_t
    character(:), allocatable :: message !! may hold several lines
    integer :: status = status_input     !! one of the `status_` constants
  end type error_t

contains

  !> Allocate an error with its message and exit status.
  subroutine raise(error, message, status)
    type(error_t), allocatable, intent(out) :: error !! the error made
    character(*), intent(in) :: message
    integer, intent(in) :: status                    !! exit status

    allocate (error)
    error%message = message
    error%status = status
  end subroutine raise

end module errors_m
