! SPDX-License-Identifier: MIT
!> Nodes and elements.
!> The deck layer fills the mesh in deck order. `renumber_model` then puts nodes into the order the
!> step is fastest in and keeps the way back in `deck_node`; elements stay in deck order here and
!> are laid out in chunks by `layout_t`, and an explicit run gives the arrays of their nodes and
!> parts up before it steps (`release_start_data`). User ids never appear in any index array.
module mesh_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, of_elements, of_nodes
  implicit none
  private
  public :: mesh_t

  !> The mesh at time zero.
  type, extends(visited_t) :: mesh_t
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
  contains
    procedure :: visit => visit_mesh
  end type mesh_t

contains

  !> Its components, but for the order of results, which the first process writes.
  subroutine visit_mesh(self, visitor)
    class(mesh_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n_node', self%n_node)
    call visitor%visit('n_element', self%n_element)
    call visitor%visit('node_id', self%node_id, of_nodes)
    call visitor%visit('coordinates', self%coordinates, of_nodes)
    call visitor%visit('element_id', self%element_id, of_elements)
    call visitor%visit('element_nodes', self%element_nodes, of_elements)
    call visitor%visit('element_part', self%element_part, of_elements)
  end subroutine visit_mesh

end module mesh_m
