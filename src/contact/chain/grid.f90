! SPDX-License-Identifier: MIT
!> The global search: segments of a chain in hashed square cells. A grid stays of use while the
!> chain moves: nothing can have moved relative to the chain's first node by more than the travel
!> since it was filled (the slip), and the search takes that off its bounds. Filling and asking are
!> linear in the number of segments and spots.
module grid_m
  use contact_state_m, only : bucket_grid_t
  use geometry_m, only : closest_distance, separation, segment_length, sight_of_segment
  use kinds_m, only : wp, long
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: nearest_t, kept_t, fill_grid, slip_limit, box_distance, find_nearest, &
    distance_to_others, cell_of, bucket_of, keep_nearest, conclude

  !> Segments kept by a search: the nearest, its two neighbours and the next one after these.
  integer, parameter :: n_kept = 4
  !> Cells are numbered within this range; beyond it they share the outermost number.
  real(wp), parameter :: widest = 1.0e9_wp

  !> Rings of cells looked into for the distance to others.
  integer, parameter :: most_rings = 6

  !> Answer of a search.
  type :: nearest_t
    integer :: segment = 0       !! nearest segment, 0 = none within the range asked for
    real(wp) :: distance = 0.0_wp !! to it, or a lower bound when there is none, m
    real(wp) :: other = 0.0_wp   !! lower bound on the distance to all but it and its neighbours, m
  end type nearest_t

  !> Nearest segments so far, by rising distance.
  type :: kept_t
    integer :: n = 0
    integer :: segment(n_kept) = 0
    real(wp) :: square(n_kept) = huge(1.0_wp)
  end type kept_t

