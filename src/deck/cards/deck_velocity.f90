! SPDX-License-Identifier: MIT
!> Initial velocities: *INITIAL_VELOCITY_RIGID_BODY, *INITIAL_VELOCITY and _NODE in deck order, then
!> _GENERATION in deck order.
module deck_velocity_m
  use kinds_m, only : wp
  use model_m, only : model_t
  use rigids_m, only : mark_rigid_nodes
  use deck_boxes_m, only : mark_box
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_row, check_rest, report_field, &
    warn_of_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node, a_part, a_node_set, a_part_set, a_box
  use deck_lines_m, only : deck_t, blocks_of, line_warning
  use deck_supports_m, only : find_body, mark_axis, warn_of_nodes, across_axis
  use deck_values_m, only : integer_of, real_of, reals_of, location_of, find_id
  implicit none
  private
  public :: read_velocities

contains

  !> Read all initial velocities.
  subroutine read_velocities(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(cursor_t) :: cursor
    type(card_t) :: card
    real(wp), allocatable :: velocity(:, :)
    integer, allocatable :: blocks(:), held(:)
    integer :: i, node, turn, lines(2)
    logical :: is_generation

    blocks = blocks_of(deck, 'INITIAL_VELOCITY')
    allocate (velocity(2, model%mesh%n_node), source=0.0_wp)
    lines = 0
    do turn = 1, 2
      do i = 1, size(blocks)
        is_generation = deck%blocks(blocks(i))%name == 'INITIAL_VELOCITY_GENERATION'
        if (is_generation .neqv. turn == 2) cycle
        call open_cursor(deck, blocks(i), cursor)
        select case (deck%blocks(blocks(i))%name)
        case ('INITIAL_VELOCITY_RIGID_BODY')
          call read_rigid_velocities(deck, cursor, model)
        case ('INITIAL_VELOCITY_NODE')
          do while (next_row(deck, cursor, 1, card))
            if (any(card%bad)) cycle
            if (lines(1) == 0) lines(1) = card%line
            call find_id(deck, a_node, card, 'NID', node)
            if (node > 0) velocity(:, node) = reals_of(card, 'VX', 'VY')
          end do
        case ('INITIAL_VELOCITY')
          call read_velocity(deck, cursor, model, lines(2), velocity)
        case default
          call read_generation(deck, cursor, model, lines(2), velocity)
        end select
      end do
    end do
    if (all(lines == 0)) return
    i = merge(lines(2), lines(1), lines(2) > 0)
    call warn_in_statics(deck, model, i)
    if (model%is_axisymmetric) then
      held = pack([(node, node=1, model%mesh%n_node)], abs(velocity(1, :)) > 0.0_wp &
        .and. (mark_axis(model) .or. mark_rigid_nodes(model%rigids, model%mesh%n_node)))
      velocity(1, held) = 0.0_wp
      call warn_of_nodes(deck, i, 'radial velocity', model, held, 'nodes on the axis or of ' &
        //'rigid bodies whose initial velocity in r is ignored', '')
    end if
    call move_alloc(velocity, model%conditions%initial_velocity)
  end subroutine read_velocities

  !> Warn once of initial velocities in statics.
  subroutine warn_in_statics(deck, model, line)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer, intent(in) :: line

    if (model%controls%implicit%is_on .and. .not. model%controls%implicit%is_dynamic) call &
      line_warning(deck, line, 'static velocity', 'an initial velocity has no effect in statics')
  end subroutine warn_in_statics

  !> *INITIAL_VELOCITY: a node set or all nodes, with BOXID those in the box, without the nodes of a
  !> second set, which have another velocity.
  subroutine read_velocity(deck, cursor, model, first_line, velocity)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(model_t), intent(in) :: model
    integer, intent(inout) :: first_line
    real(wp), intent(inout) :: velocity(:, :)
    type(card_t) :: cards(3)
    logical :: is_chosen(model%mesh%n_node)
    integer :: set, box, others, i

    call next_card(deck, cursor, 1, cards(1))
    call next_card(deck, cursor, 2, cards(2))
    if (integer_of(cards(1), 'NSIDEX') /= 0) call next_card(deck, cursor, 3, cards(3))
    call check_rest(deck, cursor)
    call check_rigid(deck, cards(1))
    if (any(cards(1)%bad) .or. any(cards(2)%bad)) return
    if (first_line == 0) first_line = cards(1)%line
    is_chosen = integer_of(cards(1), 'NSID') == 0
    if (.not. integer_of(cards(1), 'NSID') == 0) then
      call find_id(deck, a_node_set, cards(1), 'NSID', set)
      if (set > 0) is_chosen(model%node_sets(set)%nodes) = .true.
    end if
    if (integer_of(cards(1), 'BOXID') > 0) then
      call find_id(deck, a_box, cards(1), 'BOXID', box)
      if (box > 0) then
        is_chosen = is_chosen .and. mark_box(deck, box, model)
        if (.not. any(is_chosen)) call warn_of_field(deck, location_of(cards(1), 'BOXID'), &
          'has none of the nodes that it is to give a velocity')
      end if
    end if
    if (integer_of(cards(1), 'NSIDEX') > 0) then
      call find_id(deck, a_node_set, cards(1), 'NSIDEX', others)
      if (others > 0) then
        associate (nodes => model%node_sets(others)%nodes)
          is_chosen(nodes) = .false.
          velocity(:, nodes) = spread(reals_of(cards(3), 'VXE', 'VYE'), 2, size(nodes))
        end associate
      end if
    end if
    do i = 1, model%mesh%n_node
      if (is_chosen(i)) velocity(:, i) = reals_of(cards(2), 'VX', 'VY')
    end do
  end subroutine read_velocity

  !> Refuse IRIGID beside *PART_INERTIA, whose velocity it would replace. Other rigid bodies have
  !> the velocities of their nodes.
  subroutine check_rigid(deck, card)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card

    if (integer_of(card, 'IRIGID') /= 0 .and. size(blocks_of(deck, 'PART_INERTIA')) > 0) &
      call report_field(deck, card, 'IRIGID', 'asks for a velocity in place of that of ' &
      //'*PART_INERTIA; give it there')
  end subroutine check_rigid

  !> *INITIAL_VELOCITY_GENERATION: translation and rotation about an axis along z.
  subroutine read_generation(deck, cursor, model, first_line, velocity)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(model_t), intent(in) :: model
    integer, intent(inout) :: first_line
    real(wp), intent(inout) :: velocity(:, :)
    character(*), parameter :: turned = &
      'tilts the axis; in the plane bodies rotate about z'
    type(card_t) :: card, axis
    logical :: is_chosen(model%mesh%n_node)
    real(wp) :: spin, centre(2), ahead(2)
    integer :: i

    call next_card(deck, cursor, 1, card)
    call next_card(deck, cursor, 2, axis)
    call check_rest(deck, cursor)
    spin = real_of(card, 'OMEGA')
    if (abs(spin) > 0.0_wp) then
      if (abs(real_of(axis, 'NX')) > 0.0_wp) call report_field(deck, axis, 'NX', turned)
      if (abs(real_of(axis, 'NY')) > 0.0_wp) call report_field(deck, axis, 'NY', turned)
    end if
    call check_rigid(deck, axis)
    if (any(card%bad) .or. any(axis%bad)) return
    if (first_line == 0) first_line = card%line
    if (model%is_axisymmetric .and. abs(spin) > 0.0_wp) call report_field(deck, card, 'OMEGA', &
      'asks for a rotation about z, which axisymmetric parts do not have')
    if (real_of(axis, 'NZ') < 0.0_wp) spin = -spin
    ahead = reals_of(card, 'VX', 'VY')
    centre = reals_of(axis, 'XC', 'YC')
    call choose_nodes(deck, card, model, is_chosen)
    do i = 1, model%mesh%n_node
      if (.not. is_chosen(i)) cycle
      velocity(1, i) = ahead(1) - spin*(model%mesh%coordinates(2, i) - centre(2))
      velocity(2, i) = ahead(2) + spin*(model%mesh%coordinates(1, i) - centre(1))
    end do
  end subroutine read_generation

  !> Nodes of the part set, part or node set of a card; all nodes for 0.
  subroutine choose_nodes(deck, card, model, is_chosen)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    logical, intent(out) :: is_chosen(:)    !! (n_node)
    integer, parameter :: kinds(3) = [a_part_set, a_part, a_node_set]
    logical :: is_of_part(0:size(model%parts))
    integer :: kind, found

    is_chosen = integer_of(card, 'ID') == 0
    if (integer_of(card, 'ID') == 0) return
    kind = kinds(integer_of(card, 'STYP'))
    call find_id(deck, kind, card, 'ID', found)
    if (found == 0) return
    if (kind == a_node_set) then
      is_chosen(model%node_sets(found)%nodes) = .true.
      return
    end if
    is_of_part = .false.
    if (kind == a_part) is_of_part(found) = .true.
    if (kind == a_part_set) is_of_part(model%part_sets(found)%parts) = .true.
    associate (nodes => model%mesh%element_nodes)
      is_chosen(pack(nodes, nodes > 0 .and. spread(is_of_part(model%mesh%element_part), 1, 4))) &
        = .true.
    end associate
  end subroutine choose_nodes

  !> *INITIAL_VELOCITY_RIGID_BODY, which prevails over velocities of its nodes.
  subroutine read_rigid_velocities(deck, cursor, model)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(model_t), intent(inout) :: model
    type(card_t) :: card
    integer :: body

    do while (next_row(deck, cursor, 1, card))
      if (any(card%bad)) cycle
      call find_body(deck, card, model, &
        '; *INITIAL_VELOCITY_GENERATION gives a part its velocity', body)
      if (body == 0) cycle
      if (model%rigids(body)%has_velocity) then
        call report_field(deck, card, 'PID', 'has a velocity by another card')
      else
        call warn_in_statics(deck, model, card%line)
        model%rigids(body)%has_velocity = .true.
        model%rigids(body)%velocity = [reals_of(card, 'VX', 'VY'), real_of(card, 'VZR')]
        associate (velocity => model%rigids(body)%velocity)
          if (model%is_axisymmetric .and. any(abs(velocity([1, 3])) > 0.0_wp)) call &
            report_field(deck, &
            card, trim(merge('VX ', 'VZR', abs(velocity(1)) > 0.0_wp)), across_axis)
        end associate
      end if
    end do
  end subroutine read_rigid_velocities

end module deck_velocity_m
