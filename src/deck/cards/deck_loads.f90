! SPDX-License-Identifier: MIT
!> *LOAD_: forces on nodes and rigid bodies, pressures on outer edges, body loads; *ELEMENT_MASS.
module deck_loads_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use boundary_m, only : boundary_t, find_edge
  use conditions_m, only : nodal_load_t, pressure_load_t, lumped_mass_t
  use model_m, only : model_t
  use rigids_m, only : mark_rigid_nodes
  use deck_cards_m, only : cursor_t, next_of, rows_of, open_cursor, next_row, check_rest, &
    report_field, reject_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node, a_part, a_curve, a_segment_set, a_system
  use deck_lines_m, only : deck_t, place_t, blocks_of, line_warning
  use deck_sets_m, only : check_edge
  use deck_supports_m, only : card_nodes, mark_axis, mark_massive, across_axis
  use deck_values_m, only : integer_of, real_of, has_field, find_id
  implicit none
  private
  public :: read_nodal_loads, read_pressures, settle_pressures, read_body_loads, read_masses, &
    read_rigid_loads, warn_of_bores

  !> No bore is narrower than this share of the largest radius: its nodes were meant to be on the
  !> axis.
  real(wp), parameter :: bore_share = 1.0e-6_wp

contains

  !> *LOAD_NODE_: forces on nodes.
  subroutine read_nodal_loads(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(nodal_load_t), allocatable :: loads(:)
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: found, is_massive(model%mesh%n_node)
    integer, allocatable :: nodes(:)
    integer :: curve, j, k, n, first_radial
    real(wp) :: axis(2)

    allocate (loads(64))
    is_massive = mark_massive(deck, model)
    n = 0
    first_radial = 0
    call rows_of('LOAD_NODE_', cursor)
    do
      call next_of(deck, cursor, card, found)
      if (.not. found) exit
      if (any(card%bad)) cycle
      if (integer_of(card, 'DOF') == 1 .and. first_radial == 0) first_radial = card%line
      call card_nodes(deck, card, model, nodes)
      call find_id(deck, a_curve, card, 'LCID', curve)
      k = findloc(is_massive(nodes), .false., dim=1)
      if (k > 0) call report_field(deck, card, 1, ': node '//to_text(model%mesh%node_id(nodes(k))) &
        //' belongs to no element and cannot be loaded')
      if (curve == 0) cycle
      call load_axes(deck, card, axis)
      do k = 1, size(nodes)
        do j = 1, 2
          if (.not. abs(axis(j)) > 0.0_wp) cycle
          if (n == size(loads)) loads = [loads, loads]
          n = n + 1
          loads(n) = nodal_load_t(nodes(k), j, curve, real_of(card, 'SF')*axis(j))
        end do
      end do
    end do
    model%conditions%nodal_loads = loads(:n)
    if (model%is_round) call warn_of_axis_loads(deck, first_radial, model)
  end subroutine read_nodal_loads

  !> The direction of a load in the axes of the model; 0 for a moment.
  subroutine load_axes(deck, card, axis)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    real(wp), intent(out) :: axis(2)
    integer :: direction, system

    axis = 0.0_wp
    direction = integer_of(card, 'DOF')
    if (direction > 2) return
    axis(direction) = 1.0_wp
    if (integer_of(card, 'CID') == 0) return
    call find_id(deck, a_system, card, 'CID', system)
    if (system > 0) axis = deck%axes(:, direction, system)
  end subroutine load_axes

  !> Warn of forces in r on nodes of the axis, at the first card with a force in r.
  subroutine warn_of_axis_loads(deck, line, model)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    type(model_t), intent(in) :: model
    logical :: is_there(model%mesh%n_node), is_lost(size(model%conditions%nodal_loads))

    is_there = mark_axis(model)
    associate (loads => model%conditions%nodal_loads)
      is_lost = is_there(loads%node) .and. loads%direction == 1
      if (any(is_lost)) call line_warning(deck, line, 'radial load', to_text(count(is_lost)) &
        //' load(s) in r act on nodes on the axis (x = 0), which do not move in r: they do ' &
        //'nothing; the first is on node ' &
        //to_text(model%mesh%node_id(loads(findloc(is_lost, .true., dim=1))%node)))
    end associate
  end subroutine warn_of_axis_loads

  !> Warn of free nodes next to the axis: the hoop stress at the rim of a bore is not that of a body
  !> without one, however narrow it is.
  subroutine warn_of_bores(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    logical :: is_rim(model%mesh%n_node)
    integer :: first

    if (.not. model%is_round .or. model%mesh%n_node == 0) return
    associate (radius => model%mesh%coordinates(1, :), conditions => model%conditions)
      is_rim = radius > 0.0_wp .and. radius < bore_share*maxval(radius) &
        .and. .not. mark_rigid_nodes(model%rigids, model%mesh%n_node)
      is_rim(pack(conditions%fixed_nodes, conditions%fixed_directions == 1)) = .false.
      if (.not. any(is_rim)) return
      first = findloc(is_rim, .true., dim=1)
      call line_warning(deck, deck%maps(a_node)%lines(first), 'bore', to_text(count(is_rim)) &
        //' node(s) lie next to the axis but not on it, and move in r as the rim of a bore; the ' &
        //'first is '//to_text(model%mesh%node_id(first))//' at the radius ' &
        //to_text(radius(first))//'; give them x = 0, or hold them')
    end associate
  end subroutine warn_of_bores

  !> *LOAD_RIGID_BODY.
  subroutine read_rigid_loads(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: part, curve, body, k
    real(wp) :: along(3)
    logical :: found

    call rows_of('LOAD_RIGID_BODY', cursor)
    do
      call next_of(deck, cursor, card, found)
      if (.not. found) exit
      if (any(card%bad)) cycle
      call find_id(deck, a_part, card, 'PID', part)
      call find_id(deck, a_curve, card, 'LCID', curve)
      call load_axes(deck, card, along(:2))
      along(3) = merge(1.0_wp, 0.0_wp, integer_of(card, 'DOF') == 7)
      if (part == 0 .or. curve == 0) cycle
      if (model%parts(part)%material == 0) cycle
      body = findloc(model%rigids%part, part, dim=1)
      if (body == 0) then
        call report_field(deck, card, 'PID', 'is not a rigid part (*MAT_RIGID); *LOAD_NODE_SET ' &
          //'loads nodes')
        cycle
      end if
      if (model%is_round .and. any(abs(along([1, 3])) > 0.0_wp)) &
        call report_field(deck, card, 'DOF', across_axis)
      if (.not. allocated(model%conditions%rigid_loads)) allocate (model%conditions%rigid_loads(0))
      do k = 1, 3
        if (abs(along(k)) > 0.0_wp) model%conditions%rigid_loads = [model%conditions%rigid_loads, &
          nodal_load_t(body, k, curve, real_of(card, 'SF')*along(k))]
      end do
    end do
  end subroutine read_rigid_loads

  !> *LOAD_SEGMENT and _SET: edges as the cards name them, until the outer edges are known.
  subroutine read_pressures(deck, model, places)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(place_t), allocatable, intent(out) :: places(:) !! where each stands
    type(pressure_load_t), allocatable :: loads(:)
    type(place_t), allocatable :: all_places(:)
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: edges(:, :)
    integer :: curve, set, k, n
    logical :: found

    allocate (loads(64), all_places(64))
    n = 0
    call rows_of('LOAD_SEGMENT', cursor)
    do
      call next_of(deck, cursor, card, found)
      if (.not. found) exit
      if (has_field(card, 'N1')) call check_edge(deck, card)
      if (any(card%bad)) cycle
      edges = reshape([integer ::], [2, 0])
      if (has_field(card, 'N1')) then
        edges = reshape([0, 0], [2, 1])
        call find_id(deck, a_node, card, 'N1', edges(1, 1))
        call find_id(deck, a_node, card, 'N2', edges(2, 1))
        if (any(edges == 0)) edges = edges(:, :0)
      else
        call find_id(deck, a_segment_set, card, 'SSID', set)
        if (set > 0) edges = model%segment_sets(set)%nodes
      end if
      call find_id(deck, a_curve, card, 'LCID', curve)
      do k = 1, size(edges, 2)
        if (n == size(loads)) then
          loads = [loads, loads]
          all_places = [all_places, all_places]
        end if
        n = n + 1
        loads(n) = pressure_load_t(edges(:, k), curve, real_of(card, 'SF'), real_of(card, 'AT'))
        all_places(n) = place_t(card%line, 1, merge('N1  ', 'SSID', has_field(card, 'N1')))
      end do
    end do
    model%conditions%pressures = loads(:n)
    places = all_places(:n)
  end subroutine read_pressures

  !> Edges that carry pressure walked counter-clockwise round the body; others are errors, one for
  !> each card.
  subroutine settle_pressures(deck, places, outside, in_doubt, model)
    type(deck_t), intent(inout) :: deck
    type(place_t), intent(in) :: places(:)       !! where each load stands
    type(boundary_t), intent(in) :: outside
    logical, intent(in) :: in_doubt(:)           !! (n_node) edges of these are not judged
    type(model_t), intent(inout) :: model
    integer :: i, told

    told = 0
    do i = 1, size(places)
      associate (nodes => model%conditions%pressures(i)%nodes)
        if (any(in_doubt(nodes))) cycle
        if (find_edge(outside, nodes(1), nodes(2)) > 0) cycle
        if (find_edge(outside, nodes(2), nodes(1)) > 0) then
          nodes = nodes([2, 1])
        else if (places(i)%line /= told) then
          told = places(i)%line
          call reject_field(deck, places(i), ': nodes '//to_text(model%mesh%node_id(nodes(1))) &
            //' and '//to_text(model%mesh%node_id(nodes(2)))//' are not the ends of an outer ' &
            //'edge of the mesh')
        end if
      end associate
    end do
  end subroutine settle_pressures

  !> *LOAD_BODY_X and _Y: base accelerations. Across the axis of revolution they have no meaning.
  subroutine read_body_loads(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(nodal_load_t) :: load
    integer, allocatable :: blocks(:)
    integer :: i
    logical :: found

    allocate (model%conditions%body_loads(0))
    blocks = blocks_of(deck, 'LOAD_BODY_')
    do i = 1, size(blocks)
      call open_cursor(deck, blocks(i), cursor)
      call next_row(deck, cursor, 1, card, found)
      call check_rest(deck, cursor)
      if (any(card%bad)) cycle
      call find_id(deck, a_curve, card, 'LCID', load%curve)
      load%direction = merge(2, 1, deck%blocks(blocks(i))%name == 'LOAD_BODY_Y')
      load%scale = real_of(card, 'SF')
      if (model%is_round .and. load%direction == 1) call report_field(deck, card, 'LCID', &
        ': *LOAD_BODY_X acts across the axis of an axisymmetric deck; *LOAD_BODY_Y acts along it')
      if (load%curve > 0) model%conditions%body_loads = [model%conditions%body_loads, load]
    end do
  end subroutine read_body_loads

  !> *ELEMENT_MASS and *ELEMENT_MASS_NODE_SET: the mass on each node.
  subroutine read_masses(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(lumped_mass_t), allocatable :: masses(:)
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: found, is_massive(model%mesh%n_node)
    integer, allocatable :: nodes(:)
    integer :: k, n

    if (size(blocks_of(deck, 'ELEMENT_MASS')) == 0) return
    is_massive = mark_massive(deck, model)
    allocate (masses(64))
    n = 0
    call rows_of('ELEMENT_MASS', cursor)
    do
      call next_of(deck, cursor, card, found)
      if (.not. found) exit
      if (any(card%bad)) cycle
      call card_nodes(deck, card, model, nodes)
      k = findloc(is_massive(nodes), .false., dim=1)
      if (k > 0) call report_field(deck, card, 2, ': node '//to_text(model%mesh%node_id(nodes(k))) &
        //' belongs to no element and can not carry a mass')
      if (.not. real_of(card, 'MASS') > 0.0_wp) cycle
      do k = 1, size(nodes)
        if (n == size(masses)) masses = [masses, masses]
        n = n + 1
        masses(n) = lumped_mass_t(nodes(k), real_of(card, 'MASS'))
      end do
    end do
    model%conditions%lumped_masses = masses(:n)
  end subroutine read_masses

end module deck_loads_m
