! SPDX-License-Identifier: MIT
!> The list of contact points and its only writer. Placements hand over blocks of places with their
!> feet, or the spots in contact of a tracking.
module point_list_m
  use contact_state_m, only : contact_points_t, tracking_t, make_room, n_side
  use foot_block_m, only : foot_block_t, n_block
  use kinds_m, only : wp
  use lengths_m, only : put_lengths, tributary_area, mean_radius
  use radii_m, only : radius_of
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: place_block_t, append_points, drop_places, append_touching, set_lengths, &
    add_length, weigh_nodes, weigh_points

  !> Places on slave segments that are to be points, with their feet on the master. Without default
  !> values, which would be written before each use.
  type :: place_block_t
    integer :: n
    integer :: ends(2, n_block)    !! nodes of the slave segment
    integer :: nodes(2, n_block)   !! local numbers of the nodes of the master segment
    real(wp) :: xi(n_block)        !! place on the slave segment, 0 to 1
    real(wp) :: area(n_block)      !! m
    type(foot_block_t) :: feet
  end type place_block_t

contains

  !> Append the places of a block and empty it.
  pure subroutine append_points(block, stiffness, points)
    type(place_block_t), intent(inout) :: block
    real(wp), intent(in) :: stiffness !! of all, N/m^2
    type(contact_points_t), intent(inout) :: points

    if (block%n == 0) return
    call make_room(points, block%n)
    associate (p => points%n + 1)
      call put_side(block%n, block%ends, block%xi, points%slave_nodes(1, p), &
        points%slave_weights(1, p))
      call put_side(block%n, block%nodes, block%feet%xi, points%master_nodes(1, p), &
        points%master_weights(1, p))
      call put_springs(block%n, block%feet%gap, block%feet%normal, block%area, points%gap(p), &
        points%normal(1, p), points%area(p))
      points%stiffness(p:p + block%n - 1) = stiffness
    end associate
    points%n = points%n + block%n
    block%n = 0
  end subroutine append_points

  !> Drop the places of a block without area.
  pure subroutine drop_places(block)
    type(place_block_t), intent(inout) :: block
    integer :: k, n

    n = 0
    do k = 1, block%n
      if (.not. block%area(k) > 0.0_wp) cycle
      n = n + 1
      if (n == k) cycle
      block%ends(:, n) = block%ends(:, k)
      block%nodes(:, n) = block%nodes(:, k)
      block%xi(n) = block%xi(k)
      block%area(n) = block%area(k)
      block%feet%xi(n) = block%feet%xi(k)
      block%feet%gap(n) = block%feet%gap(k)
      block%feet%normal(:, n) = block%feet%normal(:, k)
    end do
    block%n = n
  end subroutine drop_places

  !> Append a point for each tracked node in contact, all of one area and stiffness. The tracked
  !> node stands on the slave side of the record, whichever surface it belongs to.
  pure subroutine append_touching(tracking, chain, offsets, area, stiffness, points)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: chain  !! tracked upon
    integer, intent(in) :: offsets(2)     !! local number before the first tracked node, and before
                                          !! the first node of the chain
    real(wp), intent(in) :: area          !! m
    real(wp), intent(in) :: stiffness     !! N/m^2 (N/m where the area is 1)
    type(contact_points_t), intent(inout) :: points
    integer :: first, i, n, p

    call make_room(points, tracking%n_touching)
    do first = 1, tracking%n_touching, n_block
      n = min(n_block, tracking%n_touching - first + 1)
      p = points%n + 1
      i = tracking%touching(first)
      call put_segments(n, tracking%touching(first), tracking%segment, chain%segments, offsets(2), &
        points%master_nodes(1, p))
      call put_nodes(n, tracking%touching(first), offsets(1), points%slave_nodes(1, p), &
        points%slave_weights(1, p))
      if (tracking%touching(first + n - 1) == i + n - 1) then
        call put_feet(n, tracking%xi(i), tracking%gap(i), tracking%normal(1, i), &
          points%master_weights(1, p), points%gap(p), points%normal(1, p))
      else
        call take_feet(n, tracking%touching(first), tracking%xi, tracking%gap, tracking%normal, &
          points%master_weights(1, p), points%gap(p), points%normal(1, p))
      end if
      points%area(p:p + n - 1) = area
      points%stiffness(p:p + n - 1) = stiffness
      points%n = points%n + n
    end do
  end subroutine append_touching

  !> Let the points of active nodes from one to the last have the tributary lengths of their nodes
  !> as areas; on closed boundaries, where sides count as far as they are opposed, in axisymmetry
  !> already weighted with the radius.
  pure subroutine set_lengths(tracking, own, places, is_round, first, points)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: own               !! of the tracked nodes
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of these
    logical, intent(in) :: is_round
    integer, intent(in) :: first                     !! of the points
    type(contact_points_t), intent(inout) :: points
    integer :: k

    if (tracking%pass%is_closed) then
      do k = 1, tracking%n_touching
        associate (node => tracking%touching(k))
          points%area(first + k - 1) = tributary_area(own, places, is_round, node, &
            tracking%normal(:, node))
        end associate
      end do
    else if (points%n >= first) then
      call put_lengths(own, places, tracking%n_touching, tracking%touching, points%area(first:))
    end if
  end subroutine set_lengths

  !> Give length to a point, if there is one.
  pure subroutine add_length(points, p, length)
    type(contact_points_t), intent(inout) :: points
    integer, intent(in) :: p       !! 0: none
    real(wp), intent(in) :: length !! m

    if (p > 0) points%area(p) = points%area(p) + length
  end subroutine add_length

  !> In axisymmetry: let the points of tracked nodes from one to the last weigh with the mean radius
  !> of the lengths of their nodes.
  pure subroutine weigh_nodes(tracking, own, places, first, points)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: own               !! of the tracked nodes
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of these
    integer, intent(in) :: first                     !! of the points
    type(contact_points_t), intent(inout) :: points
    integer :: k, p

    do k = 1, tracking%n_touching
      p = first + k - 1
      associate (node => tracking%touching(k))
        if (tracking%pass%is_closed) then
          points%area(p) = points%area(p)*tributary_area(own, places, .true., node, &
            tracking%normal(:, node))/max(tributary_area(own, places, .false., node, &
            tracking%normal(:, node)), tiny(1.0_wp))
        else
          points%area(p) = points%area(p)*mean_radius(own, places, node)
        end if
      end associate
    end do
  end subroutine weigh_nodes

  !> In axisymmetry: let all points weigh with the radius where they stand on the slave side.
  pure subroutine weigh_points(places, points)
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of the interface
    type(contact_points_t), intent(inout) :: points
    integer :: p

    do p = 1, points%n
      associate (nodes => points%slave_nodes(:, p), weights => points%slave_weights(:, p))
        points%area(p) = points%area(p)*(weights(1)*radius_of(places(:, nodes(1))) &
          + weights(2)*radius_of(places(:, nodes(2))))
      end associate
    end do
  end subroutine weigh_points

  !> Nodes and weights of one side of some points.
  pure subroutine put_side(n, nodes, xi, point_nodes, weights)
    integer, intent(in) :: n, nodes(n_side, n)
    real(wp), intent(in) :: xi(n)
    integer, intent(inout) :: point_nodes(n_side, n)
    real(wp), intent(inout) :: weights(n_side, n)
    integer :: k

    point_nodes = nodes
    do k = 1, n
      weights(1, k) = 1.0_wp - xi(k)
      weights(2, k) = xi(k)
    end do
  end subroutine put_side

  !> Gaps, normals and areas of some points.
  pure subroutine put_springs(n, gap, normal, area, point_gap, point_normal, point_area)
    integer, intent(in) :: n
    real(wp), intent(in) :: gap(n), normal(2, n), area(n)
    real(wp), intent(inout) :: point_gap(n), point_normal(2, n), point_area(n)

    point_gap = gap
    point_normal = normal
    point_area = area
  end subroutine put_springs

  !> Slave side of points at tracked nodes.
  pure subroutine put_nodes(n, touching, offset, nodes, weights)
    integer, intent(in) :: n, touching(n), offset
    integer, intent(inout) :: nodes(n_side, n)
    real(wp), intent(inout) :: weights(n_side, n)
    integer :: k

    do k = 1, n
      nodes(1, k) = offset + touching(k)
      nodes(2, k) = offset + touching(k)
    end do
    do k = 1, n
      weights(1, k) = 1.0_wp
      weights(2, k) = 0.0_wp
    end do
  end subroutine put_nodes

  !> Nodes of their master segments.
  pure subroutine put_segments(n, touching, segment, segments, offset, nodes)
    integer, intent(in) :: n, touching(n), segment(*), segments(n_side, *), offset
    integer, intent(inout) :: nodes(n_side, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      nodes(:, k) = offset + segments(:, segment(touching(k)))
    end do
  end subroutine put_segments

  !> Feet of tracked nodes that follow each other.
  pure subroutine put_feet(n, xi, gap, normal, weights, point_gap, point_normal)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(n), gap(n), normal(2, n)
    real(wp), intent(inout) :: weights(n_side, n), point_gap(n), point_normal(2, n)
    integer :: k

    do k = 1, n
      weights(1, k) = 1.0_wp - xi(k)
      weights(2, k) = xi(k)
    end do
    point_gap = gap
    point_normal = normal
  end subroutine put_feet

  !> The same for any tracked nodes.
  pure subroutine take_feet(n, touching, xi, gap, normal, weights, point_gap, point_normal)
    integer, intent(in) :: n, touching(n)
    real(wp), intent(in) :: xi(*), gap(*), normal(2, *)
    real(wp), intent(inout) :: weights(n_side, n), point_gap(n), point_normal(2, n)
    integer :: k, i

    !GCC$ NOVECTOR
    do k = 1, n
      i = touching(k)
      weights(1, k) = 1.0_wp - xi(i)
      weights(2, k) = xi(i)
      point_gap(k) = gap(i)
      point_normal(1, k) = normal(1, i)
      point_normal(2, k) = normal(2, i)
    end do
  end subroutine take_feet

end module point_list_m
