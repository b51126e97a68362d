! SPDX-License-Identifier: MIT
!> The part of the results file that is written once: mesh and ids, in deck order.
module results_mesh_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use hdf5, only : hid_t, H5T_STD_U8LE
  use kinds_m, only : long
  use errors_m, only : error_t
  use model_m, only : model_t
  use mesh_m, only : mesh_t
  use hdf5_writing_m, only : as_integer, as_index, write_rows
  implicit none
  private
  public :: write_mesh, deck_order, deck_nodes, cell_nodes, cell_starts

  !> VTK's numbers of the cell types.
  integer, parameter :: vtk_triangle = 5, vtk_quad = 9

contains

  !> Write counts, connectivity, cell types and the ids of nodes, elements and parts.
  subroutine write_mesh(group, model, error)
    integer(hid_t), intent(in) :: group                !! the open group /VTKHDF
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(inout) :: error !! nothing is written when there is one
    integer, allocatable, target :: starts(:), nodes(:), kinds(:), ids(:)
    integer :: n_cell

    n_cell = model%mesh%n_element
    allocate (starts(n_cell + 1), kinds(n_cell), ids(max(n_cell, model%mesh%n_node)))
    starts = cell_starts(model%mesh%element_nodes)
    allocate (nodes, source=cell_nodes(model%mesh))
    kinds = merge(vtk_triangle, vtk_quad, starts(2:) - starts(:n_cell) == 3)
    call write_count(group, 'NumberOfPoints', model%mesh%n_node, error)
    call write_count(group, 'NumberOfCells', n_cell, error)
    call write_count(group, 'NumberOfConnectivityIds', size(nodes), error)
    call write_rows(group, 'Connectivity', as_integer, size(nodes), c_loc(nodes), error)
    call write_rows(group, 'Offsets', as_integer, size(starts), c_loc(starts), error)
    call write_rows(group, 'Types', as_integer, n_cell, c_loc(kinds), error, H5T_STD_U8LE)
    ids(:model%mesh%n_node) = model%mesh%node_id(deck_order(model%mesh))
    call write_rows(group, 'PointData/node_id', as_integer, model%mesh%n_node, c_loc(ids), error)
    ids(:n_cell) = model%mesh%element_id
    call write_rows(group, 'CellData/element_id', as_integer, n_cell, c_loc(ids), error)
    ids(:n_cell) = model%parts(model%mesh%element_part)%id
    call write_rows(group, 'CellData/part_id', as_integer, n_cell, c_loc(ids), error)
  end subroutine write_mesh

  !> Write a dataset of one number.
  subroutine write_count(group, name, count, error)
    integer(hid_t), intent(in) :: group
    character(*), intent(in) :: name
    integer, intent(in) :: count
    type(error_t), allocatable, intent(inout) :: error
    integer(long), target :: number(1)

    number = count
    call write_rows(group, name, as_index, 1, c_loc(number), error)
  end subroutine write_count

  !> Index of the node that came k-th in the deck; the order of the mesh when it was not renumbered.
  pure function deck_order(mesh) result(order)
    type(mesh_t), intent(in) :: mesh
    integer :: order(mesh%n_node)

    order = deck_nodes(mesh, 1, mesh%n_node)
  end function deck_order

  !> The same of `n` nodes from the k-th on.
  pure function deck_nodes(mesh, k, n) result(nodes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: k, n
    integer :: nodes(n)
    integer :: i

    if (allocated(mesh%deck_node)) then
      nodes = mesh%deck_node(k:k + n - 1)
    else
      nodes = [(i, i=k, k + n - 1)]
    end if
  end function deck_nodes

  !> Where the nodes of each cell start in the list of `cell_nodes`, from zero, and its length at
  !> the end. A triangle repeats its third node in the mesh and has three entries in the list.
  pure function cell_starts(element_nodes) result(starts)
    integer, intent(in) :: element_nodes(:, :)   !! (4, n_element)
    integer :: starts(size(element_nodes, 2) + 1)
    integer :: i

    starts(1) = 0
    do i = 1, size(element_nodes, 2)
      starts(i + 1) = starts(i) + merge(3, 4, element_nodes(4, i) == element_nodes(3, i))
    end do
  end function cell_starts

  !> Points of all cells, one cell after the other, counted from zero in the order of the deck.
  pure function cell_nodes(mesh) result(points)
    type(mesh_t), intent(in) :: mesh
    integer, allocatable :: points(:)
    integer :: starts(mesh%n_element + 1), point_of_node(mesh%n_node)
    integer :: i, n

    point_of_node(deck_order(mesh)) = [(i - 1, i=1, mesh%n_node)]
    starts = cell_starts(mesh%element_nodes)
    allocate (points(starts(mesh%n_element + 1)))
    do i = 1, mesh%n_element
      n = starts(i + 1) - starts(i)
      points(starts(i) + 1:starts(i + 1)) = point_of_node(mesh%element_nodes(:n, i))
    end do
  end function cell_nodes

end module results_mesh_m
