! SPDX-License-Identifier: MIT
!> Projections of many positions at a time, each on the segment that it is known to be near: the one
!> projection of the contact layer, in blocks, so that the roots and quotients of a block are formed
!> together. Most positions need nothing else, or a look at a neighbour; the few left need a
!> decision (projection_m).
module projection_block_m
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: projection_block_t, n_block, project_block, resolve_ambiguous, bisector_width, &
    is_straight, round_off, on_bisector

  !> Part of a segment next to its ends where round-off decides on which side of a node a position
  !> is.
  real(wp), parameter :: round_off = 1.0e-12_wp
  !> Difference of the gaps to both segments of a corner, as a part of the segment, up to which a
  !> position is on the bisector of the corner: equilibrium of symmetric bodies has nodes there.
  real(wp), parameter :: on_bisector = 1.0e-10_wp
  !> One minus the square of the cosine of the turn below which there is no corner.
  real(wp), parameter :: straight = 1.0e-6_wp

  !> Positions of a block.
  integer, parameter :: n_block = 128

  !> Without default values, which would be written before each use.
  type :: projection_block_t
    integer :: n
    integer :: n_ambiguous          !! positions that need a decision yet
    integer :: segment(n_block)     !! of the surface
    real(wp) :: t(2, n_block)       !! vector of that segment, m
    real(wp) :: d(2, n_block)       !! from its first node to the position, m
    real(wp) :: xi(n_block)         !! projection on the segment
    real(wp) :: gap(n_block)        !! m
    real(wp) :: normal(2, n_block)
    real(wp) :: ambiguous(n_block)  !! 1: needs a decision; else 0
  end type projection_block_t

