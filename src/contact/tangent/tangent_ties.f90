! SPDX-License-Identifier: MIT
!> Tangent of ties: the second derivative of what their springs store (doc/theory/contact.md,
!> section 9.9). A spring is a function of its mean separation d and of the vector of its segment,
!> which are linear in the displacements of its nodes. With a = d.n - a0 and b = d.t - b0 its
!> stretches and theta the angle of the segment, grad a = n grad d + d.t grad theta and grad b = t
!> grad d - d.n grad theta.
module tangent_ties_m
  use assembly_m, only : product_t, start_product, add_at_node, finish_product
  use contact_state_m, only : contact_state_t, contact_points_t, n_side
  use dual_m, only : dual_t, variable, operator(+), operator(-), operator(*), operator(/), sqrt
  use kinds_m, only : wp
  use law_state_m, only : tie_memory_t, is_held
  use sparse_m, only : sparse_t, add_block
  use ties_m, only : tie_spring_t, tie_spring, has_state
  implicit none
  private
  public :: add_tie_tangent

contains

  !> Add the derivative of minus the forces of all springs.
  pure subroutine add_tie_tangent(memory, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    integer :: s

    do s = 1, size(memory%ties%side)
      call add_spring(memory, s, equations, matrix)
    end do
    if (memory%has%nodal_pressure) call add_averages(memory, equations, matrix)
  end subroutine add_tie_tangent

  !> One spring: k w (grad a grad a^T + grad b grad b^T), and the turn of its segment under its
  !> loads.
  pure subroutine add_spring(memory, s, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    real(wp) :: stretches(4, 2), block(4, 4), levers(2*size_of(memory%ties, s), 4)
    integer :: nodes(size_of(memory%ties, s)), rows(2*size_of(memory%ties, s))

    call linearise_spring(memory%ties, memory%tie_points, memory%positions, s, stretches, block)
    associate (points => memory%tie_points, first => memory%ties%first(s), &
      last => memory%ties%first(s + 1) - 1)
      if (.not. memory%has%nodal_pressure .and. has_state(memory, s, [is_held])) block = block &
        + sum(points%stiffness(first:last)*points%area(first:last)) &
        *matmul(stretches, transpose(stretches))
    end associate
    call find_levers(memory%ties, memory%tie_points, s, nodes, levers)
    rows = reshape(equations(:, nodes), [size(rows)])
    call add_block(matrix, rows, rows, matmul(matmul(levers, block), transpose(levers)))
  end subroutine add_spring

  !> Gradients of both stretches of a spring by d and the vector of its segment (x and y of either),
  !> and derivatives of its forces on these with the loads held: of fn grad a + fs grad b.
  pure subroutine linearise_spring(ties, points, positions, s, stretches, block)
    type(tie_memory_t), intent(in) :: ties
    type(contact_points_t), intent(in) :: points        !! of ties
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    integer, intent(in) :: s
    real(wp), intent(out) :: stretches(4, 2) !! along n and t
    real(wp), intent(out) :: block(4, 4)
    type(tie_spring_t) :: spring
    type(dual_t) :: d(2), way(2), n(2), t(2), turn(2), length, forces(4), gradients(4, 2)
    real(wp) :: fn, fs
    integer :: i

    spring = tie_spring(ties, points, positions, s)
    associate (first => ties%first(s), last => ties%first(s + 1) - 1, side => ties%side(s))
      fn = -sum(points%pressure(first:last)*points%area(first:last))
      fs = sum(points%traction(first:last)*points%area(first:last))
      d = variable(spring%d, [1, 2])
      way = variable(side*spring%length*spring%t, [3, 4])
      length = sqrt(way(1)*way(1) + way(2)*way(2))
      t = [side*way(1)/length, side*way(2)/length]
      n = [t(2), -t(1)]
      turn = [-side*n(1)/length, -side*n(2)/length]
    end associate
    gradients(:2, 1) = n
    gradients(3:, 1) = (d(1)*t(1) + d(2)*t(2))*turn
    gradients(:2, 2) = t
    gradients(3:, 2) = -(d(1)*n(1) + d(2)*n(2))*turn
    stretches = gradients%value
    forces = fn*gradients(:, 1) + fs*gradients(:, 2)
    do i = 1, 4
      block(i, :) = forces(i)%slope(:4)
    end do
  end subroutine linearise_spring

  !> Types 6 and 7, whose springs are points: the stretches averaged at the slave nodes.
  pure subroutine add_averages(memory, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(product_t) :: product
    ! n_side p - 2 + k, 0 at the end:
    integer :: head(memory%n_slave), next(n_side, memory%tie_points%n)
    integer :: i, j, k, p, at

    head = 0
    associate (points => memory%tie_points, areas => memory%ties%area)
      do p = points%n, 1, -1
        do k = n_side, 1, -1
          i = points%slave_nodes(k, p)
          next(k, p) = head(i)
          head(i) = n_side*(p - 1) + k
        end do
      end do
      call start_product(product, size(equations, 2))
      do i = 1, memory%n_slave
        if (memory%ties%state(i) /= is_held) cycle
        do j = 1, 2
          at = head(i)
          do while (at > 0)
            p = 1 + (at - 1)/n_side
            k = at - n_side*(p - 1)
            call add_stretch(memory, p, j, points%slave_weights(k, p)*points%area(p)/areas(i), &
              product)
            at = next(k, p)
          end do
          call finish_product(product, memory%slave_penalty*areas(i), equations, matrix)
        end do
      end do
    end associate
  end subroutine add_averages

  !> Add a part of the gradient of the i-th stretch of a spring to both sides of a product.
  pure subroutine add_stretch(memory, s, i, part, product)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, i
    real(wp), intent(in) :: part
    type(product_t), intent(inout) :: product
    real(wp) :: stretches(4, 2), block(4, 4), levers(2*size_of(memory%ties, s), 4)
    real(wp) :: gradient(2*size_of(memory%ties, s))
    integer :: nodes(size_of(memory%ties, s)), k

    if (.not. abs(part) > 0.0_wp) return
    call linearise_spring(memory%ties, memory%tie_points, memory%positions, s, stretches, block)
    call find_levers(memory%ties, memory%tie_points, s, nodes, levers)
    gradient = part*matmul(levers, stretches(:, i))
    do k = 1, size(nodes)
      associate (of_node => gradient(2*k - 1:2*k))
        call add_at_node(product, nodes(k), of_node, of_node)
      end associate
    end do
  end subroutine add_stretch

  !> Nodes of a spring, some of them more than once: of its points, and of its segment.
  pure function size_of(ties, s) result(n)
    type(tie_memory_t), intent(in) :: ties
    integer, intent(in) :: s
    integer :: n

    n = 2*n_side*(ties%first(s + 1) - ties%first(s)) + 2
  end function size_of

  !> These, local numbers, and by how much d and the vector of the segment move with them.
  pure subroutine find_levers(ties, points, s, nodes, levers)
    type(tie_memory_t), intent(in) :: ties
    type(contact_points_t), intent(in) :: points !! of ties
    integer, intent(in) :: s
    integer, intent(out) :: nodes(:)
    real(wp), intent(out) :: levers(:, :) !! (x and y of each node, x and y of either)
    real(wp) :: weights(size(nodes), 2)
    integer :: p, n, k

    weights = 0.0_wp
    n = 0
    associate (first => ties%first(s), last => ties%first(s + 1) - 1)
      do p = first, last
        nodes(n + 1:n + 2*n_side) = [points%slave_nodes(:, p), points%master_nodes(:, p)]
        weights(n + 1:n + 2*n_side, 1) = points%area(p)/sum(points%area(first:last)) &
          *[points%slave_weights(:, p), -points%master_weights(:, p)]
        n = n + 2*n_side
      end do
    end associate
    nodes(n + 1:) = ties%owner(:, s)
    weights(n + 1:, 2) = [-1.0_wp, 1.0_wp]
    levers = 0.0_wp
    do k = 1, 2
      levers(k::2, k) = weights(:, 1)
      levers(k::2, 2 + k) = weights(:, 2)
    end do
  end subroutine find_levers

end module tangent_ties_m
