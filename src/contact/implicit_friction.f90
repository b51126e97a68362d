! SPDX-License-Identifier: MIT
!> Friction of implicit penalties (PUNIT 4; doc/theory/contact.md, section 6.6): tractions of the
!> end of the step at the slave nodes that press, along the rows of these turned by a right angle,
!> each no more than Coulomb's law lets it be.
module implicit_friction_m
  use complementarity_m, only : outcome_t, solve_complementarity, is_low, is_between, is_high
  use contact_state_m, only : contact_state_t, contact_points_t
  use contacts_m, only : friction_rule_t
  use law_state_m, only : sticks, slips
  use gap_rates_m, only : find_rates, add_turns, load_nodes, turns_alike, fill_band, along_tangent
  use kinds_m, only : wp
  use law_friction_m, only : coefficient_of, has_decay
  use nodal_average_m, only : share_out
  use pressure_step_m, only : pressure_step_t, take_diagonal, set_diagonal, fill_columns
  use weighted_gaps_m, only : rows_t, node_of
  implicit none
  private
  public :: friction_ahead

contains

  !> Tractions of slave nodes and points, once pressures are known.
  pure subroutine friction_ahead(rule, step, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    type(outcome_t) :: outcome

    call find_bounds(rule, step, memory)
    call load_nodes(step%rows, step%mobility, step%problem%x, step%velocity, step%loaded)
    call load_modes(step)
    call find_slips(step%rows, memory%points, memory%positions, step%loaded, step%problem%r)
    call set_up(rule, step, memory)
    call solve_complementarity(step%problem, outcome)
    call store_tractions(rule, step, memory)
    associate (points => memory%points)
      call share_out(points%n, points%slave_nodes, points%slave_weights, &
        memory%friction%traction, points%traction)
    end associate
  end subroutine friction_ahead

  !> Largest tractions of the rows times kappa, by the speeds of sliding of the step behind: what
  !> stuck did not slide, however its spring moved.
  pure subroutine find_bounds(rule, step, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(in) :: memory
    integer :: i

    associate (n => step%rows%n, problem => step%problem)
      problem%high(:n) = coefficient_of(rule, 0.0_wp)*problem%x(:n)
      if (has_decay(rule) .and. step%dt_before > 0.0_wp) then
        call find_slips(step%rows, memory%points, memory%positions, memory%scratch%increment, &
          problem%r)
        do i = 1, n
          if (memory%scratch%previous_state(step%rows%slave(i)) == sticks) cycle
          problem%high(i) = coefficient_of(rule, abs(problem%r(i))/step%dt_before)*problem%x(i)
        end do
      end if
      if (rule%most > 0.0_wp) &
        problem%high(:n) = min(problem%high(:n), rule%most/step%rows%inverse(:n))
    end associate
  end subroutine find_bounds

  !> What the pressures make of the motions of rigid bodies.
  pure subroutine load_modes(step)
    type(pressure_step_t), intent(inout) :: step
    real(wp) :: speed
    integer :: j, k

    associate (n => step%problem%n)
      do k = 1, step%n_mode
        speed = dot_product(step%problem%column((k - 1)*n + 1:k*n), step%problem%x(:n))
        do j = 1, step%rows%n_node
          associate (node => step%rows%node(node_of, j))
            step%loaded(:, node) = step%loaded(:, node) + step%modes(:, node, k)*speed
          end associate
        end do
      end do
    end associate
  end subroutine load_modes

  !> Mean slips of the rows by motions of the nodes.
  pure subroutine find_slips(rows, points, positions, motion, slip)
    type(rows_t), intent(in) :: rows
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: positions(:, :), motion(:, :) !! motion in m or m/s
    real(wp), intent(inout), contiguous :: slip(:)                 !! the same

    call find_rates(rows, along_tangent, motion, slip)
    call add_turns(rows, points, positions, motion, slip)
  end subroutine find_slips

  !> The problem, whose r is the slips: x is minus kappa times the traction, its slack what is left
  !> of the slip rate beside the spring.
  pure subroutine set_up(rule, step, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(in) :: memory
    real(wp) :: stiffness
    integer :: i, node

    stiffness = rule%stiffness*memory%slave_penalty*step%dt
    associate (rows => step%rows, problem => step%problem, &
      previous => memory%scratch%previous_traction)
      if (.not. turns_alike(rows%n_node, rows%node, step%mobility)) then
        call fill_band(rows, along_tangent, step%mobility, problem%band)
        call take_diagonal(rows%n, rows%width, problem%band, step%diagonal)
      end if
      call set_diagonal(rows%n, rows%width, step%diagonal, rows%inverse, stiffness, problem%band)
      call fill_columns(step, along_tangent)
      do i = 1, rows%n
        node = rows%slave(i)
        if (stiffness > 0.0_wp) problem%r(i) = problem%r(i) + previous(node)/stiffness
        problem%low(i) = -problem%high(i)
        problem%at(i) = is_between
        if (memory%scratch%previous_state(node) == slips .or. .not. problem%high(i) > 0.0_wp) &
          problem%at(i) = merge(is_low, is_high, previous(node) > 0.0_wp)
      end do
    end associate
  end subroutine set_up

  !> What the slave nodes remember of the step.
  pure subroutine store_tractions(rule, step, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressure_step_t), intent(in) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: stiffness, rate
    integer :: i, node

    stiffness = rule%stiffness*memory%slave_penalty
    associate (problem => step%problem, friction => memory%friction, &
      previous => memory%scratch%previous_traction)
      do i = 1, step%rows%n
        node = step%rows%slave(i)
        if (.not. memory%node_pressure(node) > 0.0_wp) cycle
        associate (kappa => memory%scratch%nodal(2, node), traction => friction%traction(node))
          traction = -problem%x(i)/kappa
          rate = problem%slack(i)
          if (stiffness > 0.0_wp) then
            rate = rate + (traction - previous(node))/(stiffness*step%dt)
            friction%stored = friction%stored + kappa*traction**2/(2.0_wp*stiffness)
          end if
          friction%slip(node) = friction%slip(node) + rate*step%dt
          friction%state(node) = merge(sticks, slips, problem%at(i) == is_between)
        end associate
      end do
    end associate
  end subroutine store_tractions

end module implicit_friction_m
