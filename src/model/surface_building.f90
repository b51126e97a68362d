! SPDX-License-Identifier: MIT
!> Surfaces from exterior edges: the whole boundary as chains, and the chain that a list of nodes
!> describes.
module surface_building_m
  use boundary_m, only : boundary_t, find_edge
  use surfaces_m, only : surface_t, link_segments
  implicit none
  private
  public :: boundary_surface, chain_surface, chain_good, chain_turned, chain_ordered, &
    chain_broken, chain_repeated, chain_short

  !> How a list of nodes became a chain: as given, walked the other way, put into order; or why not:
  !> two neighbours in the list share no exterior edge, a node comes twice, fewer than two nodes.
  integer, parameter :: chain_good = 0, chain_turned = 1, chain_ordered = 2, chain_broken = 3, &
    chain_repeated = 4, chain_short = 5

contains

  !> The whole boundary as chains, open ones first. `crossing` is a node where the boundary touches
  !> itself (no chains can be made then), or 0.
  pure subroutine boundary_surface(boundary, surface, crossing)
    type(boundary_t), intent(in) :: boundary
    type(surface_t), intent(out) :: surface
    integer, intent(out) :: crossing
    integer, allocatable :: n_incoming(:)
    logical, allocatable :: used(:)
    integer :: node, n_node, i, n, s

    n_node = size(boundary%start) - 1
    allocate (n_incoming(n_node), source=0)
    crossing = 0
    do i = 1, boundary%n_edge
      n_incoming(boundary%nodes(2, i)) = n_incoming(boundary%nodes(2, i)) + 1
    end do
    do node = 1, n_node
      if (boundary%start(node + 1) - boundary%start(node) > 1 .or. n_incoming(node) > 1) then
        crossing = node
        return
      end if
    end do
    allocate (surface%nodes(2*boundary%n_edge), surface%segments(2, boundary%n_edge), &
      surface%segment_element(boundary%n_edge))
    allocate (used(boundary%n_edge), source=.false.)
    n = 0
    s = 0
    do node = 1, n_node
      if (n_incoming(node) == 0) call walk(boundary, node, used, surface, n, s)
    end do
    do node = 1, n_node
      call walk(boundary, node, used, surface, n, s)
    end do
    surface%nodes = surface%nodes(:n)
    call link_segments(surface)
  end subroutine boundary_surface

  !> Follow unused edges from a node to the end of its chain, or round to its start.
  pure subroutine walk(boundary, first_node, used, surface, n, s)
    type(boundary_t), intent(in) :: boundary
    integer, intent(in) :: first_node
    logical, intent(inout) :: used(:)
    type(surface_t), intent(inout) :: surface
    integer, intent(inout) :: n, s    !! nodes and segments so far
    integer :: node, edge, first_local

    edge = boundary%start(first_node)
    if (edge == boundary%start(first_node + 1)) return
    if (used(edge)) return
    n = n + 1
    first_local = n
    surface%nodes(n) = first_node
    node = first_node
    do
      edge = boundary%start(node)
      if (edge == boundary%start(node + 1)) exit
      if (used(edge)) exit
      used(edge) = .true.
      node = boundary%nodes(2, edge)
      s = s + 1
      surface%segment_element(s) = boundary%elements(edge)
      if (node == first_node) then
        surface%segments(:, s) = [n, first_local]
        exit
      end if
      n = n + 1
      surface%nodes(n) = node
      surface%segments(:, s) = [n - 1, n]
    end do
  end subroutine walk

  !> The chain that a list of nodes describes; its first node repeated at the end makes it closed.
  !> The list may be walked backwards, or in no order as long as its exterior edges form one
  !> chain, closed where the list is; `outcome` says which. When it fails `trouble` holds the two
  !> nodes of the first break, or the repeated node.
  pure subroutine chain_surface(boundary, given, surface, outcome, trouble)
    type(boundary_t), intent(in) :: boundary
    integer, intent(in) :: given(:)        !! node indices
    type(surface_t), intent(out) :: surface
    integer, intent(out) :: outcome        !! one of the `chain_` constants
    integer, intent(out) :: trouble(2)
    integer, allocatable :: chain(:), position(:), ahead(:), back(:)
    logical :: closed, is_ring
    integer :: n, i, n_link

    trouble = 0
    outcome = chain_short
    n = size(given)
    closed = .false.
    if (n > 2) closed = given(n) == given(1)
    if (closed) n = n - 1
    if (n < 2) return
    chain = given(:n)
    allocate (position(size(boundary%start) - 1), source=0)
    do i = 1, n
      outcome = chain_repeated
      trouble = chain(i)
      if (position(chain(i)) > 0) return
      position(chain(i)) = i
    end do
    trouble = 0
    outcome = chain_good
    n_link = merge(n, n - 1, closed)
    ahead = [(find_edge(boundary, chain(i), chain(mod(i, n) + 1)), i=1, n_link)]
    back = [(find_edge(boundary, chain(mod(i, n) + 1), chain(i)), i=1, n_link)]
    if (any(ahead == 0) .and. all(back > 0)) then
      outcome = chain_turned
      chain = chain(n:1:-1)
    else if (any(ahead == 0)) then
      is_ring = closed
      call order_chain(boundary, position, chain, closed, outcome)
      if (is_ring .and. .not. closed) outcome = chain_broken
    end if
    if (outcome == chain_broken) then
      ! In the walking direction that most of the edges have.
      if (count(ahead > 0) < count(back > 0)) ahead = back
      i = findloc(ahead > 0, .false., 1)
      trouble = given([i, mod(i, n) + 1])
      return
    end if
    call build_chain(boundary, chain, closed, surface)
  end subroutine chain_surface

  !> Put the nodes into the one order that their exterior edges allow.
  pure subroutine order_chain(boundary, position, chain, closed, outcome)
    type(boundary_t), intent(in) :: boundary
    integer, intent(in) :: position(:)      !! place of each node in the list, or 0
    integer, intent(inout) :: chain(:)
    logical, intent(inout) :: closed
    integer, intent(out) :: outcome
    integer, allocatable :: next(:), n_incoming(:), ordered(:)
    integer :: i, edge, first, n

    outcome = chain_broken
    n = size(chain)
    allocate (next(n), n_incoming(n), source=0)
    do i = 1, n
      do edge = boundary%start(chain(i)), boundary%start(chain(i) + 1) - 1
        if (position(boundary%nodes(2, edge)) == 0) cycle
        if (next(i) > 0) return
        next(i) = position(boundary%nodes(2, edge))
        n_incoming(next(i)) = n_incoming(next(i)) + 1
      end do
    end do
    if (any(n_incoming > 1) .or. count(n_incoming == 0) > 1) return
    first = 1
    do i = n, 1, -1
      if (n_incoming(i) == 0) first = i
    end do
    allocate (ordered(n))
    i = first
    do edge = 1, n
      if (i == 0) return
      if (edge > 1 .and. i == first) return
      ordered(edge) = chain(i)
      i = next(i)
    end do
    closed = i == first
    chain = ordered
    outcome = chain_ordered
  end subroutine order_chain

  !> Fill a surface from a chain whose edges are all there.
  pure subroutine build_chain(boundary, chain, closed, surface)
    type(boundary_t), intent(in) :: boundary
    integer, intent(in) :: chain(:)
    logical, intent(in) :: closed
    type(surface_t), intent(inout) :: surface
    integer :: i, n, n_segment

    n = size(chain)
    n_segment = merge(n, n - 1, closed)
    surface%nodes = chain
    allocate (surface%segments(2, n_segment), surface%segment_element(n_segment))
    do i = 1, n_segment
      surface%segments(:, i) = [i, mod(i, n) + 1]
      surface%segment_element(i) = boundary%elements(find_edge(boundary, chain(i), &
        chain(mod(i, n) + 1)))
    end do
    call link_segments(surface)
  end subroutine build_chain

end module surface_building_m
