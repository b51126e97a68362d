! SPDX-License-Identifier: MIT
!> *LOAD_: forces on nodes and rigid bodies, pressures on outer edges, body loads; *ELEMENT_MASS;
!> *DAMPING_GLOBAL, *DAMPING_PART_MASS (with a second card where FLAG asks for it) and
!> *DAMPING_PART_STIFFNESS.
module deck_loads_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use boundary_m, only : boundary_t, find_edge
  use conditions_m, only : nodal_load_t, pressure_load_t, lumped_mass_t, &
    damping_t, part_damping_t
  use model_m, only : model_t
  use parts_m, only : gives_pressure
  use rigids_m, only : mark_rigid_nodes
  use deck_cards_m, only : cursor_t, next_of, open_cursor, next_card, next_row, row_comes, &
    check_rest, report_field, reject_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node, a_part, a_part_set, a_curve, a_segment_set, a_system
  use deck_lines_m, only : deck_t, location_t, blocks_of, line_text, line_error
  use deck_sets_m, only : check_edge
  use deck_supports_m, only : card_nodes, find_body, mark_axis, mark_nodes_with_mass, &
    warn_of_nodes, across_axis
  use deck_values_m, only : integer_of, real_of, reals_of, has_field, find_id
  implicit none
  private
  public :: read_nodal_loads, read_pressures, orient_pressures, read_body_loads, read_masses, &
    read_rigid_loads, read_global_damping, read_mass_damping, read_stiffness_damping, warn_of_bores

  !> Fraction of the largest radius below which free nodes are probably meant to lie on the axis.
  real(wp), parameter :: bore_share = 1.0e-6_wp

