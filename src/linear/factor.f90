! SPDX-License-Identifier: MIT
!> LU factors of a sparse matrix, by the method that suits it: as a band where the bandwidth is
!> small, else sparse.
module factor_m
  use banded_lu_m, only : banded_lu_t, factor_banded, order_equations, solve_banded
  use kinds_m, only : wp
  use sparse_m, only : sparse_t
  use umfpack_m, only : factor_umfpack, free_umfpack, has_umfpack, solve_umfpack, umfpack_t
  implicit none
  private
  public :: factor_t, method_best, method_banded, method_sparse, factor_matrix, solve_factored, &
    free_factor

  !> Methods: choose, or take the one named.
  integer, parameter :: method_best = 0, method_banded = 1, method_sparse = 2

  !> Widest band that goes to LAPACK where UMFPACK is there. Seconds to factorise on one core
  !> (gfortran 12, reference BLAS), quads with two equations a node, banded against sparse:
  !>   square meshes          20 x 20 (bandwidth 79)  0.003/0.002,  40 x 40 (159)  0.041/0.012,
  !>                          100 x 100 (399)  1.35/0.13
  !>   slender meshes         4000 x 10 (45)  0.06/0.47,  500 x 20 (85)  0.09/0.11
  integer, parameter :: widest_band = 80

  !> Smallest pivot that is solved with, for entries of about one: far below what rounding leaves of
  !> a pivot that is zero, but large enough for nothing to overflow.
  real(wp), parameter :: least_pivot = 1.0e-3_wp*epsilon(1.0_wp)

  !> The factors; of the two only one is filled. To be given to free_factor in the end.
  type :: factor_t
    integer :: method = method_banded  !! method used
    type(banded_lu_t) :: banded        !! ordered even where the method is another
    type(umfpack_t) :: sparse
    logical :: is_negative = .false.   !! the determinant
    logical :: has_tiny_pivot = .false. !! sparse: nothing can be solved, not even a nearby system
  end type factor_t

contains

  !> Factorise a compressed matrix that is equilibrated. `factored` is false where memory does not
  !> suffice.
  subroutine factor_matrix(matrix, method, factor, factored)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: method          !! one of `method_`
    type(factor_t), intent(inout) :: factor
    logical, intent(out) :: factored

    call order_equations(matrix, factor%banded)
    factor%method = method
    if (method == method_best) factor%method = merge(method_sparse, method_banded, &
      has_umfpack .and. factor%banded%width > widest_band)
    select case (factor%method)
    case (method_sparse)
      call factor_sparse(matrix, factor, factored)
      factor%is_negative = factor%sparse%is_negative
    case default
      call factor_banded(matrix, least_pivot, factor%banded, factored)
      factor%is_negative = factor%banded%is_negative
    end select
  end subroutine factor_matrix

  !> Sparse factors. A matrix with a zero pivot is factorised again with its diagonal changed in the
  !> last digit of one, which no entry exceeds by much: singular still, but to be solved with.
  subroutine factor_sparse(matrix, factor, factored)
    type(sparse_t), intent(in) :: matrix
    type(factor_t), intent(inout) :: factor
    logical, intent(out) :: factored
    type(sparse_t) :: shifted
    integer :: i, k

    call factor_umfpack(matrix, factor%sparse, factored)
    factor%has_tiny_pivot = .false.
    if (.not. factored .or. factor%sparse%smallest_pivot >= least_pivot) return
    shifted%n = matrix%n
    shifted%first = matrix%first
    shifted%column = matrix%column
    shifted%value = matrix%value
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        if (matrix%column(k) == i) shifted%value(k) = matrix%value(k) + 2.0_wp*epsilon(1.0_wp)
      end do
    end do
    call factor_umfpack(shifted, factor%sparse, factored)
    factor%has_tiny_pivot = factor%sparse%smallest_pivot < least_pivot
  end subroutine factor_sparse

  !> x := A^-1 b, or A^-T b.
  subroutine solve_factored(factor, transposed, b, x)
    type(factor_t), intent(in) :: factor
    logical, intent(in) :: transposed !! solve with the transpose
    real(wp), intent(in) :: b(:)      !! (n)
    real(wp), intent(out) :: x(:)     !! (n)

    select case (factor%method)
    case (method_sparse)
      call solve_umfpack(factor%sparse, transposed, b, x)
    case default
      call solve_banded(factor%banded, transposed, b, x)
    end select
  end subroutine solve_factored

  !> Give the memory back.
  subroutine free_factor(factor)
    type(factor_t), intent(inout) :: factor

    call free_umfpack(factor%sparse)
    factor%banded = banded_lu_t()
  end subroutine free_factor

end module factor_m
