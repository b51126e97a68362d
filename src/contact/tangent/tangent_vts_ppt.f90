! SPDX-License-Identifier: MIT
!> Tangent of type 4: virtual nodes loaded by their own gaps, whose forces go to sub-segments of the
!> master (doc/theory/contact.md, section 9.3).
module tangent_vts_ppt_m
  use assembly_m, only : load_point, add_linearised_point, product_t, start_product, add_change, &
    finish_product
  use contact_state_m, only : contact_state_t, site_at
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*)
  use projection_m, only : round_off
  use kinds_m, only : wp
  use linearisation_m, only : linearised_point_t, linearised_list_t, linearised_projection_t, &
    append_point, difference, length_between, project, way_from, project_point, radius_at, &
    centroid_of
  use points_vts_ppt_m, only : end_of_half, ends_of_half, polyline_parameter_t
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: add_vts_ppt_tangent

contains

  !> All virtual nodes in contact. Their sub-segments follow each other on the list.
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
        point%site = site_at(memory, memory%points, p)
        call linearise_sub_segments(contact, memory, virtual_node, point, sub_segments)
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

    associate (status => memory%slave_status, at => memory%segment_xi(2 - mod(virtual_node, 2)))
      point%nodes(1:2) = contact%slave%segments(:, (virtual_node + 1)/2)
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, status%segment(virtual_node))
      point%stiffness = memory%slave_penalty
      point%slave_xi = constant(at)
      point%area = 0.5_wp*length_between(memory, point, 1, 2)
      if (contact%is_round) then
        point%area = point%area*radius_at(memory, point, 1, 2, point%slave_xi)
        point%slave_xi = centroid_of(memory, point, 1, 2, &
          constant([end_of_half(at, 2), end_of_half(at, 1)]))
      end if
      call project_point(memory, status%xi(virtual_node), status%gap(virtual_node), point)
    end associate
  end function linearise_virtual_node

  !> Its sub-segments, as they are generated: the master side of each in slots 5, 6, its own length
  !> there as area. Without any all goes to the virtual node's own projection.
  pure subroutine linearise_sub_segments(contact, memory, virtual_node, point, sub_segments)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: virtual_node
    type(linearised_point_t), intent(in) :: point
    type(linearised_list_t), intent(inout) :: sub_segments
    type(linearised_point_t) :: sub_segment
    type(polyline_parameter_t) :: limits(2)
    type(dual_t) :: range(2)
    integer :: segment, k, i

    sub_segments%n = 0
    associate (at => memory%segment_xi(2 - mod(virtual_node, 2)))
      limits = ends_of_half(contact, memory, virtual_node, at)
      sub_segment = point
      sub_segment%master_slot = 5
      segment = limits(1)%segment
      do k = limits(1)%n_step, limits(2)%n_step
        sub_segment%nodes(5:6) = memory%n_slave + contact%master%segments(:, segment)
        range = constant([0.0_wp, 1.0_wp])
        do i = 1, 2
          if (k == limits(i)%n_step) range(i) = linearise_parameter(memory, sub_segment, &
            end_of_half(at, i), limits(i))
        end do
        if (range(2)%value - range(1)%value > round_off) then
          call set_range(contact, memory, range, sub_segment)
          call append_point(sub_segments, sub_segment)
        end if
        segment = contact%master%next(segment)
        if (segment == 0) exit
      end do
    end associate
    if (sub_segments%n > 0) return
    sub_segment = point
    sub_segment%area = length_between(memory, point, 3, 4)
    call append_point(sub_segments, sub_segment)
  end subroutine linearise_sub_segments

  !> The end of a half on the segment in slots 5, 6; constant where it has been stopped at a node.
  pure function linearise_parameter(memory, sub_segment, slave_xi, eta) result(xi)
    type(contact_state_t), intent(in) :: memory
    type(linearised_point_t), intent(in) :: sub_segment
    real(wp), intent(in) :: slave_xi !! where the half ends on its segment
    type(polyline_parameter_t), intent(in) :: eta
    type(dual_t) :: xi
    type(linearised_point_t) :: site
    type(linearised_projection_t) :: projection

    site = sub_segment
    site%slave_xi = constant(slave_xi)
    projection = project(way_from(memory, site, 5), difference(memory, site, 6, 5))
    xi = projection%xi
    if (.not. eta%xi < 0.0_wp .and. xi%value < -round_off) xi = constant(0.0_wp)
    if (.not. eta%xi > 1.0_wp .and. xi%value > 1.0_wp + round_off) xi = constant(1.0_wp)
  end function linearise_parameter

  !> Let a sub-segment be this range of the segment in slots 5, 6.
  pure subroutine set_range(contact, memory, range, sub_segment)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(dual_t), intent(in) :: range(2)
    type(linearised_point_t), intent(inout) :: sub_segment

    sub_segment%master_xi = 0.5_wp*(range(1) + range(2))
    sub_segment%area = (range(2) - range(1))*length_between(memory, sub_segment, 5, 6)
    if (.not. contact%is_round) return
    sub_segment%area = sub_segment%area*radius_at(memory, sub_segment, 5, 6, sub_segment%master_xi)
    sub_segment%master_xi = centroid_of(memory, sub_segment, 5, 6, range)
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

end module tangent_vts_ppt_m
