! SPDX-License-Identifier: MIT
!> Checks of contact surfaces at time zero: chains that cross themselves, and bodies that overlap by
!> more than contact of closed boundaries resolves (doc/theory/contact.md, sections 3.4 and 3.7).
!> Linear in elements and segments. Used once, when the deck is read.
module initial_overlap_m
  use element_finder_m, only : body_view_t, most_crossed, half_thickness, list_crossed, ends_of, &
    is_inside_body, element_at
  use geometry_m, only : local_coordinates_t, coordinates_on_segment, closest_distance
  use kinds_m, only : wp
  use model_m, only : model_t
  use sorting_m, only : index_among
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: overlap_t, find_crossing, find_overlap

  !> Relative tolerance of the allowed depth.
  real(wp), parameter :: tolerance = 1.0e-9_wp
  !> Maximum number of deep samples that are compared with all segments.
  integer, parameter :: max_checked = 1000

  !> Cosine of the angle between two outward normals from which on they count as parallel.
  real(wp), parameter :: same_way = 0.5_wp

  !> A sample position on a surface.
  type :: sample_t
    real(wp) :: x(2)
    integer :: nodes(2)           !! mesh: its node, twice, or the ends of its segment
    real(wp) :: normal(2)         !! outward, 0 at a node
    integer :: neighbours(5)      !! adjacent segments where both surfaces are the same, or 0
  end type sample_t

  !> The deepest sample of one surface in the bodies of another, relative to the allowed depth.
  type :: overlap_t
    integer :: nodes(2) = 0       !! of the sample
    integer :: segment = 0        !! of the other surface; 0: no overlap
    real(wp) :: depth = 0.0_wp    !! distance from the segment, m
    real(wp) :: allowed = 0.0_wp  !! half of the thickness of the element behind it, m
  end type overlap_t

contains

  !> The first pair of segments of one chain that cross each other; 0 where there is none.
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

  !> The deepest sample of `own` in the bodies of `other`, if it is at least half of an element
  !> thickness behind all segments. Segments with a normal parallel to that of the sample are
  !> skipped: the sample has reached them from behind. Samples are nodes, midpoints of segments, and
  !> midpoints between two crossings of a segment. Samples closest to an open end of `other` are
  !> skipped, and so are adjacent segments where both surfaces are the same.
  pure subroutine find_overlap(model, own, other, view, is_same, found)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: own, other
    type(body_view_t), intent(in) :: view !! of `other`
    logical, intent(in) :: is_same
    type(overlap_t), intent(out) :: found
    integer :: s, i, n, n_checked, ends(2), crossed(most_crossed)
    real(wp) :: x(2, 2), at(most_crossed)
    type(sample_t) :: sample

    n_checked = 0
    do s = 1, own%n_segment
      if (n_checked >= max_checked) return
      ends = own%nodes(own%segments(:, s))
      x = ends_of(model, own, s)
      sample%neighbours = 0
      if (is_same) then
        sample%neighbours(1:3) = [s, own%previous(s), own%next(s)]
        if (sample%neighbours(2) > 0) sample%neighbours(4) = own%previous(sample%neighbours(2))
        if (sample%neighbours(3) > 0) sample%neighbours(5) = own%next(sample%neighbours(3))
      end if
      sample%normal = 0.0_wp
      do i = 1, merge(2, 1, own%next(s) == 0)
        sample%x = x(:, i)
        sample%nodes = ends(i)
        call check_sample(model, other, view, sample, n_checked, found)
      end do
      sample%normal = normal_of(x)
      sample%nodes = ends
      sample%x = 0.5_wp*(x(:, 1) + x(:, 2))
      call check_sample(model, other, view, sample, n_checked, found)
      call list_crossed(model, other, view, x, n, crossed, at)
      do i = 2, n
        sample%x = x(:, 1) + 0.5_wp*(at(i - 1) + at(i))*(x(:, 2) - x(:, 1))
        call check_sample(model, other, view, sample, n_checked, found)
      end do
    end do
  end subroutine find_overlap

  !> Record a sample if it is too deep and the deepest so far.
  pure subroutine check_sample(model, other, view, sample, n_checked, found)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: other
    type(body_view_t), intent(in) :: view
    type(sample_t), intent(in) :: sample
    integer, intent(inout) :: n_checked
    type(overlap_t), intent(inout) :: found
    integer :: k, node, near(8)
    type(overlap_t) :: new
    type(local_coordinates_t) :: local

    if (.not. is_inside_body(view%finder, model, sample%x, sample%nodes)) return
    associate (corners => model%mesh%element_nodes(:, &
      element_at(view%finder, model, sample%x, sample%nodes)))
      do k = 1, 4
        near(2*k - 1:2*k) = 0
        node = index_among(other%nodes, view%order, corners(k))
        if (node > 0) near(2*k - 1:2*k) = [other%incoming(node), other%outgoing(node)]
      end do
    end associate
    call measure(model, other, sample, near, new)
    if (new%segment > 0 .and. new%depth < new%allowed) return
    n_checked = n_checked + 1
    call measure(model, other, sample, [(k, k=1, other%n_segment)], new)
    if (new%segment == 0 .or. new%depth < new%allowed) return
    ! Beyond a segment at the end of an open chain.
    local = local_from(model, other, new%segment, sample%x)
    if (local%along < 0.0_wp .and. other%previous(new%segment) == 0) return
    if (local%along > local%square .and. other%next(new%segment) == 0) return
    if (found%segment > 0) then
      if (new%depth*found%allowed <= found%depth*new%allowed) return
    end if
    found = new
  end subroutine check_sample

  !> The overlap of a sample with the segment behind which it is least deep, relative to the allowed
  !> depth.
  pure subroutine measure(model, other, sample, segments, least)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: other
    type(sample_t), intent(in) :: sample
    integer, intent(in) :: segments(:) !! 0 is skipped
    type(overlap_t), intent(out) :: least
    real(wp) :: depth, allowed
    integer :: k

    least%nodes = sample%nodes
    do k = 1, size(segments)
      associate (s => segments(k))
        if (s == 0 .or. any(sample%neighbours == s)) cycle
        if (dot_product(sample%normal, normal_of(ends_of(model, other, s))) > same_way) cycle
        depth = sqrt(closest_distance(local_from(model, other, s, sample%x)))
        allowed = half_thickness(model, other, s)
        if (least%segment > 0 .and. depth*least%allowed >= least%depth*allowed) cycle
        least = overlap_t(sample%nodes, s, depth, allowed)
      end associate
    end do
    if (least%depth >= (1.0_wp - tolerance)*least%allowed) least%depth = max(least%depth, &
      least%allowed)
  end subroutine measure

  !> Outward unit normal of a segment.
  pure function normal_of(ends) result(normal)
    real(wp), intent(in) :: ends(2, 2)
    real(wp) :: normal(2)

    normal = [ends(2, 2) - ends(2, 1), ends(1, 1) - ends(1, 2)]/norm2(ends(:, 2) - ends(:, 1))
  end function normal_of

  !> Local coordinates of a position on a segment.
  pure function local_from(model, surface, segment, x) result(local)
    type(model_t), intent(in) :: model
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: segment
    real(wp), intent(in) :: x(2)
    type(local_coordinates_t) :: local
    real(wp) :: ends(2, 2)

    ends = ends_of(model, surface, segment)
    local = coordinates_on_segment([x, 0.0_wp, 0.0_wp], [ends(:, 1), 0.0_wp, 0.0_wp], &
      [ends(:, 2), 0.0_wp, 0.0_wp])
  end function local_from

end module initial_overlap_m
