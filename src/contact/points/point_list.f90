! SPDX-License-Identifier: MIT
!> The list of contact points and its only writer: points on slave segments one by one or in blocks,
!> points at the active nodes of a surface all together.
module point_list_m
  use contact_state_m, only : contact_points_t, contact_status_t, make_room, n_side
  use projection_block_m, only : projection_block_t, n_block
  use projection_m, only : projection_t, opposed_share, face_on
  use kinds_m, only : wp
  use radii_m, only : radius_between
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: point_block_t, append_points, add_point, append_active, &
    finish_segment_points

  !> Positions on slave segments that are to be points, with their projections on the master: many
  !> at a time, so that these are formed together. Without default values, which would be written
  !> before each use.
  type :: point_block_t
    integer :: n
    integer :: ends(n_side, n_block)  !! nodes of the slave segment
    integer :: nodes(n_side, n_block) !! of the master segment, local numbers
    real(wp) :: xi(n_block)           !! position on the slave segment, 0 to 1
    real(wp) :: area(n_block)         !! m
    type(projection_block_t) :: projections
  end type point_block_t

contains

  !> Append the positions of a block and empty it.
  pure subroutine append_points(block, stiffness, points)
    type(point_block_t), intent(inout) :: block
    real(wp), intent(in) :: stiffness !! of all, N/m^2
    type(contact_points_t), intent(inout) :: points

    if (block%n == 0) return
    call make_room(points, block%n)
    associate (p => points%n + 1, n => block%n, projections => block%projections)
      call put_side(n, block%ends, block%xi, points%slave_nodes(1, p), points%slave_weights(1, p))
      call put_side(n, block%nodes, projections%xi, points%master_nodes(1, p), &
        points%master_weights(1, p))
      call put_springs(n, projections%gap, projections%normal, block%area, points%gap(p), &
        points%normal(1, p), points%area(p))
      points%stiffness(p:p + n - 1) = stiffness
    end associate
    points%n = points%n + block%n
    block%n = 0
  end subroutine append_points

  !> Append a point on a slave segment, or at an end of it.
  pure subroutine add_point(points, ends, xi, nodes, projection, area, stiffness)
    type(contact_points_t), intent(inout) :: points
    integer, intent(in) :: ends(2)    !! nodes of the slave segment
    real(wp), intent(in) :: xi        !! position on that, 0 to 1
    integer, intent(in) :: nodes(2)   !! of the master segment, local numbers
    type(projection_t), intent(in) :: projection !! position on that, gap and normal
    real(wp), intent(in) :: area      !! m
    real(wp), intent(in) :: stiffness !! N/m^2
    integer :: p

    p = points%n + 1
    if (p > size(points%gap)) call make_room(points, 1)
    points%slave_nodes(:, p) = ends
    points%slave_weights(:, p) = [1.0_wp - xi, xi]
    points%master_nodes(:, p) = nodes
    points%master_weights(:, p) = [1.0_wp - projection%xi, projection%xi]
    points%normal(:, p) = projection%normal
    points%gap(p) = projection%gap
    points%area(p) = area
    points%stiffness(p) = stiffness
    points%n = p
  end subroutine add_point

  !> Append a point for each tracked node in contact, all of one area and stiffness. The tracked
  !> node stands on the slave side of the record, whichever surface it belongs to.
  pure subroutine append_active(status, polyline, offsets, area, stiffness, points)
    type(contact_status_t), intent(in) :: status
    type(surface_t), intent(in) :: polyline !! tracked upon
    integer, intent(in) :: offsets(2)     !! local number before the first tracked node, and before
                                          !! the first node of the surface
    real(wp), intent(in) :: area          !! m
    real(wp), intent(in) :: stiffness     !! N/m^2 (N/m where the area is 1)
    type(contact_points_t), intent(inout) :: points

    associate (n => status%n_active, p => points%n + 1)
      if (n == 0) return
      call make_room(points, n)
      call put_nodes(n, status%active_points, status%segment, polyline%segments, offsets, &
        points%slave_nodes(1, p), points%master_nodes(1, p))
      call put_projections(n, status%active_points, status%xi, status%gap, status%normal, &
        points%master_weights(1, p), points%gap(p), points%normal(1, p))
      points%slave_weights(1, p:p + n - 1) = 1.0_wp
      points%slave_weights(2, p:p + n - 1) = 0.0_wp
      points%area(p:p + n - 1) = area
      points%stiffness(p:p + n - 1) = stiffness
    end associate
    points%n = points%n + status%n_active
  end subroutine append_active

  !> Points on slave segments: reduce their areas to what is opposed to the master, and drop those
  !> without; in axisymmetry let them weigh with the radius where they stand.
  pure subroutine finish_segment_points(positions, is_round, first, points)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    logical, intent(in) :: is_round
    integer, intent(in) :: first                     !! of these points
    type(contact_points_t), intent(inout) :: points
    integer :: p, n

    n = points%n - first + 1
    if (n < 1) return
    call reduce_areas(n, points%slave_nodes(1, first), points%normal(1, first), positions, &
      points%area(first))
    if (is_round) then
      do p = first, points%n
        associate (nodes => points%slave_nodes(:, p))
          points%area(p) = points%area(p)*radius_between(positions(:, nodes(1)), &
            positions(:, nodes(2)), points%slave_weights(2, p))
        end associate
      end do
    end if
    if (all(points%area(first:points%n) > 0.0_wp)) return
    n = first - 1
    do p = first, points%n
      if (.not. points%area(p) > 0.0_wp) cycle
      n = n + 1
      if (n < p) call move_point(p, n, points)
    end do
    points%n = n
  end subroutine finish_segment_points

  !> Reduce areas to what is opposed to the master.
  pure subroutine reduce_areas(n, ends, normal, positions, area)
    integer, intent(in) :: n, ends(n_side, n)       !! of the slave segments
    real(wp), intent(in) :: normal(2, n)            !! outward, of the master
    real(wp), intent(in) :: positions(4, *)
    real(wp), intent(inout) :: area(n)              !! m
    real(wp) :: along(4), across, square
    integer :: p

    !GCC$ NOVECTOR
    do p = 1, n
      along = positions(:, ends(2, p)) - positions(:, ends(1, p))
      across = (along(2) + along(4))*normal(1, p) - (along(1) + along(3))*normal(2, p)
      square = (along(1) + along(3))**2 + (along(2) + along(4))**2
      if (across > 0.0_wp .or. across*across < face_on**2*square) &
        area(p) = area(p)*opposed_share(across/sqrt(square))
    end do
  end subroutine reduce_areas

  !> Move a point on the list.
  pure subroutine move_point(from, to, points)
    integer, intent(in) :: from, to
    type(contact_points_t), intent(inout) :: points

    points%slave_nodes(:, to) = points%slave_nodes(:, from)
    points%slave_weights(:, to) = points%slave_weights(:, from)
    points%master_nodes(:, to) = points%master_nodes(:, from)
    points%master_weights(:, to) = points%master_weights(:, from)
    points%gap(to) = points%gap(from)
    points%normal(:, to) = points%normal(:, from)
    points%area(to) = points%area(from)
    points%stiffness(to) = points%stiffness(from)
  end subroutine move_point

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

  !> Tracked nodes, and the nodes of the segments that they are in contact with.
  pure subroutine put_nodes(n, active_points, segment, segments, offsets, slave_nodes, master_nodes)
    integer, intent(in) :: n, active_points(n), segment(*), segments(n_side, *), offsets(2)
    integer, intent(inout) :: slave_nodes(n_side, n), master_nodes(n_side, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      slave_nodes(:, k) = offsets(1) + active_points(k)
      master_nodes(:, k) = offsets(2) + segments(:, segment(active_points(k)))
    end do
  end subroutine put_nodes

  !> Projections of tracked nodes.
  pure subroutine put_projections(n, active_points, xi, gap, normal, weights, point_gap, &
    point_normal)
    integer, intent(in) :: n, active_points(n)
    real(wp), intent(in) :: xi(*), gap(*), normal(2, *)
    real(wp), intent(inout) :: weights(n_side, n), point_gap(n), point_normal(2, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      weights(1, k) = 1.0_wp - xi(active_points(k))
      weights(2, k) = xi(active_points(k))
      point_gap(k) = gap(active_points(k))
      point_normal(:, k) = normal(:, active_points(k))
    end do
  end subroutine put_projections

end module point_list_m