contains

  !> Slip after which a grid should be filled again.
  pure function slip_limit(grid) result(slip)
    type(bucket_grid_t), intent(in) :: grid
    real(wp) :: slip

    slip = 0.5_wp*grid%cell
  end function slip_limit

  !> Sort all segments into cells as long as the mean segment (counting sort over hashed cells).
  pure subroutine fill_grid(grid, surface, chain, travel)
    type(bucket_grid_t), intent(inout) :: grid
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) places
    real(wp), intent(in) :: travel
    real(wp) :: total, y(2)
    integer :: i, n_bucket

    total = 0.0_wp
    do i = 1, surface%n_segment
      total = total + segment_length(chain(:, surface%segments(1, i)), &
        chain(:, surface%segments(2, i)))
    end do
    grid%cell = max(total/max(surface%n_segment, 1), grid%least_cell) ! runs may have no segment
    if (.not. grid%cell <= huge(1.0_wp)) grid%cell = grid%least_cell
    grid%filled_at = travel
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

  !> Lower bound on the distance from `spot` to the chain, from the box of the chain.
  pure function box_distance(grid, chain, spot, travel) result(distance)
    type(bucket_grid_t), intent(in) :: grid
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4), travel
    real(wp) :: distance, y(2)

    y = separation(spot, chain(:, 1))
    distance = norm2(max(0.0_wp, grid%low - y, y - grid%high)) - (travel - grid%filled_at)
  end function box_distance

  !> Nearest segment to `spot`, if there is one within `reach`: rings of cells round the spot, until
  !> no cell farther out can hold a nearer segment. (The last ring is there for runs that have blown
  !> up: these end by their own checks, not in here.)
  pure subroutine find_nearest(grid, surface, chain, spot, travel, reach, nearest)
    type(bucket_grid_t), intent(in) :: grid
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    real(wp), intent(in) :: travel
    real(wp), intent(in) :: reach
    type(nearest_t), intent(out) :: nearest
    type(kept_t) :: kept
    real(wp) :: bound, slip
    integer :: centre(2), ring, last_ring, ix, iy, step

    slip = travel - grid%filled_at
    centre = cell_of(grid, separation(spot, chain(:, 1)))
    last_ring = ceiling((reach + max(0.0_wp, min(slip, reach)))/grid%cell) + 2
    do ring = 0, last_ring
      do iy = centre(2) - ring, centre(2) + ring
        step = max(1, merge(1, 2*ring, abs(iy - centre(2)) == ring))
        do ix = centre(1) - ring, centre(1) + ring, step
          call look_into_bucket(grid, surface, chain, spot, bucket_of(grid, ix, iy), kept)
        end do
      end do
      bound = max(0.0_wp, ring*grid%cell - slip)
      if (ring >= 1 .and. bound >= min(sqrt(kept%square(1)), reach + grid%cell)) exit
    end do
    call conclude(surface, kept, bound, reach, nearest)
  end subroutine find_nearest

  !> Lower bound on the distance from `spot` to all segments but some that are known, as far as
  !> `reach`; rings of cells as in `find_nearest`, but no more than a few: in much smaller cells
  !> than the reach the bound is what these hold.
  pure function distance_to_others(grid, surface, chain, spot, travel, reach, &
      known) result(distance)
    type(bucket_grid_t), intent(in) :: grid
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    real(wp), intent(in) :: travel
    real(wp), intent(in) :: reach
    integer, intent(in), contiguous :: known(:) !! segments left out
    real(wp) :: distance, bound, square
    integer :: centre(2), ring, ix, iy, step

    distance = 0.0_wp
    if (.not. grid%cell > 0.0_wp) return
    square = huge(1.0_wp)
    centre = cell_of(grid, separation(spot, chain(:, 1)))
    do ring = 0, most_rings
      do iy = centre(2) - ring, centre(2) + ring
        step = max(1, merge(1, 2*ring, abs(iy - centre(2)) == ring))
        do ix = centre(1) - ring, centre(1) + ring, step
          square = min(square, square_in_bucket(grid, surface, chain, spot, &
            bucket_of(grid, ix, iy), known))
        end do
      end do
      bound = max(0.0_wp, ring*grid%cell - (travel - grid%filled_at))
      if (bound >= min(sqrt(square), reach)) exit
    end do
    distance = min(bound, sqrt(square))
  end function distance_to_others

  !> Square of the distance to the nearest segment of a bucket that is not known.
  pure function square_in_bucket(grid, surface, chain, spot, bucket, known) result(square)
    type(bucket_grid_t), intent(in) :: grid
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: bucket
    integer, intent(in), contiguous :: known(:)
    real(wp) :: square
    integer :: i, segment

    square = huge(1.0_wp)
    do i = grid%first(bucket) + 1, grid%first(bucket + 1)
      segment = grid%items(i)
      if (any(known == segment)) cycle
      square = min(square, closest_distance(sight_of_segment(spot, &
        chain(:, surface%segments(1, segment)), chain(:, surface%segments(2, segment)))))
    end do
  end function square_in_bucket

  !> Keep the nearest different segments of one bucket.
  pure subroutine look_into_bucket(grid, surface, chain, spot, bucket, kept)
    type(bucket_grid_t), intent(in) :: grid
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: bucket
    type(kept_t), intent(inout) :: kept
    real(wp) :: square
    integer :: i, segment

    do i = grid%first(bucket) + 1, grid%first(bucket + 1)
      segment = grid%items(i)
      if (any(kept%segment == segment)) cycle
      square = closest_distance(sight_of_segment(spot, chain(:, surface%segments(1, segment)), &
        chain(:, surface%segments(2, segment))))
      if (square < kept%square(n_kept)) call keep_nearest(segment, square, kept)
    end do
  end subroutine look_into_bucket

  !> Keep a segment that is nearer than the last of those kept.
  pure subroutine keep_nearest(segment, square, kept)
    integer, intent(in) :: segment
    real(wp), intent(in) :: square !! of its distance, m^2
    type(kept_t), intent(inout) :: kept
    integer :: k

    k = n_kept
    do while (k > 1)
      if (kept%square(k - 1) <= square) exit
      kept%square(k) = kept%square(k - 1)
      kept%segment(k) = kept%segment(k - 1)
      k = k - 1
    end do
    kept%square(k) = square
    kept%segment(k) = segment
  end subroutine keep_nearest

  !> Turn what was kept into the answer; `bound` holds for all segments not looked at.
  pure subroutine conclude(surface, kept, bound, reach, nearest)
    type(surface_t), intent(in) :: surface
    type(kept_t), intent(in) :: kept
    real(wp), intent(in) :: bound, reach
    type(nearest_t), intent(out) :: nearest
    integer :: i

    nearest%distance = min(bound, sqrt(kept%square(1)))
    if (sqrt(kept%square(1)) > reach) return
    nearest%segment = kept%segment(1)
    nearest%distance = sqrt(kept%square(1))
    nearest%other = bound
    do i = 2, n_kept
      if (kept%segment(i) == 0) exit
      if (kept%segment(i) == surface%previous(nearest%segment)) cycle
      if (kept%segment(i) == surface%next(nearest%segment)) cycle
      nearest%other = min(bound, sqrt(kept%square(i)))
      exit
    end do
  end subroutine conclude

end module grid_m
