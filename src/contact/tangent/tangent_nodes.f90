! SPDX-License-Identifier: MIT
!> Linearised points of types 1 to 3, which are nodes of one surface over segments of the other, and
!> the tangent of type 4: virtual nodes loaded by their own gaps, whose forces go to sub-segments of
!> the master (doc/theory/contact.md, sections 9.2 and 9.3).
module tangent_nodes_m
  use assembly_m, only : load_point, add_linearised_point, product_t, start_product, add_change, &
    finish_product
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*), operator(/)
  use kinds_m, only : wp
  use projection_m, only : slave_side, round_off
  use linearisation_m, only : linearised_point_t, linearised_list_t, linearised_projection_t, &
    append_point, project, project_point, way_from, difference, length_between, cosine_between, &
    share_of, side_share_of, radius_at, centroid_of
  use points_vts_ppt_m, only : end_of_half, ends_of_half, polyline_parameter_t
  use sparse_m, only : sparse_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: linearise_nodes, linearise_node, linearise_length, add_vts_ppt_tangent

contains

  !> Types 1 to 3: all points. The area of type 1 is 1, in axisymmetry the mean radius of the
  !> tributary length, which a largest traction counts times; that of types 2 and 3 is the tributary
  !> length.
  pure subroutine linearise_nodes(contact, has_unit_area, memory, list)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: has_unit_area !! type 1
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(inout) :: list
    type(linearised_point_t) :: point, plane
    integer :: p

    do p = 1, memory%points%n
      point = linearise_node(contact, memory, p)
      associate (is_closed => memory%slave_status%pass%is_closed, &
        is_axisymmetric => contact%is_axisymmetric)
        if (point%site > memory%n_slave) then
          call linearise_length(contact%master, memory%n_slave, is_axisymmetric, &
            memory%master_status%pass%is_closed, memory%positions, point)
        else if (is_axisymmetric .or. .not. has_unit_area) then
          call linearise_length(contact%slave, 0, is_axisymmetric, is_closed, memory%positions, &
            point)
        end if
        plane = point
        if (has_unit_area .and. is_axisymmetric) then
          call linearise_length(contact%slave, 0, .false., is_closed, memory%positions, plane)
          point%area = point%area/plane%area
        end if
        if (has_unit_area .and. contact%friction%most > 0.0_wp) then
          call linearise_length(contact%slave, 0, .false., .false., memory%positions, plane)
          point%nodes = plane%nodes
          point%length = plane%area
        end if
      end associate
      call append_point(list, point)
    end do
  end subroutine linearise_nodes

  !> The p-th point of the list, which stands at a node, with an area of 1.
  pure function linearise_node(contact, memory, p) result(point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    type(linearised_point_t) :: point

    associate (points => memory%points)
      point%site = points%slave_nodes(1, p)
      point%nodes(1) = point%site
      point%nodes(3:4) = points%master_nodes(:, p)
      point%stiffness = points%stiffness(p)
      point%slave_xi = constant(0.0_wp)
      point%area = constant(1.0_wp)
      call project_point(contact, memory, points%master_weights(2, p), points%gap(p), &
        points%normal(:, p), point)
    end associate
  end function linearise_node

  !> Let the area of a point at a node be the node's tributary length, the neighbours of which go
  !> into slots 5 and 6; on a closed boundary its segments count as far as they are opposed to the
  !> face.
  pure subroutine linearise_length(surface, offset, by_radius, is_closed, positions, point)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: offset !! local number before the first node of the surface
    logical, intent(in) :: by_radius, is_closed
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(linearised_point_t), intent(inout) :: point
    type(dual_t) :: half_lengths(2), shares(2), parts(2), cosines(2), t(2, 2), turn
    integer :: segments(2), k

    segments = [surface%incoming(point%nodes(1) - offset), &
      surface%outgoing(point%nodes(1) - offset)]
    half_lengths = constant(0.0_wp)
    do k = 1, 2
      if (segments(k) == 0) cycle
      point%nodes(4 + k) = offset + surface%segments(k, segments(k))
      half_lengths(k) = 0.5_wp*length_between(positions, point, 1, 4 + k)
      if (by_radius) half_lengths(k) = half_lengths(k)*radius_at(positions, point, 1, 4 + k, &
        constant(1.0_wp/3.0_wp))
    end do
    point%area = half_lengths(1) + half_lengths(2)
    if (.not. is_closed .or. any(segments == 0)) return
    do k = 1, 2
      t(:, k) = difference(positions, point, merge(1, 6, k == 1), merge(5, 1, k == 1))
      cosines(k) = cosine_between(t(:, k), [-point%normal(2), point%normal(1)])
      shares(k) = share_of(cosines(k))
    end do
    parts = constant(1.0_wp)
    if (t(1, 1)%value*t(2, 2)%value - t(2, 1)%value*t(1, 2)%value > 0.0_wp) then
      turn = cosine_between(t(:, 1), t(:, 2))
      parts = [side_share_of(turn, cosines(1) - cosines(2), slave_side), &
        side_share_of(turn, cosines(2) - cosines(1), slave_side)]
    end if
    point%area = half_lengths(1)*shares(1)*parts(1) + half_lengths(2)*shares(2)*parts(2)
    if (maxval(shares%value) >= 1.0_wp) return
    if (dot_product(t(:, 1)%value, point%normal%value) < 0.0_wp .and. &
      dot_product(t(:, 2)%value, point%normal%value) > 0.0_wp) &
      point%area = point%area + 0.5_wp*(1.0_wp - shares(maxloc(shares%value, 1)))*(parts(1) &
      + parts(2))*(half_lengths(1) + half_lengths(2))
  end subroutine linearise_length

  !> Type 4: all virtual nodes in contact. Their sub-segments follow each other on the list.
  pure subroutine add_vts_ppt_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(product_t) :: product
    type(linearised_point_t) :: point
    type(linearised_list_t) :: sub_segments
    type(dual_t) :: pressure, traction
    logical :: acts
    integer :: k, p

    call start_product(product, size(equations, 2))
    p = 1
    do k = 1, memory%slave_status%n_active
      associate (virtual_node => memory%slave_status%active_points(k))
        point = linearise_virtual_node(contact, memory, virtual_node)
        call linearise_sub_segments(contact, memory, virtual_node, p, point, sub_segments)
      end associate
      p = p + sub_segments%n
      call load_point(contact, memory, point, acts, pressure, traction)
      if (acts) call add_sub_segments(sub_segments, pressure*point%area, traction*point%area, &
        product, equations, matrix)
    end do
  end subroutine add_vts_ppt_tangent

  !> A virtual node over its master segment; its area is half of the slave segment.
  pure function linearise_virtual_node(contact, memory, virtual_node) result(point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: virtual_node
    type(linearised_point_t) :: point

    associate (status => memory%slave_status, &
      at => memory%segment_points%xi(2 - mod(virtual_node, 2)))
      point%site = virtual_node
      point%nodes(1:2) = contact%slave%segments(:, (virtual_node + 1)/2)
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, status%segment(virtual_node))
      point%stiffness = memory%slave_penalty
      point%slave_xi = constant(at)
      point%area = 0.5_wp*length_between(memory%positions, point, 1, 2)
      if (contact%is_axisymmetric) then
        point%area = point%area*radius_at(memory%positions, point, 1, 2, point%slave_xi)
        point%slave_xi = centroid_of(memory%positions, point, 1, 2, &
          constant([end_of_half(at, 2), end_of_half(at, 1)]))
      end if
      call project_point(contact, memory, status%xi(virtual_node), status%gap(virtual_node), &
        status%normal(:, virtual_node), point)
    end associate
  end function linearise_virtual_node

  !> Its sub-segments, as they are generated: the master side of each in slots 5, 6, its own length
  !> there as area. Without any all goes to the virtual node's own projection.
  pure subroutine linearise_sub_segments(contact, memory, virtual_node, p, point, sub_segments)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: virtual_node
    integer, intent(in) :: p !! the first of them on the list of points
    type(linearised_point_t), intent(in) :: point
    type(linearised_list_t), intent(inout) :: sub_segments
    type(linearised_point_t) :: sub_segment
    type(polyline_parameter_t) :: limits(2)
    type(dual_t) :: range(2)
    integer :: segment, k, i

    sub_segments%n = 0
    associate (at => memory%segment_points%xi(2 - mod(virtual_node, 2)))
      limits = ends_of_half(contact, memory, virtual_node, at)
      sub_segment = point
      sub_segment%master_slot = 5
      segment = limits(1)%segment
      do k = limits(1)%n_step, limits(2)%n_step
        sub_segment%nodes(5:6) = memory%n_slave + contact%master%segments(:, segment)
        range = constant([0.0_wp, 1.0_wp])
        do i = 1, 2
          if (k == limits(i)%n_step) range(i) = linearise_parameter(memory%positions, sub_segment, &
            end_of_half(at, i), limits(i))
        end do
        if (range(2)%value - range(1)%value > round_off) then
          call set_range(contact, memory, range, p + sub_segments%n, sub_segment)
          call append_point(sub_segments, sub_segment)
        end if
        segment = contact%master%next(segment)
        if (segment == 0) exit
      end do
    end associate
    if (sub_segments%n > 0) return
    sub_segment = point
    sub_segment%area = length_between(memory%positions, point, 3, 4)
    call append_point(sub_segments, sub_segment)
  end subroutine linearise_sub_segments

  !> The end of a half on the segment in slots 5, 6; constant where it has been stopped at a node.
  pure function linearise_parameter(positions, sub_segment, slave_xi, eta) result(xi)
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    type(linearised_point_t), intent(in) :: sub_segment
    real(wp), intent(in) :: slave_xi !! where the half ends on its segment
    type(polyline_parameter_t), intent(in) :: eta
    type(dual_t) :: xi
    type(linearised_point_t) :: site
    type(linearised_projection_t) :: projection

    site = sub_segment
    site%slave_xi = constant(slave_xi)
    projection = project(way_from(positions, site, 5), difference(positions, site, 6, 5))
    xi = projection%xi
    if (.not. eta%xi < 0.0_wp .and. xi%value < -round_off) xi = constant(0.0_wp)
    if (.not. eta%xi > 1.0_wp .and. xi%value > 1.0_wp + round_off) xi = constant(1.0_wp)
  end function linearise_parameter

  !> Let a sub-segment be this range of the segment in slots 5, 6.
  pure subroutine set_range(contact, memory, range, p, sub_segment)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(dual_t), intent(in) :: range(2)
    integer, intent(in) :: p !! its number on the list of points
    type(linearised_point_t), intent(inout) :: sub_segment

    sub_segment%master_xi = 0.5_wp*(range(1) + range(2))
    associate (positions => memory%positions)
      sub_segment%area = (range(2) - range(1))*length_between(positions, sub_segment, 5, 6)
      if (contact%is_axisymmetric) then
        sub_segment%area = sub_segment%area &
          *radius_at(positions, sub_segment, 5, 6, sub_segment%master_xi)
        sub_segment%master_xi = centroid_of(positions, sub_segment, 5, 6, range)
      end if
      if (memory%has%arcs) then
        sub_segment%master_xi = sub_segment%master_xi &
          + sub_segment%shift/length_between(positions, sub_segment, 5, 6)
        ! Where it is on the list, which the resultant of all of them decides.
        sub_segment%master_xi%value = memory%points%master_weights(2, p)
      end if
    end associate
  end subroutine set_range

  !> Share out the force of a virtual node by the sub-segments' lengths: each share at a constant
  !> sum of these, and the change of the sum as one product of two vectors.
  pure subroutine add_sub_segments(sub_segments, load, shear, product, equations, matrix)
    type(linearised_list_t), intent(in) :: sub_segments
    type(dual_t), intent(in) :: load, shear !! of the virtual node, N/m
    type(product_t), intent(inout) :: product
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: share
    real(wp) :: total
    integer :: k

    if (sub_segments%n == 1) then
      call add_linearised_point(sub_segments%points(1), load, shear, equations, matrix)
      return
    end if
    total = sum(sub_segments%points(:sub_segments%n)%area%value)
    do k = 1, sub_segments%n
      associate (sub_segment => sub_segments%points(k))
        share = (1.0_wp/total)*sub_segment%area
        call add_linearised_point(sub_segment, share*load, share*shear, equations, matrix)
        call add_change(product, sub_segment, share%value*load%value, share%value*shear%value, &
          share%slope)
      end associate
    end do
    call finish_product(product, 1.0_wp, equations, matrix)
  end subroutine add_sub_segments

end module tangent_nodes_m
