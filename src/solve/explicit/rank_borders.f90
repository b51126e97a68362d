! SPDX-License-Identifier: MIT
!> What a process has to know of special nodes. Those that contact, loads, walls or rigid bodies
!> touch are computed by all processes, which all hear of them. The others lie between tiles: only
!> the processes whose tiles touch them sum and move them, and these hear each other's forces on
!> them. To the others such a node is what an interior node of another process is.
module rank_borders_m
  use model_m, only : model_t
  use load_work_m, only : motion_sums_t
  use rank_shares_m, only : shares_t
  use renumber_m, only : mark_moved_nodes
  implicit none
  private
  public :: borders_t, plan_borders

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

contains

  !> The borders of process `mine`; the sums learn which blocks are its own. One process alone has
  !> none, and moves all special nodes.
  subroutine plan_borders(model, shares, mine, sums, borders)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: mine
    type(motion_sums_t), intent(inout) :: sums
    type(borders_t), intent(out) :: borders
    logical, dimension(model%layout%n_special) :: is_common, is_known, knows
    integer, allocatable :: slots(:)
    integer :: rank, i

    is_known = .true.
    if (size(shares%tiles) > 2) then
      call mark_common(model, is_common)
      call share_blocks(shares, mine, sums, borders%block_nodes)
      is_known = known_nodes(model, shares, sums, borders, mine)
      allocate (borders%common(0), borders%peers(0), borders%out_slots(0), borders%in_slots(0))
      borders%common_starts = [1]
      borders%out_starts = [1]
      borders%in_starts = [1]
      do rank = 0, size(shares%tiles) - 2
        slots = [(i, i=shares%force_slots(rank), shares%force_slots(rank + 1) - 1)]
        associate (nodes => model%layout%special_node(slots))
          borders%common = [borders%common, pack(slots, is_common(nodes))]
          borders%common_starts = [borders%common_starts, size(borders%common) + 1]
          if (rank == mine) cycle
          borders%in_slots = [borders%in_slots, pack(slots, is_known(nodes) &
            .and. .not. is_common(nodes))]
        end associate
        knows = known_nodes(model, shares, sums, borders, rank) .and. .not. is_common
        slots = [(i, i=shares%force_slots(mine), shares%force_slots(mine + 1) - 1)]
        borders%out_slots = [borders%out_slots, pack(slots, &
          knows(model%layout%special_node(slots)))]
        associate (n_out => size(borders%out_slots) + 1, n_in => size(borders%in_slots) + 1, &
          n => size(borders%peers) + 1)
          if (n_out == borders%out_starts(n) .and. n_in == borders%in_starts(n)) cycle
          borders%peers = [borders%peers, rank]
          borders%out_starts = [borders%out_starts, n_out]
          borders%in_starts = [borders%in_starts, n_in]
        end associate
      end do
      is_known = is_known .or. is_common
    end if
    call list_runs(model, is_known, borders)
  end subroutine plan_borders

  !> Special nodes that all processes know: those that anything but elements touches, and nodes
  !> without elements.
  subroutine mark_common(model, is_common)
    type(model_t), intent(in) :: model
    logical, intent(out) :: is_common(:) !! (n_special)
    logical, allocatable :: is_moved(:)

    associate (n => model%layout%n_special, starts => model%layout%node_slots)
      call mark_moved_nodes(model, is_moved)
      is_common = is_moved .or. starts(2:n + 1) == starts(:n)
    end associate
  end subroutine mark_common

  !> Special nodes that the tiles of a process touch or that are in blocks that it sums.
  pure function known_nodes(model, shares, sums, borders, rank) result(is_known)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    type(motion_sums_t), intent(in) :: sums
    type(borders_t), intent(in) :: borders
    integer, intent(in) :: rank
    logical :: is_known(model%layout%n_special)

    is_known = .false.
    is_known(model%layout%special_node(shares%force_slots(rank):shares%force_slots(rank + 1) - 1)) &
      = .true.
    if (allocated(sums%blocks)) is_known(borders%block_nodes(rank + 1): &
      borders%block_nodes(rank + 2) - 1) = .true.
  end function known_nodes

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

  !> Runs of known nodes, none beyond those of one tile.
  pure subroutine list_runs(model, is_known, borders)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_known(:)
    type(borders_t), intent(inout) :: borders
    integer :: pass, n, i, node
    logical :: goes_on

    do pass = 1, 2
      n = 0
      do i = 1, size(model%layout%tiles)
        goes_on = .false.
        do node = model%layout%tiles(i)%first_owned, model%layout%tiles(i)%last_owned
          if (is_known(node) .and. .not. goes_on) n = n + 1
          goes_on = is_known(node)
          if (pass == 1 .or. .not. goes_on) cycle
          if (borders%run_tiles(n) == 0) borders%runs(1, n) = node
          borders%runs(2, n) = node
          borders%run_tiles(n) = i
        end do
      end do
      if (pass == 1) allocate (borders%runs(2, n), borders%run_tiles(n), source=0)
    end do
  end subroutine list_runs

end module rank_borders_m
