! SPDX-License-Identifier: MIT
!> From the forces of tiles to those of nodes. Interior nodes belong to one tile; special ones get a
!> slot from each tile that touches them, and these are added in a fixed order.
module tile_forces_m
  use kinds_m, only : wp
  use layout_m, only : layout_t, tile_t
  implicit none
  private
  public :: share_tile_forces, keep_tile_forces, sum_special_forces

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

end module tile_forces_m
