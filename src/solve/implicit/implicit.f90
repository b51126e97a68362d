! SPDX-License-Identifier: MIT
!> Implicit driver: static equilibrium or generalised-alpha dynamics, step by step
!> (doc/theory/implicit.md, section 4). Output: motion, velocity and acceleration of one instant,
!> energies with the consistent mass; forces on boundaries and of node groups with their work
!> (bndout, nodfor).
module implicit_m
  use clock_m, only : lap, phase_nodes, phase_output
  use contact_reports_m, only : report_contact_end
  use contact_law_m, only : measure_springs
  use nodal_forces_m, only : count_step
  use contact_state_m, only : has_offsets
  use contacts_m, only : breaks
  use cut_forces_m, only : store_cut_chunks
  use spring_gaps_m, only : update_offsets
  use element_mass_m, only : mass_times, sum_part_motion
  use element_state_m, only : add_part_energies
  use equations_m, only : number_equations, prescribe_step
  use errors_m, only : error_t, raise, status_run
  use friction_m, only : has_slipped
  use health_m, only : check_static_step, limit_point_advice, check_energy, check_ratio, &
    check_radii, &
    warn_of_energies, warn_of_contact_energy, created_by_forces, energy_unaccounted, &
    scheme_dissipation
  use history_filling_m, only : fill_reactions
  use history_tables_m, only : table_matsum, table_spcforc, table_bndout, table_nodfor, &
    table_secforc, table_rbdout
  use implicit_forces_m, only : trial_t, start_trial, net_force, net_body_force, step_t, rates_t, &
    find_rates, cut_sections
  use implicit_start_m, only : implicit_memory_t, begin_steps, plan_next, has_ended, &
    step_control_t, plan_step, grow_step, cut_step
  use implicit_works_m, only : reactions_work, body_reactions_work, add_boundary_work, find_forces
  use interface_m, only : break_at_end
  use kinds_m, only : wp
  use law_state_m, only : tie_memory_t
  use loads_m, only : damping_rates
  use log_m, only : write_log, warn, to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t, find_due, record_energies, write_instant, output_reach
  use newton_m, only : outcome_t, find_equilibrium, freedom_words
  use progress_m, only : update_progress
  use requests_m, only : find_early_end, requests_t, read_requests
  use restart_m, only : write_restarts
  use restart_plan_m, only : wanted_files
  use snapshot_filling_m, only : fill_energies, fill_parts, fill_bodies
  use snapshot_m, only : energy_ratio
  use state_m, only : state_t
  implicit none
  private
  public :: advance_implicit

  !> Energy ratio above which a failure is attributed to growing energy.
  real(wp), parameter :: gained = 1.1_wp

