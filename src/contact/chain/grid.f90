! SPDX-License-Identifier: MIT
!> Segments of a surface in hashed square cells. Filling is linear in the number of segments.
module grid_m
  use contact_state_m, only : bucket_grid_t
  use geometry_m, only : separation, segment_length
  use kinds_m, only : wp, long
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: fill_grid, cell_of, bucket_of

  !> Cells are numbered within this range; beyond it they share the outermost number.
  real(wp), parameter :: widest = 1.0e8_wp

contains

  !> Sort all segments into cells as long as the mean segment (counting sort over hashed cells).
  pure subroutine fill_grid(grid, surface, chain)
    type(bucket_grid_t), intent(inout) :: grid
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) places
    real(wp) :: total, y(2)
    integer :: i, n_bucket

    total = 0.0_wp
    do i = 1, surface%n_segment
      total = total + segment_length(chain(:, surface%segments(1, i)), &
        chain(:, surface%segments(2, i)))
    end do
    grid%cell = max(total/max(surface%n_segment, 1), grid%least_cell)
    if (.not. grid%cell <= huge(1.0_wp)) grid%cell = grid%least_cell
    grid%low = huge(1.0_wp)
    grid%high = -huge(1.0_wp)
    do i = 1, surface%n_node
      y = separation(chain(:, i), chain(:, 1))
      grid%low = min(grid%low, y)
      grid%high = max(grid%high, y)
    end do
    n_bucket = size(grid%first) - 1
    grid%first = 0
    do i = 1, surface%n_segment
      call visit_cells(grid, surface, chain, i, .true.)
    end do
    do i = 2, n_bucket + 1
      grid%first(i) = grid%first(i) + grid%first(i - 1)
    end do
    do i = surface%n_segment, 1, -1
      call visit_cells(grid, surface, chain, i, .false.)
    end do
  end subroutine fill_grid

  !> Count a segment in its cells, or enter it: it is cut into pieces no longer than a cell, and
  !> each piece takes the cells of its box, at most four. Entering moves each bucket's end down to
  !> its start.
  pure subroutine visit_cells(grid, surface, chain, segment, counts)
    type(bucket_grid_t), intent(inout) :: grid
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    integer, intent(in) :: segment
    logical, intent(in) :: counts !! count only
    real(wp) :: a(2), b(2), p(2), q(2)
    integer :: n_piece, i, ix, iy, bucket, low(2), high(2)

    a = separation(chain(:, surface%segments(1, segment)), chain(:, 1))
    b = separation(chain(:, surface%segments(2, segment)), chain(:, 1))
    n_piece = max(1, ceiling(norm2(b - a)/grid%cell))
    do i = 1, n_piece
      p = a + (b - a)*(real(i - 1, wp)/n_piece)
      q = a + (b - a)*(real(i, wp)/n_piece)
      low = cell_of(grid, min(p, q))
      high = min(cell_of(grid, max(p, q)), low + 1)
      do iy = low(2), high(2)
        do ix = low(1), high(1)
          bucket = bucket_of(grid, ix, iy)
          if (counts) then
            grid%first(bucket) = grid%first(bucket) + 1
          else
            grid%items(grid%first(bucket)) = segment
            grid%first(bucket) = grid%first(bucket) - 1
          end if
        end do
      end do
    end do
  end subroutine visit_cells

  !> Cell that holds a place relative to the chain's first node.
  pure function cell_of(grid, y) result(cell)
    type(bucket_grid_t), intent(in) :: grid
    real(wp), intent(in) :: y(2)
    integer :: cell(2)

    cell = floor(max(-widest, min(widest, y/grid%cell)))
  end function cell_of

  !> Bucket of a cell (the usual hash of two primes).
  pure function bucket_of(grid, ix, iy) result(bucket)
    type(bucket_grid_t), intent(in) :: grid
    integer, intent(in) :: ix, iy
    integer :: bucket

    bucket = 1 + int(iand(ieor(73856093_long*ix, 19349663_long*iy), &
      int(size(grid%first) - 2, long)))
  end function bucket_of

end module grid_m
