! SPDX-License-Identifier: MIT
!> Dynamic relaxation (*CONTROL_DYNAMIC_RELAXATION): before time zero the loads of that phase act on
!> the structure, and every step scales the velocities, until the structure is at rest. The result
!> is the state at time zero. One thread, before any output.
module relaxation_m
  use clock_m, only : lap, phase_input
  use load_work_m, only : apply_loads, motion_sums_t
  use element_dispatch_m, only : add_tile_forces, scatter_tile_forces, sum_special_forces
  use errors_m, only : error_t, raise, status_run, status_stopped
  use health_m, only : check_elements
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use log_m, only : write_log, warn, to_text
  use mass_scaling_m, only : refine_limits, needs_refinement
  use model_m, only : model_t
  use monitor_m, only : monitor_t
  use node_motion_m, only : leap_t, make_leap, move_tile_nodes, move_special_nodes
  use parts_m, only : hourglass_viscous
  use rank_exchange_m, only : collect_requests
  use ranks_m, only : reduce_min, share_error
  use state_m, only : relaxation_state_t, state_t
  use requests_m, only : requests_t, recent_requests_t
  use restart_m, only : write_restarts
  use restart_plan_m, only : wanted_files
  use loads_m, only : scaled_step
  use node_constraints_m, only : apply_skew_supports
  use time_step_m, only : volume_step
  implicit none
  private
  public :: relax, switch_loads

  !> Cycles after which relaxation stops where DRTERM does not end it.
  integer, parameter :: most_cycles = 5000000
  !> Relative rise of the step limit below which the step stays.
  real(wp), parameter :: least_rise = 0.05_wp
  !> Cycles between two polls for requests.
  integer, parameter :: poll_cycles = 8

