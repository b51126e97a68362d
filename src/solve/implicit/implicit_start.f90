! SPDX-License-Identifier: MIT
!> Memory of the implicit driver from step to step besides the state, and the start at time zero or
!> from a restart file. Step lengths: constant, or growing and shrinking with the number of
!> iterations; a step is divided where the equations change (start or end of a prescribed motion).
module implicit_start_m
  use clock_m, only : lap, phase_solver
  use contact_reports_m, only : report_contact_start
  use contact_step_limit_m, only : contact_ratios
  use contact_law_m, only : measure_springs
  use contact_state_m, only : contact_state_t
  use controls_m, only : controls_t
  use cut_forces_m, only : store_cut_chunks
  use damping_m, only : of_stuck
  use element_mass_m, only : mass_times
  use equations_m, only : equations_t, number_equations, free_entries, prescribe_start, &
    list_changes, add_free_mass
  use errors_m, only : error_t, raise, status_run
  use implicit_forces_m, only : trial_t, start_trial, net_force, net_body_force, cut_sections, &
    assemble_forces, step_t
  use hanging_nodes_m, only : move_hanging_nodes
  use kinds_m, only : wp
  use friction_m, only : has_decay
  use linear_solver_m, only : report_t, solve_linear
  use loads_m, only : damping_rates
  use log_m, only : log_t, write_log, warn, to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t
  use restart_file_m, only : close_restart
  use restart_m, only : write_restarts
  use restart_plan_m, only : wanted_files
  use rigid_equations_m, only : spread_rates, add_rigid_diagonal
  use rigid_state_m, only : body_scales
  use sparse_m, only : sparse_t, start_matrix, compress_matrix
  use state_m, only : state_t
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: step_control_t, start_step_control, plan_step, grow_step, cut_step, round_off, &
    implicit_memory_t, begin_steps, plan_next, has_ended

  !> Growth of a step with few iterations, and reduction of a failed one.
  real(wp), parameter :: growth = 1.5_wp, cut = 0.5_wp
  !> Share of a step below which no remainder is left before a time at which a step must end.
  real(wp), parameter :: least_rest = 0.25_wp
  !> Share of a step by which a time may be missed.
  real(wp), parameter :: round_off = 1.0e-9_wp

  !> Step lengths of a run.
  type, extends(visited_t) :: step_control_t
    real(wp) :: dt = 0.0_wp        !! of a whole step, s
    real(wp) :: target = 0.0_wp    !! end of the present whole step, s
    real(wp) :: next = 0.0_wp      !! end of the next step: `target`, or where the equations change,
                                   !! s
    real(wp) :: end_time = 0.0_wp
    logical :: is_last = .false.   !! the next step ends the run
    logical :: is_automatic = .false.
    real(wp) :: least = 0.0_wp     !! shortest step
    real(wp) :: most = 0.0_wp      !! longest step
    integer :: few = 0             !! iterations below which the step grows
    integer :: many = 0            !! iterations above which it shrinks
    real(wp), allocatable :: changes(:) !! times at which the equations change, s
  contains
    procedure :: visit => visit_control
  end type step_control_t

  !> Memory of the driver.
  type, extends(visited_t) :: implicit_memory_t
    type(step_control_t) :: control
    type(step_t) :: step
    type(trial_t) :: trial     !! forces of the state
    type(due_t) :: written     !! outputs of the last reported state
    real(wp) :: ratio = 1.0_wp !! last known energy ratio
  contains
    procedure :: visit => visit_memory
  end type implicit_memory_t

