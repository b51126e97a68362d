! SPDX-License-Identifier: MIT
!> Serial part of the explicit cycle: contact and loads before the elements; time, step and checks
!> after them.
module explicit_cycle_m
  use archive_m, only : archive_t
  use element_dispatch_m, only : sum_special_forces
  use load_work_m, only : find_prescribed_velocities, impose_prescribed, add_motion_work, &
    add_body_motion_work, add_load_work, add_group_work, apply_loads, motion_sums_t, plan_sums, &
    add_work_of_sums
  use clock_m, only : lap, lap_interface, phase_nodes
  use coupled_nodes_m, only : coupled_velocity
  use loads_m, only : fix_nodes, update_activity, is_active
  use explicit_contact_m, only : plan_sampling, check_springs
  use start_m, only : check_added_mass, set_contact_masses
  use contacts_m, only : penalty_implicit
  use element_erosion_m, only : finish_erosion, release_free_nodes, failure_log_t, &
    update_failures, update_interfaces
  use errors_m, only : error_t
  use hanging_nodes_m, only : move_hanging_nodes
  use health_m, only : tile_check_t, check_elements, are_sound, check_step, report_collapsed, &
    check_cycle
  use history_tables_m, only : table_secforc
  use implicit_penalty_m, only : pressure_step_t
  use interface_m, only : apply_contact
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use mass_scaling_m, only : needs_refinement, grow_masses
  use model_m, only : model_t
  use monitor_m, only : monitor_t, due_t, find_due
  use node_motion_m, only : update_damping, leap_t, make_leap, solve_rigids, move_rigids
  use packed_buffer_m, only : stream_starts
  use progress_m, only : update_progress
  use rank_exchange_m, only : halo_t, plan_halo, exchange_halo, exchange_checks, &
    n_notice, notice_eroded, notice_failed, notice_error, notice_dump, notice_plot, notice_stop, &
    notice_signal, gather_integers, gather_motion, gather_state, collect_requests, cut_sections
  use rank_partition_m, only : partition_t, partition_tiles, plan_borders
  use ranks_m, only : ranks_t, gather_reals, share_error
  use requests_m, only : find_early_end, requests_t, read_requests, recent_requests_t
  use restart_file_m, only : close_restart
  use restart_m, only : write_restarts
  use restart_plan_m, only : wanted_files
  use quiescent_tiles_m, only : tile_states_t, plan_tile_states, update_tile_states
  use node_constraints_m, only : move_coupled_nodes, add_wall_work, move_walls
  use state_m, only : state_t
  use time_step_m, only : step_plan_t, volume_step, next_step, limit_approach, &
    is_last, update_spring_bounds, cycles_in, has_springs
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: explicit_cycle_t, start_cycles, begin_cycle, prepare_leap, exchange_tiles, &
    end_cycle, read_cycle

  !> Data of the cycle, shared by the team and written by one thread between barriers.
  type, extends(visited_t) :: explicit_cycle_t
    logical :: writes = .true.       !! this cycle writes output
    logical :: finished = .false.    !! the run is over
    logical :: last = .false.        !! this cycle is the last one
    logical :: plots = .false.       !! this cycle writes a plot state on request
    type(due_t) :: due
    type(partition_t) :: partition   !! tiles of each process, and nodes between them
    type(halo_t) :: halo             !! exchange between processes in each cycle
    type(requests_t) :: asked        !! requests of the user, received in this cycle
    type(recent_requests_t) :: recent !! requests served before, of several processes
    type(leap_t) :: leap             !! motion factors of this cycle
    type(step_plan_t) :: steps
    logical :: timed_motions = .false. !! some prescribed motion starts or ends during the run
    logical, allocatable :: active(:)  !! (n_motion) motions that are active, once known
    logical :: has_pressures = .false. !! some interface has implicit penalties
    type(pressure_step_t), allocatable :: pressure_steps(:) !! (interfaces) of these penalties
    logical :: refines = .false.     !! stable steps need more than the density (scaled, damped,
                                     !! exposed)
    type(motion_sums_t) :: sums      !! for the work of body loads and damping
    type(tile_states_t) :: tile_states      !! activity of the tiles
    type(tile_check_t), allocatable :: checks(:) !! (tiles) results of their elements
    integer :: first_check = 1       !! first check that counts: with several processes the last
                                     !! one, which holds the reduced results of all
    type(failure_log_t) :: failures   !! failed points that have been reported
    real(wp) :: damping(2) = 0.0_wp  !! D per direction, 1/s
    real(wp), allocatable :: rates(:, :) !! (2, n_part + 1) D of parts, where the deck damps some
    real(wp) :: ratio = 1.0_wp       !! last known energy ratio
    integer, allocatable :: n_eroded_seen(:) !! (n_part) eroded elements that the interfaces account
                                             !! for; allocated where elements may erode
    integer, allocatable :: freed(:) !! nodes without an element since this cycle; allocated with
                                     !! erosion in this cycle
    real(wp), allocatable :: velocity(:)     !! (n_motion) v(n+1/2) of prescribed motions
    real(wp), allocatable :: displacement(:) !! (n_motion) u(n) of prescribed motions
    real(wp), allocatable :: common(:, :)    !! (2, n_set) v(n-1/2) of coupled nodes
    character(:), allocatable :: reason      !! reason of the end
    type(error_t), allocatable :: error
  contains
    procedure :: visit => visit_cycle
  end type explicit_cycle_t

