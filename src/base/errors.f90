! SPDX-License-Identifier: MIT
!> Errors as values: a procedure that can fail ends with
!> `type(error_t), allocatable, intent(out) :: error` and its caller asks
!> `if (allocated(error)) return`.
module errors_m
  implicit none
  private
  public :: error_t, raise, status_normal, status_input, status_run, status_files, status_stopped

  !> Exit statuses of the program.
  integer, parameter :: status_normal = 0, status_input = 1, status_run = 2, status_files = 3, &
    status_stopped = 4

  !> What went wrong, in words for the user, and the exit status that follows from it.
  type :: error_t
    character(:), allocatable :: message !! may hold several lines
    integer :: status = status_input     !! one of the `status_` constants
  end type error_t

contains

  !> Make an error.
  subroutine raise(error, message, status)
    type(error_t), allocatable, intent(out) :: error !! the error made
    character(*), intent(in) :: message              !! what was found and what was expected
    integer, intent(in) :: status                    !! exit status

    allocate (error)
    error%message = message
    error%status = status
  end subroutine raise

end module errors_m
