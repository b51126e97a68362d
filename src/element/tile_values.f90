! SPDX-License-Identifier: MIT
!> All values of a tile's elements that a step may change, one behind the other: whether it has
!> changed any is seen by their bits, a process that takes the tile over takes them, and a step that
!> only tries puts them back.
module tile_values_m
  use block_state_m, only : block_state_t, stream_starts
  use freight_m, only : freight_t, start_loading, start_unloading, pass_reals, pass_integers
  use kinds_m, only : wp, long
  use layout_m, only : tile_t, first_slot, last_slot
  implicit none
  private
  public :: take_values, put_values, pass_values, same_bits

contains

  !> What a step may change of the elements of a tile.
  subroutine take_values(tile, elements, freight)
    type(tile_t), intent(in) :: tile
    type(block_state_t), intent(inout) :: elements !! as before
    type(freight_t), intent(out) :: freight

    call pass_values(tile, elements, freight)
    call start_loading(freight)
    call pass_values(tile, elements, freight)
  end subroutine take_values

  !> The elements of a tile as they were when their values were taken.
  subroutine put_values(tile, freight, elements)
    type(tile_t), intent(in) :: tile
    type(freight_t), intent(inout) :: freight !! may be put back again
    type(block_state_t), intent(inout) :: elements

    call start_unloading(freight)
    call pass_values(tile, elements, freight)
  end subroutine put_values

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
      call pass_reals(n, elements%volume_change(first:last), freight)
      if (allocated(elements%n_failed)) &
        call pass_integers(n, elements%n_failed(first:last), freight)
      if (allocated(elements%erosion)) &
        call pass_integers(n, elements%erosion%n_gone(first:last), freight)
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
      if (allocated(elements%viscous_pressure)) &
        call pass_reals(n, elements%viscous_pressure(first:last), freight)
      if (allocated(elements%damping_stress)) &
        call pass_reals(16*n, elements%damping_stress(16*first - 15:16*last), freight)
      if (.not. allocated(elements%erosion)) return
      ! The shape of an element that leaves the mesh becomes that of padding.
      do k = 1, size(elements%reference, 2)
        call pass_reals(n, elements%reference(first:last, k), freight)
      end do
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