contains

  !> Project all positions of a block on their segments. Not ambiguous is a position behind its
  !> segment by less than it is away from the ends: no neighbour is nearer. A loop that stores
  !> logicals is not vectorised, so that `ambiguous` is a number.
  pure subroutine project_block(block)
    type(projection_block_t), intent(inout) :: block
    real(wp) :: square, along, across, inverse, total
    integer :: k

    total = 0.0_wp
    !$omp simd private(square, along, across, inverse) reduction(+: total)
    do k = 1, block%n
      square = max(block%t(1, k)*block%t(1, k) + block%t(2, k)*block%t(2, k), tiny(1.0_wp))
      along = block%d(1, k)*block%t(1, k) + block%d(2, k)*block%t(2, k)
      across = block%d(1, k)*block%t(2, k) - block%d(2, k)*block%t(1, k)
      block%ambiguous(k) = merge(0.0_wp, 1.0_wp, across < 0.0_wp .and. across + along > 0.0_wp &
        .and. across + square > along)
      total = total + block%ambiguous(k)
      inverse = 1.0_wp/sqrt(square)
      block%xi(k) = along*(inverse*inverse)
      block%gap(k) = across*inverse
      block%normal(1, k) = block%t(2, k)*inverse
      block%normal(2, k) = -(block%t(1, k)*inverse)
    end do
    block%n_ambiguous = nint(total)
  end subroutine project_block

  !> Resolve ambiguous projections by the neighbours of their segments: those that are over their
  !> segments and no nearer to a neighbour are kept, but on the bisector of a corner.
  pure subroutine resolve_ambiguous(surface, polyline, block)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_node) positions
    type(projection_block_t), intent(inout) :: block
    real(wp) :: beside(2, n_block)

    call neighbour_vectors(block%n, block%segment, block%xi, surface%previous, surface%next, &
      surface%segments, polyline, beside)
    call keep_near_nodes(beside, block)
  end subroutine resolve_ambiguous

  !> The neighbour of each segment at the end next to the projection, where the surface ends the
  !> segment itself: first all numbers, then the vectors.
  pure subroutine neighbour_vectors(n, segment, xi, previous, next, ends, polyline, beside)
    integer, intent(in) :: n, segment(n)
    real(wp), intent(in) :: xi(n)
    integer, intent(in) :: previous(*), next(*), ends(2, *)
    real(wp), intent(in) :: polyline(4, *)
    real(wp), intent(inout) :: beside(2, n) !! its vector, m
    real(wp) :: vector(4)
    integer :: others(n_block), k, other

    do k = 1, n
      other = merge(next(segment(k)), previous(segment(k)), xi(k) > 0.5_wp)
      others(k) = merge(other, segment(k), other > 0)
    end do
    !GCC$ NOVECTOR
    do k = 1, n
      vector = polyline(:, ends(2, others(k))) - polyline(:, ends(1, others(k)))
      beside(:, k) = vector(1:2) + vector(3:4)
    end do
  end subroutine neighbour_vectors

  !> Ambiguous positions behind their segments that stay: over them, and no nearer to the neighbour
  !> at the one end that is nearer than the position is deep. Most projections on nodes of a surface
  !> that turns gently are such. A decision as a number: with `.and.` and `.or.` of all its parts
  !> the loop would not be vectorised.
  pure subroutine keep_near_nodes(beside, block)
    real(wp), intent(in) :: beside(2, n_block) !! vectors of the neighbours, m
    type(projection_block_t), intent(inout) :: block
    real(wp) :: square, along, across, at, way, to_end, from_x, from_y, other_square, &
      other_along, other_across, small, width, stays, total
    integer :: k

    total = 0.0_wp
    !$omp simd private(square, along, across, at, way, to_end, from_x, from_y, &
    !$omp   other_square, other_along, other_across, small, width, stays) &
    !$omp   reduction(+: total)
    do k = 1, block%n
      square = block%t(1, k)*block%t(1, k) + block%t(2, k)*block%t(2, k)
      along = block%d(1, k)*block%t(1, k) + block%d(2, k)*block%t(2, k)
      across = block%d(1, k)*block%t(2, k) - block%d(2, k)*block%t(1, k)
      at = merge(1.0_wp, 0.0_wp, block%xi(k) > 0.5_wp)
      way = 1.0_wp - 2.0_wp*at
      to_end = at*square + way*along
      from_x = block%d(1, k) - at*block%t(1, k)
      from_y = block%d(2, k) - at*block%t(2, k)
      other_square = beside(1, k)*beside(1, k) + beside(2, k)*beside(2, k)
      other_along = way*(from_x*beside(1, k) + from_y*beside(2, k))
      other_across = from_x*beside(2, k) - from_y*beside(1, k)
      small = round_off*(from_x*from_x + from_y*from_y + other_square)
      width = bisector_width(beside(1, k)*block%t(1, k) + beside(2, k)*block%t(2, k), square, &
        other_square, across)
      stays = merge(1.0_wp, 0.0_wp, other_along >= merge(small, -small, width > 0.0_wp))
      stays = merge(1.0_wp, stays, other_across*other_across*square &
        - across*across*other_square >= width)
      stays = merge(stays, 0.0_wp, across < 0.0_wp)
      block%ambiguous(k) = merge(0.0_wp, block%ambiguous(k), min(to_end + round_off*square, across &
        + (square - to_end), stays - 0.5_wp) >= 0.0_wp)
      total = total + block%ambiguous(k)
    end do
    block%n_ambiguous = nint(total)
  end subroutine keep_near_nodes

  !> Largest difference on the bisector of the corner of two segments between the squares of the
  !> gaps to them, times the squares of their lengths, m^6; zero on a line.
  pure function bisector_width(product, square, other_square, across) result(width)
    real(wp), intent(in) :: product !! of their vectors, m^2
    real(wp), intent(in) :: square, other_square !! of their lengths, m^2
    real(wp), intent(in) :: across  !! gap to the first times its length, m^2
    real(wp) :: width

    width = on_bisector*(2.0_wp*abs(across) + on_bisector*square)*square*other_square
    if (is_straight(product, square, other_square)) width = 0.0_wp
  end function bisector_width

  !> Whether two segments, or one and the opposite of the other, are on a line.
  pure function is_straight(product, square, other_square)
    real(wp), intent(in) :: product !! of their vectors, m^2
    real(wp), intent(in) :: square, other_square !! of their lengths, m^2
    logical :: is_straight

    is_straight = product*product >= (1.0_wp - straight)*square*other_square
  end function is_straight

end module projection_block_m
