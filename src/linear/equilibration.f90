! SPDX-License-Identifier: MIT
!> Scaling of a matrix so that the largest entry of every row and column is about one (Ruiz 2001).
!> A penalty a million times stiffer than the elements then no longer hides what is soft.
module equilibration_m
  use kinds_m, only : wp
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: equilibrate

  !> Each sweep halves the exponent of what is left to scale.
  integer, parameter :: n_sweep = 5

contains

  !> scaled(i, j) = row_scale(i)*matrix(i, j)*column_scale(j), with the largest entries from
  !> 1/4 to about 1. The scales are powers of two, so that nothing is rounded. No row and no
  !> column may be empty or zero.
  pure subroutine equilibrate(matrix, row_scale, column_scale, scaled)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(out) :: row_scale(:)    !! (n)
    real(wp), intent(out) :: column_scale(:) !! (n)
    type(sparse_t), intent(out) :: scaled    !! compressed
    real(wp), allocatable :: row_largest(:), column_largest(:)
    integer :: sweep

    allocate (row_largest(matrix%n), column_largest(matrix%n))
    row_scale = 1.0_wp
    column_scale = 1.0_wp
    do sweep = 1, n_sweep
      call find_largest(matrix, row_scale, column_scale, row_largest, column_largest)
      row_scale = row_scale/sqrt(row_largest)
      column_scale = column_scale/sqrt(column_largest)
    end do
    row_scale = scale(1.0_wp, exponent(row_scale) - 1)
    column_scale = scale(1.0_wp, exponent(column_scale) - 1)
    call scale_entries(matrix, row_scale, column_scale, scaled)
  end subroutine equilibrate

  !> Largest scaled entry of each row and column.
  pure subroutine find_largest(matrix, row_scale, column_scale, row_largest, column_largest)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(in) :: row_scale(:)       !! (n)
    real(wp), intent(in) :: column_scale(:)    !! (n)
    real(wp), intent(out) :: row_largest(:)    !! (n)
    real(wp), intent(out) :: column_largest(:) !! (n)
    real(wp) :: entry
    integer :: i, j, k

    row_largest = 0.0_wp
    column_largest = 0.0_wp
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        j = matrix%column(k)
        entry = abs(matrix%value(k))*row_scale(i)*column_scale(j)
        row_largest(i) = max(row_largest(i), entry)
        column_largest(j) = max(column_largest(j), entry)
      end do
    end do
  end subroutine find_largest

  !> The scaled matrix.
  pure subroutine scale_entries(matrix, row_scale, column_scale, scaled)
    type(sparse_t), intent(in) :: matrix
    real(wp), intent(in) :: row_scale(:)    !! (n)
    real(wp), intent(in) :: column_scale(:) !! (n)
    type(sparse_t), intent(out) :: scaled
    integer :: i, k

    allocate (scaled%first(size(matrix%first)), scaled%column(size(matrix%column)), &
      scaled%value(size(matrix%value)))
    scaled%n = matrix%n
    scaled%first = matrix%first
    scaled%column = matrix%column
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        scaled%value(k) = row_scale(i)*matrix%value(k)*column_scale(matrix%column(k))
      end do
    end do
  end subroutine scale_entries

end module equilibration_m
