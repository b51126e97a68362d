! SPDX-License-Identifier: MIT
!> Error indicator of each interface at instants that are written: contact pressure against the
!> stress of the elements at the surface (doc/theory/contact.md, section 8.1), which their errors
!> contain too, and energy of the springs against that of the bodies (section 8.2).
module error_indicator_m
  use contact_facets_m, only : follow_arcs
  use law_state_m, only : contact_estimate_t
  use contact_step_limit_m, only : spring_bound_t, bound_springs, stable_step
  use contact_results_m, only : sides_of_corners
  use contacts_m, only : contact_t, is_tied, penalty_implicit
  use controls_m, only : is_asked
  use history_tables_m, only : table_sleout
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use model_m, only : model_t
  use face_stress_m, only : face_rows_t, find_face_rows, face_pressure, face_inertia, &
    elastic_energy, has_stress, other_pressure_t, find_other_pressures, face_share
  use snapshot_filling_m, only : fill_slaves
  use snapshot_m, only : snapshot_t, interface_result_t, part_result_t
  use state_m, only : state_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: evaluate_indicators, update_energy_peaks, parts_at_surfaces, of_noise

  !> The second difference of uncorrelated noise has 6 times its variance.
  real(wp), parameter :: of_noise = 6.0_wp
  !> Resultant over the sum of nodal forces below which the resultant has no noise of its own: on
  !> closed rings it vanishes.
  real(wp), parameter :: resultant_share = 0.1_wp

