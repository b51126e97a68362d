! SPDX-License-Identifier: MIT
!> Point location in bodies at time zero: whether a position lies in the interior of given parts;
!> segments of a surface that a line crosses, and the thickness of the elements behind them.
!> Elements are sorted into the cells of a uniform grid by their bounding boxes. Used once, at the
!> start.
module element_finder_m
  use kinds_m, only : wp, long
  use model_m, only : model_t
  use sorting_m, only : index_among, sorted_order
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: element_finder_t, start_finder, is_inside_body, element_at, cell_of, body_view_t, &
    most_crossed, view_body, half_thickness, list_crossed, ends_of, initial_length, area_behind

  !> Distance from the boundary, over the cell size, from which on a position is interior.
  real(wp), parameter :: margin = 1.0e-6_wp
  !> Distance outside an element, over the edge length, up to which a position counts as inside.
  real(wp), parameter :: round_off = 1.0e-9_wp

  !> Margin of the search box over its size.
  real(wp), parameter :: box_margin = 1.0e-4_wp

  !> The grid; `cells = 0` when there is no element.
  type :: element_finder_t
    real(wp) :: low(2) = 0.0_wp       !! lower corner
    real(wp) :: high(2) = 0.0_wp      !! upper corner
    real(wp) :: cell(2) = 1.0_wp      !! sides of a cell, m
    integer :: cells(2) = 0           !! number of cells along x and y
    integer, allocatable :: first(:)  !! (cells + 1) start of each cell ...
    integer, allocatable :: items(:)  !! ... in this list of elements
  end type element_finder_t

  !> Minimum distance of the ends of crossing segments from each other's line, over the length of
  !> the shorter one: less may be round-off of the coordinates.
  real(wp), parameter :: least_crossing = 1.0e-4_wp
  !> Maximum number of crossings that are listed for one segment.
  integer, parameter :: most_crossed = 16
  !> Search structure of a surface and the bodies behind it.
  type :: body_view_t
    type(element_finder_t) :: finder
    integer, allocatable :: order(:) !! (n_node of the surface) sorts its nodes
  end type body_view_t

