! SPDX-License-Identifier: MIT
!> Element forces tile by tile, and the selection of the element form. From forces of tiles to
!> forces of nodes: interior nodes belong to one tile; special nodes get a slot from each tile that
!> touches them, and the slots are added in a fixed order. Element values of a tile that a step may
!> change can be gathered into a buffer, compared bit by bit, and restored.
module element_dispatch_m
  use kinds_m, only : wp, long
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, scatter_forces
  use layout_m, only : layout_t, chunk_size, local_kind, tile_t
  use model_m, only : model_t
  use packed_buffer_m, only : packed_buffer_t, start_packing, start_unpacking, choose_slots
  use parts_m, only : section_t, form_full, form_axisym_full
  use quad_m, only : advance_chunk
  use quad_points_m, only : n_point
  implicit none
  private
  public :: add_tile_forces, point_count, scatter_tile_forces, store_tile_forces, &
    sum_special_forces, gather_values, restore_values, same_bits

contains

  !> Integration points of an element of this section.
  pure function point_count(section) result(n)
    type(section_t), intent(in) :: section
    integer :: n

    n = merge(n_point, 1, any(section%element_form == [form_full, form_axisym_full]))
  end function point_count

  !> Advance all elements of one tile by the step `dt` before the present motion and sum their
  !> internal forces on the tile's local nodes.
  subroutine add_tile_forces(model, tile, motion, dt, elements, force)
    type(model_t), intent(in) :: model
    type(tile_t), intent(in) :: tile
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements     !! only this tile's slots are touched
    real(wp), intent(inout) :: force(2, model%layout%n_local) !! set here
    type(element_chunk_t) :: chunk
    real(wp) :: near(4, model%layout%n_local)
    integer :: i_chunk, first, numbers(4, chunk_size)

    call gather_tile_motion(tile, model%layout%special_node, motion, near)
    force = 0.0_wp
    do i_chunk = tile%first_chunk, tile%last_chunk
      first = (i_chunk - 1)*chunk_size + 1
      call widen(model%layout%slot_local(1, first), numbers)
      call advance_chunk(model, i_chunk, numbers, near, dt, elements, chunk)
      call scatter_forces(model%layout%chunk_elements(i_chunk), model%layout%slot_local(1, first), &
        chunk, force)
    end do
  end subroutine add_tile_forces

  !> Motion of a tile's nodes by local number. It is read in order here, and local numbers need half
  !> the memory of global ones.
  pure subroutine gather_tile_motion(tile, special_node, motion, near)
    type(tile_t), intent(in) :: tile
    integer, intent(in) :: special_node(*)
    real(wp), intent(in) :: motion(4, *)       !! of all nodes
    real(wp), intent(inout) :: near(4, *)
    integer :: i, n_interior

    n_interior = tile%last_node - tile%first_node + 1
    do i = 1, n_interior
      call copy_node(motion(1, tile%first_node + i - 1), near(1, i))
    end do
    do i = tile%first_special, tile%last_special
      call copy_node(motion(1, special_node(i)), near(1, n_interior + i - tile%first_special + 1))
    end do
  end subroutine gather_tile_motion

  !> Copy the motion of one node; for a loop over the four components the compiler would call a
  !> routine.
  pure subroutine copy_node(motion, near)
    real(wp), intent(in) :: motion(4)
    real(wp), intent(inout) :: near(4)

    near(1) = motion(1)
    near(2) = motion(2)
    near(3) = motion(3)
    near(4) = motion(4)
  end subroutine copy_node

  !> Local numbers of a chunk as default integers.
  pure subroutine widen(local, numbers)
    integer(local_kind), intent(in) :: local(4*chunk_size)
    integer, intent(out) :: numbers(4*chunk_size)
    integer :: i

    !$omp simd
    do i = 1, 4*chunk_size
      numbers(i) = local(i)
    end do
  end subroutine widen

  !> Copy a tile's forces on its special nodes into its force slots.
  subroutine scatter_tile_forces(tile, force, force_slots)
    type(tile_t), intent(in) :: tile
    real(wp), intent(in) :: force(2, *)          !! of the tile's local nodes
    real(wp), intent(inout) :: force_slots(2, *)
    integer :: n_interior, i

    n_interior = tile%last_node - tile%first_node + 1
    do i = tile%first_special, tile%last_special
      force_slots(1, i) = force(1, n_interior + i - tile%first_special + 1)
      force_slots(2, i) = force(2, n_interior + i - tile%first_special + 1)
    end do
  end subroutine scatter_tile_forces

  !> Copy a tile's forces on its interior nodes into the nodal array, for a cycle that writes.
  subroutine store_tile_forces(tile, force, internal_force)
    type(tile_t), intent(in) :: tile
    real(wp), intent(in) :: force(2, *)
    real(wp), intent(inout) :: internal_force(2, *) !! of all nodes

    internal_force(:, tile%first_node:tile%last_node) = &
      force(:, 1:tile%last_node - tile%first_node + 1)
  end subroutine store_tile_forces

  !> Internal forces of the special nodes first .. last: sum of their slots in fixed order.
  subroutine sum_special_forces(layout, force_slots, first, last, force)
    type(layout_t), intent(in) :: layout
    real(wp), intent(in) :: force_slots(2, *)
    integer, intent(in) :: first, last
    real(wp), intent(inout) :: force(2, *)   !! of all nodes

    call sum_slots(first, last, layout%node_slots, layout%slot_list, force_slots, force)
  end subroutine sum_special_forces

  !> Sum of slots, on arrays of known shape: access through the layout would cost a stride each.
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

  !> Gather the element values of a tile that a step may change.
  subroutine gather_values(tile, elements, buffer)
    type(tile_t), intent(in) :: tile
    type(block_state_t), intent(inout) :: elements !! unchanged
    type(packed_buffer_t), intent(out) :: buffer

    call choose_slots(buffer, [tile%first_chunk, tile%last_chunk], chunk_size, .false., .true.)
    call elements%visit(buffer)
    call start_packing(buffer)
    call elements%visit(buffer)
  end subroutine gather_values

  !> Restore the element values of a tile from a buffer.
  subroutine restore_values(buffer, elements)
    type(packed_buffer_t), intent(inout) :: buffer !! may be used again
    type(block_state_t), intent(inout) :: elements

    call start_unpacking(buffer)
    call elements%visit(buffer)
  end subroutine restore_values

  !> Whether two arrays of equal length have the same bits: zeros have signs, and NaN equals
  !> nothing.
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

end module element_dispatch_m
