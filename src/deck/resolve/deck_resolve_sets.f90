! SPDX-License-Identifier: MIT
!> Sets with indices in place of ids.
module deck_resolve_sets_m
  use force_groups_m, only : force_group_t
  use kinds_m, only : long
  use log_m, only : to_text
  use sets_m, only : segment_set_t
  use sorting_m, only : sorted_order
  use boundary_m, only : boundary_t, find_boundary
  use model_m, only : model_t
  use deck_ids_m, only : a_node, a_node_set, a_part, a_part_set, a_shell_set, an_element
  use deck_lines_m, only : deck_t, place_t, line_error
  use deck_ids_m, only : id_map_t, map_ids, ids_between, kind_names
  use deck_maps_m, only : resolve_id
  use deck_cards_m, only : reject_field
  use deck_raw_m, only : raw_t
  use deck_raw_sets_m, only : raw_set_t, add_all, add_parts, of_part, of_part_set
  implicit none
  private
  public :: resolve_sets, resolve_history, keep_first

contains

  !> All sets of the deck.
  subroutine resolve_sets(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    integer :: i

    allocate (model%node_sets(raw%n_node_set), model%part_sets(raw%n_part_set), &
      model%segment_sets(raw%n_segment_set), model%shell_sets(raw%n_shell_set))
    do i = 1, raw%n_node_set
      model%node_sets(i)%id = raw%node_sets(i)%id
      if (allocated(raw%node_sets(i)%title)) model%node_sets(i)%title = raw%node_sets(i)%title
      if (allocated(raw%node_sets(i)%actions)) then
        call resolve_general(deck, raw%node_sets(i), model, model%node_sets(i)%nodes)
      else
        call resolve_members(deck, raw%node_sets(i), a_node, &
          merge(1, 2, raw%node_sets(i)%of_beams), model%node_sets(i)%nodes)
      end if
    end do
    do i = 1, raw%n_part_set
      model%part_sets(i)%id = raw%part_sets(i)%id
      call resolve_members(deck, raw%part_sets(i), a_part, 2, &
        model%part_sets(i)%parts)
    end do
    do i = 1, raw%n_shell_set
      model%shell_sets(i)%id = raw%shell_sets(i)%id
      call resolve_members(deck, raw%shell_sets(i), an_element, 2, &
        model%shell_sets(i)%elements)
    end do
    do i = 1, raw%n_segment_set
      model%segment_sets(i)%id = raw%segment_sets(i)%id
      call resolve_segments(deck, raw%segment_sets(i), model, model%segment_sets(i))
    end do
  end subroutine resolve_sets

  !> Edges of one segment set: those of its cards, or the boundary of its parts.
  subroutine resolve_segments(deck, set, model, segments)
    type(deck_t), intent(inout) :: deck
    type(raw_set_t), intent(in) :: set
    type(model_t), intent(in) :: model
    type(segment_set_t), intent(inout) :: segments
    integer, allocatable :: members(:)
    integer :: i

    select case (set%boundary)
    case (of_part)
      call resolve_members(deck, set, a_part, 2, segments%parts)
    case (of_part_set)
      call resolve_members(deck, set, a_part_set, 2, members)
      allocate (segments%parts(0))
      do i = 1, size(members)
        segments%parts = [segments%parts, model%part_sets(members(i))%parts]
      end do
    case default
      call resolve_members(deck, set, a_node, merge(1, 2, set%of_beams), members)
      if (size(members) /= set%n) members = members(:0)
      segments%nodes = reshape(members, [2, size(members)/2])
      return
    end select
    call bound_parts(model, segments)
  end subroutine resolve_segments

  !> The boundary of the parts of a segment set.
  subroutine bound_parts(model, segments)
    type(model_t), intent(in) :: model
    type(segment_set_t), intent(inout) :: segments
    type(boundary_t) :: boundary
    logical, allocatable :: is_chosen(:), all_nodes(:)
    logical :: is_of_part(size(model%parts))
    integer :: i

    allocate (segments%nodes(2, 0))
    ! Of a mesh with mistakes only these are told.
    if (any(model%mesh%element_nodes < 1)) return
    allocate (is_chosen(model%mesh%n_element), source=.false.)
    is_of_part = .false.
    is_of_part(segments%parts) = .true.
    do i = 1, model%mesh%n_element
      if (model%mesh%element_part(i) > 0) is_chosen(i) = is_of_part(model%mesh%element_part(i))
    end do
    allocate (all_nodes(model%mesh%n_node), source=.true.)
    call find_boundary(model%mesh%element_nodes, is_chosen, all_nodes, boundary)
    segments%nodes = boundary%nodes
  end subroutine bound_parts

  !> A general set: its rows add nodes and take them out, one after the other. Each node stands in
  !> it once, where it was added.
  subroutine resolve_general(deck, set, model, nodes)
    type(deck_t), intent(inout) :: deck
    type(raw_set_t), intent(in) :: set
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: nodes(:)
    integer, allocatable :: place(:), order(:)
    integer :: i, k, n, found, clock

    allocate (place(model%mesh%n_node), source=0)
    clock = 0
    do i = 1, set%n
      if (set%actions(i) == add_all) then
        do k = 1, model%mesh%n_node
          call take(k, .true.)
        end do
      else if (abs(set%actions(i)) == add_parts) then
        call resolve_id(deck, a_part, set%members(i), &
          place_t(set%lines(i), 2, field=set%fields(i)), found)
        if (found == 0) cycle
        do k = 1, model%mesh%n_element
          if (model%mesh%element_part(k) /= found) cycle
          do n = 1, 4
            call take(model%mesh%element_nodes(n, k), set%actions(i) > 0)
          end do
        end do
      else
        call resolve_id(deck, a_node, set%members(i), &
          place_t(set%lines(i), 2, field=set%fields(i)), found)
        call take(found, set%actions(i) > 0)
      end if
    end do
    nodes = pack([(i, i=1, size(place))], place > 0)
    order = sorted_order(int(place(nodes), long))
    nodes = nodes(order)
    if (size(nodes) == 0 .and. .not. set%damaged .and. model%mesh%n_node > 0) &
      call line_error(deck, set%line, 'the set is empty')

  contains

    !> Add a node that is not there, or take it out.
    subroutine take(node, adds)
      integer, intent(in) :: node !! 0: none
      logical, intent(in) :: adds

      if (node < 1) return
      if (.not. adds) then
        place(node) = 0
      else if (place(node) == 0) then
        clock = clock + 1
        place(node) = clock
      end if
    end subroutine take

  end subroutine resolve_general

  !> Members of one set; those that do not exist are errors and left out.
  subroutine resolve_members(deck, set, kind, card, members)
    type(deck_t), intent(inout) :: deck
    type(raw_set_t), intent(in) :: set
    integer, intent(in) :: kind
    integer, intent(in) :: card            !! number of the card that members stand on
    integer, allocatable, intent(out) :: members(:)
    integer, allocatable :: block(:)
    integer :: i, n, found

    if (set%generate) then
      allocate (members(0))
      do i = 1, set%n, 2
        call ids_between(deck%maps(kind), set%members(i), set%members(i + 1), block)
        if (size(block) == 0 .and. .not. deck%maps(kind)%incomplete) call reject_field(deck, &
          place_t(set%lines(i), card, field=set%fields(i)), 'to "' &
          //to_text(set%members(i + 1))//'": there is no ' &
          //trim(kind_names(kind))//' in this block')
        members = [members, block]
      end do
    else
      allocate (members(set%n))
      n = 0
      do i = 1, set%n
        call resolve_id(deck, kind, set%members(i), &
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

  !> Nodes and elements of *DATABASE_HISTORY_, each once, in deck order.
  subroutine resolve_history(deck, raw, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    integer, allocatable :: members(:), sets(:)
    integer :: i

    call resolve_members(deck, raw%history_nodes, a_node, 1, members)
    call resolve_members(deck, raw%history_node_sets, a_node_set, 1, sets)
    do i = 1, size(sets)
      members = [members, model%node_sets(sets(i))%nodes]
    end do
    call keep_first(members, model%mesh%n_node, model%controls%output%history_nodes)
    call resolve_members(deck, raw%history_shells, an_element, 1, members)
    call resolve_members(deck, raw%history_shell_sets, a_shell_set, 1, sets)
    do i = 1, size(sets)
      members = [members, model%shell_sets(sets(i))%elements]
    end do
    call keep_first(members, model%mesh%n_element, model%controls%output%history_elements)
    if (raw%force_groups%n > 0) call resolve_groups(deck, raw%force_groups, model)
  end subroutine resolve_history

  !> Force groups: node sets, none of them twice.
  subroutine resolve_groups(deck, set, model)
    type(deck_t), intent(inout) :: deck
    type(raw_set_t), intent(in) :: set
    type(model_t), intent(inout) :: model
    type(force_group_t), allocatable :: groups(:)
    type(id_map_t) :: map
    integer, allocatable :: twice(:)
    logical :: is_again(set%n)
    integer :: i, n, found

    call map_ids(set%members(:set%n), map, twice)
    is_again = .false.
    is_again(twice) = .true.
    allocate (groups(set%n))
    n = 0
    do i = 1, set%n
      if (is_again(i)) then
        call reject_field(deck, place_t(set%lines(i), 1, 'NSID'), &
          'is the node set of another force group')
        cycle
      end if
      call resolve_id(deck, a_node_set, set%members(i), &
        place_t(set%lines(i), 1, 'NSID'), found)
      if (found == 0) cycle
      n = n + 1
      groups(n)%id = set%members(i)
      call keep_first(model%node_sets(found)%nodes, model%mesh%n_node, groups(n)%nodes)
    end do
    model%controls%output%force_groups = groups(:n)
  end subroutine resolve_groups

  !> Members of a list, each where it comes first.
  pure subroutine keep_first(members, n_all, kept)
    integer, intent(in) :: members(:)
    integer, intent(in) :: n_all           !! members are 1 to this
    integer, allocatable, intent(out) :: kept(:)
    logical, allocatable :: listed(:)
    integer :: i, n

    allocate (listed(n_all), source=.false.)
    kept = members
    n = 0
    do i = 1, size(members)
      if (listed(members(i))) cycle
      listed(members(i)) = .true.
      n = n + 1
      kept(n) = members(i)
    end do
    kept = kept(:n)
  end subroutine keep_first

end module deck_resolve_sets_m
