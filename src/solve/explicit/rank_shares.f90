! SPDX-License-Identifier: MIT
!> Which process of a run has which tiles, and what goes with them: ranges of chunks, nodes and
!> force slots, since all of these stand tile by tile.
module rank_shares_m
  use kinds_m, only : wp
  use layout_m, only : layout_t
  implicit none
  private
  public :: shares_t, share_out, tile_elements

  !> All arrays (0:n): where the range of each process starts, then one beyond the last.
  type :: shares_t
    integer, allocatable :: tiles(:), chunks(:)
    integer, allocatable :: nodes(:)       !! interior
    integer, allocatable :: special(:)     !! special nodes that its tiles own
    integer, allocatable :: force_slots(:)
    integer :: first_tile = 1, last_tile = 0 !! of this process
  end type shares_t

contains

  !> Ranges of tiles with about as many elements each, or as much work; a process may have none.
  pure function share_out(layout, mine, n, work) result(shares)
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: mine, n !! number of this process, and how many there are
    real(wp), intent(in), optional :: work(:) !! of each tile
    type(shares_t) :: shares
    real(wp) :: weights(size(layout%tiles)), before, total
    integer :: i, owner, last

    weights = tile_elements(layout)
    if (present(work)) weights = work

    allocate (shares%tiles(0:n), shares%chunks(0:n), shares%nodes(0:n), shares%force_slots(0:n))
    allocate (shares%special(0:n))
    associate (tiles => layout%tiles)
      total = max(tiny(1.0_wp), sum(weights))
      before = 0.0_wp
      last = -1
      do i = 1, size(tiles)
        owner = min(n - 1, int(n*((before + 0.5_wp*weights(i))/total)))
        before = before + weights(i)
        do while (last < owner)
          last = last + 1
          call start_range(last, i)
        end do
      end do
      do while (last < n)
        last = last + 1
        call start_range(last, size(tiles) + 1)
      end do
    end associate
    shares%first_tile = shares%tiles(mine)
    shares%last_tile = shares%tiles(mine + 1) - 1

  contains

    !> What process `rank` has begins with tile `i`.
    pure subroutine start_range(rank, i)
      integer, intent(in) :: rank, i

      associate (tiles => layout%tiles)
        shares%tiles(rank) = i
        shares%nodes(rank) = layout%n_special + 1 &
          + sum(tiles(:i - 1)%last_node - tiles(:i - 1)%first_node + 1)
        shares%force_slots(rank) = 1 &
          + sum(tiles(:i - 1)%last_special - tiles(:i - 1)%first_special + 1)
        shares%chunks(rank) = tiles(size(tiles))%last_chunk + 1
        shares%special(rank) = layout%n_special + 1
        if (i > size(tiles)) return
        shares%chunks(rank) = tiles(i)%first_chunk
        shares%special(rank) = tiles(i)%first_owned
      end associate
    end subroutine start_range

  end function share_out

  !> Elements of each tile.
  pure function tile_elements(layout) result(n)
    type(layout_t), intent(in) :: layout
    real(wp) :: n(size(layout%tiles))
    integer :: i

    do i = 1, size(layout%tiles)
      n(i) = sum(layout%chunk_elements(layout%tiles(i)%first_chunk:layout%tiles(i)%last_chunk))
    end do
  end function tile_elements

end module rank_shares_m
