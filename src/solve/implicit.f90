! SPDX-License-Identifier: MIT
!> The implicit driver: static equilibrium or generalised-alpha dynamics, step by step
!> (doc/theory/implicit.md, section 4).
module implicit_m
  use kinds_m, only : wp
  use clock_m, only : lap, phase_nodes, phase_output, phase_solver
  use contact_check_m, only : report_contact_end
  use element_mass_m, only : add_mass, mass_times
  use energies_m, only : energy_ratio
  use equations_m, only : equations_t, number_equations, find_equation, take_free
  use errors_m, only : error_t, raise, status_run
  use forces_m, only : trial_t, start_trial, assemble_forces
  use health_m, only : check_energy
  use implicit_report_m, only : reactions_work, report_step
  use linear_solver_m, only : report_t, solve_linear
  use log_m, only : write_log, warn, to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t
  use newton_m, only : outcome_t, find_equilibrium
  use prescribed_step_m, only : prescribe_step, prescribe_start, list_changes
  use progress_m, only : follow_progress
  use requests_m, only : requests_t, take_requests
  use sparse_m, only : sparse_t, start_matrix, compress_matrix
  use state_m, only : state_t
  use step_control_m, only : step_control_t, start_step_control, plan_step, grow_step, cut_step
  use tangent_m, only : step_t, new_acceleration, new_velocity, assemble_residual
  implicit none
  private
  public :: advance_implicit

  !> Energy ratio above which a failure is put down to it.
  real(wp), parameter :: gained = 1.1_wp

