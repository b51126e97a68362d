! SPDX-License-Identifier: MIT
!> Partition of the tiles among processes, with their chunks, nodes and force slots, all contiguous
!> by tile. Each process stores the special nodes and the nodes and elements of its own tiles; the
!> first process stores all, since it writes the files. Arrays have the length of the mesh, so that
!> numbers mean the same everywhere; memory of remote parts is never touched. Special nodes of
!> contact, loads, walls and rigid bodies are computed by all processes. Other special nodes are
!> summed and moved by the processes whose tiles touch them, which exchange forces. The first
!> process has read and renumbered the model and distributes it.
module rank_partition_m
  use buffer_transfer_m, only : send_item, all_ranks
  use kinds_m, only : wp
  use layout_m, only : layout_t, chunk_size
  use load_work_m, only : motion_sums_t
  use model_m, only : model_t
  use remote_state_m, only : remote_t, remote_releases, inside_tests_t
  use packed_buffer_m, only : memory_release_t, packed_buffer_t, part_of
  use ranks_m, only : ranks_t
  use renumber_m, only : mark_moved_nodes
  use state_m, only : state_t
  use visitor_m, only : visited_t, visitor_t, of_elements, of_nodes, of_slots
  implicit none
  private
  public :: partition_t, partition_tiles, release_remote, plan_borders, distribute_model, &
    distribute_start

  !> Ranges of each process; the first arrays (0:n): start of each range, then one beyond the last.
  type :: partition_t
    integer, allocatable :: tiles(:), chunks(:)
    integer, allocatable :: nodes(:)       !! interior nodes
    integer, allocatable :: special(:)     !! special nodes owned by its tiles
    integer, allocatable :: force_slots(:)
    integer :: first_tile = 1, last_tile = 0 !! of this process
    ! Borders: force slots that are exchanged, and who moves which nodes.
    integer, allocatable :: runs(:, :)       !! (2, n) special nodes that this process sums and
                                             !! moves: first and last of each run
    integer, allocatable :: run_tiles(:)     !! (n) tile that owns the nodes of each run
    integer, allocatable :: common(:)        !! force slots on nodes that all processes know, by
                                             !! process
    integer, allocatable :: common_starts(:) !! (n + 1) start of those of each process
    integer, allocatable :: peers(:)         !! processes with shared borders
    integer, allocatable :: out_starts(:), in_starts(:) !! (peers + 1)
    integer, allocatable :: out_slots(:)     !! own force slots that each peer needs
    integer, allocatable :: in_slots(:)      !! force slots of each peer that this process needs
    integer, allocatable :: block_nodes(:)   !! (n + 1) start of the special nodes that each process
                                             !! sums
  end type partition_t

  !> Largest number of items in one message.
  integer, parameter :: most_items = 65536

  !> Data for the start of the other processes, besides the model.
  type, extends(visited_t) :: start_data_t
    integer, allocatable :: parts(:)                !! of elements at contact surfaces
    integer, allocatable :: corners(:, :)           !! (4, elements) their nodes
    real(wp), allocatable :: positions(:, :)           !! (2, 4 elements) positions of these
    integer, allocatable :: slots(:)                !! of elements of cross sections
    real(wp), allocatable :: mass(:)                !! (n_node) lumped masses
    real(wp), allocatable :: penalties(:, :)        !! (3, interfaces) as in remote_t
    logical, allocatable :: is_inside(:)            !! as in inside_tests_t
  contains
    procedure :: visit => visit_start_data
  end type start_data_t

