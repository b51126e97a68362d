! SPDX-License-Identifier: MIT
!> One interface, one step: gather, search, place, press, scatter.
module contact_force_m
  use clock_m, only : clock_t, lap, phase_contact_search, phase_contact_pairing, &
    phase_contact_force
  use closing_m, only : close_contacts, closed_gap_of
  use contact_dispatch_m, only : formulation_t, formulation_of, place_points
  use contact_law_m, only : pressed_at_slave_nodes, press_places
  use contact_log_m, only : log_contact
  use contact_penalty_m, only : set_penalties
  use contact_scatter_m, only : scatter_points
  use contact_springs_m, only : stored_energy, begin_look, add_springs, end_look
  use contact_state_m, only : contact_state_t, allocate_points, allocate_scratch, is_free
  use contacts_m, only : contact_t
  use crossing_m, only : crossings_t, find_crossings, catch_crossings
  use damping_m, only : damp_points
  use first_search_m, only : start_slave_tracking, start_master_tracking, start_segments
  use gather_m, only : gather_places, take_force, power_of, keep_former, add_force
  use kinds_m, only : wp
  use log_m, only : log_t
  use model_m, only : model_t
  use spots_m, only : start_spots, move_spots
  use tracking_m, only : update_tracking, wake_all, forget_pairs
  implicit none
  private
  public :: start_contact, apply_contact, evaluate_contact

