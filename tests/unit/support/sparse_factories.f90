! SPDX-License-Identifier: MIT
!> Sparse matrices for the unit tests: trusses, whose rigid motions are known, and scattered ones.
module sparse_factories
  use kinds_m, only : wp
  use small_models, only : scattered
  use sparse_m, only : sparse_t, start_matrix, add_block, compress_matrix
  implicit none
  private
  public :: add_truss, make_scattered, dense, permuted

contains

  !> Add the bars of a grid of n_x by n_y unit cells, both diagonals in each, with stiffness EA = `stiffness`:
  !> no motion but a rigid one leaves all lengths unchanged. Nodes row by row from (0, 0).
  subroutine add_truss(n_x, n_y, stiffness, equation, matrix)
    integer, intent(in) :: n_x, n_y
    real(wp), intent(in) :: stiffness
    integer, intent(in) :: equation(:, :) !! (2, (n_x + 1)*(n_y + 1))
    type(sparse_t), intent(inout) :: matrix
    integer :: i, j

    do j = 0, n_y
      do i = 0, n_x
        if (i < n_x) call add_bar(i, j, 1, 0)
        if (j < n_y) call add_bar(i, j, 0, 1)
        if (i < n_x .and. j < n_y) call add_bar(i, j, 1, 1)
        if (i > 0 .and. j < n_y) call add_bar(i, j, -1, 1)
      end do
    end do

  contains

    !> The bar from node (i, j) to node (i + d_x, j + d_y).
    subroutine add_bar(i, j, d_x, d_y)
      integer, intent(in) :: i, j, d_x, d_y
      real(wp) :: length, direction(4)
      integer :: ends(2)

      ends = [j*(n_x + 1) + i + 1, (j + d_y)*(n_x + 1) + i + d_x + 1]
      length = sqrt(real(d_x**2 + d_y**2, wp))
      direction = [-d_x, -d_y, d_x, d_y]/length
      call add_block(matrix, reshape(equation(:, ends), [4]), reshape(equation(:, ends), [4]), &
        stiffness/length*spread(direction, 2, 4)*spread(direction, 1, 4))
    end subroutine add_bar

  end subroutine add_truss

  !> n equations, each coupled with about 2 `n_off` others: entries (i, j) and (j, i) are both there and
  !> differ. `diagonal` is added to the diagonal.
  subroutine make_scattered(n, n_off, diagonal, matrix)
    integer, intent(in) :: n, n_off
    real(wp), intent(in) :: diagonal
    type(sparse_t), intent(out) :: matrix
    real(wp) :: block(2, 2), places(n_off)
    integer :: i, k, other

    call start_matrix(matrix, n)
    do i = 1, n
      call add_block(matrix, [i], [i], reshape([diagonal], [1, 1]))
      places = scattered(n_off, i)
      do k = 1, n_off
        other = 1 + int(0.5_wp*(1.0_wp + places(k))*n)
        if (other == i) cycle
        block = reshape(scattered(4, i + n*k), [2, 2])
        call add_block(matrix, [i, other], [i, other], block)
      end do
    end do
    call compress_matrix(matrix)
  end subroutine make_scattered

  !> The matrix with its zeros.
  pure function dense(matrix) result(full)
    type(sparse_t), intent(in) :: matrix
    real(wp) :: full(matrix%n, matrix%n)
    integer :: i

    full = 0.0_wp
    do i = 1, matrix%n
      associate (columns => matrix%column(matrix%first(i):matrix%first(i + 1) - 1))
        full(i, columns) = matrix%value(matrix%first(i):matrix%first(i + 1) - 1)
      end associate
    end do
  end function dense

  !> The numbers 1 to n without order: steps of `stride`, which shares no divisor with n.
  pure function permuted(n, stride) result(numbers)
    integer, intent(in) :: n, stride
    integer :: numbers(n)
    integer :: i

    numbers = [(1 + modulo(i*stride, n), i=1, n)]
  end function permuted

end module sparse_factories
