! SPDX-License-Identifier: MIT
!> What the implicit driver writes: motion, velocity and acceleration of one instant, energies with
!> the consistent mass; forces on boundaries and of groups of nodes, and their work, where histories
!> ask for them (bndout, nodfor).
module implicit_report_m
  use clock_m, only : lap, phase_output
  use loads_m, only : is_active
  use controls_m, only : boundary_motion, group_nodes
  use element_mass_m, only : mass_times, sum_part_motion
  use element_state_m, only : add_part_energies
  use snapshot_m, only : energy_ratio
  use equations_m, only : equations_t
  use errors_m, only : error_t
  use health_m, only : check_energy, check_ratio, check_radii, judge_energies, judge_contact, &
    made_by_forces, unaccounted, dissipated
  use history_filling_m, only : fill_reactions, form_loads
  use history_tables_m, only : table_matsum, table_spcforc, table_bndout, table_nodfor, &
    table_secforc
  use implicit_forces_m, only : trial_t, net_force, cut_sections, step_t
  use implicit_start_m, only : implicit_memory_t
  use kinds_m, only : wp
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t, find_due, any_due
  use output_schedule_m, only : output_reach
  use reporting_m, only : note_energies, write_instant
  use snapshot_filling_m, only : fill_energies, fill_parts
  use state_m, only : state_t
  implicit none
  private
  public :: report_step, reactions_work, held_energy, spent_energy, count_step_boundaries

