! SPDX-License-Identifier: MIT
!> The table of pieces: stretches of slave segments, each over one master segment. Formulations that
!> go along both chains fill it with some slave segments at a time and take all pieces together, so
!> that their roots and quotients are formed together.
module piece_table_m
  use kinds_m, only : wp
  implicit none
  private
  public :: piece_table_t, allocate_pieces, grow_pieces, shrink_pieces, n_piece_block, &
    is_listed_piece, is_last_piece, is_walked_piece

  !> Pieces that are taken together; a slave segment with more of them makes the table grow.
  integer, parameter :: n_piece_block = 64
  !> Kinds of pieces: one of a list, the last one of its slave segment, and one whose start and end
  !> the walk has found.
  integer, parameter :: is_listed_piece = 1, is_last_piece = 2, is_walked_piece = 3

  !> One column per piece; those of a slave segment follow each other along it.
  type :: piece_table_t
    integer :: n_segment = 0              !! slave segments in use
    integer :: n = 0                      !! pieces in use
    logical :: is_full = .false.          !! no other segment may fit
    real(wp) :: least_cut = 0.0_wp        !! part of a slave segment next to its ends where master
                                          !! nodes need not cut it
    integer, allocatable :: slave(:)      !! (segments) of the slave
    integer, allocatable :: last(:)       !! (0:segments) last piece of each
    logical, allocatable :: touches(:)    !! (segments) both ends are in contact
    integer, allocatable :: ends(:, :)    !! (2, pieces) nodes of the slave segment
    integer, allocatable :: master(:)     !! segment of the master; 0: faces none
    integer, allocatable :: nodes(:, :)   !! (2, pieces) local numbers of its nodes
    integer, allocatable :: first_cut(:)  !! master node that cuts where it starts, 0: none
    integer, allocatable :: last_cut(:)   !! and where it ends
    integer, allocatable :: kind(:)       !! one of the constants above
    real(wp), allocatable :: own(:, :)    !! (2, pieces) vector of the slave segment, m
    real(wp), allocatable :: other(:, :)  !! (2, pieces) vector of the master segment, m
    real(wp), allocatable :: way(:, :)    !! (2, pieces) from the master segment's first node to the
                                          !! first end of the slave segment, m
    real(wp), allocatable :: length(:)    !! of the slave segment, m
    real(wp), allocatable :: normal(:, :) !! (2, pieces) of the slave segment
    real(wp), allocatable :: cut(:)       !! projection of the master segment's first node on the
                                          !! slave segment
    real(wp), allocatable :: low(:)       !! where it starts on the slave segment, 0 to 1
    real(wp), allocatable :: high(:)      !! where it ends; not above `low`: an empty piece
    real(wp), allocatable :: node_gap(:)  !! of the master segment's first node over the slave
                                          !! segment, m
    real(wp), allocatable :: share(:)     !! how much of it counts: 0 where the segments do not face
    real(wp), allocatable :: half(:)      !! scratch: half its length as far as it counts, m
    integer, allocatable :: rows(:)       !! scratch: some pieces
  end type piece_table_t

contains

  !> Allocate for `capacity` pieces.
  pure subroutine allocate_pieces(table, capacity)
    type(piece_table_t), intent(inout) :: table
    integer, intent(in) :: capacity

    allocate (table%slave(capacity), table%last(0:capacity), table%master(capacity), &
      table%ends(2, capacity), table%nodes(2, capacity), table%first_cut(capacity), &
      table%last_cut(capacity), table%kind(capacity), table%rows(capacity), source=0)
    allocate (table%touches(capacity), source=.false.)
    allocate (table%own(2, capacity), table%other(2, capacity), table%way(2, capacity), &
      table%length(capacity), table%normal(2, capacity), table%cut(capacity), &
      table%low(capacity), table%high(capacity), &
      table%node_gap(capacity), table%share(capacity), table%half(capacity), source=0.0_wp)
  end subroutine allocate_pieces

  !> Double the room; what the filling has written stays.
  pure subroutine grow_pieces(table)
    type(piece_table_t), intent(inout) :: table
    type(piece_table_t) :: larger

    call allocate_pieces(larger, 2*size(table%master))
    associate (n => table%n, m => table%n_segment)
      larger%n_segment = m
      larger%n = n
      larger%slave(:m) = table%slave(:m)
      larger%last(:m) = table%last(:m)
      larger%touches(:m) = table%touches(:m)
      larger%ends(:, :n) = table%ends(:, :n)
      larger%master(:n) = table%master(:n)
      larger%first_cut(:n) = table%first_cut(:n)
      larger%last_cut(:n) = table%last_cut(:n)
      larger%kind(:n) = table%kind(:n)
      larger%low(:n) = table%low(:n)
      larger%high(:n) = table%high(:n)
    end associate
    table = larger
  end subroutine grow_pieces

  !> Back to the room of the start; nothing stays.
  pure subroutine shrink_pieces(table)
    type(piece_table_t), intent(inout) :: table
    type(piece_table_t) :: smaller

    call allocate_pieces(smaller, n_piece_block)
    table = smaller
  end subroutine shrink_pieces

end module piece_table_m
