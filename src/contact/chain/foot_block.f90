! SPDX-License-Identifier: MIT
!> Feet of many places at a time, each on the segment that it is known to be near: the one
!> projection of the contact layer, in blocks, so that the roots and quotients of a block are formed
!> together. Most places need nothing else. Those that may be nearer to a neighbour, or stand at a
!> node, are settled by a look at the neighbours; the few left need a decision (foot_m).
module foot_block_m
  use foot_m, only : end_tolerance, gentle_turn, round_off
  use geometry_m, only : sight_t
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: foot_block_t, n_block, project, project_block, settle_odd

  !> Places of a block.
  integer, parameter :: n_block = 128
  !> Odd places up to which it is cheaper to settle them one by one.
  integer, parameter :: n_alone = 12

  !> Without default values, which would be written before each use.
  type :: foot_block_t
    integer :: n
    integer :: n_odd                !! places that need a decision yet
    integer :: n_moved              !! places that have been settled one by one
    integer :: moved(n_block)       !! these
    integer :: segment(n_block)     !! of the chain
    real(wp) :: t(2, n_block)       !! vector of that segment, m
    real(wp) :: d(2, n_block)       !! from its first node to the place, m
    real(wp) :: xi(n_block)         !! foot on the segment
    real(wp) :: gap(n_block)        !! m
    real(wp) :: normal(2, n_block)
    real(wp) :: inverse(n_block)    !! 1/length of the segment, 1/m
    real(wp) :: odd(n_block)        !! 1: needs a decision; -1: has its foot elsewhere; else 0
  end type foot_block_t

