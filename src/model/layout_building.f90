! SPDX-License-Identifier: MIT
!> Builds the layout of a mesh: elements along a Hilbert curve, divided into tiles and chunks; order
!> of the nodes in memory, by the tiles that own them; local node numbers of the tiles.
module layout_building_m
  use kinds_m, only : wp, long
  use layout_m, only : layout_t, tile_t, chunk_size, local_kind, first_slot, last_slot
  use mesh_m, only : mesh_t
  use sorting_m, only : sorted_order
  implicit none
  private
  public :: build_slots, build_local_numbers, order_nodes

  !> Elements of a tile: its nodes and forces fit into the fast caches, and few nodes are shared.
  integer, parameter :: tile_elements = 512
  !> Cells of the Hilbert curve along each axis, 2^16.
  integer, parameter :: curve_bits = 16
  !> More than any distance along the curve.
  integer(long), parameter :: beyond_curve = 2_long**40

  !> Owner of nodes that no tile assembles.
  integer, parameter :: no_owner = 0

contains

  !> Build tiles, chunks and slots of the elements: tile by tile along the curve, rigid elements
  !> after all tiles; in a tile part by part, each from the first slot of a chunk.
  subroutine build_slots(mesh, is_rigid, layout)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_rigid(:)    !! (n_element) of a rigid body
    type(layout_t), intent(out) :: layout !! without node numbers
    integer, allocatable :: order(:), tile(:)
    integer :: n_tile, n_moving, i, i_chunk

    order = sorted_order(hilbert_keys(mesh) + merge(beyond_curve, 0_long, is_rigid))
    n_moving = count(.not. is_rigid)
    n_tile = max(1, (n_moving + tile_elements - 1)/tile_elements)
    allocate (layout%tiles(n_tile), tile(mesh%n_element))
    tile(order(n_moving + 1:)) = n_tile + 1
    do i = 1, n_moving
      ! Elements n (t - 1)/n_tile + 1 .. n t/n_tile, rounded down, of tile t.
      tile(order(i)) = int((int(i, long)*n_tile + n_moving - 1)/n_moving)
    end do
    call fill_slots(mesh, tile, layout)
    allocate (layout%chunk_part(layout%n_chunk), layout%chunk_elements(layout%n_chunk), &
      layout%slot_element(layout%n_slot), source=0)
    do i = 1, mesh%n_element
      i_chunk = (layout%element_slot(i) - 1)/chunk_size + 1
      layout%slot_element(layout%element_slot(i)) = i
      layout%chunk_part(i_chunk) = mesh%element_part(i)
      layout%chunk_elements(i_chunk) = layout%chunk_elements(i_chunk) + 1
      if (tile(i) > n_tile) cycle
      layout%tiles(tile(i))%last_chunk = max(layout%tiles(tile(i))%last_chunk, i_chunk)
    end do
    do i = 2, n_tile
      layout%tiles(i)%first_chunk = layout%tiles(i - 1)%last_chunk + 1
    end do
  end subroutine build_slots

  !> Slot of each element: by tile, part and element number.
  subroutine fill_slots(mesh, tile, layout)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: tile(:)           !! (n_element)
    type(layout_t), intent(inout) :: layout
    integer(long), allocatable :: keys(:)
    integer, allocatable :: order(:)
    integer :: i

    keys = int(tile, long)*(maxval(mesh%element_part) + 1) + mesh%element_part
    order = sorted_order(keys)
    allocate (layout%element_slot(mesh%n_element))
    do i = 1, mesh%n_element
      if (i > 1) then
        if (keys(order(i)) > keys(order(i - 1))) &
          layout%n_slot = (layout%n_slot + chunk_size - 1)/chunk_size*chunk_size
      end if
      layout%n_slot = layout%n_slot + 1
      layout%element_slot(order(i)) = layout%n_slot
    end do
    layout%n_chunk = (layout%n_slot + chunk_size - 1)/chunk_size
    layout%n_slot = layout%n_chunk*chunk_size
  end subroutine fill_slots

  !> Node numbers of the slots, global and local to the tile, and the force slots of special nodes;
  !> `mesh` has been renumbered.
  subroutine build_local_numbers(mesh, layout)
    type(mesh_t), intent(in) :: mesh
    type(layout_t), intent(inout) :: layout
    integer, allocatable :: marks(:), local(:), special(:)
    integer :: i_tile, slot, n_special_slots, i

    allocate (layout%slot_nodes(4, layout%n_slot), layout%slot_local(4, layout%n_slot))
    allocate (marks(mesh%n_node), local(layout%n_special), source=0)
    allocate (special(4*mesh%n_element))
    n_special_slots = 0
    do i_tile = 1, size(layout%tiles)
      call number_tile(mesh, i_tile, layout, marks, local, special, n_special_slots)
    end do
    ! Slots after all tiles have no local numbers.
    do slot = last_slot(layout%tiles(size(layout%tiles))) + 1, layout%n_slot
      layout%slot_local(:, slot) = 0_local_kind
      if (layout%slot_element(slot) > 0) then
        layout%slot_nodes(:, slot) = mesh%element_nodes(:, layout%slot_element(slot))
      else
        layout%slot_nodes(:, slot) = layout%slot_nodes(1, slot - 1)
      end if
    end do
    layout%special_node = special(:n_special_slots)
    ! Force slots of each special node, in increasing order.
    layout%slot_list = sorted_order(int(layout%special_node, long))
    allocate (layout%node_slots(layout%n_special + 1), source=1)
    do i = 1, size(layout%slot_list)
      layout%node_slots(layout%special_node(layout%slot_list(i)) + 1) = i + 1
    end do
    do i = 1, layout%n_special ! some have none
      layout%node_slots(i + 1) = max(layout%node_slots(i), layout%node_slots(i + 1))
    end do
  end subroutine build_local_numbers

  !> Local numbers of one tile. Its special nodes get the next force slots, by node number, so that
  !> nodes that two threads share are contiguous.
  subroutine number_tile(mesh, i_tile, layout, marks, local, special, n_special_slots)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: i_tile
    type(layout_t), intent(inout) :: layout
    integer, intent(inout) :: marks(:)        !! (n_node) last tile of each node
    integer, intent(inout) :: local(:)        !! (n_special) last force slot of each special node
    integer, intent(inout) :: special(:)      !! node of each force slot
    integer, intent(inout) :: n_special_slots
    integer, allocatable :: nodes(:)
    integer :: n_interior, first_special, slot, k, node

    associate (tile => layout%tiles(i_tile))
      n_interior = tile%last_node - tile%first_node + 1
      first_special = n_special_slots + 1
      call list_nodes(mesh, tile, layout%slot_element, i_tile, marks, nodes)
      nodes = pack(nodes, nodes <= layout%n_special)
      nodes = nodes(sorted_order(int(nodes, long)))
      n_special_slots = n_special_slots + size(nodes)
      special(first_special:n_special_slots) = nodes
      local(nodes) = [(k, k=first_special, n_special_slots)]
      do slot = first_slot(tile), last_slot(tile)
        if (layout%slot_element(slot) == 0) cycle
        do k = 1, 4
          node = mesh%element_nodes(k, layout%slot_element(slot))
          layout%slot_nodes(k, slot) = node
          if (node > layout%n_special) then
            layout%slot_local(k, slot) = int(node - tile%first_node + 1, local_kind)
          else
            layout%slot_local(k, slot) = int(n_interior + local(node) - first_special + 1, &
              local_kind)
          end if
        end do
      end do
      tile%first_special = first_special
      tile%last_special = n_special_slots
      do slot = first_slot(tile), last_slot(tile)
        if (layout%slot_element(slot) /= 0) cycle
        layout%slot_nodes(:, slot) = layout%slot_nodes(1, slot - 1)
        layout%slot_local(:, slot) = layout%slot_local(1, slot - 1)
      end do
      layout%n_local = max(layout%n_local, n_interior + n_special_slots - first_special + 1)
    end associate
  end subroutine number_tile

  !> Position of each element's centre along a Hilbert curve over the bounding box.
  pure function hilbert_keys(mesh) result(keys)
    type(mesh_t), intent(in) :: mesh
    integer(long), allocatable :: keys(:) !! (n_element)
    real(wp) :: low(2), cell, centre(2)
    integer :: i, cells

    cells = 2**curve_bits
    low = minval(mesh%coordinates, 2)
    cell = max(maxval(maxval(mesh%coordinates, 2) - low), tiny(1.0_wp))/cells
    allocate (keys(mesh%n_element))
    do i = 1, mesh%n_element
      centre = 0.25_wp*sum(mesh%coordinates(:, mesh%element_nodes(:, i)), 2)
      keys(i) = hilbert_distance(min(int((centre(1) - low(1))/cell), cells - 1), &
        min(int((centre(2) - low(2))/cell), cells - 1))
    end do
  end function hilbert_keys

  !> Distance along the Hilbert curve of the cell (x, y) of a 2^curve_bits square.
  pure function hilbert_distance(x, y) result(distance)
    integer, intent(in) :: x, y !! 0 .. 2^curve_bits - 1
    integer(long) :: distance
    integer :: p, q, rx, ry, side, swap

    p = x
    q = y
    distance = 0
    side = 2**(curve_bits - 1)
    do while (side > 0)
      rx = merge(1, 0, iand(p, side) > 0)
      ry = merge(1, 0, iand(q, side) > 0)
      distance = distance + int(side, long)*side*ieor(3*rx, ry)
      if (ry == 0) then
        if (rx == 1) then
          p = 2**curve_bits - 1 - p
          q = 2**curve_bits - 1 - q
        end if
        swap = p
        p = q
        q = swap
      end if
      side = side/2
    end do
  end function hilbert_distance

  !> New order of the nodes: special nodes by owning tile, interior nodes by tile, other nodes of
  !> rigid bodies; within a tile in the order of its elements. Sets the node ranges of the tiles.
  subroutine order_nodes(mesh, is_rigid, is_special, layout, order)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_rigid(:)      !! (n_node) of a rigid body
    logical, intent(inout) :: is_special(:) !! (n_node) in: by contact, loads etc.; out: all
    type(layout_t), intent(inout) :: layout
    integer, allocatable, intent(out) :: order(:) !! (n_node) present index of each new node
    logical, allocatable :: is_numbered(:)
    integer, allocatable :: owner(:), marks(:), nodes(:)
    integer :: i, k, n_numbered

    call find_owners(mesh, is_rigid, layout, is_special, owner)
    allocate (order(mesh%n_node), marks(mesh%n_node), source=0)
    allocate (is_numbered(mesh%n_node), source=.false.)
    n_numbered = 0
    do i = 1, size(layout%tiles)
      layout%tiles(i)%first_owned = n_numbered + 1
      call list_nodes(mesh, layout%tiles(i), layout%slot_element, i, marks, nodes)
      call append(pack(nodes, owner(nodes) == i))
      layout%tiles(i)%last_owned = n_numbered
    end do
    call append(pack([(k, k=1, mesh%n_node)], is_special .and. .not. is_numbered))
    layout%tiles(size(layout%tiles))%last_owned = n_numbered
    layout%n_special = n_numbered
    do i = 1, size(layout%tiles)
      layout%tiles(i)%first_node = n_numbered + 1
      call list_nodes(mesh, layout%tiles(i), layout%slot_element, -i, marks, nodes)
      call append(pack(nodes, owner(nodes) == no_owner .and. .not. is_numbered(nodes)))
      layout%tiles(i)%last_node = n_numbered
    end do
    call append(pack([(k, k=1, mesh%n_node)], .not. (is_special .or. is_numbered)))

  contains

    !> Append the next nodes.
    subroutine append(next)
      integer, intent(in) :: next(:)

      order(n_numbered + 1:n_numbered + size(next)) = next
      is_numbered(next) = .true.
      n_numbered = n_numbered + size(next)
    end subroutine append

  end subroutine order_nodes

  !> Special nodes and their owning tiles. Nodes of several tiles are special, nodes without an
  !> element, and nodes of a rigid body with a deformable element. Of the special nodes shared with
  !> a later tile, every second one belongs to the earlier tile, which balances the work of the
  !> threads.
  subroutine find_owners(mesh, is_rigid, layout, is_special, owner)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_rigid(:)
    type(layout_t), intent(in) :: layout
    logical, intent(inout) :: is_special(:)
    integer, allocatable, intent(out) :: owner(:) !! (n_node) a tile or no_owner
    integer, allocatable :: last_tile(:), last_seen(:), n_touch(:), nodes(:), n_common(:)
    integer :: i_tile, i

    allocate (owner(mesh%n_node), source=no_owner)
    allocate (last_tile(mesh%n_node), last_seen(mesh%n_node), n_touch(mesh%n_node), &
      n_common(size(layout%tiles)), source=0)
    do i_tile = 1, size(layout%tiles)
      call list_nodes(mesh, layout%tiles(i_tile), layout%slot_element, i_tile, last_tile, nodes)
      n_touch(nodes) = n_touch(nodes) + 1
    end do
    is_special = is_special .or. n_touch > 1 .or. (n_touch == 0 .neqv. is_rigid)
    do i_tile = 1, size(layout%tiles)
      call list_nodes(mesh, layout%tiles(i_tile), layout%slot_element, i_tile, last_seen, nodes)
      nodes = pack(nodes, is_special(nodes) .and. owner(nodes) == no_owner)
      do i = 1, size(nodes)
        associate (n => n_common(last_tile(nodes(i))))
          n = n + 1
          if (last_tile(nodes(i)) == i_tile .or. modulo(n, 2) == 1) owner(nodes(i)) = i_tile
        end associate
      end do
      n_common(last_tile(nodes)) = 0
    end do
  end subroutine find_owners

  !> The nodes of a tile in the order of its elements.
  subroutine list_nodes(mesh, tile, slot_element, mark, marks, nodes)
    type(mesh_t), intent(in) :: mesh
    type(tile_t), intent(in) :: tile
    integer, intent(in) :: slot_element(:)
    integer, intent(in) :: mark                !! of this tile
    integer, intent(inout) :: marks(:)         !! (n_node) marks of listed nodes
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

end module layout_building_m
