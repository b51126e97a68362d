! SPDX-License-Identifier: MIT
!> *NODE, *ELEMENT_SHELL and *SET_ cards.
module deck_mesh_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use deck_ids_m, only : a_node, a_node_set, a_part_set, a_segment_set, a_shell_set, an_element
  use deck_maps_m, only : lose
  use deck_lines_m, only : deck_t, line_warning
  use deck_fields_m, only : card_t, field_text
  use deck_cards_m, only : cursor_t, open_cursor, next_text, next_card, next_row, report_field, &
    find_field
  use deck_values_m, only : integer_of, is_bad
  use deck_raw_m, only : raw_t, reserve_nodes, reserve_elements
  use deck_raw_sets_m, only : raw_set_t, append_set, append_member, add_all, add_nodes, add_parts, &
    of_part, of_part_set
  use text_m, only : upper_case
  implicit none
  private
  public :: read_nodes, read_elements, read_beams, read_set, read_history_ids

contains

  !> *NODE: id, coordinates and boundary code.
  subroutine read_nodes(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: found
    integer :: n, id, x, y, z, code

    call open_cursor(deck, i_block, cursor)
    id = find_field(cursor, 1, 'NID')
    x = find_field(cursor, 1, 'X')
    y = find_field(cursor, 1, 'Y')
    z = find_field(cursor, 1, 'Z')
    code = find_field(cursor, 1, 'TC')
    call reserve_nodes(raw, max(cursor%last - cursor%line + 1, 0))
    do
      call next_row(deck, cursor, 1, card, found)
      if (.not. found) exit
      if (card%i(id) < 1) call report_field(deck, cursor, card, id, &
        'is not a node number (1 or more)')
      if (card%i(code) < 0 .or. card%i(code) > 7) call report_field(deck, cursor, card, code, &
        'is not a boundary code (0 none, 1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7 xyz)')
      if (card%bad(id)) call lose(deck, [a_node])
      if (card%bad(id)) cycle
      n = raw%n_node + 1
      raw%n_node = n
      raw%node_id(n) = card%i(id)
      raw%node_line(n) = card%line
      raw%node_code(n) = card%i(code)
      raw%coordinates(1, n) = card%r(x)
      raw%coordinates(2, n) = card%r(y)
      if (n == 1) raw%z_first = card%r(z)
      if (raw%z_line == 0 .and. abs(card%r(z) - raw%z_first) > 0.0_wp) raw%z_line = card%line
    end do
  end subroutine read_nodes

  !> *ELEMENT_SHELL: id, part and corner nodes; N4 = 0 or N3 makes a triangle.
  subroutine read_elements(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: found
    integer :: n, k, id, part, first, last

    call open_cursor(deck, i_block, cursor)
    id = find_field(cursor, 1, 'EID')
    part = find_field(cursor, 1, 'PID')
    first = find_field(cursor, 1, 'N1')
    last = find_field(cursor, 1, 'N4')
    call reserve_elements(raw, max(cursor%last - cursor%line + 1, 0))
    do
      call next_row(deck, cursor, 1, card, found)
      if (.not. found) exit
      if (card%i(id) < 1) call report_field(deck, cursor, card, id, &
        'is not an element number (1 or more)')
      if (card%i(part) < 1) call report_field(deck, cursor, card, part, &
        'is not a part number (1 or more)')
      do k = first, last - 1
        if (card%i(k) < 1) call report_field(deck, cursor, card, k, &
          'is not a node number (1 or more)')
      end do
      if (card%i(last) < 0) call report_field(deck, cursor, card, last, &
        'is not a node number (1 or more)')
      if (any(card%bad)) call lose(deck, [an_element])
      if (any(card%bad)) cycle
      if (card%i(last) == 0) card%i(last) = card%i(last - 1)
      n = raw%n_element + 1
      raw%n_element = n
      raw%element_id(n) = card%i(id)
      raw%element_part(n) = card%i(part)
      raw%element_nodes(:, n) = card%i(first:first + 3)
      raw%element_line(n) = card%line
    end do
  end subroutine read_elements

  !> *ELEMENT_BEAM, as mesh generators write the edges of a plane mesh: no elements here, but the
  !> segment set and the node set of the number of their part.
  subroutine read_beams(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: found
    integer :: part, first, k

    call open_cursor(deck, i_block, cursor)
    part = find_field(cursor, 1, 'PID')
    first = find_field(cursor, 1, 'N1')
    do
      call next_row(deck, cursor, 1, card, found)
      if (.not. found) exit
      if (card%i(part) < 1) call report_field(deck, cursor, card, part, &
        'is not a part number (1 or more)')
      do k = first, first + 1
        if (card%i(k) < 1) call report_field(deck, cursor, card, k, &
          'is not a node number (1 or more)')
      end do
      if (card%bad(part) .or. any(card%bad(first:first + 1))) then
        call lose(deck, [a_node_set, a_part_set, a_segment_set, a_shell_set])
        cycle
      end if
      call line_warning(deck, card%line, 'beams', 'beams are no elements of a plane mesh: the ' &
        //'edges of each of their parts are the segment set, and the node set, of its number')
      do k = first, first + 1
        call append_to_beam_set(raw%segment_sets, raw%n_segment_set, .false., card%i(part), &
          card%i(k), card%line, k)
        call append_to_beam_set(raw%node_sets, raw%n_node_set, .true., card%i(part), card%i(k), &
          card%line, k)
      end do
    end do
  end subroutine read_beams

  !> One more node of the set that the beams of a part make; the last made is mostly the one.
  subroutine append_to_beam_set(sets, n, once, id, node, line, field)
    type(raw_set_t), allocatable, intent(inout) :: sets(:)
    integer, intent(inout) :: n
    logical, intent(in) :: once      !! a node that is there already is not taken again
    integer, intent(in) :: id, node, line, field
    type(raw_set_t) :: set
    integer :: i

    do i = n, 1, -1
      if (sets(i)%of_beams .and. sets(i)%id == id) exit
    end do
    if (i == 0) then
      set%id = id
      set%line = line
      set%of_beams = .true.
      call append_set(sets, n, set)
      i = n
    end if
    if (once .and. sets(i)%n > 0) then
      if (any(sets(i)%members(:sets(i)%n) == node)) return
    end if
    call append_member(sets(i), node, line, field)
  end subroutine append_to_beam_set

  !> A set of nodes, parts, elements or segments: its number, then its members.
  subroutine read_set(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: head, card
    type(raw_set_t) :: set
    integer :: first
    logical :: found

    call open_cursor(deck, i_block, cursor)
    if (deck%blocks(i_block)%titled) call next_text(deck, cursor, set%title)
    call next_card(deck, cursor, 1, head)
    set%id = integer_of(head, 'SID')
    if (set%id < 1) call report_field(deck, cursor, head, 'SID', 'is not a set number (1 or more)')
    set%line = head%line
    set%generate = index(deck%blocks(i_block)%name, '_GENERATE') > 0
    do
      call next_row(deck, cursor, 2, card, found)
      if (.not. found) exit
      select case (deck%blocks(i_block)%name)
      case ('SET_SEGMENT')
        ! N3 and N4 may repeat N2 or be zero.
        first = find_field(cursor, 2, 'N1')
        call check_edge(deck, cursor, card, first)
        if (.not. any(card%bad(first:first + 3))) then
          call append_member(set, card%i(first), card%line, first)
          call append_member(set, card%i(first + 1), card%line, first + 1)
        end if
      case ('SET_NODE_GENERAL')
        call take_action(deck, cursor, card, set)
      case default
        call take_members(deck, cursor, card, set)
      end select
      set%damaged = set%damaged .or. any(card%bad)
    end do
    if (is_bad(head, 'SID')) call lose(deck, [a_node_set, a_part_set, a_segment_set, a_shell_set])
    if (is_bad(head, 'SID')) return
    select case (deck%blocks(i_block)%name)
    case ('SET_SEGMENT', 'SET_2D_SEGMENT', 'SET_2D_SEGMENT_SET')
      if (deck%blocks(i_block)%name == 'SET_2D_SEGMENT') set%boundary = of_part
      if (deck%blocks(i_block)%name == 'SET_2D_SEGMENT_SET') set%boundary = of_part_set
      call append_set(raw%segment_sets, raw%n_segment_set, set)
    case ('SET_PART_LIST', 'SET_PART_LIST_GENERATE')
      call append_set(raw%part_sets, raw%n_part_set, set)
    case ('SET_SHELL_LIST', 'SET_SHELL_LIST_GENERATE')
      call append_set(raw%shell_sets, raw%n_shell_set, set)
    case default
      call append_set(raw%node_sets, raw%n_node_set, set)
    end select
  end subroutine read_set

  !> The ids of a line, one in each of its fields; zeros are padding. Generated sets take them in
  !> pairs.
  subroutine take_members(deck, cursor, card, set)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_set_t), intent(inout) :: set
    integer :: k, n

    n = cursor%specs(card%number)%n
    do k = 1, n
      if (card%i(k) < 0) call report_field(deck, cursor, card, k, 'is not a number of 1 or more')
    end do
    if (set%generate) then
      do k = 1, n - 1, 2
        if (card%i(k) == 0 .and. card%i(k + 1) == 0) cycle
        if (card%i(k) == 0 .or. card%i(k + 1) < card%i(k)) call report_field(deck, cursor, card, &
          k + 1, 'is not the end of a block that begins with "'//to_text(card%i(k))//'"')
        if (card%bad(k) .or. card%bad(k + 1)) cycle
        call append_member(set, card%i(k), card%line, k)
        call append_member(set, card%i(k + 1), card%line, k + 1)
      end do
      return
    end if
    do k = 1, n
      if (card%i(k) > 0) call append_member(set, card%i(k), card%line, k)
    end do
  end subroutine take_members

  !> A row of a general set: what it does, and with which nodes or parts.
  subroutine take_action(deck, cursor, card, set)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_set_t), intent(inout) :: set
    integer :: action, k, n

    n = cursor%specs(card%number)%n
    select case (upper_case(field_text(deck, card, 1)))
    case ('ALL')
      call append_member(set, 0, card%line, 1, add_all)
      return
    case ('NODE')
      action = add_nodes
    case ('DNODE')
      action = -add_nodes
    case ('PART')
      action = add_parts
    case ('DPART')
      action = -add_parts
    case default
      call report_field(deck, cursor, card, 'OPTION', 'is not ALL, NODE, DNODE, PART or DPART ' &
        //'(boxes are not available in slideline)')
      return
    end select
    if (all(card%i(2:n) == 0)) call report_field(deck, cursor, card, 'E1', &
      'is not a number of 1 or more')
    do k = 2, n
      if (card%i(k) < 0) call report_field(deck, cursor, card, k, 'is not a number of 1 or more')
      if (card%i(k) > 0) call append_member(set, card%i(k), card%line, k, action)
    end do
  end subroutine take_action

  !> Four node fields from `k` on must describe an edge.
  subroutine check_edge(deck, cursor, card, k)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    integer :: j

    do j = k, k + 1
      if (card%i(j) < 1) call report_field(deck, cursor, card, j, &
        'is not a node number (1 or more)')
    end do
    if (card%i(k) == card%i(k + 1)) call report_field(deck, cursor, card, k + 1, &
      'is the first node again; an edge has two nodes')
    do j = k + 2, k + 3
      if (any(card%bad)) exit
      if (card%i(j) /= 0 .and. card%i(j) /= card%i(k + 1) .and. card%i(j) /= card%i(k)) &
        call report_field(deck, cursor, card, j, &
        'is a further node; an edge in the plane has two (repeat N2 or leave it 0)')
    end do
  end subroutine check_edge

  !> *DATABASE_HISTORY_NODE, _NODE_ID, _NODE_SET, _SHELL and _SHELL_SET.
  subroutine read_history_ids(deck, i_block, set)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_set_t), intent(inout) :: set
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: found

    call open_cursor(deck, i_block, cursor)
    do
      call next_row(deck, cursor, 1, card, found)
      if (.not. found) exit
      call take_members(deck, cursor, card, set)
    end do
  end subroutine read_history_ids

end module deck_mesh_m
