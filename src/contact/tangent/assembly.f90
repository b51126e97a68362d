! SPDX-License-Identifier: MIT
!> From linearised points to the tangent of an interface, K = -dF/du
!> (doc/theory/contact.md, section 9).
module assembly_m
  use dual_m, only : dual_t, n_partial, operator(+), operator(-), operator(*)
  use kinds_m, only : wp
  use linearisation_m, only : linearised_point_t, n_slot
  use sparse_m, only : sparse_t, add_block
  implicit none
  private
  public :: add_linearised_point, product_t, start_product, add_to_row, add_to_column, &
    add_gradient, add_point_force, finish_product

  !> A product of two vectors over the nodes of an interface of which few entries are not zero.
  type :: product_t
    integer :: n = 0                      !! nodes in use
    integer, allocatable :: nodes(:)      !! (n_node) the first n: local numbers
    logical, allocatable :: is_used(:)    !! (n_node)
    real(wp), allocatable :: column(:, :) !! (2, n_node) force
    real(wp), allocatable :: row(:, :)    !! (2, n_node) gradient
  end type product_t

contains

  !> Forces of a point on slots 1, 2 and its master side: load*normal - shear*tangent on the slave
  !> side; the load is pressure times area, the shear traction times area, the tangent (-n_y, n_x).
  pure function forces_of(point, load, shear) result(forces)
    type(linearised_point_t), intent(in) :: point
    type(dual_t), intent(in) :: load, shear
    type(dual_t) :: forces(2, 4)
    type(dual_t) :: pull(2), to_last(2)

    pull = load*point%normal
    if (abs(shear%value) > 0.0_wp .or. any(abs(shear%slope) > 0.0_wp)) &
      pull = pull + [shear*point%normal(2), -(shear*point%normal(1))]
    to_last = point%slave_xi*pull
    forces(:, 2) = to_last
    forces(:, 1) = pull - to_last
    to_last = point%master_xi*pull
    forces(:, 4) = -to_last
    forces(:, 3) = to_last - pull
  end function forces_of

  !> Add a point under its load and shear.
  pure subroutine add_linearised_point(point, load, shear, equations, matrix)
    type(linearised_point_t), intent(in) :: point
    type(dual_t), intent(in) :: load, shear            !! N/m
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: forces(2, 4)
    real(wp) :: block(8, n_partial)
    integer :: numbers(n_partial), rows(8), k

    numbers = 0
    do k = 1, n_slot
      if (point%nodes(k) > 0) numbers(2*k - 1:2*k) = equations(:, point%nodes(k))
    end do
    associate (i => 2*point%master_slot)
      rows = [numbers(1:4), numbers(i - 1:i + 2)]
    end associate
    forces = forces_of(point, load, shear)
    do k = 1, 4
      block(2*k - 1, :) = -forces(1, k)%slope
      block(2*k, :) = -forces(2, k)%slope
      if (.not. any(abs(block(2*k - 1:2*k, :)) > 0.0_wp)) rows(2*k - 1:2*k) = 0
    end do
    call add_block(matrix, rows, numbers, block)
  end subroutine add_linearised_point

  !> An empty product for an interface of n nodes.
  pure subroutine start_product(product, n)
    type(product_t), intent(out) :: product
    integer, intent(in) :: n

    allocate (product%nodes(n), product%column(2, n), product%row(2, n))
    allocate (product%is_used(n), source=.false.)
  end subroutine start_product

  !> Add a vector at a node to the gradient.
  pure subroutine add_to_row(product, node, vector)
    type(product_t), intent(inout) :: product
    integer, intent(in) :: node
    real(wp), intent(in) :: vector(2)

    call use_node(product, node)
    product%row(:, node) = product%row(:, node) + vector
  end subroutine add_to_row

  !> Add a force at a node.
  pure subroutine add_to_column(product, node, vector)
    type(product_t), intent(inout) :: product
    integer, intent(in) :: node
    real(wp), intent(in) :: vector(2)

    call use_node(product, node)
    product%column(:, node) = product%column(:, node) + vector
  end subroutine add_to_column

  !> Add derivatives by the slots of a point to the gradient.
  pure subroutine add_gradient(product, point, slope)
    type(product_t), intent(inout) :: product
    type(linearised_point_t), intent(in) :: point
    real(wp), intent(in) :: slope(n_partial)
    integer :: k

    do k = 1, n_slot
      if (point%nodes(k) > 0) call add_to_row(product, point%nodes(k), slope(2*k - 1:2*k))
    end do
  end subroutine add_gradient

  !> Add the forces of a point under a load and a shear without derivatives.
  pure subroutine add_point_force(product, point, load, shear)
    type(product_t), intent(inout) :: product
    type(linearised_point_t), intent(in) :: point
    real(wp), intent(in) :: load, shear !! N/m
    real(wp) :: pull(2), weights(4)
    integer :: nodes(4), k

    pull = load*point%normal%value &
      + shear*[point%normal(2)%value, -point%normal(1)%value]
    associate (slave => point%slave_xi%value, master => point%master_xi%value)
      weights = [1.0_wp - slave, slave, master - 1.0_wp, -master]
    end associate
    nodes = point%nodes([1, 2, point%master_slot, point%master_slot + 1])
    do k = 1, 4
      if (nodes(k) > 0) call add_to_column(product, nodes(k), weights(k)*pull)
    end do
  end subroutine add_point_force

  !> Note that a node takes part.
  pure subroutine use_node(product, node)
    type(product_t), intent(inout) :: product
    integer, intent(in) :: node

    if (product%is_used(node)) return
    product%is_used(node) = .true.
    product%n = product%n + 1
    product%nodes(product%n) = node
    product%column(:, node) = 0.0_wp
    product%row(:, node) = 0.0_wp
  end subroutine use_node

  !> Add factor*column*row to the matrix and empty the product.
  pure subroutine finish_product(product, factor, equations, matrix)
    type(product_t), intent(inout) :: product
    real(wp), intent(in) :: factor
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    real(wp) :: column(2*product%n), block(2*product%n, 2)
    integer :: rows(2*product%n), k

    associate (nodes => product%nodes(:product%n))
      column = factor*reshape(product%column(:, nodes), [2*product%n])
      rows = reshape(equations(:, nodes), [2*product%n])
      do k = 1, product%n
        if (.not. any(abs(column(2*k - 1:2*k)) > 0.0_wp)) rows(2*k - 1:2*k) = 0
      end do
      do k = 1, product%n
        block(:, 1) = product%row(1, nodes(k))*column
        block(:, 2) = product%row(2, nodes(k))*column
        call add_block(matrix, rows, equations(:, nodes(k)), block)
      end do
      product%is_used(nodes) = .false.
    end associate
    product%n = 0
  end subroutine finish_product

end module assembly_m
