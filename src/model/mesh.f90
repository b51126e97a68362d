! SPDX-License-Identifier: MIT
!> Nodes and elements.
!> The deck layer fills the mesh in deck order. `renumber_model` then puts nodes into the order the
!> step is fastest in and keeps the way back in `deck_node`; elements stay in deck order here and
!> are laid out in chunks by `layout_t`, and an explicit run gives the arrays of their nodes and
!> parts up before it steps (`forget_start`). User ids never appear in any index array.
module mesh_m
  use kinds_m, only : wp
  implicit none
  private
  public :: mesh_t

  !> The mesh at time zero.
  type :: mesh_t
    integer :: n_node = 0
    integer :: n_element = 0
    integer, allocatable :: node_id(:)          !! (n_node) user ids
    real(wp), allocatable :: coordinates(:, :)  !! (2, n_node) x and y at time zero
    integer, allocatable :: element_id(:)       !! (n_element) user ids
    integer, allocatable :: element_nodes(:, :) !! (4, n_element) node indices, counter-clockwise;
                                                !! a triangle repeats its third node
    integer, allocatable :: element_part(:)     !! (n_element) index into model%parts
    integer, allocatable :: deck_node(:)        !! (n_node) index of the node that came k-th in the
                                                !! deck
  end type mesh_t

end module mesh_m
