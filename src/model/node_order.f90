! SPDX-License-Identifier: MIT
!> The order of the nodes in memory: by the tiles that sum and move them.
module node_order_m
  use layout_m, only : layout_t, tile_t, first_slot, last_slot
  use mesh_m, only : mesh_t
  implicit none
  private
  public :: order_nodes

  !> Of nodes that are no tile's to sum.
  integer, parameter :: no_owner = 0

contains

  !> New order of the nodes: special ones first, by the tile that owns them, then the interior nodes
  !> of each tile, last those of rigid bodies that nothing touches; in the first classes in the
  !> order in which the elements touch them. Fills the tiles' node ranges.
  subroutine order_nodes(mesh, is_rigid, is_special, layout, order)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_rigid(:)      !! (n_node) of a rigid body
    logical, intent(inout) :: is_special(:) !! (n_node) in: wanted special; out: all special nodes
    type(layout_t), intent(inout) :: layout
    integer, allocatable, intent(out) :: order(:) !! (n_node) present index of each new node
    logical, allocatable :: placed(:)
    integer, allocatable :: owner(:)
    integer :: i_tile, n_placed

    call find_owners(mesh, is_rigid, layout, is_special, owner)
    allocate (order(mesh%n_node))
    allocate (placed(mesh%n_node), source=.false.)
    n_placed = 0
    do i_tile = 1, size(layout%tiles)
      layout%tiles(i_tile)%first_owned = n_placed + 1
      call place_tile_nodes(mesh, layout, i_tile, owner, i_tile, placed, order, n_placed)
      layout%tiles(i_tile)%last_owned = n_placed
    end do
    call place_rest(is_special, placed, order, n_placed)
    layout%tiles(size(layout%tiles))%last_owned = n_placed
    layout%n_special = n_placed
    do i_tile = 1, size(layout%tiles)
      layout%tiles(i_tile)%first_node = n_placed + 1
      call place_tile_nodes(mesh, layout, i_tile, owner, no_owner, placed, order, n_placed)
      layout%tiles(i_tile)%last_node = n_placed
    end do
    call place_rest(.not. is_special, placed, order, n_placed)
  end subroutine order_nodes

  !> Special nodes, and the tile that owns each. Nodes that several tiles touch are special; so is a
  !> node without any element, and a node of a rigid body with an element that is not rigid. Tiles
  !> share their common nodes evenly: the threads that have them wait for each other.
  subroutine find_owners(mesh, is_rigid, layout, is_special, owner)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_rigid(:)
    type(layout_t), intent(in) :: layout
    logical, intent(inout) :: is_special(:)
    integer, allocatable, intent(out) :: owner(:) !! (n_node) a tile or no_owner
    integer, allocatable :: last_tile(:), n_touch(:), nodes(:)
    integer :: i_tile, i

    allocate (owner(mesh%n_node), source=no_owner)
    allocate (last_tile(mesh%n_node), n_touch(mesh%n_node), source=0)
    do i_tile = 1, size(layout%tiles)
      call list_nodes(mesh, layout%tiles(i_tile), layout%slot_element, i_tile, last_tile, nodes)
      do i = 1, size(nodes)
        n_touch(nodes(i)) = n_touch(nodes(i)) + 1
      end do
    end do
    is_special = is_special .or. n_touch > 1 .or. (n_touch == 0 .neqv. is_rigid)
    call share_nodes(mesh, layout, is_special, last_tile, owner)
  end subroutine find_owners

  !> Every tile gets every second of the special nodes that it has in common with a later one, and
  !> those that only it is left to take.
  subroutine share_nodes(mesh, layout, is_special, last_tile, owner)
    type(mesh_t), intent(in) :: mesh
    type(layout_t), intent(in) :: layout
    logical, intent(in) :: is_special(:)
    integer, intent(in) :: last_tile(:)   !! (n_node) the last tile that touches it
    integer, intent(inout) :: owner(:)
    integer, allocatable :: seen(:), nodes(:), n_common(:)
    integer :: i_tile, i

    allocate (seen(mesh%n_node), n_common(size(layout%tiles)), source=0)
    do i_tile = 1, size(layout%tiles)
      call list_nodes(mesh, layout%tiles(i_tile), layout%slot_element, i_tile, seen, nodes)
      nodes = pack(nodes, is_special(nodes) .and. owner(nodes) == no_owner)
      do i = 1, size(nodes)
        associate (n => n_common(last_tile(nodes(i))))
          n = n + 1
          if (last_tile(nodes(i)) == i_tile .or. modulo(n, 2) == 1) owner(nodes(i)) = i_tile
        end associate
      end do
      n_common(last_tile(nodes)) = 0
    end do
  end subroutine share_nodes

  !> The nodes of a tile in the order in which its elements touch them.
  subroutine list_nodes(mesh, tile, slot_element, mark, marks, nodes)
    type(mesh_t), intent(in) :: mesh
    type(tile_t), intent(in) :: tile
    integer, intent(in) :: slot_element(:)
    integer, intent(in) :: mark                !! of this tile
    integer, intent(inout) :: marks(:)         !! (n_node) a node that bears the mark is on the list
    integer, allocatable, intent(out) :: nodes(:)
    integer :: list(4*(last_slot(tile) - first_slot(tile) + 1)), slot, k, n, node

    n = 0
    do slot = first_slot(tile), last_slot(tile)
      if (slot_element(slot) == 0) cycle
      do k = 1, 4
        node = mesh%element_nodes(k, slot_element(slot))
        if (marks(node) == mark) cycle
        marks(node) = mark
        n = n + 1
        list(n) = node
      end do
    end do
    nodes = list(:n)
  end subroutine list_nodes

  !> Place those nodes of a tile that have the given owner and are not yet placed.
  subroutine place_tile_nodes(mesh, layout, i_tile, owner, wanted, placed, order, n_placed)
    type(mesh_t), intent(in) :: mesh
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: i_tile
    integer, intent(in) :: owner(:)
    integer, intent(in) :: wanted
    logical, intent(inout) :: placed(:)
    integer, intent(inout) :: order(:)
    integer, intent(inout) :: n_placed
    integer :: slot, k, node

    do slot = first_slot(layout%tiles(i_tile)), last_slot(layout%tiles(i_tile))
      if (layout%slot_element(slot) == 0) cycle
      do k = 1, 4
        node = mesh%element_nodes(k, layout%slot_element(slot))
        if (placed(node) .or. owner(node) /= wanted) cycle
        placed(node) = .true.
        n_placed = n_placed + 1
        order(n_placed) = node
      end do
    end do
  end subroutine place_tile_nodes

  !> Place nodes that are wanted and not yet placed.
  pure subroutine place_rest(wanted, placed, order, n_placed)
    logical, intent(in) :: wanted(:)
    logical, intent(inout) :: placed(:)
    integer, intent(inout) :: order(:)
    integer, intent(inout) :: n_placed
    integer :: node

    do node = 1, size(wanted)
      if (placed(node) .or. .not. wanted(node)) cycle
      placed(node) = .true.
      n_placed = n_placed + 1
      order(n_placed) = node
    end do
  end subroutine place_rest

end module node_order_m
