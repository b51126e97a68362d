! SPDX-License-Identifier: MIT
!> One interface, one step: gather, search, place, law, scatter, energy limit, work.
module interface_m
  use clock_m, only : clock_t, lap, phase_contact_search, phase_contact_pairing, &
    phase_contact_force
  use caught_aside_m, only : energy_caught
  use closing_m, only : close_contacts, closed_gap_of
  use contact_dispatch_m, only : formulation_t, formulation_of, place_points
  use behind_ties_m, only : leave_to_tie, take_over
  use contact_law_m, only : press_places, pressed_at_slave_nodes
  use contact_log_m, only : log_contact
  use contact_preparation_m, only : prepare_contact
  use contact_scatter_m, only : scatter_forces, join_passes
  use contact_springs_m, only : begin_look, measure_springs, end_look
  use contact_work_m, only : apart_t, take_apart, hand_over, count_work
  use contact_state_m, only : contact_state_t, is_free
  use contacts_m, only : contact_t, is_tied, penalty_implicit
  use crossing_m, only : crossings_t, find_crossings, catch_crossings
  use damping_m, only : damp_points, find_lag
  use energy_limit_m, only : keep_former_springs, form_springs, limit_forces, lend
  use facing_change_m, only : rest_loose_nodes
  use facing_look_m, only : has_outline, start_facing, look_at_facing, make_present
  use friction_m, only : start_trial_slip, take_trial_motion, rub_places
  use first_search_m, only : start_slave_tracking, start_master_tracking, start_segments
  use gather_m, only : gather_places, take_force, keep_former
  use others_memory_m, only : answers_t
  use interference_m, only : begin_growth
  use kinds_m, only : wp
  use law_friction_m, only : has_decay
  use look_ahead_m, only : look_ahead, look_back
  use log_m, only : log_t
  use model_m, only : model_t
  use spots_m, only : move_spots
  use tips_m, only : has_folds, find_tips
  use tied_interface_m, only : start_ties, apply_ties, evaluate_ties
  use tracking_m, only : update_tracking, wake_all, forget_pairs, measure_depths
  implicit none
  private
  public :: start_contact, resume_contact, apply_contact, evaluate_contact

