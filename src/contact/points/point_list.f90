! SPDX-License-Identifier: MIT
!> The list of contact points and its only writer: points on slave segments one by one or in blocks,
!> points at the active nodes of a surface all together.
module point_list_m
  use contact_state_m, only : contact_points_t, make_room, move_point, n_side
  use search_state_m, only : contact_status_t
  use projection_block_m, only : projection_block_t, n_block
  use projection_m, only : projection_t, opposed_share, face_on
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  use tributary_lengths_m, only : radius_between
  implicit none
  private
  public :: point_block_t, append_block, add_point, known_projection, append_active, copy_list, &
    finish_segment_points

  !> Positions on slave segments that are to be points, with their projections on the master: many
  !> at a time, so that these are formed together. Without default values, which would be written
  !> before each use.
  type, extends(projection_block_t) :: point_block_t
    integer :: ends(n_side, n_block)  !! nodes of the slave segment
    integer :: nodes(n_side, n_block) !! of the master segment, local numbers
    real(wp) :: at(n_block)           !! position on the slave segment, 0 to 1
    real(wp) :: area(n_block)         !! m
  end type point_block_t

contains

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

  !> Append the points of a block and empty it.
  pure subroutine append_block(block, stiffness, points)
    type(point_block_t), intent(inout) :: block
    real(wp), intent(in) :: stiffness !! of all, N/m^2
    type(contact_points_t), intent(inout) :: points

    call make_room(points, block%n)
    associate (p => points%n + 1, last => points%n + block%n, n => block%n)
      call store_side(n, block%ends, block%at, points%slave_nodes(1, p), points%slave_weights(1, p))
      call store_side(n, block%nodes, block%xi, points%master_nodes(1, p), &
        points%master_weights(1, p))
      points%gap(p:last) = block%gap(:n)
      points%normal(:, p:last) = block%normal(:, :n)
      points%area(p:last) = block%area(:n)
      points%stiffness(p:last) = stiffness
    end associate
    points%n = points%n + block%n
    block%n = 0
  end subroutine append_block

  !> Nodes and weights of one side of some points.
  pure subroutine store_side(n, nodes, xi, point_nodes, weights)
    integer, intent(in) :: n, nodes(n_side, n)
    real(wp), intent(in) :: xi(n)
    integer, intent(inout) :: point_nodes(n_side, n)
    real(wp), intent(inout) :: weights(n_side, n)

    point_nodes = nodes
    weights(1, :) = 1.0_wp - xi
    weights(2, :) = xi
  end subroutine store_side

  !> The projection of an active point that the search follows.
  pure function known_projection(status, i) result(projection)
    type(contact_status_t), intent(in) :: status
    integer, intent(in) :: i
    type(projection_t) :: projection

    projection%segment = status%segment(i)
    projection%is_on = .true.
    projection%xi = status%xi(i)
    projection%gap = status%gap(i)
    projection%normal = status%normal(:, i)
  end function known_projection

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
    integer :: k, p, i

    call make_room(points, status%n_active)
    !GCC$ NOVECTOR
    do k = 1, status%n_active
      p = points%n + k
      i = status%active_points(k)
      points%slave_nodes(:, p) = offsets(1) + i
      points%slave_weights(:, p) = [1.0_wp, 0.0_wp]
      points%master_nodes(:, p) = offsets(2) + polyline%segments(:, status%segment(i))
      points%master_weights(:, p) = [1.0_wp - status%xi(i), status%xi(i)]
      points%gap(p) = status%gap(i)
      points%normal(:, p) = status%normal(:, i)
      points%area(p) = area
      points%stiffness(p) = stiffness
    end do
    points%n = points%n + status%n_active
  end subroutine append_active

  !> Copy all points of another list behind the first `n_before`, where there is room for them.
  pure subroutine copy_list(list, n_before, points)
    type(contact_points_t), intent(in) :: list
    integer, intent(in) :: n_before
    type(contact_points_t), intent(inout) :: points

    associate (n => list%n, first => n_before + 1, last => n_before + list%n)
      points%slave_nodes(:, first:last) = list%slave_nodes(:, :n)
      points%slave_weights(:, first:last) = list%slave_weights(:, :n)
      points%master_nodes(:, first:last) = list%master_nodes(:, :n)
      points%master_weights(:, first:last) = list%master_weights(:, :n)
      points%normal(:, first:last) = list%normal(:, :n)
      points%gap(first:last) = list%gap(:n)
      points%area(first:last) = list%area(:n)
      points%stiffness(first:last) = list%stiffness(:n)
    end associate
  end subroutine copy_list

  !> Points on slave segments: reduce their areas to what is opposed to the master, and drop those
  !> without; in axisymmetry let them weigh with the radius where they stand.
  pure subroutine finish_segment_points(positions, is_axisymmetric, first, points)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    logical, intent(in) :: is_axisymmetric
    integer, intent(in) :: first                     !! of these points
    type(contact_points_t), intent(inout) :: points
    real(wp) :: along(4), across, square
    integer :: p, n

    !GCC$ NOVECTOR
    do p = first, points%n
      associate (a => points%slave_nodes(1, p), b => points%slave_nodes(2, p), &
        normal => points%normal(:, p), area => points%area(p))
        along = positions(:, b) - positions(:, a)
        across = (along(2) + along(4))*normal(1) - (along(1) + along(3))*normal(2)
        square = (along(1) + along(3))**2 + (along(2) + along(4))**2
        if (across > 0.0_wp .or. across*across < face_on**2*square) &
          area = area*opposed_share(across/sqrt(square))
        if (is_axisymmetric) area = area*radius_between(positions(:, a), positions(:, b), &
          points%slave_weights(2, p))
      end associate
    end do
    if (all(points%area(first:points%n) > 0.0_wp)) return
    n = first - 1
    do p = first, points%n
      if (.not. points%area(p) > 0.0_wp) cycle
      n = n + 1
      if (n < p) call move_point(p, n, points)
    end do
    points%n = n
  end subroutine finish_segment_points

end module point_list_m
