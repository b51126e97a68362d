! SPDX-License-Identifier: MIT
!> Axisymmetric scenes: the x of a position is its radius, and lengths weigh with it. Projections
!> stay plane (doc/theory/contact.md, section 5.8).
module radii_m
  use kinds_m, only : wp
  implicit none
  private
  public :: radius_of, end_radius, radius_between, centroid

contains

  !> Radius of a position, m.
  pure function radius_of(position) result(radius)
    real(wp), intent(in) :: position(4)
    real(wp) :: radius

    radius = position(1) + position(3)
  end function radius_of

  !> Mean radius of a straight stretch as one of its ends has it: with l/2 the integral of r over
  !> the stretch by the hat function of that end.
  elemental function end_radius(near, far) result(radius)
    real(wp), intent(in) :: near, far !! radii of that end and of the other, m
    real(wp) :: radius

    radius = (2.0_wp*near + far)/3.0_wp
  end function end_radius

  !> Radius at xi between two positions, m.
  pure function radius_between(a, b, xi) result(radius)
    real(wp), intent(in) :: a(4), b(4), xi
    real(wp) :: radius

    radius = radius_of(a) + xi*((b(1) - a(1)) + (b(3) - a(3)))
  end function radius_between

  !> Where the centre of a stretch of the segment a-b is when its parts weigh with their radius. On
  !> the axis itself nothing has weight: there it is the middle; never outside of the stretch.
  pure function centroid(a, b, low, high) result(xi)
    real(wp), intent(in) :: a(4), b(4)
    real(wp), intent(in) :: low, high !! where the stretch starts and ends on the segment, 0 to 1
    real(wp) :: xi
    real(wp) :: first, last

    first = radius_between(a, b, low)
    last = radius_between(a, b, high)
    xi = 0.5_wp*(low + high) + (high - low)/6.0_wp &
      *max(-3.0_wp, min(3.0_wp, (last - first)/max(first + last, tiny(1.0_wp))))
  end function centroid

end module radii_m
