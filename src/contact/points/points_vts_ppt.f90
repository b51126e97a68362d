! SPDX-License-Identifier: MIT
!> Type 4, VTS-PPT (virtual-slave-node-to-segment): the gap of a virtual slave node in the middle of
!> each half of a slave segment, its force on the master shared by the sub-segments that the half
!> covers, at the centre of each (Zavarise & De Lorenzis 2009; doc/theory/contact.md, section 5.4).
!> All sub-segments have the gap and the normal of the virtual node, so P2 holds for directions only
!> in parallel: the net moment is not exactly zero on a kinked master.
module points_vts_ppt_m
  use contact_state_m, only : contact_state_t, contact_points_t
  use contacts_m, only : contact_t
  use projection_m, only : projection_t, local_coordinates, is_over_segment, turns_gently, round_off
  use geometry_m, only : local_coordinates_t, segment_length, separation
  use kinds_m, only : wp
  use point_list_m, only : add_point
  use surfaces_m, only : surface_t
  use tributary_lengths_m, only : centroid, radius_between
  implicit none
  private
  public :: points_vts_ppt, ends_of_half, end_of_half, polyline_parameter_t, project_along

  !> A position on a surface reached by walking.
  type :: polyline_parameter_t
    integer :: segment = 0
    integer :: n_step = 0    !! segments walked to it, negative backwards
    real(wp) :: xi = 0.0_wp
  end type polyline_parameter_t

