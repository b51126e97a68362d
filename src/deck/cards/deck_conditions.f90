! SPDX-License-Identifier: MIT
!> *BOUNDARY_, *INITIAL_, *LOAD_ and *DAMPING_ cards: each becomes a row to be resolved later.
module deck_conditions_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, next_row, check_rest, &
    report_field, find_field
  use deck_values_m, only : integer_of, real_of, reals_of, refuse_outside
  use deck_raw_m, only : raw_t, row_t, reserve_rows, append_row, reserve_velocities, &
    append_velocity, row_spc_node, row_spc_set, row_motion_node, row_motion_set, row_velocity, &
    row_velocity_node, row_velocity_generation, row_load_node, row_load_set, row_pressure, &
    row_pressure_set, row_body, row_damping, row_motion_rigid, row_velocity_rigid, row_stiffness, &
    row_stiffness_set, row_load_rigid, row_mass, row_mass_set, row_common, id_fields
  implicit none
  private
  public :: read_condition, read_initial_velocity

  !> What to say of a negative set.
  character(*), parameter :: no_set = 'is not a set number'

  !> Positions of the fields of `row_t` on the card of a keyword; 0 where it has none.
  type :: columns_t
    integer :: id = 0, direction = 0, motion = 0, curve = 0, scale = 0, birth = 0, death = 0, &
      arrival = 0, system = 0
    integer :: fixed(2) = 0, velocity(3) = 0
    integer :: nodes(2) = 0      !! first and last of N1 to N4
    integer :: factors(2) = 0    !! first and last of STX to SRZ
  end type columns_t