contains

  !> Project all places of a block on their segments. Not odd is a place behind its segment by less
  !> than it is away from the ends: no neighbour is nearer.
  pure subroutine project_block(block)
    type(foot_block_t), intent(inout) :: block

    block%n_moved = 0
    call project(block%n, block%t, block%d, block%xi, block%gap, block%normal, block%inverse, &
      block%odd, block%n_odd)
  end subroutine project_block

  !> The same on arrays of known shape. A loop that stores logicals is not vectorised, so that `odd`
  !> is a number.
  pure subroutine project(n, t, d, xi, gap, normal, inverse, odd, n_odd)
    integer, intent(in) :: n
    real(wp), intent(in) :: t(2, n), d(2, n)
    real(wp), intent(inout) :: xi(n), gap(n), normal(2, n), inverse(n)
    real(wp), intent(inout) :: odd(n)
    integer, intent(out) :: n_odd
    real(wp) :: square, along, across, total
    integer :: k

    total = 0.0_wp
    !$omp simd private(square, along, across) reduction(+: total)
    do k = 1, n
      square = max(t(1, k)*t(1, k) + t(2, k)*t(2, k), tiny(1.0_wp))
      along = d(1, k)*t(1, k) + d(2, k)*t(2, k)
      across = d(1, k)*t(2, k) - d(2, k)*t(1, k)
      odd(k) = merge(0.0_wp, 1.0_wp, across < 0.0_wp .and. across + along >= 0.0_wp &
        .and. across + square >= along)
      total = total + odd(k)
      inverse(k) = 1.0_wp/sqrt(square)
      xi(k) = along*(inverse(k)*inverse(k))
      gap(k) = across*inverse(k)
      normal(1, k) = t(2, k)*inverse(k)
      normal(2, k) = -(t(1, k)*inverse(k))
    end do
    n_odd = nint(total)
  end subroutine project

  !> Settle the odd places of a block by a look at the neighbours of their segments: first together
  !> those that stay, then one by one. Some may have their feet on a neighbour then.
  pure subroutine settle_odd(surface, chain, block)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) places
    type(foot_block_t), intent(inout) :: block
    real(wp) :: beside(2, n_block)
    integer :: i, k

    if (block%n_odd > n_alone) then
      call see_neighbours(block%n, block%segment, block%xi, surface%previous, surface%next, &
        surface%segments, chain, beside)
      call keep_near_nodes(block%n, block%t, block%d, block%xi, beside, block%odd, block%n_odd)
      if (block%n_odd == 0) return
    end if
    call list_odd(block%n, block%odd, block%n_moved, block%moved)
    do i = 1, block%n_moved
      k = block%moved(i)
      call settle(surface%segments, surface%previous(block%segment(k)), &
        surface%next(block%segment(k)), chain, k, block)
      if (.not. block%odd(k) > 0.0_wp) block%n_odd = block%n_odd - 1
    end do
  end subroutine settle_odd

  !> List the odd places of a block.
  pure subroutine list_odd(n, odd, n_odd, list)
    integer, intent(in) :: n
    real(wp), intent(in) :: odd(n)
    integer, intent(out) :: n_odd
    integer, intent(inout) :: list(n)
    integer :: k

    n_odd = 0
    do k = 1, n
      if (.not. odd(k) > 0.0_wp) cycle
      n_odd = n_odd + 1
      list(n_odd) = k
    end do
  end subroutine list_odd

  !> The neighbour of each segment at the end next to the foot, where the chain ends the segment
  !> itself: first all numbers, then the vectors.
  pure subroutine see_neighbours(n, segment, xi, previous, next, ends, chain, beside)
    integer, intent(in) :: n, segment(n)
    real(wp), intent(in) :: xi(n)
    integer, intent(in) :: previous(*), next(*), ends(2, *)
    real(wp), intent(in) :: chain(4, *)
    real(wp), intent(inout) :: beside(2, n) !! its vector, m
    real(wp) :: vector(4)
    integer :: others(n_block), k, other

    do k = 1, n
      other = merge(next(segment(k)), previous(segment(k)), xi(k) > 0.5_wp)
      others(k) = merge(other, segment(k), other > 0)
    end do
    !GCC$ NOVECTOR
    do k = 1, n
      vector = chain(:, ends(2, others(k))) - chain(:, ends(1, others(k)))
      beside(:, k) = vector(1:2) + vector(3:4)
    end do
  end subroutine see_neighbours

  !> Odd places behind their segments that stay: over them, and no nearer to the neighbour at the
  !> one end that is nearer than the place is deep. Most feet on nodes of a chain that turns
  !> gently are such. The same decision as that of `settle`, as a number: with `.and.` and `.or.` of
  !> all its parts the loop would not be vectorised.
  pure subroutine keep_near_nodes(n, t, d, xi, beside, odd, n_odd)
    integer, intent(in) :: n
    real(wp), intent(in) :: t(2, n), d(2, n), xi(n), beside(2, n)
    real(wp), intent(inout) :: odd(n)
    integer, intent(out) :: n_odd
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
      odd(k) = merge(0.0_wp, odd(k), min(to_end + round_off*square, across + (square - to_end), &
        stays - 0.5_wp) >= 0.0_wp)
      total = total + odd(k)
    end do
    n_odd = nint(total)
  end subroutine keep_near_nodes

  !> One place. It has its foot here where it is over the segment and no nearer to a neighbour; on
  !> the neighbour at a gentle corner where it is behind that and not far from the corner; and at
  !> the node where it is over neither of the two there and on the same side of both. A place within
  !> round-off of a node is over this segment.
  pure subroutine settle(ends, previous, next, chain, k, block)
    integer, intent(in) :: ends(2, *)     !! of the segments
    integer, intent(in) :: previous, next !! neighbours, 0: none
    real(wp), intent(in) :: chain(4, *)
    integer, intent(in) :: k
    type(foot_block_t), intent(inout) :: block
    type(sight_t) :: own
    real(wp) :: before, after
    logical :: is_over

    own%t = block%t(:, k)
    own%d = block%d(:, k)
    own%square = own%t(1)*own%t(1) + own%t(2)*own%t(2)
    own%along = own%d(1)*own%t(1) + own%d(2)*own%t(2)
    own%across = own%d(1)*own%t(2) - own%d(2)*own%t(1)
    before = own%along + merge(round_off, end_tolerance, previous > 0)*own%square
    after = own%square - own%along + merge(round_off, end_tolerance, next > 0)*own%square
    is_over = min(before, after) >= 0.0_wp
    associate (s => block%segment(k))
      if (is_over) then
        ! Behind the segment a neighbour can be nearer only if its node is.
        if (previous > 0 .and. (own%across >= 0.0_wp .or. own%across + own%along < 0.0_wp)) &
          is_over = stays(own, chain(:, ends(1, s)) - chain(:, ends(1, previous)), own%d, 1.0_wp)
        if (is_over .and. next > 0 .and. (own%across >= 0.0_wp .or. own%across + own%square &
          < own%along)) is_over = stays(own, chain(:, ends(2, next)) - chain(:, ends(2, s)), &
          own%d - own%t, -1.0_wp)
        if (is_over) block%odd(k) = 0.0_wp
      else if (before < 0.0_wp .and. previous > 0) then
        call go_over(own, chain(:, ends(1, s)) - chain(:, ends(1, previous)), own%d, 1.0_wp, &
          previous, k, block)
      else if (after < 0.0_wp .and. next > 0) then
        call go_over(own, chain(:, ends(2, next)) - chain(:, ends(2, s)), own%d - own%t, -1.0_wp, &
          next, k, block)
      end if
    end associate
  end subroutine settle

  !> Whether a place over a segment is no nearer to a neighbour.
  pure function stays(own, neighbour, from_node, way)
    type(sight_t), intent(in) :: own
    real(wp), intent(in) :: neighbour(4) !! vector in X and in u, m
    real(wp), intent(in) :: from_node(2) !! from the node in common to the place, m
    real(wp), intent(in) :: way          !! 1: the neighbour lies before, -1: behind
    logical :: stays
    real(wp) :: t(2), square, along, across, product

    t = neighbour(1:2) + neighbour(3:4)
    square = t(1)*t(1) + t(2)*t(2)
    along = way*(from_node(1)*t(1) + from_node(2)*t(2))
    stays = along >= -round_off*(from_node(1)**2 + from_node(2)**2 + square)
    if (stays) return
    ! At a sharp corner a place stays on its face until that ends (follow_contact).
    product = own%t(1)*t(1) + own%t(2)*t(2)
    stays = product < 0.0_wp .or. product**2 < gentle_turn**2*(own%square*square)
    if (stays) return
    across = from_node(1)*t(2) - from_node(2)*t(1)
    stays = across**2*own%square >= own%across**2*square
  end function stays

  !> The foot of a place beyond a node of its segment: on the neighbour there, or at the node.
  pure subroutine go_over(own, neighbour, from_node, way, other, k, block)
    type(sight_t), intent(in) :: own
    real(wp), intent(in) :: neighbour(4) !! vector in X and in u, m
    real(wp), intent(in) :: from_node(2) !! from the node in common to the place, m
    real(wp), intent(in) :: way          !! 1: the neighbour lies before, -1: behind
    integer, intent(in) :: other, k      !! the neighbour, the place
    type(foot_block_t), intent(inout) :: block
    real(wp) :: t(2), square, along, across, product, small

    t = neighbour(1:2) + neighbour(3:4)
    square = t(1)*t(1) + t(2)*t(2)
    along = way*(from_node(1)*t(1) + from_node(2)*t(2))
    across = from_node(1)*t(2) - from_node(2)*t(1)
    small = round_off*(from_node(1)**2 + from_node(2)**2 + square)
    if (along > small .and. across*own%across > 0.0_wp) then
      block%odd(k) = -1.0_wp
      block%xi(k) = 0.5_wp - 0.5_wp*way
      block%gap(k) = sign(sqrt(from_node(1)**2 + from_node(2)**2), own%across)
      block%normal(:, k) = from_node/block%gap(k)
      if (across**2*own%square > own%across**2*square) then
        block%segment(k) = other
        block%inverse(k) = 1.0_wp/sqrt(square)
        block%xi(k) = 0.5_wp + 0.5_wp*way
      end if
    else if (along < -small .and. max(across, own%across) < 0.0_wp &
      .and. -across <= square + along) then
      product = own%t(1)*t(1) + own%t(2)*t(2)
      if (product < 0.0_wp .or. product**2 < gentle_turn**2*(own%square*square)) return
      block%odd(k) = -1.0_wp
      block%segment(k) = other
      block%inverse(k) = 1.0_wp/sqrt(square)
      block%xi(k) = (0.5_wp + 0.5_wp*way) + way*along/square
      block%gap(k) = across*block%inverse(k)
      block%normal(1, k) = t(2)*block%inverse(k)
      block%normal(2, k) = -(t(1)*block%inverse(k))
    end if
  end subroutine go_over

end module foot_block_m
