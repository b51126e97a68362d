! SPDX-License-Identifier: MIT
!> Exterior edges of a set of elements.
module boundary_m
  use kinds_m, only : long
  use sorting_m, only : sorted_order
  implicit none
  private
  public :: boundary_t, find_boundary, find_edge

  !> Exterior edges (of exactly one element), each walked counter-clockwise round its element,
  !> sorted by the node they leave.
  type :: boundary_t
    integer :: n_edge = 0
    integer, allocatable :: nodes(:, :)  !! (2, n_edge)
    integer, allocatable :: elements(:)  !! (n_edge) the element behind
    integer, allocatable :: start(:)     !! (n_node + 1) first edge leaving each node
  end type boundary_t

  !> All edges of the chosen elements, filed under the lower of their nodes.
  type :: edge_table_t
    integer, allocatable :: start(:)   !! (n_node + 1) first edge of each node
    integer, allocatable :: far(:)     !! the other node, negative when the edge runs from it
    integer, allocatable :: owner(:)   !! the element, 0 once the edge is known to be shared
  end type edge_table_t

contains

  !> Edges that exactly one of the chosen elements has. Only edges with both nodes in `among` are
  !> looked at. Linear in elements and nodes, but for the sorting of the edges found.
  pure subroutine find_boundary(element_nodes, chosen, among, boundary)
    integer, intent(in) :: element_nodes(:, :) !! (4, n) counter-clockwise; triangles repeat node 3
    logical, intent(in) :: chosen(:)           !! (n)
    logical, intent(in) :: among(:)            !! (n_node)
    type(boundary_t), intent(out) :: boundary
    type(edge_table_t) :: table
    integer, allocatable :: order(:)
    integer :: node, i, n, n_node

    n_node = size(among)
    call file_edges(element_nodes, chosen, among, table)
    call strike_shared(table, n_node)
    boundary%n_edge = count(table%owner > 0)
    allocate (boundary%nodes(2, boundary%n_edge), boundary%elements(boundary%n_edge))
    n = 0
    do node = 1, n_node
      do i = table%start(node), table%start(node + 1) - 1
        if (table%owner(i) == 0) cycle
        n = n + 1
        boundary%nodes(:, n) = [node, table%far(i)]
        if (table%far(i) < 0) boundary%nodes(:, n) = [-table%far(i), node]
        boundary%elements(n) = table%owner(i)
      end do
    end do
    order = sorted_order(int(boundary%nodes(1, :), long))
    boundary%nodes = boundary%nodes(:, order)
    boundary%elements = boundary%elements(order)
    allocate (boundary%start(n_node + 1), source=1)
    do i = 1, n
      boundary%start(boundary%nodes(1, i) + 1) = i + 1
    end do
    do node = 1, n_node ! some have none
      boundary%start(node + 1) = max(boundary%start(node), boundary%start(node + 1))
    end do
  end subroutine find_boundary

  !> File the edges of the chosen elements.
  pure subroutine file_edges(element_nodes, chosen, among, table)
    integer, intent(in) :: element_nodes(:, :)
    logical, intent(in) :: chosen(:)
    logical, intent(in) :: among(:)
    type(edge_table_t), intent(out) :: table
    integer, allocatable :: next(:)
    integer :: pass, i, k, a, b, node

    allocate (next(size(among) + 1))
    do pass = 1, 2
      next = 0
      if (pass == 2) next = table%start
      do i = 1, size(element_nodes, 2)
        if (.not. chosen(i)) cycle
        do k = 1, 4
          a = element_nodes(k, i)
          b = element_nodes(mod(k, 4) + 1, i)
          if (a == b .or. .not. (among(a) .and. among(b))) cycle
          node = min(a, b)
          if (pass == 2) table%far(next(node)) = merge(b, -a, a < b)
          if (pass == 2) table%owner(next(node)) = i
          next(node) = next(node) + 1
        end do
      end do
      if (pass == 2) exit
      allocate (table%start(size(next)))
      table%start(1) = 1
      do node = 1, size(among)
        table%start(node + 1) = table%start(node) + next(node)
      end do
      allocate (table%far(table%start(size(next)) - 1), table%owner(table%start(size(next)) - 1))
    end do
  end subroutine file_edges

  !> Strike out (owner 0) every edge that more than one element has.
  pure subroutine strike_shared(table, n_node)
    type(edge_table_t), intent(inout) :: table
    integer, intent(in) :: n_node
    integer, allocatable :: n_use(:)
    integer :: node, i, first, last

    allocate (n_use(n_node), source=0)
    do node = 1, n_node
      first = table%start(node)
      last = table%start(node + 1) - 1
      do i = first, last
        n_use(abs(table%far(i))) = n_use(abs(table%far(i))) + 1
      end do
      do i = first, last
        if (n_use(abs(table%far(i))) > 1) table%owner(i) = 0
      end do
      do i = first, last
        n_use(abs(table%far(i))) = 0
      end do
    end do
  end subroutine strike_shared

  !> The exterior edge from node `a` to node `b`, or 0.
  pure function find_edge(boundary, a, b) result(edge)
    type(boundary_t), intent(in) :: boundary
    integer, intent(in) :: a, b
    integer :: edge

    do edge = boundary%start(a), boundary%start(a + 1) - 1
      if (boundary%nodes(2, edge) == b) return
    end do
    edge = 0
  end function find_edge

end module boundary_m