contains

  !> Advance from the initial state to the end of the run. When a step finds no equilibrium, the
  !> last converged state is written.
  subroutine advance_implicit(model, state, monitor, reason, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    character(:), allocatable, intent(out) :: reason
    type(error_t), allocatable, intent(out) :: error
    type(implicit_memory_t) :: memory
    type(requests_t) :: asked
    type(error_t), allocatable :: second
    logical :: last

    reason = 'termination time reached'
    call begin_steps(model, state, monitor, memory, last, error)
    if (allocated(error) .or. monitor%only_checks) return
    if (monitor%restarts%is_restart) call find_early_end(model, state, last, reason)
    call report_step(model, state, last, .false., monitor, memory, error)
    do while (.not. last .and. .not. allocated(error))
      call advance_step(model, state, monitor, memory%control, memory%step, memory%trial, error)
      if (allocated(error)) exit
      call apply_requests(model, state, monitor, memory, asked, last, reason, error)
      if (allocated(error)) exit
      if (asked%stop) reason = 'stopped on request'
      call report_step(model, state, last, asked%plot, monitor, memory, error)
      call update_progress(monitor%progress, monitor%clock, state%cycle, .true., state%time, &
        state%dt_before, memory%ratio)
    end do
    if (allocated(error) .and. .not. last) then
      call report_step(model, state, .true., .false., monitor, memory, second)
      if (error%status == status_run .and. memory%step%is_dynamic .and. memory%ratio > gained) &
        error%message = error%message//'; energy ratio '//to_text(memory%ratio) &
        //': the time integration gains energy (use smaller steps or a spectral radius below 1)'
    end if
    call report_contact_end(model, state, monitor%log)
  end subroutine advance_implicit

  !> After a step: read requests, plan the next step, and write due restart files. A restarted run
  !> reports the state as this one is about to.
  subroutine apply_requests(model, state, monitor, memory, asked, last, reason, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(implicit_memory_t), intent(inout) :: memory
    type(requests_t), intent(out) :: asked  !! a stop only where a step is left
    logical, intent(out) :: last            !! the state is the last one
    character(:), allocatable, intent(inout) :: reason !! reason of the end
    type(error_t), allocatable, intent(inout) :: error
    type(step_control_t) :: planned
    logical :: ends, wanted(2) !! numbered_file, running_file

    last = .false.
    call read_requests(state, memory%ratio, .true., monitor, asked, error)
    if (allocated(error)) return
    last = has_ended(model, state, memory%control)
    call find_early_end(model, state, last, reason)
    asked%stop = asked%stop .and. .not. last
    asked%signalled = asked%signalled .and. .not. last
    last = last .or. asked%stop
    planned = memory%control
    call plan_next(model, last, state, planned, ends)
    wanted = wanted_files(monitor%restarts, state%cycle, asked%dump, ends, asked%signalled)
    if (any(wanted)) call cut_sections(model, memory%trial, state)
    call write_restarts(wanted, state, monitor, error, memory)
    last = last .and. .not. allocated(error)
    memory%control = planned
  end subroutine apply_requests

  !> One step, repeated with a smaller one while that is allowed.
  subroutine advance_step(model, state, monitor, control, step, trial, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(step_control_t), intent(inout) :: control
    type(step_t), intent(inout) :: step
    type(trial_t), intent(inout) :: trial
    type(error_t), allocatable, intent(out) :: error
    type(outcome_t) :: outcome
    type(trial_t) :: attempt
    type(tie_memory_t), allocatable :: ties(:) !! at the start of the step
    real(wp) :: held, work(2) !! absorbed energy before, and external work before and after the
                              !! step, J/m
    logical :: may_retry

    if (any(breaks(model%contacts))) ties = state%contacts%ties
    do
      if (allocated(ties)) state%contacts%ties = ties
      call try_step(model, state, monitor, control%next, step, attempt, outcome)
      if (outcome%converged) exit
      may_retry = .false.
      ! A singular stiffness at the start of a step needs constraints, not a smaller step.
      if (outcome%singular_equation == 0 .or. outcome%iterations > 1) &
        call cut_step(control, state%time, may_retry)
      if (.not. may_retry) then
        if (allocated(ties)) state%contacts%ties = ties
        call raise_failure(model, state, step, outcome, error)
        return
      end if
      call plan_step(control, state%time)
    end do
    held = absorbed_energy(model, state)
    ! Work of all external actions.
    work(1) = state%external_work + sum(state%contacts%interference%work)
    call accept_trial(model, state, step, attempt, trial)
    work(2) = state%external_work + sum(state%contacts%interference%work)
    if (.not. step%is_dynamic) call check_static_step(work, [held, absorbed_energy(model, state)], &
      released_energy(state, step), state%cycle, state%time, monitor%log)
    ! First negative pivot in the stiffness of an equilibrium, at the start of the step.
    if (outcome%began_negative .and. .not. (step%is_dynamic .or. step%began_negative)) &
      call warn(monitor%log, 'the stiffness at the end of step '//to_text(state%cycle - 1) &
      //', time '//to_text(state%time - step%dt)//', has its first negative pivot: the ' &
      //'equilibrium is unstable beyond a limit point or bifurcation; ' &
      //limit_point_advice)
    step%began_negative = outcome%began_negative
    call grow_step(control, step%dt, outcome%iterations)
    call lap(monitor%clock, phase_nodes)
  end subroutine advance_step

  !> One step to `time`. Points that slipped in the previous step slip in the first iteration; if
  !> that fails or leaves a singular stiffness, all points stick first, with full or searched
  !> iterations as in the previous step, then with the other kind.
  subroutine try_step(model, state, monitor, time, step, attempt, outcome)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state !! ties that fail in the step
    type(monitor_t), intent(inout) :: monitor
    real(wp), intent(in) :: time
    type(step_t), intent(inout) :: step
    type(trial_t), intent(inout) :: attempt
    type(outcome_t), intent(out) :: outcome
    integer :: i, k, n_new
    logical :: broke

    step%time = time
    step%dt = time - state%time
    call number_equations(model, state, 0.5_wp*(state%time + time), step%equations)
    call prescribe_step(model, state, time, step%equations, step%prescribed)
    i = merge(0, 1, has_slipped(state%contacts))
    do while (i <= 2)
      step%starts_slipping = i == 0
      call start_trial(model, state, attempt)
      call find_equilibrium(model, state, step, monitor%log, monitor%clock, attempt, outcome)
      if (outcome%converged) then
        ! Ties that fail in equilibrium stay failed, and the equilibrium of the same step is sought
        ! again.
        broke = .false.
        do k = 1, size(model%contacts)
          call break_at_end(model%contacts(k), time, attempt%contacts(k), n_new)
          if (n_new == 0) cycle
          broke = .true.
          call write_log(monitor%log, 'step to '//to_text(time)//': failed ties of ' &
            //'interface '//to_text(model%contacts(k)%id)//': '//to_text(n_new))
          state%contacts(k)%ties = attempt%contacts(k)%ties
        end do
        if (.not. broke) return
        cycle
      end if
      call write_log(monitor%log, 'step to '//to_text(time)//': '//outcome%reason)
      if (i > 0) then
        ! The first iteration has no line search, so a failure there would repeat.
        if (outcome%iterations <= 1) return
        step%searches = .not. step%searches
      end if
      i = i + 1
    end do
  end subroutine try_step

  !> Accept the trial as the state, with works of contact, loads, damping and prescribed motion by
  !> the trapezoidal rule.
  subroutine accept_trial(model, state, step, attempt, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(step_t), intent(inout) :: step
    type(trial_t), intent(inout) :: attempt
    type(trial_t), intent(inout) :: trial    !! of the previous state in, of the new one out
    type(rates_t) :: rates
    real(wp) :: bodies(3, size(state%rigids)) !! work of their prescribed motions
    integer :: i

    state%external_work = state%external_work + 0.5_wp*sum((trial%external + attempt%external) &
      *attempt%motion(3:4, :)) + 0.5_wp*sum((trial%body_load + attempt%body_load) &
      *(attempt%bodies - trial%bodies))
    do i = 1, size(model%contacts)
      associate (memory => attempt%contacts(i))
        call count_step(attempt%motion, state%contacts(i), memory)
        if (has_offsets(memory)) call update_offsets(model%contacts(i), memory)
        ! Energy that springs gain from decaying offsets is created by contact.
        call measure_springs(memory)
        memory%monitor%balance = memory%energy - memory%monitor%stored
      end associate
    end do
    if (step%is_dynamic) then
      call find_rates(model, state, step, attempt, rates)
      if (allocated(attempt%damping)) then
        attempt%damping = mass_times(model, state%mass, rates%velocity, damping_rates(model, &
          step%time))
        state%damping_work = state%damping_work + 0.5_wp*sum((trial%damping + attempt%damping) &
          *attempt%motion(3:4, :))
      end if
    end if
    state%external_work = state%external_work + reactions_work(model, step%equations, trial, &
      attempt, state, rates%velocity)
    bodies = body_reactions_work(step, net_body_force(model, state, attempt), attempt%bodies &
      - trial%bodies, rates, state%rigids)
    state%external_work = state%external_work + sum(bodies)
    call add_boundary_work(model, trial, attempt, step%time, rates%velocity, bodies, state)
    if (step%is_dynamic) then
      state%motion(3:4, :) = rates%velocity
      state%acceleration = rates%acceleration
    end if
    do i = 1, size(state%rigids)
      state%rigids(i)%displacement = attempt%bodies(:, i)
      if (.not. step%is_dynamic) cycle
      state%rigids(i)%velocity = rates%body_velocity(:, i)
      state%rigids(i)%acceleration = rates%body_acceleration(:, i)
    end do
    trial = attempt
    ! Element values before the step, for the forces of cross sections.
    if (allocated(state%cut_force)) call store_cut_chunks(model, state%elements, trial%before)
    state%motion(1:2, :) = attempt%motion(1:2, :)
    state%elements = attempt%elements
    state%contacts = attempt%contacts
    step%old_force = net_force(attempt)
    step%old_bodies = net_body_force(model, state, attempt)
    state%time = step%time
    state%dt_before = step%dt
    state%cycle = state%cycle + 1
  end subroutine accept_trial

  !> Raise the error that ends the run; a singular stiffness is reported with node and direction.
  subroutine raise_failure(model, state, step, outcome, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(outcome_t), intent(in) :: outcome
    type(error_t), allocatable, intent(out) :: error

    if (outcome%singular_equation > 0) then
      call raise(error, 'the stiffness is singular at time '//to_text(state%time)//': ' &
        //freedom_words(model, step%equations, outcome%singular_equation, &
        ' is free to move in x', ' is free to move in y', ' is free to turn') &
        //'; add constraints, contact or inertia (IMASS 1)', status_run)
    else
      call raise(error, 'no equilibrium at time '//to_text(step%time)//' with the step ' &
        //to_text(step%dt)//': '//outcome%reason//'; the last converged state is that of time ' &
        //to_text(state%time), status_run)
    end if
  end subroutine raise_failure

  !> Write due outputs; of a state that was reported before, only outputs that were not written
  !> then. Updates the energy ratio.
  subroutine report_step(model, state, last, plots, monitor, memory, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, intent(in) :: last
    logical, intent(in) :: plots          !! a plot state is requested
    type(monitor_t), intent(inout) :: monitor
    type(implicit_memory_t), intent(inout) :: memory !! `written`: outputs of the previous report
                                                     !! in, of this one out
    type(error_t), allocatable, intent(out) :: error
    type(due_t) :: due
    real(wp) :: dt, kinetic(size(model%parts)), momentum(2, size(model%parts))
    character(:), allocatable :: cause !! cause of a missing energy

    dt = output_reach(model%controls, state%dt)
    due = find_due(monitor, state%time, dt, state%cycle == 0 .or. last)
    due%plot = due%plot .or. (plots .and. monitor%has_plot)
    if (state%cycle == monitor%snapshot%cycle) then
      due%plot = due%plot .and. .not. memory%written%plot
      due%tables = due%tables .and. .not. memory%written%tables
    end if
    memory%written = due
    if (.not. (due%plot .or. any(due%tables))) return
    associate (shot => monitor%snapshot, force => memory%step%old_force)
      shot%time = state%time
      shot%cycle = state%cycle
      shot%dt = state%dt
      shot%displacement = state%motion(1:2, :)
      shot%velocity = state%motion(3:4, :)
      shot%acceleration = state%acceleration
      call fill_energies(model, state, [0.0_wp, 0.0_wp], shot)
      shot%energies%kinetic = 0.5_wp*sum(shot%velocity*mass_times(model, state%mass, &
        shot%velocity))
      call record_energies(model, .true., state, monitor)
      if (due%tables(table_matsum)) then
        call fill_parts(model, state, shot)
        call sum_part_motion(model, shot%velocity, kinetic, momentum)
        where (.not. model%materials(model%parts%material)%is_rigid)
          shot%parts%kinetic = kinetic
          shot%parts%momentum(1) = momentum(1, :)
          shot%parts%momentum(2) = momentum(2, :)
        end where
      end if
      if (due%tables(table_spcforc)) call fill_reactions(model, &
        force + mass_times(model, state%mass, shot%acceleration), shot)
      if (any(due%tables([table_bndout, table_nodfor]))) call find_forces(model, &
        force + mass_times(model, state%mass, shot%acceleration), memory%step%old_bodies, &
        memory%trial, state)
      if (due%tables(table_rbdout)) call fill_bodies(state%rigids, 0.0_wp, shot)
      if (due%tables(table_secforc)) call cut_sections(model, memory%trial, state)
      memory%ratio = energy_ratio(shot%energies)
      call write_instant(model, due, dt, memory%ratio, state, monitor, error)
      if (.not. allocated(error)) call check_energy(model%controls, shot%energies, &
        created_by_forces, error)
      cause = energy_unaccounted
      if (memory%step%is_dynamic .and. memory%step%gamma > 0.5_wp*(1.0_wp + epsilon(1.0_wp))) &
        cause = scheme_dissipation
      if (.not. allocated(error)) call check_ratio(shot%energies, &
        released_energy(state, memory%step), cause, state%cycle, state%time, monitor%warned_ratio, &
        monitor%log)
      call check_radii(model, state, monitor%warned_radii, monitor%log)
      if (last .and. .not. allocated(error)) then
        call warn_of_contact_energy(shot%energies, monitor%log)
        call warn_of_energies(shot%energies, released_energy(state, memory%step), cause, &
          monitor%log)
      end if
    end associate
    call lap(monitor%clock, phase_output)
  end subroutine report_step

  !> Energy that a body at rest has stored or dissipated, J/m.
  function absorbed_energy(model, state) result(held)
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
  end function absorbed_energy

  !> Admissible loss of energy, J/m: in statics the energy of springs and pre-stressed bodies before
  !> the first equilibrium.
  pure function released_energy(state, step) result(spent)
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    real(wp) :: spent

    spent = merge(0.0_wp, max(0.0_wp, state%initial_energy), step%is_dynamic)
  end function released_energy

end module implicit_m
