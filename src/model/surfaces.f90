! SPDX-License-Identifier: MIT
!> Contact surfaces: ordered chains of 2-node segments, counter-clockwise about their own body, so
!> that the outward normal of a segment with unit tangent t is n = (t_y, -t_x). A surface may have
!> several chains, open or closed.
module surfaces_m
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: surface_t, link_segments, number_chains, has_closed_chain, meets_axis, &
    is_axis_edge, part_at_axis, open_ends

  !> One surface. "Local" node numbers count the nodes of this surface in walking order.
  type, extends(visited_t) :: surface_t
    integer :: n_node = 0
    integer :: n_segment = 0
    integer, allocatable :: nodes(:)           !! (n_node) node indices in the mesh, chain by chain
    integer, allocatable :: segments(:, :)     !! (2, n_segment) local numbers of start and end node
    integer, allocatable :: segment_element(:) !! (n_segment) index of the element behind
    integer, allocatable :: previous(:)        !! (n_segment) previous segment, 0 at a chain's start
    integer, allocatable :: next(:)            !! (n_segment) next segment, 0 at a chain's end
    integer, allocatable :: chain(:)           !! (n_segment) chain number
    integer, allocatable :: incoming(:)        !! (n_node) segment that ends at the node, or 0
    integer, allocatable :: outgoing(:)        !! (n_node) segment that starts at the node, or 0
    integer, allocatable :: parts(:)           !! parts whose boundary it is, where they may erode
    logical, allocatable :: is_on_axis(:)      !! (n_node) node on the axis, axisymmetric only
  contains
    procedure :: visit => visit_surface
  end type surface_t

contains

  !> Set the neighbour lists from `nodes` and `segments`.
  pure subroutine link_segments(surface)
    type(surface_t), intent(inout) :: surface
    integer :: s

    surface%n_node = size(surface%nodes)
    surface%n_segment = size(surface%segments, 2)
    surface%incoming = spread(0, 1, surface%n_node)
    surface%outgoing = surface%incoming
    surface%outgoing(surface%segments(1, :)) = [(s, s=1, surface%n_segment)]
    surface%incoming(surface%segments(2, :)) = [(s, s=1, surface%n_segment)]
    surface%previous = surface%incoming(surface%segments(1, :))
    surface%next = surface%outgoing(surface%segments(2, :))
    call number_chains(surface)
  end subroutine link_segments

  !> Whether a segment starts or ends on the axis of an axisymmetric body: the chain may end there,
  !> the surface does not.
  pure function meets_axis(surface, segment, at_start)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    logical, intent(in) :: at_start
    logical :: meets_axis

    meets_axis = allocated(surface%is_on_axis)
    if (meets_axis) meets_axis = surface%is_on_axis(surface%segments(merge(1, 2, at_start), &
      segment))
  end function meets_axis

  !> Whether a segment lies on the axis of an axisymmetric body, so that it is not a contact face.
  pure function is_axis_edge(surface, segment) result(is)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    logical :: is

    is = allocated(surface%is_on_axis)
    if (is) is = all(surface%is_on_axis(surface%segments(:, segment)))
  end function is_axis_edge

  !> Separate the contact faces of an axisymmetric body from its edges on the axis.
  pure subroutine part_at_axis(surface)
    type(surface_t), intent(inout) :: surface
    integer :: s

    do s = 1, surface%n_segment
      if (.not. is_axis_edge(surface, s)) cycle
      associate (before => surface%previous(s), after => surface%next(s))
        if (before > 0) then
          if (.not. is_axis_edge(surface, before)) then
            surface%outgoing(surface%segments(1, s)) = 0
            surface%next(before) = 0
            before = 0
          end if
        end if
        if (after > 0) then
          if (.not. is_axis_edge(surface, after)) then
            surface%incoming(surface%segments(2, s)) = 0
            surface%previous(after) = 0
            after = 0
          end if
        end if
      end associate
    end do
    call number_chains(surface)
  end subroutine part_at_axis

  !> (n_node) Number of sides of a node without a segment; 0 on the axis.
  pure function open_ends(surface) result(n)
    type(surface_t), intent(in) :: surface
    integer :: n(surface%n_node)
    integer :: s

    n = merge(1, 0, surface%incoming == 0) + merge(1, 0, surface%outgoing == 0)
    do s = 1, surface%n_segment
      if (is_axis_edge(surface, s)) n(surface%segments(:, s)) = 0
    end do
  end function open_ends

  !> Whether a surface has a closed chain, also one closed along the axis.
  pure function has_closed_chain(surface) result(closed)
    type(surface_t), intent(in) :: surface
    logical :: closed
    logical :: is_open(maxval([0, surface%chain]))
    integer :: s

    is_open = .false.
    is_open(pack(surface%chain, surface%previous == 0)) = .true.
    closed = .not. all(is_open)
    do s = 1, surface%n_segment
      closed = closed .or. is_axis_edge(surface, s)
    end do
  end function has_closed_chain

  !> Number the chains of a surface in the order of their first segments.
  pure subroutine number_chains(surface)
    type(surface_t), intent(inout) :: surface
    integer :: i, k, n

    if (allocated(surface%chain)) deallocate (surface%chain)
    allocate (surface%chain(surface%n_segment), source=0)
    n = 0
    do i = 1, surface%n_segment
      if (surface%chain(i) > 0) cycle
      n = n + 1
      k = i
      do while (surface%previous(k) > 0 .and. surface%previous(k) /= i)
        k = surface%previous(k)
      end do
      do while (k > 0)
        if (surface%chain(k) > 0) exit
        surface%chain(k) = n
        k = surface%next(k)
      end do
    end do
  end subroutine number_chains

  !> Visit the components of a surface.
  subroutine visit_surface(self, visitor)
    class(surface_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n_node', self%n_node)
    call visitor%visit('n_segment', self%n_segment)
    call visitor%visit('nodes', self%nodes)
    call visitor%visit('segments', self%segments)
    call visitor%visit('segment_element', self%segment_element)
    call visitor%visit('previous', self%previous)
    call visitor%visit('next', self%next)
    call visitor%visit('chain', self%chain)
    call visitor%visit('incoming', self%incoming)
    call visitor%visit('outgoing', self%outgoing)
    call visitor%visit('parts', self%parts)
    call visitor%visit('is_on_axis', self%is_on_axis)
  end subroutine visit_surface

end module surfaces_m
