! SPDX-License-Identifier: MIT
!> Projections of many positions at a time, each on the segment that it is known to be near: the one
!> projection of the contact layer, in blocks, so that the roots and quotients of a block are formed
!> together. Most positions need nothing else, or a look at a neighbour; the few left need a
!> decision (projection_m).
module projection_block_m
  use projection_m, only : round_off
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: projection_block_t, n_block, project, project_block, resolve_ambiguous

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
    real(wp) :: inverse(n_block)    !! 1/length of the segment, 1/m
    real(wp) :: ambiguous(n_block)  !! 1: needs a decision; else 0
  end type projection_block_t

contains

  !> Project all positions of a block on their segments. Not ambiguous is a position behind its
  !> segment by less than it is away from the ends: no neighbour is nearer.
  pure subroutine project_block(block)
    type(projection_block_t), intent(inout) :: block

    call project(block%n, block%t, block%d, block%xi, block%gap, block%normal, block%inverse, &
      block%ambiguous, block%n_ambiguous)
  end subroutine project_block

  !> The same on arrays of known shape. A loop that stores logicals is not vectorised, so that
  !> `ambiguous` is a number.
  pure subroutine project(n, t, d, xi, gap, normal, inverse, ambiguous, n_ambiguous)
    integer, intent(in) :: n
    real(wp), intent(in) :: t(2, n), d(2, n)
    real(wp), intent(inout) :: xi(n), gap(n), normal(2, n), inverse(n)
    real(wp), intent(inout) :: ambiguous(n)
    integer, intent(out) :: n_ambiguous
    real(wp) :: square, along, across, total
    integer :: k

    total = 0.0_wp
    !$omp simd private(square, along, across) reduction(+: total)
    do k = 1, n
      square = max(t(1, k)*t(1, k) + t(2, k)*t(2, k), tiny(1.0_wp))
      along = d(1, k)*t(1, k) + d(2, k)*t(2, k)
      across = d(1, k)*t(2, k) - d(2, k)*t(1, k)
      ambiguous(k) = merge(0.0_wp, 1.0_wp, across < 0.0_wp .and. across + along >= 0.0_wp &
        .and. across + square >= along)
      total = total + ambiguous(k)
      inverse(k) = 1.0_wp/sqrt(square)
      xi(k) = along*(inverse(k)*inverse(k))
      gap(k) = across*inverse(k)
      normal(1, k) = t(2, k)*inverse(k)
      normal(2, k) = -(t(1, k)*inverse(k))
    end do
    n_ambiguous = nint(total)
  end subroutine project

  !> A look at the neighbours of the segments: ambiguous positions that are over their segments all
  !> the same, and no nearer to a neighbour, are ambiguous no more.
  pure subroutine resolve_ambiguous(surface, polyline, block)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_node) positions
    type(projection_block_t), intent(inout) :: block
    real(wp) :: beside(2, n_block)

    call neighbour_vectors(block%n, block%segment, block%xi, surface%previous, surface%next, &
      surface%segments, polyline, beside)
    call keep_near_nodes(block%n, block%t, block%d, block%xi, beside, block%ambiguous, &
      block%n_ambiguous)
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
  pure subroutine keep_near_nodes(n, t, d, xi, beside, ambiguous, n_ambiguous)
    integer, intent(in) :: n
    real(wp), intent(in) :: t(2, n), d(2, n), xi(n), beside(2, n)
    real(wp), intent(inout) :: ambiguous(n)
    integer, intent(out) :: n_ambiguous
    real(wp) :: square, along, across, at, way, to_end, from_x, from_y, other_square, &
      other_along, other_across, small, stays, total
    integer :: k

    total = 0.0_wp
    !$omp simd private(square, along, across, at, way, to_end, from_x, from_y, &
    !$omp   other_square, other_along, other_across, small, stays) reduction(+: total)
    do k = 1, n
      square = t(1, k)*t(1, k) + t(2, k)*t(2, k)
      along = d(1, k)*t(1, k) + d(2, k)*t(2, k)
      across = d(1, k)*t(2, k) - d(2, k)*t(1, k)
      at = merge(1.0_wp, 0.0_wp, xi(k) > 0.5_wp)
      way = 1.0_wp - 2.0_wp*at
      to_end = at*square + way*along
      from_x = d(1, k) - at*t(1, k)
      from_y = d(2, k) - at*t(2, k)
      other_square = beside(1, k)*beside(1, k) + beside(2, k)*beside(2, k)
      other_along = way*(from_x*beside(1, k) + from_y*beside(2, k))
      other_across = from_x*beside(2, k) - from_y*beside(1, k)
      small = round_off*(from_x*from_x + from_y*from_y + other_square)
      stays = merge(1.0_wp, 0.0_wp, other_along >= -small)
      stays = merge(1.0_wp, stays, other_across*other_across*square &
        >= across*across*other_square)
      stays = merge(stays, 0.0_wp, across < 0.0_wp)
      ambiguous(k) = merge(0.0_wp, ambiguous(k), min(to_end + round_off*square, across &
        + (square - to_end), stays - 0.5_wp) >= 0.0_wp)
      total = total + ambiguous(k)
    end do
    n_ambiguous = nint(total)
  end subroutine keep_near_nodes

end module projection_block_m
