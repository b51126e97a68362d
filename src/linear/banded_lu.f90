! SPDX-License-Identifier: MIT
!> LU factorisation of a sparse matrix as a band (LAPACK dgbtrf, row exchanges), with its equations
!> in the order of reverse Cuthill-McKee.
module banded_lu_m
  use bandwidth_m, only : bandwidth, reverse_cuthill_mckee
  use kinds_m, only : long, wp
  use memory_m, only : available_bytes
  use refused_memory_m, only : expect_refusal
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: banded_lu_t, order_equations, factor_banded, solve_banded

  !> A factorised matrix.
  type :: banded_lu_t
    integer :: width = 0                !! bandwidth on either side
    integer, allocatable :: order(:)    !! (n) the equation that comes k-th
    integer, allocatable :: exchange(:) !! (n) row exchanges
    real(wp), allocatable :: band(:, :) !! (3 width + 1, n) the factors, as dgbtrf leaves them
    integer(long) :: bytes = 0          !! memory of the band
    logical :: is_negative = .false.    !! the determinant
  end type banded_lu_t

  interface
    !> LAPACK: LU factorisation of a band matrix.
    subroutine dgbtrf(m, n, kl, ku, ab, ldab, ipiv, info)
      import :: wp
      integer, intent(in) :: m, n, kl, ku, ldab
      real(wp), intent(inout) :: ab(ldab, *)
      integer, intent(out) :: ipiv(*)
      integer, intent(out) :: info
    end subroutine dgbtrf

    !> LAPACK: solve with the factors of dgbtrf.
    subroutine dgbtrs(trans, n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
      import :: wp
      character, intent(in) :: trans
      integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb
      real(wp), intent(in) :: ab(ldab, *)
      integer, intent(in) :: ipiv(*)
      real(wp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
    end subroutine dgbtrs
  end interface

contains

  !> Order the equations; afterwards the bandwidth and the memory that the factors need are known.
  pure subroutine order_equations(matrix, factor)
    type(sparse_t), intent(in) :: matrix
    type(banded_lu_t), intent(out) :: factor

    factor%order = reverse_cuthill_mckee(matrix)
    factor%width = bandwidth(matrix, factor%order)
    factor%bytes = 8_long*(3_long*factor%width + 1)*matrix%n
  end subroutine order_equations

  !> Factorise; `factored` is false where memory does not suffice. A pivot below `least_pivot` (a
  !> singular matrix) is set to that, so that one can solve in any case.
  subroutine factor_banded(matrix, least_pivot, factor, factored)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(in) :: least_pivot
    type(banded_lu_t), intent(inout) :: factor !! equations ordered
    logical, intent(out) :: factored
    integer :: i, status, w

    factored = .false.
    if (factor%bytes > available_bytes()) return
    w = factor%width
    call expect_refusal(.true.)
    allocate (factor%band(3*w + 1, matrix%n), factor%exchange(matrix%n), stat=status)
    call expect_refusal(.false.)
    if (status /= 0) return
    call fill_band(matrix, factor)
    call dgbtrf(matrix%n, matrix%n, w, w, factor%band, 3*w + 1, factor%exchange, status)
    do i = 1, matrix%n
      if (abs(factor%band(2*w + 1, i)) < least_pivot) &
        factor%band(2*w + 1, i) = sign(least_pivot, factor%band(2*w + 1, i))
    end do
    factor%is_negative = mod(count(factor%band(2*w + 1, :) < 0.0_wp) &
      + count(factor%exchange /= [(i, i=1, matrix%n)]), 2) == 1
    factored = .true.
  end subroutine factor_banded

  !> Entry (i, j) of the ordered matrix to row 2 width + 1 + i - j of column j.
  pure subroutine fill_band(matrix, factor)
    type(sparse_t), intent(in) :: matrix
    type(banded_lu_t), intent(inout) :: factor
    integer :: place(matrix%n), i, j, k

    do i = 1, matrix%n
      place(factor%order(i)) = i
    end do
    factor%band = 0.0_wp
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        j = place(matrix%column(k))
        factor%band(2*factor%width + 1 + place(i) - j, j) = matrix%value(k)
      end do
    end do
  end subroutine fill_band

  !> x := A^-1 b, or A^-T b.
  subroutine solve_banded(factor, transposed, b, x)
    type(banded_lu_t), intent(in) :: factor
    logical, intent(in) :: transposed !! solve with the transpose
    real(wp), intent(in) :: b(:)      !! (n)
    real(wp), intent(out) :: x(:)     !! (n)
    real(wp) :: ordered(size(b), 1)
    integer :: status, w

    w = factor%width
    ordered(:, 1) = b(factor%order)
    call dgbtrs(merge('T', 'N', transposed), size(b), w, w, 1, factor%band, 3*w + 1, &
      factor%exchange, ordered, size(b), status)
    x(factor%order) = ordered(:, 1)
  end subroutine solve_banded

end module banded_lu_m