contains

  !> *LOAD_NODE_: forces on nodes.
  subroutine read_nodal_loads(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(nodal_load_t), allocatable :: loads(:)
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: has_mass(model%mesh%n_node), is_axis(model%mesh%n_node)
    integer, allocatable :: nodes(:)
    integer :: curve, j, k, n, first_radial
    real(wp) :: axis(2)

    allocate (loads(64))
    has_mass = mark_nodes_with_mass(deck, model)
    n = 0
    first_radial = 0
    do while (next_of(deck, 'LOAD_NODE_', cursor, card))
      if (any(card%bad)) cycle
      if (integer_of(card, 'DOF') == 1 .and. first_radial == 0) first_radial = card%line
      call card_nodes(deck, card, model, nodes)
      call find_id(deck, a_curve, card, 'LCID', curve)
      k = findloc(has_mass(nodes), .false., dim=1)
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
    is_axis = mark_axis(model)
    call warn_of_nodes(deck, first_radial, 'radial load', model, pack([loads(:n)%node], &
      is_axis(loads(:n)%node) .and. loads(:n)%direction == 1), 'loads in r without effect, ' &
      //'on nodes on the axis (x = 0), which are fixed in r', '')
  end subroutine read_nodal_loads

  !> Unit vector of the direction of a load in model axes; 0 for a moment.
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

  !> Warn of free nodes close to the axis: a bore, however narrow, changes the hoop stress.
  subroutine warn_of_bores(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    logical :: is_bore(model%mesh%n_node)
    integer, allocatable :: nodes(:)
    integer :: i

    if (.not. model%is_axisymmetric .or. model%mesh%n_node == 0) return
    associate (radius => model%mesh%coordinates(1, :), conditions => model%conditions)
      is_bore = radius > 0.0_wp .and. radius < bore_share*maxval(radius) &
        .and. .not. mark_rigid_nodes(model%rigids, model%mesh%n_node)
      is_bore(pack(conditions%fixed_nodes, conditions%fixed_directions == 1)) = .false.
      nodes = pack([(i, i=1, size(is_bore))], is_bore)
      if (size(nodes) > 0) call warn_of_nodes(deck, deck%maps(a_node)%lines(nodes(1)), 'bore', &
        model, nodes, 'nodes that lie next to the axis but not on it and form a bore', &
        ' at radius '//to_text(radius(nodes(1)))//'; set x = 0, or fix them in r')
    end associate
  end subroutine warn_of_bores

  !> *LOAD_RIGID_BODY.
  subroutine read_rigid_loads(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: curve, body, k
    real(wp) :: along(3)

    do while (next_of(deck, 'LOAD_RIGID_BODY', cursor, card))
      if (any(card%bad)) cycle
      call find_body(deck, card, model, '; *LOAD_NODE_SET loads nodes', body)
      call find_id(deck, a_curve, card, 'LCID', curve)
      call load_axes(deck, card, along(:2))
      along(3) = merge(1.0_wp, 0.0_wp, integer_of(card, 'DOF') == 7)
      if (body == 0 .or. curve == 0) cycle
      if (model%is_axisymmetric .and. any(abs(along([1, 3])) > 0.0_wp)) &
        call report_field(deck, card, 'DOF', across_axis)
      if (.not. allocated(model%conditions%rigid_loads)) allocate (model%conditions%rigid_loads(0))
      do k = 1, 3
        if (abs(along(k)) > 0.0_wp) model%conditions%rigid_loads = [model%conditions%rigid_loads, &
          nodal_load_t(body, k, curve, real_of(card, 'SF')*along(k))]
      end do
    end do
  end subroutine read_rigid_loads

  !> *LOAD_SEGMENT and _SET: edges with the nodes of the cards, not yet oriented.
  subroutine read_pressures(deck, model, locations)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(location_t), allocatable, intent(out) :: locations(:) !! of the loads
    type(pressure_load_t), allocatable :: loads(:)
    type(location_t), allocatable :: all_locations(:)
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: edges(:, :)
    integer :: curve, set, k, n

    allocate (loads(64), all_locations(64))
    n = 0
    do while (next_of(deck, 'LOAD_SEGMENT', cursor, card))
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
          all_locations = [all_locations, all_locations]
        end if
        n = n + 1
        loads(n) = pressure_load_t(edges(:, k), curve, real_of(card, 'SF'), real_of(card, 'AT'))
        all_locations(n) = location_t(card%line, 1, merge('N1  ', 'SSID', has_field(card, 'N1')))
      end do
    end do
    model%conditions%pressures = loads(:n)
    locations = all_locations(:n)
  end subroutine read_pressures

  !> Orient the edges with pressure counter-clockwise about their body; report others, one error for
  !> each card.
  subroutine orient_pressures(deck, locations, outside, is_uncertain, model)
    type(deck_t), intent(inout) :: deck
    type(location_t), intent(in) :: locations(:) !! of the loads
    type(boundary_t), intent(in) :: outside
    logical, intent(in) :: is_uncertain(:)       !! (n_node) nodes whose edges are not checked
    type(model_t), intent(inout) :: model
    integer :: i, edge, reported_line

    reported_line = 0
    do i = 1, size(locations)
      associate (nodes => model%conditions%pressures(i)%nodes)
        if (any(is_uncertain(nodes))) cycle
        edge = find_edge(outside, nodes(1), nodes(2))
        if (edge == 0) then
          edge = find_edge(outside, nodes(2), nodes(1))
          if (edge > 0) nodes = nodes([2, 1])
        end if
        if (edge > 0) then
          associate (part => model%parts(model%mesh%element_part(outside%elements(edge))))
            if (part%section > 0) model%conditions%pressures(i)%scale = &
              model%conditions%pressures(i)%scale*model%sections(part%section)%thickness
          end associate
        else if (locations(i)%line /= reported_line) then
          reported_line = locations(i)%line
          call reject_field(deck, locations(i), ': nodes '//to_text(model%mesh%node_id(nodes(1))) &
            //' and '//to_text(model%mesh%node_id(nodes(2)))//' are not the ends of an outer ' &
            //'edge of the mesh')
        end if
      end associate
    end do
  end subroutine orient_pressures

  !> *LOAD_BODY_X and _Y: base accelerations; axisymmetric decks have *LOAD_BODY_Y only.
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
      found = next_row(deck, cursor, 1, card)
      call check_rest(deck, cursor)
      if (any(card%bad)) cycle
      call find_id(deck, a_curve, card, 'LCID', load%curve)
      load%direction = merge(2, 1, deck%blocks(blocks(i))%name == 'LOAD_BODY_Y')
      load%scale = real_of(card, 'SF')
      if (model%is_axisymmetric .and. load%direction == 1) call report_field(deck, card, 'LCID', &
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
    logical :: has_mass(model%mesh%n_node)
    integer, allocatable :: nodes(:)
    integer :: k, n

    if (size(blocks_of(deck, 'ELEMENT_MASS')) == 0) return
    has_mass = mark_nodes_with_mass(deck, model)
    allocate (masses(64))
    n = 0
    do while (next_of(deck, 'ELEMENT_MASS', cursor, card))
      if (any(card%bad)) cycle
      call card_nodes(deck, card, model, nodes)
      k = findloc(has_mass(nodes), .false., dim=1)
      if (k > 0) call report_field(deck, card, 2, ': node '//to_text(model%mesh%node_id(nodes(k))) &
        //' belongs to no element and cannot have a mass')
      if (.not. real_of(card, 'MASS') > 0.0_wp) cycle
      do k = 1, size(nodes)
        if (n == size(masses)) masses = [masses, masses]
        n = n + 1
        masses(n) = lumped_mass_t(nodes(k), real_of(card, 'MASS'))
      end do
    end do
    model%conditions%lumped_masses = masses(:n)
  end subroutine read_masses

  !> *DAMPING_GLOBAL.
  subroutine read_global_damping(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(damping_t) :: damping
    integer, allocatable :: blocks(:)
    integer :: i
    logical :: found

    blocks = blocks_of(deck, 'DAMPING_GLOBAL')
    do i = 1, size(blocks)
      call open_cursor(deck, blocks(i), cursor)
      found = next_row(deck, cursor, 1, card)
      call check_rest(deck, cursor)
      if (any(card%bad)) cycle
      call refuse_static(deck, model, card%line, '*DAMPING_GLOBAL')
      if (allocated(model%conditions%damping)) call line_error(deck, card%line, &
        'is given a second time')
      damping = damping_t(coefficient=real_of(card, 'VALDMP'))
      ! All six factors zero mean one everywhere.
      if (any(abs(reals_of(card, 'STX', 'SRZ')) > 0.0_wp)) damping%factor = &
        reals_of(card, 'STX', 'STY')
      if (integer_of(card, 'LCID') > 0) call find_curve(deck, card, model, damping%curve)
      model%conditions%damping = damping
    end do
  end subroutine read_global_damping

  !> *DAMPING_PART_MASS.
  subroutine read_mass_damping(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card, factors
    type(part_damping_t) :: damping
    integer, allocatable :: parts(:)
    integer :: k
    logical :: found

    do while (next_of(deck, 'DAMPING_PART_MASS', cursor, card))
      damping%factor = 1.0_wp
      if (integer_of(card, 'FLAG') == 1) then
        call next_card(deck, cursor, 2, factors)
        damping%factor = reals_of(factors, 'STX', 'STY')
      else
        ! Skip a second card of zeros, which some programs write with FLAG 0 too: there is no part
        ! 0.
        found = row_comes(deck, cursor)
        if (found) found = verify(line_text(deck, cursor%line), ' 0.,+-eEdD') == 0
        if (found) cursor%line = cursor%line + 1
      end if
      if (any(card%bad)) cycle
      call refuse_static(deck, model, card%line, '*DAMPING_PART_MASS')
      call card_parts(deck, card, model, parts)
      call find_curve(deck, card, model, damping%curve)
      if (damping%curve == 0) cycle
      if (.not. allocated(model%conditions%part_damping)) &
        allocate (model%conditions%part_damping(0))
      damping%scale = real_of(card, 'SF')
      do k = 1, size(parts)
        damping%part = parts(k)
        model%conditions%part_damping = [model%conditions%part_damping, damping]
      end do
    end do
  end subroutine read_mass_damping

  !> *DAMPING_PART_STIFFNESS.
  subroutine read_stiffness_damping(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: parts(:)
    integer :: k

    do while (next_of(deck, 'DAMPING_PART_STIFFNESS', cursor, card))
      if (any(card%bad)) cycle
      if (model%controls%implicit%is_on) call line_error(deck, card%line, &
        'the implicit method does not have *DAMPING_PART_STIFFNESS')
      call card_parts(deck, card, model, parts)
      do k = 1, size(parts)
        associate (part => model%parts(parts(k)))
          if (part%material == 0) cycle
          if (allocated(model%materials(part%material)%eos) .or. &
            gives_pressure(model%materials(part%material))) call report_field(deck, card, 1, &
            ': part '//to_text(part%id)//' has plane stress, an equation of state, a rubber law ' &
            //'or failure, for which this version has no stiffness damping')
          if (abs(part%stiffness_damping) > 0.0_wp) call report_field(deck, card, 1, &
            ': part '//to_text(part%id)//' has stiffness damping by another card too')
          if (model%materials(part%material)%is_rigid) cycle
          part%stiffness_damping = real_of(card, 'COEF')
        end associate
      end do
    end do
  end subroutine read_stiffness_damping

  !> The part of a card, or those of its part set; none where the id is wrong.
  subroutine card_parts(deck, card, model, parts)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: parts(:)
    integer :: found

    allocate (parts(0))
    if (has_field(card, 'PSID')) then
      call find_id(deck, a_part_set, card, 'PSID', found)
      if (found > 0) parts = model%part_sets(found)%parts
    else
      call find_id(deck, a_part, card, 'PID', found)
      if (found > 0) parts = [found]
    end if
  end subroutine card_parts

  !> Index of a damping curve, which must not be negative.
  subroutine find_curve(deck, card, model, curve)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    integer, intent(out) :: curve

    call find_id(deck, a_curve, card, 'LCID', curve)
    if (curve == 0) return
    if (minval(model%curves(curve)%ordinate) < 0.0_wp) call report_field(deck, card, 'LCID', &
      'is a curve with values below 0: negative damping would create energy')
  end subroutine find_curve

  !> Report mass damping in statics.
  subroutine refuse_static(deck, model, line, name)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: line
    character(*), intent(in) :: name

    associate (implicit => model%controls%implicit)
      if (implicit%is_on .and. .not. implicit%is_dynamic) call line_error(deck, line, name &
        //' has no effect in statics; dynamics need IMASS 1 of *CONTROL_IMPLICIT_DYNAMICS')
    end associate
  end subroutine refuse_static

end module deck_loads_m
