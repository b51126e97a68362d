! SPDX-License-Identifier: MIT
!> Which process of a run has which tiles, and what goes with them: ranges of chunks, nodes and
!> force slots, since all of these stand tile by tile. Each keeps in memory the special nodes, and
!> nodes and elements of its own tiles; the first one keeps all, for it writes. Arrays are as long
!> as the mesh, so that numbers mean the same everywhere, but what belongs to others is not written
!> to. Special nodes that contact, loads, walls or rigid bodies touch are computed by all processes,
!> which all hear of them. The others lie between tiles: only the processes whose tiles touch them
!> sum and move them, and these hear each other's forces on them. To the others such a node is what
!> an interior node of another process is. The first process has read the deck, resolved and
!> renumbered; the others get the model from it.
module rank_shares_m
  use buffer_sharing_m, only : hand, everyone
  use kinds_m, only : wp
  use layout_m, only : layout_t, chunk_size
  use load_work_m, only : motion_sums_t
  use model_m, only : model_t
  use others_memory_m, only : others_t, forgetters_of, answers_t
  use packed_buffer_m, only : forgetter_t, packed_buffer_t, part_of
  use ranks_m, only : ranks_t
  use renumber_m, only : mark_moved_nodes
  use state_m, only : state_t
  use visitor_m, only : visited_t, visitor_t, of_elements, of_nodes, of_slots
  implicit none
  private
  public :: shares_t, share_out, forget_others, plan_borders, hand_model, hand_others

  !> The first arrays (0:n): where the range of each process starts, then one beyond the last.
  type :: shares_t
    integer, allocatable :: tiles(:), chunks(:)
    integer, allocatable :: nodes(:)       !! interior
    integer, allocatable :: special(:)     !! special nodes that its tiles own
    integer, allocatable :: force_slots(:)
    integer :: first_tile = 1, last_tile = 0 !! of this process
    ! Borders: force slots that are exchanged, and who moves which nodes.
    integer, allocatable :: runs(:, :)       !! (2, n) special nodes that this process sums and
                                             !! moves: first and last of each run
    integer, allocatable :: run_tiles(:)     !! (n) the tile that owns those of each run
    integer, allocatable :: common(:)        !! force slots on nodes that all know, by process
    integer, allocatable :: common_starts(:) !! (n + 1) where those of each start
    integer, allocatable :: peers(:)         !! processes with which it has borders
    integer, allocatable :: out_starts(:), in_starts(:) !! (peers + 1)
    integer, allocatable :: out_slots(:)     !! force slots of its own that each peer needs
    integer, allocatable :: in_slots(:)      !! those of each peer that it needs
    integer, allocatable :: block_nodes(:)   !! (n + 1) special nodes whose sums each forms: where
                                             !! they start
  end type shares_t

  !> Items of a piece at most.
  integer, parameter :: most_items = 65536

  !> What is handed besides the model.
  type, extends(visited_t) :: handed_t
    integer, allocatable :: parts(:)                !! of elements behind surfaces
    integer, allocatable :: corners(:, :)           !! (4, elements) their nodes
    real(wp), allocatable :: places(:, :)           !! (2, 4 elements) where these are
    integer, allocatable :: slots(:)                !! of elements of cross sections
    real(wp), allocatable :: mass(:)                !! (n_node) lumped masses
    real(wp), allocatable :: penalties(:, :)        !! (3, interfaces) as in others_t
    logical, allocatable :: is_inside(:)            !! as in answers_t
  contains
    procedure :: visit => visit_handed
  end type handed_t

