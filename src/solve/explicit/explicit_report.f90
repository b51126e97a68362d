! SPDX-License-Identifier: MIT
!> A cycle of an explicit run that writes: checks, output, and the leap-frog term that completes the
!> energy balance: v(n-1/2).M v(n+1/2)/2 + U is conserved with equal steps
!> (doc/theory/time_integration.md). One thread.
module explicit_report_m
  use coupled_nodes_m, only : coupled_acceleration, coupled_velocity
  use loads_m, only : is_active
  use contact_reports_m, only : report_contact_start
  use explicit_contact_m, only : add_implicit_penalties
  use curves_m, only : curve_value
  use element_erosion_m, only : finish_erosion
  use element_steps_m, only : find_smallest_steps
  use explicit_cycle_m, only : explicit_cycle_t, prepare_leap
  use health_m, only : check_elements, check_energy, check_ratio, check_radii, created_by_springs, &
    energy_unaccounted
  use node_constraints_m, only : apply_skew_supports, apply_walls, add_wall_work
  use history_filling_m, only : fill_explicit_reactions
  use history_tables_m, only : table_glstat, table_matsum, table_rwforc, table_spcforc, table_rbdout
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use load_work_m, only : add_work_of_sums, add_motion_work, add_body_motion_work, add_group_work
  use log_m, only : log_t, write_log, warn, to_text
  use model_m, only : model_t
  use monitor_m, only : monitor_t, write_due, record_energies, write_instant
  use ranks_m, only : share_error, broadcast_values
  use node_motion_m, only : solve_rigids, fill_rigids
  use snapshot_filling_m, only : fill_motion, fill_energies, fill_parts, fill_bodies, find_motion, &
    damping_at
  use snapshot_m, only : energy_ratio, snapshot_t
  use state_m, only : state_t
  use time_step_m, only : first_volume_change, first_step, largest_change, limit_approach, &
    limit_default_penalties, update_spring_bounds
  use walls_m, only : wall_tangent
  implicit none
  private
  public :: report_cycle, complete_balance

  !> Number of elements in the list of smallest steps.
  integer, parameter :: n_listed = 10
  !> Share of DT2MS by which a step set by mass scaling may differ from it.
  real(wp), parameter :: round_off = 1.0e-9_wp

