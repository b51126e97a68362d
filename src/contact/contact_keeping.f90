! SPDX-License-Identifier: MIT
!> Spots that stay in contact where they are: the common case of the search, many spots at a time.
!> Their feet go to the tracking; or straight onto the list of points, where the points of these
!> spots stand already: then the points know the nodes of either side, and nothing is written twice:
!> 15 to 20 % of the contact of types 1 to 3, 4 % of type 5 where the lists are longer than the
!> caches.
module contact_keeping_m
  use contact_state_m, only : contact_points_t, tracking_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: keep_contacts, keep_points, move_points, take_feet, take_foot

  !> Spots projected together.
  integer, parameter :: block_size = 64

contains

  !> The common case of spots in contact: still over their segment, behind it, and no nearer to a
  !> neighbour than to it. The others are listed. In blocks, so that the roots and quotients
  !> of a block are formed together.
  pure subroutine keep_contacts(ends, chain, spots, tracking, n_left)
    integer, intent(in) :: ends(2, *) !! of the segments of the chain
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    type(tracking_t), intent(inout) :: tracking
    integer, intent(out) :: n_left    !! spots that were not kept: `tracking%due`
    real(wp) :: edge(2, block_size), way(2, block_size), normal(2, block_size)
    real(wp), dimension(block_size) :: xi, gap, beside
    integer :: first, n, i, k, n_beside

    n_left = 0
    do first = 1, tracking%n_touching, block_size
      n = min(block_size, tracking%n_touching - first + 1)
      call see_spots(n, tracking%touching(first), tracking%segment, ends, chain, spots, edge, way)
      i = tracking%touching(first)
      if (tracking%touching(first + n - 1) == i + n - 1) then
        call project_block(n, edge, way, tracking%xi(i), tracking%gap(i), tracking%normal(1, i), &
          beside, n_beside)
      else
        call project_block(n, edge, way, xi, gap, normal, beside, n_beside)
        do k = 1, n
          i = tracking%touching(first + k - 1)
          tracking%xi(i) = xi(k)
          tracking%gap(i) = gap(k)
          tracking%normal(1, i) = normal(1, k)
          tracking%normal(2, i) = normal(2, k)
        end do
      end if
      if (n_beside > 0) call list_left(n, beside, first, tracking%due, n_left)
    end do
  end subroutine keep_contacts

  !> The same for spots whose points stand on the list: their feet are written there.
  pure subroutine keep_points(offset, chain, spots, tracking, points, n_left)
    integer, intent(in) :: offset        !! local number before the chain's first node
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    type(tracking_t), intent(inout) :: tracking
    type(contact_points_t), intent(inout) :: points
    integer, intent(out) :: n_left       !! spots that were not kept: `tracking%due`
    real(wp) :: edge(2, block_size), way(2, block_size)
    real(wp), dimension(block_size) :: xi, beside
    integer :: first, n, p, n_beside

    n_left = 0
    do first = 1, tracking%n_touching, block_size
      n = min(block_size, tracking%n_touching - first + 1)
      p = tracking%first_point + first - 1
      call see_points(n, tracking%touching(first), offset, points%master_nodes(1, p), chain, &
        spots, edge, way)
      call project_block(n, edge, way, xi, points%gap(p), points%normal(1, p), beside, n_beside)
      call put_weights(n, xi, points%master_weights(1, p))
      if (n_beside > 0) call list_left(n, beside, first, tracking%due, n_left)
    end do
  end subroutine keep_points

  !> Vectors of a block of spots.
  pure subroutine see_spots(n, touching, segment, ends, chain, spots, edge, way)
    integer, intent(in) :: n, touching(n), segment(*), ends(2, *)
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    real(wp), intent(inout) :: edge(2, block_size) !! segments, m
    real(wp), intent(inout) :: way(2, block_size)  !! from the segments' first nodes, m
    real(wp), dimension(4) :: along, across
    integer :: i, k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      i = touching(k)
      a = ends(1, segment(i))
      b = ends(2, segment(i))
      along = chain(:, b) - chain(:, a)
      across = spots(:, i) - chain(:, a)
      edge(:, k) = along(1:2) + along(3:4)
      way(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine see_spots

  !> The same where the ends of the segments are known from the points.
  pure subroutine see_points(n, touching, offset, nodes, chain, spots, edge, way)
    integer, intent(in) :: n, touching(n), offset, nodes(n_side, n)
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    real(wp), intent(inout) :: edge(2, block_size), way(2, block_size)
    real(wp), dimension(4) :: along, across
    integer :: k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      a = nodes(1, k) - offset
      b = nodes(2, k) - offset
      along = chain(:, b) - chain(:, a)
      across = spots(:, touching(k)) - chain(:, a)
      edge(:, k) = along(1:2) + along(3:4)
      way(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine see_points

  !> Projections of a block. A loop that stores logicals is not vectorised, so that the answer is a
  !> real.
  pure subroutine project_block(n, edge, way, xi, gap, normal, beside, n_beside)
    integer, intent(in) :: n
    real(wp), intent(in) :: edge(2, block_size), way(2, block_size)
    real(wp), intent(inout) :: xi(n), gap(n), normal(2, n)
    real(wp), intent(inout) :: beside(block_size) !! 0: behind the segment, and not nearer to a
                                                  !! neighbour; else 1
    integer, intent(out) :: n_beside              !! sum of these
    real(wp) :: square, along, across, inverse, total
    integer :: k

    total = 0.0_wp
    !$omp simd reduction(+: total)
    do k = 1, n
      square = max(edge(1, k)*edge(1, k) + edge(2, k)*edge(2, k), tiny(1.0_wp))
      along = way(1, k)*edge(1, k) + way(2, k)*edge(2, k)
      across = way(1, k)*edge(2, k) - way(2, k)*edge(1, k)
      beside(k) = merge(0.0_wp, 1.0_wp, across < 0.0_wp .and. across + along >= 0.0_wp &
        .and. across + square >= along)
      total = total + beside(k)
      inverse = 1.0_wp/sqrt(square)
      xi(k) = along*(inverse*inverse)
      gap(k) = across*inverse
      normal(1, k) = edge(2, k)*inverse
      normal(2, k) = -(edge(1, k)*inverse)
    end do
    n_beside = nint(total)
  end subroutine project_block

  !> Weights of the ends of the segments.
  pure subroutine put_weights(n, xi, weights)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(n)
    real(wp), intent(inout) :: weights(n_side, n)
    integer :: k

    do k = 1, n
      weights(1, k) = 1.0_wp - xi(k)
      weights(2, k) = xi(k)
    end do
  end subroutine put_weights

  !> List the spots of a block that were not kept, by their position on the list of those in
  !> contact.
  pure subroutine list_left(n, beside, first, left, n_left)
    integer, intent(in) :: n
    real(wp), intent(in) :: beside(n)
    integer, intent(in) :: first !! position of the block's first
    integer, intent(inout) :: left(*), n_left
    integer :: k

    do k = 1, n
      if (.not. beside(k) > 0.0_wp) cycle
      n_left = n_left + 1
      left(n_left) = first + k - 1
    end do
  end subroutine list_left

  !> Bring the points of spots that were not kept, but have found another foot, up to date.
  pure subroutine move_points(offset, segments, n_left, tracking, points)
    integer, intent(in) :: offset, segments(n_side, *) !! of the chain
    integer, intent(in) :: n_left
    type(tracking_t), intent(in) :: tracking
    type(contact_points_t), intent(inout) :: points
    integer :: l, i, p

    do l = 1, n_left
      i = tracking%touching(tracking%due(l))
      p = tracking%first_point + tracking%due(l) - 1
      points%master_nodes(:, p) = offset + segments(:, tracking%segment(i))
      points%master_weights(:, p) = [1.0_wp - tracking%xi(i), tracking%xi(i)]
      points%gap(p) = tracking%gap(i)
      points%normal(:, p) = tracking%normal(:, i)
    end do
  end subroutine move_points

  !> Take the feet of spots that were kept from the points to the tracking: the list of these spots
  !> has changed.
  pure subroutine take_feet(points, n_left, tracking)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: n_left
    type(tracking_t), intent(inout) :: tracking
    integer :: k, l

    l = 1
    do k = 1, tracking%n_touching
      if (l <= n_left) then
        if (tracking%due(l) == k) then
          l = l + 1
          cycle
        end if
      end if
      call take_foot(points, tracking%first_point + k - 1, tracking%touching(k), tracking)
    end do
    tracking%has_feet = .true.
  end subroutine take_feet

  !> Take one of them.
  pure subroutine take_foot(points, p, i, tracking)
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: p, i !! point, spot
    type(tracking_t), intent(inout) :: tracking

    tracking%xi(i) = points%master_weights(2, p)
    tracking%gap(i) = points%gap(p)
    tracking%normal(:, i) = points%normal(:, p)
  end subroutine take_foot

end module contact_keeping_m
