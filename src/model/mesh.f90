! SPDX-License-Identifier: MIT
!> Nodes and elements. The deck layer fills the mesh in deck order. `renumber_model` then sorts the
!> nodes for fast time steps and stores the inverse in `deck_node`; elements stay in deck order, and
!> `layout_t` has their chunks. An explicit run deallocates nodes and parts of elements before the
!> first step (`release_start_data`). Index arrays never contain user ids.
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
    integer, allocatable :: deck_node(:)        !! (n_node) index of the k-th node of the deck
    integer, allocatable :: hanging(:, :)       !! (3, n) hanging node in the middle of an edge, and
                                                !! the ends of the edge, its parents; allocated
                                                !! where the deck has some
    integer, allocatable :: dependents(:, :)    !! (2, 2 n) each parent, and its hanging node, by
                                                !! rising parent, after renumbering
  contains
    procedure :: visit => visit_mesh
  end type mesh_t

contains

  !> Visit the components of the mesh, without `deck_node`: the first process writes the results.
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
    call visitor%visit('hanging', self%hanging)
    call visitor%visit('dependents', self%dependents)
  end subroutine visit_mesh

end module mesh_m
