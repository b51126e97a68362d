! SPDX-License-Identifier: MIT
!> What the implicit driver writes: motion, velocity and acceleration of one instant, energies
!> with the consistent mass.
module implicit_report_m
  use contact_judging_m, only : judge_contacts
  use contact_softness_m, only : follow_softness
  use history_filling_m, only : fill_boundaries, fill_history_elements, fill_sections, &
    fill_reactions
  use implicit_boundary_m, only : find_forces
  use history_tables_m, only : table_matsum, table_rcforc, table_sleout, table_spcforc, &
    table_contact, table_elout, table_bndout, table_nodfor, table_secforc
  use block_state_m, only : block_state_t
  use kinds_m, only : wp
  use clock_m, only : lap, phase_output
  use element_mass_m, only : mass_times, sum_part_motion
  use element_state_m, only : add_part_energies
  use energies_m, only : energy_ratio, total_energy
  use equations_m, only : equations_t
  use errors_m, only : error_t
  use health_m, only : check_energy, check_ratio, check_radii, judge_energies, judge_ratio, &
    judge_contact, made_by_forces, unaccounted, dissipated
  use implicit_forces_m, only : trial_t, net_force, cut_sections
  use implicit_memory_m, only : implicit_memory_t
  use implicit_tangent_m, only : step_t
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t, find_due, any_due, write_due
  use output_schedule_m, only : output_reach
  use progress_m, only : show_progress
  use snapshot_m, only : snapshot_t
  use snapshot_filling_m, only : fill_energies, fill_parts, fill_interfaces, fill_plot
  use state_m, only : state_t
  implicit none
  private
  public :: report_step, reactions_work, held_energy, spent_energy

contains

  !> Write what is due; of a state that was reported before, only what was not written then.
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
    real(wp) :: dt

    dt = output_reach(model%controls, state%dt)
    due = find_due(monitor, state%time, dt, state%cycle == 0 .or. last)
    due%plot = due%plot .or. (plots .and. monitor%has_plot)
    if (state%cycle == monitor%snapshot%cycle) due = without(due, memory%written)
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
      if (state%cycle == 0) then
        state%initial_energy = total_energy(shot%energies)
        shot%energies%initial = state%initial_energy
      end if
      call follow_softness(model, shot%parts, monitor%bodies, state)
      if (due%tables(table_matsum)) call fill_consistent_parts(model, state%elements, shot)
      if (any(due%tables([table_rcforc, table_sleout, table_contact]))) &
        call fill_interfaces(model, state, shot)
      if (due%tables(table_spcforc)) call fill_reactions(model, &
        force + mass_times(model, shot%acceleration), shot)
      if (any(due%tables([table_bndout, table_nodfor]))) then
        call find_forces(model, force + mass_times(model, shot%acceleration), &
          memory%trial%internal, state)
        call fill_boundaries(state, shot)
      end if
      if (due%tables(table_secforc)) then
        call cut_sections(model, memory%trial, state)
        call fill_sections(model, state, shot)
      end if
      if (due%tables(table_elout)) call fill_history_elements(model, state, shot)
      if (due%plot) call fill_plot(model, state, shot)
      if (any(due%tables([table_sleout, table_contact]))) call judge_contacts(model, state, &
        due%plot, monitor%rows, shot)
      call write_due(model, due, dt, monitor, error)
      if (due%plot .and. .not. allocated(error)) &
        call show_progress(monitor%progress, monitor%clock, state%cycle, state%time, state%dt, &
        energy_ratio(shot%energies), 'write vtkhdf state')
      if (.not. allocated(error)) call check_energy(model%controls, shot%energies, made_by_forces, &
        error)
      if (.not. allocated(error)) call check_ratio(shot%energies, &
        spent_energy(state, memory%step), cause_of(memory%step), state%cycle, state%time, &
        monitor%told_ratio, monitor%log)
      call check_radii(model, state, monitor%told_radii, monitor%log)
      if (last .and. .not. allocated(error)) then
        call judge_contact(shot%energies, monitor%log)
        call judge_energies(shot%energies, monitor%log)
        call judge_ratio(shot%energies, spent_energy(state, memory%step), &
          cause_of(memory%step), monitor%log)
      end if
    end associate
    call lap(monitor%clock, phase_output)
  end subroutine report_step

  !> What is due and was not written.
  pure function without(due, written) result(left)
    type(due_t), intent(in) :: due, written
    type(due_t) :: left

    left%plot = due%plot .and. .not. written%plot
    left%tables = due%tables .and. .not. written%tables
  end function without

  !> Parts with the consistent mass.
  subroutine fill_consistent_parts(model, elements, shot)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    type(snapshot_t), intent(inout) :: shot
    real(wp) :: kinetic(size(model%parts)), momentum(2, size(model%parts))
    integer :: i

    call fill_parts(model, elements, shot)
    call sum_part_motion(model, shot%velocity, kinetic, momentum)
    do i = 1, size(model%parts)
      shot%parts(i)%kinetic = kinetic(i)
      shot%parts(i)%momentum = momentum(:, i)
    end do
  end subroutine fill_consistent_parts

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

  !> Where missing energy has gone, in words.
  pure function cause_of(step) result(words)
    type(step_t), intent(in) :: step
    character(:), allocatable :: words

    words = unaccounted
    if (step%is_dynamic .and. step%gamma > 0.5_wp*(1.0_wp + epsilon(step%gamma))) words = dissipated
  end function cause_of

  !> Work of the forces that hold prescribed degrees of freedom to their curves: of inertia, change
  !> of momentum times mean velocity, which is the kinetic energy that they gain, also in a blow; of
  !> the others by the trapezoidal rule.
  function reactions_work(model, equations, before, after, velocities) result(work)
    type(model_t), intent(in) :: model
    type(equations_t), intent(in) :: equations
    type(trial_t), intent(in) :: before, after
    real(wp), intent(in), optional :: velocities(:, :, :) !! (2, n_node, 2) v(n) and v(n+1); absent:
                                                          !! static
    real(wp) :: work

    work = 0.0_wp
    if (equations%n == equations%n_free) return
    work = 0.5_wp*sum((net_force(before) + net_force(after))*after%motion(3:4, :), &
      equations%number > equations%n_free)
    if (.not. present(velocities)) return
    work = work + 0.5_wp*sum(mass_times(model, velocities(:, :, 2) - velocities(:, :, 1)) &
      *(velocities(:, :, 1) + velocities(:, :, 2)), equations%number > equations%n_free)
  end function reactions_work

end module implicit_report_m
