! SPDX-License-Identifier: MIT
!> Tangent of ties: the second derivative of what their springs store (doc/theory/contact.md,
!> section 9.9). With a = d.n - a0 and b = d.t - b0 the stretches of a spring and theta the angle
!> of its segment, grad a = grad d.n + d.t grad theta and grad b = grad d.t - d.n grad theta, the
!> axes held in the gradients of d.
module tangent_ties_m
  use assembly_m, only : product_t, start_product, add_to_row, add_to_column, finish_product
  use contact_state_m, only : contact_state_t, n_side
  use kinds_m, only : wp
  use sparse_m, only : sparse_t, add_block
  use tiebreak_m, only : holds, holds_node
  use ties_m, only : tie_spring_t, tie_spring, tie_stiffness
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

  !> One spring: k w (grad a grad a^T + grad b grad b^T), and of the turn of its segment under its
  !> loads grad theta h^T + h grad theta^T, with h = fn grad(d.t) - fs grad(d.n)
  !> - (fn d.t - fs d.n) grad(stretch of the segment) - (fn d.n + fs d.t)/2 grad theta.
  pure subroutine add_spring(memory, s, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    real(wp), dimension(2*size_of(memory, s), 2*size_of(memory, s)) :: block
    real(wp), dimension(2*size_of(memory, s)) :: turn, load, stretch
    real(wp) :: fn, fs, gap, shift, tau(2)
    integer :: rows(2*size_of(memory, s)), i
    type(tie_spring_t) :: spring

    spring = tie_spring(memory, s)
    associate (p => [memory%ties%first(s), memory%ties%first(s + 1) - 1], &
      points => memory%points)
      fn = -sum(points%pressure(p(1):p(2))*points%area(p(1):p(2)))
      fs = sum(points%traction(p(1):p(2))*points%area(p(1):p(2)))
    end associate
    gap = dot_product(spring%d, spring%n)
    shift = dot_product(spring%d, spring%t)
    tau = turn_of(memory, s, spring)
    turn = gradient_of(memory, s, [0.0_wp, 0.0_wp], tau)
    load = gradient_of(memory, s, fn*spring%t - fs*spring%n, -(fn*shift - fs*gap) &
      *memory%ties%side(s)/spring%length*spring%t - 0.5_wp*(fn*gap + fs*shift)*tau)
    block = outer(turn, load) + outer(load, turn)
    if (.not. memory%has%nodal_pressure .and. holds(memory, s)) then
      do i = 1, 2
        stretch = stretch_of(memory, s, i)
        block = block + tie_stiffness(memory, s)*outer(stretch, stretch)
      end do
    end if
    rows = reshape(equations(:, nodes_of(memory, s)), [size(rows)])
    call add_block(matrix, rows, rows, block)
  end subroutine add_spring

  !> Types 6 and 7, whose springs are points: the stretches averaged at the slave nodes.
  pure subroutine add_averages(memory, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(product_t) :: product
    real(wp) :: areas(memory%n_slave)
    integer :: head(memory%n_slave), next(n_side, memory%points%n) ! n_side p - 2 + k, 0 at the end
    integer :: i, j, k, p, at

    areas = 0.0_wp
    head = 0
    associate (points => memory%points)
      do p = points%n, 1, -1
        do k = n_side, 1, -1
          i = points%slave_nodes(k, p)
          areas(i) = areas(i) + points%slave_weights(k, p)*points%area(p)
          next(k, p) = head(i)
          head(i) = n_side*(p - 1) + k
        end do
      end do
      call start_product(product, size(equations, 2))
      do i = 1, memory%n_slave
        if (.not. areas(i) > 0.0_wp .or. .not. holds_node(memory, i)) cycle
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

  !> Add a part of the gradient of a stretch to both sides of a product.
  pure subroutine add_stretch(memory, s, i, part, product)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, i
    real(wp), intent(in) :: part
    type(product_t), intent(inout) :: product
    real(wp) :: stretch(2, size_of(memory, s))
    integer :: nodes(size_of(memory, s)), k

    if (.not. abs(part) > 0.0_wp) return
    nodes = nodes_of(memory, s)
    stretch = reshape(part*stretch_of(memory, s, i), shape(stretch))
    do k = 1, size(nodes)
      call add_to_row(product, nodes(k), stretch(:, k))
      call add_to_column(product, nodes(k), stretch(:, k))
    end do
  end subroutine add_stretch

  !> Gradient of the i-th stretch of a spring, 1 along n and 2 along t.
  pure function stretch_of(memory, s, i) result(gradient)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, i
    real(wp) :: gradient(2*size_of(memory, s))
    type(tie_spring_t) :: spring

    spring = tie_spring(memory, s)
    associate (tau => turn_of(memory, s, spring))
      if (i == 1) gradient = gradient_of(memory, s, spring%n, dot_product(spring%d, spring%t)*tau)
      if (i == 2) gradient = gradient_of(memory, s, spring%t, -dot_product(spring%d, spring%n)*tau)
    end associate
  end function stretch_of

  !> Gradient of the angle of the segment of a spring by its second node, 1/m.
  pure function turn_of(memory, s, spring) result(tau)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    type(tie_spring_t), intent(in) :: spring
    real(wp) :: tau(2)

    tau = -memory%ties%side(s)/spring%length*spring%n
  end function turn_of

  !> Nodes of a spring, some of them more than once: of its points, and of its segment.
  pure function size_of(memory, s) result(n)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer :: n

    n = 2*n_side*(memory%ties%first(s + 1) - memory%ties%first(s)) + 2
  end function size_of

  !> These, local numbers.
  pure function nodes_of(memory, s) result(nodes)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer :: nodes(size_of(memory, s))

    associate (first => memory%ties%first(s), last => memory%ties%first(s + 1) - 1)
      nodes = [memory%points%slave_nodes(:, first:last), memory%points%master_nodes(:, &
        first:last), memory%ties%owner(:, s)]
    end associate
  end function nodes_of

  !> Gradient of d.direction, the direction held, and of what the second node of the segment less
  !> the first one has as `pair`.
  pure function gradient_of(memory, s, direction, pair) result(gradient)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp), intent(in) :: direction(2), pair(2)
    real(wp) :: gradient(2*size_of(memory, s))
    real(wp), dimension(n_side*(memory%ties%first(s + 1) - memory%ties%first(s))) :: slave, master
    integer :: p, n

    n = 0
    associate (points => memory%points, first => memory%ties%first(s), &
      last => memory%ties%first(s + 1) - 1)
      do p = first, last
        associate (share => points%area(p)/sum(points%area(first:last)))
          slave(n + 1:n + n_side) = share*points%slave_weights(:, p)
          master(n + 1:n + n_side) = -share*points%master_weights(:, p)
        end associate
        n = n + n_side
      end do
    end associate
    gradient = [reshape(outer(direction, [slave, master]), [4*n]), -pair, pair]
  end function gradient_of

  !> The product a b^T.
  pure function outer(a, b) result(product)
    real(wp), intent(in) :: a(:), b(:)
    real(wp) :: product(size(a), size(b))

    product = spread(a, 2, size(b))*spread(b, 1, size(a))
  end function outer

end module tangent_ties_m
