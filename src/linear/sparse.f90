! SPDX-License-Identifier: MIT
!> Sparse square matrix, assembled from small dense blocks: entries are collected and then
!> compressed to rows, duplicates summed. Banded LU factorisation (LAPACK dgbtrf, row exchanges)
!> with equations in reverse Cuthill-McKee order (Cuthill & McKee 1969, George 1971) from a
!> pseudo-peripheral equation (George & Liu 1979).
module sparse_m
  use, intrinsic :: iso_c_binding, only : c_bool
  use kinds_m, only : wp, long
  use memory_m, only : available_bytes
  use system_m, only : expect_allocation_failure
  implicit none
  private
  public :: sparse_t, start_matrix, add_block, compress_matrix, multiply, banded_lu_t, &
    factor_banded, solve_banded, reverse_cuthill_mckee, bandwidth

  !> Sparse matrix: collected entries before compression, rows afterwards.
  type :: sparse_t
    integer :: n = 0                        !! rows and columns
    integer :: n_entry = 0                  !! collected entries
    integer, allocatable :: rows(:)         !! (capacity) of the collected entries
    integer, allocatable :: columns(:)      !! (capacity)
    real(wp), allocatable :: values(:)      !! (capacity)
    integer, allocatable :: first(:)        !! (n + 1) where each row starts ...
    integer, allocatable :: column(:)       !! ... in these: column numbers, rising in each row
    real(wp), allocatable :: value(:)       !! and entries
  end type sparse_t

  !> Banded LU factors.
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

  !> Empty matrix of n rows; memory of an earlier one is reused.
  pure subroutine start_matrix(matrix, n)
    type(sparse_t), intent(inout) :: matrix
    integer, intent(in) :: n

    matrix%n = n
    matrix%n_entry = 0
    ! Four quads at a node with eight columns each: 32 entries per equation, and some contact.
    if (.not. allocated(matrix%rows)) &
      allocate (matrix%rows(40*n + 64), matrix%columns(40*n + 64), matrix%values(40*n + 64))
  end subroutine start_matrix

  !> Add a dense block; equation number 0 leaves a row or column out.
  pure subroutine add_block(matrix, row_equations, column_equations, block)
    type(sparse_t), intent(inout) :: matrix
    integer, intent(in) :: row_equations(:)    !! (m)
    integer, intent(in) :: column_equations(:) !! (k)
    real(wp), intent(in) :: block(:, :)        !! (m, k)
    integer :: i, j, more

    associate (n => matrix%n_entry, capacity => size(matrix%rows))
      more = max(capacity, n + size(block) - capacity)
      if (n + size(block) > capacity) then
        matrix%rows = [matrix%rows(:n), spread(0, 1, capacity + more - n)]
        matrix%columns = [matrix%columns(:n), spread(0, 1, capacity + more - n)]
        matrix%values = [matrix%values(:n), spread(0.0_wp, 1, capacity + more - n)]
      end if
    end associate
    do j = 1, size(column_equations)
      if (column_equations(j) == 0) cycle
      do i = 1, size(row_equations)
        if (row_equations(i) == 0) cycle
        matrix%n_entry = matrix%n_entry + 1
        matrix%rows(matrix%n_entry) = row_equations(i)
        matrix%columns(matrix%n_entry) = column_equations(j)
        matrix%values(matrix%n_entry) = block(i, j)
      end do
    end do
  end subroutine add_block

  !> Compress the collected entries to rows: two counting sorts (by column, then stably by row),
  !> then duplicates are summed in the order of their addition.
  pure subroutine compress_matrix(matrix)
    type(sparse_t), intent(inout) :: matrix
    integer, allocatable :: as_entered(:), by_column(:), by_row(:)
    integer :: i, k, n, row

    allocate (by_column(matrix%n_entry), by_row(matrix%n_entry))
    as_entered = [(i, i=1, matrix%n_entry)]
    call sort_by(matrix%columns(:matrix%n_entry), as_entered, matrix%n, by_column)
    call sort_by(matrix%rows(:matrix%n_entry), by_column, matrix%n, by_row)
    if (allocated(matrix%first)) deallocate (matrix%first, matrix%column, matrix%value)
    allocate (matrix%first(matrix%n + 1), source=0)
    allocate (matrix%column(matrix%n_entry), matrix%value(matrix%n_entry))
    n = 0
    row = 0
    do i = 1, matrix%n_entry
      k = by_row(i)
      if (matrix%rows(k) == row .and. n > 0) then
        if (matrix%column(n) == matrix%columns(k)) then
          matrix%value(n) = matrix%value(n) + matrix%values(k)
          cycle
        end if
      end if
      n = n + 1
      if (matrix%rows(k) /= row) matrix%first(row + 1:matrix%rows(k)) = n
      row = matrix%rows(k)
      matrix%column(n) = matrix%columns(k)
      matrix%value(n) = matrix%values(k)
    end do
    matrix%first(row + 1:) = n + 1
    matrix%column = matrix%column(:n)
    matrix%value = matrix%value(:n)
  end subroutine compress_matrix

  !> `items` sorted by keys(items), 1 to n_key, stable.
  pure subroutine sort_by(keys, items, n_key, order)
    integer, intent(in) :: keys(:)
    integer, intent(in) :: items(:)
    integer, intent(in) :: n_key
    integer, intent(out) :: order(:) !! (size(items))
    integer, allocatable :: start(:)
    integer :: i, key

    allocate (start(n_key + 1))
    start = 0
    do i = 1, size(items)
      start(keys(items(i)) + 1) = start(keys(items(i)) + 1) + 1
    end do
    start(1) = 1
    do key = 2, n_key + 1
      start(key) = start(key) + start(key - 1)
    end do
    do i = 1, size(items)
      key = keys(items(i))
      order(start(key)) = items(i)
      start(key) = start(key) + 1
    end do
  end subroutine sort_by

  !> y = A x for a compressed matrix.
  pure function multiply(matrix, x) result(y)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(in) :: x(:) !! (n)
    real(wp) :: y(matrix%n)
    integer :: i, k

    do i = 1, matrix%n
      y(i) = 0.0_wp
      do k = matrix%first(i), matrix%first(i + 1) - 1
        y(i) = y(i) + matrix%value(k)*x(matrix%column(k))
      end do
    end do
  end function multiply

  !> Factorise; `factored` is false where memory does not suffice. Entry (i, j) of the ordered
  !> matrix goes to row 2 width + 1 + i - j of column j. A pivot below `least_pivot` (a singular
  !> matrix) is set to that value, so that a solution exists.
  subroutine factor_banded(matrix, least_pivot, factor, factored)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(in) :: least_pivot
    type(banded_lu_t), intent(inout) :: factor !! with order, width and bytes
    logical, intent(out) :: factored
    integer :: new_index(matrix%n), i, j, k, status, w

    factored = .false.
    if (factor%bytes > available_bytes()) return
    w = factor%width
    call expect_allocation_failure(.true._c_bool)
    allocate (factor%band(3*w + 1, matrix%n), factor%exchange(matrix%n), stat=status)
    call expect_allocation_failure(.false._c_bool)
    if (status /= 0) return
    new_index(factor%order) = [(i, i=1, matrix%n)]
    factor%band = 0.0_wp
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        j = new_index(matrix%column(k))
        factor%band(2*w + 1 + new_index(i) - j, j) = matrix%value(k)
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

  !> order(k) is the k-th equation. Two equations are neighbours where either has an entry for the
  !> other.
  pure function reverse_cuthill_mckee(matrix) result(order)
    type(sparse_t), intent(in) :: matrix
    integer :: order(matrix%n)
    type(sparse_t) :: pattern
    integer :: level(matrix%n) !! 0: not reached yet
    integer :: rows(size(matrix%column))
    integer :: root, start, n_done, n_found, i

    ! Pattern of the matrix and its transpose: contact fills some entries on one side of the
    ! diagonal only.
    do i = 1, matrix%n
      rows(matrix%first(i):matrix%first(i + 1) - 1) = i
    end do
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

  !> Equation at one end of the connected part of `root`: the walk from there has the most, and so
  !> the narrowest, levels.
  pure subroutine find_end(matrix, root, level, found, start)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: root
    integer, intent(inout) :: level(:) !! 0 for all equations of the part, on return too
    integer, intent(inout) :: found(:) !! work array
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

  !> Largest distance of an entry from the diagonal in the given order.
  pure function bandwidth(matrix, order) result(width)
    type(sparse_t), intent(in) :: matrix
    integer, intent(in) :: order(:) !! (n)
    integer :: width
    integer :: new_index(matrix%n), i, k

    new_index(order) = [(i, i=1, matrix%n)]
    width = 0
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        width = max(width, abs(new_index(matrix%column(k)) - new_index(i)))
      end do
    end do
  end function bandwidth

end module sparse_m
