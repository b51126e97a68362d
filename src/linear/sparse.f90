! SPDX-License-Identifier: MIT
!> Sparse square matrix, assembled from small dense blocks: entries are collected as they come and
!> then compressed to rows, duplicates summed.
module sparse_m
  use kinds_m, only : wp
  implicit none
  private
  public :: sparse_t, start_matrix, add_block, compress_matrix, multiply

  !> The matrix. Until it is compressed only the collected entries count, afterwards only the rows.
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

contains

  !> An empty matrix of n rows. Memory of an earlier one is kept for use again.
  pure subroutine start_matrix(matrix, n)
    type(sparse_t), intent(inout) :: matrix
    integer, intent(in) :: n

    matrix%n = n
    matrix%n_entry = 0
    ! Four quads at a node, eight columns for each of them: 32 entries an
    ! equation, and some contact.
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

  !> Rows from the collected entries: two counting sorts (by column, then stably by row) and one
  !> pass that sums duplicates in the order in which they were added.
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

end module sparse_m
