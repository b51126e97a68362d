! SPDX-License-Identifier: MIT
!> Where tiles rest, ranges of tiles with as many elements each are not as much work. From time to
!> time the processes tell each other which tiles rest, and share all tiles out anew where that
!> pays: those that change hands go from process to process. What comes of a run does not depend on
!> who steps which tile.
module rank_balance_m
  use explicit_cycle_m, only : explicit_cycle_t
  use health_m, only : check_tile
  use kinds_m, only : wp
  use model_m, only : model_t
  use rank_borders_m, only : plan_borders
  use rank_exchange_m, only : parcel_t, plan_parcel, gather_special
  use rank_memory_m, only : needs_all, forget_tiles
  use rank_shares_m, only : shares_t, share_out, tile_elements
  use ranks_m, only : ranks_t, bring_reals, bring_integers
  use resting_tiles_m, only : take_tiles, is_awake, effort_of
  use state_m, only : state_t
  use tile_moving_m, only : move_tiles
  implicit none
  private
  public :: balance_ranks

  !> Cycles between two looks.
  integer, parameter :: look_interval = 64

  !> The tiles are shared out anew where the process with most work has so many times what the one
  !> with most would then have.
  real(wp), parameter :: pays = 1.05_wp

contains

  !> Between two cycles, in all of several processes.
  subroutine balance_ranks(model, ranks, state, cycle)
    type(model_t), intent(inout) :: model
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(inout) :: cycle
    integer :: status(size(model%layout%tiles))
    real(wp) :: work(size(model%layout%tiles))
    type(shares_t) :: next

    if (cycle%rest%is_settled .or. mod(state%cycle, look_interval) > 0) return
    cycle%rest%is_settled = needs_all(model)
    if (cycle%rest%is_settled) return
    status = cycle%rest%status
    call bring_integers(ranks, cycle%shares%tiles, 1, .true., status)
    work = tile_elements(model%layout)*effort_of(status)
    next = share_out(model%layout, ranks%mine, ranks%n, work)
    if (most_of(cycle%shares, work) > pays*most_of(next, work)) &
      call share_anew(model, status, next, ranks, state, cycle)
    cycle%rest%is_settled = all(is_awake(status))
  end subroutine balance_ranks

  !> The work of the process that has most.
  pure function most_of(shares, work) result(most)
    type(shares_t), intent(in) :: shares
    real(wp), intent(in) :: work(:) !! (tiles)
    real(wp) :: most
    integer :: rank

    most = 0.0_wp
    do rank = 0, ubound(shares%tiles, 1) - 1
      most = max(most, sum(work(shares%tiles(rank):shares%tiles(rank + 1) - 1)))
    end do
  end function most_of

  !> Tiles, the special nodes on which they lie and all that is planned from who has them.
  subroutine share_anew(model, status, next, ranks, state, cycle)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: status(:)    !! of all tiles
    type(shares_t), intent(in) :: next
    type(ranks_t), intent(inout) :: ranks
    type(state_t), intent(inout) :: state
    type(explicit_cycle_t), intent(inout) :: cycle
    type(parcel_t) :: former
    integer :: i

    call gather_special(cycle%shares, cycle%borders, .true., ranks, state)
    call bring_reals(ranks, cycle%shares%special, 2, .true., state%internal_force)
    call move_tiles(cycle%shares, next, ranks, model, state)
    cycle%shares = next
    if (ranks%mine > 0) call forget_tiles(next, ranks, model, state)
    call plan_borders(model, next, ranks%mine, cycle%sums, cycle%borders)
    former = cycle%parcel
    call plan_parcel(cycle%borders, next, ranks%mine, state%elements, cycle%sums, cycle%parcel)
    cycle%parcel%sent = former%sent
    cycle%parcel%joined = former%joined
    cycle%parcel%n_cycle = former%n_cycle
    cycle%parcel%n_shared = former%n_shared + 1
    call take_tiles(model, next, status, cycle%borders%run_tiles, cycle%rest)
    do i = next%first_tile, next%last_tile
      cycle%checks(i) = check_tile(model%layout%tiles(i), state%elements)
    end do
  end subroutine share_anew

end module rank_balance_m
