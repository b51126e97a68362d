! SPDX-License-Identifier: MIT
!> Tangents of points under pressures and tractions from gaps and slips averaged at slave nodes
!> (types 6 and 7; doc/theory/contact.md, sections 9.5 and 9.8): the points under the present
!> nodal values, and for each slave node in contact and each average a product of the force that
!> a unit of that makes and its gradient.
module nodal_tangent_m
  use assembly_m, only : add_linearised_point, product_t, start_product, add_gradient, &
    add_point_force, finish_product
  use tie_handover_m, only : is_held_by_tie
  use contact_law_m, only : linearise_pressure
  use contact_state_m, only : contact_state_t, n_side
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, variable, operator(-), operator(+), operator(*)
  use interference_m, only : ramp_gaps
  use kinds_m, only : wp
  use linearisation_m, only : linearised_list_t, linearised_point_t, slip_of, between
  use point_tangent_m, only : linearise_friction
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: add_nodal_tangents, nodal_share

  !> What is averaged.
  integer, parameter :: of_gap = 1, of_slip = 2

contains

  !> Add the tangent of all points. Those of a slave segment follow each other.
  pure subroutine add_nodal_tangents(contact, memory, list, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(in) :: list
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: values(list%n, 2)
    type(dual_t), dimension(memory%n_slave) :: pressures, tractions
    real(wp) :: means(2, memory%n_slave), areas(memory%n_slave)
    integer :: p

    do p = 1, list%n
      values(p, of_gap) = list%points(p)%gap + list%points(p)%remaining
      values(p, of_slip) = constant(0.0_wp)
      if (memory%has%friction) values(p, of_slip) = slip_of(memory, list%points(p))
    end do
    call average(list, values, means, areas)
    call form_nodal_pressures(contact, memory, means, areas, pressures, tractions)
    do p = 1, list%n
      associate (point => list%points(p), a => list%points(p)%nodes(1), &
        b => list%points(p)%nodes(2))
        if (.not. max(pressures(a)%value, pressures(b)%value) > 0.0_wp) cycle
        call add_linearised_point(point, &
          point%area*between([pressures(a)%value, pressures(b)%value], point%slave_xi), &
          point%area*between([tractions(a)%value, tractions(b)%value], point%slave_xi), &
          equations, matrix)
      end associate
    end do
    call add_averages(contact, list, values, means, areas, pressures, tractions, equations, matrix)
  end subroutine add_nodal_tangents

  !> Means of gaps and slips at the slave nodes, and what these weigh there.
  pure subroutine average(list, values, means, areas)
    type(linearised_list_t), intent(in) :: list
    type(dual_t), intent(in) :: values(:, :) !! (list%n, 2) m
    real(wp), intent(out) :: means(:, :)     !! (2, n_slave) m; 0 where there is no point
    real(wp), intent(out) :: areas(:)        !! (n_slave) m
    type(dual_t) :: share
    integer :: p, k

    means = 0.0_wp
    areas = 0.0_wp
    do p = 1, list%n
      do k = 1, n_side
        share = nodal_share(list%points(p), k)
        associate (node => list%points(p)%nodes(k))
          means(:, node) = means(:, node) + share%value*values(p, :)%value
          areas(node) = areas(node) + share%value
        end associate
      end do
    end do
    means = means/spread(max(areas, tiny(1.0_wp)), 1, 2)
  end subroutine average

  !> Pressures and tractions of the slave nodes, variable 1 the mean gap, 2 the mean slip; without
  !> slopes where nothing acts.
  pure subroutine form_nodal_pressures(contact, memory, means, areas, pressures, tractions)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: means(:, :), areas(:)
    type(dual_t), intent(out) :: pressures(:), tractions(:) !! (n_slave) N/m^2
    real(wp) :: gaps(memory%n_slave)
    integer :: i

    gaps = means(of_gap, :)
    if (memory%has%interference) call ramp_gaps(memory, gaps)
    pressures = constant(0.0_wp)
    tractions = constant(0.0_wp)
    do i = 1, memory%n_slave
      if (.not. (gaps(i) < memory%closed_gap .and. areas(i) > 0.0_wp)) cycle
      if (is_held_by_tie(memory, i)) cycle
      pressures(i) = linearise_pressure(memory%contact_law, memory%slave_penalty, &
        variable(gaps(i), of_gap))
      if (memory%has%friction) tractions(i) = linearise_friction(contact%friction, memory, &
        constant(memory%scratch%previous_traction(i)), variable(means(of_slip, i), of_slip), &
        pressures(i), memory%slave_penalty, memory%scratch%previous_state(i), constant(1.0_wp))
    end do
  end subroutine form_nodal_pressures

  !> Add what the means of all slave nodes change, by the points on both segments of each.
  pure subroutine add_averages(contact, list, values, means, areas, pressures, tractions, &
      equations, matrix)
    type(contact_t), intent(in) :: contact
    type(linearised_list_t), intent(in) :: list
    type(dual_t), intent(in) :: values(:, :)
    real(wp), intent(in) :: means(:, :), areas(:)
    type(dual_t), intent(in) :: pressures(:), tractions(:)
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(product_t) :: product
    type(dual_t) :: share, change
    integer, dimension(contact%slave%n_segment) :: first, last
    integer :: segments(2), i, k, p, q

    first = 1
    last = 0
    do p = list%n, 1, -1
      associate (s => contact%slave%outgoing(list%points(p)%nodes(1)))
        first(s) = p
        if (last(s) == 0) last(s) = p
      end associate
    end do
    call start_product(product, size(equations, 2))
    do i = 1, size(areas)
      segments = [contact%slave%outgoing(i), contact%slave%incoming(i)]
      do q = of_gap, of_slip
        if (.not. max(abs(pressures(i)%slope(q)), abs(tractions(i)%slope(q))) > 0.0_wp) cycle
        do k = 1, 2
          if (segments(k) == 0) cycle
          do p = first(segments(k)), last(segments(k))
            share = nodal_share(list%points(p), k)
            change = share*(values(p, q) + (-means(q, i)))
            call add_gradient(product, list%points(p), change%slope)
            call add_point_force(product, list%points(p), pressures(i)%slope(q)*share%value, &
              tractions(i)%slope(q)*share%value)
          end do
        end do
        call finish_product(product, -1.0_wp/areas(i), equations, matrix)
      end do
    end do
  end subroutine add_averages

  !> N_A a at a point, for its k-th slave node.
  pure function nodal_share(point, k) result(share)
    type(linearised_point_t), intent(in) :: point
    integer, intent(in) :: k
    type(dual_t) :: share

    share = point%slave_xi*point%area
    if (k == 1) share = point%area - share
  end function nodal_share

end module nodal_tangent_m
