! SPDX-License-Identifier: MIT
!> Surfaces of what is left once elements have gone.
module surface_outline_m
  use boundary_m, only : boundary_t, find_boundary
  use kinds_m, only : wp
  use mesh_m, only : mesh_t
  use surfaces_m, only : surface_t, link_segments
  implicit none
  private
  public :: surface_left

  !> Elements at the nodes where the boundary touches itself.
  type :: corners_t
    integer :: n = 0
    integer, allocatable :: node(:), element(:)
  end type corners_t

contains

  !> The outline of the elements that are left, where the surface is that of parts; else its
  !> segments whose elements are left, in their order.
  pure subroutine surface_left(mesh, is_left, former, surface)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_left(:)     !! (n_element)
    type(surface_t), intent(in) :: former !! of the deck, before anything left
    type(surface_t), intent(out) :: surface
    type(boundary_t) :: boundary
    logical, allocatable :: chosen_part(:), is_chosen(:), is_near(:)
    integer :: i

    if (allocated(former%parts)) then
      allocate (chosen_part(maxval(mesh%element_part)), source=.false.)
      chosen_part(former%parts) = .true.
      is_chosen = chosen_part(mesh%element_part)
      if (.not. any(is_chosen .and. .not. is_left)) then
        surface = former
        return
      end if
      is_chosen = is_chosen .and. is_left
      ! Nodes that the outline can have: those of the deck's, and of elements that have gone.
      allocate (is_near(size(mesh%coordinates, 2)), source=.false.)
      is_near(former%nodes) = .true.
      do i = 1, size(is_left)
        if (.not. is_left(i)) is_near(mesh%element_nodes(:, i)) = .true.
      end do
      call find_boundary(mesh%element_nodes, is_chosen, is_near, boundary)
      call walk_outline(mesh, is_chosen, boundary, surface)
      surface%parts = former%parts
    else
      call take_left(is_left, former, surface)
    end if
    if (allocated(former%is_on_axis)) surface%is_on_axis = &
      .not. mesh%coordinates(1, surface%nodes) > 0.0_wp
  end subroutine surface_left

  !> Segments of a surface whose elements are left.
  pure subroutine take_left(is_left, former, surface)
    logical, intent(in) :: is_left(:)
    type(surface_t), intent(in) :: former
    type(surface_t), intent(out) :: surface
    integer :: place(former%n_node), s, n, k

    n = count(is_left(former%segment_element))
    allocate (surface%segments(2, n), surface%segment_element(n))
    place = 0
    n = 0
    do s = 1, former%n_segment
      if (.not. is_left(former%segment_element(s))) cycle
      n = n + 1
      surface%segments(:, n) = former%segments(:, s)
      surface%segment_element(n) = former%segment_element(s)
      place(former%segments(:, s)) = 1
    end do
    n = 0
    do k = 1, former%n_node
      if (place(k) == 0) cycle
      n = n + 1
      place(k) = n
    end do
    surface%nodes = pack(former%nodes, place > 0)
    do s = 1, size(surface%segments, 2)
      surface%segments(:, s) = place(surface%segments(:, s))
    end do
    call link_segments(surface)
  end subroutine take_left

  !> Closed chains of a boundary. Where it touches itself in a node a chain goes on along the
  !> elements that it came by, and the node stands in the surface once for each passage.
  pure subroutine walk_outline(mesh, is_chosen, boundary, surface)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: is_chosen(:)
    type(boundary_t), intent(in) :: boundary
    type(surface_t), intent(out) :: surface
    type(corners_t) :: corners
    logical, allocatable :: is_used(:)
    integer :: start, edge, n, first

    call find_corners(mesh, is_chosen, boundary, corners)
    allocate (surface%nodes(boundary%n_edge), surface%segments(2, boundary%n_edge), &
      surface%segment_element(boundary%n_edge))
    allocate (is_used(boundary%n_edge), source=.false.)
    n = 0
    ! Edges are sorted by the node that they leave.
    do start = 1, boundary%n_edge
      if (is_used(start)) cycle
      edge = start
      first = n + 1
      do while (.not. is_used(edge))
        is_used(edge) = .true.
        n = n + 1
        surface%nodes(n) = boundary%nodes(1, edge)
        surface%segments(:, n) = [n, n + 1]
        surface%segment_element(n) = boundary%elements(edge)
        edge = edge_behind(mesh, boundary, corners, edge)
      end do
      surface%segments(2, n) = first
    end do
    call link_segments(surface)
  end subroutine walk_outline

  !> Chosen elements at nodes that several edges leave.
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
    corners%n = size(corners%node)
  end subroutine find_corners

  !> The edge that follows another along its elements.
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
    do step = 1, corners%n
      far = node_behind(mesh%element_nodes(:, element), node)
      do next = boundary%start(node), boundary%start(node + 1) - 1
        if (boundary%nodes(2, next) == far .and. boundary%elements(next) == element) return
      end do
      do i = 1, corners%n
        if (corners%node(i) /= node) cycle
        if (node_behind(mesh%element_nodes(:, corners%element(i)), far) == node) exit
      end do
      if (i > corners%n) exit
      element = corners%element(i)
    end do
    next = boundary%start(node)
  end function edge_behind

  !> The node that follows another round an element, 0 where it has not that one.
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

end module surface_outline_m
