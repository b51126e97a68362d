! SPDX-License-Identifier: MIT
!> A cycle of an explicit run that writes: what the elements have come to, and what is due from it.
module explicit_report_m
  use boundary_account_m, only : count_boundary_motions, count_boundary_bodies, count_groups
  use contact_check_m, only : report_contact_start
  use contact_judging_m, only : judge_contacts
  use contact_softness_m, only : follow_softness
  use energies_m, only : energy_ratio, total_energy
  use erosion_account_m, only : settle_elements, note_least_step
  use explicit_prescribed_m, only : start_prescribed, prescribed_work
  use history_filling_m, only : fill_boundaries, fill_history_elements, fill_sections, &
    fill_explicit_reactions
  use history_tables_m, only : table_glstat, table_rcforc, table_matsum, table_rwforc, &
    table_sleout, table_spcforc, table_contact, table_elout, table_rbdout, table_bndout, &
    table_nodfor, table_secforc
  use first_change_m, only : first_change
  use health_m, only : check_energy, check_ratio, check_radii, made_by_springs, unaccounted
  use kinds_m, only : wp
  use leapfrog_balance_m, only : complete_balance
  use log_m, only : write_log, to_text
  use model_log_m, only : log_smallest_steps, judge_damping
  use model_m, only : model_t
  use monitor_m, only : monitor_t, write_due
  use motion_sums_m, only : count_sums
  use rigid_motion_m, only : solve_rigids, start_rigid_motions, rigid_work, fill_rigids, &
    fill_bodies
  use progress_m, only : show_progress
  use rank_exchange_m, only : judge_elements
  use ranks_m, only : share_error, spread_values
  use snapshot_filling_m, only : fill_motion, fill_energies, fill_parts, fill_interfaces, &
    fill_plot
  use skew_motion_m, only : hold_skew_nodes
  use slowest_element_m, only : find_slowest
  use state_m, only : state_t
  use wall_motion_m, only : hold_nodes, count_walls, fill_walls
  use time_step_m, only : first_step, shorten_first_step, obey_approach, obey_defaults, &
    follow_springs
  use explicit_cycle_m, only : explicit_cycle_t, prepare_leap, press_cycle
  use node_motion_m, only : leap_t
  implicit none
  private
  public :: report_cycle

