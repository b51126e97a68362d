! SPDX-License-Identifier: MIT
!> Fill a snapshot from the state as far as it is due. Forces, energies and motion belong to one
!> instant: v(n) = v(n-1/2) + a(n) dt/2.
module snapshot_filling_m
  use kinds_m, only : wp, long
  use coupled_nodes_m, only : fill_coupled_nodes
  use loads_m, only : is_active
  use contact_results_m, only : interface_resultants, slave_rows
  use element_mass_m, only : element_shares
  use hanging_nodes_m, only : move_hanging_nodes
  use element_state_m, only : add_part_energies, is_eroded, stress_of_slot, &
    plastic_strain_of_slot, find_heat, hoop_strain_of_slot, thickness_strain_of_slot
  use contacts_m, only : has_shear
  use controls_m, only : is_asked
  use history_tables_m, only : table_elout, table_matsum, table_rbdout, table_spcforc
  use layout_m, only : slot_part
  use mass_scaling_m, only : scales_masses, added_masses
  use model_m, only : model_t, mark_supports, is_sheet
  use parts_m, only : has_memory_of_heat
  use snapshot_m, only : snapshot_t, interface_result_t, slave_result_t
  use sorting_m, only : sorted_order
  use rigid_state_m, only : rigid_state_t
  use state_m, only : state_t
  use stress_error_m, only : estimate_errors
  implicit none
  private
  public :: start_snapshot, fill_motion, find_motion, damping_at, fill_energies, fill_parts, &
    fill_bodies, fill_interfaces, fill_plot, fill_slaves

  !> Nodes whose motion is summed at a time.
  integer, parameter :: block_size = 512