contains

  !> From the state at time zero to the end of the run. When a step finds no equilibrium the last converged state is
  !> written and stays.
  subroutine advance_implicit(model, state, monitor, reason, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    character(:), allocatable, intent(out) :: reason
    type(error_t), allocatable, intent(out) :: error
    type(step_control_t) :: control
    type(trial_t) :: trial
    type(step_t) :: step
    type(due_t) :: written
    type(requests_t) :: asked
    type(error_t), allocatable :: second
    real(wp), allocatable :: changes(:)
    logical :: last, stopped

    reason = 'termination time reached'
    call list_changes(model, changes)
    control = start_step_control(model%controls, changes)
    if (abs(control%dt - model%controls%implicit%dt) > 0.0_wp) call warn(monitor%log, 'the first step ' &
      //to_text(model%controls%implicit%dt)//' does not lie between DTMIN and DTMAX of ' &
      //'*CONTROL_IMPLICIT_AUTO; it is '//to_text(control%dt))
    call plan_step(control, 0.0_wp)
    call start_implicit(model, control%next, state, monitor, step, trial, error)
    if (allocated(error)) return
    last = .false.
    state%dt = control%next
    call report_step(model, state, step%old_force, .false., .false., monitor, written, error)
    do while (.not. last .and. .not. allocated(error))
      call take_step(model, state, monitor, control, step, trial, error)
      if (allocated(error)) exit
      last = control%is_last
      if (model%controls%end_cycle > 0) last = last .or. state%cycle >= model%controls%end_cycle
      call take_requests(state, energy_ratio(monitor%snapshot%energies), .true., monitor, asked, error)
      if (allocated(error)) exit
      if (asked%dump) call warn(monitor%log, 'a restart file was asked for: the implicit method ' &
        //'writes none')
      stopped = asked%stop .and. .not. last
      last = last .or. stopped
      if (stopped) reason = 'stopped on request'
      state%dt = control%dt
      if (.not. last) then
        call plan_step(control, state%time)
        state%dt = control%next - state%time
      end if
      call report_step(model, state, step%old_force, last, asked%plot, monitor, written, error)
      call follow_progress(monitor%progress, monitor%clock, state%cycle, .true., state%time, &
        state%dt_before, energy_ratio(monitor%snapshot%energies))
    end do
    if (allocated(error) .and. .not. last) then
      call report_step(model, state, step%old_force, .true., .false., monitor, written, second)
      call hint_at_energy(step, energy_ratio(monitor%snapshot%energies), error)
    end if
    call report_contact_end(model, state, monitor%log)
  end subroutine advance_implicit

  !> Forces and acceleration at time zero.
  subroutine start_implicit(model, dt, state, monitor, step, trial, error)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: dt !! first step
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(step_t), intent(out) :: step
    type(trial_t), intent(out) :: trial
    type(error_t), allocatable, intent(out) :: error

    associate (implicit => model%controls%implicit)
      step%is_dynamic = implicit%is_dynamic
      step%alpha_m = implicit%alpha_m
      step%alpha_f = implicit%alpha_f
      step%gamma = implicit%gamma
      step%beta = implicit%beta
      call write_log(monitor%log, 'implicit method: '//trim(merge('dynamic', 'static ', &
        implicit%is_dynamic))//', first step '//to_text(implicit%dt))
      if (implicit%is_dynamic) call write_log(monitor%log, '  '//implicit%scheme//': alpha_m ' &
        //to_text(implicit%alpha_m)//', alpha_f '//to_text(implicit%alpha_f)//', gamma ' &
        //to_text(implicit%gamma)//', beta '//to_text(implicit%beta))
    end associate
    allocate (state%acceleration(2, model%mesh%n_node), source=0.0_wp)
    if (step%is_dynamic) then
      call prescribe_start(model, dt, state)
    else
      state%motion(3:4, :) = 0.0_wp
    end if
    call start_trial(model, state, trial)
    call assemble_forces(model, state, 0.0_wp, .false., monitor%clock, trial)
    state%contacts = trial%contacts
    step%old_force = trial%internal - trial%contact - trial%external
    if (step%is_dynamic) call find_first_acceleration(model, monitor, step, state, error)
    call lap(monitor%clock, phase_solver)
  end subroutine start_implicit

  !> M a(0) = -f(0) on the free degrees of freedom; those of prescribed ones, which the state has, act on them.
  subroutine find_first_acceleration(model, monitor, step, state, error)
    type(model_t), intent(in) :: model
    type(monitor_t), intent(inout) :: monitor
    type(step_t), intent(in) :: step
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error
    type(equations_t) :: equations
    type(sparse_t) :: matrix
    type(report_t) :: report
    real(wp), allocatable :: x(:)
    integer :: i, k

    call number_equations(model, state, 0.0_wp, equations)
    call start_matrix(matrix, equations%n)
    call add_mass(model, 1.0_wp, merge(equations%number, 0, equations%number <= equations%n_free), &
      matrix)
    matrix%n = equations%n_free
    call compress_matrix(matrix)
    allocate (x(equations%n_free))
    call solve_linear(matrix, -take_free(equations, step%old_force &
      + mass_times(model, state%acceleration)), x, report)
    if (.not. report%is_solved) then
      call raise(error, 'no acceleration at time zero: '//report%message, status_run)
      return
    end if
    call write_log(monitor%log, '  equations: '//to_text(equations%n_free)//' free, ' &
      //to_text(equations%n - equations%n_free)//' prescribed; mass solved by '//report%method)
    do i = 1, model%mesh%n_node
      do k = 1, 2
        if (equations%number(k, i) > 0 .and. equations%number(k, i) <= equations%n_free) &
          state%acceleration(k, i) = x(equations%number(k, i))
      end do
    end do
  end subroutine find_first_acceleration

  !> One step, tried again with a shorter one while that is allowed.
  subroutine take_step(model, state, monitor, control, step, trial, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(step_control_t), intent(inout) :: control
    type(step_t), intent(inout) :: step
    type(trial_t), intent(inout) :: trial
    type(error_t), allocatable, intent(out) :: error
    type(outcome_t) :: outcome
    type(trial_t) :: attempt
    logical :: may_retry

    do
      call try_step(model, state, monitor, control%next, step, attempt, outcome)
      if (outcome%converged) exit
      may_retry = .false.
      ! A body that nothing holds at the start of the step is none the better for a shorter one.
      if (outcome%singular_equation == 0 .or. outcome%iterations > 1) &
        call cut_step(control, state%time, may_retry)
      if (.not. may_retry) then
        call raise_failure(model, state, step, outcome, error)
        return
      end if
      call plan_step(control, state%time)
    end do
    call commit(model, state, step, attempt, trial)
    call grow_step(control, step%dt, outcome%iterations)
    call lap(monitor%clock, phase_nodes)
  end subroutine take_step

  !> A step to `time`: full iterations or searched ones, as the step before, then the other kind.
  subroutine try_step(model, state, monitor, time, step, attempt, outcome)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(monitor_t), intent(inout) :: monitor
    real(wp), intent(in) :: time
    type(step_t), intent(inout) :: step
    type(trial_t), intent(inout) :: attempt
    type(outcome_t), intent(out) :: outcome
    integer :: i

    step%time = time
    step%dt = time - state%time
    call number_equations(model, state, 0.5_wp*(state%time + time), step%equations)
    call prescribe_step(model, state, time, step%equations, step%prescribed)
    do i = 1, 2
      call start_trial(model, state, attempt)
      call find_equilibrium(model, state, step, monitor%log, monitor%clock, attempt, outcome)
      if (outcome%converged) return
      call write_log(monitor%log, 'step to '//to_text(time)//': '//outcome%reason)
      ! The first iteration is not searched: one that fails there fails again.
      if (outcome%iterations <= 1) return
      step%searches = .not. step%searches
    end do
  end subroutine try_step

  !> The trial becomes the state; works of contact, loads and prescribed motion by the trapezoidal rule.
  subroutine commit(model, state, step, attempt, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(step_t), intent(inout) :: step
    type(trial_t), intent(inout) :: attempt
    type(trial_t), intent(inout) :: trial    !! of the state before; of the new state on return
    real(wp), allocatable :: acceleration(:, :), velocity(:, :)
    integer :: i

    state%external_work = state%external_work + 0.5_wp*sum((trial%external + attempt%external) &
      *attempt%motion(3:4, :))
    do i = 1, size(model%contacts)
      associate (nodes => state%contacts(i)%nodes)
        attempt%contacts(i)%energy = state%contacts(i)%energy - 0.5_wp &
          *sum((state%contacts(i)%force + attempt%contacts(i)%force)*attempt%motion(3:4, nodes))
      end associate
    end do
    if (step%is_dynamic) then
      acceleration = new_acceleration(state, step, attempt)
      velocity = new_velocity(state, step, acceleration)
      state%external_work = state%external_work + reactions_work(model, step%equations, trial, attempt, &
        reshape([state%motion(3:4, :), velocity], [2, size(velocity, 2), 2]))
      state%motion(3:4, :) = velocity
      state%acceleration = acceleration
    else
      state%external_work = state%external_work + reactions_work(model, step%equations, trial, attempt)
    end if
    state%motion(1:2, :) = attempt%motion(1:2, :)
    state%elements = attempt%elements
    state%contacts = attempt%contacts
    step%old_force = attempt%internal - attempt%contact - attempt%external
    trial = attempt
    state%time = step%time
    state%dt_before = step%dt
    state%cycle = state%cycle + 1
  end subroutine commit

  !> The error that ends the run; a free motion is named by node and direction.
  subroutine raise_failure(model, state, step, outcome, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(outcome_t), intent(in) :: outcome
    type(error_t), allocatable, intent(out) :: error
    integer :: node, direction

    if (outcome%singular_equation > 0) then
      call find_equation(step%equations, outcome%singular_equation, node, direction)
      call raise(error, 'the stiffness is singular at time '//to_text(state%time)//': node ' &
        //to_text(model%mesh%node_id(node))//' moves freely in ' &
        //merge('x', 'y', direction == 1)//'; the model needs constraints, contact or inertia ' &
        //'(IMASS = 1) that hold it', status_run)
    else
      call raise(error, 'no equilibrium at time '//to_text(step%time)//' with the step ' &
        //to_text(step%dt)//': '//outcome%reason//'; the last converged state is that of time ' &
        //to_text(state%time), status_run)
    end if
  end subroutine raise_failure

  !> Say so where a run that failed had gained energy before.
  subroutine hint_at_energy(step, ratio, error)
    type(step_t), intent(in) :: step
    real(wp), intent(in) :: ratio !! of the last converged state
    type(error_t), intent(inout) :: error

    if (.not. step%is_dynamic .or. ratio <= gained) return
    error%message = error%message//'; its energy ratio is '//to_text(ratio) &
      //': the steps gain energy (shorter steps, or a spectral radius below 1)'
  end subroutine hint_at_energy

end module implicit_m
