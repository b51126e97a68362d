! SPDX-License-Identifier: MIT
!> Tangent of ties: the second derivative of what their springs store (doc/theory/contact.md,
!> section 9.9).
module tangent_ties_m
  use assembly_m, only : pattern_t, start_pattern, use_node, add_product
  use contact_state_m, only : contact_state_t, n_side
  use kinds_m, only : wp
  use sparse_m, only : sparse_t
  use tiebreak_m, only : holds, holds_node
  use ties_m, only : tie_spring_t, tie_spring, tie_stiffness
  implicit none
  private
  public :: add_tie_tangent

  !> Gradients go into the row or into the column of the scratch.
  integer, parameter :: to_row = 1, to_column = 2

contains

  !> Add the derivative of minus the forces of all springs.
  pure subroutine add_tie_tangent(memory, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(pattern_t) :: pattern
    integer :: s

    call start_pattern(pattern, memory%n_slave + memory%n_master)
    do s = 1, size(memory%ties%side)
      call add_turns(memory, s, pattern, equations, matrix)
      if (memory%has%nodal_pressure .or. .not. holds(memory, s)) cycle
      call add_stretches(memory, s, pattern, equations, matrix)
    end do
    if (memory%has%nodal_pressure) call add_nodal(memory, pattern, equations, matrix)
  end subroutine add_tie_tangent

  !> Both stretches of a spring: k w (grad a grad a^T + grad b grad b^T).
  pure subroutine add_stretches(memory, s, pattern, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    type(pattern_t), intent(inout) :: pattern
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(tie_spring_t) :: spring
    integer :: i, k

    spring = tie_spring(memory, s)
    do i = 1, 2
      do k = to_row, to_column
        call add_stretch(memory, spring, s, i, 1.0_wp, k, pattern)
      end do
      call add_product(pattern, tie_stiffness(memory, s), equations, matrix)
    end do
  end subroutine add_stretches

  !> Types 6 and 7: the same of the averages at slave nodes.
  pure subroutine add_nodal(memory, pattern, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    type(pattern_t), intent(inout) :: pattern
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(tie_spring_t) :: spring
    real(wp) :: area(memory%n_slave), share
    integer :: first(memory%n_slave + 1), at(n_side*memory%points%n)
    integer :: i, j, k, m

    call list_by_node(memory, first, at, area)
    associate (points => memory%points)
      do i = 1, memory%n_slave
        if (.not. area(i) > 0.0_wp .or. .not. holds_node(memory, i)) cycle
        do j = 1, 2
          do m = first(i), first(i + 1) - 1
            share = sum(points%slave_weights(:, at(m)), points%slave_nodes(:, at(m)) == i) &
              *points%area(at(m))/area(i)
            if (.not. abs(share) > 0.0_wp) cycle
            spring = tie_spring(memory, at(m))
            do k = to_row, to_column
              call add_stretch(memory, spring, at(m), j, share, k, pattern)
            end do
          end do
          call add_product(pattern, memory%slave_penalty*area(i), equations, matrix)
        end do
      end do
    end associate
  end subroutine add_nodal

  !> The points at each slave node, once each and in their order, and the area of the node.
  pure subroutine list_by_node(memory, first, at, area)
    type(contact_state_t), intent(in) :: memory
    integer, intent(out) :: first(:) !! (n_slave + 1) where each node starts in ...
    integer, intent(out) :: at(:)    !! ... this list of points
    real(wp), intent(out) :: area(:) !! (n_slave) m
    integer :: next(memory%n_slave), n(memory%n_slave), p, k, i

    n = 0
    area = 0.0_wp
    associate (points => memory%points)
      do p = 1, points%n
        do k = 1, n_side
          i = points%slave_nodes(k, p)
          area(i) = area(i) + points%slave_weights(k, p)*points%area(p)
          if (k == 1 .or. i /= points%slave_nodes(1, p)) n(i) = n(i) + 1
        end do
      end do
      first(1) = 1
      do i = 1, memory%n_slave
        first(i + 1) = first(i) + n(i)
      end do
      next = first(:memory%n_slave)
      do p = 1, points%n
        do k = 1, n_side
          i = points%slave_nodes(k, p)
          if (k > 1 .and. i == points%slave_nodes(1, p)) cycle
          at(next(i)) = p
          next(i) = next(i) + 1
        end do
      end do
    end associate
  end subroutine list_by_node

  !> What the springs' loads make of the turn of the segment: with theta its angle, grad grad of
  !> fn a + fs b is grad theta h^T + h grad theta^T with h = fn grad(d.t) - fs grad(d.n)
  !> - (fn d.t - fs d.n) grad(stretch of the segment) - (fn d.n + fs d.t)/2 grad theta, n and t held
  !> in the first two.
  pure subroutine add_turns(memory, s, pattern, equations, matrix)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    type(pattern_t), intent(inout) :: pattern
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(tie_spring_t) :: spring
    real(wp) :: fn, fs, gap, shift
    integer :: k

    spring = tie_spring(memory, s)
    associate (first => memory%ties%first(s), last => memory%ties%first(s + 1) - 1, &
      points => memory%points)
      fn = -sum(points%pressure(first:last)*points%area(first:last))
      fs = sum(points%traction(first:last)*points%area(first:last))
    end associate
    gap = dot_product(spring%d, spring%n)
    shift = dot_product(spring%d, spring%t)
    do k = 1, 2
      call add_turn(memory, spring, s, 1.0_wp, k, pattern)
      call add_distance(memory, s, fn*spring%t - fs*spring%n, 3 - k, pattern)
      call add_pair(memory, s, -(fn*shift - fs*gap)*memory%ties%side(s)/spring%length*spring%t, &
        3 - k, pattern)
      call add_turn(memory, spring, s, -0.5_wp*(fn*gap + fs*shift), 3 - k, pattern)
      call add_product(pattern, 1.0_wp, equations, matrix)
    end do
  end subroutine add_turns

  !> Add factor times the gradient of a stretch: along n with grad d.n + d.t grad theta, along t
  !> with grad d.t - d.n grad theta.
  pure subroutine add_stretch(memory, spring, s, i, factor, k, pattern)
    type(contact_state_t), intent(in) :: memory
    type(tie_spring_t), intent(in) :: spring
    integer, intent(in) :: s
    integer, intent(in) :: i !! 1 along n, 2 along t
    real(wp), intent(in) :: factor
    integer, intent(in) :: k !! to_row or to_column
    type(pattern_t), intent(inout) :: pattern

    if (i == 1) then
      call add_distance(memory, s, factor*spring%n, k, pattern)
      call add_turn(memory, spring, s, factor*dot_product(spring%d, spring%t), k, pattern)
    else
      call add_distance(memory, s, factor*spring%t, k, pattern)
      call add_turn(memory, spring, s, -factor*dot_product(spring%d, spring%n), k, pattern)
    end if
  end subroutine add_stretch

  !> Add the gradient of d.direction, the direction held.
  pure subroutine add_distance(memory, s, direction, k, pattern)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp), intent(in) :: direction(2)
    integer, intent(in) :: k
    type(pattern_t), intent(inout) :: pattern
    real(wp) :: share
    integer :: p, i

    associate (points => memory%points, first => memory%ties%first(s), &
      last => memory%ties%first(s + 1) - 1)
      do p = first, last
        share = points%area(p)/sum(points%area(first:last))
        do i = 1, n_side
          call add_to_node(points%slave_nodes(i, p), &
            share*points%slave_weights(i, p)*direction, k, pattern)
          call add_to_node(points%master_nodes(i, p), &
            -share*points%master_weights(i, p)*direction, k, pattern)
        end do
      end do
    end associate
  end subroutine add_distance

  !> Add factor times the gradient of the angle of the segment.
  pure subroutine add_turn(memory, spring, s, factor, k, pattern)
    type(contact_state_t), intent(in) :: memory
    type(tie_spring_t), intent(in) :: spring
    integer, intent(in) :: s
    real(wp), intent(in) :: factor
    integer, intent(in) :: k
    type(pattern_t), intent(inout) :: pattern

    call add_pair(memory, s, -factor*memory%ties%side(s)/spring%length*spring%n, k, pattern)
  end subroutine add_turn

  !> Add a vector at the second node of the segment and its opposite at the first.
  pure subroutine add_pair(memory, s, vector, k, pattern)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp), intent(in) :: vector(2)
    integer, intent(in) :: k
    type(pattern_t), intent(inout) :: pattern

    call add_to_node(memory%ties%owner(2, s), vector, k, pattern)
    call add_to_node(memory%ties%owner(1, s), -vector, k, pattern)
  end subroutine add_pair

  !> Add to one node.
  pure subroutine add_to_node(node, vector, k, pattern)
    integer, intent(in) :: node
    real(wp), intent(in) :: vector(2)
    integer, intent(in) :: k
    type(pattern_t), intent(inout) :: pattern

    call use_node(pattern, node)
    if (k == to_row) pattern%row(:, node) = pattern%row(:, node) + vector
    if (k == to_column) pattern%column(:, node) = pattern%column(:, node) + vector
  end subroutine add_to_node

end module tangent_ties_m
