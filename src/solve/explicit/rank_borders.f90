! SPDX-License-Identifier: MIT
!> What a process has to know of special nodes. Those that contact, loads, walls or rigid bodies
!> touch are computed by all processes, which all hear of them. The others lie between tiles: only
!> the processes whose tiles touch them sum and move them, and these hear each other's forces on
!> them. To the others such a node is what an interior node of another process is.
module rank_borders_m
  use model_m, only : model_t
  use motion_sums_m, only : motion_sums_t
  use rank_shares_m, only : shares_t
  use renumber_m, only : mark_moved_nodes
  implicit none
  private
  public :: borders_t, plan_borders, plan_whole

  !> Force slots that are exchanged, and who moves which nodes.
  type :: borders_t
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
  end type borders_t

  !> Pairs of a process and a force slot that it needs or has.
  type :: pairs_t
    integer :: n = 0
    integer, allocatable :: rank(:), slot(:)
  end type pairs_t

contains

  !> One process moves all special nodes, tile by tile.
  pure subroutine plan_whole(model, borders)
    type(model_t), intent(in) :: model
    type(borders_t), intent(out) :: borders
    integer :: i

    allocate (borders%runs(2, size(model%layout%tiles)))
    do i = 1, size(model%layout%tiles)
      borders%runs(:, i) = [model%layout%tiles(i)%first_owned, model%layout%tiles(i)%last_owned]
    end do
    allocate (borders%run_tiles(size(model%layout%tiles)), &
      source=[(i, i = 1, size(model%layout%tiles))])
  end subroutine plan_whole

  !> The borders of process `mine`; the sums learn which blocks are its own.
  subroutine plan_borders(model, shares, mine, sums, borders)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: mine
    type(motion_sums_t), intent(inout) :: sums
    type(borders_t), intent(out) :: borders
    logical, allocatable :: is_common(:), is_known(:)
    integer, allocatable :: slot_rank(:)
    type(pairs_t) :: out, in
    integer :: i

    call mark_common(model, is_common)
    call find_slot_ranks(shares, size(model%layout%special_node), slot_rank)
    call share_blocks(shares, mine, sums, borders%block_nodes)
    allocate (is_known, source=is_common)
    if (allocated(sums%blocks)) is_known(borders%block_nodes(mine + 1): &
      borders%block_nodes(mine + 2) - 1) = .true.
    do i = shares%force_slots(mine), shares%force_slots(mine + 1) - 1
      is_known(model%layout%special_node(i)) = .true.
    end do
    call list_common(model%layout%special_node, is_common, shares%force_slots, borders)
    call list_needs(model, is_common, slot_rank, mine, borders%block_nodes, out)
    call list_slots(model%layout%special_node, is_known .and. .not. is_common, slot_rank, mine, in)
    call sort_by_peer(size(shares%tiles) - 1, out, in, borders)
    call list_runs(model, is_known, borders)
  end subroutine plan_borders

  !> Special nodes that all processes know: those that anything but elements touches.
  subroutine mark_common(model, is_common)
    type(model_t), intent(in) :: model
    logical, allocatable, intent(out) :: is_common(:) !! (n_special)

    associate (n => model%layout%n_special, starts => model%layout%node_slots)
      call mark_moved_nodes(model, is_common)
      ! Nodes without elements.
      is_common = is_common .or. starts(2:n + 1) == starts(:n)
    end associate
  end subroutine mark_common

  !> The process that has each force slot.
  pure subroutine find_slot_ranks(shares, n_slot, slot_rank)
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: n_slot
    integer, allocatable, intent(out) :: slot_rank(:)
    integer :: rank

    allocate (slot_rank(n_slot))
    do rank = 0, ubound(shares%tiles, 1) - 1
      slot_rank(shares%force_slots(rank):shares%force_slots(rank + 1) - 1) = rank
    end do
  end subroutine find_slot_ranks

  !> A block of special nodes is summed by the process that owns its first node, which has to know
  !> all of it: the sums are those of one process.
  pure subroutine share_blocks(shares, mine, sums, block_nodes)
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: mine
    type(motion_sums_t), intent(inout) :: sums
    integer, allocatable, intent(out) :: block_nodes(:)
    integer :: starts(size(shares%special)), i

    allocate (block_nodes(size(starts)), source=1)
    if (.not. allocated(sums%blocks)) return
    associate (first => sums%blocks(1, :sums%n_special))
      do i = 1, size(starts)
        starts(i) = 1 + count(first < shares%special(i - 1))
        block_nodes(i) = shares%special(size(starts) - 1)
        if (starts(i) <= size(first)) block_nodes(i) = first(starts(i))
      end do
    end associate
    sums%starts = starts
    sums%first = starts(mine + 1)
    sums%last = starts(mine + 2) - 1
  end subroutine share_blocks

  !> Force slots on nodes that all know.
  pure subroutine list_common(nodes, is_common, slot_starts, borders)
    integer, intent(in) :: nodes(:)        !! of the force slots
    logical, intent(in) :: is_common(:)
    integer, intent(in) :: slot_starts(0:) !! of the processes
    type(borders_t), intent(inout) :: borders
    integer :: rank, slot, n

    allocate (borders%common_starts(size(slot_starts)), source=1)
    allocate (borders%common(count(is_common(nodes))))
    n = 0
    do rank = 0, size(slot_starts) - 2
      do slot = slot_starts(rank), slot_starts(rank + 1) - 1
        if (.not. is_common(nodes(slot))) cycle
        n = n + 1
        borders%common(n) = slot
      end do
      borders%common_starts(rank + 2) = n + 1
    end do
  end subroutine list_common

  !> Which others need which force slots of this process: those that touch the node too, and the one
  !> that sums its block.
  pure subroutine list_needs(model, is_common, slot_rank, mine, block_nodes, pairs)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_common(:)
    integer, intent(in) :: slot_rank(:)
    integer, intent(in) :: mine
    integer, intent(in) :: block_nodes(:)
    type(pairs_t), intent(out) :: pairs
    integer :: slot, node, i, last, summing

    do slot = 1, size(slot_rank)
      if (slot_rank(slot) /= mine) cycle
      node = model%layout%special_node(slot)
      if (is_common(node)) cycle
      summing = count(block_nodes <= node) - 1
      last = mine
      associate (slots => model%layout%slot_list(model%layout%node_slots(node): &
        model%layout%node_slots(node + 1) - 1))
        do i = 1, size(slots)
          associate (rank => slot_rank(slots(i)))
            ! Slots rise, and so do their processes.
            if (rank == mine .or. rank == last) cycle
            last = rank
            call add_pair(rank, slot, pairs)
          end associate
        end do
        if (summing < size(block_nodes) - 1 .and. all(slot_rank(slots) /= summing)) &
          call add_pair(summing, slot, pairs)
      end associate
    end do
  end subroutine list_needs

  !> Force slots of others on the nodes that are needed.
  pure subroutine list_slots(nodes, is_needed, slot_rank, mine, pairs)
    integer, intent(in) :: nodes(:)
    logical, intent(in) :: is_needed(:)
    integer, intent(in) :: slot_rank(:)
    integer, intent(in) :: mine
    type(pairs_t), intent(out) :: pairs
    integer :: slot

    do slot = 1, size(slot_rank)
      if (slot_rank(slot) /= mine .and. is_needed(nodes(slot))) &
        call add_pair(slot_rank(slot), slot, pairs)
    end do
  end subroutine list_slots

  !> One more pair; room is doubled.
  pure subroutine add_pair(rank, slot, pairs)
    integer, intent(in) :: rank, slot
    type(pairs_t), intent(inout) :: pairs
    integer, allocatable :: more(:)

    if (.not. allocated(pairs%rank)) allocate (pairs%rank(64), pairs%slot(64), source=0)
    if (pairs%n == size(pairs%rank)) then
      allocate (more(2*pairs%n), source=0)
      more(:pairs%n) = pairs%rank
      call move_alloc(more, pairs%rank)
      allocate (more(2*pairs%n), source=0)
      more(:pairs%n) = pairs%slot
      call move_alloc(more, pairs%slot)
    end if
    pairs%n = pairs%n + 1
    pairs%rank(pairs%n) = rank
    pairs%slot(pairs%n) = slot
  end subroutine add_pair

  !> Lists of slots peer by peer, in rising order on both sides.
  pure subroutine sort_by_peer(n_rank, out, in, borders)
    integer, intent(in) :: n_rank
    type(pairs_t), intent(in) :: out, in
    type(borders_t), intent(inout) :: borders
    integer :: counts(0:n_rank - 1, 2), i

    counts = 0
    do i = 1, out%n
      counts(out%rank(i), 1) = counts(out%rank(i), 1) + 1
    end do
    do i = 1, in%n
      counts(in%rank(i), 2) = counts(in%rank(i), 2) + 1
    end do
    borders%peers = pack([(i, i=0, n_rank - 1)], sum(counts, 2) > 0)
    call lay_out(counts(:, 1), out, borders%peers, borders%out_starts, borders%out_slots)
    call lay_out(counts(:, 2), in, borders%peers, borders%in_starts, borders%in_slots)
  end subroutine sort_by_peer

  !> The slots of pairs by peer.
  pure subroutine lay_out(counts, pairs, peers, starts, slots)
    integer, intent(in) :: counts(0:)  !! pairs of each process
    type(pairs_t), intent(in) :: pairs
    integer, intent(in) :: peers(:)
    integer, allocatable, intent(out) :: starts(:), slots(:)
    integer :: next(0:size(counts) - 1), i

    allocate (starts(size(peers) + 1), source=1)
    allocate (slots(pairs%n))
    next = 0
    do i = 1, size(peers)
      next(peers(i)) = starts(i)
      starts(i + 1) = starts(i) + counts(peers(i))
    end do
    do i = 1, pairs%n
      slots(next(pairs%rank(i))) = pairs%slot(i)
      next(pairs%rank(i)) = next(pairs%rank(i)) + 1
    end do
  end subroutine lay_out

  !> Runs of known nodes, none beyond those of one tile.
  pure subroutine list_runs(model, is_known, borders)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_known(:)
    type(borders_t), intent(inout) :: borders
    logical :: begins, ends
    integer :: pass, n, i, node

    do pass = 1, 2
      n = 0
      do i = 1, size(model%layout%tiles)
        associate (tile => model%layout%tiles(i))
          do node = tile%first_owned, tile%last_owned
            if (.not. is_known(node)) cycle
            begins = node == tile%first_owned
            if (.not. begins) begins = .not. is_known(node - 1)
            ends = node == tile%last_owned
            if (.not. ends) ends = .not. is_known(node + 1)
            if (begins) n = n + 1
            if (pass == 1) cycle
            borders%run_tiles(n) = i
            if (begins) borders%runs(1, n) = node
            if (ends) borders%runs(2, n) = node
          end do
        end associate
      end do
      if (pass == 1) allocate (borders%runs(2, n), borders%run_tiles(n))
    end do
  end subroutine list_runs

end module rank_borders_m
