! SPDX-License-Identifier: MIT
!> *SET_; *ELEMENT_BEAM, by which mesh generators write the edges of a plane mesh: a segment set and
!> a node set with the number of their part; *DATABASE_HISTORY_ and *DATABASE_NODAL_FORCE_GROUP.
module deck_sets_m
  use kinds_m, only : long
  use log_m, only : to_text
  use text_m, only : upper_case
  use controls_m, only : force_group_t
  use sorting_m, only : sorted_order
  use boundary_m, only : boundary_t, find_boundary
  use model_m, only : model_t
  use deck_boxes_m, only : mark_box
  use deck_lines_m, only : deck_t, blocks_of, count_rows, line_error, line_warning
  use deck_fields_m, only : card_t, field_text
  use deck_cards_m, only : cursor_t, first_card, open_cursor, next_text, next_card, next_row, &
    next_of, report_field
  use deck_ids_m, only : ids_between, kind_names, a_node, an_element, a_part, a_node_set, &
    a_part_set, a_segment_set, a_shell_set, a_box
  use deck_segments_m, only : change_edges
  use deck_values_m, only : integer_of, is_bad, map_defined, note_refused, find_id
  implicit none
  private
  public :: read_sets, read_histories, remove_duplicates, check_edge

  !> One set of any kind; members of a segment set are pairs of nodes.
  type :: set_t
    integer :: id = 0
    integer :: line = 0
    integer :: block = 0                !! 0: of beams
    character(:), allocatable :: title
    logical :: of_beams = .false.
    logical :: is_whole = .true.        !! all members on its cards exist
    logical :: is_boundary = .false.    !! segment set whose members are parts
    integer :: n_named = 0              !! number of members on its cards
    integer :: n = 0
    integer, allocatable :: members(:)  !! (n), longer while the set is read
    integer, allocatable :: position(:) !! (n_node) of each node in a general set while it is read,
                                        !! 0: not in it
  end type set_t

