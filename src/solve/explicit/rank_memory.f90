! SPDX-License-Identifier: MIT
!> What a process of an explicit run keeps in memory: the special nodes, and nodes and elements of
!> its own tiles. The first process keeps all, for it writes. Arrays stay as long as they are, so
!> that numbers mean the same everywhere, but the pages of what belongs to others go back to the
!> system.
module rank_memory_m
  use, intrinsic :: iso_c_binding, only : c_loc, c_size_t
  use block_state_m, only : block_state_t
  use heap_m, only : give_back_pages
  use kinds_m, only : wp
  use layout_m, only : layout_t, chunk_size, local_kind
  use model_m, only : model_t
  use rank_shares_m, only : shares_t, share_out, stream_starts
  use ranks_m, only : ranks_t
  use state_m, only : state_t
  implicit none
  private
  public :: forget_others

  integer(c_size_t), parameter :: real_bytes = storage_size(1.0_wp)/8, &
    integer_bytes = storage_size(1)/8, local_bytes = storage_size(1_local_kind)/8

contains

  !> Behind the start of a process that is not the first: give up what only others need. Where
  !> elements may leave the mesh, masses grow or parts are damped, each looks at all elements.
  subroutine forget_others(model, ranks, state)
    type(model_t), intent(inout) :: model
    type(ranks_t), intent(in) :: ranks
    type(state_t), intent(inout) :: state
    type(shares_t) :: shares
    integer :: slots(4), nodes(4)

    if (ranks%mine == 0 .or. model%controls%check_only .or. needs_all(model)) return
    shares = share_out(model%layout, ranks%mine, ranks%n)
    associate (layout => model%layout, mine => ranks%mine)
      slots = [1, (shares%chunks(mine) - 1)*chunk_size, &
        (shares%chunks(mine + 1) - 1)*chunk_size + 1, layout%n_slot]
      ! Nodes inside of rigid bodies stand behind those of tiles: all move them.
      nodes = [layout%n_special + 1, shares%nodes(mine) - 1, shares%nodes(mine + 1), &
        shares%nodes(ranks%n) - 1]
    end associate
    deallocate (model%mesh%element_id, model%layout%element_slot)
    if (allocated(model%mesh%deck_node)) deallocate (model%mesh%deck_node)
    call forget_integers(nodes, 1, model%mesh%node_id)
    call forget_reals(nodes, 2, model%mesh%coordinates)
    call forget_integers(slots, 1, model%layout%slot_element)
    call forget_integers(slots, 4, model%layout%slot_nodes)
    call forget_locals(slots, 4, model%layout%slot_local)
    call forget_nodes(nodes, state)
    call forget_elements(slots, shares, ranks%mine, state%elements)
  end subroutine forget_others

  !> Whether all elements are looked at by each process.
  pure function needs_all(model) result(needs)
    type(model_t), intent(in) :: model
    logical :: needs

    needs = model%erodes .or. allocated(model%conditions%part_damping) &
      .or. (abs(model%controls%mass_step) > 0.0_wp .and. .not. model%controls%masses_stay)
  end function needs_all

  !> State of interior nodes.
  subroutine forget_nodes(nodes, state)
    integer, intent(in) :: nodes(4)
    type(state_t), intent(inout) :: state

    call forget_reals(nodes, 4, state%motion)
    call forget_reals(nodes, 1, state%mass)
    call forget_reals(nodes, 2, state%inverse_mass)
    call forget_reals(nodes, 2, state%internal_force)
    if (allocated(state%former_velocity)) call forget_reals(nodes, 2, state%former_velocity)
  end subroutine forget_nodes

  !> State of elements.
  subroutine forget_elements(slots, shares, mine, elements)
    integer, intent(in) :: slots(4)
    type(shares_t), intent(in) :: shares
    integer, intent(in) :: mine
    type(block_state_t), intent(inout) :: elements
    integer :: k

    do k = 1, size(elements%reference, 2)
      call forget_reals(slots, 1, elements%reference(:, k))
    end do
    do k = 1, size(elements%deviator, 2)
      call forget_reals(slots, 1, elements%deviator(:, k))
    end do
    if (allocated(elements%mass_ratio)) call forget_reals(slots, 1, elements%mass_ratio)
    if (allocated(elements%retardation)) call forget_reals(slots, 1, elements%retardation)
    if (allocated(elements%damping_stress)) call forget_reals(slots, 16, elements%damping_stress)
    call forget_stream(elements%point_start, elements%point_deviator)
    call forget_stream(elements%history_start, elements%history)
    call forget_stream(elements%eos_start, elements%eos_state)
    call forget_stream(elements%hourglass_start, elements%hourglass_strain)

  contains

    subroutine forget_stream(chunk_start, values)
      integer, intent(in) :: chunk_start(:)
      real(wp), intent(inout), contiguous :: values(:)

      if (size(values) == 0) return
      associate (starts => stream_starts(shares%chunks, chunk_start, size(values)))
        call forget_reals([1, starts(mine + 1) - 1, starts(mine + 2), size(values)], 1, values)
      end associate
    end subroutine forget_stream

  end subroutine forget_elements

  !> Items of two ranges.
  subroutine forget_reals(items, width, values)
    integer, intent(in) :: items(4)       !! first and last of the one, first and last of the other
    integer, intent(in) :: width          !! values of an item
    real(wp), intent(inout), target :: values(width, *)
    integer :: k

    do k = 1, 3, 2
      if (items(k + 1) >= items(k)) call give_back_pages(c_loc(values(1, items(k))), &
        real_bytes*width*(items(k + 1) - items(k) + 1))
    end do
  end subroutine forget_reals

  !> The same of integers.
  subroutine forget_integers(items, width, values)
    integer, intent(in) :: items(4), width
    integer, intent(inout), target :: values(width, *)
    integer :: k

    do k = 1, 3, 2
      if (items(k + 1) >= items(k)) call give_back_pages(c_loc(values(1, items(k))), &
        integer_bytes*width*(items(k + 1) - items(k) + 1))
    end do
  end subroutine forget_integers

  !> The same of local numbers.
  subroutine forget_locals(items, width, values)
    integer, intent(in) :: items(4), width
    integer(local_kind), intent(inout), target :: values(width, *)
    integer :: k

    do k = 1, 3, 2
      if (items(k + 1) >= items(k)) call give_back_pages(c_loc(values(1, items(k))), &
        local_bytes*width*(items(k + 1) - items(k) + 1))
    end do
  end subroutine forget_locals

end module rank_memory_m
