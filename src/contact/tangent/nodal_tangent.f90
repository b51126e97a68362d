! SPDX-License-Identifier: MIT
!> Tangent where pressure comes from averaged gaps of slave nodes (types 6 and 7;
!> doc/theory/contact.md, section 9.5): the points under their present nodal pressures, and for each
!> loaded slave node one product of the force of unit pressure and the gradient of the pressure.
module nodal_tangent_m
  use assembly_m, only : add_varied_point, pattern_t, start_pattern, add_to_row, &
    add_to_column, add_product
  use behind_ties_m, only : is_left_to_tie
  use contact_law_m, only : vary_pressure
  use contact_state_m, only : contact_state_t, n_side
  use variation_m, only : varied_point_t
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, operator(-), operator(+), operator(*)
  use kinds_m, only : wp
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: varied_list_t, start_list, append_point, add_nodal_tangent, average, nodal_share, &
    eased_moment

  !> Points segment by segment.
  type :: varied_list_t
    integer :: n = 0
    type(varied_point_t), allocatable :: points(:) !! (capacity)
    integer, allocatable :: first(:) !! (n_segment) of the points on each slave segment
    integer, allocatable :: last(:)  !! (n_segment) less than the first where there are none
  end type varied_list_t

contains

  !> An empty list; it grows as needed.
  pure subroutine start_list(list, n_segment, capacity)
    type(varied_list_t), intent(out) :: list
    integer, intent(in) :: n_segment !! of the slave surface
    integer, intent(in) :: capacity

    allocate (list%points(max(1, capacity)))
    allocate (list%first(n_segment), source=1)
    allocate (list%last(n_segment), source=0)
  end subroutine start_list

  !> Append a point. All points of a segment come one after the other.
  pure subroutine append_point(list, segment, point)
    type(varied_list_t), intent(inout) :: list
    integer, intent(in) :: segment !! of the slave surface
    type(varied_point_t), intent(in) :: point
    type(varied_point_t), allocatable :: longer(:)

    if (list%n == size(list%points)) then
      allocate (longer(2*list%n))
      longer(:list%n) = list%points
      call move_alloc(longer, list%points)
    end if
    list%n = list%n + 1
    list%points(list%n) = point
    if (list%last(segment) == 0) list%first(segment) = list%n
    list%last(segment) = list%n
  end subroutine append_point

  !> Add the tangent of all points.
  pure subroutine add_nodal_tangent(contact, memory, list, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(varied_list_t), intent(in) :: list
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(pattern_t) :: pattern
    type(dual_t) :: load
    type(dual_t) :: gap, pressed
    real(wp), dimension(memory%n_slave) :: moment, content, eased, pressure, stiffness
    real(wp) :: gaps(list%n)
    integer :: p, node

    do p = 1, list%n
      gaps(p) = list%points(p)%gap%value + list%points(p)%left%value
    end do
    call average(memory, list, gaps, moment, content)
    eased = eased_moment(memory, moment, content)
    pressure = 0.0_wp
    gap%slope = 0.0_wp
    gap%slope(1) = 1.0_wp
    do node = 1, memory%n_slave
      gap%value = eased(node)/max(content(node), tiny(1.0_wp))
      pressed = vary_pressure(memory%contact_law, memory%slave_penalty, gap)
      if (eased(node) < 0.0_wp .and. .not. is_left_to_tie(memory, node)) &
        pressure(node) = pressed%value
      stiffness(node) = -pressed%slope(1)
    end do
    do p = 1, list%n
      associate (point => list%points(p))
        load = ((pressure(point%nodes(2)) - pressure(point%nodes(1)))*point%slave_xi &
          + pressure(point%nodes(1)))*point%area
        if (any(pressure(point%nodes(:2)) > 0.0_wp)) &
          call add_varied_point(point, load, equations, matrix)
      end associate
    end do
    call start_pattern(pattern, size(equations, 2))
    do node = 1, memory%n_slave
      if (.not. eased(node) < memory%closed_gap*content(node)) cycle
      if (is_left_to_tie(memory, node)) cycle
      call fill_pattern(contact, list, node, moment(node)/content(node), pattern)
      call add_product(pattern, stiffness(node)/content(node), equations, matrix)
    end do
  end subroutine add_nodal_tangent

  !> Sums of N_A a g as the springs feel it, where initial overlaps grow.
  pure function eased_moment(memory, moment, content) result(eased)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: moment(:), content(:) !! (n_slave) of N_A a g, and of N_A a
    real(wp) :: eased(size(moment))

    eased = moment
    if (memory%has%interference) eased = moment + memory%interference%left &
      *memory%interference%depth(:size(moment))*content
  end function eased_moment

  !> Sums of N_A a g and N_A a of all slave nodes, g a value of points.
  pure subroutine average(memory, list, values, moment, content)
    type(contact_state_t), intent(in) :: memory
    type(varied_list_t), intent(in) :: list
    real(wp), intent(in) :: values(:) !! (list%n)
    real(wp), intent(out) :: moment(memory%n_slave)
    real(wp), intent(out) :: content(memory%n_slave)
    type(dual_t) :: share
    integer :: p, k

    moment = 0.0_wp
    content = 0.0_wp
    do p = 1, list%n
      do k = 1, n_side
        associate (point => list%points(p), node => list%points(p)%nodes(k))
          share = nodal_share(point, k)
          moment(node) = moment(node) + share%value*values(p)
          content(node) = content(node) + share%value
        end associate
      end do
    end do
  end subroutine average

  !> N_A a at a point, for its k-th slave node.
  pure function nodal_share(point, k) result(share)
    type(varied_point_t), intent(in) :: point
    integer, intent(in) :: k
    type(dual_t) :: share

    share = point%slave_xi*point%area
    if (k == 1) share = point%area - share
  end function nodal_share

  !> For one slave node: the force of all points under unit pressure of the node as column, and as
  !> row content times the gradient of the averaged gap.
  pure subroutine fill_pattern(contact, list, node, gap, pattern)
    type(contact_t), intent(in) :: contact
    type(varied_list_t), intent(in) :: list
    integer, intent(in) :: node
    real(wp), intent(in) :: gap !! averaged, m
    type(pattern_t), intent(inout) :: pattern
    type(dual_t) :: share, change
    integer :: segments(2), k, p

    segments = [contact%slave%outgoing(node), contact%slave%incoming(node)]
    do k = 1, 2
      if (segments(k) == 0) cycle
      do p = list%first(segments(k)), list%last(segments(k))
        associate (point => list%points(p))
          share = nodal_share(point, k)
          change = share*(point%gap + point%left + (-gap))
          call add_to_row(pattern, point, change%slope)
          call add_to_column(pattern, point, share%value, 0.0_wp)
        end associate
      end do
    end do
  end subroutine fill_pattern

end module nodal_tangent_m
