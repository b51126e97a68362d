! SPDX-License-Identifier: MIT
!> One interface, one step: gather, search, points, law, scatter, energy limit, work.
module interface_m
  use clock_m, only : clock_t, lap, phase_contact_search, phase_contact_pairing, &
    phase_contact_force
  use candidates_m, only : update_candidates, list_candidates
  use contact_dispatch_m, only : generate_points
  use contact_law_m, only : form_pressures, begin_sampling, measure_springs, end_sampling, &
    add_tie_energy
  use contact_log_m, only : log_contact
  use contact_memory_m, only : prepare_contact
  use contact_state_m, only : contact_state_t, exchange, has_offsets
  use search_state_m, only : pass_t, separated
  use contacts_m, only : contact_t, breaks, penalty_implicit, tie_always
  use damping_m, only : damp_points, find_lag
  use spring_gaps_m, only : reduce_new_offsets, update_offsets, faded_work, begin_ramp
  use energy_limit_m, only : store_previous_springs, form_springs, limit_forces, admit_entry_work
  use friction_m, only : store_previous_tractions, form_tractions, has_decay
  use initial_status_m, only : activate_deep_points, activate_deep_segments
  use remote_state_m, only : inside_tests_t
  use kinds_m, only : wp
  use log_m, only : log_t
  use model_m, only : model_t
  use positions_m, only : gather_positions, move_segment_points, closed_gap_of, gap_ahead
  use nodal_forces_m, only : scatter_forces, join_passes, previous_work_t, store_previous_work, &
    apply_forces
  use ties_m, only : tie_distance, freeze_ties, hold_ties, break_ties, tie_energy
  use contact_status_m, only : update_status, reset_status
  implicit none
  private
  public :: start_contact, resume_contact, apply_contact, evaluate_contact, break_at_end

  !> When a call is, and what it asks for.
  type :: instant_t
    real(wp) :: time = 0.0_wp     !! of u, s
    real(wp) :: dt = 0.0_wp       !! step that led to u, s
    integer :: cycle = 0
    logical :: is_trial = .false. !! of an implicit step: no damping, no energy
    logical :: closes = .false.   !! gaps of zero count as contact
  end type instant_t