contains

  !> Generate the points of a range of the virtual nodes in contact.
  pure subroutine points_vts_ppt(contact, memory, first, last, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: first, last
    type(contact_points_t), intent(inout) :: points
    integer :: k

    do k = first, last
      call add_sub_segments(contact, memory, memory%slave_status%active_points(k), points)
    end do
  end subroutine points_vts_ppt

  !> The sub-segments of a virtual node, from the master segment below the later end of its half to
  !> that below the earlier one; they share the half by their lengths, in axisymmetry by their
  !> areas.
  pure subroutine add_sub_segments(contact, memory, virtual_node, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: virtual_node
    type(contact_points_t), intent(inout) :: points
    type(polyline_parameter_t) :: limits(2)
    type(projection_t) :: projection
    real(wp) :: a(4), b(4), at, xi, half
    integer :: ends(2), segment, first, i

    ends = contact%slave%segments(:, (virtual_node + 1)/2)
    a = memory%positions(:, ends(1))
    b = memory%positions(:, ends(2))
    at = memory%segment_points%xi(2 - mod(virtual_node, 2))
    limits = ends_of_half(contact, memory, virtual_node, at)
    xi = at
    half = 0.5_wp*segment_length(a, b)
    if (contact%is_axisymmetric) then
      xi = centroid(a, b, end_of_half(at, 2), end_of_half(at, 1))
      half = half*radius_between(a, b, at)
    end if
    projection%gap = memory%slave_status%gap(virtual_node)
    projection%normal = memory%slave_status%normal(:, virtual_node)
    first = points%n + 1
    segment = limits(1)%segment
    do i = limits(1)%n_step, limits(2)%n_step
      call add_sub_segment(contact, ends, xi, segment, [merge(limits(1)%xi, 0.0_wp, &
        i == limits(1)%n_step), merge(limits(2)%xi, 1.0_wp, i == limits(2)%n_step)], projection, &
        memory, points)
      segment = contact%master%next(segment)
      ! Marks of displacements beyond all bounds need not lie on one surface.
      if (segment == 0) exit
    end do
    if (points%n < first) then
      projection%xi = memory%slave_status%xi(virtual_node)
      call add_point(points, ends, xi, memory%n_slave + contact%master%segments(:, &
        memory%slave_status%segment(virtual_node)), projection, half, memory%slave_penalty)
    else
      half = half/sum(points%area(first:points%n))
      do i = first, points%n
        points%area(i) = half*points%area(i)
      end do
    end if
  end subroutine add_sub_segments

  !> Where both ends of the half of a virtual node are on the master: on the segment below the
  !> virtual node, or where a walk from there leads.
  pure function ends_of_half(contact, memory, virtual_node, at) result(limits)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: virtual_node
    real(wp), intent(in) :: at !! where the virtual node is on its slave segment
    type(polyline_parameter_t) :: limits(2)
    type(local_coordinates_t) :: local
    real(wp) :: a(4), b(4), slope
    integer :: k

    associate (segment => memory%slave_status%segment(virtual_node), &
      polyline => memory%positions(:, memory%n_slave + 1:), &
      ends => contact%slave%segments(:, (virtual_node + 1)/2))
      a = memory%positions(:, ends(1))
      b = memory%positions(:, ends(2))
      local = local_coordinates(contact%master, polyline, (1.0_wp - at)*a + at*b, segment)
      slope = dot_product(separation(b, a), local%t)
      do k = 1, 2
        limits(k)%segment = segment
        limits(k)%xi = (local%along + (end_of_half(at, k) - at)*slope)/local%square
      end do
      if (all(abs(limits%xi - 0.5_wp) <= 0.5_wp)) return
      do k = 1, 2
        slope = end_of_half(at, k)
        limits(k) = project_along(contact%master, polyline, (1.0_wp - slope)*a + slope*b, segment)
      end do
    end associate
  end function ends_of_half

  !> Project a position on a surface, starting at a segment and going on to the neighbour where it
  !> runs over a node. It stops at the surface's end (with the usual overshoot), at a sharp corner,
  !> and at a node that no neighbour sees it beyond.
  pure function project_along(surface, polyline, position, start) result(eta)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: polyline(:, :) !! (4, n_node) positions
    real(wp), intent(in) :: position(4)
    integer, intent(in) :: start
    type(polyline_parameter_t) :: eta
    type(local_coordinates_t) :: local, other
    logical :: backwards
    integer :: neighbour, i_step

    eta%segment = start
    local = local_coordinates(surface, polyline, position, start)
    backwards = local%along < 0.0_wp
    do i_step = 1, surface%n_segment
      eta%xi = local%along/local%square
      if (local%along >= 0.0_wp .and. local%along <= local%square) return
      if (backwards .neqv. local%along < 0.0_wp) exit
      neighbour = merge(surface%previous(eta%segment), surface%next(eta%segment), backwards)
      if (neighbour == 0) then
        if (.not. is_over_segment(local)) exit
        return
      end if
      other = local_coordinates(surface, polyline, position, neighbour)
      if (.not. turns_gently(local%t, other%t)) then
        ! At a sharp convex vertex the face ends as at the end of an open surface.
        if (is_over_segment(local) .and. merge(-1.0_wp, 1.0_wp, backwards)*(local%t(1)*other%t(2) &
          - local%t(2)*other%t(1)) > 0.0_wp) return
        exit
      end if
      local = other
      eta%segment = neighbour
      eta%n_step = eta%n_step + merge(-1, 1, backwards)
    end do
    eta%xi = max(0.0_wp, min(1.0_wp, eta%xi))
  end function project_along

  !> Append a sub-segment of a half with its own length as area: it has the gap and the normal of
  !> the virtual node, and its position on the master is its centre, in axisymmetry by radius.
  pure subroutine add_sub_segment(contact, ends, xi, segment, range, projection, memory, points)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: ends(2)        !! nodes of the slave segment
    real(wp), intent(in) :: xi            !! position of the virtual node on that
    integer, intent(in) :: segment        !! of the master
    real(wp), intent(in) :: range(2)      !! of that
    type(projection_t), intent(inout) :: projection !! gap and normal
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points
    real(wp) :: length
    integer :: nodes(2)

    if (.not. range(2) - range(1) > round_off) return
    nodes = memory%n_slave + contact%master%segments(:, segment)
    associate (a => memory%positions(:, nodes(1)), b => memory%positions(:, nodes(2)))
      projection%xi = 0.5_wp*(range(1) + range(2))
      length = (range(2) - range(1))*segment_length(a, b)
      if (contact%is_axisymmetric) then
        length = length*radius_between(a, b, projection%xi)
        projection%xi = centroid(a, b, range(1), range(2))
      end if
    end associate
    call add_point(points, ends, xi, nodes, projection, length, memory%slave_penalty)
  end subroutine add_sub_segment

  !> Ends of a half segment, the later one first: the slave runs against the master.
  pure function end_of_half(xi, k)
    real(wp), intent(in) :: xi !! of the virtual node
    integer, intent(in) :: k
    real(wp) :: end_of_half

    end_of_half = xi + (1.5_wp - k)*0.5_wp
  end function end_of_half

end module points_vts_ppt_m
