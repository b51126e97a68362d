! SPDX-License-Identifier: MIT
!> A contact surface with the bodies behind it at time zero: which of its segments a line crosses,
!> and how thick the elements behind them are. Used when the deck is read; looks go through the grid
!> of the elements.
module body_view_m
  use element_finder_m, only : element_finder_t, start_finder, cell_of
  use kinds_m, only : wp
  use model_m, only : model_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: body_view_t, most_crossed, view_body, half_row, list_crossed, ends_of

  !> Part of the shorter segment by which two segments have to reach through each other at least:
  !> less may be round-off of the coordinates.
  real(wp), parameter :: through = 1.0e-4_wp
  !> Segments of a surface that one segment is known to cross, at most.
  integer, parameter :: most_crossed = 16
  !> A surface and the bodies behind it.
  type :: body_view_t
    type(element_finder_t) :: finder
    integer, allocatable :: local(:) !! (n_node of the mesh) number on the surface, 0: not on it
  end type body_view_t

contains

  !> Know the bodies behind a surface, for looks at it and at another one. It must have a segment.
  pure subroutine view_body(model, surface, other, view)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface, other
    type(body_view_t), intent(out) :: view
    integer :: i

    call start_finder(model, surface%segment_element, [surface%nodes, other%nodes], view%finder)
    allocate (view%local(model%mesh%n_node), source=0)
    view%local(surface%nodes) = [(i, i=1, surface%n_node)]
  end subroutine view_body

  !> Half of the thickness of the element behind a segment, m.
  pure function half_row(model, surface, segment) result(depth)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp) :: depth
    real(wp) :: length, area

    associate (x => model%mesh%coordinates, ends => surface%nodes(surface%segments(:, segment)), &
      nodes => model%mesh%element_nodes(:, surface%segment_element(segment)))
      length = norm2(x(:, ends(2)) - x(:, ends(1)))
      area = 0.5_wp*((x(1, nodes(3)) - x(1, nodes(1)))*(x(2, nodes(4)) - x(2, nodes(2))) &
        - (x(1, nodes(4)) - x(1, nodes(2)))*(x(2, nodes(3)) - x(2, nodes(1))))
    end associate
    depth = 0.5_wp*area/length
  end function half_row

  !> Segments that a line a-b and that cross each other, in order along it, and where on it (0 to
  !> 1): each reaches through the other with both ends. All behind which elements lie in its way.
  pure subroutine list_crossed(model, surface, view, line, n, crossed, at)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    type(body_view_t), intent(in) :: view
    real(wp), intent(in) :: line(2, 2)
    integer, intent(out) :: n, crossed(most_crossed)
    real(wp), intent(out) :: at(most_crossed)
    integer :: low(2), high(2), ix, iy, i, k, t, cell
    real(wp) :: place

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
              t = view%local(model%mesh%element_nodes(k, element))
              if (t > 0) t = surface%outgoing(t)
              if (t == 0) cycle
              if (surface%segment_element(t) /= element) cycle
              if (n == most_crossed .or. any(crossed(:n) == t)) cycle
              call cross(line, ends_of(model, surface, t), place)
              if (place > 0.0_wp) call put_in_order(t, place, n, crossed, at)
            end do
          end associate
        end do
      end do
    end do
  end subroutine list_crossed

  !> One more crossing, in order along the line.
  pure subroutine put_in_order(segment, place, n, crossed, at)
    integer, intent(in) :: segment
    real(wp), intent(in) :: place
    integer, intent(inout) :: n, crossed(most_crossed)
    real(wp), intent(inout) :: at(most_crossed)
    integer :: k

    k = n + 1
    do while (k > 1)
      if (at(k - 1) <= place) exit
      at(k) = at(k - 1)
      crossed(k) = crossed(k - 1)
      k = k - 1
    end do
    at(k) = place
    crossed(k) = segment
    n = n + 1
  end subroutine put_in_order

  !> Where on one line (0 to 1) another goes through it, 0 where it does not.
  pure subroutine cross(one, two, place)
    real(wp), intent(in), dimension(2, 2) :: one, two !! ends
    real(wp), intent(out) :: place
    real(wp) :: a(2), b(2), least

    place = 0.0_wp
    a = [across(two, one(:, 1)), across(two, one(:, 2))]
    b = [across(one, two(:, 1)), across(one, two(:, 2))]
    least = through*min(norm2(one(:, 2) - one(:, 1)), norm2(two(:, 2) - two(:, 1)))
    if (a(1)*a(2) >= 0.0_wp .or. b(1)*b(2) >= 0.0_wp) return
    if (minval(abs([a, b])) > least) place = a(1)/(a(1) - a(2))
  end subroutine cross

  !> Signed distance of a place from the line through two others.
  pure function across(line, x) result(distance)
    real(wp), intent(in) :: line(2, 2), x(2)
    real(wp) :: distance

    associate (t => line(:, 2) - line(:, 1), d => x - line(:, 1))
      distance = (d(1)*t(2) - d(2)*t(1))/norm2(t)
    end associate
  end function across

  !> Places of the two ends of a segment.
  pure function ends_of(model, surface, segment) result(x)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp) :: x(2, 2)

    x = model%mesh%coordinates(:, surface%nodes(surface%segments(:, segment)))
  end function ends_of

end module body_view_m