contains

  !> Set up the memory of one interface at time zero and write the log.
  subroutine start_contact(contact, model, log, memory, inside_tests)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(contact_state_t), intent(out) :: memory
    type(inside_tests_t), intent(inout), optional :: inside_tests

    call prepare_contact(contact, model, memory)
    if (memory%has%ties) call start_ties(contact, model, memory, inside_tests)
    if (memory%has%contact) call start_search(contact, model, memory, inside_tests)
    call log_contact(contact, model, memory, log)
  end subroutine start_contact

  !> Place the points of ties: contact points of the same rule in the reference geometry, where gaps
  !> within reach are closed.
  subroutine start_ties(contact, model, memory, inside_tests)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(inside_tests_t), intent(inout), optional :: inside_tests
    type(contact_t) :: tie
    type(contact_state_t) :: placed

    tie = contact
    tie%tie = tie_always
    call prepare_contact(tie, model, placed)
    placed%closed_gap = tie_distance(contact, model)
    call start_search(tie, model, placed, inside_tests)
    call generate_points(tie, placed)
    call freeze_ties(contact, placed%closed_gap, placed, memory)
  end subroutine start_ties

  !> Who touches whom at time zero.
  subroutine start_search(contact, model, memory, inside_tests)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(inside_tests_t), intent(inout), optional :: inside_tests

    if (contact%birth > 0.0_wp) return
    call search_pairs(contact, 0, .false., memory)
    associate (n => memory%n_slave)
      if (memory%has%segment_points) then
        call activate_deep_points(memory%slave_status, model, contact%slave, contact%master, &
          memory%positions, memory%segment_points%positions, inside_tests)
      else
        call activate_deep_points(memory%slave_status, model, contact%slave, contact%master, &
          memory%positions, memory%positions(:, :n), inside_tests)
      end if
      if (memory%master_status%n > 0) call activate_deep_points(memory%master_status, model, &
        contact%master, contact%slave, memory%positions, memory%positions(:, n + 1:), inside_tests)
    end associate
    if (memory%has%overlaps) call activate_deep_segments(contact, model, memory%positions, &
      memory%segments%state, inside_tests)
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

    call step_contact(contact, instant_t(time, dt, cycle), motion, mass, memory, force, clock)
  end subroutine apply_contact

  !> Contact forces of one interface at the given u, added to `force`; no damping, no energy, no
  !> clock. The memory is taken from the last converged step: give a copy of it to each trial, so
  !> that forces are a function of u.
  subroutine evaluate_contact(contact, motion, time, dt, is_first, memory, force)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u, and u minus that of the
                                                       !! start of the step
    real(wp), intent(in) :: time                       !! of u, s
    real(wp), intent(in) :: dt                         !! of the step to u, s
    logical, intent(in) :: is_first                    !! of a step: gaps of zero count as contact
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)

    memory%n_active = 0
    memory%force = 0.0_wp
    memory%closed_gap = 0.0_wp
    if (memory%has%friction) then
      memory%scratch%dt = dt
      memory%friction%force = 0.0_wp
      memory%friction%stored = 0.0_wp
      call store_previous_tractions(memory%friction, memory%scratch)
    end if
    call step_contact(contact, instant_t(time, dt, is_trial=.true., closes=is_first), motion, &
      [real(wp) ::], memory, force)
  end subroutine evaluate_contact

  !> One interface in an explicit step or a trial of an implicit one: positions, candidate pairs and
  !> status, contact points, laws, nodal forces, energy. Ties have their points from the start;
  !> sites that no tie holds are in contact.
  !> Outside birth .. death the forces of the last call do their last half step of work. Implicit
  !> penalties (PUNIT 4) form their forces after those of all other interfaces
  !> (`implicit_penalty_m`).
  subroutine step_contact(contact, now, motion, mass, memory, force, clock)
    type(contact_t), intent(in) :: contact
    type(instant_t), intent(in) :: now
    real(wp), intent(in), contiguous :: motion(:, :)      !! (4, n_node) u; v, or u minus that of
                                                          !! the start of the step in a trial
    real(wp), intent(in), contiguous :: mass(:)           !! (n_node) kg/m; none in a trial
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)    !! (2, at least the interface's nodes)
    type(clock_t), intent(inout), optional :: clock
    type(previous_work_t) :: previous
    logical :: had_force, begins

    had_force = memory%n_active > 0 .or. memory%ties%n_held > 0
    begins = memory%is_stale .and. now%cycle > 0
    memory%monitor%has_sampled = .false.
    call find_contacts(contact, now, motion, memory)
    if (present(clock)) call lap(clock, phase_contact_search)
    if (memory%is_stale .and. .not. had_force) return

    if (.not. now%is_trial) call keep_previous(contact, motion, begins, had_force, memory, previous)
    if (memory%has%contact .and. .not. memory%is_stale) call generate_points(contact, memory)
    if (present(clock)) call lap(clock, phase_contact_pairing)
    if (memory%scratch%waits) return

    call form_forces(contact, now, motion, mass, begins, memory)
    if (now%is_trial) then
      call add_trial_force(memory%nodes, memory%force, force)
    else
      if (memory%points%n + memory%tie_points%n > 0 .or. had_force) &
        call apply_forces(now%dt, motion, previous, memory, force)
      call end_sampling(had_force, memory%n_active > 0 .or. memory%tie_points%n > 0, memory%monitor)
    end if
    if (present(clock)) call lap(clock, phase_contact_force)
  end subroutine step_contact

  !> Pressures and tractions of ties and contact points, nodal forces within the energy limit.
  subroutine form_forces(contact, now, motion, mass, begins, memory)
    type(contact_t), intent(in) :: contact
    type(instant_t), intent(in) :: now
    real(wp), intent(in), contiguous :: motion(:, :), mass(:)
    logical, intent(in) :: begins !! contact is born in this call
    type(contact_state_t), intent(inout) :: memory

    if (memory%has%ties) &
      call hold_ties(memory, merge(0.0_wp, contact%strength, now%is_trial), now%time)
    if (memory%points%n > 0) call form_pressures(memory)
    if (memory%points%n + memory%tie_points%n > 0 .and. .not. now%is_trial) &
      call book_springs(now%cycle, begins, memory)
    if (memory%points%n == 0) return
    if (memory%has%friction) then
      ! Where the coefficient decays, explicit steps damp what sticks.
      if (has_decay(contact%friction) .and. now%dt > 0.0_wp .and. .not. now%is_trial) call &
        find_lag(memory%points, memory%nodes, mass, contact%is_self, now%dt, &
        memory%scratch%nodal, memory%scratch%lag)
      call form_tractions(contact, now%dt, memory)
    end if
    if (memory%has%damping .and. .not. now%is_trial) call damp_points(memory%points, &
      contact%damping, memory%nodes, motion, mass, contact%is_self, memory%scratch%nodal)
    call scatter_forces(memory)
    if (contact%is_self) call join_passes(memory)
    if (memory%scratch%had_force .or. memory%n_active > 0) &
      call limit_forces(motion, now%time, now%dt, memory)
  end subroutine form_forces

  !> Positions and status of all points; outside birth .. death no points. Implicit penalties take
  !> what may touch in the step ahead as closed.
  subroutine find_contacts(contact, now, motion, memory)
    type(contact_t), intent(in) :: contact
    type(instant_t), intent(in) :: now
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    logical :: was_stale

    if (memory%has%interference) call begin_ramp(contact, now%time, memory)
    if (now%time < contact%birth .or. now%time > contact%death) then
      memory%is_stale = .true.
      memory%advance = 0.0_wp
      memory%points%n = 0
      memory%tie_points%n = 0
      return
    end if
    was_stale = memory%is_stale
    if (was_stale) call refresh_memory(motion, memory)
    call gather_positions(motion, memory)
    if (.not. memory%has%contact) return
    if (memory%has%segment_points) call move_segment_points(contact%slave, memory%positions, &
      memory%segment_points, memory%travel)
    if (now%is_trial) then
      if (memory%has%friction) memory%scratch%increment = motion(3:4, memory%nodes)
      if (now%closes) memory%closed_gap = closed_gap_of(contact, memory)
    else if (contact%penalty_unit == penalty_implicit) then
      memory%closed_gap = gap_ahead(contact, now%cycle == 0 .or. was_stale, memory)
    end if
    memory%slave_status%pass%is_trial = now%is_trial
    memory%master_status%pass%is_trial = now%is_trial
    call search_pairs(contact, now%cycle, .not. was_stale .and. (now%is_trial .or. now%cycle > 0), &
      memory)
  end subroutine find_contacts

  !> Before contact points are generated: the forces of the last call are kept for their half of the
  !> work of the step.
  pure subroutine keep_previous(contact, motion, begins, had_force, memory, previous)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)
    logical, intent(in) :: begins    !! contact is born in this call
    logical, intent(in) :: had_force !! the call before, of contact or ties
    type(contact_state_t), intent(inout) :: memory
    type(previous_work_t), intent(out) :: previous

    associate (scratch => memory%scratch)
      scratch%had_force = memory%n_active > 0
      scratch%is_born = begins
      scratch%waits = contact%penalty_unit == penalty_implicit .and. .not. memory%is_stale
      memory%n_active = 0
      call begin_sampling(had_force, memory%monitor)
      ! What was previous before is zero since the forces have been added to the mesh.
      if (had_force) call exchange(memory%force, scratch%previous_force)
      if (scratch%waits) return
      call store_previous_springs(memory)
      call store_previous_work(motion, had_force, memory, previous)
      if (memory%has%friction) call store_previous_tractions(memory%friction, scratch)
    end associate
  end subroutine keep_previous

  !> What the springs hold as loaded: those loaded at time zero hold energy that no force has put
  !> in; those born loaded may return what they hold; the work of fading offsets is admitted.
  pure subroutine book_springs(cycle, begins, memory)
    integer, intent(in) :: cycle
    logical, intent(in) :: begins
    type(contact_state_t), intent(inout) :: memory

    if (memory%scratch%n_freed > 0 .and. memory%points%n > 0) call add_tie_energy(memory)
    if (memory%monitor%is_due .or. cycle == 0) call measure_springs(memory)
    if (cycle == 0) then
      memory%energy = memory%monitor%stored
      if (memory%has%ties) memory%ties%energy = tie_energy(memory)
    end if
    if (begins) memory%limit%admissible = memory%limit%admissible + memory%monitor%stored
    if (has_offsets(memory)) call admit_entry_work(faded_work(memory), memory%limit)
  end subroutine book_springs

  !> Break what reaches its strength in equilibrium, at the end of an implicit step.
  pure subroutine break_at_end(contact, time, memory, n_new)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: time
    type(contact_state_t), intent(inout) :: memory
    integer, intent(out) :: n_new !! sites that have broken

    n_new = 0
    if (breaks(contact) .and. memory%tie_points%n > 0) &
      call break_ties(contact%strength, time, memory, n_new)
  end subroutine break_at_end

  !> Add the forces of a trial to those of the mesh.
  pure subroutine add_trial_force(nodes, contact_force, force)
    integer, intent(in) :: nodes(:)
    real(wp), intent(in) :: contact_force(:, :)        !! (2, nodes)
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, n_node)
    integer :: i

    do i = 1, size(nodes)
      force(:, nodes(i)) = force(:, nodes(i)) + contact_force(:, i)
    end do
  end subroutine add_trial_force

  !> After a restart: what follows from the memory of an interface that has been read.
  pure subroutine resume_contact(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    if (memory%has%contact) call list_candidates(contact, memory, .true.)
    call form_springs(memory)
  end subroutine resume_contact

  !> After a time without contact: take the present positions and search all anew.
  pure subroutine refresh_memory(motion, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory

    memory%positions(3:4, :) = motion(1:2, memory%nodes)
    memory%listed_until = -huge(1.0_wp)
    call reset_status(memory%slave_status)
    call reset_status(memory%master_status)
    if (memory%has%overlaps) memory%segments%state = separated
    memory%is_stale = .false.
  end subroutine refresh_memory

  !> Candidate pairs, and the status of the slave's points and of the master nodes where there are
  !> two passes.
  subroutine search_pairs(contact, cycle, has_history, memory)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: cycle
    logical, intent(in) :: has_history !! increments are those of a step
    type(contact_state_t), intent(inout) :: memory

    call update_candidates(contact, cycle, memory)
    call start_pass(memory%slave_status%pass)
    call start_pass(memory%master_status%pass)
    associate (n => memory%n_slave, increments => memory%scratch%increment)
      if (memory%has%segment_points) then
        call update_status(memory%slave_status, contact%slave, contact%master, &
          memory%candidates, memory%positions, increments, memory%segment_points%positions)
      else
        call update_status(memory%slave_status, contact%slave, contact%master, &
          memory%candidates, memory%positions, increments, memory%positions(:, :n))
      end if
      if (memory%master_status%n > 0) call update_status(memory%master_status, &
        contact%master, contact%slave, memory%reversed, memory%positions, increments, &
        memory%positions(:, n + 1:))
    end associate
    if (.not. has_offsets(memory)) return
    if (memory%has%overlaps) call reduce_new_offsets(memory)
    ! In a trial of an implicit step they stay: they are no part of the tangent.
    if (.not. memory%slave_status%pass%is_trial) call update_offsets(contact, memory)

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
