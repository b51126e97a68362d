! SPDX-License-Identifier: MIT
!> Surfaces that stand for curved ones: the curvature that the initial mesh gives to each of its
!> segments (doc/theory/contact.md, section 8.2).
module arcs_m
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: find_curvatures, arc_height

  !> Cosine of 16 degrees: what turns by more is a corner (24 segments on a circle turn by 15).
  real(wp), parameter :: corner = 0.961261695938319_wp
  !> Curvature at one end of a segment, as a part of that at the other, below which the one is flat.
  real(wp), parameter :: flat = 0.1_wp

contains

  !> Curvature of the arc that each segment of a surface stands for: the mean of those at its ends,
  !> of circles through three nodes each; 0 where one end is a corner, flat, or bent the other way;
  !> at an end of an open surface that of the other end.
  pure subroutine find_curvatures(surface, positions, curvature, meets_corner)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: positions(:, :)   !! (at least 2, n_node) X, Y at time zero, m
    real(wp), intent(out) :: curvature(:)     !! (n_segment) 1/m, above 0 where the body is convex
    logical, intent(out) :: meets_corner(:)   !! (n_segment) at either end
    real(wp) :: at_end(surface%n_segment), ends(2)
    logical :: is_corner(surface%n_segment)
    integer :: s

    at_end = 0.0_wp
    is_corner = .false.
    do s = 1, surface%n_segment
      if (surface%next(s) > 0) call curvature_at_end(surface, positions, s, at_end(s), is_corner(s))
    end do
    curvature = 0.0_wp
    meets_corner = is_corner
    do s = 1, surface%n_segment
      associate (before => surface%previous(s))
        ends = at_end(s)
        if (before > 0) then
          meets_corner(s) = meets_corner(s) .or. is_corner(before)
          ends(1) = at_end(before)
          if (surface%next(s) == 0) ends(2) = ends(1)
        end if
      end associate
      if (meets_corner(s) .or. product(sign([1.0_wp, 1.0_wp], ends)) < 0.0_wp) cycle
      if (minval(abs(ends)) >= flat*maxval(abs(ends))) curvature(s) = 0.5_wp*sum(ends)
    end do
  end subroutine find_curvatures

  !> Curvature of the circle through the nodes of a segment and the next one, and whether the turn
  !> between them is a corner.
  pure subroutine curvature_at_end(surface, positions, segment, curvature, is_corner)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: positions(:, :)
    integer, intent(in) :: segment
    real(wp), intent(out) :: curvature !! 1/m
    logical, intent(out) :: is_corner
    real(wp) :: a(2), b(2)

    associate (one => surface%segments(:, segment), &
      two => surface%segments(:, surface%next(segment)))
      a = positions(1:2, one(2)) - positions(1:2, one(1))
      b = positions(1:2, two(2)) - positions(1:2, two(1))
    end associate
    curvature = 2.0_wp*(a(1)*b(2) - a(2)*b(1))/max(tiny(1.0_wp), norm2(a)*norm2(b)*norm2(a + b))
    is_corner = dot_product(a, b) < corner*norm2(a)*norm2(b)
  end subroutine curvature_at_end

  !> How far an arc stands off the middle of its chord, m.
  pure elemental function arc_height(curvature, chord) result(height)
    real(wp), intent(in) :: curvature, chord !! 1/m, m
    real(wp) :: height

    height = 0.125_wp*abs(curvature)*chord**2
  end function arc_height

end module arcs_m
