! SPDX-License-Identifier: MIT
!> What can not be right of contact surfaces at time zero: a chain that crosses itself, and bodies
!> that lie in each other deeper than whole outlines are caught (doc/theory/contact.md, sections 3.4
!> and 3.7). Linear in elements and segments. Used once, when the deck is read.
module initial_overlap_m
  use body_view_m, only : body_view_t, most_crossed, half_row, list_crossed, ends_of
  use element_finder_m, only : is_inside_body, element_at
  use geometry_m, only : sight_t, sight_of_segment, closest_distance
  use kinds_m, only : wp
  use model_m, only : model_t
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: overlap_t, find_crossing, find_overlap

  !> Part of the allowed depth by which bodies that lie half an element deep may miss it.
  real(wp), parameter :: hair = 1.0e-9_wp
  !> Deep places for which all segments are looked at; bodies with more of them overlap anyway.
  integer, parameter :: most_looks = 1000

  !> The place of one surface that is deepest in the bodies of another, by the depth allowed there.
  type :: overlap_t
    integer :: nodes(2) = 0     !! mesh: node of the place twice, or ends of its segment; 0: none
    integer :: segment = 0      !! of the other surface, the nearest
    real(wp) :: depth = 0.0_wp  !! distance to that, m
    real(wp) :: allowed = 0.0_wp !! half of the row of elements behind it, m
  end type overlap_t

contains

  !> The first two segments of one chain that cross, 0 where there are none.
  pure subroutine find_crossing(model, surface, view, pair)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    type(body_view_t), intent(in) :: view
    integer, intent(out) :: pair(2)
    integer :: crossed(most_crossed), s, i, n
    real(wp) :: at(most_crossed)

    do s = 1, surface%n_segment
      call list_crossed(model, surface, view, ends_of(model, surface, s), n, crossed, at)
      do i = 1, n
        pair = [s, crossed(i)]
        if (surface%chain(crossed(i)) /= surface%chain(s)) cycle
        if (any(crossed(i) == [surface%previous(s), surface%next(s)])) cycle
        return
      end do
    end do
    pair = 0
  end subroutine find_crossing

  !> The place of `own` that is deepest behind `other`: of nodes, middles of segments, and middles
  !> of what of a segment lies between two crossings, those as deep as half of the row of elements
  !> or deeper. What stands nearest to an open end of `other` is no contact and is left alone, and
  !> so are the segments next to its own where both are one surface.
  pure subroutine find_overlap(model, own, other, view, is_same, found)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, other
    type(body_view_t), intent(in) :: view !! of `other`
    logical, intent(in) :: is_same
    type(overlap_t), intent(out) :: found
    integer :: s, i, n, n_look, beside(5), ends(2), crossed(most_crossed)
    real(wp) :: x(2, 2), at(most_crossed)

    n_look = 0
    do s = 1, own%n_segment
      if (n_look >= most_looks) return
      ends = own%nodes(own%segments(:, s))
      x = ends_of(model, own, s)
      beside = 0
      if (is_same) beside = segments_beside(own, s)
      call look_at_place(model, other, view, x(:, 1), ends([1, 1]), beside, n_look, found)
      if (own%next(s) == 0) &
        call look_at_place(model, other, view, x(:, 2), ends([2, 2]), beside, n_look, found)
      call look_at_place(model, other, view, 0.5_wp*(x(:, 1) + x(:, 2)), ends, beside, n_look, &
        found)
      call list_crossed(model, other, view, x, n, crossed, at)
      do i = 2, n
        call look_at_place(model, other, view, x(:, 1) + 0.5_wp*(at(i - 1) + at(i)) &
          *(x(:, 2) - x(:, 1)), ends, beside, n_look, found)
      end do
    end do
  end subroutine find_overlap

  !> A segment, and two on either side of it, 0 where its chain ends.
  pure function segments_beside(surface, segment) result(beside)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    integer :: beside(5)

    beside = 0
    beside(1:3) = [segment, surface%previous(segment), surface%next(segment)]
    if (beside(2) > 0) beside(4) = surface%previous(beside(2))
    if (beside(3) > 0) beside(5) = surface%next(beside(3))
  end function segments_beside

  !> Keep one place if it is too deep and the deepest so far.
  pure subroutine look_at_place(model, other, view, x, carriers, beside, n_look, found)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: other
    type(body_view_t), intent(in) :: view
    real(wp), intent(in) :: x(2)
    integer, intent(in) :: carriers(2), beside(5)
    integer, intent(inout) :: n_look
    type(overlap_t), intent(inout) :: found
    integer :: k, node, near(8), segment
    real(wp) :: depth

    if (.not. is_inside_body(view%finder, model, x, carriers)) return
    associate (corners => model%mesh%element_nodes(:, element_at(view%finder, model, x, carriers)))
      do k = 1, 4
        near(2*k - 1:2*k) = 0
        node = view%local(corners(k))
        if (node > 0) near(2*k - 1:2*k) = [other%incoming(node), other%outgoing(node)]
      end do
    end associate
    call find_nearest_of(model, other, x, beside, near, segment, depth)
    if (segment > 0) then
      if (depth < half_row(model, other, segment)*(1.0_wp - hair)) return
    end if
    n_look = n_look + 1
    call find_nearest_of(model, other, x, beside, [(k, k=1, other%n_segment)], segment, depth)
    if (segment == 0) return
    associate (allowed => half_row(model, other, segment))
      if (depth < allowed*(1.0_wp - hair) .or. depth*found%allowed <= found%depth*allowed &
        .and. found%segment > 0) return
      if (is_at_open_end(model, other, segment, x)) return
      found = overlap_t(carriers, segment, depth, allowed)
    end associate
  end subroutine look_at_place

  !> The nearest of some segments to a place, and its distance; 0 where there is none.
  pure subroutine find_nearest_of(model, surface, x, beside, segments, nearest, distance)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: x(2)
    integer, intent(in) :: beside(5), segments(:) !! left out; looked at, 0 for none
    integer, intent(out) :: nearest
    real(wp), intent(out) :: distance
    real(wp) :: square
    integer :: k

    nearest = 0
    distance = huge(1.0_wp)
    do k = 1, size(segments)
      if (segments(k) == 0 .or. any(beside == segments(k))) cycle
      square = closest_distance(sight_from(model, surface, segments(k), x))
      if (sqrt(square) >= distance) cycle
      nearest = segments(k)
      distance = sqrt(square)
    end do
  end subroutine find_nearest_of

  !> Whether a place lies beyond a segment at the end of an open chain.
  pure function is_at_open_end(model, surface, segment, x) result(at_end)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp), intent(in) :: x(2)
    logical :: at_end
    type(sight_t) :: sight

    sight = sight_from(model, surface, segment, x)
    at_end = sight%along < 0.0_wp .and. surface%previous(segment) == 0 &
      .or. sight%along > sight%square .and. surface%next(segment) == 0
  end function is_at_open_end

  !> A place seen from a segment.
  pure function sight_from(model, surface, segment, x) result(sight)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp), intent(in) :: x(2)
    type(sight_t) :: sight
    real(wp) :: ends(2, 2)

    ends = ends_of(model, surface, segment)
    sight = sight_of_segment([x, 0.0_wp, 0.0_wp], [ends(:, 1), 0.0_wp, 0.0_wp], &
      [ends(:, 2), 0.0_wp, 0.0_wp])
  end function sight_from

end module initial_overlap_m
