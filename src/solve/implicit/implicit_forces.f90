! SPDX-License-Identifier: MIT
!> All nodal forces of one instant for the implicit driver: the explicit kernels from a committed
!> state to a trial displacement (doc/theory/implicit.md, section 1).
module implicit_forces_m
  use behind_ties_m, only : hear_tie
  use contacts_m, only : told_as
  use interface_m, only : evaluate_contact
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use clock_m, only : clock_t, lap, share_contact, phase_elements, &
    phase_contact_force, phase_nodes
  use contact_state_m, only : contact_state_t
  use cut_forces_m, only : find_cut_forces
  use element_dispatch_m, only : add_tile_forces, share_tile_forces, keep_tile_forces, &
    sum_special_forces
  use element_mass_m, only : mass_times
  use external_force_m, only : form_external_force, body_acceleration, damping_rates
  use packed_buffer_m, only : packed_buffer_t
  use model_m, only : model_t
  use state_m, only : state_t
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: trial_t, start_trial, assemble_forces, damping_force, net_force, trouble_of, &
    cut_sections

  !> Step of the kernels: motion holds increments in place of velocities.
  real(wp), parameter :: unit_step = 1.0_wp

  !> What a trial displacement makes of a committed state.
  type, extends(visited_t) :: trial_t
    real(wp), allocatable :: motion(:, :)   !! (4, n_node) u, and u minus the committed u
    type(block_state_t) :: elements
    type(contact_state_t), allocatable :: contacts(:)
    real(wp), allocatable :: internal(:, :) !! (2, n_node) divergence of stress
    real(wp), allocatable :: contact(:, :)  !! (2, n_node)
    real(wp), allocatable :: external(:, :) !! (2, n_node) loads and gravity
    real(wp), allocatable :: damping(:, :)  !! (2, n_node) D M v of an equilibrium; only where the
                                            !! deck damps by mass
    real(wp), allocatable :: slots(:, :)    !! forces of tiles on their special nodes
    type(packed_buffer_t), allocatable :: before(:) !! chunks of cross sections before the step,
                                            !! until the forces of these are formed
  contains
    procedure :: visit => visit_trial
  end type trial_t

contains

  !> A trial at the committed state.
  subroutine start_trial(model, state, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(trial_t), intent(out) :: trial

    allocate (trial%motion(4, model%mesh%n_node), trial%internal(2, model%mesh%n_node), &
      trial%contact(2, model%mesh%n_node), trial%external(2, model%mesh%n_node), source=0.0_wp)
    if (allocated(model%conditions%damping) .or. allocated(model%conditions%part_damping)) &
      allocate (trial%damping, source=trial%external)
    allocate (trial%slots, source=state%force_slots)
    trial%motion(1:2, :) = state%motion(1:2, :)
  end subroutine start_trial

  !> Forces at the displacement in `trial%motion(1:2)`, loads at `time`.
  subroutine assemble_forces(model, state, time, is_first, clock, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state      !! committed
    real(wp), intent(in) :: time
    logical, intent(in) :: is_first         !! touching counts as closed
    type(clock_t), intent(inout) :: clock
    type(trial_t), intent(inout) :: trial
    real(wp), allocatable :: force(:, :)
    real(wp) :: body(2)
    integer :: i, k

    trial%motion(3:4, :) = trial%motion(1:2, :) - state%motion(1:2, :)
    ! Element forces from the committed history.
    trial%elements = state%elements
    allocate (force(2, model%layout%n_local))
    do i = 1, size(model%layout%tiles)
      associate (tile => model%layout%tiles(i))
        call add_tile_forces(model, tile, trial%motion, unit_step, trial%elements, force)
        call share_tile_forces(tile, force, trial%slots)
        call keep_tile_forces(tile, force, trial%internal)
      end associate
    end do
    call sum_special_forces(model%layout, trial%slots, 1, model%layout%n_special, trial%internal)
    call lap(clock, phase_elements)
    trial%contact = 0.0_wp
    trial%contacts = state%contacts
    do i = 1, size(model%contacts)
      k = told_as(model%contacts, i)
      if (k < i) call hear_tie(trial%contacts(k), trial%contacts(i))
      call evaluate_contact(model%contacts(i), trial%motion, time, time - state%time, is_first, &
        trial%contacts(i), trial%contact)
      call lap(clock, phase_contact_force)
      call share_contact(clock, k)
    end do
    trial%external = 0.0_wp
    call form_external_force(model, trial%motion, time, trial%external)
    if (size(model%conditions%body_loads) > 0) then
      body = body_acceleration(model%conditions, model%curves, time)
      trial%external = trial%external + mass_times(model, spread(body, 2, model%mesh%n_node))
    end if
    call lap(clock, phase_nodes)
  end subroutine assemble_forces

  !> Forces of the elements of cross sections, unless the state has them.
  subroutine cut_sections(model, trial, state)
    type(model_t), intent(in) :: model
    type(trial_t), intent(inout) :: trial !! that has become the state
    type(state_t), intent(inout) :: state

    if (.not. allocated(trial%before)) return
    call find_cut_forces(model, [1, model%layout%n_chunk], trial%motion, [state%time, unit_step], &
      state%elements, state%cut_force, trial%before)
    deallocate (trial%before)
  end subroutine cut_sections

  !> What damping by mass takes, D M v with the consistent mass of each part.
  pure function damping_force(model, time, velocity) result(force)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(in) :: velocity(:, :) !! (2, n_node) at `time`
    real(wp) :: force(2, size(velocity, 2))

    force = mass_times(model, velocity, damping_rates(model, time))
  end function damping_force

  !> Internal minus contact and external forces, and damping.
  pure function net_force(trial) result(force)
    type(trial_t), intent(in) :: trial
    real(wp) :: force(2, size(trial%internal, 2))

    force = trial%internal - trial%contact - trial%external
    if (allocated(trial%damping)) force = force + trial%damping
  end function net_force

  !> What is wrong with a trial in words; empty where all volumes are
  !> positive and all forces finite.
  pure function trouble_of(trial) result(trouble)
    type(trial_t), intent(in) :: trial
    character(:), allocatable :: trouble

    trouble = ''
    if (.not. minval(trial%elements%volume_limit) > 0.0_wp) then
      trouble = 'an element has turned inside out'
    else if (.not. sum(abs(trial%external)) <= huge(1.0_wp)) then
      trouble = 'the loads are not finite'
    else if (.not. sum(abs(trial%internal)) + sum(abs(trial%contact)) <= huge(1.0_wp)) then
      trouble = 'the forces are not finite'
    end if
  end function trouble_of

  !> The forces of the state.
  subroutine visit_trial(self, visitor)
    class(trial_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('internal', self%internal)
    call visitor%visit('contact', self%contact)
    call visitor%visit('external', self%external)
    call visitor%visit('damping', self%damping)
  end subroutine visit_trial

end module implicit_forces_m
