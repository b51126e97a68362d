! SPDX-License-Identifier: MIT
!> Rows of *SET_SEGMENT_GENERAL, which add edges of the mesh to a set or remove them.
module deck_segments_m
  use text_m, only : upper_case
  use boundary_m, only : boundary_t, find_boundary
  use model_m, only : model_t
  use deck_boxes_m, only : mark_box
  use deck_cards_m, only : report_field
  use deck_fields_m, only : card_t, field_text
  use deck_ids_m, only : a_node, a_part, a_box
  use deck_lines_m, only : deck_t
  use deck_values_m, only : find_id
  implicit none
  private
  public :: change_edges

contains

  !> Read one row. PART: exterior edges of the parts of the row together; BOX: exterior edges of the
  !> mesh with both nodes in a box. The options with D remove the edges with both nodes in it.
  subroutine change_edges(deck, card, model, edges)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    integer, allocatable, intent(inout) :: edges(:, :) !! (2, n) nodes of the edges of the set
    type(boundary_t) :: boundary
    logical :: is_of_part(0:size(model%parts)), is_inside(model%mesh%n_node)
    logical, allocatable :: is_chosen(:)
    character(:), allocatable :: action
    integer :: ends(2)

    action = upper_case(field_text(deck, card, 1))
    if (all(action /= ['ALL  ', 'SEG  ', 'DSEG ', 'PART ', 'DPART', 'BOX  ', 'DBOX '])) then
      call report_field(deck, card, 'OPTION', 'is not ALL, SEG, DSEG, PART, DPART, BOX or DBOX')
      return
    end if
    is_of_part = action == 'ALL'
    is_inside = index(action, 'BOX') == 0
    if (action /= 'ALL') call read_entities(deck, card, action, model, ends, is_of_part, is_inside)
    ! Errors of the mesh have been reported.
    if (any(card%bad) .or. any(model%mesh%element_nodes < 1)) return
    select case (action)
    case ('SEG')
      call add_edges(reshape(ends, [2, 1]), edges)
    case ('DSEG')
      call keep_edges(.not. is_same(edges(1, :), edges(2, :), ends(1), ends(2)), edges)
    case ('DPART', 'DBOX')
      associate (nodes => model%mesh%element_nodes)
        if (action == 'DPART') then
          is_inside = .false.
          is_inside(pack(nodes, spread(is_of_part(model%mesh%element_part), 1, 4))) = .true.
        end if
      end associate
      call keep_edges(.not. (is_inside(edges(1, :)) .and. is_inside(edges(2, :))), edges)
    case default
      is_chosen = is_of_part(model%mesh%element_part) .or. action == 'BOX'
      call find_boundary(model%mesh%element_nodes, is_chosen, is_inside, boundary, &
        model%mesh%hanging)
      call add_edges(boundary%nodes, edges)
    end select
  end subroutine change_edges

  !> Read the nodes of an edge, the parts or the boxes of a row.
  subroutine read_entities(deck, card, action, model, ends, is_of_part, is_inside)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: action
    type(model_t), intent(in) :: model
    integer, intent(out) :: ends(2)
    logical, intent(inout) :: is_of_part(0:), is_inside(:)
    integer :: found, k, kind

    kind = a_node
    if (index(action, 'PART') > 0) kind = a_part
    if (index(action, 'BOX') > 0) kind = a_box
    ends = 0
    do k = 2, 1 + count(card%kinds == 'i')
      if (card%i(k) < 0 .or. (k == 2 .and. all(card%i(2:) == 0)) .or. (kind == a_node &
        .and. k < 4 .and. card%i(k) == 0)) then
        call report_field(deck, card, k, 'is not a number of 1 or more')
      else if (kind == a_node .and. k > 3 .and. all(card%i(k) /= [0, card%i(2:3)])) then
        call report_field(deck, card, k, &
          'is a third node; an edge in the plane has two (repeat E2 or leave it 0)')
      end if
      if (card%i(k) < 1 .or. card%bad(k) .or. (kind == a_node .and. k > 3)) cycle
      call find_id(deck, kind, card, k, found)
      if (kind == a_node) ends(k - 1) = found
      if (found == 0) cycle
      if (kind == a_part) is_of_part(found) = .true.
      if (kind == a_box) is_inside = is_inside .or. mark_box(deck, found, model)
    end do
    if (kind == a_node .and. card%i(2) == card%i(3)) call report_field(deck, card, 'E2', &
      'is the first node again; an edge has two nodes')
  end subroutine read_entities

  !> Whether an edge has two nodes as ends, in either direction.
  elemental function is_same(a, b, c, d) result(yes)
    integer, intent(in) :: a, b !! nodes of the edge
    integer, intent(in) :: c, d !! the two nodes
    logical :: yes

    yes = (a == c .and. b == d) .or. (a == d .and. b == c)
  end function is_same

  !> Keep the edges of a mask.
  subroutine keep_edges(is_kept, edges)
    logical, intent(in) :: is_kept(:)
    integer, allocatable, intent(inout) :: edges(:, :)

    edges = reshape(pack(edges, spread(is_kept, 1, 2)), [2, count(is_kept)])
  end subroutine keep_edges

  !> Append the edges that the set does not have.
  subroutine add_edges(more, edges)
    integer, intent(in) :: more(:, :)
    integer, allocatable, intent(inout) :: edges(:, :)
    logical :: is_new(size(more, 2))
    integer :: i

    do i = 1, size(more, 2)
      is_new(i) = .not. any(is_same(edges(1, :), edges(2, :), more(1, i), more(2, i)))
    end do
    edges = reshape([edges, pack(more, spread(is_new, 1, 2))], [2, size(edges, 2) + count(is_new)])
  end subroutine add_edges

end module deck_segments_m