contains

  !> Sort the elements of the parts of `members` into the grid, as far as they lie near the box of
  !> `nodes`.
  pure subroutine start_finder(model, members, nodes, finder, behind)
    type(model_t), intent(in) :: model
    integer, intent(in) :: members(:) !! element indices
    integer, intent(in) :: nodes(:)   !! positions lie in the box of these nodes
    type(element_finder_t), intent(out) :: finder
    integer, intent(in), optional :: behind(:) !! all elements of these parts
    logical, allocatable :: is_wanted(:)
    integer, allocatable :: elements(:)
    real(wp) :: size_of_box(2), low(2), high(2), box(2, 2)
    integer :: i, n

    if (present(behind)) then
      elements = behind
    else
      allocate (is_wanted(size(model%parts)), source=.false.)
      is_wanted(model%mesh%element_part(members)) = .true.
      elements = pack([(i, i=1, model%mesh%n_element)], is_wanted(model%mesh%element_part))
    end if
    low = minval(model%mesh%coordinates(:, nodes), 2)
    high = maxval(model%mesh%coordinates(:, nodes), 2)
    size_of_box = box_margin*maxval(high - low)
    low = low - size_of_box
    high = high + size_of_box
    finder%low = huge(1.0_wp)
    finder%high = -huge(1.0_wp)
    n = 0
    do i = 1, size(elements)
      box = box_of(model, elements(i))
      if (any(box(:, 2) < low .or. box(:, 1) > high)) cycle
      n = n + 1
      elements(n) = elements(i)
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

  !> Lower and upper corner of the bounding box of an element.
  pure function box_of(model, element) result(box)
    type(model_t), intent(in) :: model
    integer, intent(in) :: element
    real(wp) :: box(2, 2)
    real(wp) :: x(2, 4)

    x = model%mesh%coordinates(:, model%mesh%element_nodes(:, element))
    box(:, 1) = minval(x, 2)
    box(:, 2) = maxval(x, 2)
  end function box_of

  !> Counting sort of the elements into the cells that their bounding boxes overlap.
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

  !> Cell of position x, counted from 0; the nearest one for positions outside.
  pure function cell_of(finder, x) result(cell)
    type(element_finder_t), intent(in) :: finder
    real(wp), intent(in) :: x(2)
    integer :: cell(2)

    cell = max(0, min(finder%cells - 1, int((x - finder%low)/finder%cell)))
  end function cell_of

  !> Whether four positions close to `x` all lie in elements that do not contain all owner nodes of
  !> x. (x alone does not distinguish an interior edge from the boundary.)
  pure function is_inside_body(finder, model, x, owner_nodes) result(inside)
    type(element_finder_t), intent(in) :: finder
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(2)        !! m
    integer, intent(in) :: owner_nodes(:)  !! node indices
    logical :: inside
    real(wp) :: tolerance(2)

    tolerance = margin*finder%cell
    inside = element_at(finder, model, x + tolerance, owner_nodes) > 0
    if (inside) inside = element_at(finder, model, x - tolerance, owner_nodes) > 0
    if (inside) inside = element_at(finder, model, x + [tolerance(1), -tolerance(2)], &
      owner_nodes) > 0
    if (inside) inside = element_at(finder, model, x + [-tolerance(1), tolerance(2)], &
      owner_nodes) > 0
  end function is_inside_body

  !> An element that contains x but not all of `owner_nodes`, or 0.
  pure function element_at(finder, model, x, owner_nodes) result(element)
    type(element_finder_t), intent(in) :: finder
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(2)
    integer, intent(in) :: owner_nodes(:)
    integer :: element
    integer :: cell(2), k, i, j

    element = 0
    if (any(x < finder%low) .or. any(x > finder%high)) return
    cell = cell_of(finder, x)
    k = 1 + cell(1) + cell(2)*finder%cells(1)
    do i = finder%first(k) + 1, finder%first(k + 1)
      associate (nodes => model%mesh%element_nodes(:, finder%items(i)))
        if (all([(any(nodes == owner_nodes(j)), j=1, size(owner_nodes))])) cycle
      end associate
      if (.not. is_in_element(model, finder%items(i), x)) cycle
      element = finder%items(i)
      return
    end do
  end function element_at

  !> Whether an element contains x, edges included.
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

  !> Build the search structure of a surface with one or more segments, for positions of it and of
  !> another surface.
  pure subroutine view_body(model, surface, other, view, behind)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface, other
    type(body_view_t), intent(out) :: view
    integer, intent(in), optional :: behind(:) !! all elements of these bodies

    call start_finder(model, surface%segment_element, [surface%nodes, other%nodes], view%finder, &
      behind)
    view%order = sorted_order(int(surface%nodes, long))
  end subroutine view_body

  !> Half of the thickness of the element behind a segment, m.
  pure function half_thickness(model, surface, segment) result(depth)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp) :: depth

    depth = 0.5_wp*area_behind(model, surface, segment)/initial_length(model, surface, segment)
  end function half_thickness

  !> Length of a segment, m.
  pure function initial_length(model, surface, segment) result(length)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp) :: length
    real(wp) :: x(2, 2)

    x = ends_of(model, surface, segment)
    length = norm2(x(:, 2) - x(:, 1))
  end function initial_length

  !> Area of the element behind a segment, m^2.
  pure function area_behind(model, surface, segment) result(area)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp) :: area
    real(wp) :: x(2, 4)

    x = model%mesh%coordinates(:, model%mesh%element_nodes(:, surface%segment_element(segment)))
    area = 0.5_wp*((x(1, 3) - x(1, 1))*(x(2, 4) - x(2, 2)) &
      - (x(1, 4) - x(1, 2))*(x(2, 3) - x(2, 1)))
  end function area_behind

  !> Segments of the surface that a line crosses, in order along the line, and the parameters of the
  !> crossings on it (0 to 1).
  pure subroutine list_crossed(model, surface, view, line, n, crossed, at)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    type(body_view_t), intent(in) :: view
    real(wp), intent(in) :: line(2, 2)
    integer, intent(out) :: n, crossed(most_crossed)
    real(wp), intent(out) :: at(most_crossed)
    integer, allocatable :: order(:)
    integer :: low(2), high(2), ix, iy, i, k, t, cell
    real(wp) :: position

    n = 0
    if (any(maxval(line, 2) < view%finder%low .or. minval(line, 2) > view%finder%high)) return
    low = cell_of(view%finder, minval(line, 2))
    high = cell_of(view%finder, maxval(line, 2))
    do iy = low(2), high(2)
      do ix = low(1), high(1)
        cell = 1 + ix + iy*view%finder%cells(1)
        do i = view%finder%first(cell) + 1, view%finder%first(cell + 1)
          associate (element => view%finder%items(i))
            do k = 1, 4
              t = index_among(surface%nodes, view%order, model%mesh%element_nodes(k, element))
              if (t > 0) t = surface%outgoing(t)
              if (t == 0) cycle
              if (surface%segment_element(t) /= element) cycle
              if (n == most_crossed .or. any(crossed(:n) == t)) cycle
              call cross(line, ends_of(model, surface, t), position)
              if (.not. position > 0.0_wp) cycle
              n = n + 1
              crossed(n) = t
              at(n) = position
            end do
          end associate
        end do
      end do
    end do
    order = sorted_order(transfer(at(:n), [0_long])) ! bits of positive numbers sort alike
    crossed(:n) = crossed(order)
    at(:n) = at(order)
  end subroutine list_crossed

  !> Parameter on line `one` (0 to 1) of its crossing with line `two`; 0 where they do not cross.
  pure subroutine cross(one, two, position)
    real(wp), intent(in), dimension(2, 2) :: one, two !! ends
    real(wp), intent(out) :: position
    real(wp) :: a(2), b(2), least

    position = 0.0_wp
    a = [across(two, one(:, 1)), across(two, one(:, 2))]
    b = [across(one, two(:, 1)), across(one, two(:, 2))]
    least = least_crossing*min(norm2(one(:, 2) - one(:, 1)), norm2(two(:, 2) - two(:, 1)))
    if (a(1)*a(2) >= 0.0_wp .or. b(1)*b(2) >= 0.0_wp) return
    if (minval(abs([a, b])) > least) position = a(1)/(a(1) - a(2))
  end subroutine cross

  !> Signed distance of x from a line, m.
  pure function across(line, x) result(distance)
    real(wp), intent(in) :: line(2, 2), x(2)
    real(wp) :: distance

    associate (t => line(:, 2) - line(:, 1), d => x - line(:, 1))
      distance = (d(1)*t(2) - d(2)*t(1))/norm2(t)
    end associate
  end function across

  !> Positions of the two ends of a segment, m.
  pure function ends_of(model, surface, segment) result(x)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp) :: x(2, 2)

    x = model%mesh%coordinates(:, surface%nodes(surface%segments(:, segment)))
  end function ends_of

end module element_finder_m
