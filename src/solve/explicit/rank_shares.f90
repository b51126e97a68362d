! SPDX-License-Identifier: MIT
!> Which process of a run has which tiles, and what goes with them: ranges of chunks, nodes and
!> force slots, since all of these stand tile by tile. Each keeps in memory the special nodes, and
!> nodes and elements of its own tiles; the first one keeps all, for it writes. Arrays are as long
!> as the mesh, so that numbers mean the same everywhere, but what belongs to others is not written
!> to.
module rank_shares_m
  use kinds_m, only : wp
  use layout_m, only : layout_t, chunk_size
  use model_m, only : model_t
  use others_memory_m, only : others_t, forgetters_of
  use packed_buffer_m, only : forgetter_t
  use ranks_m, only : ranks_t
  use state_m, only : state_t
  implicit none
  private
  public :: shares_t, share_out, others_of, forget_others, starts_from_all

  !> All arrays (0:n): where the range of each process starts, then one beyond the last.
  type :: shares_t
    integer, allocatable :: tiles(:), chunks(:)
    integer, allocatable :: nodes(:)       !! interior
    integer, allocatable :: special(:)     !! special nodes that its tiles own
    integer, allocatable :: force_slots(:)
    integer :: first_tile = 1, last_tile = 0 !! of this process
  end type shares_t

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

  !> Whether each process looks at the state of all elements at the start, or steps them in dynamic
  !> relaxation.
  pure function starts_from_all(model) result(starts)
    type(model_t), intent(in) :: model
    logical :: starts

    starts = needs_all(model) .or. model%controls%relaxation%is_on &
      .or. abs(model%controls%mass_step) > 0.0_wp &
      .or. any(abs(model%parts%stiffness_damping) > 0.0_wp)
  end function starts_from_all

end module rank_shares_m
