! SPDX-License-Identifier: MIT
!> Rows of histories other than sums and fields: supports (spcforc), elements (elout), boundaries
!> and groups of nodes (bndout, nodfor), cross sections (secforc). Both drivers fill them into the
!> snapshot where they are due.
module history_filling_m
  use controls_m, only : cross_section_t, boundary_load, boundary_pressure
  use element_state_m, only : stress_of_slot, plastic_strain_of_slot, is_eroded
  use loads_m, only : add_nodal_loads, add_pressures
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use model_m, only : model_t
  use face_stress_m, only : position_of
  use snapshot_m, only : snapshot_t, section_result_t
  use state_m, only : state_t
  implicit none
  private
  public :: fill_reactions, fill_explicit_reactions, fill_history_elements, form_loads, &
    fill_boundaries, fill_sections

contains

  ! ---- support forces: R = f_int - f_ext - f_contact at a fixed degree of freedom

  !> Fill the reactions of supports; 0 in free directions.
  pure subroutine fill_reactions(model, reaction, snapshot)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: reaction(:, :)   !! (2, n_node) R of all degrees of freedom
    type(snapshot_t), intent(inout) :: snapshot
    logical :: is_fixed(2, model%mesh%n_node)
    integer :: i

    if (size(snapshot%supports) == 0) return
    is_fixed = .false.
    do i = 1, size(model%conditions%fixed_nodes)
      is_fixed(model%conditions%fixed_directions(i), model%conditions%fixed_nodes(i)) = .true.
    end do
    snapshot%reaction = merge(reaction(:, snapshot%supports), 0.0_wp, &
      is_fixed(:, snapshot%supports))
  end subroutine fill_reactions

  !> Fill the reactions of the explicit driver. A body load acts on the mass of fixed nodes too.
  pure subroutine fill_explicit_reactions(model, state, snapshot, held)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    real(wp), intent(in), optional :: held(:, :) !! (2, n_skew) forces of skew supports on nodes
    real(wp) :: reaction(2, model%mesh%n_node)
    integer :: row(model%mesh%n_node), i, k

    if (size(snapshot%supports) == 0) return
    do k = 1, 2
      reaction(k, :) = state%internal_force(k, :) - state%mass*state%body_acceleration(k)
    end do
    associate (n => model%layout%n_special)
      reaction(:, :n) = reaction(:, :n) - state%force_special(:, :n)
    end associate
    call fill_reactions(model, reaction, snapshot)
    if (.not. present(held)) return
    row = 0
    row(snapshot%supports) = [(i, i=1, size(snapshot%supports))]
    do i = 1, size(held, 2)
      k = row(model%conditions%skew_supports(i)%node)
      if (k > 0) snapshot%reaction(:, k) = snapshot%reaction(:, k) + held(:, i)
    end do
  end subroutine fill_explicit_reactions

  ! ---- elements

  !> Fill stresses and plastic strains of the elements of *DATABASE_HISTORY_SHELL.
  subroutine fill_history_elements(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i

    if (.not. allocated(snapshot%history_elements)) return
    do i = 1, size(snapshot%history_elements)
      associate (slot => model%layout%element_slot(model%controls%output%history_elements(i)), &
        element => snapshot%history_elements(i))
        element%is_eroded = is_eroded(state%elements, slot)
        element%stress = 0.0_wp
        if (.not. element%is_eroded) element%stress = stress_of_slot(model, state%motion, &
          state%elements, slot)
        element%plastic_strain = plastic_strain_of_slot(model, state%elements, slot)
      end associate
    end do
  end subroutine fill_history_elements

  ! ---- boundaries and groups of nodes

  !> Forces of nodal loads and pressures at `time`, by row of bndout.
  subroutine form_loads(model, motion, time, force)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)    !! (4, n_node)
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: force(:, :)  !! (3, n_boundary)
    real(wp), allocatable :: nodal(:, :), pressed(:, :)
    integer :: i

    allocate (nodal(2, model%layout%n_special), pressed(2, model%layout%n_special), source=0.0_wp)
    call add_nodal_loads(model, time, nodal)
    call add_pressures(model, motion, time, pressed)
    associate (rows => model%controls%output%boundaries)
      do i = 1, size(rows%where)
        if (rows%condition(i) == boundary_load) force(1:2, i) = nodal(:, rows%where(i))
        if (rows%condition(i) == boundary_pressure) force(1:2, i) = pressed(:, rows%where(i))
      end do
    end associate
  end subroutine form_loads

  !> Copy forces and works of boundaries and node groups into the snapshot.
  subroutine fill_boundaries(state, snapshot)
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot

    if (allocated(state%boundary_work)) then
      snapshot%boundary_force = state%boundary_force
      snapshot%boundary_work = state%boundary_work
    end if
    if (allocated(state%group_work)) then
      snapshot%group_force = state%group_force
      snapshot%group_work = state%group_work
    end if
  end subroutine fill_boundaries

  ! ---- cross sections: resultants of the element forces on the nodes of the section

  !> Fill all cross sections from the stored element forces.
  subroutine fill_sections(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i, first

    if (.not. allocated(state%cut_force)) return
    first = 1
    associate (sections => model%controls%output%cross_sections)
      if (.not. allocated(snapshot%sections)) allocate (snapshot%sections(size(sections)))
      do i = 1, size(sections)
        call find_centroid(model, sections(i), state, snapshot%sections(i))
        call add_forces(model, sections(i), state, first, snapshot%sections(i))
        first = first + size(sections(i)%elements)
      end do
    end associate
  end subroutine fill_sections

  !> Current area and centroid of the edges in the section; without edges the mean position of its
  !> nodes and no area.
  pure subroutine find_centroid(model, section, state, result)
    type(model_t), intent(in) :: model
    type(cross_section_t), intent(in) :: section
    type(state_t), intent(in) :: state
    type(section_result_t), intent(out) :: result
    real(wp) :: a(2), b(2), length, depth
    integer :: i

    depth = 1.0_wp
    if (size(section%elements) > 0) depth = model%sections(model%parts(slot_part(model%layout, &
      model%layout%element_slot(section%elements(1))))%section)%thickness
    do i = 1, size(section%edges, 2)
      a = position_of(model, state, section%edges(1, i))
      b = position_of(model, state, section%edges(2, i))
      length = depth*norm2(b - a)
      if (model%is_axisymmetric) then
        result%area = result%area + 0.5_wp*length*(a(1) + b(1))
        result%centroid = result%centroid + length/6.0_wp*((2.0_wp*a(1) + b(1))*a + (a(1) &
          + 2.0_wp*b(1))*b)
      else
        result%area = result%area + length
        result%centroid = result%centroid + 0.5_wp*length*(a + b)
      end if
    end do
    if (result%area > 0.0_wp) then
      result%centroid = result%centroid/result%area
      return
    end if
    do i = 1, size(section%nodes)
      result%centroid = result%centroid + position_of(model, state, section%nodes(i)) &
        /size(section%nodes)
    end do
  end subroutine find_centroid

  !> Sum of the forces on the nodes of the section and their moment about its centroid.
  pure subroutine add_forces(model, section, state, first, result)
    type(model_t), intent(in) :: model
    type(cross_section_t), intent(in) :: section
    type(state_t), intent(in) :: state
    integer, intent(in) :: first              !! of its elements among those of all sections
    type(section_result_t), intent(inout) :: result
    real(wp) :: arm(2), f(2)
    integer :: i, k

    do i = 1, size(section%elements)
      associate (nodes => model%layout%slot_nodes(:, &
        model%layout%element_slot(section%elements(i))))
        do k = 1, 4
          if (.not. section%is_corner(k, i)) cycle
          f = state%cut_force(2*k - 1:2*k, first + i - 1)
          arm = position_of(model, state, nodes(k)) - result%centroid
          result%force = result%force + f
          result%moment = result%moment + (arm(1)*f(2) - arm(2)*f(1))
        end do
      end associate
    end do
  end subroutine add_forces

end module history_filling_m
