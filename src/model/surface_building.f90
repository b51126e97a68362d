! SPDX-License-Identifier: MIT
!> Builds surfaces from exterior edges: the boundary as chains, the chain of a list of nodes, and
!> the remaining surface after erosion.
module surface_building_m
  use boundary_m, only : boundary_t, find_boundary, find_edge
  use kinds_m, only : wp
  use mesh_m, only : mesh_t
  use surfaces_m, only : surface_t, link_segments, part_at_axis
  implicit none
  private
  public :: boundary_surface, chain_surface, remaining_surface, chain_good, chain_turned, &
    chain_ordered, chain_broken, chain_repeated, chain_short

  !> Result of a chain from a list of nodes: as given, reversed, sorted; or an error: two neighbours
  !> in the list without an exterior edge, a repeated node, fewer than two nodes.
  integer, parameter :: chain_good = 0, chain_turned = 1, chain_ordered = 2, chain_broken = 3, &
    chain_repeated = 4, chain_short = 5

  !> Elements at nodes that the boundary passes more than once.
  type :: corners_t
    integer, allocatable :: node(:), element(:)
  end type corners_t

contains

  !> The chosen edges of a boundary as chains, open ones first. `crossing` is a node where chains
  !> touch, in which case there is no surface, or 0.
  pure subroutine boundary_surface(boundary, is_chosen, surface, crossing)
    type(boundary_t), intent(in) :: boundary
    logical, intent(in) :: is_chosen(:)    !! (n_edge)
    type(surface_t), intent(out) :: surface
    integer, intent(out) :: crossing
    integer, allocatable :: outgoing(:), n_incoming(:), edges(:)
    logical, allocatable :: is_first(:)
    integer :: pass, node, here, i, n

    allocate (outgoing(size(boundary%start) - 1), n_incoming(size(boundary%start) - 1), source=0)
    crossing = huge(1)
    do i = 1, boundary%n_edge
      if (.not. is_chosen(i)) cycle
      associate (from => boundary%nodes(1, i), to => boundary%nodes(2, i))
        n_incoming(to) = n_incoming(to) + 1
        if (outgoing(from) > 0) crossing = min(crossing, from)
        if (n_incoming(to) > 1) crossing = min(crossing, to)
        outgoing(from) = i
      end associate
    end do
    if (crossing < huge(1)) return
    crossing = 0
    allocate (edges(boundary%n_edge))
    allocate (is_first(boundary%n_edge), source=.false.)
    n = 0
    do pass = 1, 2
      do node = 1, size(outgoing)
        if (outgoing(node) == 0 .or. (pass == 1 .and. n_incoming(node) > 0)) cycle
        is_first(n + 1) = .true.
        here = node
        do while (outgoing(here) > 0)
          n = n + 1
          edges(n) = outgoing(here)
          outgoing(here) = 0
          here = boundary%nodes(2, edges(n))
        end do
      end do
    end do
    call chain_edges(boundary, edges(:n), is_first(:n), surface)
  end subroutine boundary_surface

  !> The surface of edges in walking order. A chain that ends at its first node is closed; the
  !> surface has a node once for each passage.
  pure subroutine chain_edges(boundary, edges, is_first, surface)
    type(boundary_t), intent(in) :: boundary
    integer, intent(in) :: edges(:)
    logical, intent(in) :: is_first(:)     !! (size(edges)) of its chain
    type(surface_t), intent(inout) :: surface
    integer :: s, n, first

    allocate (surface%nodes(2*size(edges)), surface%segments(2, size(edges)))
    surface%segment_element = boundary%elements(edges)
    n = 0
    do s = 1, size(edges)
      if (is_first(s)) then
        first = n + 1
        surface%nodes(first) = boundary%nodes(1, edges(s))
        n = first
      end if
      surface%segments(:, s) = [n, n + 1]
      if (is_last(s) .and. boundary%nodes(2, edges(s)) == surface%nodes(first)) then
        surface%segments(2, s) = first
      else
        n = n + 1
        surface%nodes(n) = boundary%nodes(2, edges(s))
      end if
    end do
    surface%nodes = surface%nodes(:n)
    call link_segments(surface)

  contains

    !> Whether an edge is the last one of its chain.
    pure logical function is_last(s)
      integer, intent(in) :: s

      is_last = s == size(edges)
      if (.not. is_last) is_last = is_first(s + 1)
    end function is_last

  end subroutine chain_edges

  !> The chain of a list of nodes; the first node repeated at the end makes it closed. The list may
  !> be reversed, or unsorted if its exterior edges form one chain.
  pure subroutine chain_surface(boundary, given, surface, outcome, bad_nodes)
    type(boundary_t), intent(in) :: boundary
    integer, intent(in) :: given(:)        !! node indices
    type(surface_t), intent(out) :: surface
    integer, intent(out) :: outcome        !! one of the `chain_` constants
    integer, intent(out) :: bad_nodes(2)   !! nodes of the first break, or the repeated node
    integer, allocatable :: ahead(:), back(:)
    logical, allocatable :: is_listed(:)
    logical :: closed
    integer :: n, i, n_link

    bad_nodes = 0
    outcome = chain_short
    n = size(given)
    closed = .false.
    if (n > 2) closed = given(n) == given(1)
    if (closed) n = n - 1
    if (n < 2) return
    allocate (is_listed(size(boundary%start) - 1), source=.false.)
    do i = 1, n
      outcome = chain_repeated
      bad_nodes = given(i)
      if (is_listed(given(i))) return
      is_listed(given(i)) = .true.
    end do
    bad_nodes = 0
    n_link = merge(n, n - 1, closed)
    ahead = [(find_edge(boundary, given(i), given(mod(i, n) + 1)), i=1, n_link)]
    back = [(find_edge(boundary, given(mod(i, n) + 1), given(i)), i=1, n_link)]
    if (all(ahead > 0)) then
      outcome = chain_good
      call chain_edges(boundary, ahead, [(i == 1, i=1, n_link)], surface)
    else if (all(back > 0)) then
      outcome = chain_turned
      back = merge(cshift(back(n_link:1:-1), 1), back(n_link:1:-1), closed)
      call chain_edges(boundary, back, [(i == 1, i=1, n_link)], surface)
    else
      call order_chain(boundary, is_listed, given(:n), closed, surface, outcome)
    end if
    if (outcome /= chain_broken) return
    ! In the walking direction of most edges.
    if (count(ahead > 0) < count(back > 0)) ahead = back
    i = findloc(ahead > 0, .false., 1)
    bad_nodes = given([i, mod(i, n) + 1])
  end subroutine chain_surface

  !> The single chain of the exterior edges between nodes of a list; a closed one starts at the
  !> first node of the list.
  pure subroutine order_chain(boundary, is_listed, given, closed, surface, outcome)
    type(boundary_t), intent(in) :: boundary
    logical, intent(in) :: is_listed(:)    !! (n_node)
    integer, intent(in) :: given(:)        !! the list
    logical, intent(in) :: closed          !! a closed chain is required
    type(surface_t), intent(out) :: surface
    integer, intent(out) :: outcome
    type(surface_t) :: found
    integer :: crossing, shift

    outcome = chain_broken
    call boundary_surface(boundary, is_listed(boundary%nodes(1, :)) &
      .and. is_listed(boundary%nodes(2, :)), found, crossing)
    if (crossing > 0) return
    if (found%n_node < size(given) .or. any(found%chain > 1)) return
    if (closed .and. found%previous(1) == 0) return
    outcome = chain_ordered
    surface = found
    if (surface%previous(1) == 0) return
    shift = findloc(surface%nodes, given(1), 1) - 1
    surface%nodes = cshift(surface%nodes, shift)
    surface%segment_element = cshift(surface%segment_element, shift)
  end subroutine order_chain

  !> The surface after erosion: the boundary of the remaining elements of its parts; of other
  !> surfaces the segments of remaining elements, in their order.
  pure subroutine remaining_surface(mesh, is_left, initial, surface)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_left(:)     !! (n_element)
    type(surface_t), intent(in) :: initial !! without erosion
    type(surface_t), intent(out) :: surface
    type(boundary_t) :: boundary
    logical, allocatable :: chosen_part(:), is_chosen(:), is_near(:)
    integer :: i

    if (allocated(initial%parts)) then
      allocate (chosen_part(maxval(mesh%element_part)), source=.false.)
      chosen_part(initial%parts) = .true.
      is_chosen = chosen_part(mesh%element_part)
      if (.not. any(is_chosen .and. .not. is_left)) then
        surface = initial
        return
      end if
      is_chosen = is_chosen .and. is_left
      ! Candidates: nodes of the initial surface and of eroded elements.
      allocate (is_near(size(mesh%coordinates, 2)), source=.false.)
      is_near(initial%nodes) = .true.
      do i = 1, size(is_left)
        if (.not. is_left(i)) is_near(mesh%element_nodes(:, i)) = .true.
      end do
      call find_boundary(mesh%element_nodes, is_chosen, is_near, boundary, mesh%hanging)
      call walk_boundary(mesh, is_chosen, boundary, surface)
      surface%parts = initial%parts
    else
      call copy_remaining(is_left, initial, surface)
    end if
    if (.not. allocated(initial%is_on_axis)) return
    surface%is_on_axis = .not. mesh%coordinates(1, surface%nodes) > 0.0_wp
    call part_at_axis(surface)
  end subroutine remaining_surface

  !> The segments of a surface with remaining elements.
  pure subroutine copy_remaining(is_left, initial, surface)
    logical, intent(in) :: is_left(:)
    type(surface_t), intent(in) :: initial
    type(surface_t), intent(out) :: surface
    integer, allocatable :: segments(:), nodes(:)
    integer :: new_index(initial%n_node), s

    segments = pack([(s, s=1, initial%n_segment)], is_left(initial%segment_element))
    surface%segment_element = initial%segment_element(segments)
    surface%segments = initial%segments(:, segments)
    new_index = 0
    do s = 1, size(segments)
      new_index(surface%segments(:, s)) = 1
    end do
    nodes = pack([(s, s=1, initial%n_node)], new_index > 0)
    new_index(nodes) = [(s, s=1, size(nodes))]
    surface%nodes = initial%nodes(nodes)
    do s = 1, size(segments)
      surface%segments(:, s) = new_index(surface%segments(:, s))
    end do
    call link_segments(surface)
  end subroutine copy_remaining

  !> Closed chains of a boundary. At a node that it passes more than once a chain follows the
  !> elements of its last edge.
  pure subroutine walk_boundary(mesh, is_chosen, boundary, surface)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_chosen(:)
    type(boundary_t), intent(in) :: boundary
    type(surface_t), intent(out) :: surface
    type(corners_t) :: corners
    logical, dimension(boundary%n_edge) :: is_used, is_first
    integer :: edges(boundary%n_edge), start, edge, n

    call find_corners(mesh, is_chosen, boundary, corners)
    is_used = .false.
    is_first = .false.
    n = 0
    ! Edges are sorted by first node.
    do start = 1, boundary%n_edge
      if (is_used(start)) cycle
      edge = start
      is_first(n + 1) = .true.
      do while (.not. is_used(edge))
        is_used(edge) = .true.
        n = n + 1
        edges(n) = edge
        edge = edge_behind(mesh, boundary, corners, edge)
      end do
    end do
    call chain_edges(boundary, edges, is_first, surface)
  end subroutine walk_boundary

  !> Chosen elements at nodes where several edges start.
  pure subroutine find_corners(mesh, is_chosen, boundary, corners)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_chosen(:)
    type(boundary_t), intent(in) :: boundary
    type(corners_t), intent(out) :: corners
    logical, allocatable :: is_crossing(:)
    integer :: i, n

    n = size(boundary%start) - 1
    allocate (is_crossing(n))
    is_crossing = boundary%start(2:) - boundary%start(:n) > 1
    allocate (corners%node(0), corners%element(0))
    if (.not. any(is_crossing)) return
    do i = 1, size(is_chosen)
      if (.not. is_chosen(i)) cycle
      associate (nodes => mesh%element_nodes(:, i))
        if (.not. any(is_crossing(nodes))) cycle
        corners%node = [corners%node, pack(nodes, is_crossing(nodes))]
        corners%element = [corners%element, spread(i, 1, count(is_crossing(nodes)))]
      end associate
    end do
  end subroutine find_corners

  !> The edge that follows another along the elements of their common node.
  pure function edge_behind(mesh, boundary, corners, edge) result(next)
    type(mesh_t), intent(in) :: mesh
    type(boundary_t), intent(in) :: boundary
    type(corners_t), intent(in) :: corners
    integer, intent(in) :: edge
    integer :: next
    integer :: node, far, element, i, step

    node = boundary%nodes(2, edge)
    next = boundary%start(node)
    if (boundary%start(node + 1) - next == 1) return
    element = boundary%elements(edge)
    do step = 1, size(corners%node)
      far = node_behind(mesh%element_nodes(:, element), node)
      do next = boundary%start(node), boundary%start(node + 1) - 1
        if (boundary%nodes(2, next) == far .and. boundary%elements(next) == element) return
      end do
      do i = 1, size(corners%node)
        if (corners%node(i) /= node) cycle
        if (node_behind(mesh%element_nodes(:, corners%element(i)), far) == node) exit
      end do
      if (i > size(corners%node)) exit
      element = corners%element(i)
    end do
    next = boundary%start(node)
  end function edge_behind

  !> The node that follows another around an element; 0 where the element does not have it.
  pure function node_behind(nodes, node) result(behind)
    integer, intent(in) :: nodes(4), node
    integer :: behind
    integer :: k

    behind = 0
    do k = 1, 4
      if (nodes(k) /= node) cycle
      behind = nodes(mod(k, 4) + 1)
      if (behind /= node) return
    end do
  end function node_behind

end module surface_building_m
