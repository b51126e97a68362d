! SPDX-License-Identifier: MIT
!> LU factorisation of a sparse matrix as a band (LAPACK dgbtrf, row exchanges), with its equations
!> in the order of reverse Cuthill-McKee (Cuthill & McKee 1969, George 1971) from a pseudo-
!> peripheral equation (George & Liu 1979).
module banded_lu_m
  use, intrinsic :: iso_c_binding, only : c_bool
  use kinds_m, only : long, wp
  use memory_m, only : available_bytes
  use sparse_m, only : compress_matrix, sparse_t
  use system_m, only : expect_refusal
  implicit none
  private
  public :: banded_lu_t, factor_banded, solve_banded, reverse_cuthill_mckee, bandwidth

  !> A factorised matrix.
  type :: banded_lu_t
    integer :: width = 0                !! bandwidth on either side
    integer, allocatable :: order(:)    !! (n) the equation that comes k-th
    integer, allocatable :: exchange(:) !! (n) row exchanges
    real(wp), allocatable :: band(:, :) !! (3 width + 1, n) the factors, as dgbtrf leaves them
    integer(long) :: bytes = 0          !! memory that the band needs
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

  !> Factorise; `factored` is false where memory does not suffice. Entry (i, j) of the ordered
  !> matrix goes to row 2 width + 1 + i - j of column j. A pivot below `least_pivot` (a singular
  !> matrix) is set to that, so that one can solve in any case.
  subroutine factor_banded(matrix, least_pivot, factor, factored)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(in) :: least_pivot
    type(banded_lu_t), intent(inout) :: factor !! order, width and bytes are known
    logical, intent(out) :: factored
    integer :: place(matrix%n), i, j, k, status, w

    factored = .false.
    if (factor%bytes > available_bytes()) return
    w = factor%width
    call expect_refusal(.true._c_bool)
    allocate (factor%band(3*w + 1, matrix%n), factor%exchange(matrix%n), stat=status)
    call expect_refusal(.false._c_bool)
    if (status /= 0) return
    place(factor%order) = [(i, i=1, matrix%n)]
    factor%band = 0.0_wp
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        j = place(matrix%column(k))
        factor%band(2*w + 1 + place(i) - j, j) = matrix%value(k)
      end do
    end do
    call dgbtrf(matrix%n, matrix%n, w, w, factor%band, 3*w + 1, factor%exchange, status)
    do i = 1, matrix%n
      if (abs(factor%band(2*w + 1, i)) < least_pivot) &
        factor%band(2*w + 1, i) = sign(least_pivot, factor%band(2*w + 1, i))
    end do
    factor%is_negative = mod(count(factor%band(2*w + 1, :) < 0.0_wp) &
      + count(factor%exchange /= [(i, i=1, matrix%n)]), 2) == 1
    factored = .true.
  end subroutine factor_banded

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

  !> order(k) is the equation that comes k-th. Two equations are neighbours where either
  !> has an entry for the other.
  pure function reverse_cuthill_mckee(matrix) result(order)
    type(sparse_t), intent(in) :: matrix
    integer :: order(matrix%n)
    type(sparse_t) :: pattern
    integer :: level(matrix%n) !! 0: not reached yet
    integer, allocatable :: rows(:)
    integer :: root, start, n_done, n_found, i, k

    ! The matrix and its transpose together, values zero: contact fills some entries on one side of
    ! the diagonal alone, and a walk along rows would pass by such neighbours.
    rows = [((i, k=matrix%first(i), matrix%first(i + 1) - 1), i=1, matrix%n)]
    pattern%n = matrix%n
    pattern%n_entry = 2*size(rows)
    pattern%rows = [rows, matrix%column]
    pattern%columns = [matrix%column, rows]
    allocate (pattern%values(pattern%n_entry), source=0.0_wp)
    call compress_matrix(pattern)
    level = 0
    n_done = 0
    do root = 1, matrix%n
      if (level(root) /= 0) cycle
      call find_end(pattern, root, level, order(n_done + 1:), start)
      call walk_from(pattern, start, level, order(n_done + 1:), n_found)
      n_done = n_done + n_found
    end do
    order = order(matrix%n:1:-1)
  end function reverse_cuthill_mckee

  !> An equation at one end of the connected part that holds `root`: from there the walk has the
  !> most, and so the narrowest, levels.
  pure subroutine find_end(matrix, root, level, found, start)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: root
    integer, intent(inout) :: level(:) !! 0 for all equations of the part, now and afterwards
    integer, intent(inout) :: found(:) !! room for its equations
    integer, intent(out) :: start
    integer :: n_found, depth, deepest, candidate

    deepest = 0
    start = root
    candidate = root
    do
      call walk_from(matrix, candidate, level, found, n_found)
      depth = level(found(n_found))
      level(found(:n_found)) = 0
      if (depth <= deepest) exit
      deepest = depth
      start = candidate
      candidate = found(n_found)
    end do
  end subroutine find_end

  !> Breadth-first walk, the neighbours of each equation by their number of neighbours.
  pure subroutine walk_from(matrix, start, level, found, n_found)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: start
    integer, intent(inout) :: level(:) !! 0: not reached; else one more than steps from the start
    integer, intent(inout) :: found(:) !! equations in the order reached
    integer, intent(out) :: n_found
    integer :: next, equation, i, k, n_old

    found(1) = start
    level(start) = 1
    n_found = 1
    next = 1
    do while (next <= n_found)
      equation = found(next)
      next = next + 1
      n_old = n_found
      do k = matrix%first(equation), matrix%first(equation + 1) - 1
        i = matrix%column(k)
        if (level(i) /= 0) cycle
        level(i) = level(equation) + 1
        n_found = n_found + 1
        found(n_found) = i
      end do
      call sort_by_degree(matrix, found(n_old + 1:n_found))
    end do
  end subroutine walk_from

  !> Insertion sort, stable; lists are short.
  pure subroutine sort_by_degree(matrix, equations)
    type(sparse_t), intent(in) :: matrix
    integer, intent(inout) :: equations(:)
    integer :: degrees(size(equations)), i, j, moved(2)

    degrees = matrix%first(equations + 1) - matrix%first(equations)
    do i = 2, size(equations)
      moved = [equations(i), degrees(i)]
      do j = i - 1, 1, -1
        if (degrees(j) <= moved(2)) exit
        equations(j + 1) = equations(j)
        degrees(j + 1) = degrees(j)
      end do
      equations(j + 1) = moved(1)
      degrees(j + 1) = moved(2)
    end do
  end subroutine sort_by_degree

  !> Largest distance of an entry from the diagonal when the equations are ordered so.
  pure function bandwidth(matrix, order) result(width)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: order(:) !! (n)
    integer :: width
    integer :: place(matrix%n), i, k

    place(order) = [(i, i=1, matrix%n)]
    width = 0
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        width = max(width, abs(place(matrix%column(k)) - place(i)))
      end do
    end do
  end function bandwidth

end module banded_lu_m
