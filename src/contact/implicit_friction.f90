! SPDX-License-Identifier: MIT
!> Friction of implicit penalties (PUNIT 4; doc/theory/contact.md, section 6.6): tractions of the
!> end of the step at the slave nodes that press, along the rows of these turned by a right angle,
!> each no more than Coulomb's law lets it be.
module implicit_friction_m
  use complementarity_m, only : outcome_t, set_size, solve_complementarity, is_low, &
    is_between, is_high
  use contact_state_m, only : contact_state_t
  use contacts_m, only : friction_rule_t
  use friction_slips_m, only : find_slips
  use friction_state_m, only : sticks, slips
  use kinds_m, only : wp
  use law_friction_m, only : find_limits
  use nodal_average_m, only : average_more, share_out
  use pressing_m, only : pressing_t, add_compliance, fill_columns
  use weighted_gaps_m, only : press_nodes, fill_band, along_tangent
  implicit none
  private
  public :: rub_ahead

contains

  !> Tractions of slave nodes and points, once pressures are known.
  pure subroutine rub_ahead(rule, step, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressing_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    type(outcome_t) :: outcome
    real(wp) :: limit(step%rows%n)
    integer :: k

    call provide_slips(size(memory%points%gap), step)
    call find_limits_ahead(rule, step, memory, limit)
    call press_nodes(step%rows, step%mobility, step%problem%x, step%velocity, step%pressed)
    do k = 1, step%n_mode
      associate (n => step%problem%n)
        step%pressed = step%pressed + step%modes(:, :, k)*dot_product( &
          step%problem%column((k - 1)*n + 1:k*n), step%problem%x(:n))
      end associate
    end do
    call average_slips(step%pressed, step%slip, memory)
    call set_up(rule, step, limit, memory)
    call solve_complementarity(step%problem, outcome)
    if (outcome%n_sweep > 0) memory%n_swept = memory%n_swept + 1
    call leave_tractions(rule, step, memory)
    associate (points => memory%points)
      call share_out(points%n, points%slave_nodes, points%slave_weights, &
        memory%friction%traction, points%traction)
    end associate
    memory%scratch%nodal(1, :memory%n_slave) = step%gap
  end subroutine rub_ahead

  !> Largest tractions of the rows, by the speeds of the step behind.
  pure subroutine find_limits_ahead(rule, step, memory, limit)
    type(friction_rule_t), intent(in) :: rule
    type(pressing_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(out) :: limit(:) !! (rows) N/m^2
    real(wp) :: slip(size(limit))

    slip = 0.0_wp
    if (rule%decay > 0.0_wp .and. step%dt_before > 0.0_wp) then
      call average_slips(memory%scratch%increment, step%slip, memory)
      slip = memory%scratch%nodal(1, step%rows%slave(:step%rows%n))
    end if
    call find_limits(rule, size(limit), step%dt_before, slip, &
      memory%node_pressure(step%rows%slave(:step%rows%n)), limit)
    if (rule%most > 0.0_wp) limit = min(limit, rule%most)
  end subroutine find_limits_ahead

  !> Mean slips of the slave nodes by motions of the nodes.
  pure subroutine average_slips(motion, slip, memory)
    real(wp), intent(in), contiguous :: motion(:, :)  !! (2, n_node) m or m/s
    real(wp), intent(inout), contiguous :: slip(:)    !! room for all points
    type(contact_state_t), intent(inout) :: memory    !! scratch%nodal(1, :): the means

    associate (points => memory%points)
      call find_slips(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
        points%master_weights, points%normal, points%gap, motion, memory%places, slip)
      call average_more(points, slip, memory%n_slave, memory%scratch%nodal)
    end associate
  end subroutine average_slips

  !> Room for the slips of so many points.
  pure subroutine provide_slips(n, step)
    integer, intent(in) :: n
    type(pressing_t), intent(inout) :: step

    if (allocated(step%slip)) then
      if (size(step%slip) >= n) return
      deallocate (step%slip)
    end if
    allocate (step%slip(n))
  end subroutine provide_slips

  !> The problem: x is minus kappa times the traction, its slack what is left of the slip rate
  !> beside the spring.
  pure subroutine set_up(rule, step, limit, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressing_t), intent(inout) :: step
    real(wp), intent(in) :: limit(:) !! (rows) largest tractions, N/m^2
    type(contact_state_t), intent(in) :: memory
    real(wp) :: stiffness
    integer :: i, node

    stiffness = rule%stiffness*memory%slave_penalty*step%dt
    associate (rows => step%rows, problem => step%problem, nodal => memory%scratch%nodal, &
      former => memory%scratch%former_traction)
      call set_size(problem, rows%n, rows%width, step%n_mode)
      call fill_band(rows, along_tangent, step%mobility, problem%band)
      call fill_columns(step, along_tangent)
      if (stiffness > 0.0_wp) call add_compliance(rows%n, rows%width, rows%inverse, &
        stiffness, problem%band)
      do i = 1, rows%n
        node = rows%slave(i)
        problem%r(i) = nodal(1, node)
        if (stiffness > 0.0_wp) problem%r(i) = problem%r(i) + former(node)/stiffness
        problem%high(i) = limit(i)*nodal(2, node)
        problem%low(i) = -problem%high(i)
        problem%at(i) = is_between
        if (memory%scratch%former_state(node) == slips .or. .not. problem%high(i) > 0.0_wp) &
          problem%at(i) = merge(is_low, is_high, former(node) > 0.0_wp)
      end do
    end associate
  end subroutine set_up

  !> What the slave nodes remember of the step.
  pure subroutine leave_tractions(rule, step, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressing_t), intent(in) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: stiffness, rate
    integer :: i, node

    stiffness = rule%stiffness*memory%slave_penalty
    associate (problem => step%problem, friction => memory%friction, &
      former => memory%scratch%former_traction)
      do i = 1, step%rows%n
        node = step%rows%slave(i)
        if (.not. memory%node_pressure(node) > 0.0_wp) cycle
        associate (kappa => memory%scratch%nodal(2, node), traction => friction%traction(node))
          traction = -problem%x(i)/kappa
          rate = problem%slack(i)
          if (stiffness > 0.0_wp) then
            rate = rate + (traction - former(node))/(stiffness*step%dt)
            friction%stored = friction%stored + kappa*traction**2/(2.0_wp*stiffness)
          end if
          friction%slip(node) = friction%slip(node) + rate*step%dt
          friction%state(node) = merge(sticks, slips, problem%at(i) == is_between)
        end associate
      end do
    end associate
  end subroutine leave_tractions

end module implicit_friction_m
