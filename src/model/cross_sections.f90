! SPDX-License-Identifier: MIT
!> Cross sections whose forces the histories tell (secforc).
module cross_sections_m
  use kinds_m, only : long
  use sorting_m, only : sorted_order
  implicit none
  private
  public :: cross_section_t, find_edges, n_cut

  !> One *DATABASE_CROSS_SECTION_SET.
  type :: cross_section_t
    integer :: id = 0                   !! user number, or its position in the deck
    character(:), allocatable :: title
    integer, allocatable :: nodes(:)    !! node indices, each once
    integer, allocatable :: elements(:) !! element indices, each once; by rising slot once there is
                                        !! a layout
    integer, allocatable :: edges(:, :) !! (2, n) edges of the elements with both nodes in it
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

end module cross_sections_m