contains

  !> Ranges of tiles with about as many elements each; a process may have none.
  pure function share_out(layout, mine, n) result(shares)
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: mine, n !! number of this process, and how many there are
    type(shares_t) :: shares
    real(wp) :: elements(size(layout%tiles)), before, total
    integer :: firsts(size(layout%tiles) + 1), i, owner, last

    associate (tiles => layout%tiles, n_tile => size(layout%tiles))
      elements = [(real(sum(layout%chunk_elements(tiles(i)%first_chunk:tiles(i)%last_chunk)), wp), &
        i=1, n_tile)]
      total = max(tiny(1.0_wp), sum(elements))
      allocate (shares%tiles(0:n), source=n_tile + 1)
      before = 0.0_wp
      last = -1
      do i = 1, n_tile
        owner = min(n - 1, int(n*((before + 0.5_wp*elements(i))/total)))
        before = before + elements(i)
        shares%tiles(last + 1:owner) = i
        last = max(last, owner)
      end do
      shares%first_tile = shares%tiles(mine)
      shares%last_tile = shares%tiles(mine + 1) - 1
      allocate (shares%chunks(0:n), shares%nodes(0:n), shares%special(0:n), shares%force_slots(0:n))
      firsts = [tiles%first_chunk, tiles(n_tile)%last_chunk + 1]
      shares%chunks(:) = firsts(shares%tiles)
      firsts = [tiles%first_node, tiles(n_tile)%last_node + 1]
      shares%nodes(:) = firsts(shares%tiles)
      firsts = [tiles%first_owned, layout%n_special + 1]
      shares%special(:) = firsts(shares%tiles)
      firsts = [tiles%first_special, tiles(n_tile)%last_special + 1]
      shares%force_slots(:) = firsts(shares%tiles)
    end associate
  end function share_out

  !> Ranges of nodes and slots that other processes have. Nodes inside of rigid bodies stand behind
  !> those of tiles: all move them.
  pure function others_of(model, shares, ranks) result(others)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    type(ranks_t), intent(in) :: ranks
    type(others_t) :: others

    others%nodes = [model%layout%n_special + 1, shares%nodes(ranks%mine) - 1, &
      shares%nodes(ranks%mine + 1), shares%nodes(ranks%n) - 1]
    others%slots = [1, (shares%chunks(ranks%mine) - 1)*chunk_size, &
      (shares%chunks(ranks%mine + 1) - 1)*chunk_size + 1, model%layout%n_slot]
  end function others_of

  !> Behind the start of a process that is not the first: give up what only others need, tiles of
  !> others and their interior nodes.
  subroutine forget_others(model, ranks, state)
    type(model_t), intent(inout) :: model
    type(ranks_t), intent(in) :: ranks
    type(state_t), intent(inout) :: state
    type(forgetter_t) :: forgetters(2)
    integer :: k

    if (ranks%mine == 0 .or. needs_all(model)) return
    deallocate (model%mesh%element_id)
    if (.not. allocated(state%cut_force)) deallocate (model%layout%element_slot)
    forgetters = forgetters_of(others_of(model, share_out(model%layout, ranks%mine, ranks%n), &
      ranks))
    do k = 1, 2
      call model%visit(forgetters(k))
      call state%visit(forgetters(k))
    end do
  end subroutine forget_others

  !> Whether each process looks at all elements during the run.
  pure function needs_all(model) result(needs)
    type(model_t), intent(in) :: model
    logical :: needs

    needs = model%erodes .or. allocated(model%conditions%part_damping) &
      .or. (abs(model%controls%mass_step) > 0.0_wp .and. .not. model%controls%masses_stay)
  end function needs_all

  !> The borders of process `mine`; the sums learn which blocks are its own. One process alone has
  !> none, and moves all special nodes.
  subroutine plan_borders(model, mine, sums, shares)
    type(model_t), intent(in) :: model
    integer, intent(in) :: mine
    type(motion_sums_t), intent(inout) :: sums
    type(shares_t), intent(inout) :: shares
    logical, dimension(model%layout%n_special) :: is_common, is_known, knows
    logical, allocatable :: is_moved(:)
    integer, allocatable :: slots(:)
    integer :: rank, i

    is_known = .true.
    if (size(shares%tiles) > 2) then
      ! All processes know those that anything but elements touches, and nodes without elements.
      call mark_moved_nodes(model, is_moved)
      associate (n => model%layout%n_special, starts => model%layout%node_slots)
        is_common = is_moved .or. starts(2:n + 1) == starts(:n)
      end associate
      call share_blocks(mine, sums, shares)
      is_known = known_nodes(model, shares, sums, mine)
      allocate (shares%common(0), shares%peers(0), shares%out_slots(0), shares%in_slots(0))
      shares%common_starts = [1]
      shares%out_starts = [1]
      shares%in_starts = [1]
      do rank = 0, size(shares%tiles) - 2
        slots = [(i, i=shares%force_slots(rank), shares%force_slots(rank + 1) - 1)]
        associate (nodes => model%layout%special_node(slots))
          shares%common = [shares%common, pack(slots, is_common(nodes))]
          shares%common_starts = [shares%common_starts, size(shares%common) + 1]
          if (rank == mine) cycle
          shares%in_slots = [shares%in_slots, pack(slots, is_known(nodes) &
            .and. .not. is_common(nodes))]
        end associate
        knows = known_nodes(model, shares, sums, rank) .and. .not. is_common
        slots = [(i, i=shares%force_slots(mine), shares%force_slots(mine + 1) - 1)]
        shares%out_slots = [shares%out_slots, pack(slots, &
          knows(model%layout%special_node(slots)))]
        associate (n_out => size(shares%out_slots) + 1, n_in => size(shares%in_slots) + 1, &
          n => size(shares%peers) + 1)
          if (n_out == shares%out_starts(n) .and. n_in == shares%in_starts(n)) cycle
          shares%peers = [shares%peers, rank]
          shares%out_starts = [shares%out_starts, n_out]
          shares%in_starts = [shares%in_starts, n_in]
        end associate
      end do
      is_known = is_known .or. is_common
    end if
    call list_runs(model, is_known, shares)
  end subroutine plan_borders

  !> Special nodes that the tiles of a process touch or that are in blocks that it sums.
  pure function known_nodes(model, shares, sums, rank) result(is_known)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    type(motion_sums_t), intent(in) :: sums
    integer, intent(in) :: rank
    logical :: is_known(model%layout%n_special)

    is_known = .false.
    is_known(model%layout%special_node(shares%force_slots(rank):shares%force_slots(rank + 1) - 1)) &
      = .true.
    if (allocated(sums%blocks)) is_known(shares%block_nodes(rank + 1): &
      shares%block_nodes(rank + 2) - 1) = .true.
  end function known_nodes

  !> A block of special nodes is summed by the process that owns its first node, which has to know
  !> all of it: the sums are those of one process.
  pure subroutine share_blocks(mine, sums, shares)
    integer, intent(in) :: mine
    type(motion_sums_t), intent(inout) :: sums
    type(shares_t), intent(inout) :: shares
    integer :: starts(size(shares%special)), i

    allocate (shares%block_nodes(size(starts)), source=1)
    if (.not. allocated(sums%blocks)) return
    associate (first => sums%blocks(1, :sums%n_special))
      do i = 1, size(starts)
        starts(i) = 1 + count(first < shares%special(i - 1))
        shares%block_nodes(i) = shares%special(size(starts) - 1)
        if (starts(i) <= size(first)) shares%block_nodes(i) = first(starts(i))
      end do
    end associate
    sums%starts = starts
    sums%first = starts(mine + 1)
    sums%last = starts(mine + 2) - 1
  end subroutine share_blocks

  !> Runs of known nodes, none beyond those of one tile.
  pure subroutine list_runs(model, is_known, shares)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_known(:)
    type(shares_t), intent(inout) :: shares
    integer :: owner(0:size(is_known) + 1) !! tile of each known node, else 0
    integer :: i, n

    n = size(is_known)
    owner = 0
    do i = 1, size(model%layout%tiles)
      associate (first => model%layout%tiles(i)%first_owned, &
        last => model%layout%tiles(i)%last_owned)
        owner(first:last) = merge(i, 0, is_known(first:last))
      end associate
    end do
    shares%run_tiles = pack(owner(1:n), owner(1:n) > 0 .and. owner(1:n) /= owner(:n - 1))
    allocate (shares%runs(2, size(shares%run_tiles)))
    shares%runs(1, :) = pack([(i, i=1, n)], owner(1:n) > 0 .and. owner(1:n) /= owner(:n - 1))
    shares%runs(2, :) = pack([(i, i=1, n)], owner(1:n) > 0 .and. owner(1:n) /= owner(2:))
  end subroutine list_runs

  !> Its components.
  subroutine visit_handed(self, visitor)
    class(handed_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('parts', self%parts)
    call visitor%visit('corners', self%corners)
    call visitor%visit('places', self%places)
    call visitor%visit('slots', self%slots)
    call visitor%visit('mass', self%mass, of_nodes)
    call visitor%visit('penalties', self%penalties)
    call visitor%visit('is_inside', self%is_inside)
  end subroutine visit_handed

  !> The model of the first process for all.
  subroutine hand_model(ranks, model, has_all)
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(inout) :: model
    logical, intent(out) :: has_all !! each process gets all of it
    type(packed_buffer_t) :: buffer
    type(shares_t) :: shares
    logical, allocatable :: is_known(:)
    integer :: n_node

    has_all = .true.
    if (ranks%n == 1) return
    call hand(ranks, everyone, buffer, model)
    deallocate (buffer%values)
    ! Where each process looks at the state of all elements at the start, or steps them in dynamic
    ! relaxation.
    has_all = needs_all(model) .or. model%controls%relaxation%is_on &
      .or. abs(model%controls%mass_step) > 0.0_wp &
      .or. any(abs(model%parts%stiffness_damping) > 0.0_wp)
    n_node = model%mesh%n_node
    if (has_all) then
      call hand_range(ranks, everyone, of_nodes, [1, n_node], model)
      call hand_range(ranks, everyone, of_slots, [1, model%layout%n_slot], model)
      call hand_range(ranks, everyone, of_elements, [1, model%mesh%n_element], model)
    else
      shares = share_out(model%layout, ranks%mine, ranks%n)
      call hand_shares(ranks, of_nodes, shares, n_node, model)
      call hand_shares(ranks, of_slots, shares, n_node, model)
      call hand_faces(ranks, model)
    end if
    if (has_all .or. ranks%mine == 0) return
    ! Of fixed degrees of freedom each process keeps those of the nodes that it has.
    associate (nodes => model%conditions%fixed_nodes, starts => shares%nodes)
      is_known = nodes <= model%layout%n_special .or. nodes >= starts(ranks%n) &
        .or. (nodes >= starts(ranks%mine) .and. nodes < starts(ranks%mine + 1))
    end associate
    model%conditions%fixed_directions = pack(model%conditions%fixed_directions, is_known)
    model%conditions%fixed_nodes = pack(model%conditions%fixed_nodes, is_known)
  end subroutine hand_model

  !> Single elements that all have to know: those behind contact surfaces with their nodes, and
  !> where those of cross sections stand.
  subroutine hand_faces(ranks, model)
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(inout) :: model
    type(handed_t) :: handed
    type(packed_buffer_t) :: buffer
    integer, allocatable :: elements(:), cut(:)
    integer :: i, k

    allocate (elements(0), cut(0))
    do i = 1, size(model%contacts)
      elements = [elements, model%contacts(i)%slave%segment_element, &
        model%contacts(i)%master%segment_element]
    end do
    if (allocated(model%controls%output%cross_sections)) then
      do i = 1, size(model%controls%output%cross_sections)
        cut = [cut, model%controls%output%cross_sections(i)%elements]
      end do
    end if
    associate (mesh => model%mesh, layout => model%layout)
      if (ranks%mine == 0) then
        handed%parts = mesh%element_part(elements)
        handed%corners = mesh%element_nodes(:, elements)
        handed%places = mesh%coordinates(:, [handed%corners])
        handed%slots = layout%element_slot(cut)
      end if
      call hand(ranks, everyone, buffer, handed)
      if (ranks%mine == 0) return
      do i = 1, size(elements)
        mesh%element_part(elements(i)) = handed%parts(i)
        mesh%element_nodes(:, elements(i)) = handed%corners(:, i)
        do k = 1, 4
          mesh%coordinates(:, handed%corners(k, i)) = handed%places(:, 4*(i - 1) + k)
        end do
      end do
      do i = 1, size(cut)
        layout%element_slot(cut(i)) = handed%slots(i)
      end do
    end associate
  end subroutine hand_faces

  !> What a process that starts its own share alone has to know of the state of the first one.
  subroutine hand_others(model, ranks, state, others, answers)
    type(model_t), intent(in) :: model
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state              !! of the first process
    type(others_t), allocatable, intent(out) :: others !! left alone
    type(answers_t), allocatable, intent(inout) :: answers !! to the first process; then from it
    type(packed_buffer_t) :: buffer
    type(handed_t) :: handed
    type(shares_t) :: shares
    integer :: i

    if (ranks%mine == 0) then
      call move_alloc(state%mass, handed%mass)
      handed%penalties = reshape([(state%contacts(i)%slave_penalty, &
        state%contacts(i)%master_penalty, state%contacts(i)%node_penalty, &
        i=1, size(state%contacts))], [3, size(state%contacts)])
      if (allocated(answers%is_inside)) handed%is_inside = answers%is_inside
    end if
    call hand(ranks, everyone, buffer, handed)
    shares = share_out(model%layout, ranks%mine, ranks%n)
    call hand_shares(ranks, of_nodes, shares, model%mesh%n_node, handed)
    if (ranks%mine == 0) then
      call move_alloc(handed%mass, state%mass)
      return
    end if
    allocate (others, source=others_of(model, shares, ranks))
    call move_alloc(handed%mass, others%mass)
    call move_alloc(handed%penalties, others%penalties)
    allocate (answers)
    answers%are_given = .true.
    if (allocated(handed%is_inside)) call move_alloc(handed%is_inside, answers%is_inside)
  end subroutine hand_others

  !> What all have to know, and then to each process what is of its tiles. Nodes inside of rigid
  !> bodies stand behind those of tiles: all move them.
  subroutine hand_shares(ranks, of, shares, n_node, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: of         !! of_nodes or of_slots
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: n_node     !! of the mesh
    class(visited_t), intent(inout) :: item
    integer :: starts(0:ranks%n), rank

    starts = shares%nodes
    if (of == of_slots) then
      starts = (shares%chunks - 1)*chunk_size + 1
    else
      call hand_range(ranks, everyone, of, [1, starts(0) - 1], item)
      call hand_range(ranks, everyone, of, [starts(ranks%n), n_node], item)
    end if
    do rank = 1, ranks%n - 1
      call hand_range(ranks, rank, of, [starts(rank), starts(rank + 1) - 1], item)
    end do
  end subroutine hand_shares

  !> A range of what an item has, piece by piece.
  subroutine hand_range(ranks, receiver, of, range, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver   !! `everyone` or one of the others
    integer, intent(in) :: of         !! one of the `of_` constants
    integer, intent(in) :: range(2)
    class(visited_t), intent(inout) :: item
    type(packed_buffer_t) :: buffer
    integer :: first

    do first = range(1), range(2), most_items
      buffer = part_of(of, [first, min(range(2), first + most_items - 1)])
      call hand(ranks, receiver, buffer, item)
    end do
  end subroutine hand_range

end module rank_shares_m
