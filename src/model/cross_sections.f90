! SPDX-License-Identifier: MIT
!> Cross sections whose forces the histories tell (secforc).
module cross_sections_m
  use kinds_m, only : long
  use layout_m, only : layout_t
  use sorting_m, only : sorted_order
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: cross_section_t, find_edges, mark_corners, n_cut

  !> One *DATABASE_CROSS_SECTION_SET.
  type, extends(visited_t) :: cross_section_t
    integer :: id = 0                   !! user number, or its position in the deck
    character(:), allocatable :: title
    integer, allocatable :: nodes(:)    !! node indices, each once
    integer, allocatable :: elements(:) !! element indices, each once; by rising slot once there is
                                        !! a layout
    logical, allocatable :: is_corner(:, :) !! (4, elements) corners that are nodes of it
    integer, allocatable :: edges(:, :) !! (2, n) edges of the elements with both nodes in it
  contains
    procedure :: visit => visit_section
  end type cross_section_t

contains

  !> Elements of all sections.
  pure function n_cut(sections) result(n)
    type(cross_section_t), intent(in) :: sections(:)
    integer :: n, i

    n = sum([(size(sections(i)%elements), i=1, size(sections))])
  end function n_cut

  !> The edges of the elements that lie in the section, each once.
  subroutine find_edges(element_nodes, section)
    integer, intent(in) :: element_nodes(:, :) !! (4, n_element)
    type(cross_section_t), intent(inout) :: section
    integer, allocatable :: edges(:, :), order(:)
    logical, allocatable :: is_in(:)
    integer :: i, k, n, a, b

    allocate (is_in(maxval(element_nodes)), source=.false.)
    is_in(section%nodes) = .true.
    allocate (edges(2, 4*size(section%elements)))
    n = 0
    do i = 1, size(section%elements)
      do k = 1, 4
        a = element_nodes(k, section%elements(i))
        b = element_nodes(mod(k, 4) + 1, section%elements(i))
        if (a == b .or. .not. (is_in(a) .and. is_in(b))) cycle
        n = n + 1
        edges(:, n) = [min(a, b), max(a, b)]
      end do
    end do
    edges = edges(:, :n)
    order = sorted_order(edges(1, :)*int(size(is_in), long) + edges(2, :))
    edges = edges(:, order)
    k = 0
    do i = 1, n
      if (k > 0) then
        if (all(edges(:, k) == edges(:, i))) cycle
      end if
      k = k + 1
      edges(:, k) = edges(:, i)
    end do
    section%edges = edges(:, :k)
  end subroutine find_edges

  !> Find the corners of the elements that are nodes of the section, once there is a layout.
  subroutine mark_corners(layout, n_node, section)
    type(layout_t), intent(in) :: layout
    integer, intent(in) :: n_node
    type(cross_section_t), intent(inout) :: section
    logical, allocatable :: is_in(:)
    integer :: i, k

    allocate (is_in(n_node), source=.false.)
    is_in(section%nodes) = .true.
    allocate (section%is_corner(4, size(section%elements)))
    do i = 1, size(section%elements)
      do k = 1, 4
        section%is_corner(k, i) = &
          is_in(layout%slot_nodes(k, layout%element_slot(section%elements(i))))
      end do
    end do
  end subroutine mark_corners

  !> Its components.
  subroutine visit_section(self, visitor)
    class(cross_section_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor
    integer, allocatable :: corner(:, :)

    call visitor%visit('id', self%id)
    call visitor%visit('title', self%title)
    call visitor%visit('nodes', self%nodes)
    call visitor%visit('elements', self%elements)
    if (allocated(self%is_corner)) corner = merge(1, 0, self%is_corner)
    call visitor%visit('is_corner', corner)
    if (allocated(corner)) self%is_corner = corner == 1
    call visitor%visit('edges', self%edges)
  end subroutine visit_section

end module cross_sections_m
