! SPDX-License-Identifier: MIT
!> Exterior edges of a set of elements.
module boundary_m
  use kinds_m, only : long
  use sorting_m, only : sorted_order
  implicit none
  private
  public :: boundary_t, find_boundary, find_edge

  !> Exterior edges (edges of exactly one element), each counter-clockwise about its element, sorted
  !> by first node.
  type :: boundary_t
    integer :: n_edge = 0
    integer, allocatable :: nodes(:, :)  !! (2, n_edge)
    integer, allocatable :: elements(:)  !! (n_edge) element of each edge
    integer, allocatable :: start(:)     !! (n_node + 1) first edge that starts at each node
  end type boundary_t

contains

  !> Exterior edges of the chosen elements with both nodes in `among`. Linear in elements and nodes,
  !> except for the sorting of the edges found. An edge and its two halves to a hanging node, all of
  !> chosen elements, lie inside.
  pure subroutine find_boundary(element_nodes, chosen, among, boundary, hanging)
    integer, intent(in) :: element_nodes(:, :) !! (4, n) counter-clockwise; triangles repeat node 3
    logical, intent(in) :: chosen(:)           !! (n)
    logical, intent(in) :: among(:)            !! (n_node)
    type(boundary_t), intent(out) :: boundary
    integer, intent(in), optional :: hanging(:, :) !! (3, n) as in mesh_t, nodes 0: not there
    integer, allocatable :: latest(:)   !! (n_node) last edge so far with this lower node
    integer, allocatable :: before(:)   !! previous edge with the same lower node, 0: none
    logical, allocatable :: is_outer(:) !! by edge: 4 (element - 1) + first corner
    integer, allocatable :: outer(:)
    integer :: i, edge, other, node, ends(2), halves(3)

    allocate (latest(size(among)), before(4*size(chosen)), source=0)
    allocate (is_outer(4*size(chosen)), source=.false.)
    do edge = 1, size(is_outer)
      if (.not. chosen((edge + 3)/4)) cycle
      ends = ends_of(edge)
      if (ends(1) == ends(2) .or. .not. all(among(ends))) cycle
      is_outer(edge) = .true.
      node = minval(ends)
      other = latest(node)
      do while (other > 0)
        if (maxval(ends_of(other)) == maxval(ends)) is_outer([edge, other]) = .false.
        other = before(other)
      end do
      before(edge) = latest(node)
      latest(node) = edge
    end do
    if (present(hanging)) then
      do i = 1, size(hanging, 2)
        if (any(hanging(:, i) < 1)) cycle
        halves = [edge_between(hanging(1, i), hanging(2, i)), edge_between(hanging(1, i), &
          hanging(3, i)), edge_between(hanging(2, i), hanging(3, i))]
        if (all(halves > 0)) is_outer(halves) = .false.
      end do
    end if
    outer = pack([(i, i=1, size(is_outer))], is_outer)
    ! By first node, then lower node, then element.
    outer = outer(sorted_order([(sum(ends_of(outer(i))*[size(among) + 1_long, 0_long]) &
      + minval(ends_of(outer(i))), i=1, size(outer))]))
    boundary%n_edge = size(outer)
    boundary%nodes = reshape([(ends_of(outer(i)), i=1, size(outer))], [2, size(outer)])
    boundary%elements = (outer + 3)/4
    allocate (boundary%start(size(among) + 1), source=1)
    do i = 1, size(outer)
      boundary%start(boundary%nodes(1, i) + 1) = i + 1
    end do
    do node = 1, size(among) ! some have none
      boundary%start(node + 1) = max(boundary%start(node), boundary%start(node + 1))
    end do

  contains

    !> Nodes of an edge.
    pure function ends_of(edge) result(ends)
      integer, intent(in) :: edge
      integer :: ends(2), corner

      corner = modulo(edge - 1, 4) + 1
      ends = element_nodes([corner, modulo(corner, 4) + 1], (edge + 3)/4)
    end function ends_of

    !> The edge between two nodes if it is the only one, or 0.
    pure function edge_between(a, b) result(edge)
      integer, intent(in) :: a, b
      integer :: edge

      edge = latest(min(a, b))
      do while (edge > 0)
        if (is_outer(edge) .and. maxval(ends_of(edge)) == max(a, b)) return
        edge = before(edge)
      end do
    end function edge_between

  end subroutine find_boundary

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
