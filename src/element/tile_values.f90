! SPDX-License-Identifier: MIT
!> All values of a tile's elements that a step may change, one behind the other: whether it has
!> changed any is seen by their bits, and a step that only tries puts them back.
module tile_values_m
  use block_state_m, only : block_state_t
  use packed_buffer_m, only : packed_buffer_t, start_loading, start_unloading, choose_slots
  use kinds_m, only : wp, long
  use layout_m, only : tile_t, chunk_size
  implicit none
  private
  public :: take_values, put_values, same_bits

contains

  !> What a step may change of the elements of a tile.
  subroutine take_values(tile, elements, buffer)
    type(tile_t), intent(in) :: tile
    type(block_state_t), intent(inout) :: elements !! as before
    type(packed_buffer_t), intent(out) :: buffer

    call choose_slots(buffer, [tile%first_chunk, tile%last_chunk], chunk_size, .false., .true.)
    call elements%visit(buffer)
    call start_loading(buffer)
    call elements%visit(buffer)
  end subroutine take_values

  !> The elements of a tile as they were when their values were taken.
  subroutine put_values(buffer, elements)
    type(packed_buffer_t), intent(inout) :: buffer !! may be put back again
    type(block_state_t), intent(inout) :: elements

    call start_unloading(buffer)
    call elements%visit(buffer)
  end subroutine put_values

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
