! SPDX-License-Identifier: MIT
!> Whether a place lies inside the elements of certain parts at time zero, and not just on their
!> boundary. Elements are sorted into the cells of a uniform grid by their boxes; used once, at the
!> start.
module element_finder_m
  use kinds_m, only : wp
  use model_m, only : model_t
  implicit none
  private
  public :: element_finder_t, start_finder, is_inside_body, element_at, cell_of

  !> Part of a cell by which a node must lie within the boundary.
  real(wp), parameter :: margin = 1.0e-6_wp
  !> Part of an edge by which a place may lie outside of an element and still count as in it.
  real(wp), parameter :: round_off = 1.0e-9_wp

  !> Part of the places' box by which elements outside of it are taken too.
  real(wp), parameter :: beside = 1.0e-4_wp

  !> The grid; `cells = 0` when there is no element.
  type :: element_finder_t
    real(wp) :: low(2) = 0.0_wp       !! lower corner
    real(wp) :: high(2) = 0.0_wp      !! upper corner
    real(wp) :: cell(2) = 1.0_wp      !! sides of a cell, m
    integer :: cells(2) = 0           !! number of cells along x and y
    integer, allocatable :: first(:)  !! (cells + 1) where each cell starts ...
    integer, allocatable :: items(:)  !! ... in this list of elements
  end type element_finder_t