contains

  !> Set up the cycles.
  subroutine start_cycles(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(out) :: cycle

    associate (motions => model%conditions%motions)
      allocate (cycle%velocity(size(motions)), cycle%displacement(size(motions)), source=0.0_wp)
      cycle%timed_motions = any(motions%birth > 0.0_wp .or. &
        motions%death < model%controls%end_time)
    end associate
    call plan_sums(model, cycle%sums)
    cycle%has_pressures = any(model%contacts%penalty_unit == penalty_implicit)
    if (cycle%has_pressures) allocate (cycle%pressure_steps(size(model%contacts)))
    cycle%refines = needs_refinement(state%elements)
    associate (ranks => monitor%ranks)
      cycle%partition = partition_tiles(model%layout, ranks%mine, ranks%n)
      if (ranks%n > 1) cycle%first_check = size(model%layout%tiles) + 1
      allocate (cycle%checks(max(size(model%layout%tiles), cycle%first_check)))
      call plan_borders(model, ranks%mine, cycle%sums, cycle%partition)
      if (ranks%n > 1) call plan_halo(cycle%partition, ranks%mine, state%elements, cycle%sums, &
        cycle%halo)
      call plan_tile_states(model, cycle%partition, allocated(cycle%sums%parts), cycle%tile_states)
    end associate
    cycle%reason = 'termination time reached'
    if (model%erodes) allocate (cycle%n_eroded_seen, source=state%elements%erosion%n_eroded)
    cycle%steps%start_time = state%time
    cycle%failures%is_restart = monitor%restarts%is_restart
    if (monitor%restarts%is_restart) call read_cycle(model, state, monitor%restarts%source, cycle)
    ! The end comes from the deck of this run.
    cycle%steps%end_time = model%controls%end_time
    cycle%steps%end_cycle = model%controls%end_cycle
    if (.not. monitor%restarts%is_restart) return
    if (cycle%steps%constant > 0.0_wp) cycle%steps%n_cycle = &
      cycles_in(cycle%steps%end_time - cycle%steps%start_time, cycle%steps%constant)
    call close_restart(monitor%restarts%source, cycle%error)
    call find_early_end(model, state, cycle%last, cycle%reason)
  end subroutine start_cycles

  !> Read the driver data of a restart file; the first fault becomes the error of the archive.
  subroutine read_cycle(model, state, source, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(archive_t), intent(inout) :: source
    type(explicit_cycle_t), intent(inout) :: cycle

    if (has_springs(model, state%contacts)) allocate (cycle%steps%springs(size(model%contacts)))
    call source%part('driver', cycle)
    call source%expect('driver/steps/start_cycle', cycle%steps%start_cycle <= state%cycle, &
      'a cycle after the present one')
  end subroutine read_cycle

  !> Forces on the special nodes at u(n), and the outputs of this cycle.
  subroutine begin_cycle(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    integer :: i

    cycle%last = is_last(cycle%steps, state%cycle, state%time) .or. cycle%last .or. &
      monitor%only_checks
    cycle%due = find_due(monitor, state%time, state%dt, state%cycle == 0 .or. cycle%last)
    cycle%due%plot = cycle%due%plot .or. (cycle%plots .and. monitor%has_plot)
    cycle%plots = .false.
    cycle%writes = cycle%due%plot .or. any(cycle%due%tables) .or. state%cycle == 0 .or. cycle%last
    call apply_loads(model, state, cycle%damping, cycle%sums)
    if (allocated(state%boundary_work)) call add_load_work(model, state)
    if (allocated(state%node_damping)) call update_damping(model, cycle%rates, state)
    ! This lap, or without contact the one below, includes the end of the previous cycle.
    if (size(model%contacts) > 0) call lap(monitor%clock, phase_nodes)
    call plan_sampling(model, cycle%writes, state)
    do i = 1, size(model%contacts)
      call apply_contact(state%interfaces(i), state%motion, state%contact_mass, state%time, &
        state%dt_before, state%cycle, monitor%clock, state%contacts(i), state%force_special)
      call lap_interface(monitor%clock, i)
      call check_springs(model, i, state, monitor%log)
    end do
    if (state%cycle > 0) call prepare_leap(model, state, cycle)
    if (allocated(state%cut_force) .and. cycle%due%tables(table_secforc)) &
      call cut_sections(model, cycle%partition, monitor%ranks, state)
    call lap(monitor%clock, phase_nodes)
  end subroutine begin_cycle

  !> Set the motion factors and prescribed velocities once the step is known.
  subroutine prepare_leap(model, state, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(inout) :: cycle
    logical, allocatable :: active(:)
    integer :: i

    cycle%leap = make_leap(state%dt_before, state%dt, cycle%damping, state%body_acceleration)
    if (cycle%timed_motions) then
      ! Inverse masses change where some prescribed motion has just started or ended.
      active = is_active(model%conditions%motions, state%time)
      if (.not. allocated(cycle%active)) allocate (cycle%active, source=.not. active)
      if (any(active .neqv. cycle%active)) then
        cycle%active = active
        call update_activity(model, state%time, state%mass, state%inverse_mass)
        call fix_nodes(model, state%inverse_mass)
        call set_contact_masses(model, state)
      end if
    end if
    do i = 1, size(cycle%displacement)
      associate (prescribed => model%conditions%motions(i))
        cycle%displacement(i) = state%motion(prescribed%direction, prescribed%node)
      end associate
    end do
    call find_prescribed_velocities(model, state, cycle%velocity)
    if (allocated(model%conditions%common_motions)) then
      associate (n => size(model%conditions%common_motions))
        cycle%common = reshape([(coupled_velocity(model, i, state), i=1, n)], [2, n])
      end associate
    end if
  end subroutine prepare_leap

  !> Exchange forces and notices between processes before special nodes move.
  subroutine exchange_tiles(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    logical :: notices(n_notice)

    associate (ranks => monitor%ranks, partition => cycle%partition, elements => state%elements)
      call collect_requests(state, cycle%ratio, monitor, cycle%recent, cycle%asked, cycle%error)
      notices = .false.
      notices(notice_error) = allocated(cycle%error)
      notices([notice_dump, notice_plot, notice_stop, notice_signal]) = [cycle%asked%dump, &
        cycle%asked%plot, cycle%asked%stop, cycle%asked%signalled]
      call exchange_halo(partition, ranks, cycle%halo, state, cycle%sums)
      call exchange_checks(partition, elements, ranks, cycle%halo, cycle%checks, notices)
      cycle%asked = requests_t(notices(notice_dump), notices(notice_plot), notices(notice_stop), &
        notices(notice_signal))
      if (notices(notice_error)) call share_error(ranks, cycle%error)
      if (notices(notice_eroded)) then
        associate (erosion => elements%erosion, slots => (partition%chunks - 1)*chunk_size + 1)
          call gather_integers(ranks, partition%chunks, erosion%n_removed)
          call gather_integers(ranks, slots, erosion%status)
          call gather_reals(ranks, slots, 1, .true., erosion%hourglass)
          call gather_reals(ranks, slots, 1, .true., erosion%internal)
        end associate
      end if
      if (state%cycle == 0) call gather_reals(ranks, partition%chunks, 1, .true., &
        elements%time_limit)
      if (notices(notice_failed)) then
        call gather_integers(ranks, partition%chunks, elements%n_failed)
        ! The log names the first one.
        if (cycle%failures%n_reported == 0 .and. any(elements%n_failed > 0)) &
          call gather_reals(ranks, stream_starts(partition%chunks, elements%history_start, &
          size(elements%history)), 1, .false., elements%history)
      end if
      if (cycle%writes) call gather_state(partition, .false., ranks, state)
      if (cycle%writes .and. ranks%mine == 0) call sum_special_forces(model%layout, &
        state%force_slots, 1, model%layout%n_special, state%internal_force)
    end associate
    call lap(monitor%clock, phase_nodes)
  end subroutine exchange_tiles

  !> Move prescribed nodes and bodies, check the state, and advance to the next instant.
  subroutine end_cycle(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp) :: limit

    if (allocated(state%elements%n_failed)) call update_failures(model, state, cycle%failures, &
      monitor%log)
    call update_tile_states(model, cycle%partition, cycle%tile_states)
    if (cycle%finished) return
    if (.not. cycle%writes) then
      call add_work_of_sums(cycle%sums, state%external_work, state%damping_work)
      if (model%erodes) call finish_erosion(model, state, monitor%log, cycle%freed)
      if (.not. are_sound(cycle%checks(cycle%first_check:), state%contacts)) then
        if (monitor%ranks%n > 1) call gather_state(cycle%partition, .false., monitor%ranks, state)
        if (monitor%ranks%mine == 0) call check_elements(model, state, cycle%error)
        call share_error(monitor%ranks, cycle%error)
      end if
    end if
    if (size(cycle%velocity) > 0) then
      call add_motion_work(model, cycle%velocity, cycle%damping, [.not. cycle%writes, .true.], &
        state)
      call impose_prescribed(model, cycle%velocity, cycle%displacement, state)
    end if
    if (allocated(cycle%common)) call move_coupled_nodes(model, cycle%leap, cycle%damping, &
      cycle%common, state)
    if (allocated(state%walls)) then
      call add_wall_work(model, [.not. cycle%writes, .true.], state)
      call move_walls(model, state, cycle%error)
    end if
    if (size(state%rigids) > 0) then
      if (.not. cycle%writes) call solve_rigids(model, cycle%damping, state)
      call add_body_motion_work(model, cycle%damping, [.not. cycle%writes, .true.], state)
      call move_rigids(model, state)
    end if
    call move_hanging_nodes(model%mesh, state%motion)
    if (allocated(state%group_work)) call add_group_work(model, [.not. cycle%writes, .true.], state)
    if (allocated(cycle%freed)) then
      if (monitor%ranks%n > 1) call gather_motion(cycle%partition, .true., monitor%ranks, state)
      ! Nodes without elements, and surfaces of interfaces.
      call release_free_nodes(model, cycle%leap, cycle%freed, state)
      associate (n_eroded => state%elements%erosion%n_eroded)
        call update_interfaces(model, n_eroded > cycle%n_eroded_seen, state)
        cycle%n_eroded_seen = n_eroded
      end associate
      cycle%refines = needs_refinement(state%elements)
      deallocate (cycle%freed)
    end if
    state%cycle = state%cycle + 1
    state%previous_dt = state%dt_before
    state%dt_before = state%dt
    if (allocated(state%elements%mass_ratio)) call update_masses(model, monitor%ranks, state, cycle)
    call update_spring_bounds(model, state, cycle%steps%springs)
    limit = element_limit(model, state, cycle)
    if (size(state%contacts) > 0) call limit_approach(model, merge(state%previous_dt, &
      state%dt_before, state%cycle > 1), state, monitor%log, cycle%steps, limit)
    call next_step(model, limit, monitor%log, state%cycle, cycle%steps, state%time, state%dt)
    if (.not. allocated(cycle%error)) then
      call check_step(model%controls, cycle%steps%first_dt, state%time, state%dt, cycle%error)
      if (allocated(cycle%error) .and. monitor%ranks%n > 1) &
        call gather_state(cycle%partition, .false., monitor%ranks, state)
      if (allocated(cycle%error) .and. monitor%ranks%mine == 0) call report_collapsed(model, &
        state, cycle%error)
    end if
    if (.not. allocated(cycle%error)) call check_cycle(state%cycle, state%time, cycle%error)
    cycle%finished = allocated(cycle%error)
    call find_early_end(model, state, cycle%last, cycle%reason)
    if (.not. cycle%finished) call apply_requests(state, monitor, cycle)
    if (monitor%ranks%mine == 0) call update_progress(monitor%progress, monitor%clock, &
      state%cycle, .false., state%time, state%dt, cycle%ratio)
  end subroutine end_cycle

  !> Smallest stable step of the elements, s. Where all elements have eroded the step stays.
  pure function element_limit(model, state, cycle) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(explicit_cycle_t), intent(in) :: cycle
    real(wp) :: limit, dt

    ! Changes belong to the step before the last one, in the first cycle to the first step.
    dt = merge(state%previous_dt, state%dt_before, state%cycle > 1)
    associate (checks => cycle%checks(cycle%first_check:))
      limit = min(minval(checks%time_limit), volume_step(dt, merge(state%dt_before, 0.0_wp, &
        state%cycle > 1), maxval(checks%volume_change)))
    end associate
    if (.not. model%erodes) return
    associate (n_removed => state%elements%erosion%n_removed)
      if (sum(n_removed) == sum(model%layout%chunk_elements(:size(n_removed)))) &
        limit = state%dt/model%controls%dt_scale
    end associate
  end function element_limit

  !> Add mass to elements whose stable step has fallen below DT2MS, where the deck allows, and
  !> update all masses. Its kinetic energy is external work.
  subroutine update_masses(model, ranks, state, cycle)
    type(model_t), intent(in) :: model
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp), allocatable :: before(:)
    real(wp) :: work
    integer :: i, n

    if (model%controls%masses_stay) return
    if (minval(cycle%checks(cycle%first_check:)%time_limit) >= abs(model%controls%mass_step)) return
    if (ranks%n > 1) call gather_state(cycle%partition, .true., ranks, state)
    before = state%mass
    call grow_masses(model, state%motion, state%dt, state%elements, state%mass, work)
    ! The limits hold for the positions of the next cycle.
    cycle%checks%time_limit = max(cycle%checks%time_limit, abs(model%controls%mass_step))
    if (.not. any(state%mass > before)) return
    state%external_work = state%external_work + work
    do i = 1, size(before)
      if (state%mass(i) > before(i)) where (state%inverse_mass(:, i) > 0.0_wp) &
        state%inverse_mass(:, i) = 1.0_wp/state%mass(i)
    end do
    n = size(state%contact_mass)
    where (state%mass(:n) > before(:n)) &
      state%contact_mass = state%contact_mass + (state%mass(:n) - before(:n))
    call set_contact_masses(model, state)
    if (allocated(cycle%rates)) deallocate (cycle%rates)
    if (.not. allocated(cycle%error)) call check_added_mass(model, state%elements, cycle%error)
  end subroutine update_masses

  !> Serve requests and write due restart files. A stop by a signal counts as an end for restart
  !> files. The state is that before the next cycle, which a restarted run repeats.
  subroutine apply_requests(state, monitor, cycle)
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    logical :: ends, wanted(2) !! numbered_file, running_file

    if (monitor%ranks%n == 1) &
      call read_requests(state, cycle%ratio, .false., monitor, cycle%asked, cycle%error)
    cycle%plots = cycle%asked%plot
    ends = is_last(cycle%steps, state%cycle, state%time) .or. cycle%last
    wanted = wanted_files(monitor%restarts, state%cycle, cycle%asked%dump, ends, &
      cycle%asked%signalled .and. .not. ends)
    if (any(wanted) .and. .not. allocated(cycle%error)) then
      if (monitor%ranks%n > 1) call gather_state(cycle%partition, .false., monitor%ranks, state)
      if (monitor%ranks%mine == 0) call write_restarts(wanted, state, monitor, cycle%error, cycle)
      call share_error(monitor%ranks, cycle%error)
    end if
    cycle%finished = allocated(cycle%error)
    if (ends .or. .not. cycle%asked%stop) return
    cycle%last = .true.
    cycle%reason = 'stopped on request'
  end subroutine apply_requests

  !> Visit the driver data that the next cycle needs besides the state.
  subroutine visit_cycle(self, visitor)
    class(explicit_cycle_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%part('steps', self%steps)
    call visitor%fixed('damping', self%damping)
    call visitor%visit('ratio', self%ratio)
  end subroutine visit_cycle

end module explicit_cycle_m
