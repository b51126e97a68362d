! SPDX-License-Identifier: MIT
!> Counterpart of `with_umfpack` for builds without UMFPACK: factorisation always fails, and
!> `has_umfpack` is false.
module umfpack_m
  use kinds_m, only : long, wp
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: umfpack_t, has_umfpack, factor_umfpack, solve_umfpack, free_umfpack

  !> UMFPACK is not available.
  logical, parameter :: has_umfpack = .false.

  !> Components that other modules read.
  type :: umfpack_t
    real(wp) :: smallest_pivot = 0.0_wp !! absolute value
    integer(long) :: bytes = 0          !! memory of the factors
    logical :: is_negative = .false.    !! the determinant
  end type umfpack_t

contains

  !> Fails, except for an empty system.
  subroutine factor_umfpack(matrix, factor, factored)
    type(sparse_t), intent(in) :: matrix
    type(umfpack_t), intent(inout) :: factor
    logical, intent(out) :: factored

    factored = matrix%n == 0
  end subroutine factor_umfpack

  !> Copies b, the solution of the empty system.
  subroutine solve_umfpack(factor, transposed, b, x)
    type(umfpack_t), intent(in) :: factor
    logical, intent(in) :: transposed !! solve with the transpose
    real(wp), intent(in) :: b(:)      !! (n)
    real(wp), intent(out) :: x(:)     !! (n)

    x = b
    if (transposed .and. factor%bytes > 0) x = 0.0_wp
  end subroutine solve_umfpack

  !> Nothing to free.
  subroutine free_umfpack(factor)
    type(umfpack_t), intent(inout) :: factor

    factor%bytes = 0
  end subroutine free_umfpack

end module umfpack_m
