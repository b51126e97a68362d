! SPDX-License-Identifier: MIT
!> From varied points to the tangent of an interface, K = -dF/du (doc/theory/contact.md, section 9).
module assembly_m
  use behind_ties_m, only : is_left_to_tie
  use variation_m, only : varied_point_t, n_slot
  use contact_law_m, only : vary_pressure
  use contact_state_m, only : contact_state_t
  use contacts_m, only : friction_rule_t
  use dual_m, only : dual_t, constant, n_partial, operator(+), operator(-), operator(*)
  use entry_offset_m, only : has_offsets
  use friction_tangent_m, only : vary_grip
  use kinds_m, only : wp
  use sparse_m, only : sparse_t, add_block
  implicit none
  private
  public :: add_varied_point, add_pressed_point, pattern_t, start_pattern, use_node, &
    add_to_row, add_to_column, add_product

  !> Scratch for a product of two vectors over the nodes of an interface of which few entries are
  !> not zero.
  type :: pattern_t
    integer :: n = 0                       !! nodes in use
    integer, allocatable :: nodes(:)       !! (n_node) the first n: local numbers
    logical, allocatable :: is_used(:)     !! (n_node)
    real(wp), allocatable :: column(:, :)  !! (2, n_node) force
    real(wp), allocatable :: row(:, :)     !! (2, n_node) gradient
  end type pattern_t

