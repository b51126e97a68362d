! SPDX-License-Identifier: MIT
!> Which tiles share nodes, and which have nodes that feel more than their elements.
module tile_neighbours_m
  use layout_m, only : layout_t
  use model_m, only : model_t
  use renumber_m, only : mark_moved_nodes
  implicit none
  private
  public :: neighbours_t, find_neighbours

  !> Of all tiles.
  type :: neighbours_t
    logical, allocatable :: is_touched(:) !! contact, loads, prescribed motion, walls or bodies that
                                          !! are rigid may move its nodes
    integer, allocatable :: first(:)      !! (tiles + 1) where the neighbours of each tile start ...
    integer, allocatable :: near(:)       !! ... in this list
  end type neighbours_t

contains

  !> Find both.
  subroutine find_neighbours(model, neighbours)
    type(model_t), intent(in) :: model
    type(neighbours_t), intent(out) :: neighbours
    logical, allocatable :: is_touched(:)
    integer :: i

    call mark_moved_nodes(model, is_touched)
    associate (layout => model%layout, n => size(model%layout%tiles))
      allocate (neighbours%is_touched(n))
      do i = 1, n
        neighbours%is_touched(i) = any(is_touched(layout%special_node( &
          layout%tiles(i)%first_special:layout%tiles(i)%last_special)))
      end do
      ! The last one has the nodes without element, too.
      neighbours%is_touched(n) = .true.
    end associate
    call list_neighbours(model%layout, neighbours)
  end subroutine find_neighbours

  !> For each tile those that have special nodes in common with it: counted, then listed.
  subroutine list_neighbours(layout, neighbours)
    type(layout_t), intent(in) :: layout
    type(neighbours_t), intent(inout) :: neighbours
    integer, allocatable :: tile_of(:), last_met(:)
    integer :: i, n

    allocate (tile_of(size(layout%special_node)))
    do i = 1, size(layout%tiles)
      tile_of(layout%tiles(i)%first_special:layout%tiles(i)%last_special) = i
    end do
    allocate (last_met(size(layout%tiles)), neighbours%first(size(layout%tiles) + 1))
    call walk(.false.)
    allocate (neighbours%near(n))
    call walk(.true.)

  contains

    !> Along the force slots of each tile, to those of others on the same nodes.
    subroutine walk(lists)
      logical, intent(in) :: lists
      integer :: k, m

      last_met = 0
      n = 0
      do i = 1, size(layout%tiles)
        neighbours%first(i) = n + 1
        last_met(i) = i
        do k = layout%tiles(i)%first_special, layout%tiles(i)%last_special
          do m = layout%node_slots(layout%special_node(k)), &
            layout%node_slots(layout%special_node(k) + 1) - 1
            associate (other => tile_of(layout%slot_list(m)))
              if (last_met(other) == i) cycle
              last_met(other) = i
              n = n + 1
              if (lists) neighbours%near(n) = other
            end associate
          end do
        end do
      end do
      neighbours%first(i) = n + 1
    end subroutine walk

  end subroutine list_neighbours

end module tile_neighbours_m
