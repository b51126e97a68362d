! SPDX-License-Identifier: MIT
!> Tiles go from the processes that have had them to those that have them from now on, with all that
!> a process keeps of its tiles alone.
module tile_moving_m
  use packed_buffer_m, only : packed_buffer_t, start_loading, start_unloading, choose_slots
  use layout_m, only : tile_t, chunk_size
  use model_m, only : model_t
  use rank_shares_m, only : shares_t
  use ranks_m, only : ranks_t, swap_reals
  use state_m, only : state_t
  use visitor_m, only : of_forces, of_nodes
  implicit none
  private
  public :: move_tiles

contains

  !> A message from each process to each that takes over tiles of it.
  subroutine move_tiles(old, next, ranks, model, state)
    type(shares_t), intent(in) :: old, next
    type(ranks_t), intent(inout) :: ranks
    type(model_t), intent(inout) :: model
    type(state_t), intent(inout) :: state
    integer :: peers(ranks%n - 1), out_starts(ranks%n), in_starts(ranks%n), i
    type(packed_buffer_t) :: outgoing, incoming

    peers = pack([(i, i = 0, ranks%n - 1)], [(i /= ranks%mine, i = 0, ranks%n - 1)])
    call pass_all(old, ranks%mine, next, peers, outgoing, out_starts)
    call start_loading(outgoing)
    call pass_all(old, ranks%mine, next, peers, outgoing, out_starts)
    call pass_all(next, ranks%mine, old, peers, incoming, in_starts)
    call start_loading(incoming)
    call swap_reals(ranks, peers, out_starts, outgoing%values, in_starts, incoming%values)
    call start_unloading(incoming)
    call pass_all(next, ranks%mine, old, peers, incoming, in_starts)

  contains

    !> The tiles that this process has in the one sharing out and each peer in the other.
    subroutine pass_all(own, mine, theirs, peers, buffer, starts)
      type(shares_t), intent(in) :: own, theirs
      integer, intent(in) :: mine, peers(:)
      type(packed_buffer_t), intent(inout) :: buffer
      integer, intent(out) :: starts(:) !! (peers + 1)
      integer :: i, k

      do k = 1, size(peers)
        starts(k) = buffer%n + 1
        do i = max(own%tiles(mine), theirs%tiles(peers(k))), &
          min(own%tiles(mine + 1), theirs%tiles(peers(k) + 1)) - 1
          call pass_tile(model%layout%tiles(i), model, state, buffer)
        end do
      end do
      starts(size(starts)) = buffer%n + 1
    end subroutine pass_all

  end subroutine move_tiles

  !> A tile: its elements, its interior nodes and its forces on special ones.
  subroutine pass_tile(tile, model, state, buffer)
    type(tile_t), intent(in) :: tile
    type(model_t), intent(inout) :: model
    type(state_t), intent(inout) :: state
    type(packed_buffer_t), intent(inout) :: buffer

    call choose_slots(buffer, [tile%first_chunk, tile%last_chunk], chunk_size, .true., .true.)
    buffer%ranges(:, of_nodes) = [tile%first_node, tile%last_node]
    buffer%ranges(:, of_forces) = [tile%first_special, tile%last_special]
    call model%visit(buffer)
    call state%visit(buffer)
  end subroutine pass_tile

end module tile_moving_m
