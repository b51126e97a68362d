! SPDX-License-Identifier: MIT
!> From the forces of tiles to those of nodes. Interior nodes belong to one tile; special ones get a
!> slot from each tile that touches them, and these are added in a fixed order. And all values of a
!> tile's elements that a step may change, one behind the other: whether it has changed any is seen
!> by their bits, and a step that only tries puts them back.
module tile_forces_m
  use block_state_m, only : block_state_t
  use kinds_m, only : wp, long
  use layout_m, only : layout_t, tile_t, chunk_size
  use packed_buffer_m, only : packed_buffer_t, start_loading, start_unloading, choose_slots
  implicit none
  private
  public :: share_tile_forces, keep_tile_forces, sum_special_forces, take_values, put_values, &
    same_bits

contains

  !> A tile's forces on its special nodes into its force slots.
  subroutine share_tile_forces(tile, force, force_slots)
    type(tile_t), intent(in) :: tile
    real(wp), intent(in) :: force(2, *)          !! of the tile's local nodes
    real(wp), intent(inout) :: force_slots(2, *)
    integer :: n_interior, i

    n_interior = tile%last_node - tile%first_node + 1
    do i = tile%first_special, tile%last_special
      force_slots(1, i) = force(1, n_interior + i - tile%first_special + 1)
      force_slots(2, i) = force(2, n_interior + i - tile%first_special + 1)
    end do
  end subroutine share_tile_forces

  !> A tile's forces on its interior nodes into the nodal array, for a cycle that writes.
  subroutine keep_tile_forces(tile, force, internal_force)
    type(tile_t), intent(in) :: tile
    real(wp), intent(in) :: force(2, *)
    real(wp), intent(inout) :: internal_force(2, *) !! of all nodes

    internal_force(:, tile%first_node:tile%last_node) = &
      force(:, 1:tile%last_node - tile%first_node + 1)
  end subroutine keep_tile_forces

  !> Internal forces of the special nodes first .. last: their slots in their fixed order.
  subroutine sum_special_forces(layout, force_slots, first, last, force)
    type(layout_t), intent(in) :: layout
    real(wp), intent(in) :: force_slots(2, *)
    integer, intent(in) :: first, last
    real(wp), intent(inout) :: force(2, *)   !! of all nodes

    call sum_slots(first, last, layout%node_slots, layout%slot_list, force_slots, force)
  end subroutine sum_special_forces

  !> On arrays of known shape: through the layout each access costs its stride.
  subroutine sum_slots(first, last, node_slots, slot_list, force_slots, force)
    integer, intent(in) :: first, last, node_slots(*), slot_list(*)
    real(wp), intent(in) :: force_slots(2, *)
    real(wp), intent(inout) :: force(2, *)
    real(wp) :: fx, fy
    integer :: node, i

    do node = first, last
      fx = 0.0_wp
      fy = 0.0_wp
      do i = node_slots(node), node_slots(node + 1) - 1
        fx = fx + force_slots(1, slot_list(i))
        fy = fy + force_slots(2, slot_list(i))
      end do
      force(1, node) = fx
      force(2, node) = fy
    end do
  end subroutine sum_slots

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

end module tile_forces_m
