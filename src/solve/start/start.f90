! SPDX-License-Identifier: MIT
!> From a model to its state at time zero.
module start_m
  use interface_m, only : start_contact, resume_contact
  use kinds_m, only : wp
  use behind_ties_m, only : hear_tie
  use automatic_penalty_m, only : set_automatic_penalties
  use rigid_start_m, only : start_common, weigh_contacts, start_rigids
  use constraints_m, only : start_motion, fix_nodes, update_activity
  use element_log_m, only : log_elements
  use element_mass_m, only : lump_mass
  use element_start_m, only : start_elements
  use element_steps_m, only : start_retardation
  use contact_log_m, only : log_softness
  use contacts_m, only : is_tied, n_told, told_as
  use controls_m, only : is_asked, group_nodes
  use errors_m, only : error_t, raise, status_input
  use history_tables_m, only : table_nodfor
  use others_memory_m, only : answers_t, others_t, known_nodes, known_slots
  use log_m, only : log_t, to_text
  use model_log_m, only : log_added_mass, log_masses
  use mass_scaling_m, only : scales_masses, start_mass_scaling
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: start_state, resume_contacts

contains

  !> Allocate and fill everything that the run changes.
  subroutine start_state(model, log, state, error, others, answers)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(state_t), intent(out) :: state
    type(error_t), allocatable, intent(out) :: error
    type(others_t), intent(inout), optional :: others !! what other processes have; it is left alone
    type(answers_t), intent(inout), optional :: answers !! of the first search
    integer :: known(2, 3), i, k

    known = known_nodes(model, others)
    call start_elements(model, known_slots(model, others), state%elements)
    call start_motion(model, known, state%motion)
    call log_elements(model, log)
    if (present(others)) then
      call move_alloc(others%mass, state%mass)
    else
      call lump_mass(model, state%mass)
      call log_masses(model, log)
    end if
    if (any(abs(model%parts%stiffness_damping) > 0.0_wp)) &
      call start_retardation(model, state%motion, state%elements)
    if (scales_masses(model)) then
      call start_mass_scaling(model, state%motion, state%elements, state%mass)
      call log_added_mass(model, state%elements, log, error)
      if (allocated(error)) return
    end if
    call start_common(model, state)
    call start_vectors(known, model%mesh%n_node, state%inverse_mass)
    do k = 1, size(known, 2)
      do i = known(1, k), known(2, k)
        if (state%mass(i) > 0.0_wp) state%inverse_mass(:, i) = 1.0_wp/state%mass(i)
      end do
    end do
    call update_activity(model, 0.0_wp, state%mass, state%inverse_mass)
    call fix_nodes(model, state%inverse_mass)
    allocate (state%force_special(2, model%layout%n_special), source=0.0_wp)
    if (size(model%conditions%nodal_loads) + size(model%conditions%pressures) > 0) &
      allocate (state%external(2, model%layout%n_special), source=0.0_wp)
    if (allocated(model%conditions%damping) .and. .not. model%controls%implicit%is_on) &
      call start_vectors(known, model%mesh%n_node, state%former_velocity)
    if (allocated(model%conditions%part_damping) .and. .not. model%controls%implicit%is_on) then
      allocate (state%node_damping(2, model%mesh%n_node), &
        state%former_damping(2, model%mesh%n_node), source=0.0_wp)
      if (.not. allocated(state%former_velocity)) &
        allocate (state%former_velocity(2, model%mesh%n_node), source=0.0_wp)
    end if
    allocate (state%force_slots(2, size(model%layout%special_node)), source=0.0_wp)
    call start_vectors(known, model%mesh%n_node, state%internal_force)
    allocate (state%prescribed_velocity(size(model%conditions%motions)), source=0.0_wp)
    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        state%prescribed_velocity(i) = state%motion(2 + prescribed%direction, prescribed%node)
      end associate
    end do
    call start_rigids(model, log, state)
    call start_works(model, state)
    if (allocated(model%controls%ends)) &
      allocate (state%quiet_since(size(model%controls%ends)), source=-1.0_wp)
    call start_contacts(model, log, state, error, answers)
    if (allocated(error)) return
    state%outlines = model%contacts
    call weigh_contacts(model, state)
    if (present(others)) then
      do i = 1, size(state%contacts)
        state%contacts(i)%slave_penalty = others%penalties(1, i)
        state%contacts(i)%master_penalty = others%penalties(2, i)
        state%contacts(i)%node_penalty = others%penalties(3, i)
      end do
    else
      call set_automatic_penalties(model, state, log, error)
      if (allocated(error)) return
      do i = 1, size(state%estimates)
        call log_softness(model%contacts(i), model, state%contacts(i), log, &
          state%estimates(i)%softness)
      end do
    end if
  end subroutine start_state

  !> Memories of the interfaces.
  subroutine start_contacts(model, log, state, error, answers)
    type(model_t), intent(in) :: model
    type(log_t), intent(inout) :: log
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(out) :: error
    type(answers_t), intent(inout), optional :: answers !! of the first search
    integer :: i

    allocate (state%contacts(size(model%contacts)), state%estimates(n_told(model%contacts)))
    do i = 1, size(model%contacts)
      call start_contact(model%contacts(i), model, log, state%contacts(i), answers)
      if (.not. is_tied(model%contacts(i)) .or. state%contacts(i)%points%n > 0) cycle
      call raise(error, 'interface '//to_text(model%contacts(i)%id)//' ties nothing: none of its ' &
        //to_text(state%contacts(i)%n_slave)//' slave nodes has the master within reach', &
        status_input)
      return
    end do
  end subroutine start_contacts

  !> Vectors of all nodes, zero where the process knows them.
  pure subroutine start_vectors(known, n_node, vectors)
    integer, intent(in) :: known(:, :)
    integer, intent(in) :: n_node
    real(wp), allocatable, intent(out) :: vectors(:, :) !! (2, n_node)
    integer :: k

    allocate (vectors(2, n_node))
    do k = 1, size(known, 2)
      vectors(:, known(1, k):known(2, k)) = 0.0_wp
    end do
  end subroutine start_vectors

  !> Memories of the walls, where the deck has any; forces and works that histories ask for.
  subroutine start_works(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    integer :: i, n

    n = 0
    if (allocated(model%walls)) n = size(model%walls)
    if (n > 0) allocate (state%walls(n))
    do i = 1, n
      associate (wall => model%walls(i), memory => state%walls(i))
        allocate (memory%force(size(wall%nodes)), memory%speed(size(wall%nodes)), source=0.0_wp)
        allocate (memory%friction(merge(size(wall%nodes), 0, wall%friction > 0.0_wp)), &
          source=0.0_wp)
        allocate (memory%slip_speed, source=memory%friction)
      end associate
    end do
    associate (output => model%controls%output)
      if (allocated(output%boundaries%where)) then
        n = size(output%boundaries%where)
        allocate (state%boundary_force(3, n), state%boundary_work(n), source=0.0_wp)
      end if
      if (allocated(output%cross_sections)) allocate (state%cut_force(8, &
        sum([(size(output%cross_sections(i)%elements), i=1, size(output%cross_sections))])), &
        source=0.0_wp)
      if (.not. allocated(output%force_groups)) return
      if (.not. is_asked(output%histories(table_nodfor))) return
      n = size(group_nodes(output%force_groups))
      allocate (state%group_force(2, n), state%group_work(n), state%group_velocity(2, n), &
        source=0.0_wp)
    end associate
  end subroutine start_works

  !> After a restart: what interfaces make anew of the memory that has been read.
  pure subroutine resume_contacts(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    integer :: i, k

    do i = 1, size(state%contacts)
      call resume_contact(state%outlines(i), state%contacts(i))
      k = told_as(model%contacts, i)
      if (k < i) call hear_tie(state%contacts(k), state%contacts(i))
    end do
  end subroutine resume_contacts

end module start_m
