! SPDX-License-Identifier: MIT
!> One interface, one step: gather, search, place, law, scatter, energy limit, work.
module interface_m
  use clock_m, only : clock_t, lap, phase_contact_search, phase_contact_pairing, &
    phase_contact_force
  use candidates_m, only : update_candidates, list_candidates
  use closed_gap_m, only : closed_gap_of, gap_ahead
  use contact_dispatch_m, only : formulation_t, formulation_of, place_points
  use behind_ties_m, only : leave_to_tie, take_over
  use contact_law_m, only : press_places
  use contact_log_m, only : log_contact
  use contact_preparation_m, only : prepare_contact
  use contact_scatter_m, only : scatter_forces, join_passes
  use contact_springs_m, only : begin_look, measure_springs, end_look
  use contact_work_m, only : apart_t, take_apart, hand_over, count_work
  use contact_state_m, only : contact_state_t, pass_t, is_free
  use contacts_m, only : contact_t, is_tied, penalty_implicit
  use damping_m, only : damp_points, find_lag
  use entry_offset_m, only : has_offsets, update_offsets, faded_work
  use energy_limit_m, only : keep_former_springs, form_springs, limit_forces, lend
  use friction_m, only : start_trial_slip, take_trial_motion, rub_places
  use initial_status_m, only : activate_deep_points, activate_deep_segments
  use gather_m, only : gather_places, take_force, keep_former
  use others_memory_m, only : answers_t
  use interference_m, only : begin_growth
  use kinds_m, only : wp
  use law_friction_m, only : has_decay
  use log_m, only : log_t
  use model_m, only : model_t
  use spots_m, only : move_spots
  use tips_m, only : has_folds, find_tips
  use tied_interface_m, only : start_ties, apply_ties, evaluate_ties, tie_reach
  use contact_status_m, only : update_status, forget_pairs, measure_depths
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

  !> Who touches whom at time zero; ties take gaps within their reach as closed.
  subroutine start_search(contact, model, memory, answers)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(answers_t), intent(inout), optional :: answers

    if (contact%birth > 0.0_wp) return
    if (is_tied(contact)) memory%closed_gap = tie_reach(contact, model)
    call search_pairs(contact, 0, .false., memory)
    associate (n => memory%n_slave)
      if (memory%has%spots) then
        call activate_deep_points(memory%slave_tracking, model, contact%slave, contact%master, &
          memory%places, memory%spots, answers)
      else
        call activate_deep_points(memory%slave_tracking, model, contact%slave, contact%master, &
          memory%places, memory%places(:, :n), answers)
      end if
      if (memory%master_tracking%n > 0) call activate_deep_points(memory%master_tracking, model, &
        contact%master, contact%slave, memory%places, memory%places(:, n + 1:), answers)
    end associate
    if (memory%has%overlaps) &
      call activate_deep_segments(contact, model, memory, answers)
    ! Points that lie deep need pairs as deep.
    memory%listed_until = -huge(1.0_wp)
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

    if (memory%has%interference) call begin_growth(contact, time, memory)
    if (is_suspended(contact, time)) then
      call suspend_contact(motion, dt, memory)
    else if (is_tied(contact)) then
      call apply_ties(contact, motion, [time, dt], cycle, clock, memory, force)
    else
      call apply_between(contact, motion, mass, [time, dt], cycle, clock, memory, force)
    end if
  end subroutine apply_contact

  !> The same within birth .. death, of an interface that is not tied.
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
    call find_contacts(contact, motion, cycle, memory)
    call lap(clock, phase_contact_search)
    if (has_folds(contact) .and. memory%has%nodal_pressure) &
      call find_tips(contact%slave, memory)
    call set_forces_aside(motion, had_force, memory, apart)
    call place_points(contact, memory)
    call lap(clock, phase_contact_pairing)
    if (memory%points%n > 0) then
      call press_places(memory)
      if (contact%behind > 0) then
        call leave_to_tie(memory)
        call take_over(memory)
      end if
      call look_at_springs(cycle, memory)
      ! Springs born loaded make what they hold: that is reported, and may be returned.
      if (is_born) memory%limit%credit = memory%limit%credit + memory%watch%stored
      if (has_offsets(memory)) call lend(faded_work(memory), memory%limit)
      if (has_decay(contact%friction) .and. times(2) > 0.0_wp) call find_lag(memory%points, &
        memory%nodes, mass, contact%is_self, times(2), memory%scratch%nodal, memory%scratch%lag)
      if (memory%has%friction) &
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

    memory%scratch%had_force = memory%n_active > 0
    memory%scratch%waits = .true.
    memory%scratch%is_born = memory%is_stale .and. cycle > 0
    call find_contacts(contact, motion, cycle, memory)
    call lap(clock, phase_contact_search)
    memory%n_active = 0
    memory%watch%has_looked = .false.
    call begin_look(memory%scratch%had_force, memory%watch)
    if (memory%scratch%had_force) call keep_former(memory)
    call place_points(contact, memory)
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

    if (is_tied(contact)) then
      if (is_suspended(contact, time)) memory%points%n = 0
      call evaluate_ties(motion, memory, force)
      return
    end if
    if (memory%has%interference) call begin_growth(contact, time, memory)
    memory%is_stale = memory%is_stale .or. is_suspended(contact, time)
    memory%points%n = 0
    memory%n_active = 0
    memory%force = 0.0_wp
    memory%closed_gap = 0.0_wp
    if (memory%has%friction) call start_trial_slip(dt, memory)
    if (is_suspended(contact, time)) return
    call evaluate_between(contact, motion, is_first, memory, force)
  end subroutine evaluate_contact

  !> The same within birth .. death, of an interface that is not tied.
  pure subroutine evaluate_between(contact, motion, is_first, memory, force)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u, and u minus that of the
                                                       !! start of the step
    logical, intent(in) :: is_first                    !! of a step: gaps of zero count as contact
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)
    type(formulation_t) :: formulation
    logical :: was_stale
    integer :: i

    formulation = formulation_of(contact)
    was_stale = memory%is_stale
    call gather_points(contact, motion, memory)
    if (memory%has%friction) call take_trial_motion(motion, memory)
    if (is_first) memory%closed_gap = closed_gap_of(contact, memory)
    memory%slave_tracking%pass%is_trial = .true.
    memory%master_tracking%pass%is_trial = .true.
    call search_pairs(contact, 0, .not. was_stale, memory)
    if (has_folds(contact) .and. memory%has%nodal_pressure) &
      call find_tips(contact%slave, memory, motion)
    call place_points(contact, memory)
    if (memory%points%n == 0) return
    call press_places(memory)
    if (contact%behind > 0) call leave_to_tie(memory)
    if (memory%has%friction) &
      call rub_places(contact, formulation%has_unit_area, memory%scratch%dt, memory)
    call scatter_forces(memory)
    if (contact%is_self) call join_passes(memory)
    do i = 1, size(memory%nodes)
      associate (node => memory%nodes(i))
        force(:, node) = force(:, node) + memory%force(:, i)
      end associate
    end do
  end subroutine evaluate_between

  !> After a restart: what follows from the memory of an interface that has been read.
  pure subroutine resume_contact(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    call list_candidates(contact, memory)
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

  !> Positions and status of all points in an explicit step; implicit penalties take what may touch
  !> in the step ahead as closed.
  pure subroutine find_contacts(contact, motion, cycle, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)
    integer, intent(in) :: cycle
    type(contact_state_t), intent(inout) :: memory
    logical :: was_stale

    was_stale = memory%is_stale
    call gather_points(contact, motion, memory)
    if (contact%penalty_unit == penalty_implicit) &
      memory%closed_gap = gap_ahead(contact, cycle == 0 .or. was_stale, memory)
    call search_pairs(contact, cycle, .not. was_stale .and. cycle > 0, memory)
  end subroutine find_contacts

  !> The present positions of nodes and of points between them.
  pure subroutine gather_points(contact, motion, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    if (memory%is_stale) call refresh_memory(motion, memory)
    call gather_places(motion, memory)
    if (memory%has%spots) call move_spots(contact%slave, memory%places, memory%spot_xi, &
      memory%spot_spread, memory%spots, memory%travel)
  end subroutine gather_points

  !> After a time without contact: take the present places and search all anew.
  pure subroutine refresh_memory(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    memory%places(3:4, :) = motion(1:2, memory%nodes)
    memory%listed_until = -huge(1.0_wp)
    call forget_pairs(memory%slave_tracking)
    call forget_pairs(memory%master_tracking)
    if (memory%has%overlaps) then
      memory%segment_status = is_free
      memory%segment_gap = huge(1.0_wp)
    end if
    memory%is_stale = .false.
  end subroutine refresh_memory

  !> Candidate pairs, and the status of the slave's points and of the master nodes where there are
  !> two passes.
  pure subroutine search_pairs(contact, cycle, has_history, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: cycle
    logical, intent(in) :: has_history !! increments are those of a step
    type(contact_state_t), intent(inout) :: memory

    call update_candidates(contact, cycle, memory)
    call start_pass(memory%slave_tracking%pass)
    call start_pass(memory%master_tracking%pass)
    associate (n => memory%n_slave, increments => memory%scratch%increment)
      if (memory%has%spots) then
        call update_status(memory%slave_tracking, contact%slave, contact%master, &
          memory%candidates, memory%places, increments, memory%spots)
      else
        call update_status(memory%slave_tracking, contact%slave, contact%master, &
          memory%candidates, memory%places, increments, memory%places(:, :n))
      end if
      if (memory%master_tracking%n > 0) call update_status(memory%master_tracking, &
        contact%master, contact%slave, memory%reversed, memory%places, increments, &
        memory%places(:, n + 1:))
    end associate
    if (has_offsets(memory)) call update_offsets(contact, memory)

  contains

    !> What this call asks for.
    pure subroutine start_pass(pass)
      type(pass_t), intent(inout) :: pass

      pass%has_history = has_history
      pass%travel = memory%travel
      pass%closed_gap = memory%closed_gap
    end subroutine start_pass

  end subroutine search_pairs

end module interface_m
