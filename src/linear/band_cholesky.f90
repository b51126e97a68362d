! SPDX-License-Identifier: MIT
!> Cholesky factors of a symmetric band (0:width, n), B(j + i, j) in row i of column j, without
!> negative eigenvalues: of rows that depend on others the later ones are left out. LAPACK's dpbtrf
!> gives up at the first such pivot, and in OpenBLAS its bits depend on the number of threads where
!> the band is wide.
module band_cholesky_m
  use kinds_m, only : wp
  implicit none
  private
  public :: take_rows, factorise, substitute

  !> Entries of a band up to which a loop over them is not worth vectors.
  integer, parameter :: few = 8
  !> Pivots below this part of their own diagonal are zero.
  real(wp), parameter :: least_pivot = 1.0e-10_wp

contains

  !> The band of some rows.
  pure subroutine take_rows(m, width, place, band, factor)
    integer, intent(in) :: m, width, place(m)
    real(wp), intent(in) :: band(0:width, *)
    real(wp), intent(inout) :: factor(0:width, m)
    integer :: i, j

    if (place(m) - place(1) == m - 1) then
      ! They follow each other.
      call copy((width + 1)*m, band(0, place(1)), factor)
      return
    end if
    do j = 1, m
      do i = j, min(j + width, m)
        if (place(i) - place(j) > width) then
          factor(i - j, j) = 0.0_wp
        else
          factor(i - j, j) = band(place(i) - place(j), place(j))
        end if
      end do
    end do
  end subroutine take_rows

  !> All columns in one loop.
  pure subroutine copy(n, from, to)
    integer, intent(in) :: n
    real(wp), intent(in) :: from(n)
    real(wp), intent(inout) :: to(n)

    to = from
  end subroutine copy

  !> Cholesky factors of a band. A row whose pivot is zero takes no part.
  pure subroutine factorise(n, width, factor, diagonal, is_zero)
    integer, intent(in) :: n, width
    real(wp), intent(inout) :: factor(0:width, n)
    real(wp), intent(inout) :: diagonal(n)
    logical, intent(inout) :: is_zero(n)
    real(wp) :: inverse
    integer :: j, k, last

    do j = 1, n
      diagonal(j) = factor(0, j)
    end do
    do j = 1, n
      is_zero(j) = .not. factor(0, j) > least_pivot*diagonal(j)
      if (is_zero(j)) then
        factor(:, j) = 0.0_wp
        factor(0, j) = 1.0_wp
        cycle
      end if
      factor(0, j) = sqrt(factor(0, j))
      inverse = 1.0_wp/factor(0, j)
      last = min(width, n - j)
      do k = 1, last
        factor(k, j) = factor(k, j)*inverse
      end do
      do k = 1, last
        call take_off(last - k + 1, factor(k, j), factor(k, j), factor(0, j + k))
      end do
    end do
  end subroutine factorise

  !> Take a multiple of numbers off others. Few are cheaper one by one.
  pure subroutine take_off(n, multiple, these, others)
    integer, intent(in) :: n
    real(wp), intent(in) :: multiple, these(n)
    real(wp), intent(inout) :: others(n)
    integer :: m

    if (n > few) then
      others = others - multiple*these
    else
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do m = 1, n
        others(m) = others(m) - multiple*these(m)
      end do
    end if
  end subroutine take_off

  !> Solve with the factors, in place.
  pure subroutine substitute(n, width, factor, is_zero, y)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: factor(0:width, n)
    logical, intent(in) :: is_zero(n)
    real(wp), intent(inout) :: y(n)
    real(wp) :: value
    integer :: j, k

    do j = 1, n
      if (is_zero(j)) y(j) = 0.0_wp
      value = y(j)/factor(0, j)
      y(j) = value
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do k = 1, min(width, n - j)
        y(j + k) = y(j + k) - factor(k, j)*value
      end do
    end do
    do j = n, 1, -1
      value = y(j)
      !GCC$ UNROLL 1
      do k = 1, min(width, n - j)
        value = value - factor(k, j)*y(j + k)
      end do
      y(j) = value/factor(0, j)
      if (is_zero(j)) y(j) = 0.0_wp
    end do
  end subroutine substitute

end module band_cholesky_m