contains

  !> Weights of slots 1 to 4 in the force, master side with minus.
  pure function point_weights(point) result(weights)
    type(varied_point_t), intent(in) :: point
    type(dual_t) :: weights(4)

    weights = [1.0_wp - point%slave_xi, point%slave_xi, point%master_xi, -point%master_xi]
    weights(3)%value = weights(3)%value - 1.0_wp
  end function point_weights

  !> Add a point with the force load*normal - shear*tangent; the load is pressure times area, the
  !> shear traction times area, the tangent (-n_y, n_x).
  pure subroutine add_varied_point(point, load, equations, matrix, shear)
    type(varied_point_t), intent(in) :: point
    type(dual_t), intent(in) :: load
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(dual_t), intent(in), optional :: shear !! absent: none
    type(dual_t) :: weights(4), pull(2), force
    real(wp) :: block(8, n_partial)
    integer :: numbers(n_partial), rows(8), k, j

    numbers = 0
    do k = 1, n_slot
      if (point%nodes(k) > 0) numbers(2*k - 1:2*k) = equations(:, point%nodes(k))
    end do
    rows = numbers(:8)
    weights = point_weights(point)
    pull = load*point%normal
    if (present(shear)) pull = pull + [shear*point%normal(2), -(shear*point%normal(1))]
    do k = 1, 4
      if (.not. (abs(weights(k)%value) > 0.0_wp .or. any(abs(weights(k)%slope) > 0.0_wp))) &
        rows(2*k - 1:2*k) = 0
      do j = 1, 2
        force = weights(k)*pull(j)
        block(2*k - 2 + j, :) = -force%slope
      end do
    end do
    call add_block(matrix, rows, numbers, block)
  end subroutine add_varied_point

  !> Add a point that is pressed by its own gap, with friction by its own slip.
  pure subroutine add_pressed_point(rule, memory, place, point, stiffness, equations, matrix, &
      length)
    type(friction_rule_t), intent(in) :: rule
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: place !! of its traction, a local node
    type(varied_point_t), intent(in) :: point
    real(wp), intent(in) :: stiffness
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(dual_t), intent(in), optional :: length !! competence length where the area is 1, m
    type(dual_t) :: pressure, gap

    if (is_left_to_tie(memory, place)) return
    gap = point%gap
    if (memory%has%interference) gap = gap + vary_left(memory, place, point)
    if (has_offsets(memory)) gap = gap + vary_offset(memory, place, point)
    if (.not. gap%value < memory%closed_gap) return
    pressure = vary_pressure(memory%contact_law, stiffness, gap)
    if (memory%has%friction) then
      call add_varied_point(point, pressure*point%area, equations, matrix, &
        vary_grip(rule, memory, place, point, pressure, stiffness, length)*point%area)
    else
      call add_varied_point(point, pressure*point%area, equations, matrix)
    end if
  end subroutine add_pressed_point

  !> The part of a place's initial overlap that does not act yet. A master node that was no place
  !> at time zero goes by the ends of its slave segment.
  pure function vary_left(memory, place, point) result(left)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: place
    type(varied_point_t), intent(in) :: point
    type(dual_t) :: left
    real(wp) :: ends(2)

    associate (interference => memory%interference)
      left = constant(interference%left*max(0.0_wp, interference%depth(place)))
      if (interference%depth(place) >= 0.0_wp .or. point%nodes(2) == 0) return
      ends = interference%left*max(0.0_wp, interference%depth(point%nodes(:2)))
      left = (ends(2) - ends(1))*point%slave_xi
      left = left + ends(1)
    end associate
  end function vary_left

  !> Entry offset of a point at a node; a master node of type 5 goes by the ends of its slave
  !> segment.
  pure function vary_offset(memory, place, point) result(offset)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: place
    type(varied_point_t), intent(in) :: point
    type(dual_t) :: offset
    real(wp) :: ends(2)

    if (place <= memory%n_slave) then
      offset = constant(memory%slave_tracking%offset(place))
    else if (memory%master_tracking%n > 0) then
      offset = constant(memory%master_tracking%offset(place - memory%n_slave))
    else
      ends = memory%slave_tracking%offset(point%nodes(:2))
      offset = (ends(2) - ends(1))*point%slave_xi
      offset = offset + ends(1)
    end if
  end function vary_offset

  !> Scratch for an interface of n nodes.
  pure subroutine start_pattern(pattern, n)
    type(pattern_t), intent(out) :: pattern
    integer, intent(in) :: n

    allocate (pattern%nodes(n), source=0)
    allocate (pattern%is_used(n), source=.false.)
    allocate (pattern%column(2, n), pattern%row(2, n), source=0.0_wp)
  end subroutine start_pattern

  !> Add the derivative of something to the row.
  pure subroutine add_to_row(pattern, point, slope)
    type(pattern_t), intent(inout) :: pattern
    type(varied_point_t), intent(in) :: point !! whose slots the derivative is for
    real(wp), intent(in) :: slope(n_partial)
    integer :: k, node

    do k = 1, n_slot
      node = point%nodes(k)
      if (node == 0) cycle
      call use_node(pattern, node)
      pattern%row(:, node) = pattern%row(:, node) + slope(2*k - 1:2*k)
    end do
  end subroutine add_to_row

  !> Add the force of a point under the given load and shear to the column.
  pure subroutine add_to_column(pattern, point, load, shear)
    type(pattern_t), intent(inout) :: pattern
    type(varied_point_t), intent(in) :: point
    real(wp), intent(in) :: load, shear
    type(dual_t) :: weights(4)
    integer :: k, node

    weights = point_weights(point)
    do k = 1, 4
      node = point%nodes(k)
      if (node == 0) cycle
      call use_node(pattern, node)
      pattern%column(:, node) = pattern%column(:, node) &
        + load*weights(k)%value*point%normal%value
      if (abs(shear) > 0.0_wp) pattern%column(:, node) = pattern%column(:, node) &
        + shear*weights(k)%value*[point%normal(2)%value, -point%normal(1)%value]
    end do
  end subroutine add_to_column

  !> Note that a node takes part.
  pure subroutine use_node(pattern, node)
    type(pattern_t), intent(inout) :: pattern
    integer, intent(in) :: node

    if (pattern%is_used(node)) return
    pattern%is_used(node) = .true.
    pattern%n = pattern%n + 1
    pattern%nodes(pattern%n) = node
  end subroutine use_node

  !> Add factor*column*row to the matrix and empty the scratch.
  pure subroutine add_product(pattern, factor, equations, matrix)
    type(pattern_t), intent(inout) :: pattern
    real(wp), intent(in) :: factor
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    real(wp) :: block(2*pattern%n, 2)
    integer :: rows(2*pattern%n), i, j

    do i = 1, pattern%n
      associate (node => pattern%nodes(i))
        rows(2*i - 1:2*i) = equations(:, node)
        if (.not. any(abs(pattern%column(:, node)) > 0.0_wp)) rows(2*i - 1:2*i) = 0
      end associate
    end do
    do i = 1, pattern%n
      associate (row => pattern%row(:, pattern%nodes(i)))
        do j = 1, pattern%n
          block(2*j - 1:2*j, 1) = factor*row(1)*pattern%column(:, pattern%nodes(j))
          block(2*j - 1:2*j, 2) = factor*row(2)*pattern%column(:, pattern%nodes(j))
        end do
      end associate
      call add_block(matrix, rows, equations(:, pattern%nodes(i)), block)
    end do
    pattern%is_used(pattern%nodes(:pattern%n)) = .false.
    pattern%column(:, pattern%nodes(:pattern%n)) = 0.0_wp
    pattern%row(:, pattern%nodes(:pattern%n)) = 0.0_wp
    pattern%n = 0
  end subroutine add_product

end module assembly_m