contains

  !> Divide the tiles into ranges with about equal numbers of elements; a process may have none.
  pure function partition_tiles(layout, mine, n) result(partition)
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: mine, n !! number of this process, and number of processes
    type(partition_t) :: partition
    real(wp) :: elements(size(layout%tiles)), before, total
    integer :: firsts(size(layout%tiles) + 1), i, owner, last

    associate (tiles => layout%tiles, n_tile => size(layout%tiles))
      elements = [(real(sum(layout%chunk_elements(tiles(i)%first_chunk:tiles(i)%last_chunk)), wp), &
        i=1, n_tile)]
      total = max(tiny(1.0_wp), sum(elements))
      allocate (partition%tiles(0:n), source=n_tile + 1)
      before = 0.0_wp
      last = -1
      do i = 1, n_tile
        owner = min(n - 1, int(n*((before + 0.5_wp*elements(i))/total)))
        before = before + elements(i)
        partition%tiles(last + 1:owner) = i
        last = max(last, owner)
      end do
      partition%first_tile = partition%tiles(mine)
      partition%last_tile = partition%tiles(mine + 1) - 1
      allocate (partition%chunks(0:n), partition%nodes(0:n), partition%special(0:n), &
        partition%force_slots(0:n))
      firsts = [tiles%first_chunk, tiles(n_tile)%last_chunk + 1]
      partition%chunks(:) = firsts(partition%tiles)
      firsts = [tiles%first_node, tiles(n_tile)%last_node + 1]
      partition%nodes(:) = firsts(partition%tiles)
      firsts = [tiles%first_owned, layout%n_special + 1]
      partition%special(:) = firsts(partition%tiles)
      firsts = [tiles%first_special, tiles(n_tile)%last_special + 1]
      partition%force_slots(:) = firsts(partition%tiles)
    end associate
  end function partition_tiles

  !> Ranges of nodes and slots of other processes. Nodes inside rigid bodies follow those of tiles:
  !> all processes move them.
  pure function remote_of(model, partition, ranks) result(remote)
    type(model_t), intent(in) :: model
    type(partition_t), intent(in) :: partition
    type(ranks_t), intent(in) :: ranks
    type(remote_t) :: remote

    remote%nodes = [model%layout%n_special + 1, partition%nodes(ranks%mine) - 1, &
      partition%nodes(ranks%mine + 1), partition%nodes(ranks%n) - 1]
    remote%slots = [1, (partition%chunks(ranks%mine) - 1)*chunk_size, &
      (partition%chunks(ranks%mine + 1) - 1)*chunk_size + 1, model%layout%n_slot]
  end function remote_of

  !> Release the memory of remote tiles and their interior nodes after the start, except in the
  !> first process.
  subroutine release_remote(model, ranks, state)
    type(model_t), intent(inout) :: model
    type(ranks_t), intent(in) :: ranks
    type(state_t), intent(inout) :: state
    type(memory_release_t) :: releases(2)
    integer :: k

    if (ranks%mine == 0 .or. needs_all(model)) return
    deallocate (model%mesh%element_id)
    if (.not. allocated(state%cut_force)) deallocate (model%layout%element_slot)
    releases = remote_releases(remote_of(model, partition_tiles(model%layout, ranks%mine, &
      ranks%n), ranks))
    do k = 1, 2
      call model%visit(releases(k))
      call state%visit(releases(k))
    end do
  end subroutine release_remote

  !> Whether each process needs all elements during the run.
  pure function needs_all(model) result(needs)
    type(model_t), intent(in) :: model
    logical :: needs

    needs = model%erodes .or. allocated(model%conditions%part_damping) &
      .or. (abs(model%controls%mass_step) > 0.0_wp .and. .not. model%controls%masses_stay)
  end function needs_all

  !> Plan the borders of process `mine` and its blocks of the sums. A single process has no borders
  !> and moves all special nodes.
  subroutine plan_borders(model, mine, sums, partition)
    type(model_t), intent(in) :: model
    integer, intent(in) :: mine
    type(motion_sums_t), intent(inout) :: sums
    type(partition_t), intent(inout) :: partition
    logical, dimension(model%layout%n_special) :: is_common, is_known, is_known_there
    logical, allocatable :: is_moved(:)
    integer, allocatable :: slots(:)
    integer :: rank, i

    is_known = .true.
    if (size(partition%tiles) > 2) then
      ! All processes know nodes with other forces than those of elements, and nodes without
      ! elements.
      call mark_moved_nodes(model, is_moved)
      associate (n => model%layout%n_special, starts => model%layout%node_slots)
        is_common = is_moved .or. starts(2:n + 1) == starts(:n)
      end associate
      call assign_blocks(mine, sums, partition)
      is_known = known_nodes(model, partition, sums, mine)
      allocate (partition%common(0), partition%peers(0), partition%out_slots(0), &
        partition%in_slots(0))
      partition%common_starts = [1]
      partition%out_starts = [1]
      partition%in_starts = [1]
      do rank = 0, size(partition%tiles) - 2
        slots = [(i, i=partition%force_slots(rank), partition%force_slots(rank + 1) - 1)]
        associate (nodes => model%layout%special_node(slots))
          partition%common = [partition%common, pack(slots, is_common(nodes))]
          partition%common_starts = [partition%common_starts, size(partition%common) + 1]
          if (rank == mine) cycle
          partition%in_slots = [partition%in_slots, pack(slots, is_known(nodes) &
            .and. .not. is_common(nodes))]
        end associate
        is_known_there = known_nodes(model, partition, sums, rank) .and. .not. is_common
        slots = [(i, i=partition%force_slots(mine), partition%force_slots(mine + 1) - 1)]
        partition%out_slots = [partition%out_slots, pack(slots, &
          is_known_there(model%layout%special_node(slots)))]
        associate (n_out => size(partition%out_slots) + 1, n_in => size(partition%in_slots) + 1, &
          n => size(partition%peers) + 1)
          if (n_out == partition%out_starts(n) .and. n_in == partition%in_starts(n)) cycle
          partition%peers = [partition%peers, rank]
          partition%out_starts = [partition%out_starts, n_out]
          partition%in_starts = [partition%in_starts, n_in]
        end associate
      end do
      is_known = is_known .or. is_common
    end if
    call list_runs(model, is_known, partition)
  end subroutine plan_borders

  !> Special nodes that the tiles of a process touch or that are in blocks that it sums.
  pure function known_nodes(model, partition, sums, rank) result(is_known)
    type(model_t), intent(in) :: model
    type(partition_t), intent(in) :: partition
    type(motion_sums_t), intent(in) :: sums
    integer, intent(in) :: rank
    logical :: is_known(model%layout%n_special)

    is_known = .false.
    is_known(model%layout%special_node(partition%force_slots(rank):partition%force_slots(rank + 1) &
      - 1)) = .true.
    if (allocated(sums%blocks)) is_known(partition%block_nodes(rank + 1): &
      partition%block_nodes(rank + 2) - 1) = .true.
  end function known_nodes

  !> Assign each block of special nodes to the process that owns its first node, which then knows
  !> all nodes of the block: the sums equal those of a single process.
  pure subroutine assign_blocks(mine, sums, partition)
    integer, intent(in) :: mine
    type(motion_sums_t), intent(inout) :: sums
    type(partition_t), intent(inout) :: partition
    integer :: starts(size(partition%special)), i

    allocate (partition%block_nodes(size(starts)), source=1)
    if (.not. allocated(sums%blocks)) return
    associate (first => sums%blocks(1, :sums%n_special))
      do i = 1, size(starts)
        starts(i) = 1 + count(first < partition%special(i - 1))
        partition%block_nodes(i) = partition%special(size(starts) - 1)
        if (starts(i) <= size(first)) partition%block_nodes(i) = first(starts(i))
      end do
    end associate
    sums%starts = starts
    sums%first = starts(mine + 1)
    sums%last = starts(mine + 2) - 1
  end subroutine assign_blocks

  !> List the runs of known nodes, each within the nodes of one tile.
  pure subroutine list_runs(model, is_known, partition)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_known(:)
    type(partition_t), intent(inout) :: partition
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
    partition%run_tiles = pack(owner(1:n), owner(1:n) > 0 .and. owner(1:n) /= owner(:n - 1))
    allocate (partition%runs(2, size(partition%run_tiles)))
    partition%runs(1, :) = pack([(i, i=1, n)], owner(1:n) > 0 .and. owner(1:n) /= owner(:n - 1))
    partition%runs(2, :) = pack([(i, i=1, n)], owner(1:n) > 0 .and. owner(1:n) /= owner(2:))
  end subroutine list_runs

  !> Visit the components.
  subroutine visit_start_data(self, visitor)
    class(start_data_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('parts', self%parts)
    call visitor%visit('corners', self%corners)
    call visitor%visit('positions', self%positions)
    call visitor%visit('slots', self%slots)
    call visitor%visit('mass', self%mass, of_nodes)
    call visitor%visit('penalties', self%penalties)
    call visitor%visit('is_inside', self%is_inside)
  end subroutine visit_start_data

  !> Distribute the model of the first process.
  subroutine distribute_model(ranks, model, has_all)
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(inout) :: model
    logical, intent(out) :: has_all !! each process gets all of it
    type(packed_buffer_t) :: buffer
    type(partition_t) :: partition
    logical, allocatable :: is_known(:)
    integer :: n_node

    has_all = .true.
    if (ranks%n == 1) return
    call send_item(ranks, all_ranks, buffer, model)
    deallocate (buffer%values)
    ! Each process needs all elements at the start for mass scaling, stiffness damping or dynamic
    ! relaxation.
    has_all = needs_all(model) .or. model%controls%relaxation%is_on &
      .or. abs(model%controls%mass_step) > 0.0_wp &
      .or. any(abs(model%parts%stiffness_damping) > 0.0_wp)
    n_node = model%mesh%n_node
    if (has_all) then
      call send_range(ranks, all_ranks, of_nodes, [1, n_node], model)
      call send_range(ranks, all_ranks, of_slots, [1, model%layout%n_slot], model)
      call send_range(ranks, all_ranks, of_elements, [1, model%mesh%n_element], model)
    else
      partition = partition_tiles(model%layout, ranks%mine, ranks%n)
      call distribute_partition(ranks, of_nodes, partition, n_node, model)
      call distribute_partition(ranks, of_slots, partition, n_node, model)
      call broadcast_faces(ranks, model)
    end if
    if (has_all .or. ranks%mine == 0) return
    ! Each process keeps the fixed degrees of freedom of its own nodes.
    associate (nodes => model%conditions%fixed_nodes, starts => partition%nodes)
      is_known = nodes <= model%layout%n_special .or. nodes >= starts(ranks%n) &
        .or. (nodes >= starts(ranks%mine) .and. nodes < starts(ranks%mine + 1))
    end associate
    model%conditions%fixed_directions = pack(model%conditions%fixed_directions, is_known)
    model%conditions%fixed_nodes = pack(model%conditions%fixed_nodes, is_known)
  end subroutine distribute_model

  !> Broadcast single elements that all processes need: those at contact surfaces with their nodes,
  !> and the slots of those in cross sections.
  subroutine broadcast_faces(ranks, model)
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(inout) :: model
    type(start_data_t) :: item
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
        item%parts = mesh%element_part(elements)
        item%corners = mesh%element_nodes(:, elements)
        item%positions = mesh%coordinates(:, [item%corners])
        item%slots = layout%element_slot(cut)
      end if
      call send_item(ranks, all_ranks, buffer, item)
      if (ranks%mine == 0) return
      do i = 1, size(elements)
        mesh%element_part(elements(i)) = item%parts(i)
        mesh%element_nodes(:, elements(i)) = item%corners(:, i)
        do k = 1, 4
          mesh%coordinates(:, item%corners(k, i)) = item%positions(:, 4*(i - 1) + k)
        end do
      end do
      do i = 1, size(cut)
        layout%element_slot(cut(i)) = item%slots(i)
      end do
    end associate
  end subroutine broadcast_faces

  !> Distribute the data that other processes need to start their own part of the state.
  subroutine distribute_start(model, ranks, state, remote, inside_tests)
    type(model_t), intent(in) :: model
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state              !! of the first process
    type(remote_t), allocatable, intent(out) :: remote !! not allocated in the first process
    type(inside_tests_t), allocatable, intent(inout) :: inside_tests !! in the first process in, in
                                                                     !! the others out
    type(packed_buffer_t) :: buffer
    type(start_data_t) :: item
    type(partition_t) :: partition
    integer :: i

    if (ranks%mine == 0) then
      call move_alloc(state%mass, item%mass)
      item%penalties = reshape([(state%contacts(i)%slave_penalty, &
        state%contacts(i)%master_penalty, state%contacts(i)%node_penalty, &
        i=1, size(state%contacts))], [3, size(state%contacts)])
      if (allocated(inside_tests%is_inside)) item%is_inside = inside_tests%is_inside
    end if
    call send_item(ranks, all_ranks, buffer, item)
    partition = partition_tiles(model%layout, ranks%mine, ranks%n)
    call distribute_partition(ranks, of_nodes, partition, model%mesh%n_node, item)
    if (ranks%mine == 0) then
      call move_alloc(item%mass, state%mass)
      return
    end if
    allocate (remote, source=remote_of(model, partition, ranks))
    call move_alloc(item%mass, remote%mass)
    call move_alloc(item%penalties, remote%penalties)
    allocate (inside_tests)
    inside_tests%are_given = .true.
    if (allocated(item%is_inside)) call move_alloc(item%is_inside, inside_tests%is_inside)
  end subroutine distribute_start

  !> Broadcast the data that all processes need, then send each process the data of its tiles. Nodes
  !> inside rigid bodies follow those of tiles: all processes move them.
  subroutine distribute_partition(ranks, of, partition, n_node, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: of         !! of_nodes or of_slots
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: n_node     !! of the mesh
    class(visited_t), intent(inout) :: item
    integer :: starts(0:ranks%n), rank

    starts = partition%nodes
    if (of == of_slots) then
      starts = (partition%chunks - 1)*chunk_size + 1
    else
      call send_range(ranks, all_ranks, of, [1, starts(0) - 1], item)
      call send_range(ranks, all_ranks, of, [starts(ranks%n), n_node], item)
    end if
    do rank = 1, ranks%n - 1
      call send_range(ranks, rank, of, [starts(rank), starts(rank + 1) - 1], item)
    end do
  end subroutine distribute_partition

  !> Send a range of an item in messages of limited size.
  subroutine send_range(ranks, receiver, of, range, item)
    type(ranks_t), intent(inout) :: ranks
    integer, intent(in) :: receiver   !! `all_ranks` or the number of one process
    integer, intent(in) :: of         !! one of the `of_` constants
    integer, intent(in) :: range(2)
    class(visited_t), intent(inout) :: item
    type(packed_buffer_t) :: buffer
    integer :: first

    do first = range(1), range(2), most_items
      buffer = part_of(of, [first, min(range(2), first + most_items - 1)])
      call send_item(ranks, receiver, buffer, item)
    end do
  end subroutine send_range

end module rank_partition_m
