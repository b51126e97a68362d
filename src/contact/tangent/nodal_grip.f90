! SPDX-License-Identifier: MIT
!> What friction adds to the tangent where slips are averaged at slave nodes as gaps are (types 6
!> and 7; doc/theory/contact.md, section 9.8): the points under their present nodal tractions, and
!> for each loaded slave node one product of the force of unit traction and the gradient of the
!> traction.
module nodal_grip_m
  use behind_ties_m, only : is_left_to_tie
  use assembly_m, only : add_varied_point, pattern_t, start_pattern, add_to_row, add_to_column, &
    add_product
  use contact_law_m, only : vary_pressure
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, variable, operator(-), operator(+), operator(*)
  use friction_tangent_m, only : vary_slip, largest_grip, state_before
  use kinds_m, only : wp
  use law_friction_m, only : vary_traction
  use nodal_tangent_m, only : varied_list_t, average, nodal_share, eased_moment
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: add_nodal_grip

  !> A slave node.
  type :: grip_t
    real(wp) :: gap      !! averaged, m
    real(wp) :: slip     !! averaged, m
    real(wp) :: area     !! m
    type(dual_t) :: traction !! variable 1 is the averaged gap, 2 the averaged slip
  end type grip_t

contains

  !> Add the tangent of the tractions of all points.
  pure subroutine add_nodal_grip(contact, memory, list, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(varied_list_t), intent(in) :: list
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(pattern_t) :: pattern
    type(dual_t) :: slips(list%n), shear
    type(grip_t) :: grips(memory%n_slave)
    real(wp) :: at_points(2, list%n)
    integer :: p, node

    do p = 1, list%n
      slips(p) = vary_slip(memory, list%points(p), 3, list%points(p)%master_xi)
      at_points(1, p) = list%points(p)%gap%value + list%points(p)%left%value
      at_points(2, p) = slips(p)%value
    end do
    call grip_nodes(contact, memory, list, at_points, grips)
    do p = 1, list%n
      associate (point => list%points(p), a => grips(list%points(p)%nodes(1))%traction%value, &
        b => grips(list%points(p)%nodes(2))%traction%value)
        shear = ((b - a)*point%slave_xi + a)*point%area
        if (max(abs(a), abs(b)) > 0.0_wp) &
          call add_varied_point(point, constant(0.0_wp), equations, matrix, shear)
      end associate
    end do
    call start_pattern(pattern, size(equations, 2))
    do node = 1, memory%n_slave
      if (.not. any(abs(grips(node)%traction%slope) > 0.0_wp)) cycle
      call fill_pattern(contact, list, slips, node, grips(node), pattern)
      call add_product(pattern, -1.0_wp/grips(node)%area, equations, matrix)
    end do
  end subroutine add_nodal_grip

  !> Tractions of all slave nodes, without slope where a node is not in contact.
  pure subroutine grip_nodes(contact, memory, list, at_points, grips)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(varied_list_t), intent(in) :: list
    real(wp), intent(in) :: at_points(:, :) !! (2, list%n) gap and slip, m
    type(grip_t), intent(out) :: grips(:) !! (n_slave)
    real(wp), dimension(memory%n_slave) :: gaps, eased, moments, areas
    integer :: node

    call average(memory, list, at_points(1, :), gaps, areas)
    eased = eased_moment(memory, gaps, areas)
    call average(memory, list, at_points(2, :), moments, areas)
    do node = 1, memory%n_slave
      associate (grip => grips(node))
        grip%traction = constant(0.0_wp)
        if (.not. eased(node) < memory%closed_gap*areas(node)) cycle
        if (is_left_to_tie(memory, node)) cycle
        grip%area = areas(node)
        grip%gap = gaps(node)/areas(node)
        grip%slip = moments(node)/areas(node)
        grip%traction = vary_traction(contact%friction, &
          constant(memory%scratch%former_traction(node)), variable(grip%slip, 2), &
          vary_pressure(memory%contact_law, memory%slave_penalty, &
          variable(eased(node)/areas(node), 1)), &
          contact%friction%stiffness*memory%slave_penalty, largest_grip(contact%friction), &
          [memory%scratch%dt, memory%scratch%lag], state_before(memory, node))
      end associate
    end do
  end subroutine grip_nodes

  !> For one slave node: the force of all points under unit traction of the node as column, and as
  !> row its area times the gradient of the traction.
  pure subroutine fill_pattern(contact, list, slips, node, grip, pattern)
    type(contact_t), intent(in) :: contact
    type(varied_list_t), intent(in) :: list
    type(dual_t), intent(in) :: slips(:) !! (list%n)
    integer, intent(in) :: node
    type(grip_t), intent(in) :: grip
    type(pattern_t), intent(inout) :: pattern
    type(dual_t) :: share, change
    integer :: segments(2), k, p

    segments = [contact%slave%outgoing(node), contact%slave%incoming(node)]
    do k = 1, 2
      if (segments(k) == 0) cycle
      do p = list%first(segments(k)), list%last(segments(k))
        associate (point => list%points(p), slope => grip%traction%slope)
          share = nodal_share(point, k)
          change = share*(slope(1)*(point%gap + point%left + (-grip%gap)) &
            + slope(2)*(slips(p) + (-grip%slip)))
          call add_to_row(pattern, point, change%slope)
          call add_to_column(pattern, point, 0.0_wp, share%value)
        end associate
      end do
    end do
  end subroutine fill_pattern

end module nodal_grip_m
