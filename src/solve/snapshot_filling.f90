! SPDX-License-Identifier: MIT
!> Fills a snapshot from the state, only what is due. Forces, energies and motion of one cycle belong to
!> one instant: v(n) = v(n-1/2) + a(n) dt/2.
module snapshot_filling_m
  use kinds_m, only : wp
  use constraints_m, only : is_active
  use contact_results_m, only : interface_resultants, slave_rows
  use element_state_m, only : add_part_energies, element_stresses, element_plastic_strains
  use energies_m, only : energies_t
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t
  use state_m, only : state_t
  use support_forces_m, only : find_supports
  implicit none
  private
  public :: start_snapshot, fill_motion, fill_energies, fill_parts, fill_interfaces, fill_plot

contains

  !> Allocate what this run can ask for.
  subroutine start_snapshot(model, has_history, snapshot)
    type(model_t), intent(in) :: model
    logical, intent(in) :: has_history !! some part keeps a plastic strain
    type(snapshot_t), intent(out) :: snapshot
    integer :: n_node, n_element

    n_node = model%mesh%n_node
    n_element = model%mesh%n_element
    allocate (snapshot%displacement(2, n_node), snapshot%velocity(2, n_node), &
      snapshot%acceleration(2, n_node), source=0.0_wp)
    allocate (snapshot%parts(size(model%parts)))
    if (allocated(model%walls)) allocate (snapshot%walls(size(model%walls)))
    allocate (snapshot%interfaces(size(model%contacts)), snapshot%slaves(size(model%contacts)))
    call find_supports(model, snapshot)
    if (.not. (model%controls%output%plot%dt > 0.0_wp .or. model%controls%output%plot%curve > 0)) &
      return
    allocate (snapshot%stress(6, n_element), source=0.0_wp)
    if (has_history) &
      allocate (snapshot%plastic_strain(n_element), source=0.0_wp)
    if (size(model%contacts) > 0) allocate (snapshot%contact_force(2, n_node), &
      snapshot%contact_pressure(n_node), snapshot%gap(n_node), source=0.0_wp)
  end subroutine start_snapshot

  !> Displacement, velocity and acceleration of the present instant. `velocity_next` is v(n+1/2) of the
  !> prescribed degrees of freedom.
  subroutine fill_motion(model, state, damping, velocity_next, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)       !! D per direction
    real(wp), intent(in) :: velocity_next(:) !! (n_motion)
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: force, acceleration
    integer :: i, k

    snapshot%time = state%time
    snapshot%cycle = state%cycle
    snapshot%dt = state%dt
    do i = 1, model%mesh%n_node
      do k = 1, 2
        force = -state%internal_force(k, i)
        if (i <= model%layout%n_special) force = force + state%force_special(k, i)
        acceleration = force*state%inverse_mass(k, i)
        if (state%inverse_mass(k, i) > 0.0_wp) acceleration = acceleration &
          + state%body_acceleration(k)
        acceleration = (acceleration - damping(k)*state%motion(2 + k, i)) &
          /(1.0_wp + 0.5_wp*damping(k)*state%dt_before)
        snapshot%displacement(k, i) = state%motion(k, i)
        snapshot%acceleration(k, i) = acceleration
        snapshot%velocity(k, i) = state%motion(2 + k, i) + 0.5_wp*state%dt_before*acceleration
      end do
    end do
    call fill_prescribed(model, state, velocity_next, snapshot)
  end subroutine fill_motion

  !> Prescribed degrees of freedom: the mean of their two half-step velocities.
  subroutine fill_prescribed(model, state, velocity_next, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: velocity_next(:)
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: acceleration
    integer :: i

    if (.not. state%dt > 0.0_wp) return
    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        if (.not. is_active(prescribed, state%time)) cycle
        acceleration = (velocity_next(i) - state%prescribed_velocity(i)) &
          /(0.5_wp*(state%dt + state%dt_before))
        snapshot%acceleration(prescribed%direction, prescribed%node) = acceleration
        snapshot%velocity(prescribed%direction, prescribed%node) = state%prescribed_velocity(i) &
          + 0.5_wp*state%dt_before*acceleration
      end associate
    end do
  end subroutine fill_prescribed

  !> The energy account; `motion` must be filled.
  subroutine fill_energies(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: internal(size(model%parts)), hourglass(size(model%parts)), &
      viscous(size(model%parts))
    integer :: i

    internal = 0.0_wp
    hourglass = 0.0_wp
    viscous = 0.0_wp
    call add_part_energies(model, state%motion, state%elements, internal, hourglass, viscous)
    snapshot%parts%internal = internal
    snapshot%parts%hourglass = hourglass
    associate (energies => snapshot%energies)
      energies%internal = sum(internal)
      energies%hourglass = sum(hourglass)
      energies%viscous = sum(viscous)
      energies%kinetic = 0.0_wp
      snapshot%mean_velocity = 0.0_wp
      do i = 1, model%mesh%n_node
        energies%kinetic = energies%kinetic + 0.5_wp*state%mass(i) &
          *(snapshot%velocity(1, i)**2 + snapshot%velocity(2, i)**2)
        snapshot%mean_velocity = snapshot%mean_velocity + state%mass(i)*snapshot%velocity(:, i)
      end do
      snapshot%mean_velocity = snapshot%mean_velocity/sum(state%mass)
      energies%damping = state%damping_work
      energies%contact = sum(state%contacts%energy)
      energies%external_work = state%external_work
      energies%initial = state%initial_energy
    end associate
  end subroutine fill_energies

  !> Kinetic energy, momentum and mass of each part (energies are there already).
  subroutine fill_parts(model, snapshot)
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: x(2, 4), share, v(2)
    integer :: i, k, corners

    snapshot%parts%kinetic = 0.0_wp
    snapshot%parts%momentum(1) = 0.0_wp
    snapshot%parts%momentum(2) = 0.0_wp
    snapshot%parts%mass = 0.0_wp
    do i = 1, model%mesh%n_element
      associate (nodes => model%mesh%element_nodes(:, i), &
        part => snapshot%parts(model%mesh%element_part(i)), &
        material => model%materials(model%parts(model%mesh%element_part(i))%material))
        x = model%mesh%coordinates(:, nodes)
        corners = merge(3, 4, nodes(4) == nodes(3))
        share = material%density/corners*0.5_wp*((x(1, 3) - x(1, 1))*(x(2, 4) - x(2, 2)) &
          - (x(1, 4) - x(1, 2))*(x(2, 3) - x(2, 1)))
        do k = 1, corners
          v = snapshot%velocity(:, nodes(k))
          part%kinetic = part%kinetic + 0.5_wp*share*(v(1)**2 + v(2)**2)
          part%momentum = part%momentum + share*v
          part%mass = part%mass + share
        end do
      end associate
    end do
  end subroutine fill_parts

  !> Resultants of all interfaces.
  subroutine fill_interfaces(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i

    do i = 1, size(model%contacts)
      call interface_resultants(state%contacts(i), snapshot%interfaces(i))
      snapshot%interfaces(i)%energy = state%contacts(i)%energy
    end do
  end subroutine fill_interfaces

  !> Fields of a plot state and the rows of slave nodes.
  subroutine fill_plot(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i, k

    call element_stresses(model, state%motion, state%elements, snapshot%stress)
    if (allocated(snapshot%plastic_strain)) &
      call element_plastic_strains(model, state%elements, snapshot%plastic_strain)
    if (size(model%contacts) == 0) return
    snapshot%contact_force = 0.0_wp
    snapshot%contact_pressure = 0.0_wp
    snapshot%gap = 0.0_wp
    do i = 1, size(model%contacts)
      call slave_rows(model%contacts(i), state%motion, state%contacts(i), &
        snapshot%slaves(i))
      associate (memory => state%contacts(i), rows => snapshot%slaves(i))
        do k = 1, size(memory%nodes)
          snapshot%contact_force(:, memory%nodes(k)) = snapshot%contact_force(:, memory%nodes(k)) &
            + memory%force(:, k)
        end do
        do k = 1, memory%n_master
          associate (node => memory%nodes(memory%n_slave + k))
            snapshot%contact_pressure(node) = snapshot%contact_pressure(node) &
              + rows%master_pressure(k)
          end associate
        end do
        do k = 1, memory%n_slave
          snapshot%contact_pressure(rows%node(k)) = snapshot%contact_pressure(rows%node(k)) &
            + rows%pressure(k)
          if (rows%pressure(k) > 0.0_wp) snapshot%gap(rows%node(k)) = &
            min(snapshot%gap(rows%node(k)), rows%gap(k))
        end do
      end associate
    end do
  end subroutine fill_plot

end module snapshot_filling_m
