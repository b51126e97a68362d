! SPDX-License-Identifier: MIT
!> What the placements share: points at tracked nodes, points on slave segments.
module contact_placing_m
  use contact_projection_m, only : foot_t
  use contact_state_m, only : contact_points_t, tracking_t, n_side
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: add_touching_nodes, put_stiffness, forget_other_stiffness, add_segment_point, &
    add_plain_point, tracked_foot, place_on_segment

  !> Nodes placed together.
  integer, parameter :: n_room = 64

contains

  !> Append a point for each tracked node in contact; area and stiffness are left to the
  !> formulation. The tracked node stands on the slave side of the record, whichever surface it
  !> belongs to. Where the points stand already (`is_known`) that side is not written again; nor is
  !> the other one if the search has brought it up to date.
  pure subroutine add_touching_nodes(tracking, chain_surface, spot_offset, chain_offset, points, &
      is_known)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: chain_surface
    integer, intent(in) :: spot_offset, chain_offset !! local number before the first node of each
    type(contact_points_t), intent(inout) :: points
    logical, intent(out) :: is_known

    is_known = tracking%first_point == points%n + 1
    tracking%first_point = points%n + 1
    if (.not. is_known) call put_spots(tracking%n_touching, tracking%touching, spot_offset, points)
    if (tracking%has_feet) call put_blocks(tracking, chain_surface, chain_offset, points)
    points%n = points%n + tracking%n_touching
  end subroutine add_touching_nodes

  !> Master side of these points.
  pure subroutine put_blocks(tracking, chain_surface, chain_offset, points)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: chain_surface
    integer, intent(in) :: chain_offset
    type(contact_points_t), intent(inout) :: points
    integer :: first, i, n, p

    do first = 1, tracking%n_touching, n_room
      n = min(n_room, tracking%n_touching - first + 1)
      p = points%n + first
      i = tracking%touching(first)
      call put_segments(n, tracking%touching(first), tracking%segment, chain_surface%segments, &
        chain_offset, points%master_nodes(1, p))
      if (tracking%touching(first + n - 1) == i + n - 1) then
        call put_run(n, tracking%xi(i), tracking%gap(i), tracking%normal(1, i), &
          points%master_weights(1, p), points%gap(p), points%normal(1, p))
      else
        call put_feet(n, tracking%touching(first), tracking%xi, tracking%gap, tracking%normal, &
          points%master_weights(1, p), points%gap(p), points%normal(1, p))
      end if
    end do
  end subroutine put_blocks

  !> Slave side of points at tracked nodes.
  pure subroutine put_spots(n, touching, offset, points)
    integer, intent(in) :: n, touching(n), offset
    type(contact_points_t), intent(inout) :: points
    integer :: k, p

    do k = 1, n
      p = points%n + k
      points%slave_nodes(1, p) = offset + touching(k)
      points%slave_nodes(2, p) = offset + touching(k)
      points%slave_weights(1, p) = 1.0_wp
      points%slave_weights(2, p) = 0.0_wp
    end do
  end subroutine put_spots

  !> Nodes of their master segments.
  pure subroutine put_segments(n, touching, segment, segments, offset, nodes)
    integer, intent(in) :: n, touching(n), segment(*), segments(2, *), offset
    integer, intent(inout) :: nodes(n_side, n)
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      nodes(:, k) = offset + segments(:, segment(touching(k)))
    end do
  end subroutine put_segments

  !> Feet of tracked nodes that follow each other, in vectors: 3 % of the whole contact of type 1.
  pure subroutine put_run(n, xi, gap, normal, weights, gaps, normals)
    integer, intent(in) :: n
    real(wp), intent(in) :: xi(n), gap(n), normal(2, n)
    real(wp), intent(inout) :: weights(n_side, n), gaps(n), normals(2, n)
    integer :: k

    do k = 1, n
      weights(1, k) = 1.0_wp - xi(k)
      weights(2, k) = xi(k)
      gaps(k) = gap(k)
      normals(1, k) = normal(1, k)
      normals(2, k) = normal(2, k)
    end do
  end subroutine put_run

  !> The same for any tracked nodes.
  pure subroutine put_feet(n, touching, xi, gap, normal, weights, gaps, normals)
    integer, intent(in) :: n, touching(n)
    real(wp), intent(in) :: xi(*), gap(*), normal(2, *)
    real(wp), intent(inout) :: weights(n_side, n), gaps(n), normals(2, n)
    integer :: k, i

    !GCC$ NOVECTOR
    do k = 1, n
      i = touching(k)
      weights(1, k) = 1.0_wp - xi(i)
      weights(2, k) = xi(i)
      gaps(k) = gap(i)
      normals(1, k) = normal(1, i)
      normals(2, k) = normal(2, i)
    end do
  end subroutine put_feet

  !> Stiffness of the points at slave nodes, one and the same: not written again where it is theirs.
  pure subroutine put_stiffness(stiffness, is_known, points)
    real(wp), intent(in) :: stiffness
    logical, intent(in) :: is_known !! they stand where they stood at the last placement
    type(contact_points_t), intent(inout) :: points

    if (points%n == 0) return
    if (is_known .and. .not. abs(points%stiffness(1) - stiffness) > 0.0_wp) return
    points%stiffness(:points%n) = stiffness
  end subroutine put_stiffness

  !> Points stand as the placement before left them only as long as the stiffness, which all have in
  !> common, is the same.
  pure subroutine forget_other_stiffness(stiffness, points)
    real(wp), intent(in) :: stiffness
    type(contact_points_t), intent(inout) :: points

    if (abs(points%stiffness(1) - stiffness) > 0.0_wp) points%n_former = 0
  end subroutine forget_other_stiffness

  !> Append a point between the nodes of a slave segment; area and stiffness are left to the
  !> formulation.
  pure subroutine add_segment_point(master, n_slave, ends, xi, foot, points)
    type(surface_t), intent(in) :: master
    integer, intent(in) :: n_slave    !! local number before the first master node
    integer, intent(in) :: ends(2)    !! nodes of the slave segment
    real(wp), intent(in) :: xi        !! place on it, 0 to 1
    type(foot_t), intent(in) :: foot  !! segment, xi, gap and normal on the master
    type(contact_points_t), intent(inout) :: points

    points%n = points%n + 1
    associate (p => points%n)
      points%slave_nodes(1, p) = ends(1)
      points%slave_nodes(2, p) = ends(2)
      points%slave_weights(1, p) = 1.0_wp - xi
      points%slave_weights(2, p) = xi
      points%master_nodes(1, p) = n_slave + master%segments(1, foot%segment)
      points%master_nodes(2, p) = n_slave + master%segments(2, foot%segment)
      points%master_weights(1, p) = 1.0_wp - foot%xi
      points%master_weights(2, p) = foot%xi
      points%normal(1, p) = foot%normal(1)
      points%normal(2, p) = foot%normal(2)
      points%gap(p) = foot%gap
    end associate
  end subroutine add_segment_point

  !> The same for a foot of which each part is known.
  pure subroutine add_plain_point(ends, xi, nodes, foot, normal, gap, points)
    integer, intent(in) :: ends(2), nodes(2) !! local numbers of slave and master nodes
    real(wp), intent(in) :: xi, foot         !! place on the slave and on the master segment
    real(wp), intent(in) :: normal(2)
    real(wp), intent(in) :: gap              !! m
    type(contact_points_t), intent(inout) :: points
    integer :: p

    p = points%n + 1
    points%n = p
    points%slave_nodes(1, p) = ends(1)
    points%slave_nodes(2, p) = ends(2)
    points%slave_weights(1, p) = 1.0_wp - xi
    points%slave_weights(2, p) = xi
    points%master_nodes(1, p) = nodes(1)
    points%master_nodes(2, p) = nodes(2)
    points%master_weights(1, p) = 1.0_wp - foot
    points%master_weights(2, p) = foot
    points%normal(1, p) = normal(1)
    points%normal(2, p) = normal(2)
    points%gap(p) = gap
  end subroutine add_plain_point

  !> Foot of a spot in contact as the tracking knows it.
  pure function tracked_foot(tracking, i) result(foot)
    type(tracking_t), intent(in) :: tracking
    integer, intent(in) :: i !! spot
    type(foot_t) :: foot

    foot%segment = tracking%segment(i)
    foot%is_on = .true.
    foot%xi = tracking%xi(i)
    foot%gap = tracking%gap(i)
    foot%normal = tracking%normal(:, i)
  end function tracked_foot

  !> Place at `xi` between two nodes.
  pure function place_on_segment(places, ends, xi) result(place)
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n)
    integer, intent(in) :: ends(2)
    real(wp), intent(in) :: xi
    real(wp) :: place(4)

    place = (1.0_wp - xi)*places(:, ends(1)) + xi*places(:, ends(2))
  end function place_on_segment

end module contact_placing_m