contains

  !> Sort the elements of those parts that hold any of `members`, as far as they come near the
  !> places that will be asked about.
  pure subroutine start_finder(model, members, nodes, finder)
    type(model_t), intent(in) :: model
    integer, intent(in) :: members(:) !! element indices
    integer, intent(in) :: nodes(:)   !! places lie between these
    type(element_finder_t), intent(out) :: finder
    logical, allocatable :: is_wanted(:)
    integer, allocatable :: elements(:)
    real(wp) :: size_of_box(2), low(2), high(2), box(2, 2)
    integer :: i, n

    allocate (is_wanted(size(model%parts)), source=.false.)
    is_wanted(model%mesh%element_part(members)) = .true.
    low = minval(model%mesh%coordinates(:, nodes), 2)
    high = maxval(model%mesh%coordinates(:, nodes), 2)
    size_of_box = beside*maxval(high - low)
    low = low - size_of_box
    high = high + size_of_box
    finder%low = huge(1.0_wp)
    finder%high = -huge(1.0_wp)
    allocate (elements(model%mesh%n_element))
    n = 0
    do i = 1, model%mesh%n_element
      if (.not. is_wanted(model%mesh%element_part(i))) cycle
      box = box_of(model, i)
      if (any(box(:, 2) < low .or. box(:, 1) > high)) cycle
      n = n + 1
      elements(n) = i
      finder%low = min(finder%low, box(:, 1))
      finder%high = max(finder%high, box(:, 2))
    end do
    if (n == 0) return
    elements = elements(:n)
    size_of_box = max(finder%high - finder%low, tiny(1.0_wp))
    finder%cell = max(sqrt(product(size_of_box)/size(elements)), maxval(size_of_box)/30000)
    finder%cells = int(size_of_box/finder%cell) + 1
    call sort_elements(model, elements, finder)
  end subroutine start_finder

  !> Lower and upper corner of the box of an element.
  pure function box_of(model, element) result(box)
    type(model_t), intent(in) :: model
    integer, intent(in) :: element
    real(wp) :: box(2, 2)
    integer :: k

    associate (x => model%mesh%coordinates, nodes => model%mesh%element_nodes(:, element))
      box(:, 1) = x(:, nodes(1))
      box(:, 2) = x(:, nodes(1))
      do k = 2, 4
        box(:, 1) = min(box(:, 1), x(:, nodes(k)))
        box(:, 2) = max(box(:, 2), x(:, nodes(k)))
      end do
    end associate
  end function box_of

  !> Counting sort of the elements into the cells that their boxes touch.
  pure subroutine sort_elements(model, elements, finder)
    type(model_t), intent(in) :: model
    integer, intent(in) :: elements(:)
    type(element_finder_t), intent(inout) :: finder
    integer :: i, ix, iy, cell, pass, low(2), high(2)
    real(wp) :: box(2, 2)

    allocate (finder%first(product(finder%cells) + 1), source=0)
    do pass = 1, 2
      do i = 1, size(elements)
        box = box_of(model, elements(i))
        low = cell_of(finder, box(:, 1))
        high = cell_of(finder, box(:, 2))
        do iy = low(2), high(2)
          do ix = low(1), high(1)
            cell = 1 + ix + iy*finder%cells(1)
            if (pass == 2) finder%items(finder%first(cell)) = elements(i)
            finder%first(cell) = finder%first(cell) + merge(1, -1, pass == 1)
          end do
        end do
      end do
      if (pass == 2) exit
      do cell = 2, size(finder%first)
        finder%first(cell) = finder%first(cell) + finder%first(cell - 1)
      end do
      allocate (finder%items(finder%first(size(finder%first))))
    end do
  end subroutine sort_elements

  !> Cell that holds x, counted from 0; the nearest one for places outside.
  pure function cell_of(finder, x) result(cell)
    type(element_finder_t), intent(in) :: finder
    real(wp), intent(in) :: x(2)
    integer :: cell(2)

    cell = max(0, min(finder%cells - 1, int((x - finder%low)/finder%cell)))
  end function cell_of

  !> Whether four places round `x`, a hair away, are all in elements that do not have the nodes
  !> which carry the place. (x alone would not tell an edge between two elements from the boundary.)
  pure function is_inside_body(finder, model, x, carriers) result(inside)
    type(element_finder_t), intent(in) :: finder
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(2)        !! m
    integer, intent(in) :: carriers(:)  !! node indices
    logical :: inside
    real(wp) :: hair(2)

    hair = margin*finder%cell
    inside = element_at(finder, model, x + hair, carriers) > 0
    if (inside) inside = element_at(finder, model, x - hair, carriers) > 0
    if (inside) inside = element_at(finder, model, x + [hair(1), -hair(2)], carriers) > 0
    if (inside) inside = element_at(finder, model, x + [-hair(1), hair(2)], carriers) > 0
  end function is_inside_body

  !> An element that x is in and that does not have all of `carriers`, or 0.
  pure function element_at(finder, model, x, carriers) result(element)
    type(element_finder_t), intent(in) :: finder
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(2)
    integer, intent(in) :: carriers(:)
    integer :: element
    integer :: cell(2), k, i

    element = 0
    if (any(x < finder%low) .or. any(x > finder%high)) return
    cell = cell_of(finder, x)
    k = 1 + cell(1) + cell(2)*finder%cells(1)
    do i = finder%first(k) + 1, finder%first(k + 1)
      if (has_all(model%mesh%element_nodes(:, finder%items(i)), carriers)) cycle
      if (.not. is_in_element(model, finder%items(i), x)) cycle
      element = finder%items(i)
      return
    end do
  end function element_at

  !> Whether an element has all of the given nodes.
  pure function has_all(nodes, wanted)
    integer, intent(in) :: nodes(4), wanted(:)
    logical :: has_all
    integer :: k

    has_all = .false.
    do k = 1, size(wanted)
      if (all(nodes /= wanted(k))) return
    end do
    has_all = .true.
  end function has_all

  !> Whether x is in an element, edges included.
  pure function is_in_element(model, element, x) result(is_in)
    type(model_t), intent(in) :: model
    integer, intent(in) :: element
    real(wp), intent(in) :: x(2)
    logical :: is_in
    real(wp) :: a(2), t(2)
    integer :: k

    is_in = .false.
    do k = 1, 4
      a = model%mesh%coordinates(:, model%mesh%element_nodes(k, element))
      t = model%mesh%coordinates(:, model%mesh%element_nodes(1 + modulo(k, 4), element)) - a
      if (t(1)*(x(2) - a(2)) - t(2)*(x(1) - a(1)) < -round_off*dot_product(t, t)) return
    end do
    is_in = .true.
  end function is_in_element

end module element_finder_m
