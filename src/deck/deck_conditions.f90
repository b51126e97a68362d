! SPDX-License-Identifier: MIT
!> *BOUNDARY_, *INITIAL_, *LOAD_ and *DAMPING_ cards: each becomes a row to be resolved later.
module deck_conditions_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, line_error
  use deck_fields_m, only : card_t
  use deck_parameter_table_m, only : parameters_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, next_row, check_rest, &
    report_field
  use deck_raw_m, only : raw_t, row_t, reserve_rows, append_row, reserve_velocities, &
    append_velocity, row_spc_node, row_spc_set, row_motion_node, row_motion_set, row_velocity, &
    row_velocity_node, row_velocity_generation, row_load_node, row_load_set, row_pressure, &
    row_pressure_set, row_body, row_damping, row_motion_rigid, row_velocity_rigid
  implicit none
  private
  public :: read_condition, read_initial_velocity

contains

  !> A keyword whose cards stand for themselves, one line each.
  subroutine read_condition(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(row_t) :: row
    logical :: found
    integer :: n_row

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    row%kind = row_kind(trim(deck%blocks(i_block)%name))
    row%direction = merge(2, 1, deck%blocks(i_block)%name == 'LOAD_BODY_Y')
    n_row = deck%blocks(i_block)%last - deck%blocks(i_block)%first + 1
    if (row%kind == row_velocity_node) then
      call reserve_velocities(raw, n_row)
    else
      call reserve_rows(raw, n_row)
    end if
    n_row = 0
    do
      call next_row(deck, parameters, cursor, 1, card, found)
      if (.not. found) exit
      n_row = n_row + 1
      call check_row(deck, cursor, card, row%kind)
      call keep_row(raw, card, row)
      if (row%kind == row_body .or. row%kind == row_damping) exit
    end do
    if (n_row == 0) call line_error(deck, deck%blocks(i_block)%keyword, 'its card is missing')
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
    case default
      kind = row_damping
    end select
  end function row_kind

  !> Keep a card, unless a field that matters is bad.
  subroutine keep_row(raw, card, row)
    type(raw_t), intent(inout) :: raw
    type(card_t), intent(in) :: card
    type(row_t), intent(inout) :: row

    if (any(card%bad)) return
    if (row%kind == row_velocity_node) then
      call append_velocity(raw, card%line, card%i(1), card%r(2:3))
      return
    end if
    row%line = card%line
    row%i = card%i(1:8)
    row%r = card%r(1:8)
    call append_row(raw, row)
  end subroutine keep_row

  !> Fields of one row.
  subroutine check_row(deck, cursor, card, kind)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: kind
    integer :: k

    if (kind /= row_damping .and. card%i(1) < 1) call report_field(deck, cursor, card, 1, &
      'is not a number of 1 or more')
    select case (kind)
    case (row_spc_node, row_spc_set)
      call check_flag(deck, cursor, card, 3)
      call check_flag(deck, cursor, card, 4)
    case (row_motion_node, row_motion_set)
      call check_direction(deck, cursor, card, 2)
      call check_motion(deck, cursor, card)
    case (row_motion_rigid)
      if (all(card%i(2) /= [1, 2, 7])) call report_field(deck, cursor, card, 2, &
        'is not a motion that a rigid body has here (1 x, 2 y, 7 turn about z)')
      call check_motion(deck, cursor, card)
    case (row_load_node, row_load_set)
      call check_direction(deck, cursor, card, 2)
      call check_curve(deck, cursor, card, 3)
    case (row_pressure)
      call check_edge_nodes(deck, cursor, card)
      if (card%r(3) < 0.0_wp) call report_field(deck, cursor, card, 3, 'is negative')
    case (row_pressure_set)
      call check_curve(deck, cursor, card, 2)
      if (card%r(4) < 0.0_wp) call report_field(deck, cursor, card, 4, 'is negative')
    case (row_damping)
      if (card%i(1) < 0) call report_field(deck, cursor, card, 1, 'is not a curve number')
      do k = 2, 4
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
  subroutine check_motion(deck, cursor, card)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card

    if (card%i(3) < 0 .or. card%i(3) > 2) call report_field(deck, cursor, card, 3, &
      'is not a kind of motion that this version has (0 velocity, 1 acceleration, 2 displacement)')
    call check_curve(deck, cursor, card, 4)
    if (.not. abs(card%r(7)) > 0.0_wp) card%r(7) = 1.0e28_wp
    if (card%r(7) <= card%r(8)) call report_field(deck, cursor, card, 7, &
      'is not after BIRTH "'//to_text(card%r(8))//'"')
    if (card%r(7) <= 0.0_wp) call report_field(deck, cursor, card, 7, &
      'is before the run begins (0 means never)')
  end subroutine check_motion

  !> N1 to N4 of *LOAD_SEGMENT.
  subroutine check_edge_nodes(deck, cursor, card)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer :: k

    do k = 4, 5
      if (card%i(k) < 1) call report_field(deck, cursor, card, k, &
        'is not a node number (1 or more)')
    end do
    if (card%i(4) == card%i(5)) call report_field(deck, cursor, card, 5, &
      'is the first node again; an edge has two nodes')
    do k = 6, 7
      if (card%i(k) /= 0 .and. card%i(k) /= card%i(4) .and. card%i(k) /= card%i(5)) &
        call report_field(deck, cursor, card, k, &
        'is a further node; an edge in the plane has two (repeat N2 or leave it 0)')
    end do
  end subroutine check_edge_nodes

  !> *INITIAL_VELOCITY (two or three cards) and *INITIAL_VELOCITY_GENERATION (two cards).
  !> Integers of the row: those of card 1. Reals: of _GENERATION OMEGA, VX, VY, XC, YC; of the other
  !> VX, VY and, for the nodes left out, VXE, VYE.
  subroutine read_initial_velocity(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: cards(3)
    type(row_t) :: row
    integer :: k

    call open_cursor(deck, i_block, cursor)
    do k = 1, cursor%n_card
      if (k == 3 .and. cards(1)%i(2) == 0) exit
      call next_card(deck, parameters, cursor, k, cards(k))
    end do
    row%line = cards(1)%line
    row%i = cards(1)%i(1:8)
    if (deck%blocks(i_block)%name == 'INITIAL_VELOCITY') then
      row%kind = row_velocity
      do k = 1, 2
        if (cards(1)%i(k) < 0) call report_field(deck, cursor, cards(1), k, 'is not a set number')
      end do
      row%r(1:2) = cards(2)%r(1:2)
      row%r(3:4) = cards(3)%r(1:2)
    else
      row%kind = row_velocity_generation
      call check_generation(deck, cursor, cards)
      row%r(1:3) = cards(1)%r(3:5)
      if (cards(2)%r(6) < 0.0_wp) row%r(1) = -row%r(1)
      row%r(4:5) = cards(2)%r(1:2)
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
    integer :: k

    if (cards(1)%i(1) < 0) call report_field(deck, cursor, cards(1), 1, &
      'is not a number of 0 or more')
    if (cards(1)%i(2) < 1 .or. cards(1)%i(2) > 3) call report_field(deck, cursor, cards(1), 2, &
      'is not a kind of set (1 part set, 2 part, 3 node set)')
    if (abs(cards(1)%r(3)) > 1.0e30_wp) call report_field(deck, cursor, cards(1), 3, 'is too large')
    if (.not. abs(cards(1)%r(3)) > 0.0_wp) return
    do k = 4, 5
      if (abs(cards(2)%r(k)) > 0.0_wp) call report_field(deck, cursor, cards(2), k, &
        'turns the axis out of z; in the plane bodies spin about z')
    end do
  end subroutine check_generation

end module deck_conditions_m
