! SPDX-License-Identifier: MIT
!> Sets with indices in place of ids.
module deck_resolve_sets_m
  use log_m, only : to_text
  use model_m, only : model_t
  use deck_lines_m, only : deck_t, place_t, line_error
  use deck_ids_m, only : id_map_t, ids_between
  use deck_maps_m, only : maps_t, resolve_id
  use deck_cards_m, only : reject_field
  use deck_raw_m, only : raw_t
  use deck_raw_sets_m, only : raw_set_t
  implicit none
  private
  public :: resolve_sets, resolve_history

contains

  !> All sets of the deck.
  subroutine resolve_sets(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    integer, allocatable :: members(:)
    integer :: i

    allocate (model%node_sets(raw%n_node_set), model%part_sets(raw%n_part_set), &
      model%segment_sets(raw%n_segment_set))
    do i = 1, raw%n_node_set
      model%node_sets(i)%id = raw%node_sets(i)%id
      call resolve_members(deck, raw%node_sets(i), maps%nodes, 'node', 2, &
        model%node_sets(i)%nodes)
    end do
    do i = 1, raw%n_part_set
      model%part_sets(i)%id = raw%part_sets(i)%id
      call resolve_members(deck, raw%part_sets(i), maps%parts, 'part', 2, &
        model%part_sets(i)%parts)
    end do
    do i = 1, raw%n_segment_set
      model%segment_sets(i)%id = raw%segment_sets(i)%id
      call resolve_members(deck, raw%segment_sets(i), maps%nodes, 'node', 2, members)
      if (size(members) /= raw%segment_sets(i)%n) members = members(:0)
      model%segment_sets(i)%nodes = reshape(members, [2, size(members)/2])
    end do
  end subroutine resolve_sets

  !> Members of one set; those that do not exist are errors and left out.
  subroutine resolve_members(deck, set, map, what, card, members)
    type(deck_t), intent(inout) :: deck
    type(raw_set_t), intent(in) :: set
    type(id_map_t), intent(in) :: map
    character(*), intent(in) :: what
    integer, intent(in) :: card            !! number of the card that members stand on
    integer, allocatable, intent(out) :: members(:)
    integer, allocatable :: block(:)
    integer :: i, n, found

    if (set%generate) then
      allocate (members(0))
      do i = 1, set%n, 2
        call ids_between(map, set%members(i), set%members(i + 1), block)
        if (size(block) == 0 .and. .not. map%incomplete) call reject_field(deck, &
          place_t(set%lines(i), card, field=set%fields(i)), 'to "' &
          //to_text(set%members(i + 1))//'": there is no '//what//' in this block')
        members = [members, block]
      end do
    else
      allocate (members(set%n))
      n = 0
      do i = 1, set%n
        call resolve_id(deck, map, set%members(i), what, &
          place_t(set%lines(i), card, field=set%fields(i)), found)
        if (found == 0) cycle
        n = n + 1
        members(n) = found
      end do
      if (n < set%n) members = members(:n)
    end if
    if (set%n == 0 .and. set%line > 0 .and. .not. set%damaged) call line_error(deck, &
      set%line, 'the set is empty')
  end subroutine resolve_members

  !> Nodes of *DATABASE_HISTORY_NODE and _NODE_SET, each once, in deck order.
  subroutine resolve_history(deck, raw, maps, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(maps_t), intent(in) :: maps
    type(model_t), intent(inout) :: model
    integer, allocatable :: nodes(:), sets(:), all_nodes(:)
    logical, allocatable :: listed(:)
    integer :: i, n

    call resolve_members(deck, raw%history_nodes, maps%nodes, 'node', 1, nodes)
    call resolve_members(deck, raw%history_node_sets, maps%node_sets, 'node set', 1, sets)
    all_nodes = nodes
    do i = 1, size(sets)
      all_nodes = [all_nodes, model%node_sets(sets(i))%nodes]
    end do
    allocate (listed(model%mesh%n_node), source=.false.)
    n = 0
    do i = 1, size(all_nodes)
      if (listed(all_nodes(i))) cycle
      listed(all_nodes(i)) = .true.
      n = n + 1
      all_nodes(n) = all_nodes(i)
    end do
    model%controls%output%history_nodes = all_nodes(:n)
  end subroutine resolve_history

end module deck_resolve_sets_m
