! SPDX-License-Identifier: MIT
!> Springs on the weighted gaps of type 7 whose forces are those of the end of the step (PUNIT 4;
!> doc/theory/contact.md, section 6.6): no stiffness makes them unstable at the step of the
!> elements. The points are generated with the other interfaces; pressures follow here, once the
!> velocities are known that the nodes would have without them, then tractions at the slave nodes
!> under pressure, along the rows of these turned by a right angle, within Coulomb's bounds.
module implicit_penalty_m
  use complementarity_m, only : problem_t, outcome_t, set_size, solve_complementarity, is_low, &
    is_between, is_high
  use contact_law_m, only : measure_springs, end_sampling
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t, friction_rule_t
  use energy_limit_m, only : energy_factor, scale_forces, count_cycle, returned_t, slack, &
    store_previous_springs, form_springs
  use kinds_m, only : wp
  use friction_m, only : store_previous_tractions, coefficient_of, has_decay
  use law_state_m, only : sticks, slips
  use nodal_forces_m, only : scatter_forces, average_values, share_out, previous_work_t, &
    store_previous_work, apply_forces
  use weighted_gaps_m, only : rows_t, start_rows, choose_rows, form_shares, find_rates, &
    find_slips, velocities_under, fill_band, along_normal, along_tangent
  implicit none
  private
  public :: pressure_step_t, start_pressure_step, find_rows, pressures_ahead

  !> The step ahead at the nodes of an interface, with room that is kept from step to step.
  type :: pressure_step_t
    real(wp) :: dt = 0.0_wp                 !! to the end of the step, s
    real(wp) :: dt_before = 0.0_wp          !! of the step behind, s
    integer :: cycle = 0
    logical :: is_stiff = .false.           !! the deck asks for springs without compliance
    real(wp) :: time = 0.0_wp               !! of u(n), s
    real(wp), allocatable :: velocity(:, :) !! (2, n_slave + n_master) v(n+1/2) without the
                                            !! interface; this and the next of nodes that have
                                            !! rows, of others from some step before
    real(wp), allocatable :: mobility(:, :) !! (2, n_slave + n_master) velocity from a force of 1
    real(wp), allocatable :: loaded(:, :)   !! (2, n_slave + n_master) v(n+1/2) with pressures, of
                                            !! nodes that have rows
    integer, allocatable :: prescribed(:, :) !! (2, :) prescribed motions, and their nodes
    integer, allocatable :: rigid_nodes(:, :) !! (3, :) rigid bodies, the number of a node in it,
                                            !! and the node
    integer :: n_mode = 0                   !! free motions of rigid bodies
    real(wp), allocatable :: modes(:, :, :) !! (2, n_slave + n_master, n_mode or more) velocities of
                                            !! them, times the root of what a unit force makes
    real(wp), allocatable :: gap(:)         !! (n_slave) mean gaps, m
    type(rows_t) :: rows
    type(problem_t) :: problem
  end type pressure_step_t

  !> Part of a penetration that is taken back in a step where springs have no compliance, or stand
  !> for such.
  real(wp), parameter :: recovered = 0.1_wp
  !> Penetration that counts as one from the start, over the gap below which nodes have rows.
  real(wp), parameter :: overlap = 1.0e-3_wp

