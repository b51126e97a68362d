! SPDX-License-Identifier: MIT
!> Memory layout of elements and nodes during the time steps.
!>
!> Elements are stored in slots. A chunk is `chunk_size` consecutive slots of one part; its last
!> slots may be padding. A tile is a sequence of chunks whose elements are neighbours in space.
!> Special nodes come first (nodes of several tiles, contact, loads or prescribed motion), then,
!> tile by tile, the interior nodes of one tile. Elements of rigid bodies have slots after all
!> tiles; their other nodes come last, and time steps skip both. A tile assembles the forces of its
!> interior nodes and moves them. Forces on special nodes are stored in one force slot per tile and
!> node and added in a fixed order, so that results have the same bits at any number of threads.
module layout_m
  use, intrinsic :: iso_fortran_env, only : int16
  use, intrinsic :: iso_c_binding, only : c_loc
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, length, of_elements, of_slots
  implicit none
  private
  public :: layout_t, tile_t, chunk_size, local_kind, slot_part, first_slot, last_slot

  !> Integer kind of local node numbers: a tile has at most 512 elements with 2048 nodes.
  integer, parameter :: local_kind = int16

  !> Elements per chunk; the speed is about the same from 32 to 128, larger chunks exceed the L1
  !> cache.
  integer, parameter :: chunk_size = 64

  !> One tile.
  type :: tile_t
    integer :: first_chunk = 1, last_chunk = 0
    integer :: first_node = 1, last_node = 0     !! interior nodes
    integer :: first_owned = 1, last_owned = 0   !! special nodes that its thread assembles and
                                                 !! moves; in the last tile also unconnected ones
    integer :: first_special = 1, last_special = 0 !! range in the list of force slots
  end type tile_t

  !> The layout of the whole model.
  type, extends(visited_t) :: layout_t
    integer :: n_slot = 0          !! element slots, chunk_size * n_chunk
    integer :: n_chunk = 0
    integer :: n_special = 0       !! nodes 1 .. n_special are special
    integer :: n_local = 0         !! largest number of local nodes of a tile
    type(tile_t), allocatable :: tiles(:)
    integer, allocatable :: chunk_part(:)    !! (n_chunk) part index
    integer, allocatable :: chunk_elements(:) !! (n_chunk) number of elements, in the first slots
    integer, allocatable :: slot_element(:)  !! (n_slot) element index, 0 for padding
    integer, allocatable :: element_slot(:)  !! (n_element) slot of each element
    integer, allocatable :: slot_nodes(:, :) !! (4, n_slot) node indices; all equal in padding
    integer(local_kind), allocatable :: slot_local(:, :) !! (4, n_slot) local numbers in the tile:
                                             !! interior nodes from 1, then its special nodes;
                                             !! all equal in padding
    integer, allocatable :: exposed(:)       !! slots of exposed quads (`find_exposed`)
    real(wp), allocatable :: exposed_shares(:, :) !! (4, size(exposed)) shares of nodal masses
    integer, allocatable :: special_node(:)  !! (force slots) node of each force slot, tile by tile
    integer, allocatable :: node_slots(:)    !! (n_special + 1) start of each special node's list
                                             !! ...
    integer, allocatable :: slot_list(:)     !! ... in this list of force slots
  contains
    procedure :: visit => visit_layout
  end type layout_t

contains

  !> Part index of the element in a slot.
  pure integer function slot_part(layout, slot)
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: slot

    slot_part = layout%chunk_part((slot - 1)/chunk_size + 1)
  end function slot_part

  !> First element slot of a tile.
  pure integer function first_slot(tile)
    type(tile_t), intent(in) :: tile

    first_slot = (tile%first_chunk - 1)*chunk_size + 1
  end function first_slot

  !> Last element slot of a tile.
  pure integer function last_slot(tile)
    type(tile_t), intent(in) :: tile

    last_slot = tile%last_chunk*chunk_size
  end function last_slot

  !> Visit the components of the layout.
  subroutine visit_layout(self, visitor)
    class(layout_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n_slot', self%n_slot)
    call visitor%visit('n_chunk', self%n_chunk)
    call visitor%visit('n_special', self%n_special)
    call visitor%visit('n_local', self%n_local)
    if (visitor%makes(length(self%tiles))) allocate (self%tiles(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%tiles(1)), storage_size(self%tiles), visitor%n_item)
    call visitor%visit('chunk_part', self%chunk_part)
    call visitor%visit('chunk_elements', self%chunk_elements)
    call visitor%visit('slot_element', self%slot_element, of_slots)
    call visitor%visit('element_slot', self%element_slot, of_elements)
    call visitor%visit('slot_nodes', self%slot_nodes, of_slots)
    call visitor%visit('slot_local', self%slot_local, of_slots)
    call visitor%visit('exposed', self%exposed)
    call visitor%visit('exposed_shares', self%exposed_shares)
    call visitor%visit('special_node', self%special_node)
    call visitor%visit('node_slots', self%node_slots)
    call visitor%visit('slot_list', self%slot_list)
  end subroutine visit_layout

end module layout_m