contains

  !> Write what is due; of a state that was reported before, only what was not written then. The
  !> memory learns the energy ratio.
  subroutine report_step(model, state, last, plots, monitor, memory, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, intent(in) :: last
    logical, intent(in) :: plots          !! someone asks for a plot state
    type(monitor_t), intent(inout) :: monitor
    type(implicit_memory_t), intent(inout) :: memory !! of the state; `written` is that of the one
                                          !! reported before, and becomes that of this one
    type(error_t), allocatable, intent(out) :: error
    type(due_t) :: due
    real(wp) :: dt, kinetic(size(model%parts)), momentum(2, size(model%parts))
    character(:), allocatable :: cause !! where missing energy has gone

    dt = output_reach(model%controls, state%dt)
    due = find_due(monitor, state%time, dt, state%cycle == 0 .or. last)
    due%plot = due%plot .or. (plots .and. monitor%has_plot)
    if (state%cycle == monitor%snapshot%cycle) then
      due%plot = due%plot .and. .not. memory%written%plot
      due%tables = due%tables .and. .not. memory%written%tables
    end if
    memory%written = due
    if (.not. any_due(due)) return
    associate (shot => monitor%snapshot, force => memory%step%old_force)
      shot%time = state%time
      shot%cycle = state%cycle
      shot%dt = state%dt
      shot%displacement = state%motion(1:2, :)
      shot%velocity = state%motion(3:4, :)
      shot%acceleration = state%acceleration
      call fill_energies(model, state, [0.0_wp, 0.0_wp], shot)
      shot%energies%kinetic = 0.5_wp*sum(shot%velocity*mass_times(model, shot%velocity))
      shot%energies%made = max(0.0_wp, -shot%energies%contact)
      call note_energies(model, .true., state, monitor)
      if (due%tables(table_matsum)) then
        call fill_parts(model, state%elements, shot)
        call sum_part_motion(model, shot%velocity, kinetic, momentum)
        shot%parts%kinetic = kinetic
        shot%parts%momentum(1) = momentum(1, :)
        shot%parts%momentum(2) = momentum(2, :)
      end if
      if (due%tables(table_spcforc)) call fill_reactions(model, &
        force + mass_times(model, shot%acceleration), shot)
      if (any(due%tables([table_bndout, table_nodfor]))) call find_forces(model, &
        force + mass_times(model, shot%acceleration), memory%trial%internal, state)
      if (due%tables(table_secforc)) call cut_sections(model, memory%trial, state)
      memory%ratio = energy_ratio(shot%energies)
      call write_instant(model, due, dt, memory%ratio, state, monitor, error)
      if (.not. allocated(error)) call check_energy(model%controls, shot%energies, made_by_forces, &
        error)
      cause = unaccounted
      if (memory%step%is_dynamic .and. memory%step%gamma > 0.5_wp*(1.0_wp + epsilon(1.0_wp))) &
        cause = dissipated
      if (.not. allocated(error)) call check_ratio(shot%energies, &
        spent_energy(state, memory%step), cause, state%cycle, state%time, monitor%told_ratio, &
        monitor%log)
      call check_radii(model, state, monitor%told_radii, monitor%log)
      if (last .and. .not. allocated(error)) then
        call judge_contact(shot%energies, monitor%log)
        call judge_energies(shot%energies, spent_energy(state, memory%step), cause, monitor%log)
      end if
    end associate
    call lap(monitor%clock, phase_output)
  end subroutine report_step

  !> All that a body at rest has taken of the work done on it, stored or dissipated, J/m.
  function held_energy(model, state) result(held)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp) :: held
    real(wp), dimension(size(model%parts)) :: internal, hourglass, viscous

    internal = 0.0_wp
    hourglass = 0.0_wp
    viscous = 0.0_wp
    call add_part_energies(model, state%motion, state%elements, internal, hourglass, viscous)
    held = sum(internal + hourglass + viscous) + sum(state%contacts%energy) &
      + sum(state%contacts%damping_work) + sum(state%contacts%friction%work)
    if (allocated(state%elements%damping_work)) held = held + sum(state%elements%damping_work)
  end function held_energy

  !> Energy that may go without an account, J/m: in statics what springs and pre-stressed bodies
  !> hold before the first equilibrium.
  pure function spent_energy(state, step) result(spent)
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    real(wp) :: spent

    spent = merge(0.0_wp, max(0.0_wp, state%initial_energy), step%is_dynamic)
  end function spent_energy

  !> Work of the forces that hold prescribed degrees of freedom to their curves: of inertia, change
  !> of momentum times mean velocity, which is the kinetic energy that they gain, also in a blow; of
  !> the others by the trapezoidal rule.
  function reactions_work(model, equations, before, after, state, velocity) result(work)
    type(model_t), intent(in) :: model
    type(equations_t), intent(in) :: equations
    type(trial_t), intent(in) :: before, after
    type(state_t), intent(in) :: state                  !! as the step has found it
    real(wp), allocatable, intent(in) :: velocity(:, :) !! (2, n_node) v(n+1); not there in statics
    real(wp) :: work

    work = 0.0_wp
    if (equations%n == equations%n_free) return
    work = 0.5_wp*sum((net_force(before) + net_force(after))*after%motion(3:4, :), &
      equations%number > equations%n_free)
    if (allocated(velocity)) work = work + 0.5_wp*sum(mass_times(model, velocity &
      - state%motion(3:4, :))*(state%motion(3:4, :) + velocity), &
      equations%number > equations%n_free)
  end function reactions_work

  !> Work of a step, of which the state has not heard yet: loads and reactions by the trapezoidal
  !> rule, and of inertia the change of momentum times mean velocity.
  subroutine count_step_boundaries(model, before, after, time, velocity, state)
    type(model_t), intent(in) :: model
    type(trial_t), intent(in) :: before, after
    real(wp), intent(in) :: time                        !! at the end of the step
    real(wp), allocatable, intent(in) :: velocity(:, :) !! (2, n_node) there; not there in statics
    type(state_t), intent(inout) :: state               !! as the step has found it
    real(wp), allocatable :: power(:, :), former(:, :)
    integer :: i

    if (allocated(state%boundary_work)) then
      former = state%boundary_force
      call form_loads(model, state%motion, state%time, former)
      call form_loads(model, after%motion, time, state%boundary_force)
      power = 0.5_wp*(net_force(before) + net_force(after))*after%motion(3:4, :)
      if (allocated(velocity)) power = power + 0.5_wp*mass_times(model, velocity &
        - state%motion(3:4, :))*(velocity + state%motion(3:4, :))
      associate (rows => model%controls%output%boundaries, motions => model%conditions%motions, &
        work => state%boundary_work)
        do i = 1, size(rows%where)
          if (rows%condition(i) == boundary_motion) cycle
          work(i) = work(i) + 0.5_wp*sum((former(1:2, i) + state%boundary_force(1:2, i)) &
            *after%motion(3:4, rows%where(i)))
        end do
        do i = 1, size(motions)
          if (is_active(motions(i), 0.5_wp*(state%time + time))) work(rows%motion_rows(i)) &
            = work(rows%motion_rows(i)) + power(motions(i)%direction, motions(i)%node)
        end do
      end associate
    end if
    if (.not. allocated(state%group_work)) return
    associate (nodes => group_nodes(model%controls%output%force_groups))
      state%group_work = state%group_work + 0.5_wp*sum((before%internal(:, nodes) &
        + after%internal(:, nodes))*after%motion(3:4, nodes), 1)
    end associate
  end subroutine count_step_boundaries

  !> Forces of the present instant, also where a run that goes on is the first to ask for them.
  subroutine find_forces(model, reaction, internal, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: reaction(:, :)   !! (2, n_node) of all degrees of freedom
    real(wp), intent(in) :: internal(:, :)   !! (2, n_node) divergence of stress
    type(state_t), intent(inout) :: state
    integer :: i

    if (allocated(state%boundary_work)) then
      call form_loads(model, state%motion, state%time, state%boundary_force)
      associate (rows => model%controls%output%boundaries%motion_rows, &
        motions => model%conditions%motions)
        do i = 1, size(motions)
          state%boundary_force(motions(i)%direction, rows(i)) = 0.0_wp
        end do
        do i = 1, size(motions)
          if (is_active(motions(i), state%time)) state%boundary_force(motions(i)%direction, &
            rows(i)) = reaction(motions(i)%direction, motions(i)%node)
        end do
      end associate
    end if
    if (allocated(state%group_work)) state%group_force = internal(:, &
      group_nodes(model%controls%output%force_groups))
  end subroutine find_forces

end module implicit_report_m
