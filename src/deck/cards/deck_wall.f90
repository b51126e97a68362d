! SPDX-License-Identifier: MIT
!> *RIGIDWALL_PLANAR, _MOVING, and the nodes of each wall.
module deck_wall_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use rigids_m, only : mark_rigid_nodes
  use walls_m, only : wall_t, wall_distance, friction_sticks
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, check_rest, report_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node_set
  use deck_lines_m, only : deck_t, blocks_of, line_error, line_warning, where_text
  use deck_supports_m, only : mark_nodes_with_mass, mark_constrained, warn_of_nodes
  use deck_values_m, only : integer_of, real_of, reals_of, read_active_time, find_id, &
    refuse_duplicates
  implicit none
  private
  public :: read_walls

contains

  !> Read all walls. Conditions and rigid bodies have been read.
  subroutine read_walls(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    integer, allocatable :: blocks(:), lines(:)
    logical, allocatable :: has_number(:)
    integer :: i

    blocks = blocks_of(deck, 'RIGIDWALL_PLANAR')
    if (size(blocks) == 0) return
    lines = deck%blocks(blocks)%keyword
    if (model%controls%implicit%is_on) call line_error(deck, lines(1), &
      'rigid walls: the implicit method does not have them')
    allocate (model%walls(size(blocks)))
    do i = 1, size(blocks)
      call read_wall(deck, blocks(i), model, model%walls(i))
      call check_wall_nodes(deck, lines(i), model, model%walls(i))
    end do
    has_number = model%walls%id > 0
    call refuse_duplicates(deck, pack([model%walls%id], has_number), pack(lines, has_number), &
      'wall number ', 'wall')
    call number_walls(model%walls)
  end subroutine read_walls

  !> Read one wall and its nodes.
  subroutine read_wall(deck, i_block, model, wall)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(model_t), intent(in) :: model
    type(wall_t), intent(inout) :: wall
    type(cursor_t) :: cursor
    type(card_t) :: card, plane_card, mass_card
    character(:), allocatable :: title
    logical :: is_tracked(model%mesh%n_node)
    integer :: k

    call open_cursor(deck, i_block, cursor)
    if (deck%blocks(i_block)%titled) call next_heading(deck, cursor, wall%id, title)
    call next_card(deck, cursor, 1, card)
    call next_card(deck, cursor, 2, plane_card)
    if (deck%blocks(i_block)%name == 'RIGIDWALL_PLANAR_MOVING') then
      call next_card(deck, cursor, 3, mass_card)
      wall%mass = real_of(mass_card, 'MASS')
      wall%velocity = real_of(mass_card, 'V0')
    end if
    call check_rest(deck, cursor)
    call read_active_time(deck, card, ['BIRTH', 'DEATH'], wall%birth, wall%death)
    call read_plane(deck, plane_card, wall)
    wall%friction = real_of(plane_card, 'FRIC')
    if (any(.not. abs(wall%friction - [2.0_wp, 3.0_wp]) > 0.0_wp)) then
      call report_field(deck, plane_card, 'FRIC', &
        'asks for welding of nodes to the wall, which this ' &
        //'version does not have (0 none, 1 sticks, between: coefficient of friction)')
    else if (wall%friction < 0.0_wp .or. wall%friction > friction_sticks) then
      call report_field(deck, plane_card, 'FRIC', &
        'is not the friction of a wall (0 none, 1 sticks, '//'between: coefficient of friction)')
    end if
    call find_nodes(deck, card, deck%blocks(i_block)%keyword, model, is_tracked)
    is_tracked = is_tracked .and. mark_nodes_with_mass(deck, model)
    if (real_of(card, 'OFFSET') > 0.0_wp) then
      do k = 1, size(is_tracked)
        is_tracked(k) = is_tracked(k) .and. wall_distance(wall, model%mesh%coordinates(:, k), &
          [0.0_wp, 0.0_wp]) <= real_of(card, 'OFFSET')
      end do
    end if
    wall%nodes = pack([(k, k=1, model%mesh%n_node)], is_tracked)
    wall%source = where_text(deck, card%line)
  end subroutine read_wall

  !> Read tail and head: a point of the wall and its normal.
  subroutine read_plane(deck, card, wall)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(wall_t), intent(inout) :: wall
    real(wp) :: arrow(2)

    wall%point = reals_of(card, 'XT', 'YT')
    arrow = reals_of(card, 'XH', 'YH') - wall%point
    if (abs(real_of(card, 'ZH') - real_of(card, 'ZT')) > 0.0_wp) then
      call report_field(deck, card, 'ZH', &
        'is not ZT: the normal of the wall must lie in the plane of the mesh')
    else if (.not. maxval(abs(arrow)) > 0.0_wp) then
      call report_field(deck, card, 'XH', &
        'with YH gives the tail again: the normal points from tail (XT, YT) to head (XH, YH)')
    else
      arrow = arrow/maxval(abs(arrow))
      wall%normal = arrow/norm2(arrow)
    end if
  end subroutine read_plane

  !> Mark the nodes of NSID without those of NSIDEX and of rigid bodies.
  subroutine find_nodes(deck, card, line, model, is_tracked)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(in) :: line        !! of the keyword
    type(model_t), intent(in) :: model
    logical, intent(out) :: is_tracked(:)
    logical :: is_rigid(size(is_tracked))
    integer :: k

    is_tracked = integer_of(card, 'NSID') == 0
    if (integer_of(card, 'NSID') > 0) then
      call find_id(deck, a_node_set, card, 'NSID', k)
      if (k > 0) is_tracked(model%node_sets(k)%nodes) = .true.
    end if
    if (integer_of(card, 'NSIDEX') > 0) then
      call find_id(deck, a_node_set, card, 'NSIDEX', k)
      if (k > 0) is_tracked(model%node_sets(k)%nodes) = .false.
    end if
    is_rigid = is_tracked .and. mark_rigid_nodes(model%rigids, size(is_tracked))
    call warn_of_nodes(deck, line, 'wall and rigid body'//to_text(line), model, pack([(k, k=1, &
      size(is_tracked))], is_rigid), &
      'nodes of rigid bodies, which pass the wall', '')
    is_tracked = is_tracked .and. .not. is_rigid
  end subroutine find_nodes

  !> Number the walls without a number (0): position in the deck, or the next free number.
  pure subroutine number_walls(walls)
    type(wall_t), intent(inout) :: walls(:)
    logical :: is_used(2*size(walls))
    integer :: i, k

    is_used = .false.
    do i = 1, size(walls)
      if (walls(i)%id > 0 .and. walls(i)%id <= size(is_used)) is_used(walls(i)%id) = .true.
    end do
    do i = 1, size(walls)
      if (walls(i)%id > 0) cycle
      k = findloc(is_used(i:), .false., 1) + i - 1
      walls(i)%id = k
      is_used(k) = .true.
    end do
  end subroutine number_walls

  !> Warn of a wall without nodes, of nodes that start behind it, and of nodes with prescribed
  !> motion that it cannot stop: each direction of its normal is prescribed or fixed. Nodes fixed in
  !> all these directions do not approach the wall.
  subroutine check_wall_nodes(deck, line, model, wall)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    type(model_t), intent(in) :: model
    type(wall_t), intent(in) :: wall
    logical :: is_behind(size(wall%nodes))
    logical, dimension(2, model%mesh%n_node) :: is_pushed, is_moved
    real(wp) :: round_off
    integer :: i

    if (size(wall%nodes) == 0) call line_warning(deck, line, 'wall'//to_text(line), &
      'the wall has no nodes')
    associate (x => model%mesh%coordinates)
      round_off = 1.0e-12_wp*maxval(abs(x))
      is_behind = [(wall_distance(wall, x(:, wall%nodes(i)), [0.0_wp, 0.0_wp]) < -round_off, &
        i=1, size(wall%nodes))]
    end associate
    call warn_of_nodes(deck, line, 'behind the wall'//to_text(line), model, pack(wall%nodes, &
      is_behind), 'nodes that start behind the wall', &
      '; they are stopped there, not moved back')
    is_pushed = spread(abs(wall%normal) > 0.0_wp, 2, model%mesh%n_node)
    is_moved = .false.
    do i = 1, size(model%conditions%motions)
      associate (motion => model%conditions%motions(i))
        is_moved(motion%direction, motion%node) = .true.
      end associate
    end do
    is_moved(1, :) = any(is_moved .and. is_pushed, 1) .and. all(mark_constrained(model) &
      .or. .not. is_pushed, 1)
    call warn_of_nodes(deck, line, 'wall and motion'//to_text(line), model, pack(wall%nodes, &
      is_moved(1, wall%nodes)), 'nodes that pass the wall while their motion is ' &
      //'prescribed (*BOUNDARY_PRESCRIBED_MOTION)', '')
  end subroutine check_wall_nodes

end module deck_wall_m