contains

  !> Evaluate the indicators of all interfaces, whose resultants are in the snapshot.
  subroutine evaluate_indicators(model, state, plots, rows, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, intent(in) :: plots !! slave rows are in the snapshot already
    type(face_rows_t), intent(inout) :: rows
    type(snapshot_t), intent(inout) :: snapshot
    type(other_pressure_t), allocatable :: others(:)
    type(contact_t) :: contact
    type(contact_estimate_t) :: side
    type(spring_bound_t) :: bound(1)
    real(wp), allocatable :: master_stress(:)
    real(wp) :: element_limit, scale(1)
    integer :: i

    if (size(model%contacts) == 0) return
    ! The first and the last state have everything, whether a file receives it or not.
    if (state%cycle == 0 .and. .not. (plots &
      .or. is_asked(model%controls%output%histories(table_sleout)))) return
    call find_face_rows(model, rows)
    if (.not. plots) call fill_slaves(model, state, snapshot)
    element_limit = minval(state%elements%time_limit)
    allocate (others(2*size(model%contacts)))
    if (rows%are_shared) call find_other_pressures(model, state, snapshot%slaves, others)
    do i = 1, size(model%contacts)
      contact = state%interfaces(i)
      ! The common step limit of interfaces that share nodes is too expensive for every row.
      if (.not. model%controls%implicit%is_on) then
        scale = merge(0.0_wp, 1.0_wp, model%contacts(i)%penalty_unit == penalty_implicit)
        call bound_springs(state%interfaces(i:i), state%contact_mass, state%contacts(i:i), scale, &
          bound)
        snapshot%interfaces(i)%step_limit = stable_step(element_limit, bound(1))
      end if
      side = contact_estimate_t()
      associate (slaves => snapshot%slaves(i), result => snapshot%interfaces(i))
        call add_side(model, state, rows, contact%slave, slaves%pressure, &
          others(2*i - 1)%pressure, side, slaves%row_stress)
        if (allocated(snapshot%error)) call add_jumps(model, state, contact%slave, &
          slaves%pressure, others(2*i - 1)%pressure, slaves%row_stress, snapshot%error)
        ! Self contact has slave nodes only.
        if (.not. contact%is_self) then
          call add_side(model, state, rows, contact%master, slaves%master_pressure, &
            others(2*i)%pressure, side, master_stress)
          if (allocated(snapshot%error)) call add_jumps(model, state, contact%master, &
            slaves%master_pressure, others(2*i)%pressure, master_stress, snapshot%error)
        end if
        ! Accelerations of nodes at rigid walls and of coupled nodes are not known here.
        side%still = min(side%still, side%misfit)
        result%row_energy = side%rows
        result%estimate = 0.0_wp
        if (side%load > 0.0_wp) result%estimate = sqrt(side%misfit/side%load)
        if (state%cycle > state%estimates(i)%cycle) call add_instant(state%cycle, state%dt, side, &
          result, sum(norm2(slaves%force, 1)), state%estimates(i))
      end associate
    end do
  end subroutine evaluate_indicators

  !> Add one side: pressure of each loaded node against the mean stress of the elements at its
  !> segments, weighted by area. Rigid bodies are left out.
  subroutine add_side(model, state, rows, surface, own, others, side, row_stress)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(face_rows_t), intent(in) :: rows
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: own(:) !! contact pressure of its nodes
    real(wp), allocatable, intent(in) :: others(:) !! contact pressure of other interfaces there
    type(contact_estimate_t), intent(inout) :: side
    real(wp), allocatable, intent(inout) :: row_stress(:) !! element stress at its nodes
    real(wp), dimension(surface%n_node) :: area, moved, pressure
    real(wp) :: places(4, surface%n_node), share(2), stress
    logical :: is_side(surface%n_segment)
    integer :: s, k, nodes(2)

    if (allocated(row_stress)) deallocate (row_stress)
    allocate (row_stress(surface%n_node), source=0.0_wp)
    area = 0.0_wp
    moved = 0.0_wp
    pressure = own
    if (allocated(others)) pressure = own + others
    places(1:2, :) = model%mesh%coordinates(:, surface%nodes)
    places(3:4, :) = state%motion(1:2, surface%nodes)
    is_side = sides_of_corners(surface, places, abs(own) > 0.0_wp)
    do s = 1, surface%n_segment
      if (is_side(s)) cycle
      associate (element => surface%segment_element(s), ends => surface%segments(:, s))
        if (.not. has_stress(model, state, element)) cycle
        nodes = surface%nodes(ends)
        stress = face_pressure(model, state, rows, element, nodes)
        share = face_share(model, state, nodes)
        area(ends) = area(ends) + share
        row_stress(ends) = row_stress(ends) + share*stress
        if (.not. any(abs(own(ends)) > 0.0_wp)) cycle
        moved(ends) = moved(ends) + face_inertia(model, state, rows, element, nodes)
        side%rows = side%rows + elastic_energy(model, state, element)
      end associate
    end do
    do k = 1, surface%n_node
      if (.not. area(k) > 0.0_wp) cycle
      row_stress(k) = row_stress(k)/area(k)
      if (.not. abs(own(k)) > 0.0_wp) cycle
      side%misfit = side%misfit + (pressure(k) - row_stress(k))**2*area(k)
      side%load = side%load + pressure(k)**2*area(k)
      side%still = side%still + (pressure(k) - row_stress(k) - moved(k)/area(k))**2*area(k)
    end do
  end subroutine add_side

  !> Add the energy of the jump between contact pressure and element stress at loaded nodes to the
  !> errors of the elements at the segments: half of the squared jump at each end.
  subroutine add_jumps(model, state, surface, own, others, stress, errors)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: own(:)     !! contact pressure of its nodes, Pa
    real(wp), allocatable, intent(in) :: others(:) !! contact pressure of other interfaces there
    real(wp), intent(in) :: stress(:)              !! element stress at its nodes
    real(wp), intent(inout) :: errors(:)           !! (n_element) J per metre or per radian
    real(wp) :: jump(surface%n_node)
    integer :: s

    jump = own - stress
    if (allocated(others)) jump = jump + others
    where (.not. abs(own) > 0.0_wp) jump = 0.0_wp
    do s = 1, surface%n_segment
      associate (element => surface%segment_element(s), ends => surface%segments(:, s))
        if (has_stress(model, state, element)) errors(element) = errors(element) &
          + elastic_energy(model, state, element, norm2(jump(ends))*[sqrt(0.5_wp), 0.0_wp, 0.0_wp, &
          0.0_wp])
      end associate
    end do
  end subroutine add_jumps

  !> Add one instant to the sums of the run.
  pure subroutine add_instant(cycle, dt, side, result, nodal_forces, estimate)
    integer, intent(in) :: cycle
    real(wp), intent(in) :: dt
    type(contact_estimate_t), intent(in) :: side
    type(interface_result_t), intent(in) :: result
    real(wp), intent(in) :: nodal_forces !! sum of their magnitudes, N/m
    type(contact_estimate_t), intent(inout) :: estimate
    real(wp) :: ratio

    ratio = real(cycle - estimate%cycle, wp)/max(estimate%stride, 1)
    estimate%stride = cycle - estimate%cycle
    estimate%cycle = cycle
    estimate%n = estimate%n + 1
    estimate%misfit = estimate%misfit + side%misfit
    estimate%load = estimate%load + side%load
    estimate%still = estimate%still + side%still
    if (side%load > estimate%heaviest) then
      estimate%heaviest = side%load
      estimate%at_heaviest = result%estimate
    end if
    if (side%load > 0.0_wp) then
      estimate%springs = estimate%springs + result%stored
      estimate%rows = estimate%rows + side%rows
    end if
    if (estimate%n > 2 .and. norm2(result%slave_force) >= resultant_share*nodal_forces) then
      estimate%jumps = estimate%jumps + sum((result%slave_force - estimate%force &
        - ratio*(estimate%force - estimate%previous))**2) &
        *of_noise/(1.0_wp + (1.0_wp + ratio)**2 + ratio**2)
      estimate%forces = estimate%forces + sum(result%slave_force**2)
    end if
    estimate%previous = estimate%force
    estimate%force = result%slave_force
    if (result%step_limit > 0.0_wp .and. dt > 0.0_wp) &
      estimate%least_margin = min(estimate%least_margin, result%step_limit/dt)
  end subroutine add_instant

  !> Update the largest energies of the springs and of the bodies on both sides (none at time zero),
  !> and the facet measures of curved surfaces.
  subroutine update_energy_peaks(model, parts, bodies, state)
    type(model_t), intent(in) :: model
    type(part_result_t), intent(in) :: parts(:)      !! with internal energies
    integer, allocatable, intent(inout) :: bodies(:) !! (n_part) set in the first call
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(model%contacts)
      if (is_tied(model%contacts(i))) cycle
      if (.not. allocated(bodies)) call find_bodies(model, bodies)
      associate (contact => model%contacts(i), memory => state%contacts(i), &
        estimate => state%estimates(i))
        call follow_arcs(state%interfaces(i), memory, estimate)
        if (state%cycle == 0) cycle
        estimate%bodies = max(estimate%bodies, sum(parts%internal, &
          of_bodies(bodies, parts_at_surfaces(model, contact))))
        estimate%stored = max(estimate%stored, memory%monitor%stored)
      end associate
    end do
  end subroutine update_energy_peaks

  !> Number the bodies: parts that share nodes or are tied to each other have one number.
  pure subroutine find_bodies(model, bodies)
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: bodies(:) !! (n_part)
    integer, allocatable :: first(:) !! (n_node) first part of each node
    logical :: is_joined(size(model%parts))
    integer :: i, k, slot, part

    bodies = [(i, i=1, size(model%parts))]
    allocate (first(model%mesh%n_node), source=0)
    do slot = 1, model%layout%n_slot
      if (model%layout%slot_element(slot) == 0) cycle
      part = slot_part(model%layout, slot)
      do k = 1, size(model%layout%slot_nodes, 1)
        associate (node => model%layout%slot_nodes(k, slot))
          if (first(node) == 0) first(node) = part
          if (bodies(first(node)) == bodies(part)) cycle
          where (bodies == bodies(part)) bodies = bodies(first(node))
        end associate
      end do
    end do
    do i = 1, size(model%contacts)
      if (.not. is_tied(model%contacts(i))) cycle
      is_joined = of_bodies(bodies, parts_at_surfaces(model, model%contacts(i)))
      where (is_joined) bodies = minval(bodies, mask=is_joined)
    end do
  end subroutine find_bodies

  !> Parts whose elements lie at the surfaces of an interface.
  pure function parts_at_surfaces(model, contact) result(is_behind)
    type(model_t), intent(in) :: model
    type(contact_t), intent(in) :: contact
    logical :: is_behind(size(model%parts))
    integer :: s

    is_behind = .false.
    associate (elements => [contact%slave%segment_element, contact%master%segment_element])
      do s = 1, size(elements)
        is_behind(slot_part(model%layout, model%layout%element_slot(elements(s)))) = .true.
      end do
    end associate
  end function parts_at_surfaces

  !> Parts of all bodies that the given parts belong to.
  pure function of_bodies(bodies, is_some) result(is_of)
    integer, intent(in) :: bodies(:)  !! (n_part)
    logical, intent(in) :: is_some(:) !! (n_part)
    logical :: is_of(size(bodies))
    logical :: is_body(size(bodies))

    is_body = .false.
    is_body(pack(bodies, is_some)) = .true.
    is_of = is_body(bodies)
  end function of_bodies

end module error_indicator_m
