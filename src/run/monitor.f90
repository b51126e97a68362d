! SPDX-License-Identifier: MIT
!> Output of a run, shared by both drivers: schedules of the files, what is due, and writing it.
module monitor_m
  use clock_m, only : clock_t
  use error_indicator_m, only : evaluate_indicators, update_energy_peaks
  use controls_m, only : controls_t, interval_t, is_asked
  use curves_m, only : curve_t, curve_value
  use errors_m, only : error_t
  use history_file_m, only : histories_t, plan_histories, open_histories, flush_histories, &
    close_histories, n_each
  use history_filling_m, only : fill_boundaries, fill_history_elements, fill_sections
  use history_rows_m, only : append_rows
  use history_tables_m, only : history_tables, n_table, asked_or_states, asked_by_states, &
    table_rcforc, table_sleout, table_contact, table_elout, table_bndout, table_nodfor, &
    table_secforc
  use kinds_m, only : wp, long
  use log_m, only : log_t, write_log
  use model_m, only : model_t
  use progress_m, only : progress_t, start_progress, show_progress
  use ranks_m, only : ranks_t
  use restart_plan_m, only : restarts_t
  use results_file_m, only : results_file_t, run_info_t, open_results, append_state, finish_results
  use face_stress_m, only : face_rows_t
  use snapshot_m, only : snapshot_t, total_energy
  use snapshot_filling_m, only : start_snapshot, fill_interfaces, fill_plot
  use state_m, only : state_t
  use visitor_m, only : visited_t, visitor_t, any_length
  implicit none
  private
  public :: monitor_t, open_files, start_monitor, start_schedules, find_due, write_due, &
    record_energies, write_instant, finish_monitor, due_t, schedule_t, start_schedule, is_due, &
    mark_written, output_reach, resume_schedule

  !> Round-off of an output time as a share of a step: of two cycles at equal distance the first is
  !> due, although sums of steps carry rounding.
  real(wp), parameter :: forgiven = 1.0e-6_wp
  !> Share of a step by which a state may precede an output time where steps can be cut.
  real(wp), parameter :: soon = 1.0e-6_wp
  !> Shortest interval as a share of the run, so that counts stay finite, and the bound of these
  !> counts.
  real(wp), parameter :: shortest = 1.0e-9_wp
  integer(long), parameter :: most_outputs = 2_long**53

  !> Schedule of one output.
  type, extends(visited_t) :: schedule_t
    logical :: active = .false.         !! false: never due
    real(wp) :: interval = 0.0_wp       !! constant interval, s; unused with a curve
    logical :: varies = .false.         !! the interval comes from the curve
    type(curve_t) :: curve              !! interval against time, s
    integer(long) :: count = 0          !! multiples that are written
    real(wp) :: next = 0.0_wp           !! next output time, s
    real(wp) :: end_time = 0.0_wp       !! last possible output time, s
  contains
    procedure :: visit => visit_schedule
  end type schedule_t

  !> Outputs that are due in a cycle.
  type :: due_t
    logical :: plot = .false.
    logical :: tables(n_table) = .false. !! by the `table_` constants
  end type due_t

  !> Files, schedules, log, clock and progress lines of a run.
  type :: monitor_t
    type(schedule_t) :: plot
    type(schedule_t) :: tables(n_table) !! by the `table_` constants; inactive for tables written
                                        !! with plot states
    integer, allocatable :: scheduled(:) !! active tables
    type(results_file_t) :: results
    type(histories_t) :: histories
    type(snapshot_t) :: snapshot
    type(face_rows_t) :: rows          !! elements at contact surfaces
    integer, allocatable :: bodies(:)  !! (n_part) number of the body of each part
    type(log_t) :: log
    type(clock_t) :: clock
    type(progress_t) :: progress
    type(restarts_t) :: restarts
    type(ranks_t) :: ranks        !! the first process alone has files
    logical :: has_plot = .false. !! the deck asks for plot states
    logical :: warned_radii = .false. !! nodes across the axis have been reported
    logical :: warned_ratio = .false. !! a violated energy balance has been reported
    logical :: only_checks = .false. !! write the state at time zero only
  end type monitor_t