contains

  !> Relax the initial state, or a state of this phase from a restart file, to rest.
  subroutine relax(model, monitor, state, error)
    type(model_t), intent(in) :: model
    type(monitor_t), intent(inout) :: monitor
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error
    type(model_t), allocatable :: relaxing
    type(requests_t) :: asked
    type(recent_requests_t) :: recent
    real(wp), allocatable :: force(:, :)
    real(wp) :: share !! kinetic energy over its maximum
    real(wp) :: momentum(2), mass
    integer :: n, i

    allocate (relaxing, source=model)
    call switch_loads(relaxing, 0)
    if (state%relaxation%n > 0) then
      state%time = state%relaxation%time
    else
      state%relaxation%velocity = state%motion(3:4, :)
      state%motion(3:4, :) = 0.0_wp
    end if
    allocate (force(2, model%layout%n_local))
    share = 1.0_wp
    ! A cycle without motion gives the step limit of the elements at time zero.
    if (.not. state%dt > 0.0_wp) call relax_cycle(relaxing, force, state)
    associate (rules => model%controls%relaxation)
      do n = state%relaxation%n + 1, most_cycles
        call relax_cycle(relaxing, force, state)
        if (mod(n, 100) == 0 .or. mod(n, rules%check_cycles) == 0) &
          call check_elements(relaxing, state, error)
        if (allocated(error)) return
        ! Kinetic energy beyond that of the mean velocity.
        share = 0.0_wp
        momentum = 0.0_wp
        mass = 0.0_wp
        do i = 1, size(state%mass)
          share = share + 0.5_wp*state%mass(i)*(state%motion(3, i)**2 + state%motion(4, i)**2)
          momentum = momentum + state%mass(i)*state%motion(3:4, i)
          mass = mass + state%mass(i)
        end do
        share = max(0.0_wp, share - 0.5_wp*sum(momentum**2)/mass)
        state%relaxation%most = max(state%relaxation%most, share)
        if (state%relaxation%most > 0.0_wp) share = share/state%relaxation%most
        if (mod(n, rules%check_cycles) == 0 .and. share < rules%tolerance) exit
        if (state%time >= rules%most_time) exit
        state%relaxation%n = n
        if (mod(n, poll_cycles) == 0) call apply_requests(asked, recent, state, monitor, error)
        if (allocated(error)) return
      end do
      if (n > most_cycles) then
        call raise(error, 'dynamic relaxation has not converged in '//to_text(most_cycles) &
          //' cycles: the kinetic energy is '//to_text(share)//' of its maximum', status_run)
        return
      end if
      call write_log(monitor%log, 'dynamic relaxation: '//to_text(n)//' cycles, kinetic energy ' &
        //to_text(share)//' of its maximum at the end')
      if (.not. share < rules%tolerance) call warn(monitor%log, 'dynamic relaxation ended by ' &
        //'DRTERM before it converged')
    end associate
    call start_run_state(model, state%relaxation%velocity, state)
    state%relaxation = relaxation_state_t()
  end subroutine relax

  !> Serve requests: a restart file, from which the phase can restart, and a stop, which is returned
  !> as an error. A requested plot state is that of time zero.
  subroutine apply_requests(asked, recent, state, monitor, error)
    type(requests_t), intent(inout) :: asked !! previous requests in, new ones out
    type(recent_requests_t), intent(inout) :: recent
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    logical :: wanted(2) !! numbered_file, running_file
    real(wp) :: none(3)

    call lap(monitor%clock, phase_input)
    call collect_requests(state, 1.0_wp, monitor, recent, asked, error)
    ! A request to one process is served by all.
    none = merge(0.0_wp, 1.0_wp, [asked%dump, asked%stop, asked%signalled])
    call reduce_min(monitor%ranks, none)
    asked%dump = none(1) < 1.0_wp
    asked%stop = none(2) < 1.0_wp
    asked%signalled = none(3) < 1.0_wp
    wanted = wanted_files(monitor%restarts, 0, asked%dump, .false., asked%signalled)
    if (any(wanted)) then
      ! In restart files the run is at time zero.
      state%relaxation%time = state%time
      state%time = 0.0_wp
      if (monitor%ranks%mine == 0 .and. .not. allocated(error)) &
        call write_restarts(wanted, state, monitor, error)
      state%time = state%relaxation%time
      call share_error(monitor%ranks, error)
    end if
    if (.not. asked%stop .or. allocated(error)) return
    call raise(error, 'stopped on request in dynamic relaxation after ' &
      //to_text(state%relaxation%n)//' cycles', status_stopped)
    state%time = 0.0_wp
  end subroutine apply_requests

  !> One cycle of relaxation, v(n+1/2) = DRFCTR v(n-1/2) + h a, and the step of the next one.
  subroutine relax_cycle(model, force, state)
    type(model_t), intent(in) :: model
    real(wp), intent(inout), contiguous :: force(:, :) !! work array of a tile
    type(state_t), intent(inout) :: state
    type(motion_sums_t) :: unused
    type(leap_t) :: leap
    real(wp) :: global(2), limit, wanted
    real(wp), parameter :: none(2) = 0.0_wp
    integer :: i

    global = none
    call apply_loads(model, state, global, unused)
    leap = make_leap(state%dt_before, state%dt, none, state%body_acceleration)
    leap%keep = model%controls%relaxation%factor
    do i = 1, size(model%layout%tiles)
      associate (tile => model%layout%tiles(i))
        call add_tile_forces(model, tile, state%motion, state%dt_before, state%elements, force)
        if (needs_refinement(state%elements)) &
          call refine_limits(model, tile, state%motion, state%dt_before, state%elements)
        call scatter_tile_forces(tile, force, state%force_slots)
        call move_tile_nodes(leap, tile%first_node, tile%last_node, force, state%inverse_mass, &
          state%motion)
      end associate
    end do
    associate (n => model%layout%n_special)
      call sum_special_forces(model%layout, state%force_slots, 1, n, state%internal_force)
      if (allocated(model%conditions%skew_supports)) call apply_skew_supports(model, leap, 1, n, &
        state)
      call move_special_nodes(leap, 1, n, state)
    end associate
    state%time = state%time + state%dt
    state%dt_before = state%dt
    ! TSSFDR, or the factor of the run, times the limit; constant while the limit rises by little.
    limit = min(minval(state%elements%time_limit), volume_step(state%dt, state%dt, &
      maxval(state%elements%volume_change)))
    wanted = scaled_step(model, limit, 0.0_wp)
    if (model%controls%relaxation%step_scale > 0.0_wp) &
      wanted = model%controls%relaxation%step_scale*limit
    if (wanted < state%dt .or. wanted > (1.0_wp + least_rise)*state%dt) state%dt = wanted
  end subroutine relax_cycle

  !> Reset time, works and damping for the start of the run; velocities are those of the deck.
  subroutine start_run_state(model, velocity, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:, :) !! (2, n_node)
    type(state_t), intent(inout) :: state
    integer :: i

    state%time = 0.0_wp
    state%dt = 0.0_wp
    state%dt_before = 0.0_wp
    state%cycle = 0
    state%motion(3:4, :) = velocity
    state%external_work = 0.0_wp
    state%damping_work = 0.0_wp
    state%body_acceleration = 0.0_wp
    state%elements%viscous_work = 0.0_wp
    ! Work of viscous hourglass control is dissipated; that of the other forms is stored.
    do i = 1, size(state%elements%hourglass_work)
      if (model%parts(model%layout%chunk_part(i))%hourglass%form /= hourglass_viscous) cycle
      state%elements%hourglass_work(i) = 0.0_wp
      if (allocated(state%elements%erosion)) &
        state%elements%erosion%hourglass((i - 1)*chunk_size + 1:i*chunk_size) = 0.0_wp
    end do
    if (allocated(state%external)) state%external = 0.0_wp
    if (allocated(state%elements%damping_work)) state%elements%damping_work = 0.0_wp
    if (allocated(state%elements%damping_stress)) state%elements%damping_stress = 0.0_wp
  end subroutine start_run_state

  !> Switch off the loads whose curves belong to one phase alone.
  subroutine switch_loads(model, phase)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: phase !! SIDR 0 of the run, 1 of relaxation

    associate (loads => model%conditions)
      where (model%curves(loads%nodal_loads%curve)%phase == phase) loads%nodal_loads%scale = 0.0_wp
      where (model%curves(loads%pressures%curve)%phase == phase) loads%pressures%scale = 0.0_wp
      where (model%curves(loads%body_loads%curve)%phase == phase) loads%body_loads%scale = 0.0_wp
    end associate
  end subroutine switch_loads

end module relaxation_m
