! SPDX-License-Identifier: MIT
!> The part of the results file that is written once: mesh and ids, in deck order.
module results_mesh_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use, intrinsic :: iso_fortran_env, only : int8
  use archive_m, only : archive_t
  use kinds_m, only : long
  use model_m, only : model_t
  use mesh_m, only : mesh_t
  use visitor_m, only : as_bytes, item_t
  implicit none
  private
  public :: write_mesh, deck_order, deck_nodes, cell_nodes, cell_starts

  !> VTK's numbers of the cell types.
  integer(int8), parameter :: vtk_triangle = 5, vtk_quad = 9

contains

  !> Write counts, connectivity, cell types and the ids of nodes, elements and parts.
  subroutine write_mesh(file, model)
    type(archive_t), intent(inout) :: file             !! in the group /VTKHDF
    type(model_t), intent(in) :: model
    integer, allocatable :: starts(:), nodes(:), ids(:)
    integer(int8), allocatable, target :: kinds(:)
    integer :: n_cell

    n_cell = model%mesh%n_element
    starts = cell_starts(model%mesh%element_nodes)
    nodes = cell_nodes(model%mesh)
    allocate (kinds(n_cell))
    kinds = merge(vtk_triangle, vtk_quad, starts(2:) - starts(:n_cell) == 3)
    call write_count('NumberOfPoints', model%mesh%n_node)
    call write_count('NumberOfCells', n_cell)
    call write_count('NumberOfConnectivityIds', size(nodes))
    call file%visit('Connectivity', nodes)
    call file%visit('Offsets', starts)
    call file%pass(item_t('Types', as_bytes, 1, [n_cell, 1]), c_loc(kinds))
    ids = model%mesh%node_id(deck_order(model%mesh))
    call file%visit('PointData/node_id', ids)
    ids = model%mesh%element_id
    call file%visit('CellData/element_id', ids)
    ids = model%parts(model%mesh%element_part)%id
    call file%visit('CellData/part_id', ids)

  contains

    !> Write a dataset of one number.
    subroutine write_count(name, count)
      character(*), intent(in) :: name
      integer, intent(in) :: count
      integer(long) :: number

      number = count
      call file%visit(name, number, 0_long, '')
    end subroutine write_count

  end subroutine write_mesh

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