contains

  !> Open the files that the deck asks for. `prefix` is directory and job name.
  subroutine open_files(model, prefix, run_info, monitor, error)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: prefix
    type(run_info_t), intent(in) :: run_info
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: names
    integer :: k

    monitor%has_plot = is_asked(model%controls%output%plot)
    if (monitor%ranks%mine > 0) then
      call plan_histories(monitor%histories, model)
      return
    end if
    call open_histories(monitor%histories, prefix, model, error)
    if (allocated(error)) return
    names = ''
    do k = 1, n_table
      if (is_asked(model%controls%output%histories(k)) .and. n_each(model, k) <= 0) &
        names = names//', '//trim(history_tables(k)%name)
    end do
    if (len(names) > 0) call write_log(monitor%log, 'requested without content in the ' &
      //'model, not written: '//names(3:))
    if (monitor%has_plot) &
      call open_results(monitor%results, prefix//'.vtkhdf', model, run_info, &
        monitor%restarts%is_restart, error)
  end subroutine open_files

  !> Set up schedules, progress lines and the snapshot.
  subroutine start_monitor(model, has_history, monitor)
    type(model_t), intent(in) :: model
    logical, intent(in) :: has_history !! some part has a plastic strain
    type(monitor_t), intent(inout) :: monitor

    call start_schedules(model, monitor)
    call start_progress(monitor%progress, model%controls%end_time, &
      model%controls%output%status_interval)
    monitor%restarts%is_implicit = model%controls%implicit%is_on
    monitor%restarts%dump_cycles = model%controls%output%dump_cycles
    monitor%restarts%running_cycles = model%controls%output%running_cycles
    if (monitor%ranks%mine == 0) call start_snapshot(model, has_history, monitor%snapshot)
  end subroutine start_monitor

  !> Set up the schedules. Energies go with plot states where the deck gives them no interval, so
  !> that every run has an energy history.
  subroutine start_schedules(model, monitor)
    type(model_t), intent(in) :: model
    type(monitor_t), intent(inout) :: monitor
    type(interval_t) :: interval
    integer :: k

    associate (plan => model%controls%output, end_time => model%controls%end_time)
      call start_schedule(monitor%plot, plan%plot, model%curves, end_time)
      do k = 1, n_table
        ! A table without rows makes no cycle due.
        if (n_each(model, k) <= 0) cycle
        interval = plan%histories(k)
        if (history_tables(k)%asked == asked_or_states .and. .not. is_asked(interval)) &
          interval = plan%plot
        call start_schedule(monitor%tables(k), interval, model%curves, end_time)
      end do
      monitor%scheduled = pack([(k, k=1, n_table)], [(monitor%tables(k)%active, k=1, n_table)])
    end associate
  end subroutine start_schedules

  !> Outputs due at `time`; `everything` for the first and the last state.
  pure function find_due(monitor, time, dt, everything) result(due)
    type(monitor_t), intent(in) :: monitor
    real(wp), intent(in) :: time, dt
    logical, intent(in) :: everything
    type(due_t) :: due
    integer :: i

    if (monitor%has_plot) due%plot = everything .or. is_due(monitor%plot, time, dt)
    if (everything) then
      due%tables = .true.
    else
      do i = 1, size(monitor%scheduled)
        due%tables(monitor%scheduled(i)) = is_due(monitor%tables(monitor%scheduled(i)), time, dt)
      end do
    end if
    if (everything .or. due%plot) where (history_tables%asked == asked_by_states) &
      due%tables = due%plot
  end function find_due

  !> Write the due outputs from the snapshot.
  subroutine write_due(model, due, dt, monitor, error)
    type(model_t), intent(in) :: model
    type(due_t), intent(in) :: due
    real(wp), intent(in) :: dt
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error
    integer :: k

    if (monitor%only_checks) then
      if (due%plot) call append_state(monitor%results, model, monitor%snapshot, error)
      return
    end if
    associate (shot => monitor%snapshot, histories => monitor%histories)
      do k = 1, n_table
        if (due%tables(k)) call append_rows(histories%tables(k), k, model, shot)
      end do
      if (due%plot .and. monitor%ranks%mine == 0) then
        call append_state(monitor%results, model, shot, error)
        if (allocated(error)) return
      end if
      call flush_histories(histories, due%plot .and. monitor%ranks%mine == 0, error)
      do k = 1, n_table
        if (due%tables(k)) call mark_written(monitor%tables(k), shot%time, dt)
      end do
      if (due%plot) call mark_written(monitor%plot, shot%time, dt)
    end associate
  end subroutine write_due

  !> Record the initial energy at time zero and the largest energies of springs and bodies.
  subroutine record_energies(model, knows_parts, state, monitor)
    type(model_t), intent(in) :: model
    logical, intent(in) :: knows_parts !! internal energies of parts are in the snapshot
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor

    if (state%cycle == 0) then
      state%initial_energy = total_energy(monitor%snapshot%energies)
      monitor%snapshot%energies%initial = state%initial_energy
    end if
    if (knows_parts) call update_energy_peaks(model, monitor%snapshot%parts, monitor%bodies, state)
  end subroutine record_energies

  !> Complete the snapshot, of which the driver has filled its own part, and write the due outputs.
  subroutine write_instant(model, due, dt, ratio, state, monitor, error)
    type(model_t), intent(in) :: model
    type(due_t), intent(in) :: due
    real(wp), intent(in) :: dt    !! tolerance of output times (`output_reach`), s
    real(wp), intent(in) :: ratio !! last known energy ratio
    type(state_t), intent(inout) :: state
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(inout) :: error

    associate (shot => monitor%snapshot)
      if (any(due%tables([table_rcforc, table_sleout, table_contact]))) &
        call fill_interfaces(model, state, shot)
      if (due%tables(table_elout)) call fill_history_elements(model, state, shot)
      if (any(due%tables([table_bndout, table_nodfor]))) call fill_boundaries(state, shot)
      if (due%tables(table_secforc)) call fill_sections(model, state, shot)
      if (due%plot) call fill_plot(model, state, shot)
      if (any(due%tables([table_sleout, table_contact]))) &
        call evaluate_indicators(model, state, due%plot, monitor%rows, shot)
    end associate
    call write_due(model, due, dt, monitor, error)
    if (due%plot .and. .not. allocated(error)) call show_progress(monitor%progress, monitor%clock, &
      state%cycle, state%time, state%dt, ratio, 'write vtkhdf state')
  end subroutine write_instant

  !> Close the files.
  subroutine finish_monitor(monitor, error)
    type(monitor_t), intent(inout) :: monitor
    type(error_t), allocatable, intent(out) :: error

    call close_histories(monitor%histories, error)
    if (allocated(error)) return
    call finish_results(monitor%results, monitor%histories, error)
  end subroutine finish_monitor

  ! ---- schedules: an output is due at time zero and at the cycle nearest to each multiple of its
  ! interval. Multiples are formed as k times the interval, never by adding, so that nothing drifts.
  ! An interval that varies (a curve of time) leads from each output time to the next.

  !> Set up the schedule of an interval from time zero to `end_time`.
  pure subroutine start_schedule(schedule, interval, curves, end_time)
    type(schedule_t), intent(out) :: schedule
    type(interval_t), intent(in) :: interval
    type(curve_t), intent(in) :: curves(:)   !! the model's curves
    real(wp), intent(in) :: end_time         !! s

    schedule%end_time = end_time
    schedule%varies = interval%curve > 0
    if (schedule%varies) schedule%curve = curves(interval%curve)
    schedule%active = schedule%varies .or. interval%dt > 0.0_wp
    schedule%interval = max(interval%dt, shortest*end_time)
  end subroutine start_schedule

  !> Step by which the state nearest to an output time is found. An automatic implicit step may be
  !> cut, so the state at or after an output time counts there.
  pure function output_reach(controls, dt) result(reach)
    type(controls_t), intent(in) :: controls
    real(wp), intent(in) :: dt     !! step from the state to the next, s
    real(wp) :: reach

    reach = dt
    if (controls%implicit%is_on .and. controls%implicit%is_automatic) reach = soon*dt
  end function output_reach

  !> Whether the state at `time` is the nearest to the next output time; `dt` is the step between
  !> states.
  pure function is_due(schedule, time, dt) result(due)
    type(schedule_t), intent(in) :: schedule
    real(wp), intent(in) :: time, dt   !! s
    logical :: due
    real(wp) :: step

    due = schedule%active
    step = min(dt, schedule%end_time)
    if (due) due = schedule%next <= schedule%end_time + forgiven*step .and. &
      schedule%next <= time + (0.5_wp + forgiven)*step
  end function is_due

  !> Advance to the first output time that a later state is nearest to. Several intervals within one
  !> step are written once.
  pure subroutine mark_written(schedule, time, dt)
    type(schedule_t), intent(inout) :: schedule
    real(wp), intent(in) :: time, dt   !! s, as given to `is_due`

    ! The first state may lie far beyond the end time.
    if (.not. schedule%varies .and. schedule%active) schedule%count = max(schedule%count, &
      int((min(time, schedule%end_time) + (0.5_wp + forgiven)*min(dt, schedule%end_time)) &
      /schedule%interval, long) - 1)
    do while (is_due(schedule, time, dt))
      call advance(schedule)
    end do
  end subroutine mark_written

  !> Advance to the next output time. A curve that falls to zero ends the output.
  pure subroutine advance(schedule)
    type(schedule_t), intent(inout) :: schedule
    real(wp) :: interval

    schedule%count = schedule%count + 1
    if (.not. schedule%varies) then
      schedule%next = real(schedule%count, wp)*schedule%interval
      return
    end if
    interval = curve_value(schedule%curve, schedule%next)
    schedule%next = schedule%next + max(interval, shortest*schedule%end_time)
    if (interval <= 0.0_wp) schedule%active = .false.
  end subroutine advance

  !> Take over the schedule of the run before a restart. With another interval the first output
  !> comes at the next multiple of the new one.
  pure subroutine resume_schedule(kept, time, dt, schedule)
    type(schedule_t), intent(in) :: kept            !! of the run before
    real(wp), intent(in) :: time, dt      !! of the state before, as given to `is_due`
    type(schedule_t), intent(inout) :: schedule     !! planned from the deck
    logical :: same, follows

    same = kept%varies .eqv. schedule%varies
    follows = same .and. schedule%varies
    if (same .and. .not. follows) same = (kept%active .eqv. schedule%active) &
      .and. .not. abs(kept%interval - schedule%interval) > 0.0_wp
    if (follows) same = allocated(kept%curve%ordinate) .and. allocated(kept%curve%abscissa)
    if (follows .and. same) same = size(kept%curve%ordinate) == size(schedule%curve%ordinate) &
      .and. size(kept%curve%abscissa) == size(schedule%curve%abscissa)
    if (follows .and. same) same = &
      all(.not. abs(kept%curve%ordinate - schedule%curve%ordinate) > 0.0_wp) &
      .and. all(.not. abs(kept%curve%abscissa - schedule%curve%abscissa) > 0.0_wp)
    if (same) then
      schedule%active = kept%active
      schedule%count = kept%count
      schedule%next = kept%next
    else
      call mark_written(schedule, time, dt)
    end if
  end subroutine resume_schedule

  !> Visit the components; the end time comes from the deck, which may change it.
  subroutine visit_schedule(self, visitor)
    class(schedule_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('active', self%active)
    call visitor%visit('interval', self%interval)
    call visitor%visit('varies', self%varies)
    call visitor%visit('curve_abscissa', self%curve%abscissa, any_length)
    call visitor%visit('curve_ordinate', self%curve%ordinate, any_length)
    call visitor%visit('count', self%count, most_outputs, 'a count that no run can reach')
    call visitor%visit('next', self%next, 0.0_wp, 'a time below zero')
  end subroutine visit_schedule

end module monitor_m