contains

  !> Allocate the arrays that the run needs: motion of all nodes only where a file or a constraint
  !> needs it.
  subroutine start_snapshot(model, has_history, snapshot)
    type(model_t), intent(in) :: model
    logical, intent(in) :: has_history !! some part has a plastic strain
    type(snapshot_t), intent(out) :: snapshot
    integer :: n_node, n_element, i

    n_node = model%mesh%n_node
    n_element = model%mesh%n_element
    if (stores_motion(model)) allocate (snapshot%displacement(2, n_node), &
      snapshot%acceleration(2, n_node), source=0.0_wp)
    if (stores_motion(model) .or. is_asked(model%controls%output%histories(table_matsum))) &
      allocate (snapshot%velocity(2, n_node), source=0.0_wp)
    allocate (snapshot%parts(size(model%parts)))
    snapshot%energies%has_mass_scaling = scales_masses(model)
    if (allocated(model%walls)) allocate (snapshot%walls(size(model%walls)))
    if (allocated(model%transducers)) allocate (snapshot%transducers(size(model%transducers)))
    allocate (snapshot%interfaces(size(model%contacts)), snapshot%slaves(size(model%contacts)))
    ! Nodes with mass and a fixed degree of freedom by rising id, if spcforc is asked for.
    allocate (snapshot%supports(0))
    if (is_asked(model%controls%output%histories(table_spcforc))) &
      snapshot%supports = pack([(i, i=1, n_node)], mark_supports(model))
    snapshot%supports = snapshot%supports(sorted_order(int(model%mesh%node_id(snapshot%supports), &
      long)))
    allocate (snapshot%reaction(2, size(snapshot%supports)), source=0.0_wp)
    if (is_asked(model%controls%output%histories(table_elout))) then
      associate (chosen => model%controls%output%history_elements)
        allocate (snapshot%history_elements(size(chosen)))
        snapshot%history_elements%part = model%parts(model%mesh%element_part(chosen))%id
      end associate
    end if
    if (is_asked(model%controls%output%histories(table_rbdout))) &
      allocate (snapshot%bodies(size(model%rigids)))
    if (.not. is_asked(model%controls%output%plot)) return
    allocate (snapshot%stress(6, n_element), source=0.0_wp)
    if (has_history) &
      allocate (snapshot%plastic_strain(n_element), source=0.0_wp)
    if (model%is_axisymmetric) allocate (snapshot%hoop_strain(n_element), source=0.0_wp)
    if (model%controls%output%has_errors) allocate (snapshot%error(n_element), source=0.0_wp)
    if (is_sheet(model)) allocate (snapshot%thickness_strain(n_element), source=0.0_wp)
    if (any(has_memory_of_heat(model%materials))) allocate (snapshot%temperature(n_element), &
      snapshot%damage(n_element), source=0.0_wp)
    if (model%erodes) allocate (snapshot%eroded(n_element), source=0.0_wp)
    if (size(model%contacts) > 0) allocate (snapshot%contact_force(2, n_node), &
      snapshot%contact_pressure(n_node), snapshot%gap(n_node), source=0.0_wp)
    if (any(has_shear(model%contacts))) allocate (snapshot%contact_traction(n_node), &
      snapshot%contact_slip(n_node), snapshot%contact_state(n_node), source=0.0_wp)
  end subroutine start_snapshot

  !> Whether the motion of all nodes is stored: for files, or since some of it does not follow from
  !> nodal forces.
  pure function stores_motion(model) result(stores)
    type(model_t), intent(in) :: model
    logical :: stores

    stores = is_asked(model%controls%output%plot) .or. size(model%controls%output%history_nodes) &
      > 0 .or. size(model%conditions%motions) > 0 .or. size(model%rigids) > 0 &
      .or. model%controls%implicit%is_on .or. allocated(model%conditions%common_motions)
  end function stores_motion

  !> Fill displacement, velocity and acceleration at t(n), where they are stored.
  subroutine fill_motion(model, state, damping, velocity_next, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)       !! D per direction
    real(wp), intent(in) :: velocity_next(:) !! (n_motion) v(n+1/2) of the prescribed degrees of
                                             !! freedom
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: velocity(2), acceleration(2)
    integer :: i

    snapshot%time = state%time
    snapshot%cycle = state%cycle
    snapshot%dt = state%dt
    if (.not. allocated(snapshot%velocity)) return
    do i = 1, model%mesh%n_node
      call find_motion(model%layout%n_special, state, damping, i, velocity, acceleration)
      snapshot%velocity(:, i) = velocity
      if (.not. allocated(snapshot%displacement)) cycle
      snapshot%displacement(:, i) = state%motion(1:2, i)
      snapshot%acceleration(:, i) = acceleration
    end do
    if (allocated(model%conditions%common_motions)) &
      call fill_coupled_nodes(model, state, damping, snapshot%velocity, snapshot%acceleration)
    call fill_prescribed(model, state, velocity_next, snapshot)
    call move_hanging_nodes(model%mesh, snapshot%velocity)
    if (allocated(snapshot%acceleration)) &
      call move_hanging_nodes(model%mesh, snapshot%acceleration)
  end subroutine fill_motion

  !> Fill velocity and acceleration of prescribed degrees of freedom, where they are stored.
  subroutine fill_prescribed(model, state, velocity_next, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: velocity_next(:) !! (n_motion) v(n+1/2)
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: acceleration(2)
    integer :: i

    if (.not. allocated(snapshot%displacement) .or. .not. state%dt > 0.0_wp) return
    ! Prescribed degrees of freedom: the mean of their two half-step velocities.
    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i), &
        k => model%conditions%motions(i)%direction)
        if (.not. is_active(prescribed, state%time)) cycle
        acceleration(k) = (velocity_next(i) - state%prescribed_velocity(i)) &
          /(0.5_wp*(state%dt + state%dt_before))
        snapshot%acceleration(k, prescribed%node) = acceleration(k)
        snapshot%velocity(k, prescribed%node) = state%prescribed_velocity(i) &
          + 0.5_wp*state%dt_before*acceleration(k)
      end associate
    end do
  end subroutine fill_prescribed

  !> D of a node: global, or its own where the deck damps parts.
  pure function damping_at(state, damping, node) result(d)
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    integer, intent(in) :: node
    real(wp) :: d(2)

    d = damping
    if (allocated(state%node_damping)) d = state%node_damping(:, node)
  end function damping_at

  !> Velocity and acceleration of a free node at t(n).
  pure subroutine find_motion(n_special, state, damping, node, velocity, acceleration)
    integer, intent(in) :: n_special
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)
    integer, intent(in) :: node
    real(wp), intent(out) :: velocity(2), acceleration(2)
    real(wp) :: force, a, d(2)
    integer :: k

    d = damping_at(state, damping, node)
    do k = 1, 2
      force = -state%internal_force(k, node)
      if (node <= n_special) force = force + state%force_special(k, node)
      a = force*state%inverse_mass(k, node)
      if (state%inverse_mass(k, node) > 0.0_wp) a = a + state%body_acceleration(k)
      a = (a - d(k)*state%motion(2 + k, node))/(1.0_wp + 0.5_wp*d(k)*state%dt_before)
      acceleration(k) = a
      velocity(k) = state%motion(2 + k, node) + 0.5_wp*state%dt_before*a
    end do
  end subroutine find_motion

  !> Fill the energies; motion must be filled where it is stored.
  subroutine fill_energies(model, state, damping, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2) !! D per direction
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: internal(size(model%parts)), hourglass(size(model%parts)), &
      viscous(size(model%parts)), v(2, block_size)
    real(wp) :: added(size(model%parts)), own(size(model%parts)), total, a(2)
    integer :: first, n, i

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
      do first = 1, model%mesh%n_node, block_size
        n = min(block_size, model%mesh%n_node - first + 1)
        do i = 1, n
          if (allocated(snapshot%velocity)) then
            v(:, i) = snapshot%velocity(:, first + i - 1)
          else
            call find_motion(model%layout%n_special, state, damping, first + i - 1, v(:, i), a)
          end if
        end do
        call add_motion(n, state%mass(first), v, energies%kinetic, snapshot%mean_velocity)
      end do
      total = sum(state%mass) ! none where all elements have left
      if (total > 0.0_wp) snapshot%mean_velocity = snapshot%mean_velocity/total
      energies%damping = state%damping_work
      if (allocated(state%elements%damping_work)) energies%damping = energies%damping &
        + sum(state%elements%damping_work)
      energies%contact = sum(state%contacts%energy) + sum(state%contacts%damping_work) &
        + sum(state%contacts%friction%stored)
      energies%friction = sum(state%contacts%friction%work) - sum(state%contacts%friction%stored)
      if (allocated(state%walls)) energies%friction = energies%friction &
        + sum(state%walls%dissipated)
      energies%created = sum(max(0.0_wp, -state%contacts%monitor%balance))
      energies%external_work = state%external_work + sum(state%contacts%interference%work)
      energies%initial = state%initial_energy
      if (model%erodes) energies%eroded = state%elements%erosion%removed_energy
      if (.not. energies%has_mass_scaling) return
      call added_masses(model, state%elements, added, own)
      snapshot%parts%added_mass = added
      energies%added_mass = sum(added)
      energies%mass_increase = 100.0_wp*sum(added)/max(sum(own), tiny(total))
    end associate
  end subroutine fill_energies

  !> Add kinetic energy and momentum of some nodes. Products first, then sums: fused multiply-adds
  !> in one copy of a loop and not in another would make the bits depend on the block length.
  pure subroutine add_motion(n, mass, velocity, kinetic, momentum)
    integer, intent(in) :: n
    real(wp), intent(in) :: mass(n), velocity(2, n)
    real(wp), intent(inout) :: kinetic, momentum(2)
    real(wp) :: products(3, block_size)
    integer :: i

    do i = 1, n
      products(1, i) = 0.5_wp*mass(i)*(velocity(1, i)**2 + velocity(2, i)**2)
      products(2:3, i) = mass(i)*velocity(:, i)
    end do
    do i = 1, n
      kinetic = kinetic + products(1, i)
      momentum = momentum + products(2:3, i)
    end do
  end subroutine add_motion

  !> Fill kinetic energy, momentum and mass of each part, where velocities are stored.
  subroutine fill_parts(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: shares(4), v(2)
    real(wp), allocatable :: squares(:, :) !! (2, n_node) of velocity
    integer :: i, k, slot, i_part

    if (.not. allocated(snapshot%velocity)) return
    ! Hanging nodes have the energy of their masses at the parents.
    squares = snapshot%velocity**2
    call move_hanging_nodes(model%mesh, squares)
    snapshot%parts%kinetic = 0.0_wp
    snapshot%parts%momentum(1) = 0.0_wp
    snapshot%parts%momentum(2) = 0.0_wp
    snapshot%parts%mass = 0.0_wp
    do i = 1, model%mesh%n_element
      slot = model%layout%element_slot(i)
      i_part = slot_part(model%layout, slot)
      associate (nodes => model%layout%slot_nodes(:, slot), part => snapshot%parts(i_part))
        shares = element_shares(model, slot)
        if (allocated(state%elements%mass_ratio)) shares = state%elements%mass_ratio(slot)*shares
        do k = 1, merge(3, 4, nodes(4) == nodes(3))
          v = snapshot%velocity(:, nodes(k))
          part%kinetic = part%kinetic + 0.5_wp*shares(k)*sum(squares(:, nodes(k)))
          part%momentum = part%momentum + shares(k)*v
          part%mass = part%mass + shares(k)
        end do
      end associate
    end do
    ! *PART_INERTIA: masses of nodes, not of elements.
    do i = 1, size(model%rigids)
      if (.not. model%rigids(i)%has_inertia) cycle
      associate (nodes => model%rigids(i)%nodes, part => snapshot%parts(model%rigids(i)%part))
        part%kinetic = 0.0_wp
        part%momentum = 0.0_wp
        part%mass = sum(state%mass(nodes))
        do k = 1, size(nodes)
          v = snapshot%velocity(:, nodes(k))
          part%kinetic = part%kinetic + 0.5_wp*state%mass(nodes(k))*(v(1)**2 + v(2)**2)
          part%momentum = part%momentum + state%mass(nodes(k))*v
        end do
      end associate
    end do
  end subroutine fill_parts

  !> Fill the motion of rigid bodies, if rbdout is asked for.
  pure subroutine fill_bodies(rigids, lag, snapshot)
    type(rigid_state_t), intent(in) :: rigids(:)
    real(wp), intent(in) :: lag !! time since the instant of the velocities, s
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i

    if (.not. allocated(snapshot%bodies)) return
    do i = 1, size(rigids)
      associate (rigid => rigids(i), body => snapshot%bodies(i))
        body%displacement = rigid%displacement
        body%position = rigid%centre + rigid%displacement(1:2)
        body%velocity = rigid%velocity + lag*rigid%acceleration
        body%acceleration = rigid%acceleration
      end associate
    end do
  end subroutine fill_bodies

  !> Fill the resultants of all interfaces and transducers.
  subroutine fill_interfaces(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    logical, allocatable :: is_on(:), is_loaded(:)
    integer :: i, j, k

    do i = 1, size(model%contacts)
      call interface_resultants(state%contacts(i), snapshot%interfaces(i))
    end do
    if (.not. allocated(model%transducers)) return
    allocate (is_on(size(state%mass)), is_loaded(size(state%mass)))
    do j = 1, size(model%transducers)
      snapshot%transducers(j) = interface_result_t()
      is_loaded = .false.
      is_on = .false.
      is_on(model%transducers(j)%nodes) = .true.
      do i = 1, size(state%contacts)
        associate (memory => state%contacts(i), force => snapshot%transducers(j)%slave_force)
          do k = 1, size(memory%nodes)
            if (.not. is_on(memory%nodes(k))) cycle
            force = force + memory%force(:, k)
            if (any(abs(memory%force(:, k)) > 0.0_wp)) is_loaded(memory%nodes(k)) = .true.
          end do
        end associate
      end do
      snapshot%transducers(j)%n_active = count(is_loaded)
    end do
  end subroutine fill_interfaces

  !> Fill the fields of a plot state and the rows of slave nodes.
  subroutine fill_plot(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i, k, slot

    ! Loop over slots, whose streams are contiguous.
    do slot = 1, model%layout%n_slot
      i = model%layout%slot_element(slot)
      if (i == 0) cycle
      snapshot%stress(:, i) = 0.0_wp
      if (.not. is_eroded(state%elements, slot)) snapshot%stress(1:4, i) = stress_of_slot(model, &
        state%motion, state%elements, slot)
      if (allocated(snapshot%plastic_strain)) &
        snapshot%plastic_strain(i) = plastic_strain_of_slot(model, state%elements, slot)
      if (model%erodes) snapshot%eroded(i) = merge(1.0_wp, 0.0_wp, is_eroded(state%elements, slot))
      if (model%is_axisymmetric) snapshot%hoop_strain(i) = hoop_strain_of_slot(model, &
        state%motion, slot)
      if (allocated(snapshot%thickness_strain)) snapshot%thickness_strain(i) = &
        thickness_strain_of_slot(model, state%elements, slot)
      if (allocated(snapshot%damage)) call find_heat(model, state%elements, slot, &
        snapshot%temperature(i), snapshot%damage(i))
    end do
    if (allocated(snapshot%error)) call estimate_errors(model, state, snapshot%stress, &
      snapshot%error)
    if (size(model%contacts) == 0) return
    snapshot%contact_force = 0.0_wp
    snapshot%contact_pressure = 0.0_wp
    snapshot%gap = 0.0_wp
    if (allocated(snapshot%contact_state)) then
      snapshot%contact_traction = 0.0_wp
      snapshot%contact_slip = 0.0_wp
      snapshot%contact_state = 0.0_wp
    end if
    call fill_slaves(model, state, snapshot)
    do i = 1, size(model%contacts)
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
        if (.not. allocated(rows%friction_result)) cycle
        ! A node of several interfaces has the sum of tractions, the largest slip and the highest
        ! state.
        do k = 1, size(memory%nodes)
          associate (friction_result => rows%friction_result(k), node => memory%nodes(k))
            associate (traction => snapshot%contact_traction(node), &
              slip => snapshot%contact_slip(node), now => snapshot%contact_state(node))
              traction = traction + friction_result%traction
              if (abs(friction_result%slip) > abs(slip)) slip = friction_result%slip
              now = max(now, real(friction_result%state, wp))
            end associate
          end associate
        end do
      end associate
    end do
  end subroutine fill_plot

  !> Fill the rows of slave nodes of each interface.
  subroutine fill_slaves(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i

    do i = 1, size(model%contacts)
      ! Erosion may have changed its nodes.
      if (model%erodes) snapshot%slaves(i) = slave_result_t()
      call slave_rows(state%interfaces(i), state%motion, state%contacts(i), snapshot%slaves(i))
    end do
  end subroutine fill_slaves

end module snapshot_filling_m