contains

  !> Step control of the deck; the first step is limited to the shortest and longest step.
  pure function start_step_control(controls, changes) result(control)
    type(controls_t), intent(in) :: controls
    real(wp), intent(in) :: changes(:) !! times at which the equations change, in any order
    type(step_control_t) :: control

    control%changes = changes
    associate (implicit => controls%implicit)
      control%dt = implicit%dt
      control%end_time = controls%end_time
      control%is_automatic = implicit%is_automatic
      control%least = implicit%dt_least
      if (.not. control%least > 0.0_wp) control%least = 1.0e-3_wp*implicit%dt
      control%most = implicit%dt_most
      if (.not. control%most > 0.0_wp) control%most = 10.0_wp*implicit%dt
      control%most = max(control%most, control%least)
      if (control%is_automatic) control%dt = min(max(control%dt, control%least), control%most)
      control%few = implicit%best_iterations - implicit%iteration_window
      ! A step with the largest number of iterations is a hard one too.
      control%many = max(control%few, min(implicit%best_iterations + implicit%iteration_window, &
        implicit%max_iteration - 1))
    end associate
  end function start_step_control

  !> End of the next step. The last step is stretched or shortened to the end time. A remainder at a
  !> change of the equations is a step of its own with constant steps, a whole step with automatic
  !> ones; a step that would leave a small remainder before a change goes half of the way.
  pure subroutine plan_step(control, time)
    type(step_control_t), intent(inout) :: control
    real(wp), intent(in) :: time !! start of the step
    real(wp) :: change

    associate (missed => round_off*control%dt)
      if (time >= control%target - missed) then
        control%target = time + control%dt
        if (control%target >= control%end_time - missed) control%target = control%end_time
      end if
      control%next = control%target
      change = minval(control%changes, mask=control%changes > time + missed)
      if (change < control%target - missed) then
        control%next = change
      else if (control%is_automatic .and. change > control%target + missed .and. &
        change < control%target + least_rest*control%dt) then
        control%next = time + 0.5_wp*(change - time)
      end if
      if (control%is_automatic) control%target = control%next
      control%is_last = control%next >= control%end_time
    end associate
  end subroutine plan_step

  !> Adapt the step after a converged step of length `dt`. Few iterations in a shortened step do not
  !> count.
  pure subroutine grow_step(control, dt, iterations)
    type(step_control_t), intent(inout) :: control
    real(wp), intent(in) :: dt
    integer, intent(in) :: iterations

    if (.not. control%is_automatic) return
    if (iterations <= control%few .and. dt >= (1.0_wp - round_off)*control%dt) &
      control%dt = min(control%most, growth*control%dt)
    if (iterations > control%many) control%dt = max(control%least, cut*control%dt)
  end subroutine grow_step

  !> Reduce the step after a failed step from `time`, if that is allowed.
  pure subroutine cut_step(control, time, may_retry)
    type(step_control_t), intent(inout) :: control
    real(wp), intent(in) :: time
    logical, intent(out) :: may_retry
    real(wp) :: tried

    tried = control%next - time
    may_retry = control%is_automatic .and. tried > (1.0_wp + round_off)*control%least
    if (.not. may_retry) return
    control%dt = max(control%least, cut*tried)
    control%target = time
  end subroutine cut_step

  !> Visit the components that deck and plan do not give.
  subroutine visit_control(self, visitor)
    class(step_control_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('dt', self%dt)
    call visitor%expect('dt', self%dt > 0.0_wp, 'a step that is not positive')
    call visitor%visit('target', self%target)
  end subroutine visit_control

  !> Visit the components that the next step needs.
  subroutine visit_memory(self, visitor)
    class(implicit_memory_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%part('control', self%control)
    call visitor%part('step', self%step)
    call visitor%part('trial', self%trial)
    call visitor%visit('ratio', self%ratio)
  end subroutine visit_memory

  !> Set up the memory up to the first report, and plan the first step.
  subroutine begin_steps(model, state, monitor, memory, last, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(implicit_memory_t), intent(out) :: memory
    logical, intent(out) :: last       !! no step is left
    type(error_t), allocatable, intent(out) :: error
    type(step_control_t) :: planned
    real(wp), allocatable :: changes(:)
    logical :: ends, wanted(2) !! numbered_file, running_file

    call list_changes(model, changes)
    memory%control = start_step_control(model%controls, changes)
    associate (implicit => model%controls%implicit, step => memory%step)
      step%is_dynamic = implicit%is_dynamic
      step%alpha_m = implicit%alpha_m
      step%alpha_f = implicit%alpha_f
      step%gamma = implicit%gamma
      step%beta = implicit%beta
    end associate
    if (memory%step%is_dynamic) call set_lags(model, state)
    last = .false.
    if (monitor%restarts%is_restart) then
      call start_trial(model, state, memory%trial)
      call monitor%restarts%source%part('driver', memory)
      call close_restart(monitor%restarts%source, error)
      if (allocated(error)) return
      memory%step%old_force = net_force(memory%trial)
      memory%step%old_bodies = net_body_force(model, state, memory%trial)
      ! The end time may have been reduced within a whole step.
      memory%control%target = min(memory%control%target, memory%control%end_time)
      last = has_ended(model, state, memory%control)
    else
      associate (implicit => model%controls%implicit)
        if (abs(memory%control%dt - implicit%dt) > 0.0_wp) call warn(monitor%log, &
          'the first step '//to_text(implicit%dt)//' is outside DTMIN and DTMAX of ' &
          //'*CONTROL_IMPLICIT_AUTO and becomes '//to_text(memory%control%dt))
        call write_log(monitor%log, 'implicit method: '//trim(merge('dynamic', 'static ', &
          implicit%is_dynamic))//', first step '//to_text(implicit%dt))
        if (implicit%is_dynamic) call write_log(monitor%log, '  '//implicit%scheme//': alpha_m ' &
          //to_text(implicit%alpha_m)//', alpha_f '//to_text(implicit%alpha_f)//', gamma ' &
          //to_text(implicit%gamma)//', beta '//to_text(implicit%beta))
      end associate
    end if
    planned = memory%control
    call plan_next(model, last, state, planned, ends)
    if (.not. monitor%restarts%is_restart) then
      call start_implicit(model, planned%next, state, monitor, memory, error)
      if (.not. allocated(error)) call report_contact_start(model, state, monitor%log)
      if (allocated(error)) return
      wanted = wanted_files(monitor%restarts, state%cycle, .false., ends, .false.)
      if (any(wanted)) call cut_sections(model, memory%trial, state)
      call write_restarts(wanted, state, monitor, error, memory)
    end if
    memory%control = planned
  end subroutine begin_steps

  !> Plan the next step, if any.
  pure subroutine plan_next(model, last, state, control, ends)
    type(model_t), intent(in) :: model
    logical, intent(in) :: last
    type(state_t), intent(inout) :: state   !! gets its step
    type(step_control_t), intent(inout) :: control
    logical, intent(out) :: ends            !! that step is the last one

    state%dt = control%dt
    ends = .false.
    if (last) return
    call plan_step(control, state%time)
    state%dt = control%next - state%time
    ends = control%is_last
    if (model%controls%end_cycle > 0) ends = ends .or. state%cycle + 1 >= model%controls%end_cycle
  end subroutine plan_next

  !> Whether the run is at its end.
  pure function has_ended(model, state, control) result(ended)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_control_t), intent(in) :: control
    logical :: ended

    ended = state%time >= control%end_time - round_off*control%dt
    if (model%controls%end_cycle > 0) ended = ended .or. state%cycle >= model%controls%end_cycle
  end function has_ended

  !> Damping of sticking points, from the frequencies of the contact springs at time zero.
  subroutine set_lags(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(contact_state_t) :: undeformed
    integer :: i

    do i = 1, size(model%contacts)
      if (.not. (has_decay(model%contacts(i)%friction) .and. state%contacts(i)%has%contact)) cycle
      undeformed = state%contacts(i)
      undeformed%positions(1:2, :) = model%mesh%coordinates(:, undeformed%nodes)
      undeformed%positions(3:4, :) = 0.0_wp
      associate (ratio => contact_ratios(model%contacts(i), state%contact_mass, undeformed), &
        n => undeformed%n_slave)
        state%contacts(i)%scratch%lag = 2.0_wp*of_stuck/sqrt(maxval(ratio(:n)) &
          + maxval(ratio(n + 1:)))
      end associate
    end do
  end subroutine set_lags

  !> Forces and acceleration at time zero.
  subroutine start_implicit(model, dt, state, monitor, memory, error)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: dt !! first step
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(implicit_memory_t), intent(inout) :: memory
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    allocate (state%acceleration(2, model%mesh%n_node), source=0.0_wp)
    if (memory%step%is_dynamic) then
      call prescribe_start(model, dt, state)
      call move_hanging_nodes(model%mesh, state%motion)
    else
      state%motion(3:4, :) = 0.0_wp
      do i = 1, size(state%rigids)
        state%rigids(i)%velocity = 0.0_wp
      end do
    end if
    call start_trial(model, state, memory%trial)
    call assemble_forces(model, state, 0.0_wp, .false., monitor%clock, memory%trial)
    if (allocated(state%cut_force)) call store_cut_chunks(model, state%elements, &
      memory%trial%before)
    state%contacts = memory%trial%contacts
    ! Springs loaded at time zero start with their stored energy.
    do i = 1, size(state%contacts)
      call measure_springs(state%contacts(i))
      state%contacts(i)%energy = state%contacts(i)%monitor%stored
    end do
    if (allocated(memory%trial%damping)) memory%trial%damping = mass_times(model, &
      state%mass, state%motion(3:4, :), damping_rates(model, 0.0_wp))
    memory%step%old_force = net_force(memory%trial)
    memory%step%old_bodies = net_body_force(model, state, memory%trial)
    if (memory%step%is_dynamic) call find_first_acceleration(model, monitor, memory%step, state, &
      error)
    call lap(monitor%clock, phase_solver)
  end subroutine start_implicit

  !> Solve M a(0) = -f(0) on the free degrees of freedom, with the accelerations of prescribed ones;
  !> the nodes of rigid bodies follow.
  subroutine find_first_acceleration(model, monitor, step, state, error)
    type(model_t), intent(in) :: model
    type(monitor_t), intent(inout) :: monitor
    type(step_t), intent(in) :: step
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error
    type(equations_t) :: equations
    type(sparse_t) :: matrix
    type(report_t) :: report
    real(wp), allocatable :: velocity(:, :)
    real(wp) :: x(2*model%mesh%n_node + 3*size(state%rigids)), ones(3, size(state%rigids)), &
      bodies(3, size(state%rigids)), displacement(3, size(state%rigids)), &
      speed(3, size(state%rigids))
    integer :: i, n

    call number_equations(model, state, 0.0_wp, equations)
    call start_matrix(matrix, equations%n)
    call add_free_mass(model, 1.0_wp, equations, matrix)
    ones = 1.0_wp
    call add_rigid_diagonal(state%rigids, ones, equations, matrix)
    n = equations%n_free
    matrix%n = n
    call compress_matrix(matrix)
    call solve_linear(matrix, -free_entries(equations, step%old_force + mass_times(model, &
      state%mass, state%acceleration), step%old_bodies/body_scales(state%rigids)), x(:n), report)
    if (.not. report%is_solved) then
      call raise(error, 'no acceleration at time zero: '//report%message, status_run)
      return
    end if
    call write_log(monitor%log, '  equations: '//to_text(equations%n_free)//' free, ' &
      //to_text(equations%n - equations%n_free)//' prescribed; mass solved by '//report%method)
    state%acceleration = unpack(x, equations%number > 0 .and. equations%number <= n, &
      state%acceleration)
    n = count(equations%number > 0 .and. equations%number <= n)
    bodies = unpack(x(n + 1:), equations%bodies > 0 .and. equations%bodies <= equations%n_free, &
      0.0_wp)/body_scales(state%rigids)
    do i = 1, size(state%rigids)
      associate (rigid => state%rigids(i))
        rigid%acceleration = rigid%acceleration + bodies(:, i)
        displacement(:, i) = rigid%displacement
        bodies(:, i) = rigid%acceleration
        speed(:, i) = rigid%velocity
      end associate
    end do
    call move_hanging_nodes(model%mesh, state%acceleration)
    velocity = state%motion(3:4, :)
    call spread_rates(model, state%rigids, displacement, speed, bodies, velocity, &
      state%acceleration)
    state%motion(3:4, :) = velocity
  end subroutine find_first_acceleration

end module implicit_start_m
