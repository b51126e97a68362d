! SPDX-License-Identifier: MIT
!> What a process of an explicit run keeps in memory: the special nodes, and nodes and elements of
!> its own tiles. The first process keeps all, for it writes. Arrays are as long as the mesh, so
!> that numbers mean the same everywhere, but what belongs to others is not written to; the pages of
!> tiles that go to another process go back to the system.
module rank_memory_m
  use packed_buffer_m, only : forgetter_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use others_memory_m, only : others_t, forgetters_of
  use rank_shares_m, only : shares_t, share_out
  use ranks_m, only : ranks_t
  use state_m, only : state_t
  implicit none
  private
  public :: forget_others, forget_tiles, needs_all, starts_from_all, others_of

contains

  !> Behind the start of a process that is not the first: give up what only others need.
  subroutine forget_others(model, ranks, state)
    type(model_t), intent(inout) :: model
    type(ranks_t), intent(in) :: ranks
    type(state_t), intent(inout) :: state

    if (ranks%mine == 0 .or. needs_all(model)) return
    deallocate (model%mesh%element_id)
    if (.not. allocated(state%cut_force)) deallocate (model%layout%element_slot)
    call forget_tiles(share_out(model%layout, ranks%mine, ranks%n), ranks, model, state)
  end subroutine forget_others

  !> Tiles of others, and their interior nodes.
  subroutine forget_tiles(shares, ranks, model, state)
    type(shares_t), intent(in) :: shares
    type(ranks_t), intent(in) :: ranks
    type(model_t), intent(inout) :: model
    type(state_t), intent(inout) :: state
    type(forgetter_t) :: forgetters(2)
    integer :: k

    forgetters = forgetters_of(others_of(model, shares, ranks))
    do k = 1, 2
      call model%visit(forgetters(k))
      call state%visit(forgetters(k))
    end do
  end subroutine forget_tiles

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

end module rank_memory_m