contains

  !> A keyword whose cards stand for themselves, one line each.
  subroutine read_condition(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(row_t) :: row
    type(columns_t) :: at
    logical :: found
    integer :: n_row

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    row%kind = row_kind(trim(deck%blocks(i_block)%name))
    if (row%kind == row_body) row%direction = merge(2, 1, &
      deck%blocks(i_block)%name == 'LOAD_BODY_Y')
    call find_columns(cursor, row%kind, at)
    n_row = deck%blocks(i_block)%last - deck%blocks(i_block)%first + 1
    if (row%kind == row_velocity_node) then
      call reserve_velocities(raw, n_row)
    else
      call reserve_rows(raw, n_row)
    end if
    do
      call next_row(deck, cursor, 1, card, found)
      if (.not. found) exit
      call fill_row(card, at, row)
      call check_row(deck, cursor, at, card, row)
      if (.not. any(card%bad)) then
        if (row%kind == row_velocity_node) then
          call append_velocity(raw, row%line, row%id, row%velocity(:2))
        else
          call append_row(raw, row)
        end if
      end if
      if (row%kind == row_body .or. row%kind == row_damping) exit
    end do
    call check_rest(deck, cursor)
  end subroutine read_condition

  !> The kind of row of a keyword.
  pure function row_kind(name) result(kind)
    character(*), intent(in) :: name
    integer :: kind

    select case (name)
    case ('BOUNDARY_SPC_NODE')
      kind = row_spc_node
    case ('BOUNDARY_SPC_SET')
      kind = row_spc_set
    case ('BOUNDARY_PRESCRIBED_MOTION_NODE')
      kind = row_motion_node
    case ('BOUNDARY_PRESCRIBED_MOTION_SET')
      kind = row_motion_set
    case ('BOUNDARY_PRESCRIBED_MOTION_RIGID')
      kind = row_motion_rigid
    case ('INITIAL_VELOCITY_NODE')
      kind = row_velocity_node
    case ('INITIAL_VELOCITY_RIGID_BODY')
      kind = row_velocity_rigid
    case ('LOAD_NODE_POINT')
      kind = row_load_node
    case ('LOAD_NODE_SET')
      kind = row_load_set
    case ('LOAD_SEGMENT')
      kind = row_pressure
    case ('LOAD_SEGMENT_SET')
      kind = row_pressure_set
    case ('LOAD_BODY_X', 'LOAD_BODY_Y')
      kind = row_body
    case ('LOAD_RIGID_BODY')
      kind = row_load_rigid
    case ('DAMPING_PART_STIFFNESS')
      kind = row_stiffness
    case ('DAMPING_PART_STIFFNESS_SET')
      kind = row_stiffness_set
    case ('ELEMENT_MASS')
      kind = row_mass
    case ('ELEMENT_MASS_NODE_SET')
      kind = row_mass_set
    case ('CONSTRAINED_NODE_SET')
      kind = row_common
    case default
      kind = row_damping
    end select
  end function row_kind

  !> Positions of the fields that a kind of row has: looked up once, since rows may be many.
  subroutine find_columns(cursor, kind, at)
    type(cursor_t), intent(in) :: cursor
    integer, intent(in) :: kind
    type(columns_t), intent(out) :: at

    at%id = find_field(cursor, 1, trim(id_fields(kind)))
    select case (kind)
    case (row_spc_node, row_spc_set)
      at%fixed = [find_field(cursor, 1, 'DOFX'), find_field(cursor, 1, 'DOFY')]
      at%system = find_field(cursor, 1, 'CID')
    case (row_stiffness, row_stiffness_set)
      at%scale = find_field(cursor, 1, 'COEF')
    case (row_mass, row_mass_set)
      at%scale = find_field(cursor, 1, 'MASS')
    case (row_common)
      at%direction = find_field(cursor, 1, 'DOF')
    case (row_velocity_node)
      at%velocity = [find_field(cursor, 1, 'VX'), find_field(cursor, 1, 'VY'), 0]
    case (row_velocity_rigid)
      at%velocity = [find_field(cursor, 1, 'VX'), find_field(cursor, 1, 'VY'), &
        find_field(cursor, 1, 'VZR')]
    case (row_damping)
      at%curve = find_field(cursor, 1, 'LCID')
      at%scale = find_field(cursor, 1, 'VALDMP')
      at%factors = [find_field(cursor, 1, 'STX'), find_field(cursor, 1, 'SRZ')]
    case default
      at%curve = find_field(cursor, 1, 'LCID')
      at%scale = find_field(cursor, 1, 'SF')
    end select
    select case (kind)
    case (row_motion_node, row_motion_set, row_motion_rigid)
      at%direction = find_field(cursor, 1, 'DOF')
      at%motion = find_field(cursor, 1, 'VAD')
      at%birth = find_field(cursor, 1, 'BIRTH')
      at%death = find_field(cursor, 1, 'DEATH')
    case (row_load_node, row_load_set, row_load_rigid)
      at%direction = find_field(cursor, 1, 'DOF')
      at%system = find_field(cursor, 1, 'CID')
    case (row_pressure, row_pressure_set)
      at%arrival = find_field(cursor, 1, 'AT')
      if (kind == row_pressure) at%nodes = [find_field(cursor, 1, 'N1'), &
        find_field(cursor, 1, 'N4')]
    end select
  end subroutine find_columns

  !> The values of a row.
  subroutine fill_row(card, at, row)
    type(card_t), intent(in) :: card
    type(columns_t), intent(in) :: at
    type(row_t), intent(inout) :: row

    row%line = card%line
    row%id = card%i(at%id)
    if (at%fixed(1) > 0) row%fixed = card%i(at%fixed) == 1
    if (at%velocity(1) > 0) row%velocity(:2) = card%r(at%velocity(:2))
    if (at%velocity(3) > 0) row%velocity(3) = card%r(at%velocity(3))
    if (at%curve > 0) row%curve = card%i(at%curve)
    if (at%scale > 0) row%scale = card%r(at%scale)
    if (at%direction > 0) row%direction = card%i(at%direction)
    if (at%system > 0) row%system = card%i(at%system)
    if (at%arrival > 0) row%arrival = card%r(at%arrival)
    if (at%nodes(1) > 0) row%nodes = card%i(at%nodes(1):at%nodes(1) + 1)
    if (at%motion > 0) then
      row%motion = card%i(at%motion)
      row%birth = card%r(at%birth)
      row%death = card%r(at%death)
    end if
    if (at%factors(1) > 0) then
      ! All six factors zero mean one everywhere.
      if (any(abs(card%r(at%factors(1):at%factors(2))) > 0.0_wp)) row%factor = &
        card%r(at%factors(1):at%factors(1) + 1)
    end if
  end subroutine fill_row

  !> Fields of one row.
  subroutine check_row(deck, cursor, at, card, row)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(columns_t), intent(in) :: at
    type(card_t), intent(inout) :: card
    type(row_t), intent(in) :: row
    integer :: k

    if (row%kind /= row_damping .and. row%id < 1) call report_field(deck, cursor, card, at%id, &
      'is not a number of 1 or more')
    select case (row%kind)
    case (row_spc_node, row_spc_set)
      call check_flag(deck, cursor, card, at%fixed(1))
      call check_flag(deck, cursor, card, at%fixed(2))
    case (row_motion_node, row_motion_set)
      call check_direction(deck, cursor, card, at%direction)
      call check_motion(deck, cursor, at, card, row)
    case (row_motion_rigid)
      if (all(row%direction /= [1, 2, 7])) call report_field(deck, cursor, card, at%direction, &
        'is not a motion that a rigid body has here (1 x, 2 y, 7 turn about z)')
      call check_motion(deck, cursor, at, card, row)
    case (row_load_node, row_load_set)
      call check_direction(deck, cursor, card, at%direction)
      call check_curve(deck, cursor, card, at%curve)
    case (row_load_rigid)
      if (all(row%direction /= [1, 2, 7])) call report_field(deck, cursor, card, at%direction, &
        'is not a load on a rigid body that this version has (1 x, 2 y, 7 moment about z)')
      call check_curve(deck, cursor, card, at%curve)
    case (row_mass, row_mass_set)
      if (row%scale < 0.0_wp) call report_field(deck, cursor, card, at%scale, &
        'is negative: a mass is 0 or more')
    case (row_stiffness, row_stiffness_set)
      if (row%scale > 1.0_wp) call report_field(deck, cursor, card, at%scale, &
        'is not a share of critical damping (at most 1; below 0 it is a time)')
    case (row_common)
      if (row%direction < 1 .or. row%direction > 7) call report_field(deck, cursor, card, &
        at%direction, 'is not a code of directions (1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7 xyz)')
    case (row_pressure)
      call check_edge_nodes(deck, cursor, card, at%nodes(1))
      call check_arrival(deck, cursor, card, at%arrival)
    case (row_pressure_set)
      call check_curve(deck, cursor, card, at%curve)
      call check_arrival(deck, cursor, card, at%arrival)
    case (row_damping)
      if (row%curve < 0) call report_field(deck, cursor, card, at%curve, 'is not a curve number')
      do k = at%scale, at%factors(1) + 1
        if (card%r(k) < 0.0_wp) call report_field(deck, cursor, card, k, &
          'is negative: forces that push along with the velocity would feed energy')
      end do
    end select
  end subroutine check_row

  !> A field that is 0 or 1.
  subroutine check_flag(deck, cursor, card, k)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k

    if (card%i(k) /= 0 .and. card%i(k) /= 1) call report_field(deck, cursor, card, k, &
      'is not 0 (free) or 1 (fixed)')
  end subroutine check_flag

  !> A degree of freedom.
  subroutine check_direction(deck, cursor, card, k)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k

    if (card%i(k) /= 1 .and. card%i(k) /= 2) call report_field(deck, cursor, card, k, &
      'is not a direction that this version has (1 x, 2 y)')
  end subroutine check_direction

  !> A time of arrival.
  subroutine check_arrival(deck, cursor, card, k)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k

    if (card%r(k) < 0.0_wp) call report_field(deck, cursor, card, k, 'is negative')
  end subroutine check_arrival

  !> A curve that must be there.
  subroutine check_curve(deck, cursor, card, k)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k

    if (card%i(k) < 1) call report_field(deck, cursor, card, k, &
      'is not a curve number (1 or more)')
  end subroutine check_curve

  !> *BOUNDARY_PRESCRIBED_MOTION_ but its direction.
  subroutine check_motion(deck, cursor, at, card, row)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(columns_t), intent(in) :: at
    type(card_t), intent(inout) :: card
    type(row_t), intent(in) :: row

    if (row%motion < 0 .or. row%motion > 2) call report_field(deck, cursor, card, at%motion, &
      'is not a kind of motion that this version has (0 velocity, 1 acceleration, 2 displacement)')
    call check_curve(deck, cursor, card, at%curve)
    if (row%death <= row%birth) call report_field(deck, cursor, card, at%death, &
      'is not after BIRTH "'//to_text(row%birth)//'"')
    if (row%death <= 0.0_wp) call report_field(deck, cursor, card, at%death, &
      'is before the run begins (0 means never)')
  end subroutine check_motion

  !> N1 to N4 of *LOAD_SEGMENT.
  subroutine check_edge_nodes(deck, cursor, card, first)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: first     !! field of N1
    integer :: k

    do k = first, first + 1
      if (card%i(k) < 1) call report_field(deck, cursor, card, k, &
        'is not a node number (1 or more)')
    end do
    if (card%i(first) == card%i(first + 1)) call report_field(deck, cursor, card, first + 1, &
      'is the first node again; an edge has two nodes')
    do k = first + 2, first + 3
      if (all(card%i(k) /= [0, card%i(first:first + 1)])) call report_field(deck, cursor, card, k, &
        'is a further node; an edge in the plane has two (repeat N2 or leave it 0)')
    end do
  end subroutine check_edge_nodes

  !> *INITIAL_VELOCITY (two or three cards) and *INITIAL_VELOCITY_GENERATION (two cards).
  subroutine read_initial_velocity(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: cards(3)
    type(row_t) :: row

    call open_cursor(deck, i_block, cursor)
    call next_card(deck, cursor, 1, cards(1))
    call next_card(deck, cursor, 2, cards(2))
    row%line = cards(1)%line
    if (deck%blocks(i_block)%name == 'INITIAL_VELOCITY') then
      row%kind = row_velocity
      row%id = integer_of(cards(1), 'NSID')
      row%others = integer_of(cards(1), 'NSIDEX')
      row%velocity(:2) = reals_of(cards(2), 'VX', 'VY')
      if (row%others /= 0) then
        call next_card(deck, cursor, 3, cards(3))
        row%other_velocity = reals_of(cards(3), 'VXE', 'VYE')
      end if
      if (row%id < 0) call report_field(deck, cursor, cards(1), 'NSID', no_set)
      if (row%others < 0) call report_field(deck, cursor, cards(1), 'NSIDEX', no_set)
    else
      row%kind = row_velocity_generation
      call check_generation(deck, cursor, cards)
      row%id = integer_of(cards(1), 'ID')
      row%set_kind = integer_of(cards(1), 'STYP')
      row%velocity(:2) = reals_of(cards(1), 'VX', 'VY')
      row%spin = real_of(cards(1), 'OMEGA')
      if (real_of(cards(2), 'NZ') < 0.0_wp) row%spin = -row%spin
      row%centre = reals_of(cards(2), 'XC', 'YC')
    end if
    call check_rest(deck, cursor)
    if (any(cards(1)%bad) .or. any(cards(2)%bad)) return
    call append_row(raw, row)
  end subroutine read_initial_velocity

  !> Fields of *INITIAL_VELOCITY_GENERATION.
  subroutine check_generation(deck, cursor, cards)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    character(*), parameter :: turned = &
      'turns the axis out of z; in the plane bodies spin about z'

    if (integer_of(cards(1), 'ID') < 0) call report_field(deck, cursor, cards(1), 'ID', &
      'is not a number of 0 or more')
    call refuse_outside(deck, cursor, cards(1), 'STYP', 1, 3, &
      'is not a kind of set (1 part set, 2 part, 3 node set)')
    if (abs(real_of(cards(1), 'OMEGA')) > 1.0e30_wp) call report_field(deck, cursor, cards(1), &
      'OMEGA', 'is too large')
    if (.not. abs(real_of(cards(1), 'OMEGA')) > 0.0_wp) return
    if (abs(real_of(cards(2), 'NX')) > 0.0_wp) call report_field(deck, cursor, cards(2), 'NX', &
      turned)
    if (abs(real_of(cards(2), 'NY')) > 0.0_wp) call report_field(deck, cursor, cards(2), 'NY', &
      turned)
  end subroutine check_generation

end module deck_conditions_m