contains

  !> Room for an interface.
  pure subroutine start_pressure_step(contact, memory, step)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(pressure_step_t), intent(inout) :: step

    step%is_stiff = contact%penalty < 0.0_wp
    associate (n_node => memory%n_slave + memory%n_master, n_slave => memory%n_slave)
      allocate (step%velocity(2, n_node), step%mobility(2, n_node), step%loaded(2, n_node), &
        source=0.0_wp)
      allocate (step%gap(n_slave))
      call start_rows(n_slave, n_node, step%rows)
    end associate
  end subroutine start_pressure_step

  !> The rows of the interface once its points are generated, and what each moves.
  pure subroutine find_rows(step, memory)
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory

    associate (nodal => memory%scratch%nodal)
      call average_values(memory%points, memory%points%gap, memory%n_slave, nodal)
      step%gap = nodal(1, :memory%n_slave)
      call choose_rows(memory%n_slave, nodal, memory%node_pressure, memory%closed_gap, step%rows)
      call form_shares(memory%points, step%rows)
    end associate
  end subroutine find_rows

  !> Pressures, nodal forces added to `force`, and the work of the step behind.
  subroutine pressures_ahead(rule, motion, step, memory, force)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u(n), v(n-1/2)
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)
    type(previous_work_t) :: previous_work

    memory%scratch%waits = .false.
    call store_previous_springs(memory)
    call store_previous_work(motion, memory%scratch%had_force, memory, previous_work)
    if (memory%has%friction) call store_previous_tractions(memory%friction, memory%scratch)
    if (memory%points%n > 0) then
      call solve_pressures(step, memory)
      call admit_energy(step, memory)
      if (memory%has%friction) then
        memory%points%traction(:memory%points%n) = 0.0_wp
        if (step%rows%n > 0) call solve_tractions(rule, step, memory)
      end if
      if (step%rows%n > 0) call scatter_forces(memory)
      call form_springs(memory)
      if (memory%n_active > 0 .and. step%cycle > 0 .and. memory%limit%admissible < huge(1.0_wp)) &
        call limit_return(step, motion, memory)
    else
      step%gap = 0.0_wp
      call admit_energy(step, memory)
      memory%node_pressure = 0.0_wp
    end if
    associate (had_force => memory%scratch%had_force)
      if (memory%n_active > 0 .or. had_force) &
        call apply_forces(step%dt_before, motion, previous_work, memory, force)
      call end_sampling(had_force, memory%n_active > 0, memory%monitor)
    end associate
  end subroutine pressures_ahead

  !> Energy of the springs where it is due; those loaded at time zero hold energy that no force has
  !> put in, and those without compliance hold none. The energy of springs that are born loaded is
  !> admissible; without compliance a penetration from the start is taken back at any energy, and
  !> from then on contact may return what it has taken.
  pure subroutine admit_energy(step, memory)
    type(pressure_step_t), intent(in) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: left(memory%n_slave) !! mean gaps without the compliance of the springs, m
    logical :: begins, overlaps

    begins = step%cycle == 0 .or. memory%scratch%is_born
    if (memory%monitor%is_due .or. begins) then
      call measure_springs(memory)
      if (step%is_stiff) memory%monitor%stored = 0.0_wp
    end if
    if (step%cycle == 0) memory%energy = memory%monitor%stored
    associate (limit => memory%limit)
      if (.not. step%is_stiff) then
        if (memory%scratch%is_born) limit%admissible = memory%monitor%stored
      else if (begins .or. limit%admissible >= huge(1.0_wp)) then
        left = step%gap
        if (memory%slave_penalty > 0.0_wp) left = left &
          + memory%node_pressure/(recovered*memory%slave_penalty)
        overlaps = any(left < -overlap*memory%closed_gap)
        if (overlaps) limit%admissible = huge(1.0_wp)
        if (begins .or. overlaps) return
        limit%admissible = max(0.0_wp, -memory%energy)
        limit%largest = 0.0_wp
      end if
    end associate
  end subroutine admit_energy

  !> Energy limit (section 6.1): areas and normals change while corners turn. The step to come is
  !> known here, and so is the energy that it returns.
  pure subroutine limit_return(step, motion, memory)
    type(pressure_step_t), intent(in) :: step
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    real(wp), dimension(2, size(memory%nodes)) :: velocity, forces, previous
    type(returned_t) :: returned !! by normal forces with the factor one in both half steps
    real(wp) :: factor
    integer :: k

    velocity = motion(3:4, memory%nodes)
    if (memory%has%friction) then
      forces = memory%scratch%spring
      previous = memory%scratch%previous_spring
    else
      forces = memory%force
      previous = memory%scratch%previous_force
    end if
    returned%behind = 0.5_wp*step%dt_before*sum(forces*velocity)
    returned%ahead = 0.5_wp*step%dt*sum(forces*step%velocity)
    returned%recoil = 0.5_wp*step%dt*sum(forces**2*step%mobility)
    do k = 1, step%n_mode
      returned%recoil = returned%recoil + 0.5_wp*step%dt*sum(step%modes(:, :, k)*forces)**2
    end do
    associate (limit => memory%limit)
      factor = energy_factor(returned, memory%energy + limit%admissible &
        - 0.5_wp*step%dt_before*sum(previous*velocity) + slack*limit%largest &
        + limit%entry_allowance)
      call count_cycle(factor, step%time, limit)
    end associate
    if (.not. factor < 1.0_wp) return
    call scale_forces(factor, memory)
    call form_springs(memory)
  end subroutine limit_return

  !> Pressures of the slave nodes: P = kappa p >= 0, and what is left of each mean gap at the end of
  !> the step beside the spring, r + W P >= 0, one of them zero.
  pure subroutine solve_pressures(step, memory)
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    type(outcome_t) :: outcome

    associate (rows => step%rows, problem => step%problem, points => memory%points)
      if (rows%n > 0) then
        call set_size(problem, rows%n, rows%width, step%n_mode)
        call set_matrix(step, along_normal, memory%slave_penalty*step%dt)
        call set_gap_rates(step, memory%node_pressure)
        call solve_complementarity(problem, outcome)
      end if
      memory%node_pressure = 0.0_wp
      if (rows%n > 0) memory%node_pressure(rows%slave(:rows%n)) = problem%x(:rows%n) &
        *rows%inverse(:rows%n)
      call share_out(points%n, points%slave_nodes, points%slave_weights, memory%node_pressure, &
        points%pressure)
    end associate
  end subroutine solve_pressures

  !> W: what forces along rows change in their rates, the compliance of their springs on the
  !> diagonal, and how they move rigid bodies.
  pure subroutine set_matrix(step, direction, stiffness)
    type(pressure_step_t), intent(inout) :: step
    integer, intent(in) :: direction    !! along_normal or along_tangent
    real(wp), intent(in) :: stiffness   !! times the step, N s/m^2; 0: they have no compliance
    integer :: i, at, m

    associate (rows => step%rows, problem => step%problem)
      call fill_band(rows, direction, step%mobility, problem%band)
      do i = 1, rows%n
        at = (rows%width + 1)*(i - 1) + 1
        if (stiffness > 0.0_wp) &
          problem%band(at) = problem%band(at) + rows%inverse(i)/stiffness
      end do
      do m = 1, step%n_mode
        call find_rates(rows, direction, step%modes(:, :, m), problem%column((m - 1)*rows%n + 1))
      end do
    end associate
  end subroutine set_matrix

  !> Rates of the mean gaps over the step without pressures, and which pressures are guessed above
  !> zero. Of an overlap a part is taken back in a step where springs have no compliance.
  pure subroutine set_gap_rates(step, pressure)
    type(pressure_step_t), intent(inout) :: step
    real(wp), intent(in) :: pressure(:) !! (n_slave) of the step before, N/m^2
    real(wp) :: closes                  !! per m of overlap, 1/s
    integer :: i

    closes = merge(recovered, 1.0_wp, step%is_stiff)/step%dt
    associate (rows => step%rows, problem => step%problem)
      call find_rates(rows, along_normal, step%velocity, problem%r)
      do i = 1, rows%n
        associate (gap => step%gap(rows%slave(i)))
          problem%r(i) = problem%r(i) + merge(closes, 1.0_wp/step%dt, gap < 0.0_wp)*gap
        end associate
        problem%low(i) = 0.0_wp
        problem%high(i) = huge(1.0_wp)
        problem%at(i) = merge(is_between, is_low, pressure(rows%slave(i)) > 0.0_wp)
      end do
    end associate
  end subroutine set_gap_rates

  !> Tractions of slave nodes and points, once pressures are known: x is minus kappa times the
  !> traction, its slack what is left of the slip rate beside the spring.
  pure subroutine solve_tractions(rule, step, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(inout) :: memory
    type(outcome_t) :: outcome
    real(wp) :: stiffness !! of the tangential springs, N/m^2
    integer :: m

    stiffness = rule%stiffness*memory%slave_penalty
    associate (rows => step%rows, problem => step%problem, points => memory%points)
      call set_bounds(rule, step, memory)
      call velocities_under(rows, step%mobility, problem%x, step%velocity, step%loaded)
      do m = 1, step%n_mode
        step%loaded = step%loaded + step%modes(:, :, m)*dot_product(problem%x(:rows%n), &
          problem%column((m - 1)*rows%n + 1:m*rows%n))
      end do
      call set_matrix(step, along_tangent, stiffness*step%dt)
      call find_slips(rows, points, memory%positions, step%loaded, problem%r)
      if (stiffness > 0.0_wp) problem%r(:rows%n) = problem%r(:rows%n) &
        + memory%scratch%previous_traction(rows%slave(:rows%n))/(stiffness*step%dt)
      call solve_complementarity(problem, outcome)
      call store_tractions(stiffness, step, memory)
      call share_out(points%n, points%slave_nodes, points%slave_weights, &
        memory%friction%traction, points%traction)
    end associate
  end subroutine solve_tractions

  !> Largest tractions of the rows times kappa, by the speeds of sliding of the step behind: what
  !> stuck did not slide, however its spring moved. What slipped is guessed to slip.
  pure subroutine set_bounds(rule, step, memory)
    type(friction_rule_t), intent(in) :: rule
    type(pressure_step_t), intent(inout) :: step
    type(contact_state_t), intent(in) :: memory
    real(wp) :: slip(step%rows%n), speed
    integer :: i

    slip = 0.0_wp
    if (has_decay(rule) .and. step%dt_before > 0.0_wp) call find_slips(step%rows, memory%points, &
      memory%positions, memory%scratch%increment, slip)
    associate (problem => step%problem)
      do i = 1, step%rows%n
        associate (before => memory%scratch%previous_state(step%rows%slave(i)), &
          high => problem%high(i))
          speed = merge(0.0_wp, abs(slip(i)), before == sticks)/max(step%dt_before, tiny(1.0_wp))
          high = coefficient_of(rule, speed)*problem%x(i)
          if (rule%most > 0.0_wp) high = min(high, rule%most/step%rows%inverse(i))
          problem%low(i) = -high
          problem%at(i) = is_between
          if (before == slips .or. .not. high > 0.0_wp) problem%at(i) = merge(is_low, is_high, &
            memory%scratch%previous_traction(step%rows%slave(i)) > 0.0_wp)
        end associate
      end do
    end associate
  end subroutine set_bounds

  !> Tractions, states and slips of the slave nodes, and what their tangential springs store.
  pure subroutine store_tractions(stiffness, step, memory)
    real(wp), intent(in) :: stiffness !! of the tangential springs, N/m^2
    type(pressure_step_t), intent(in) :: step
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: rate
    integer :: i, node

    associate (problem => step%problem, friction => memory%friction, &
      previous => memory%scratch%previous_traction)
      do i = 1, step%rows%n
        node = step%rows%slave(i)
        if (.not. memory%node_pressure(node) > 0.0_wp) cycle
        associate (inverse => step%rows%inverse(i), traction => friction%traction(node))
          traction = -problem%x(i)*inverse
          rate = problem%slack(i)
          if (stiffness > 0.0_wp) then
            rate = rate + (traction - previous(node))/(stiffness*step%dt)
            friction%stored = friction%stored + traction**2/(2.0_wp*stiffness*inverse)
          end if
          friction%slip(node) = friction%slip(node) + rate*step%dt
          friction%state(node) = merge(sticks, slips, problem%at(i) == is_between)
        end associate
      end do
    end associate
  end subroutine store_tractions

end module implicit_penalty_m
