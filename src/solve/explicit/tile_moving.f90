! SPDX-License-Identifier: MIT
!> Tiles go from the processes that have had them to those that have them from now on, with all that
!> a process keeps of its tiles alone.
module tile_moving_m
  use block_state_m, only : block_state_t
  use freight_m, only : freight_t, start_loading, start_unloading, pass_reals
  use layout_m, only : tile_t, first_slot, last_slot
  use mesh_freight_m, only : pass_nodes, pass_slots
  use model_m, only : model_t
  use rank_shares_m, only : shares_t
  use ranks_m, only : ranks_t, swap_reals
  use state_m, only : state_t
  use tile_values_m, only : pass_values
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
    type(freight_t) :: outgoing, incoming

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
    subroutine pass_all(own, mine, theirs, peers, freight, starts)
      type(shares_t), intent(in) :: own, theirs
      integer, intent(in) :: mine, peers(:)
      type(freight_t), intent(inout) :: freight
      integer, intent(out) :: starts(:) !! (peers + 1)
      integer :: i, k

      do k = 1, size(peers)
        starts(k) = freight%n + 1
        do i = max(own%tiles(mine), theirs%tiles(peers(k))), &
          min(own%tiles(mine + 1), theirs%tiles(peers(k) + 1)) - 1
          call pass_tile(model%layout%tiles(i), model, state, freight)
        end do
      end do
      starts(size(starts)) = freight%n + 1
    end subroutine pass_all

  end subroutine move_tiles

  !> A tile: its elements, its interior nodes and its forces on special ones.
  subroutine pass_tile(tile, model, state, freight)
    type(tile_t), intent(in) :: tile
    type(model_t), intent(inout) :: model
    type(state_t), intent(inout) :: state
    type(freight_t), intent(inout) :: freight

    call pass_motion(tile%first_node, tile%last_node, state, freight)
    call pass_nodes(tile%first_node, tile%last_node, model, freight)
    associate (first => tile%first_special, last => tile%last_special)
      call pass_reals(2*(last - first + 1), state%force_slots(:, first:last), freight)
    end associate
    call pass_values(tile, state%elements, freight)
    call pass_constants(first_slot(tile), last_slot(tile), state%elements, freight)
    call pass_slots(first_slot(tile), last_slot(tile), model%layout, freight)
  end subroutine pass_tile

  !> The state of interior nodes (what `forget_nodes` gives up).
  subroutine pass_motion(first, last, state, freight)
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state
    type(freight_t), intent(inout) :: freight

    associate (n => last - first + 1)
      call pass_reals(4*n, state%motion(:, first:last), freight)
      call pass_reals(n, state%mass(first:last), freight)
      call pass_reals(2*n, state%inverse_mass(:, first:last), freight)
      call pass_reals(2*n, state%internal_force(:, first:last), freight)
      if (allocated(state%former_velocity)) &
        call pass_reals(2*n, state%former_velocity(:, first:last), freight)
    end associate
  end subroutine pass_motion

  !> What a step does not change of the state of elements.
  subroutine pass_constants(first, last, elements, freight)
    integer, intent(in) :: first, last !! slots
    type(block_state_t), intent(inout) :: elements
    type(freight_t), intent(inout) :: freight
    integer :: k

    associate (n => last - first + 1)
      do k = 1, size(elements%reference, 2)
        call pass_reals(n, elements%reference(first:last, k), freight)
      end do
      if (allocated(elements%mass_ratio)) &
        call pass_reals(n, elements%mass_ratio(first:last), freight)
      if (allocated(elements%retardation)) &
        call pass_reals(n, elements%retardation(first:last), freight)
    end associate
  end subroutine pass_constants

end module tile_moving_m
