! SPDX-License-Identifier: MIT
!> Node, segment and part sets, with indices in place of user ids.
module sets_m
  implicit none
  private
  public :: node_set_t, segment_set_t, part_set_t

  !> *SET_NODE: members in the order of the deck (walking order where a surface is meant).
  type :: node_set_t
    integer :: id = 0
    character(:), allocatable :: title !! only where the deck gives one
    integer, allocatable :: nodes(:) !! node indices
  end type node_set_t

  !> *SET_SEGMENT, *SET_2D_SEGMENT: edges by their two nodes.
  type :: segment_set_t
    integer :: id = 0
    integer, allocatable :: nodes(:, :) !! (2, n) node indices
    integer, allocatable :: parts(:)    !! indices of the parts whose boundary they are, where they
                                        !! are one
  end type segment_set_t

  !> *SET_PART.
  type :: part_set_t
    integer :: id = 0
    integer, allocatable :: parts(:) !! indices into model%parts
  end type part_set_t

end module sets_m