contains

  !> Write due outputs unless the state is faulty; the first cycle determines the first step before.
  subroutine report_cycle(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp), allocatable :: held(:, :)              !! (2, n_skew) forces of skew supports
    integer, allocatable :: node_constraints(:)
    real(wp) :: energy(1)
    logical, parameter :: due(2) = [.true., .false.] !! works of the half step before the instant

    call add_work_of_sums(cycle%sums, state%external_work, state%damping_work)
    if (model%erodes) call finish_erosion(model, state, monitor%log, cycle%freed)
    ! The first process has gathered the state of all elements.
    if (monitor%ranks%mine == 0) call check_elements(model, state, cycle%error)
    call share_error(monitor%ranks, cycle%error)
    if (state%cycle == 0) then
      call limit_default_penalties(model, state)
      call update_spring_bounds(model, state, cycle%steps%springs)
    end if
    if (state%cycle == 0 .and. .not. allocated(cycle%error)) &
      call first_step(model, state%elements, monitor%log, cycle%steps, state%dt, cycle%error)
    if (allocated(cycle%error)) then
      cycle%finished = .true.
      return
    end if
    if (state%cycle == 0) then
      call limit_first_step(model, state, monitor, cycle)
      ! ERODE erodes elements below DTMIN times the first step, before TSSFAC.
      if (model%erodes) state%elements%erosion%least_step = model%controls%dt_floor &
        *cycle%steps%first_dt/model%controls%dt_scale
      call prepare_leap(model, state, cycle)
      if (cycle%has_pressures .and. cycle%leap%dt > 0.0_wp) call add_implicit_penalties(model, &
        cycle%leap, cycle%damping, cycle%velocity, monitor%clock, monitor%log, state, &
        cycle%pressure_steps)
      call report_contact_start(model, state, monitor%log)
      if (monitor%ranks%mine == 0) call log_smallest_steps(model, state, monitor%log)
      call warn_of_damping(model, state%dt, monitor%log)
    end if
    if (size(state%rigids) > 0) then
      call solve_rigids(model, cycle%damping, state)
      call add_body_motion_work(model, cycle%damping, due, state)
    end if
    if (allocated(state%walls)) then
      call apply_walls(model, cycle%leap, 1, model%layout%n_special, state)
      call add_wall_work(model, due, state)
    end if
    if (allocated(model%conditions%skew_supports)) then
      node_constraints = model%conditions%skew_supports%node
      held = -state%force_special(:, node_constraints)
      call apply_skew_supports(model, cycle%leap, 1, model%layout%n_special, state)
      held = held + state%force_special(:, node_constraints)
    end if
    call add_motion_work(model, cycle%velocity, cycle%damping, due, state)
    if (allocated(state%group_work)) call add_group_work(model, due, state)
    if (monitor%ranks%mine == 0) then
      call write_report(model, held, state, monitor, cycle)
    else
      monitor%snapshot%time = state%time
      call write_due(model, cycle%due, state%dt, monitor, cycle%error)
    end if
    energy = state%initial_energy
    if (state%cycle == 0) call broadcast_values(monitor%ranks, energy)
    state%initial_energy = energy(1)
    call share_error(monitor%ranks, cycle%error)
    cycle%finished = cycle%last .or. allocated(cycle%error)
  end subroutine report_cycle

  !> Shorten the first step where elements would change their volume by too much in it, or bodies
  !> would approach too far.
  subroutine limit_first_step(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp) :: change, dt, limit
    integer :: i

    dt = state%dt
    limit = dt/model%controls%dt_scale
    do i = 1, size(state%contacts)
      associate (memory => state%contacts(i))
        if (memory%is_stale) cycle
        memory%advance = dt*norm2(maxval(state%motion(3:4, memory%nodes), 2) &
          - minval(state%motion(3:4, memory%nodes), 2))
      end associate
    end do
    call limit_approach(model, dt, state, monitor%log, cycle%steps, limit)
    if (model%controls%dt_scale*limit < dt) then
      state%dt = model%controls%dt_scale*limit
      cycle%steps%constant = 0.0_wp
      call write_log(monitor%log, 'first time step shortened to '//to_text(state%dt) &
        //': bodies would approach by more than the search radius of a first contact')
    end if
    call prepare_leap(model, state, cycle)
    call first_volume_change(model, cycle%partition, cycle%leap, cycle%velocity, state, &
      monitor%ranks, change)
    if (change > largest_change) then
      state%dt = state%dt*(largest_change/change)
      cycle%steps%constant = 0.0_wp
      call write_log(monitor%log, 'first time step shortened to '//to_text(state%dt) &
        //': at the stable step the volume of an element would change by ' &
        //to_text(100.0_wp*change)//' %')
      change = largest_change
    end if
    state%contacts%advance = state%contacts%advance*(state%dt/dt)
    ! The first cycle had no volume change of its elements yet.
    cycle%checks(cycle%first_check)%volume_change = change
  end subroutine limit_first_step

  !> Fill the snapshot with due outputs and write it.
  subroutine write_report(model, held, state, monitor, cycle)
    type(model_t), intent(in) :: model
    real(wp), allocatable, intent(in) :: held(:, :) !! forces of skew supports, if any
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    logical :: follows !! energies of springs and bodies are known
    integer :: i

    call fill_motion(model, state, cycle%damping, cycle%velocity, monitor%snapshot)
    call fill_rigids(model, state, monitor%snapshot)
    if (cycle%due%tables(table_rwforc) .and. allocated(state%walls)) then
      do i = 1, size(state%walls)
        associate (result => monitor%snapshot%walls(i), wall => state%walls(i))
          result%normal_force = sum(wall%force)
          result%tangential_force = sum(wall%friction)
          result%force = result%normal_force*model%walls(i)%normal
          result%force = result%force + result%tangential_force*wall_tangent(model%walls(i))
          result%impulse = wall%impulse
          result%work = wall%work
          result%dissipated = wall%dissipated
          result%displacement = wall%displacement
          result%n_active = count(wall%force > 0.0_wp)
        end associate
      end do
    end if
    follows = any(cycle%due%tables([table_glstat, table_matsum])) &
      .or. (cycle%due%plot .and. size(model%contacts) > 0)
    if (follows) call fill_energies(model, state, cycle%damping, monitor%snapshot)
    if (cycle%due%tables(table_glstat)) call complete_balance(model, state, cycle%damping, &
      cycle%velocity, monitor%snapshot)
    call record_energies(model, follows, state, monitor)
    if (cycle%due%tables(table_matsum)) call fill_parts(model, state, monitor%snapshot)
    if (cycle%due%tables(table_glstat)) then
      call find_slowest(model, state, monitor%snapshot)
      cycle%ratio = energy_ratio(monitor%snapshot%energies)
    end if
    if (cycle%due%tables(table_spcforc)) &
      call fill_explicit_reactions(model, state, monitor%snapshot, held)
    if (cycle%due%tables(table_rbdout)) call fill_bodies(state%rigids, 0.5_wp*state%dt_before, &
      monitor%snapshot)
    call write_instant(model, cycle%due, state%dt, cycle%ratio, state, monitor, cycle%error)
    if (.not. allocated(cycle%error) .and. cycle%due%tables(table_glstat)) then
      call check_energy(model%controls, monitor%snapshot%energies, created_by_springs, cycle%error)
      if (.not. allocated(cycle%error)) call check_ratio(monitor%snapshot%energies, 0.0_wp, &
        energy_unaccounted, state%cycle, state%time, monitor%warned_ratio, monitor%log)
    end if
    call check_radii(model, state, monitor%warned_radii, monitor%log)
  end subroutine write_report

  !> Ids of the element with the smallest stable step and of its part, 0 where the curve determines
  !> the step; and whether that step is DT2MS.
  subroutine find_slowest(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer, allocatable :: found(:)
    real(wp), allocatable :: steps(:)

    snapshot%slowest = 0
    snapshot%by_dt2ms = 0
    if (model%controls%dt_curve > 0) then
      if (.not. abs(curve_value(model%curves(model%controls%dt_curve), state%time) - state%dt) &
        > 0.0_wp) return
    end if
    call find_smallest_steps(model, state%elements, state%motion, 1, found, steps)
    if (size(found) == 0) return
    ! An element of this step without added mass determines it itself.
    if (snapshot%energies%has_mass_scaling) snapshot%by_dt2ms = merge(1, 0, &
      abs(steps(1)/abs(model%controls%mass_step) - 1.0_wp) <= round_off .or. &
      (model%controls%mass_step > 0.0_wp .and. steps(1) > model%controls%mass_step))
    snapshot%slowest = [model%mesh%element_id(found(1)), &
      model%parts(slot_part(model%layout, model%layout%element_slot(found(1))))%id]
  end subroutine find_slowest

  !> Complete the energies of the snapshot: the leap-frog term of the kinetic energy -(dt^2/8) sum m
  !> a^2 and the damping work over the half step before t(n).
  subroutine complete_balance(model, state, damping, velocity_next, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)       !! D per direction
    real(wp), intent(in) :: velocity_next(:) !! (n_motion) v(n+1/2) of prescribed motions
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: dt, mean, inertia, prescribed, rigid_bodies, work, velocity(2), &
      acceleration(2)
    integer :: i

    ! At time zero use the coming step for the previous one.
    dt = merge(state%dt_before, state%dt, state%dt_before > 0.0_wp)
    mean = 0.5_wp*(state%dt + state%dt_before)
    prescribed = 0.0_wp
    if (state%dt > 0.0_wp) prescribed = sum(state%mass(model%conditions%motions%node) &
      *((velocity_next - state%prescribed_velocity)/mean)**2, is_active(model%conditions%motions, &
      state%time))
    inertia = free_inertia(model, state, damping) + prescribed
    rigid_bodies = 0.0_wp
    do i = 1, size(state%rigids)
      associate (rigid => state%rigids(i))
        rigid_bodies = rigid_bodies &
          + sum(rigid%inertia*((rigid%next_velocity - rigid%velocity)/mean)**2)
      end associate
    end do
    inertia = inertia + rigid_bodies
    if (allocated(model%conditions%common_motions)) &
      inertia = inertia + coupled_inertia(model, state, damping)
    if (allocated(state%walls) .and. .not. state%dt_before > 0.0_wp) &
      inertia = inertia - wall_power(model, state, damping)
    snapshot%energies%leapfrog = -0.125_wp*dt**2*inertia
    if (.not. allocated(state%previous_velocity)) return
    ! Work that the damping forces D m v(n) take over the half step behind.
    work = 0.0_wp
    do i = 1, model%mesh%n_node
      if (allocated(snapshot%velocity)) then
        velocity = snapshot%velocity(:, i)
      else
        call find_motion(model%layout%n_special, state, damping, i, velocity, acceleration)
      end if
      work = work + state%mass(i)*sum(damping_at(state, damping, i)*velocity*state%motion(3:4, i))
    end do
    snapshot%energies%damping = snapshot%energies%damping + 0.5_wp*state%dt_before*work
  end subroutine complete_balance

  !> Sum of m a^2 over free degrees of freedom, with a = (v(n+1/2) - v(n-1/2))/h.
  pure function free_inertia(model, state, damping) result(total)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    real(wp) :: total
    real(wp) :: velocity(2), a(2), late(2)
    integer :: i, k

    total = 0.0_wp
    ! At time zero damping acts on the mean of v(0) and v(1/2).
    late = 1.0_wp
    if (.not. state%dt_before > 0.0_wp) late = 1.0_wp + 0.25_wp*damping*state%dt
    do i = 1, model%mesh%n_node
      if (allocated(state%node_damping) .and. .not. state%dt_before > 0.0_wp) late = 1.0_wp &
        + 0.25_wp*state%node_damping(:, i)*state%dt
      call find_motion(model%layout%n_special, state, damping, i, velocity, a)
      do k = 1, 2
        if (state%inverse_mass(k, i) > 0.0_wp) total = total + state%mass(i)*(a(k)/late(k))**2
      end do
    end do
  end function free_inertia

  !> Sum of m a^2 over coupled nodes, with a = (v(n+1/2) - v(n-1/2))/h.
  pure function coupled_inertia(model, state, damping) result(total)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    real(wp) :: total
    real(wp) :: push, rate, a, before(2)
    integer :: i, k

    total = 0.0_wp
    do i = 1, size(model%conditions%common_motions)
      before = coupled_velocity(model, i, state)
      associate (common => model%conditions%common_motions(i))
        do k = 1, 2
          if (.not. common%along(k)) cycle
          call coupled_acceleration(model, i, k, state, damping, push, rate)
          a = (push - rate*before(k))/(1.0_wp &
            + 0.5_wp*rate*merge(state%dt_before, 0.5_wp*state%dt, state%dt_before > 0.0_wp))
          total = total + sum(state%mass(common%nodes))*a**2
        end do
      end associate
    end do
  end function coupled_inertia

  !> Sum of F.a of the wall forces: their work at time zero uses the mean of v(0) and v(1/2), other
  !> forces use v(1/2).
  pure function wall_power(model, state, damping) result(total)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    real(wp) :: total
    real(wp) :: velocity(2), a(2), push(2)
    integer :: i, k

    total = 0.0_wp
    do i = 1, size(state%walls)
      do k = 1, size(model%walls(i)%nodes)
        if (.not. state%walls(i)%force(k) > 0.0_wp) cycle
        call find_motion(model%layout%n_special, state, damping, model%walls(i)%nodes(k), &
          velocity, a)
        push = state%walls(i)%force(k)*model%walls(i)%normal
        if (size(state%walls(i)%friction) > 0) push = push + state%walls(i)%friction(k) &
          *wall_tangent(model%walls(i))
        total = total + dot_product(push, a/(1.0_wp + 0.25_wp*damping_at(state, damping, &
          model%walls(i)%nodes(k))*state%dt))
      end do
    end do
  end function wall_power

  !> Log the elements with the smallest stable steps.
  subroutine log_smallest_steps(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    integer, allocatable :: found(:)
    real(wp), allocatable :: steps(:)
    character(60) :: line
    integer :: i

    call find_smallest_steps(model, state%elements, state%motion, n_listed, found, steps)
    if (size(found) == 0) return
    call write_log(log, 'smallest stable steps of elements (TSSFAC not applied):')
    call write_log(log, '   element      part   stable step')
    do i = 1, size(found)
      write (line, '(ss,2i10,es14.6)') model%mesh%element_id(found(i)), &
        model%parts(slot_part(model%layout, model%layout%element_slot(found(i))))%id, steps(i)
      call write_log(log, trim(line))
    end do
  end subroutine log_smallest_steps

  !> Warn where the step is too long for the global damping. A free node keeps (2 - D dt)/(2 + D dt)
  !> of its velocity in a step (node_motion): this never grows, but deviates from exp(-D dt) for D
  !> dt > 1 and is negative for D dt > 2.
  subroutine warn_of_damping(model, dt, log)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: dt          !! first step, s
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text
    real(wp) :: largest, share

    if (.not. allocated(model%conditions%damping)) return
    associate (damping => model%conditions%damping)
      text = 'VALDMP'
      largest = damping%coefficient
      if (damping%curve > 0) then
        associate (curve => model%curves(damping%curve), end_time => model%controls%end_time)
          text = 'the largest ordinate of curve '//to_text(curve%id)
          largest = max(curve_value(curve, 0.0_wp), curve_value(curve, end_time), &
            maxval(curve%ordinate, curve%abscissa >= 0.0_wp .and. curve%abscissa <= end_time))
        end associate
      end if
      share = largest*maxval(damping%factor)*dt
      if (.not. share > 1.0_wp) return
      text = '*DAMPING_GLOBAL acts on all parts with D = ' &
        //to_text(largest*maxval(damping%factor))//' ('//text &
        //', times STX or STY); D dt = '//to_text(share)//' is above 1 (dt '//to_text(dt) &
        //'): a step multiplies velocities by '//to_text((2.0_wp - share)/(2.0_wp + share)) &
        //', the exact factor exp(-D dt) is '//to_text(exp(-share))
    end associate
    if (share > 2.0_wp) text = text//', and above 2 velocities change sign in every step'
    call warn(log, text//'; the run is stable, but inaccurate: reduce D or the time step')
  end subroutine warn_of_damping

end module explicit_report_m