contains

  !> Set up the memory of one interface at time zero and tell the log what was understood.
  subroutine start_contact(contact, model, log, memory, answers)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(contact_state_t), intent(out) :: memory
    type(answers_t), intent(inout), optional :: answers
    type(formulation_t) :: formulation

    formulation = formulation_of(contact)
    call prepare_contact(contact, model, memory)
    call start_search(contact, model, memory, answers)
    if (is_tied(contact)) call start_ties(contact, model, memory)
    call log_contact(contact, model, formulation%kind, memory, log)
  end subroutine start_contact

  !> Who touches whom at time zero, between whole surfaces or between runs of them.
  subroutine start_search(contact, model, memory, answers)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(answers_t), intent(inout), optional :: answers
    type(contact_t), allocatable :: present

    if (has_outline(contact)) then
      call start_facing(contact, memory)
      call move_alloc(memory%facing%present, present)
      if (min(present%slave%n_segment, present%master%n_segment) > 0) &
        call search_between(present)
      call move_alloc(present, memory%facing%present)
    else
      call search_between(contact)
    end if

  contains

    !> The first search of an interface.
    subroutine search_between(contact)
      type(contact_t), intent(in) :: contact

      call start_slave_tracking(contact, model, memory, answers)
      if (memory%master_tracking%n > 0) &
        call start_master_tracking(contact, model, memory, answers)
      if (allocated(memory%segments%status)) call start_segments(contact, model, memory, answers)
    end subroutine search_between

  end subroutine start_search

  !> Contact forces of one interface at the present u, added to `force`, and their work since the
  !> previous call (trapezoidal rule). Laps the phases of the clock.
  subroutine apply_contact(contact, motion, mass, time, dt, cycle, clock, memory, force)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)      !! (4, n_node) u(n), v(n-1/2)
    real(wp), intent(in), contiguous :: mass(:)           !! (n_node) kg/m
    real(wp), intent(in) :: time                          !! of u, s
    real(wp), intent(in) :: dt                            !! step that led to u, 0 at the start
    integer, intent(in) :: cycle
    type(clock_t), intent(inout) :: clock
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)    !! (2, at least the interface's nodes)
    type(contact_t), allocatable :: present

    if (allocated(memory%interference%depth)) call begin_growth(contact, time, memory)
    if (is_suspended(contact, time)) then
      call suspend_contact(motion, dt, memory)
    else if (is_tied(contact)) then
      call apply_ties(contact, motion, [time, dt], cycle, clock, memory, force)
    else if (memory%facing%is_used) then
      call follow_runs(contact, motion, memory)
      call move_alloc(memory%facing%present, present)
      call apply_between(present, motion, mass, [time, dt], cycle, clock, memory, force)
      call move_alloc(present, memory%facing%present)
    else
      call apply_between(contact, motion, mass, [time, dt], cycle, clock, memory, force)
    end if
  end subroutine apply_contact

  !> The same between two surfaces, or between the present runs of them.
  subroutine apply_between(contact, motion, mass, times, cycle, clock, memory, force)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)      !! (4, n_node) u(n), v(n-1/2)
    real(wp), intent(in), contiguous :: mass(:)           !! (n_node) kg/m
    real(wp), intent(in) :: times(2)                      !! of u, and the step that led to it, s
    integer, intent(in) :: cycle
    type(clock_t), intent(inout) :: clock
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)    !! (2, at least the interface's nodes)
    type(formulation_t) :: formulation
    type(apart_t) :: apart
    logical :: had_force, is_born

    if (contact%penalty_unit == penalty_implicit) then
      call place_ahead(contact, motion, cycle, clock, memory)
      return
    end if
    formulation = formulation_of(contact)
    had_force = memory%n_active > 0
    is_born = memory%is_stale .and. cycle > 0
    call gather_spots(contact, motion, memory)
    call search_pairs(contact, cycle, memory)
    call lap(clock, phase_contact_search)
    if (has_folds(contact) .and. formulation%where_pressed == pressed_at_slave_nodes) &
      call find_tips(contact%slave, memory)
    call set_forces_aside(motion, had_force, memory, apart)
    call place_points(contact, memory)
    call lap(clock, phase_contact_pairing)
    if (memory%points%n > 0) then
      call press_places(memory%contact_law, formulation%where_pressed, memory)
      if (contact%behind > 0) then
        call leave_to_tie(memory)
        call take_over(memory)
      end if
      call look_at_springs(cycle, memory)
      ! Springs born or caught loaded make what they hold: that is told, and may be returned.
      if (is_born) then
        memory%limit%credit = memory%limit%credit + memory%watch%stored
      else
        call lend(energy_caught(contact, formulation%has_unit_area, memory), memory%limit)
      end if
      if (has_decay(contact%friction) .and. times(2) > 0.0_wp) call find_lag(memory%points, &
        memory%nodes, mass, contact%is_self, times(2), memory%scratch%nodal, memory%scratch%lag)
      if (allocated(memory%friction%force)) &
        call rub_places(contact, formulation%has_unit_area, times(2), memory)
      if (contact%damping > 0.0_wp) call damp_points(memory%points, contact%damping, &
        memory%nodes, motion, mass, contact%is_self, memory%scratch%nodal)
      call scatter_forces(memory)
      if (contact%is_self) call join_passes(memory)
      if (had_force .or. memory%n_active > 0) call limit_forces(motion, times(1), times(2), memory)
    end if
    if (memory%points%n > 0 .or. had_force) &
      call hand_over(times(2), motion, apart, memory, force)
    call end_look(had_force, memory%n_active > 0, memory%watch)
    call lap(clock, phase_contact_force)
  end subroutine apply_between

  !> Implicit penalties: the points, of all that may touch in the step ahead. Their forces follow
  !> (implicit_penalty).
  subroutine place_ahead(contact, motion, cycle, clock, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)
    integer, intent(in) :: cycle
    type(clock_t), intent(inout) :: clock
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: travel !! before the step behind, m

    memory%scratch%had_force = memory%n_active > 0
    memory%scratch%waits = .true.
    memory%scratch%is_born = memory%is_stale .and. cycle > 0
    travel = memory%travel
    call gather_spots(contact, motion, memory)
    call search_pairs(contact, cycle, memory)
    call look_ahead(contact, cycle == 0 .or. memory%scratch%is_born, memory%travel - travel, memory)
    call lap(clock, phase_contact_search)
    memory%n_active = 0
    memory%watch%has_looked = .false.
    call begin_look(memory%scratch%had_force, memory%watch)
    if (memory%scratch%had_force) call keep_former(memory)
    call place_points(contact, memory)
    call look_back(memory)
    call lap(clock, phase_contact_pairing)
  end subroutine place_ahead

  !> Before the points are placed: the forces of the last call stand aside, for their half of the
  !> work of the step.
  pure subroutine set_forces_aside(motion, had_force, memory, apart)
    real(wp), intent(in), contiguous :: motion(:, :)
    logical, intent(in) :: had_force              !! that call had some
    type(contact_state_t), intent(inout) :: memory
    type(apart_t), intent(out) :: apart

    memory%n_active = 0
    call begin_look(had_force, memory%watch)
    if (had_force) call keep_former(memory)
    call keep_former_springs(had_force, memory)
    call take_apart(motion, had_force, memory, apart)
  end subroutine set_forces_aside

  !> The springs as pressed, in calls that look at them. Those loaded at time zero hold energy that
  !> no force has put in.
  pure subroutine look_at_springs(cycle, memory)
    integer, intent(in) :: cycle
    type(contact_state_t), intent(inout) :: memory

    if (memory%watch%is_due .or. cycle == 0) call measure_springs(memory)
    if (cycle == 0) memory%energy = memory%watch%stored
  end subroutine look_at_springs

  !> Contact forces of one interface at the given u, added to `force`; no damping, no energy, no
  !> clock. The memory is taken from the last converged step: give a copy of it to each trial, so
  !> that forces are a function of u.
  pure subroutine evaluate_contact(contact, motion, time, dt, is_first, memory, force)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u, and u minus that of the
                                                       !! start of the step
    real(wp), intent(in) :: time                       !! of u, s
    real(wp), intent(in) :: dt                         !! of the step to u, s
    logical, intent(in) :: is_first                    !! of a step: gaps of zero count as contact
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)
    type(contact_t), allocatable :: present

    if (is_tied(contact)) then
      if (is_suspended(contact, time)) memory%points%n = 0
      call evaluate_ties(motion, memory, force)
      return
    end if
    if (allocated(memory%interference%depth)) call begin_growth(contact, time, memory)
    memory%is_stale = memory%is_stale .or. is_suspended(contact, time)
    if (memory%facing%is_used .and. .not. is_suspended(contact, time)) &
      call follow_runs_in_step(contact, motion, memory)
    memory%points%n = 0
    memory%n_active = 0
    memory%force = 0.0_wp
    memory%closed_gap = 0.0_wp
    if (allocated(memory%friction%force)) call start_trial_slip(dt, memory)
    if (is_suspended(contact, time)) return
    if (.not. memory%facing%is_used) then
      call evaluate_between(contact, motion, is_first, memory, force)
      return
    end if
    call move_alloc(memory%facing%present, present)
    if (min(present%slave%n_segment, present%master%n_segment) > 0) &
      call evaluate_between(present, motion, is_first, memory, force)
    call move_alloc(present, memory%facing%present)
  end subroutine evaluate_contact

  !> The same between two surfaces, or between the present runs of them.
  pure subroutine evaluate_between(contact, motion, is_first, memory, force)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u, and u minus that of the
                                                       !! start of the step
    logical, intent(in) :: is_first                    !! of a step: gaps of zero count as contact
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)
    type(formulation_t) :: formulation
    type(crossings_t) :: crossings
    integer :: i

    formulation = formulation_of(contact)
    call gather_spots(contact, motion, memory)
    if (allocated(memory%friction%force)) call take_trial_motion(motion, memory)
    call find_crossings(contact, motion, memory, crossings)
    call search_pairs(contact, 0, memory)
    call catch_crossings(contact, crossings, memory)
    if (is_first) call close_contacts(contact, closed_gap_of(contact, memory), memory)
    if (has_folds(contact) .and. formulation%where_pressed == pressed_at_slave_nodes) &
      call find_tips(contact%slave, memory, motion)
    call place_points(contact, memory)
    if (memory%points%n == 0) return
    call press_places(memory%contact_law, formulation%where_pressed, memory)
    if (contact%behind > 0) call leave_to_tie(memory)
    if (allocated(memory%friction%force)) &
      call rub_places(contact, formulation%has_unit_area, memory%scratch%dt, memory)
    call scatter_forces(memory)
    if (contact%is_self) call join_passes(memory)
    do i = 1, size(memory%nodes)
      associate (node => memory%nodes(i))
        force(:, node) = force(:, node) + memory%force(:, i)
      end associate
    end do
  end subroutine evaluate_between

  !> Where there is a whole outline: the runs that face each other at the present u.
  pure subroutine follow_runs(contact, motion, memory)
    type(contact_t), intent(in) :: contact !! of the deck
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    logical :: was_stale

    was_stale = memory%is_stale
    if (was_stale) call refresh_memory(motion, memory)
    call gather_places(motion, memory)
    call look_at_facing(contact, 0.0_wp, was_stale, memory)
    ! What comes after has to know that contact begins.
    memory%is_stale = was_stale
  end subroutine follow_runs

  !> The same in a trial step: who faces whom where it starts, within reach of its motion.
  pure subroutine follow_runs_in_step(contact, motion, memory)
    type(contact_t), intent(in) :: contact !! of the deck
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) u, and u minus that of the start
                                                     !! of the step
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: low(2), high(2)
    integer :: i

    if (memory%is_stale) then
      call refresh_memory(motion, memory)
      call look_at_facing(contact, 0.0_wp, .true., memory)
    else
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do i = 1, size(memory%nodes)
        low = min(low, motion(3:4, memory%nodes(i)))
        high = max(high, motion(3:4, memory%nodes(i)))
      end do
      call look_at_facing(contact, norm2(high - low), .false., memory)
    end if
    call gather_places(motion, memory)
  end subroutine follow_runs_in_step

  !> After a restart: what follows from the memory of an interface that has been read.
  pure subroutine resume_contact(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    if (memory%facing%is_used) call make_present(contact, memory)
    call measure_depths(memory%slave_tracking)
    call measure_depths(memory%master_tracking)
    call form_springs(memory)
  end subroutine resume_contact

  !> Whether a time is outside birth .. death.
  pure function is_suspended(contact, time)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: time
    logical :: is_suspended

    is_suspended = time < contact%birth .or. time > contact%death
  end function is_suspended

  !> Outside birth .. death: no forces; those of the last call have done their last half step of
  !> work.
  pure subroutine suspend_contact(motion, dt, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    type(apart_t) :: apart
    real(wp) :: power

    memory%is_stale = .true.
    memory%advance = 0.0_wp
    memory%watch%has_looked = .false.
    if (memory%n_active == 0) return
    call take_force(memory%nodes, motion, memory%force, power)
    call take_apart(motion, .true., memory, apart)
    memory%points%n = 0
    call count_work(dt, motion, power, apart, memory)
    call end_look(.true., .false., memory%watch)
    memory%n_active = 0
  end subroutine suspend_contact

  !> The present places of nodes, unless the look at what faces them has taken these, and of spots.
  pure subroutine gather_spots(contact, motion, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    if (memory%is_stale) then
      call refresh_memory(motion, memory)
      if (memory%facing%is_used) call rest_loose_nodes(contact%slave, contact%master, memory)
    end if
    if (.not. memory%facing%is_used) call gather_places(motion, memory)
    if (allocated(memory%spots)) call move_spots(contact%slave, memory%places, memory%spot_xi, &
      memory%spot_spread, memory%spots, memory%travel)
  end subroutine gather_spots

  !> After a time without contact: take the present places and search all anew.
  pure subroutine refresh_memory(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    memory%places(3:4, :) = motion(1:2, memory%nodes)
    call forget_pairs(memory%slave_tracking)
    if (memory%master_tracking%n > 0) call forget_pairs(memory%master_tracking)
    if (allocated(memory%segments%status)) then
      memory%segments%status = is_free
      memory%segments%wake = -huge(1.0_wp)
      memory%segments%next_wake = -huge(1.0_wp)
    end if
    memory%is_stale = .false.
  end subroutine refresh_memory

  !> Have all searched for globally when FREQ asks for it.
  pure subroutine wake_at_interval(contact, cycle, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: cycle
    type(contact_state_t), intent(inout) :: memory

    if (contact%search_interval <= 0 .or. cycle < memory%next_search) return
    memory%next_search = cycle + contact%search_interval
    call wake_all(memory%slave_tracking)
    if (memory%master_tracking%n > 0) call wake_all(memory%master_tracking)
    if (memory%facing%is_used) call rest_loose_nodes(contact%slave, contact%master, memory)
  end subroutine wake_at_interval

  !> Pairs of the slave spots, and of the master nodes where there are two passes.
  pure subroutine search_pairs(contact, cycle, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: cycle
    type(contact_state_t), intent(inout) :: memory

    call wake_at_interval(contact, cycle, memory)
    associate (slave => memory%places(:, :memory%n_slave), &
      master => memory%places(:, memory%n_slave + 1:))
      if (allocated(memory%spots)) then
        call update_tracking(memory%slave_tracking, contact%master, master, memory%spots, &
          memory%travel, memory%facing%is_used, memory%n_released)
      else
        call update_tracking(memory%slave_tracking, contact%master, master, slave, memory%travel, &
          memory%facing%is_used, memory%n_released)
      end if
      if (memory%master_tracking%n > 0) call update_tracking(memory%master_tracking, &
        contact%slave, slave, master, memory%travel, memory%facing%is_used, memory%n_released)
    end associate
  end subroutine search_pairs

end module interface_m
