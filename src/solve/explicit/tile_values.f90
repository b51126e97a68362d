! SPDX-License-Identifier: MIT
!> All values of a tile's elements that a step may change, one behind the other: whether it has
!> changed any is seen by their bits.
module tile_values_m
  use block_state_m, only : block_state_t
  use kinds_m, only : wp, long
  use layout_m, only : tile_t, first_slot, last_slot
  use rank_shares_m, only : stream_starts
  implicit none
  private
  public :: take_values, same_bits

contains

  !> What a step may change of the elements of a tile.
  subroutine take_values(tile, elements, values)
    type(tile_t), intent(in) :: tile
    type(block_state_t), intent(in) :: elements
    real(wp), allocatable, intent(out) :: values(:)

    allocate (values(0))
    call append_chunks(tile%first_chunk, tile%last_chunk, elements, values)
    call append_slots(first_slot(tile), last_slot(tile), elements, values)
    call append_stream(tile, elements%point_start, elements%point_deviator, values)
    call append_stream(tile, elements%history_start, elements%history, values)
    call append_stream(tile, elements%eos_start, elements%eos_state, values)
    call append_stream(tile, elements%hourglass_start, elements%hourglass_strain, values)
  end subroutine take_values

  !> What they keep chunk by chunk.
  subroutine append_chunks(first, last, elements, values)
    integer, intent(in) :: first, last
    type(block_state_t), intent(in) :: elements
    real(wp), allocatable, intent(inout) :: values(:)

    call append(elements%deviatoric_work(first:last), values)
    call append(elements%hourglass_work(first:last), values)
    call append(elements%viscous_work(first:last), values)
    if (allocated(elements%damping_work)) call append(elements%damping_work(first:last), values)
    call append(elements%time_limit(first:last), values)
    call append(elements%volume_limit(first:last), values)
    if (allocated(elements%n_failed)) call append(real(elements%n_failed(first:last), wp), values)
  end subroutine append_chunks

  !> What they keep slot by slot.
  subroutine append_slots(first, last, elements, values)
    integer, intent(in) :: first, last
    type(block_state_t), intent(in) :: elements
    real(wp), allocatable, intent(inout) :: values(:)
    integer :: k

    do k = 1, size(elements%deviator, 2)
      call append(elements%deviator(first:last, k), values)
    end do
    if (allocated(elements%damping_stress)) &
      call append(elements%damping_stress(16*first - 15:16*last), values)
    if (.not. allocated(elements%erosion)) return
    associate (erosion => elements%erosion)
      call append(real(erosion%status(first:last), wp), values)
      call append(erosion%hourglass(first:last), values)
      call append(erosion%internal(first:last), values)
      call append(erosion%impulse(first:last), values)
    end associate
  end subroutine append_slots

  !> What only some chunks keep.
  subroutine append_stream(tile, chunk_start, stream, values)
    type(tile_t), intent(in) :: tile
    integer, intent(in) :: chunk_start(:)
    real(wp), intent(in), contiguous :: stream(:)
    real(wp), allocatable, intent(inout) :: values(:)
    integer :: range(2)

    if (size(stream) == 0) return
    range = stream_starts([tile%first_chunk, tile%last_chunk + 1], chunk_start, size(stream))
    call append(stream(range(1):range(2) - 1), values)
  end subroutine append_stream

  !> One piece more.
  subroutine append(piece, values)
    real(wp), intent(in), contiguous :: piece(:)
    real(wp), allocatable, intent(inout) :: values(:)
    real(wp), allocatable :: longer(:)

    allocate (longer(size(values) + size(piece)))
    longer(:size(values)) = values
    longer(size(values) + 1:) = piece
    call move_alloc(longer, values)
  end subroutine append

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