contains

  !> Set up the memory of one interface at time zero and tell the log what was understood.
  subroutine start_contact(contact, model, log, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(contact_state_t), intent(out) :: memory
    type(formulation_t) :: formulation
    integer :: n_slave, n_master, i

    n_slave = contact%slave%n_node
    n_master = contact%master%n_node
    memory%n_slave = n_slave
    memory%n_master = n_master
    memory%nodes = [contact%slave%nodes, contact%master%nodes]
    allocate (memory%force(2, n_slave + n_master), memory%places(4, n_slave + n_master), &
      source=0.0_wp)
    do i = 1, size(memory%nodes)
      memory%places(1:2, i) = model%mesh%coordinates(:, memory%nodes(i)) &
        - model%mesh%coordinates(:, memory%nodes(1))
    end do
    formulation = formulation_of(contact)
    memory%contact_law = formulation%contact_law
    call set_penalties(contact, model, memory)
    call start_spots(formulation%spots, contact%n_gauss, contact%slave, memory)
    call start_slave_tracking(contact, model, memory)
    if (formulation%has_two_passes) call start_master_tracking(contact, model, memory)
    if (formulation%covers_segments) call start_segments(contact, model, memory)
    call allocate_points(memory%points, formulation%points_per_slave*memory%slave_tracking%n &
      + formulation%points_per_master*n_master)
    if (formulation%where_pressed == pressed_at_slave_nodes) &
      allocate (memory%node_pressure(n_slave), source=0.0_wp)
    if (contact%damping > 0.0_wp) &
      allocate (memory%damping_force(2, n_slave + n_master), source=0.0_wp)
    call allocate_scratch(memory)
    call log_contact(contact, model, formulation%kind, memory, log)
  end subroutine start_contact

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
    type(formulation_t) :: formulation
    real(wp) :: power, damping_power
    logical :: had_force

    if (time < contact%birth .or. time > contact%death) then
      call suspend_contact(motion, dt, memory)
      return
    end if
    formulation = formulation_of(contact)
    if (memory%is_stale) call refresh_memory(motion, memory)
    call gather_places(motion, memory)
    if (allocated(memory%spots)) &
      call move_spots(contact%slave, memory%places, memory%spot_xi, memory%spots)
    call wake_at_interval(contact, cycle, memory)
    call search_pairs(contact, memory)
    call lap(clock, phase_contact_search)
    had_force = memory%n_active > 0
    memory%n_active = 0
    call begin_look(had_force, memory%watch)
    if (had_force) call keep_former(memory)
    damping_power = 0.0_wp
    if (allocated(memory%damping_force)) &
      call take_force(memory%nodes, motion, memory%damping_force, damping_power)
    call place_points(contact, memory)
    call lap(clock, phase_contact_pairing)
    if (memory%points%n > 0) then
      call press_places(memory%contact_law, formulation%where_pressed, memory)
      ! Springs loaded at time zero hold energy that no force has put in.
      if (cycle == 0) memory%energy = stored_energy(memory%points)
      if (memory%watch%is_due) call add_springs(memory)
      if (contact%damping > 0.0_wp) call damp_all(contact, motion, mass, memory)
      call scatter_points(memory%points, memory%force, memory%n_active)
    end if
    if (memory%points%n > 0 .or. had_force) then
      call add_force(memory%nodes, memory%scratch%former_force, memory%force, motion, force, power)
      if (allocated(memory%damping_force)) damping_power = damping_power &
        + power_of(memory%nodes, motion, memory%damping_force)
      call count_work(dt, power, damping_power, memory)
    end if
    call end_look(had_force, memory%n_active > 0, memory%watch)
    call lap(clock, phase_contact_force)
  end subroutine apply_contact

  !> Work of half a step, that of the damping forces apart.
  pure subroutine count_work(dt, power, damping_power, memory)
    real(wp), intent(in) :: dt
    real(wp), intent(in) :: power, damping_power !! of all contact forces, and of those of damping
    type(contact_state_t), intent(inout) :: memory

    memory%energy = memory%energy - 0.5_wp*dt*(power - damping_power)
    memory%damping_work = memory%damping_work - 0.5_wp*dt*damping_power
  end subroutine count_work

  !> Add the damping to all pressures; its nodal forces are kept apart as well.
  pure subroutine damp_all(contact, motion, mass, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :), mass(:)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: spring(memory%points%n), damped(memory%points%n)
    integer :: n, n_damped

    n = memory%points%n
    spring = memory%points%pressure(:n)
    call damp_points(memory%points, contact%damping, memory%nodes, motion, mass, &
      memory%scratch%nodal)
    damped = memory%points%pressure(:n)
    memory%points%pressure(:n) = damped - spring
    call scatter_points(memory%points, memory%damping_force, n_damped)
    memory%points%pressure(:n) = damped
  end subroutine damp_all

  !> Contact forces of one interface at the given u, added to `force`; no damping, no energy, no
  !> clock. The memory is taken from the last converged step: give a copy of it to each trial, so
  !> that forces are a function of u.
  pure subroutine evaluate_contact(contact, motion, time, is_first, memory, force)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node) u, and u minus that of the
                                                       !! start of the step
    real(wp), intent(in) :: time                       !! of u, s
    logical, intent(in) :: is_first                    !! of a step: gaps of zero count as contact
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, at least the interface's nodes)
    type(formulation_t) :: formulation
    type(crossings_t) :: crossings
    integer :: i

    memory%points%n = 0
    memory%n_active = 0
    memory%force = 0.0_wp
    memory%closed_gap = 0.0_wp
    memory%is_stale = memory%is_stale .or. time < contact%birth .or. time > contact%death
    if (time < contact%birth .or. time > contact%death) return
    if (memory%is_stale) call refresh_memory(motion, memory)
    call gather_places(motion, memory)
    if (allocated(memory%spots)) &
      call move_spots(contact%slave, memory%places, memory%spot_xi, memory%spots)
    call find_crossings(contact, motion, memory, crossings)
    call wake_at_interval(contact, 0, memory)
    call search_pairs(contact, memory)
    call catch_crossings(contact, crossings, memory)
    if (is_first) call close_contacts(contact, closed_gap_of(contact, memory), memory)
    call place_points(contact, memory)
    if (memory%points%n == 0) return
    formulation = formulation_of(contact)
    call press_places(memory%contact_law, formulation%where_pressed, memory)
    call scatter_points(memory%points, memory%force, memory%n_active)
    do i = 1, size(memory%nodes)
      associate (node => memory%nodes(i))
        force(:, node) = force(:, node) + memory%force(:, i)
      end associate
    end do
  end subroutine evaluate_contact

  !> Outside birth .. death: no forces; those of the last call have done their last half step of
  !> work.
  pure subroutine suspend_contact(motion, dt, memory)
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: power, damping_power

    memory%is_stale = .true.
    memory%watch%has_looked = .false.
    if (memory%n_active == 0) return
    call take_force(memory%nodes, motion, memory%force, power)
    damping_power = 0.0_wp
    if (allocated(memory%damping_force)) &
      call take_force(memory%nodes, motion, memory%damping_force, damping_power)
    call count_work(dt, power, damping_power, memory)
    call end_look(.true., .false., memory%watch)
    memory%points%n = 0
    memory%n_active = 0
  end subroutine suspend_contact

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
  end subroutine wake_at_interval

  !> Pairs of the slave spots, and of the master nodes where there are two passes.
  pure subroutine search_pairs(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    associate (slave => memory%places(:, :memory%n_slave), &
      master => memory%places(:, memory%n_slave + 1:))
      if (allocated(memory%spots)) then
        call update_tracking(memory%slave_tracking, contact%master, master, memory%spots, &
          memory%travel, memory%n_released)
      else
        call update_tracking(memory%slave_tracking, contact%master, master, slave, memory%travel, &
          memory%n_released)
      end if
      if (memory%master_tracking%n > 0) call update_tracking(memory%master_tracking, &
        contact%slave, slave, master, memory%travel, memory%n_released)
    end associate
  end subroutine search_pairs

end module contact_force_m