contains

  !> Read all sets. Mesh and parts have been read.
  subroutine read_sets(deck, model, is_whole)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    logical, allocatable, intent(out) :: is_whole(:) !! (node sets) all nodes on the cards exist
    type(set_t), allocatable :: sets(:), beams(:, :)
    type(boundary_t) :: boundary
    logical, allocatable :: is_chosen(:), all_nodes(:)
    logical :: is_of_part(0:size(model%parts))
    integer :: i

    call read_kind(deck, 'SET_PART', a_part_set, model, sets)
    allocate (model%part_sets(size(sets)))
    do i = 1, size(sets)
      model%part_sets(i)%id = sets(i)%id
      call move_alloc(sets(i)%members, model%part_sets(i)%parts)
    end do
    call read_kind(deck, 'SET_SHELL', a_shell_set, model, sets)
    allocate (model%shell_sets(size(sets)))
    do i = 1, size(sets)
      model%shell_sets(i)%id = sets(i)%id
      call move_alloc(sets(i)%members, model%shell_sets(i)%elements)
    end do
    call read_beams(deck, model, beams)
    call read_kind(deck, 'SET_NODE', a_node_set, model, sets, beams(:, 1))
    allocate (model%node_sets(size(sets)))
    do i = 1, size(sets)
      model%node_sets(i)%id = sets(i)%id
      if (allocated(sets(i)%title)) model%node_sets(i)%title = sets(i)%title
      call move_alloc(sets(i)%members, model%node_sets(i)%nodes)
    end do
    is_whole = sets%is_whole
    call read_kind(deck, 'SEGMENT', a_segment_set, model, sets, beams(:, 2))
    allocate (model%segment_sets(size(sets)))
    allocate (all_nodes(model%mesh%n_node), source=.true.)
    do i = 1, size(sets)
      model%segment_sets(i)%id = sets(i)%id
      if (sets(i)%is_boundary) then
        call move_alloc(sets(i)%members, model%segment_sets(i)%parts)
        allocate (model%segment_sets(i)%nodes(2, 0))
        ! Errors of the mesh have been reported.
        if (any(model%mesh%element_nodes < 1)) cycle
        is_of_part = .false.
        is_of_part(model%segment_sets(i)%parts) = .true.
        is_chosen = is_of_part(model%mesh%element_part)
        call find_boundary(model%mesh%element_nodes, is_chosen, all_nodes, boundary, &
          model%mesh%hanging)
        model%segment_sets(i)%nodes = boundary%nodes
      else
        if (.not. sets(i)%is_whole) sets(i)%n = 0
        model%segment_sets(i)%nodes = reshape(sets(i)%members(:sets(i)%n), [2, sets(i)%n/2])
      end if
    end do
  end subroutine read_sets

  !> Read the sets of one kind, and merge the sets of beams in the order of the deck.
  subroutine read_kind(deck, word, kind, model, sets, of_beams)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: word         !! part of the names of their keywords
    integer, intent(in) :: kind
    type(model_t), intent(in) :: model
    type(set_t), allocatable, intent(out) :: sets(:)
    type(set_t), intent(in), optional :: of_beams(:)
    integer, allocatable :: blocks(:), order(:)
    integer :: i, n

    blocks = blocks_of(deck, 'SET_')
    blocks = pack(blocks, [(index(deck%blocks(blocks(i))%name, word) > 0, i=1, size(blocks))])
    allocate (sets(size(blocks)))
    n = 0
    do i = 1, size(blocks)
      call read_set(deck, blocks(i), model, sets(n + 1))
      if (sets(n + 1)%id > 0) n = n + 1
    end do
    if (n < size(sets)) sets = sets(:n)
    if (present(of_beams)) then
      if (size(of_beams) > 0) then
        order = sorted_order(int([sets%line, of_beams%line], long))
        sets = [sets, of_beams]
        sets = sets(order)
      end if
    end if
    deck%maps(kind)%n = size(sets)
    deck%maps(kind)%ids = [sets%id]
    deck%maps(kind)%lines = [sets%line]
    call map_defined(deck, kind, 'SID', [sets%of_beams])
    if (kind == a_part_set) call add_sets(deck, size(model%parts), sets)
  end subroutine read_kind

  !> Read a set of nodes, parts, elements or segments: its number, then its members.
  subroutine read_set(deck, i_block, model, set)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(model_t), intent(in) :: model
    type(set_t), intent(out) :: set           !! id 0: refused
    type(cursor_t) :: cursor
    type(card_t) :: head, card
    logical :: is_sound
    integer, allocatable :: edges(:, :)
    integer :: k, kind

    call open_cursor(deck, i_block, cursor)
    if (deck%blocks(i_block)%titled) call next_text(deck, cursor, set%title)
    call next_card(deck, cursor, 1, head)
    set%line = head%line
    set%block = i_block
    allocate (set%members(64), edges(2, 0))
    is_sound = .true.
    kind = a_part
    if (index(deck%blocks(i_block)%name, 'SET_NODE') == 1) kind = a_node
    if (index(deck%blocks(i_block)%name, 'SET_SHELL') == 1) kind = an_element
    do while (next_row(deck, cursor, 2, card))
      select case (deck%blocks(i_block)%name)
      case ('SET_NODE_LIST', 'SET_PART_LIST', 'SET_SHELL_LIST', 'SET_2D_SEGMENT')
        call read_members(deck, card, kind, set)
      case ('SET_NODE_LIST_GENERATE', 'SET_PART_LIST_GENERATE', 'SET_SHELL_LIST_GENERATE')
        call read_id_ranges(deck, card, kind, set)
      case ('SET_2D_SEGMENT_SET')
        call find_id(deck, a_part_set, card, 'PSID', k)
        set%n_named = set%n_named + 1
        if (k > 0) call append(set, model%part_sets(k)%parts)
      case ('SET_SEGMENT')
        call check_edge(deck, card)
        if (.not. any(card%bad)) call read_edge(deck, card, set)
      case ('SET_PART_ADD')
        set%n_named = 1 ! read by add_sets
      case ('SET_SEGMENT_GENERAL')
        call change_edges(deck, card, model, edges)
      case ('SET_NODE_GENERAL')
        call read_option(deck, card, model, set)
      end select
      is_sound = is_sound .and. .not. any(card%bad)
    end do
    call append(set, [edges])
    set%is_boundary = index(deck%blocks(i_block)%name, 'SET_2D_SEGMENT') == 1
    set%is_whole = is_sound
    set%members = set%members(:set%n)
    if (allocated(set%position)) then
      set%members = pack(set%members, set%position(set%members) == [(k, k=1, set%n)])
      set%n_named = size(set%members)
    end if
    if (is_sound .and. set%n_named == 0) call line_error(deck, set%line, 'the set is empty')
    if (is_bad(head, 'SID')) call note_refused(deck, [a_node_set, a_part_set, a_segment_set, &
      a_shell_set])
    if (.not. is_bad(head, 'SID')) set%id = integer_of(head, 'SID')
  end subroutine read_set

  !> *SET_PART_ADD: the parts of the sets on its cards, each once.
  subroutine add_sets(deck, n_part, sets)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: n_part
    type(set_t), intent(inout) :: sets(:)
    type(cursor_t) :: cursor
    type(card_t) :: card
    logical :: is_known(size(sets))
    integer, allocatable :: kept(:)
    integer :: i, k, found

    is_known = [(deck%blocks(sets(i)%block)%name /= 'SET_PART_ADD', i=1, size(sets))]
    do i = 1, size(sets)
      if (is_known(i)) cycle
      call first_card(deck, sets(i)%block, cursor, card)
      sets(i)%members = [(0, k=1, 64)]
      do while (next_row(deck, cursor, 2, card))
        do k = 1, count(card%kinds == 'i')
          if (card%i(k) < 0) call report_field(deck, card, k, 'is not a number of 1 or more')
          if (card%i(k) < 1) cycle
          call find_id(deck, a_part_set, card, k, found)
          if (found == 0) cycle
          if (.not. is_known(found)) call report_field(deck, card, k, &
            'is the number of this set or of a later *SET_PART_ADD')
          call append(sets(i), sets(found)%members)
        end do
      end do
      is_known(i) = .true.
      call remove_duplicates(sets(i)%members(:sets(i)%n), n_part, kept)
      call move_alloc(kept, sets(i)%members)
      sets(i)%n = size(sets(i)%members)
    end do
  end subroutine add_sets

  !> Append members; 0 is skipped.
  subroutine append(set, members)
    type(set_t), intent(inout) :: set
    integer, intent(in) :: members(:)
    integer :: i

    do i = 1, size(members)
      set%n_named = set%n_named + 1
      if (members(i) == 0) cycle
      if (set%n == size(set%members)) set%members = [set%members, set%members]
      set%n = set%n + 1
      set%members(set%n) = members(i)
    end do
  end subroutine append

  !> Read the ids of a row, one in each field; zeros are padding.
  subroutine read_members(deck, card, kind, set)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(in) :: kind               !! of the members
    type(set_t), intent(inout) :: set
    integer :: k, found

    do k = 1, count(card%kinds == 'i')
      if (card%i(k) < 0) call report_field(deck, card, k, 'is not a number of 1 or more')
      if (card%i(k) < 1) cycle
      call find_id(deck, kind, card, k, found)
      call append(set, [found])
    end do
  end subroutine read_members

  !> Read pairs of first and last id.
  subroutine read_id_ranges(deck, card, kind, set)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(in) :: kind
    type(set_t), intent(inout) :: set
    integer, allocatable :: block(:)
    integer :: k

    do k = 1, count(card%kinds == 'i') - 1, 2
      if (all(card%i(k:k + 1) == 0)) cycle
      if (card%i(k) < 1) call report_field(deck, card, k, 'is not a number of 1 or more')
      if (card%i(k + 1) < card%i(k)) call report_field(deck, card, k + 1, &
        'is not the end of a range that begins with "'//to_text(card%i(k))//'"')
      if (any(card%bad(k:k + 1))) cycle
      call ids_between(deck%maps(kind), card%i(k), card%i(k + 1), block)
      if (size(block) == 0 .and. .not. deck%maps(kind)%incomplete) call &
        report_field(deck, card, k, 'to "'//to_text(card%i(k + 1))//'": there is no ' &
        //trim(kind_names(kind))//' in this range')
      set%n_named = set%n_named + 1
      call append(set, block)
    end do
  end subroutine read_id_ranges

  !> Read the nodes N1 and N2 of an edge.
  subroutine read_edge(deck, card, set)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(set_t), intent(inout) :: set
    integer :: ends(2)

    call find_id(deck, a_node, card, 'N1', ends(1))
    call find_id(deck, a_node, card, 'N2', ends(2))
    call append(set, ends)
  end subroutine read_edge

  !> Read a row of *SET_NODE_GENERAL, which adds or removes nodes. Each node is in the set once, at
  !> the position where it was added.
  subroutine read_option(deck, card, model, set)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    type(set_t), intent(inout) :: set
    character(:), allocatable :: action
    integer :: i, k, kind, found

    action = upper_case(field_text(deck, card, 1))
    if (.not. allocated(set%position)) allocate (set%position(model%mesh%n_node), source=0)
    if (all(action /= ['ALL  ', 'NODE ', 'DNODE', 'PART ', 'DPART', 'BOX  ', 'DBOX '])) then
      call report_field(deck, card, 'OPTION', &
        'is not ALL, NODE, DNODE, PART, DPART, BOX or DBOX')
      return
    else if (action == 'ALL') then
      call change_members([(i, i=1, model%mesh%n_node)])
      return
    end if
    if (all(card%i(2:) == 0)) call report_field(deck, card, 'E1', 'is not a number of 1 or more')
    kind = a_node
    if (index(action, 'PART') > 0) kind = a_part
    if (index(action, 'BOX') > 0) kind = a_box
    do k = 2, 1 + count(card%kinds == 'i')
      if (card%i(k) < 0) call report_field(deck, card, k, 'is not a number of 1 or more')
      if (card%i(k) < 1) cycle
      call find_id(deck, kind, card, k, found)
      if (found == 0) cycle
      if (kind == a_node) call change_members([found])
      if (kind == a_box) call change_members(pack([(i, i=1, model%mesh%n_node)], &
        mark_box(deck, found, model)))
      do i = 1, merge(model%mesh%n_element, 0, kind == a_part)
        if (model%mesh%element_part(i) == found) call change_members(model%mesh%element_nodes(:, i))
      end do
    end do

  contains

    !> Add nodes that are not in the set, or remove them; 0 is skipped.
    subroutine change_members(nodes)
      integer, intent(in) :: nodes(:)
      integer :: j

      do j = 1, size(nodes)
        if (nodes(j) == 0) cycle
        if (action(1:1) == 'D') then
          set%position(nodes(j)) = 0
        else if (set%position(nodes(j)) == 0) then
          call append(set, nodes(j:j))
          set%position(nodes(j)) = set%n
        end if
      end do
    end subroutine change_members

  end subroutine read_option

  !> Check N1 to N4 of an edge: two nodes, then 0 or repeated nodes.
  subroutine check_edge(deck, card)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer :: first, k

    first = findloc(card%names, 'N1  ', dim=1)
    if (card%i(first) == card%i(first + 1)) call report_field(deck, card, first + 1, &
      'is the first node again; an edge has two nodes')
    do k = first + 2, first + 3
      if (any(card%bad)) exit
      if (all(card%i(k) /= [0, card%i(first:first + 1)])) call report_field(deck, card, k, &
        'is a third node; an edge in the plane has two (repeat N2 or leave it 0)')
    end do
  end subroutine check_edge

  !> *ELEMENT_BEAM: a node set and a segment set with the number of each part.
  subroutine read_beams(deck, model, sets)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    type(set_t), allocatable, intent(out) :: sets(:, :) !! (n, 2) of nodes, of segments
    type(set_t), allocatable :: edges(:)
    type(set_t) :: unset
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: kept(:)
    integer :: i

    allocate (edges(0), unset%members(64))
    do while (next_of(deck, 'ELEMENT_BEAM', cursor, card))
      if (any(card%bad)) call note_refused(deck, [a_node_set, a_segment_set])
      if (any(card%bad)) cycle
      call line_warning(deck, card%line, 'beams', 'beams are edges here, not elements: those of ' &
        //'each part are the segment set and the node set with its number')
      ! Most often the last part.
      do i = size(edges), 1, -1
        if (edges(i)%id == integer_of(card, 'PID')) exit
      end do
      if (i == 0) then
        edges = [edges, unset]
        i = size(edges)
        edges(i)%id = integer_of(card, 'PID')
        edges(i)%line = card%line
        edges(i)%of_beams = .true.
      end if
      call read_edge(deck, card, edges(i))
      edges(i)%is_whole = edges(i)%is_whole .and. .not. any(card%bad)
    end do
    allocate (sets(size(edges), 2))
    do i = 1, size(edges)
      edges(i)%members = edges(i)%members(:edges(i)%n)
      sets(i, :) = edges(i)
      call remove_duplicates(edges(i)%members, model%mesh%n_node, kept)
      sets(i, 1)%members = kept
    end do
  end subroutine read_beams

  !> Read nodes and elements of *DATABASE_HISTORY_, each once, in deck order, and the force groups
  !> of *DATABASE_NODAL_FORCE_GROUP.
  subroutine read_histories(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(force_group_t), allocatable :: groups(:)
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: members(:), sets(:)
    logical :: is_used(size(model%node_sets))
    integer :: i, n, set

    call read_chosen(deck, 'DATABASE_HISTORY_NODE', [a_node, a_node_set], members, sets)
    members = [members, (model%node_sets(sets(i))%nodes, i=1, size(sets))]
    call remove_duplicates(members, model%mesh%n_node, model%controls%output%history_nodes)
    call read_chosen(deck, 'DATABASE_HISTORY_SHELL', [an_element, a_shell_set], members, sets)
    members = [members, (model%shell_sets(sets(i))%elements, i=1, size(sets))]
    call remove_duplicates(members, model%mesh%n_element, model%controls%output%history_elements)
    n = count_rows(deck, 'DATABASE_NODAL_FORCE_GROUP')
    if (n == 0) return
    allocate (groups(n))
    is_used = .false.
    n = 0
    do while (next_of(deck, 'DATABASE_NODAL_FORCE_GROUP', cursor, card))
      call find_id(deck, a_node_set, card, 'NSID', set)
      if (set == 0) cycle
      if (is_used(set)) call report_field(deck, card, 'NSID', &
        'is the node set of another force group')
      is_used(set) = .true.
      n = n + 1
      groups(n)%id = integer_of(card, 'NSID')
      call remove_duplicates(model%node_sets(set)%nodes, model%mesh%n_node, groups(n)%nodes)
    end do
    model%controls%output%force_groups = groups(:n)
  end subroutine read_histories

  !> Read the members and sets of keywords that begin with `head`.
  subroutine read_chosen(deck, head, kinds, members, sets)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: head
    integer, intent(in) :: kinds(2)           !! of members and of sets
    integer, allocatable, intent(out) :: members(:), sets(:)
    type(set_t) :: chosen(2)
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: k

    allocate (chosen(1)%members(64), chosen(2)%members(64))
    do while (next_of(deck, head, cursor, card))
      k = merge(2, 1, deck%blocks(cursor%block)%name == head//'_SET')
      call read_members(deck, card, kinds(k), chosen(k))
    end do
    members = chosen(1)%members(:chosen(1)%n)
    sets = chosen(2)%members(:chosen(2)%n)
  end subroutine read_chosen

  !> Members of a list without repetitions, in order.
  pure subroutine remove_duplicates(members, n_all, kept)
    integer, intent(in) :: members(:)
    integer, intent(in) :: n_all           !! members are 1 to this
    integer, allocatable, intent(out) :: kept(:)
    logical, allocatable :: is_first(:), listed(:)
    integer :: i

    allocate (listed(n_all), is_first(size(members)), source=.false.)
    do i = 1, size(members)
      is_first(i) = .not. listed(members(i))
      listed(members(i)) = .true.
    end do
    kept = pack(members, is_first)
  end subroutine remove_duplicates

end module deck_sets_m