contains

  !> Write what is due, unless the state has gone wrong; the first cycle first finds its step.
  subroutine report_cycle(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp), allocatable :: held(:, :)

    call count_sums(cycle%sums, state%external_work, state%damping_work)
    if (model%erodes) call settle_elements(model, state, monitor%log, cycle%freed)
    call judge_elements(monitor%ranks, model, state, cycle%error)
    if (state%cycle == 0) then
      call obey_defaults(model, state)
      call follow_springs(model, state, cycle%steps%springs)
    end if
    if (state%cycle == 0 .and. .not. allocated(cycle%error)) &
      call first_step(model, state%elements, monitor%log, cycle%steps, state%dt, cycle%error)
    if (allocated(cycle%error)) then
      cycle%finished = .true.
      return
    end if
    if (state%cycle == 0) then
      call bound_first_change(model, state, monitor, cycle)
      if (model%erodes) call note_least_step(model%controls, cycle%steps%first_dt, state)
      call prepare_leap(model, state, cycle)
      call start_prescribed(model, cycle%velocity, state)
      if (cycle%presses) call press_cycle(model, state, monitor, cycle)
      call report_contact_start(model, state, monitor%log)
      if (monitor%ranks%mine == 0) call log_smallest_steps(model, state, monitor%log)
      call judge_damping(model, state%dt, monitor%log)
    end if
    call report_rigids(model, state, cycle)
    call report_walls(model, state, cycle)
    if (allocated(model%conditions%skew_supports)) call report_skew(model, cycle%leap, state, held)
    state%external_work = state%external_work + prescribed_work(model, state, cycle%velocity, &
      cycle%damping, 0.5_wp*state%dt_before, 0.0_wp)
    if (allocated(state%boundary_work)) call count_boundary_motions(model, cycle%velocity, &
      cycle%damping, .true., .false., state)
    if (allocated(state%group_work)) call count_groups(model, .true., .false., state)
    if (monitor%ranks%mine == 0) call write_report(model, held, state, monitor, cycle)
    if (monitor%ranks%n > 1) call hear_report(model, state, monitor, cycle)
    cycle%finished = cycle%last .or. allocated(cycle%error)
  end subroutine report_cycle

  !> A shorter first step where elements would change their volume by too much in it, or bodies come
  !> too far into each other.
  subroutine bound_first_change(model, state, monitor, cycle)
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
    call obey_approach(model, dt, state, monitor%log, cycle%steps, limit)
    if (model%controls%dt_scale*limit < dt) then
      state%dt = model%controls%dt_scale*limit
      cycle%steps%constant = 0.0_wp
      call write_log(monitor%log, 'first time step shortened to '//to_text(state%dt) &
        //': bodies would come deeper into each other in it than a first contact may be')
    end if
    call prepare_leap(model, state, cycle)
    call first_change(model, cycle%shares, cycle%leap, cycle%velocity, state, monitor%ranks, change)
    call shorten_first_step(monitor%log, cycle%steps, state%dt, change)
    state%contacts%advance = state%contacts%advance*(state%dt/dt)
    ! What the elements of the first cycle could not yet tell the step of the second one.
    cycle%checks(cycle%first_check)%volume_change = change
  end subroutine bound_first_change

  !> Fill the snapshot with what is due, and write it.
  subroutine write_report(model, held, state, monitor, cycle)
    type(model_t), intent(in) :: model
    real(wp), allocatable, intent(in) :: held(:, :) !! by skew supports, where there are any
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    logical :: follows !! springs beside the bodies, of which energies are known

    call fill_motion(model, state, cycle%damping, cycle%velocity, monitor%snapshot)
    call fill_rigids(model, state, monitor%snapshot)
    if (cycle%due%tables(table_rwforc) .and. allocated(state%walls)) &
      call fill_walls(model, state, monitor%snapshot%walls)
    follows = any(cycle%due%tables([table_glstat, table_matsum])) &
      .or. (cycle%due%plot .and. size(model%contacts) > 0)
    if (follows) call fill_energies(model, state, cycle%damping, monitor%snapshot)
    if (cycle%due%tables(table_glstat)) call complete_balance(model, state, cycle%damping, &
      cycle%velocity, monitor%snapshot)
    if (state%cycle == 0) then
      state%initial_energy = total_energy(monitor%snapshot%energies)
      monitor%snapshot%energies%initial = state%initial_energy
    end if
    if (follows) call follow_softness(model, monitor%snapshot%parts, monitor%bodies, state)
    if (cycle%due%tables(table_matsum)) call fill_parts(model, state%elements, &
      monitor%snapshot)
    if (cycle%due%tables(table_glstat)) call find_slowest(model, state, monitor%snapshot)
    if (any(cycle%due%tables([table_rcforc, table_sleout, table_contact]))) &
      call fill_interfaces(model, state, monitor%snapshot)
    if (cycle%due%tables(table_spcforc)) &
      call fill_explicit_reactions(model, state, monitor%snapshot, held)
    if (cycle%due%tables(table_elout)) call fill_history_elements(model, state, monitor%snapshot)
    if (any(cycle%due%tables([table_bndout, table_nodfor]))) &
      call fill_boundaries(state, monitor%snapshot)
    if (cycle%due%tables(table_secforc)) call fill_sections(model, state, monitor%snapshot)
    if (cycle%due%tables(table_rbdout)) call fill_bodies(state, monitor%snapshot)
    if (cycle%due%plot) call fill_plot(model, state, monitor%snapshot)
    if (any(cycle%due%tables([table_sleout, table_contact]))) &
      call judge_contacts(model, state, cycle%due%plot, monitor%rows, monitor%snapshot)
    call write_due(model, cycle%due, state%dt, monitor, cycle%error)
    if (cycle%due%tables(table_glstat)) cycle%ratio = energy_ratio(monitor%snapshot%energies)
    if (cycle%due%plot .and. .not. allocated(cycle%error)) call show_progress(monitor%progress, &
      monitor%clock, state%cycle, state%time, state%dt, cycle%ratio, 'write vtkhdf state')
    if (.not. allocated(cycle%error) .and. cycle%due%tables(table_glstat)) then
      call check_energy(model%controls, monitor%snapshot%energies, made_by_springs, cycle%error)
      if (.not. allocated(cycle%error)) call check_ratio(monitor%snapshot%energies, 0.0_wp, &
        unaccounted, state%cycle, state%time, monitor%told_ratio, monitor%log)
    end if
    call check_radii(model, state, monitor%told_radii, monitor%log)
  end subroutine write_report

  !> What a process that writes nothing has to know of the report, and what came of it.
  subroutine hear_report(model, state, monitor, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(explicit_cycle_t), intent(inout) :: cycle
    real(wp) :: energy(1)

    if (monitor%ranks%mine > 0) then
      monitor%snapshot%time = state%time
      call write_due(model, cycle%due, state%dt, monitor, cycle%error)
    end if
    energy = state%initial_energy
    if (state%cycle == 0) call spread_values(monitor%ranks, energy)
    state%initial_energy = energy(1)
    call share_error(monitor%ranks, cycle%error)
  end subroutine hear_report

  !> Skew supports in a cycle that writes: their nodes are held, and by what force.
  subroutine report_skew(model, leap, state, held)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    type(state_t), intent(inout) :: state
    real(wp), allocatable, intent(out) :: held(:, :) !! (2, n_skew)

    integer :: i, n

    n = size(model%conditions%skew_supports)
    allocate (held(2, n))
    do i = 1, n
      held(:, i) = -state%force_special(:, model%conditions%skew_supports(i)%node)
    end do
    call hold_skew_nodes(model, leap, 1, model%layout%n_special, state)
    do i = 1, n
      held(:, i) = held(:, i) + state%force_special(:, model%conditions%skew_supports(i)%node)
    end do
  end subroutine report_skew

  !> Rigid bodies in a cycle that writes: what their forces ask for, and the work of
  !> prescribed motion so far.
  subroutine report_rigids(model, state, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(in) :: cycle

    if (size(state%rigids) == 0) return
    call solve_rigids(model, cycle%damping, state)
    if (state%cycle == 0) call start_rigid_motions(model, state)
    state%external_work = state%external_work + rigid_work(model, state, cycle%damping, &
      0.5_wp*state%dt_before, 0.0_wp)
    if (allocated(state%boundary_work)) call count_boundary_bodies(model, cycle%damping, &
      .true., .false., state)
  end subroutine report_rigids

  !> Rigid walls in a cycle that writes: their forces, and their work so far.
  subroutine report_walls(model, state, cycle)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(in) :: cycle

    if (.not. allocated(state%walls)) return
    call hold_nodes(model, cycle%leap, 1, model%layout%n_special, state)
    call count_walls(model, .true., .false., state)
  end subroutine report_walls

end module explicit_report_m
