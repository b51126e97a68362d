! SPDX-License-Identifier: MIT
!> LU factorisation of a sparse matrix as a band (LAPACK dgbtrf, row exchanges), with its equations
!> in the order of reverse Cuthill-McKee (Cuthill & McKee 1969, George 1971) from a pseudo-
!> peripheral equation (George & Liu 1979).
module banded_lu_m
  use, intrinsic :: iso_c_binding, only : c_bool
  use kinds_m, only : long, wp
  use memory_m, only : available_bytes
  use sparse_m, only : sparse_t
  use system_m, only : expect_refusal
  implicit none
  private
  public :: banded_lu_t, order_equations, factor_banded, solve_banded, reverse_cuthill_mckee, &
    bandwidth

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
    call expect_refusal(.true._c_bool)
    allocate (factor%band(3*w + 1, matrix%n), factor%exchange(matrix%n), stat=status)
    call expect_refusal(.false._c_bool)
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

  !> order(k) is the equation that comes k-th. Two equations are neighbours where either
  !> has an entry for the other.
  pure function reverse_cuthill_mckee(matrix) result(order)
    type(sparse_t), intent(in) :: matrix
    integer :: order(matrix%n)
    type(sparse_t) :: pattern
    integer :: level(matrix%n) !! 0: not reached yet
    integer :: root, start, n_done, n_found

    pattern = symmetric_pattern(matrix)
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

  !> The pattern of the matrix and its transpose together, without values. Contact fills some
  !> entries on one side of the diagonal alone; a walk along rows would pass by such neighbours.
  pure function symmetric_pattern(matrix) result(pattern)
    type(sparse_t), intent(in) :: matrix
    type(sparse_t) :: pattern
    integer, allocatable :: first(:), row(:)
    integer :: i, n, a, b, next_a, next_b, least

    call transpose_pattern(matrix, first, row)
    pattern%n = matrix%n
    allocate (pattern%first(matrix%n + 1), pattern%column(2*size(matrix%column)))
    n = 0
    do i = 1, matrix%n
      pattern%first(i) = n + 1
      a = matrix%first(i)
      b = first(i)
      do while (a < matrix%first(i + 1) .or. b < first(i + 1))
        next_a = huge(1)
        next_b = huge(1)
        if (a < matrix%first(i + 1)) next_a = matrix%column(a)
        if (b < first(i + 1)) next_b = row(b)
        least = min(next_a, next_b)
        if (next_a == least) a = a + 1
        if (next_b == least) b = b + 1
        n = n + 1
        pattern%column(n) = least
      end do
    end do
    pattern%first(matrix%n + 1) = n + 1
  end function symmetric_pattern

  !> Rows of the entries of each column, rising.
  pure subroutine transpose_pattern(matrix, first, row)
    type(sparse_t), intent(in) :: matrix
    integer, allocatable, intent(out) :: first(:) !! (n + 1) where each column starts ...
    integer, allocatable, intent(out) :: row(:)   !! ... in these
    integer, allocatable :: next(:)
    integer :: i, k

    allocate (first(matrix%n + 1), row(size(matrix%column)), source=0)
    do k = 1, size(matrix%column)
      first(matrix%column(k) + 1) = first(matrix%column(k) + 1) + 1
    end do
    first(1) = 1
    do i = 1, matrix%n
      first(i + 1) = first(i + 1) + first(i)
    end do
    next = first
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        row(next(matrix%column(k))) = i
        next(matrix%column(k)) = next(matrix%column(k)) + 1
      end do
    end do
  end subroutine transpose_pattern

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
    integer :: i, j, moved

    do i = 2, size(equations)
      moved = equations(i)
      do j = i - 1, 1, -1
        if (degree(matrix, equations(j)) <= degree(matrix, moved)) exit
        equations(j + 1) = equations(j)
      end do
      equations(j + 1) = moved
    end do
  end subroutine sort_by_degree

  !> Entries of a row.
  pure integer function degree(matrix, row)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: row

    degree = matrix%first(row + 1) - matrix%first(row)
  end function degree

  !> Largest distance of an entry from the diagonal when the equations are ordered so.
  pure function bandwidth(matrix, order) result(width)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: order(:) !! (n)
    integer :: width
    integer :: place(matrix%n), i, k

    do i = 1, matrix%n
      place(order(i)) = i
    end do
    width = 0
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        width = max(width, abs(place(matrix%column(k)) - place(i)))
      end do
    end do
  end function bandwidth

end module banded_lu_m
