! SPDX-License-Identifier: MIT
!> Renumbers the nodes of a complete model and builds its layout.
module renumber_m
  use controls_m, only : list_boundaries, is_asked, group_nodes, set_corners, &
    end_node_coordinate, end_node_contact
  use exposed_quads_m, only : find_exposed
  use history_tables_m, only : table_bndout
  use kinds_m, only : wp, long
  use layout_building_m, only : build_slots, build_local_numbers, order_nodes
  use mesh_m, only : mesh_t
  use model_m, only : model_t, mark_supports
  use rigids_m, only : mark_rigid_nodes
  use sorting_m, only : sorted_order
  use stages_m, only : stage_t, arrange_stage
  implicit none
  private
  public :: renumber_model, mark_moved_nodes, release_start_data

contains

  !> Renumber the nodes of the model and build its layout; called once, after the deck is read.
  subroutine renumber_model(model)
    type(model_t), intent(inout) :: model
    logical, allocatable :: is_special(:), is_rigid(:)
    integer, allocatable :: order(:), new_index(:)
    real(wp), allocatable :: shares(:, :)
    integer :: i

    allocate (is_rigid(model%mesh%n_element))
    do i = 1, model%mesh%n_element
      is_rigid(i) = model%materials(model%parts(model%mesh%element_part(i))%material)%is_rigid
    end do
    call build_slots(model%mesh, is_rigid, model%layout)
    allocate (is_special(model%mesh%n_node), source=.false.)
    call mark_touched_nodes(model, is_special)
    is_rigid = mark_rigid_nodes(model%rigids, model%mesh%n_node)
    call order_nodes(model%mesh, is_rigid, is_special, model%layout, order)
    allocate (new_index(model%mesh%n_node))
    do i = 1, model%mesh%n_node
      new_index(order(i)) = i
    end do
    associate (mesh => model%mesh)
      mesh%node_id = mesh%node_id(order)
      mesh%coordinates = mesh%coordinates(:, order)
      do i = 1, mesh%n_element
        mesh%element_nodes(:, i) = new_index(mesh%element_nodes(:, i))
      end do
      mesh%deck_node = new_index
    end associate
    if (allocated(model%mesh%hanging)) call renumber_hanging(new_index, model%mesh)
    call renumber_conditions(model, order, new_index)
    call renumber_bodies(model, new_index)
    call build_local_numbers(model%mesh, model%layout)
    call arrange_stage(model%layout%slot_element, model%stage)
    if (.not. model%controls%implicit%is_on) then
      shares = find_exposed(model, [(.true., i=1, model%mesh%n_element)])
      order = pack([(i, i=1, model%mesh%n_element)], any(shares > 0.0_wp, 1))
      model%layout%exposed = model%layout%element_slot(order)
      model%layout%exposed_shares = shares(:, order)
    end if
    if (allocated(model%controls%output%cross_sections)) call renumber_sections(model, new_index)
    model%conditions%n_support = count(mark_supports(model))
    associate (output => model%controls%output)
      if (is_asked(output%histories(table_bndout))) call list_boundaries(model%conditions, &
        model%mesh%node_id, [model%parts(model%rigids%part)%id], output%boundaries)
    end associate
  end subroutine renumber_model

  !> Deallocate arrays that only the start of an explicit run needs: element nodes and parts,
  !> initial velocities and sets.
  subroutine release_start_data(model)
    type(model_t), intent(inout) :: model

    if (allocated(model%conditions%initial_velocity)) &
      deallocate (model%conditions%initial_velocity)
    model%stage = stage_t()
    if (allocated(model%node_sets)) deallocate (model%node_sets)
    if (allocated(model%segment_sets)) deallocate (model%segment_sets)
    if (allocated(model%shell_sets)) deallocate (model%shell_sets)
    if (model%controls%implicit%is_on .or. model%erodes) return
    deallocate (model%mesh%element_nodes, model%mesh%element_part)
    if (.not. is_asked(model%controls%output%plot) .and. allocated(model%mesh%deck_node)) &
      deallocate (model%mesh%deck_node)
  end subroutine release_start_data

  !> Mark nodes with contact, loads, prescribed motion, force groups or rigid walls, and hanging
  !> nodes with their parents.
  subroutine mark_touched_nodes(model, is_special)
    type(model_t), intent(in) :: model
    logical, intent(inout) :: is_special(:) !! (n_node) or (n_special)
    integer :: i

    do i = 1, size(model%contacts)
      is_special(model%contacts(i)%slave%nodes) = .true.
      is_special(model%contacts(i)%master%nodes) = .true.
    end do
    if (model%erodes) call mark_hidden_nodes(model, is_special)
    if (allocated(model%mesh%hanging)) is_special([model%mesh%hanging]) = .true.
    associate (conditions => model%conditions, output => model%controls%output)
      is_special(conditions%motions%node) = .true.
      is_special(conditions%nodal_loads%node) = .true.
      if (allocated(conditions%skew_supports)) is_special(conditions%skew_supports%node) = .true.
      if (allocated(conditions%common_motions)) is_special([(conditions%common_motions(i)%nodes, &
        i=1, size(conditions%common_motions))]) = .true.
      is_special([(conditions%pressures(i)%nodes, i=1, size(conditions%pressures))]) = .true.
      ! Their forces are needed in every cycle.
      if (allocated(output%force_groups)) is_special(group_nodes(output%force_groups)) = .true.
    end associate
    if (allocated(model%controls%ends)) then
      do i = 1, size(model%controls%ends)
        associate (ending => model%controls%ends(i))
          if (ending%kind == end_node_coordinate) is_special(ending%where) = .true.
        end associate
      end do
    end if
    if (allocated(model%walls)) &
      is_special([(model%walls(i)%nodes, i=1, size(model%walls))]) = .true.
  end subroutine mark_touched_nodes

  !> Mark special nodes with contact, loads, prescribed motion, rigid walls or rigid bodies.
  subroutine mark_moved_nodes(model, is_moved)
    type(model_t), intent(in) :: model
    logical, allocatable, intent(out) :: is_moved(:) !! (n_special)
    integer :: i

    allocate (is_moved(model%layout%n_special), source=.false.)
    call mark_touched_nodes(model, is_moved)
    do i = 1, size(model%rigids)
      associate (nodes => model%rigids(i)%nodes)
        is_moved(nodes(:count(nodes <= size(is_moved)))) = .true. ! nodes are sorted
      end associate
    end do
  end subroutine mark_moved_nodes

  !> Mark interior nodes of parts in contact that erosion may expose.
  subroutine mark_hidden_nodes(model, is_special)
    type(model_t), intent(in) :: model
    logical, intent(inout) :: is_special(:) !! (n_node)
    logical :: may_open(size(model%parts))
    integer :: i

    may_open = .false.
    do i = 1, size(model%contacts)
      if (allocated(model%contacts(i)%slave%parts)) &
        may_open(model%contacts(i)%slave%parts) = .true.
      if (allocated(model%contacts(i)%master%parts)) &
        may_open(model%contacts(i)%master%parts) = .true.
    end do
    do i = 1, size(model%parts)
      may_open(i) = may_open(i) .and. allocated(model%materials(model%parts(i)%material)%erosion)
    end do
    do i = 1, model%mesh%n_element
      if (may_open(model%mesh%element_part(i))) is_special(model%mesh%element_nodes(:, i)) = .true.
    end do
  end subroutine mark_hidden_nodes

  !> Renumber hanging nodes, and list them by parent.
  subroutine renumber_hanging(new_index, mesh)
    integer, intent(in) :: new_index(:)
    type(mesh_t), intent(inout) :: mesh
    integer :: k

    do k = 1, 3
      mesh%hanging(k, :) = new_index(mesh%hanging(k, :))
    end do
    associate (parents => [mesh%hanging(2, :), mesh%hanging(3, :)], &
      nodes => [mesh%hanging(1, :), mesh%hanging(1, :)])
      associate (order => sorted_order(int(parents, long)))
        mesh%dependents = transpose(reshape([parents(order), nodes(order)], [size(order), 2]))
      end associate
    end associate
  end subroutine renumber_hanging

  !> Renumber conditions, outputs, termination conditions and sets.
  subroutine renumber_conditions(model, order, new_index)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: order(:), new_index(:)
    integer :: i

    associate (conditions => model%conditions, output => model%controls%output)
      conditions%fixed_nodes = new_index(conditions%fixed_nodes)
      conditions%motions%node = new_index(conditions%motions%node)
      conditions%nodal_loads%node = new_index(conditions%nodal_loads%node)
      if (allocated(conditions%lumped_masses)) &
        conditions%lumped_masses%node = new_index(conditions%lumped_masses%node)
      if (allocated(conditions%skew_supports)) &
        conditions%skew_supports%node = new_index(conditions%skew_supports%node)
      if (allocated(conditions%common_motions)) then
        do i = 1, size(conditions%common_motions)
          conditions%common_motions(i)%nodes = new_index(conditions%common_motions(i)%nodes)
        end do
      end if
      do i = 1, size(conditions%pressures)
        conditions%pressures(i)%nodes = new_index(conditions%pressures(i)%nodes)
      end do
      if (allocated(conditions%initial_velocity)) &
        conditions%initial_velocity = conditions%initial_velocity(:, order)
      output%history_nodes = new_index(output%history_nodes)
      if (allocated(output%force_groups)) then
        do i = 1, size(output%force_groups)
          output%force_groups(i)%nodes = new_index(output%force_groups(i)%nodes)
        end do
      end if
    end associate
    if (allocated(model%controls%ends)) then
      associate (ends => model%controls%ends)
        do i = 1, size(ends)
          if (any(ends(i)%kind == [end_node_coordinate, end_node_contact])) &
            ends(i)%where = new_index(ends(i)%where)
        end do
      end associate
    end if
    do i = 1, size(model%node_sets)
      model%node_sets(i)%nodes = new_index(model%node_sets(i)%nodes)
    end do
    do i = 1, size(model%segment_sets)
      model%segment_sets(i)%nodes(1, :) = new_index(model%segment_sets(i)%nodes(1, :))
      model%segment_sets(i)%nodes(2, :) = new_index(model%segment_sets(i)%nodes(2, :))
    end do
  end subroutine renumber_conditions

  !> Renumber nodes and edges of cross sections and sort their elements by slot.
  subroutine renumber_sections(model, new_index)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: new_index(:)
    integer :: i

    do i = 1, size(model%controls%output%cross_sections)
      associate (section => model%controls%output%cross_sections(i))
        section%nodes = new_index(section%nodes)
        section%edges(1, :) = new_index(section%edges(1, :))
        section%edges(2, :) = new_index(section%edges(2, :))
        section%elements = section%elements(sorted_order(int( &
          model%layout%element_slot(section%elements), long)))
        call set_corners(model%layout, model%mesh%n_node, section)
      end associate
    end do
  end subroutine renumber_sections

  !> Renumber contact surfaces, transducers, rigid bodies and walls. Nodes of bodies and walls are
  !> sorted, so that special nodes come first; walls get the index of each special node.
  subroutine renumber_bodies(model, new_index)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: new_index(:)
    integer :: i, k

    do i = 1, size(model%contacts)
      model%contacts(i)%slave%nodes = new_index(model%contacts(i)%slave%nodes)
      model%contacts(i)%master%nodes = new_index(model%contacts(i)%master%nodes)
    end do
    if (allocated(model%transducers)) then
      do i = 1, size(model%transducers)
        model%transducers(i)%nodes = new_index(model%transducers(i)%nodes)
      end do
    end if
    do i = 1, size(model%rigids)
      model%rigids(i)%nodes = rising(new_index(model%rigids(i)%nodes))
    end do
    if (.not. allocated(model%walls)) return
    do i = 1, size(model%walls)
      associate (wall => model%walls(i))
        wall%nodes = rising(new_index(wall%nodes))
        allocate (wall%node_index(model%layout%n_special), source=0)
        do k = 1, size(wall%nodes)
          wall%node_index(wall%nodes(k)) = k
        end do
      end associate
    end do

  contains

    !> Numbers in increasing order.
    function rising(numbers) result(sorted)
      integer, intent(in) :: numbers(:)
      integer :: sorted(size(numbers))

      sorted = numbers(sorted_order(int(numbers, long)))
    end function rising

  end subroutine renumber_bodies

end module renumber_m
