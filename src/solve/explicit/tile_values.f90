! SPDX-License-Identifier: MIT
!> All values of a tile's elements that a step may change, one behind the other: whether it has
!> changed any is seen by their bits, and a process that takes the tile over takes them.
module tile_values_m
  use block_state_m, only : block_state_t
  use freight_m, only : freight_t, start_loading, pass_reals, pass_integers
  use kinds_m, only : wp, long
  use layout_m, only : tile_t, first_slot, last_slot
  use rank_shares_m, only : stream_starts
  implicit none
  private
  public :: take_values, pass_values, same_bits

contains

  !> What a step may change of the elements of a tile.
  subroutine take_values(tile, elements, values)
    type(tile_t), intent(in) :: tile
    type(block_state_t), intent(inout) :: elements !! as before
    real(wp), allocatable, intent(out) :: values(:)
    type(freight_t) :: freight

    call pass_values(tile, elements, freight)
    call start_loading(freight)
    call pass_values(tile, elements, freight)
    call move_alloc(freight%values, values)
  end subroutine take_values

  !> The same into a freight, or out of it.
  subroutine pass_values(tile, elements, freight)
    type(tile_t), intent(in) :: tile
    type(block_state_t), intent(inout) :: elements
    type(freight_t), intent(inout) :: freight

    call pass_chunks(tile%first_chunk, tile%last_chunk, elements, freight)
    call pass_slots(first_slot(tile), last_slot(tile), elements, freight)
    call pass_stream(tile, elements%point_start, elements%point_deviator, freight)
    call pass_stream(tile, elements%history_start, elements%history, freight)
    call pass_stream(tile, elements%eos_start, elements%eos_state, freight)
    call pass_stream(tile, elements%hourglass_start, elements%hourglass_strain, freight)
  end subroutine pass_values

  !> What they keep chunk by chunk.
  subroutine pass_chunks(first, last, elements, freight)
    integer, intent(in) :: first, last
    type(block_state_t), intent(inout) :: elements
    type(freight_t), intent(inout) :: freight

    associate (n => last - first + 1)
      call pass_reals(n, elements%deviatoric_work(first:last), freight)
      call pass_reals(n, elements%hourglass_work(first:last), freight)
      call pass_reals(n, elements%viscous_work(first:last), freight)
      if (allocated(elements%damping_work)) &
        call pass_reals(n, elements%damping_work(first:last), freight)
      call pass_reals(n, elements%time_limit(first:last), freight)
      call pass_reals(n, elements%volume_limit(first:last), freight)
      if (allocated(elements%n_failed)) &
        call pass_integers(n, elements%n_failed(first:last), freight)
    end associate
  end subroutine pass_chunks

  !> What they keep slot by slot.
  subroutine pass_slots(first, last, elements, freight)
    integer, intent(in) :: first, last
    type(block_state_t), intent(inout) :: elements
    type(freight_t), intent(inout) :: freight
    integer :: k

    associate (n => last - first + 1)
      do k = 1, size(elements%deviator, 2)
        call pass_reals(n, elements%deviator(first:last, k), freight)
      end do
      if (allocated(elements%damping_stress)) &
        call pass_reals(16*n, elements%damping_stress(16*first - 15:16*last), freight)
      if (.not. allocated(elements%erosion)) return
      call pass_integers(n, elements%erosion%status(first:last), freight)
      call pass_reals(n, elements%erosion%hourglass(first:last), freight)
      call pass_reals(n, elements%erosion%internal(first:last), freight)
      call pass_reals(n, elements%erosion%impulse(first:last), freight)
    end associate
  end subroutine pass_slots

  !> What only some chunks keep.
  subroutine pass_stream(tile, chunk_start, stream, freight)
    type(tile_t), intent(in) :: tile
    integer, intent(in) :: chunk_start(:)
    real(wp), intent(inout), contiguous :: stream(:)
    type(freight_t), intent(inout) :: freight
    integer :: range(2)

    if (size(stream) == 0) return
    range = stream_starts([tile%first_chunk, tile%last_chunk + 1], chunk_start, size(stream))
    call pass_reals(range(2) - range(1), stream(range(1):range(2) - 1), freight)
  end subroutine pass_stream

  !> Whether two arrays of one length have the same bits: zeros have signs, and what is not a number
  !> equals nothing.
  pure function same_bits(a, b) result(same)
    real(wp), intent(in) :: a(:), b(:)
    logical :: same
    integer(long) :: differing
    integer :: i

    differing = 0_long
    do i = 1, size(a)
      differing = ior(differing, ieor(transfer(a(i), 0_long), transfer(b(i), 0_long)))
    end do
    same = differing == 0_long
  end function same_bits

end module tile_values_m
