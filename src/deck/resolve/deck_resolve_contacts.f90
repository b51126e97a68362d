! SPDX-License-Identifier: MIT
!> Surfaces of the interfaces and edges of the pressure loads. Called for sound meshes only.
module deck_resolve_contacts_m
  use log_m, only : to_text
  use surfaces_m, only : surface_t
  use conditions_m, only : pressure_load_t
  use model_m, only : model_t
  use boundary_m, only : boundary_t, find_boundary, find_edge
  use surface_building_m, only : boundary_surface, chain_surface, chain_turned, chain_ordered, &
    chain_broken, chain_repeated, chain_short
  use deck_lines_m, only : deck_t, place_t, line_warning
  use deck_cards_m, only : reject_field
  use deck_initial_overlap_m, only : check_overlap
  use deck_maps_m, only : maps_t, resolve_id
  use deck_raw_m, only : raw_t, row_t, raw_contact_t, row_pressure, row_pressure_set, &
    id_fields, id_place
  implicit none
  private
  public :: resolve_contacts, check_references

  !> Names of the two sides in messages.
  character(6), parameter :: side_names(2) = ['slave ', 'master']
  !> Fields of the ends of an edge.
  character(2), parameter :: node_fields(2) = ['N1', 'N2']

contains

  !> Interfaces and pressure loads.
  subroutine resolve_contacts(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    type(boundary_t) :: outside
    type(surface_t) :: sides(2)
    logical, allocatable :: among(:), all_elements(:)
    integer :: i, k, n_error

    allocate (among(model%mesh%n_node), source=.false.)
    allocate (all_elements(model%mesh%n_element), source=.true.)
    call mark_nodes(raw, maps, model, among)
    call find_boundary(model%mesh%element_nodes, all_elements, among, outside)
    call resolve_pressures(deck, raw, maps, outside, model)
    allocate (model%contacts(size(raw%contacts)))
    do i = 1, size(raw%contacts)
      n_error = deck%report%n_error
      do k = 1, merge(1, 2, raw%contacts(i)%contact%is_self)
        call resolve_side(deck, raw%contacts(i), k, maps, outside, model, sides(k))
      end do
      if (raw%contacts(i)%contact%is_self) sides(2) = sides(1)
      model%contacts(i) = raw%contacts(i)%contact
      model%contacts(i)%slave = sides(1)
      model%contacts(i)%master = sides(2)
      if (.not. raw%contacts(i)%contact%is_self) &
        call check_common_nodes(deck, raw%contacts(i), sides, model)
      if (deck%report%n_error == n_error) call check_overlap(deck, raw%contacts(i), sides, model)
    end do
  end subroutine resolve_contacts

  !> What `resolve_contacts` would find of wrong ids, for a mesh that it can not be called for.
  subroutine check_references(deck, raw, maps)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    integer :: i, k, found

    do i = 1, size(raw%contacts)
      associate (sides => raw%contacts(i)%sides, places => raw%contacts(i)%places)
        do k = 1, 2
          if (sides(k) > 0) call resolve_id(deck, maps%part_sets, sides(k), 'part set', &
            places(k), found)
          if (sides(k) < 0) call resolve_id(deck, maps%node_sets, -sides(k), 'node set', &
            places(k), found)
        end do
      end associate
    end do
    do i = 1, raw%n_row
      associate (row => raw%rows(i))
        if (row%kind == row_pressure) then
          call resolve_id(deck, maps%curves, row%curve, 'curve', id_place(row), found)
          do k = 1, 2
            call resolve_id(deck, maps%nodes, row%nodes(k), 'node', &
              place_t(row%line, 1, node_fields(k)), found)
          end do
        else if (row%kind == row_pressure_set) then
          call resolve_id(deck, maps%segment_sets, row%id, 'segment set', id_place(row), found)
          call resolve_id(deck, maps%curves, row%curve, 'curve', place_t(row%line, 1, 'LCID'), &
            found)
        end if
      end associate
    end do
  end subroutine check_references

  !> Nodes of contact node sets and of pressure edges: only their edges are looked for.
  subroutine mark_nodes(raw, maps, model, among)
    use deck_ids_m, only : index_of
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(in) :: model
    logical, intent(inout) :: among(:)
    integer :: i, k, found

    do i = 1, size(raw%contacts)
      do k = 1, 2
        if (raw%contacts(i)%sides(k) >= 0) cycle
        found = index_of(maps%node_sets, -raw%contacts(i)%sides(k))
        if (found > 0) among(model%node_sets(found)%nodes) = .true.
      end do
    end do
    do i = 1, raw%n_row
      if (raw%rows(i)%kind == row_pressure) then
        do k = 1, 2
          found = index_of(maps%nodes, raw%rows(i)%nodes(k))
          if (found > 0) among(found) = .true.
        end do
      else if (raw%rows(i)%kind == row_pressure_set) then
        found = index_of(maps%segment_sets, raw%rows(i)%id)
        if (found == 0) cycle
        do k = 1, 2
          among(model%segment_sets(found)%nodes(k, :)) = .true.
        end do
      end if
    end do
  end subroutine mark_nodes

  !> Pressure loads, their edges walked counter-clockwise round the body.
  subroutine resolve_pressures(deck, raw, maps, outside, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(boundary_t), intent(in) :: outside
    type(model_t), intent(inout) :: model
    type(pressure_load_t), allocatable :: loads(:)
    integer :: i, k, n, found, nodes(2)

    allocate (loads(64))
    n = 0
    do i = 1, raw%n_row
      if (raw%rows(i)%kind == row_pressure) then
        do k = 1, 2
          call resolve_id(deck, maps%nodes, raw%rows(i)%nodes(k), 'node', &
            place_t(raw%rows(i)%line, 1, node_fields(k)), nodes(k))
        end do
        if (all(nodes > 0)) call add_pressures(deck, maps, raw%rows(i), &
          reshape(nodes, [2, 1]), outside, model, loads, n)
      else if (raw%rows(i)%kind == row_pressure_set) then
        call resolve_id(deck, maps%segment_sets, raw%rows(i)%id, 'segment set', &
          id_place(raw%rows(i)), found)
        if (found > 0) call add_pressures(deck, maps, raw%rows(i), &
          model%segment_sets(found)%nodes, outside, model, loads, n)
      end if
    end do
    model%conditions%pressures = loads(:n)
  end subroutine resolve_pressures

  !> Pressure of one card on its edges.
  subroutine add_pressures(deck, maps, row, edges, outside, model, loads, n)
    type(deck_t), intent(inout) :: deck
    type(maps_t), intent(in) :: maps
    type(row_t), intent(in) :: row
    integer, intent(in) :: edges(:, :)
    type(boundary_t), intent(in) :: outside
    type(model_t), intent(in) :: model
    type(pressure_load_t), allocatable, intent(inout) :: loads(:)
    integer, intent(inout) :: n          !! loads so far
    type(pressure_load_t) :: load
    integer :: i

    call resolve_id(deck, maps%curves, row%curve, 'curve', place_t(row%line, 1, 'LCID'), load%curve)
    if (load%curve == 0) return
    load%scale = row%scale
    load%arrival = row%arrival
    do i = 1, size(edges, 2)
      if (find_edge(outside, edges(1, i), edges(2, i)) > 0) then
        load%nodes = edges(:, i)
      else if (find_edge(outside, edges(2, i), edges(1, i)) > 0) then
        load%nodes = edges([2, 1], i)
      else
        call reject_field(deck, place_t(row%line, 1, merge('N1  ', &
          id_fields(row%kind), row%kind == row_pressure)), ': nodes ' &
          //to_text(model%mesh%node_id(edges(1, i)))//' and ' &
          //to_text(model%mesh%node_id(edges(2, i)))//' are not the ends of an outer edge of ' &
          //'the mesh')
        return
      end if
      if (n == size(loads)) loads = [loads, loads]
      n = n + 1
      loads(n) = load
    end do
  end subroutine add_pressures

  !> The surface of one side of an interface.
  subroutine resolve_side(deck, entry, side, maps, outside, model, surface)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    integer, intent(in) :: side
    type(maps_t), intent(in) :: maps
    type(boundary_t), intent(in) :: outside
    type(model_t), intent(in) :: model
    type(surface_t), intent(out) :: surface
    integer :: found

    if (entry%sides(side) > 0) then
      call resolve_id(deck, maps%part_sets, entry%sides(side), 'part set', entry%places(side), &
        found)
      if (found > 0) call surface_of_parts(deck, model%part_sets(found)%parts, entry%places(side), &
        model, surface)
    else if (entry%sides(side) < 0) then
      call resolve_id(deck, maps%node_sets, -entry%sides(side), 'node set', entry%places(side), &
        found)
      if (found > 0) call surface_of_nodes(deck, model%node_sets(found)%nodes, side, &
        entry%places(side), outside, model, surface)
    end if
    if (.not. allocated(surface%nodes)) &
      allocate (surface%nodes(0), surface%segments(2, 0), surface%segment_element(0))
  end subroutine resolve_side

  !> Exterior boundary of a set of parts.
  subroutine surface_of_parts(deck, parts, place, model, surface)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: parts(:)
    type(place_t), intent(in) :: place
    type(model_t), intent(in) :: model
    type(surface_t), intent(out) :: surface
    type(boundary_t) :: boundary
    logical, allocatable :: chosen_part(:), all_nodes(:)
    integer :: crossing

    allocate (chosen_part(size(model%parts)), source=.false.)
    allocate (all_nodes(model%mesh%n_node), source=.true.)
    chosen_part(parts) = .true.
    call find_boundary(model%mesh%element_nodes, chosen_part(model%mesh%element_part), all_nodes, &
      boundary)
    if (boundary%n_edge == 0) then
      call reject_field(deck, place, 'has no boundary: its parts have no elements')
      return
    end if
    call boundary_surface(boundary, surface, crossing)
    if (crossing > 0) call reject_field(deck, place, 'has a boundary that touches itself at node ' &
      //to_text(model%mesh%node_id(crossing))//'; give the surface as a node set')
  end subroutine surface_of_parts

  !> Chain of a node set.
  subroutine surface_of_nodes(deck, nodes, side, place, outside, model, surface)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: nodes(:)
    integer, intent(in) :: side
    type(place_t), intent(in) :: place
    type(boundary_t), intent(in) :: outside
    type(model_t), intent(in) :: model
    type(surface_t), intent(out) :: surface
    integer :: outcome, trouble(2)

    call chain_surface(outside, nodes, surface, outcome, trouble)
    select case (outcome)
    case (chain_turned)
      call line_warning(deck, place%line, 'turned'//to_text(place%line)//side_names(side), &
        'the '//trim(side_names(side))//' surface was walked clockwise round its body and ' &
        //'has been turned')
    case (chain_ordered)
      call line_warning(deck, place%line, 'ordered'//to_text(place%line)//side_names(side), &
        'the nodes of the '//trim(side_names(side))//' surface were not in walking order and ' &
        //'have been put in order')
    case (chain_short)
      call reject_field(deck, place, 'is a set with fewer than two nodes, which is no surface')
    case (chain_repeated)
      call reject_field(deck, place, 'is a set with node ' &
        //to_text(model%mesh%node_id(trouble(1)))//' in it twice')
    case (chain_broken)
      call reject_field(deck, place, 'is a set whose nodes do not follow an outer edge of the ' &
        //'mesh: the first break is between nodes ' &
        //to_text(model%mesh%node_id(trouble(1)))//' and ' &
        //to_text(model%mesh%node_id(trouble(2))))
    end select
  end subroutine surface_of_nodes

  !> A node may stand on one side of an interface only.
  subroutine check_common_nodes(deck, entry, sides, model)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(surface_t), intent(in) :: sides(2)
    type(model_t), intent(in) :: model
    logical, allocatable :: on_slave(:)
    character(:), allocatable :: names
    integer :: i, n

    if (size(sides(1)%nodes) == 0 .or. size(sides(2)%nodes) == 0) return
    allocate (on_slave(model%mesh%n_node), source=.false.)
    on_slave(sides(1)%nodes) = .true.
    n = 0
    names = ''
    do i = 1, size(sides(2)%nodes)
      if (.not. on_slave(sides(2)%nodes(i))) cycle
      n = n + 1
      if (n <= 5) names = names//' '//to_text(model%mesh%node_id(sides(2)%nodes(i)))
    end do
    if (n > 5) names = names//' and '//to_text(n - 5)//' more'
    if (n > 0) call reject_field(deck, entry%places(2), &
      'shares nodes with the slave surface:'//names)
  end subroutine check_common_nodes

end module deck_resolve_contacts_m
