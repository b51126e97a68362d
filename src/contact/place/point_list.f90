! SPDX-License-Identifier: MIT
!> The list of contact points and its only writer: points on slave segments one by one, points at
!> the active nodes of a surface all together.
module point_list_m
  use contact_state_m, only : contact_points_t, tracking_t, make_room, n_side
  use foot_m, only : foot_t, facing_share, face_on
  use geometry_m, only : separation
  use kinds_m, only : wp
  use radii_m, only : radius_between
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: add_point, append_touching, add_length, finish_segment_points

contains

  !> Append a point on a slave segment, or at an end of it.
  pure subroutine add_point(points, ends, xi, nodes, foot, area, stiffness)
    type(contact_points_t), intent(inout) :: points
    integer, intent(in) :: ends(2)    !! nodes of the slave segment
    real(wp), intent(in) :: xi        !! place on that, 0 to 1
    integer, intent(in) :: nodes(2)   !! of the master segment, local numbers
    type(foot_t), intent(in) :: foot  !! place on that, gap and normal
    real(wp), intent(in) :: area      !! m
    real(wp), intent(in) :: stiffness !! N/m^2
    integer :: p

    p = points%n + 1
    if (p > size(points%gap)) call make_room(points, 1)
    points%slave_nodes(:, p) = ends
    points%slave_weights(:, p) = [1.0_wp - xi, xi]
    points%master_nodes(:, p) = nodes
    points%master_weights(:, p) = [1.0_wp - foot%xi, foot%xi]
    points%normal(:, p) = foot%normal
    points%gap(p) = foot%gap
    points%area(p) = area
    points%stiffness(p) = stiffness
    points%n = p
  end subroutine add_point

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

    associate (n => tracking%n_touching, p => points%n + 1)
      if (n == 0) return
      call make_room(points, n)
      call put_nodes(n, tracking%touching, tracking%segment, chain%segments, offsets, &
        points%slave_nodes(1, p), points%master_nodes(1, p))
      call put_feet(n, tracking%touching, tracking%xi, tracking%gap, tracking%normal, &
        points%master_weights(1, p), points%gap(p), points%normal(1, p))
      points%slave_weights(1, p:p + n - 1) = 1.0_wp
      points%slave_weights(2, p:p + n - 1) = 0.0_wp
      points%area(p:p + n - 1) = area
      points%stiffness(p:p + n - 1) = stiffness
    end associate
    points%n = points%n + tracking%n_touching
  end subroutine append_touching

  !> Give length to a point, if there is one.
  pure subroutine add_length(points, p, length)
    type(contact_points_t), intent(inout) :: points
    integer, intent(in) :: p       !! 0: none
    real(wp), intent(in) :: length !! m

    if (p > 0) points%area(p) = points%area(p) + length
  end subroutine add_length

  !> Points on slave segments: reduce their areas to what is opposed to the master, and drop those
  !> without; in axisymmetry let them weigh with the radius where they stand.
  pure subroutine finish_segment_points(places, is_round, first, points)
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of the interface
    logical, intent(in) :: is_round
    integer, intent(in) :: first                     !! of these points
    type(contact_points_t), intent(inout) :: points
    real(wp) :: t(2), across, square
    integer :: p, n

    n = first - 1
    do p = first, points%n
      if (.not. points%area(p) > 0.0_wp) cycle
      associate (nodes => points%slave_nodes(:, p), normal => points%normal(:, p))
        t = separation(places(:, nodes(2)), places(:, nodes(1)))
        across = t(2)*normal(1) - t(1)*normal(2)
        square = t(1)*t(1) + t(2)*t(2)
        if (across > 0.0_wp .or. across*across < face_on**2*square) &
          points%area(p) = points%area(p)*facing_share(across/sqrt(square))
        if (is_round) points%area(p) = points%area(p)*radius_between(places(:, nodes(1)), &
          places(:, nodes(2)), points%slave_weights(2, p))
      end associate
      if (.not. points%area(p) > 0.0_wp) cycle
      n = n + 1
      if (n < p) call move_point(p, n, points)
    end do
    points%n = n
  end subroutine finish_segment_points

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

  !> Tracked nodes, and the nodes of the segments that they are in contact with.
  pure subroutine put_nodes(n, touching, segment, segments, offsets, slave_nodes, master_nodes)
    integer, intent(in) :: n, touching(n), segment(*), segments(n_side, *), offsets(2)
    integer, intent(inout) :: slave_nodes(n_side, n), master_nodes(n_side, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      slave_nodes(:, k) = offsets(1) + touching(k)
      master_nodes(:, k) = offsets(2) + segments(:, segment(touching(k)))
    end do
  end subroutine put_nodes

  !> Projections of tracked nodes.
  pure subroutine put_feet(n, touching, xi, gap, normal, weights, point_gap, point_normal)
    integer, intent(in) :: n, touching(n)
    real(wp), intent(in) :: xi(*), gap(*), normal(2, *)
    real(wp), intent(inout) :: weights(n_side, n), point_gap(n), point_normal(2, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      weights(1, k) = 1.0_wp - xi(touching(k))
      weights(2, k) = xi(touching(k))
      point_gap(k) = gap(touching(k))
      point_normal(:, k) = normal(:, touching(k))
    end do
  end subroutine put_feet

end module point_list_m
