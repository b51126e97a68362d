! SPDX-License-Identifier: MIT
!> Tangent of type 4: virtual nodes pressed by their own gaps, whose forces go to portions of the
!> master (doc/theory/contact.md, section 9.3).
module tangent_vts_ppt_m
  use assembly_m, only : add_varied_point, product_t, start_product, add_gradient, &
    add_point_force, finish_product
  use contact_state_m, only : contact_state_t, place_at
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*)
  use foot_m, only : mark_t, walk_to_mark, round_off
  use kinds_m, only : wp
  use linearisation_m, only : varied_point_t, varied_list_t, varied_projection_t, append_point, &
    apart, length_between, project, way_from, project_point, radius_at, centroid_of
  use place_vts_ppt_m, only : end_of_half
  use point_tangent_m, only : press_point, parts_left
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: add_vts_ppt_tangent

contains

  !> All virtual nodes in contact. Their portions follow each other on the list.
  pure subroutine add_vts_ppt_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(product_t) :: product
    type(varied_point_t) :: point
    type(varied_list_t) :: portions
    type(dual_t) :: pressure, traction
    real(wp) :: left(memory%points%n)
    logical :: acts
    integer :: k, p

    left = parts_left(memory)
    call start_product(product, size(equations, 2))
    p = 1
    do k = 1, memory%slave_tracking%n_touching
      associate (spot => memory%slave_tracking%touching(k))
        point = vary_virtual_node(contact, memory, spot)
        point%place = place_at(memory, p)
        point%left = constant(left(p))
        call vary_portions(contact, memory, spot, point, portions)
      end associate
      p = p + portions%n
      call press_point(contact%friction, memory, point, acts, pressure, traction)
      if (acts) call add_portions(portions, pressure*point%area, traction*point%area, product, &
        equations, matrix)
    end do
  end subroutine add_vts_ppt_tangent

  !> A virtual node over its master segment; its area is half of the slave segment.
  pure function vary_virtual_node(contact, memory, spot) result(point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    type(varied_point_t) :: point

    associate (tracking => memory%slave_tracking, at => memory%spot_xi(2 - mod(spot, 2)), &
      places => memory%places)
      point%nodes(1:2) = contact%slave%segments(:, (spot + 1)/2)
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, tracking%segment(spot))
      point%stiffness = memory%slave_penalty
      point%slave_xi = constant(at)
      point%area = 0.5_wp*length_between(places, point%nodes, 1, 2)
      if (contact%is_round) then
        point%area = point%area*radius_at(places, point%nodes, 1, 2, point%slave_xi)
        point%slave_xi = centroid_of(places, point%nodes, 1, 2, constant(end_of_half(at, 2)), &
          constant(end_of_half(at, 1)))
      end if
      call project_point(memory, tracking%xi(spot), tracking%gap(spot), point)
    end associate
  end function vary_virtual_node

  !> Its portions, as the placement finds them: the master side of each in slots 5, 6, its own
  !> length there as area. Without any all goes to the virtual node's own projection.
  pure subroutine vary_portions(contact, memory, spot, point, portions)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: spot
    type(varied_point_t), intent(in) :: point
    type(varied_list_t), intent(inout) :: portions
    type(varied_point_t) :: portion
    type(mark_t) :: marks(2)
    type(dual_t) :: range(2)
    real(wp) :: xi(2)
    integer :: segment, k

    portions%n = 0
    do k = 1, 2
      xi(k) = end_of_half(memory%spot_xi(2 - mod(spot, 2)), k)
      marks(k) = walk_to_mark(contact%master, memory%places(:, memory%n_slave + 1:), &
        (1.0_wp - xi(k))*memory%places(:, point%nodes(1)) &
        + xi(k)*memory%places(:, point%nodes(2)), memory%slave_tracking%segment(spot))
    end do
    portion = point
    portion%master_slot = 5
    segment = marks(1)%segment
    do k = marks(1)%n_step, marks(2)%n_step
      portion%nodes(5:6) = memory%n_slave + contact%master%segments(:, segment)
      range = constant([0.0_wp, 1.0_wp])
      if (k == marks(1)%n_step) range(1) = vary_mark(memory, portion, xi(1), marks(1))
      if (k == marks(2)%n_step) range(2) = vary_mark(memory, portion, xi(2), marks(2))
      segment = contact%master%next(segment)
      if (range(2)%value - range(1)%value > round_off) then
        call set_range(contact, memory, range, portion)
        call append_point(portions, portion)
      end if
      if (segment == 0) exit
    end do
    if (portions%n > 0) return
    portion = point
    portion%area = length_between(memory%places, point%nodes, 3, 4)
    call append_point(portions, portion)
  end subroutine vary_portions

  !> The end of a half on the segment in slots 5, 6; constant where it has been stopped at a node.
  pure function vary_mark(memory, portion, slave_xi, mark) result(xi)
    type(contact_state_t), intent(in) :: memory
    type(varied_point_t), intent(in) :: portion
    real(wp), intent(in) :: slave_xi !! where the half ends on its segment
    type(mark_t), intent(in) :: mark
    type(dual_t) :: xi
    type(varied_point_t) :: place
    type(varied_projection_t) :: projection

    place = portion
    place%slave_xi = constant(slave_xi)
    projection = project(way_from(memory%places, place, 5), &
      apart(memory%places, place%nodes, 6, 5))
    xi = projection%xi
    if (.not. mark%xi < 0.0_wp .and. xi%value < -round_off) xi = constant(0.0_wp)
    if (.not. mark%xi > 1.0_wp .and. xi%value > 1.0_wp + round_off) xi = constant(1.0_wp)
  end function vary_mark

  !> Let a portion be this range of the segment in slots 5, 6.
  pure subroutine set_range(contact, memory, range, portion)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(dual_t), intent(in) :: range(2)
    type(varied_point_t), intent(inout) :: portion

    associate (nodes => portion%nodes)
      portion%master_xi = 0.5_wp*(range(1) + range(2))
      portion%area = (range(2) - range(1))*length_between(memory%places, nodes, 5, 6)
      if (.not. contact%is_round) return
      portion%area = portion%area*radius_at(memory%places, nodes, 5, 6, portion%master_xi)
      portion%master_xi = centroid_of(memory%places, nodes, 5, 6, range(1), range(2))
    end associate
  end subroutine set_range

  !> Share out the force of a virtual node by the portions' lengths: each share at a constant sum
  !> of these, and the change of the sum as one product of two vectors.
  pure subroutine add_portions(portions, load, shear, product, equations, matrix)
    type(varied_list_t), intent(in) :: portions
    type(dual_t), intent(in) :: load, shear !! of the virtual node, N/m
    type(product_t), intent(inout) :: product
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: share
    real(wp) :: total
    integer :: k

    if (portions%n == 1) then
      call add_varied_point(portions%points(1), load, shear, equations, matrix)
      return
    end if
    total = sum(portions%points(:portions%n)%area%value)
    do k = 1, portions%n
      associate (portion => portions%points(k))
        share = (1.0_wp/total)*portion%area
        call add_varied_point(portion, share*load, share*shear, equations, matrix)
        call add_gradient(product, portion, share%slope)
        call add_point_force(product, portion, share%value*load%value, share%value*shear%value)
      end associate
    end do
    call finish_product(product, 1.0_wp, equations, matrix)
  end subroutine add_portions

end module tangent_vts_ppt_m
