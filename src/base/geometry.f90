! SPDX-License-Identifier: MIT
!> A point in the local coordinates of a segment: projection, gap and normal.
!> Positions are given as (X, Y, u_x, u_y), coordinates at time zero and displacement. Vectors are
!> differences of X plus differences of u, so that no digit is lost far from the origin
!> (doc/theory/contact.md, section 2).
module geometry_m
  use kinds_m, only : wp
  implicit none
  private
  public :: local_coordinates_t, coordinates_on_segment, separation, closest_distance, local_gap, &
    local_normal, segment_length

  !> Local coordinates of a point on a segment a-b with the vector t = b - a and the outward normal
  !> (t_y, -t_x)/|t|. No default values, whose initialisation would cost time.
  type :: local_coordinates_t
    real(wp) :: t(2)    !! vector of the segment, m
    real(wp) :: d(2)    !! vector from a to the point, m
    real(wp) :: square  !! t.t, m^2 (never zero)
    real(wp) :: along   !! d.t: xi times `square`
    real(wp) :: across  !! gap times length
  end type local_coordinates_t

contains

  !> Vector from position q to position p, m.
  pure function separation(p, q) result(d)
    real(wp), intent(in) :: p(4), q(4) !! X, Y, u_x, u_y
    real(wp) :: d(2)

    d(1) = (p(1) - q(1)) + (p(3) - q(3))
    d(2) = (p(2) - q(2)) + (p(4) - q(4))
  end function separation

  !> Local coordinates of `point` on the segment a-b.
  pure function coordinates_on_segment(point, a, b) result(local)
    real(wp), intent(in) :: point(4), a(4), b(4)
    type(local_coordinates_t) :: local

    local%t(1) = (b(1) - a(1)) + (b(3) - a(3))
    local%t(2) = (b(2) - a(2)) + (b(4) - a(4))
    local%d(1) = (point(1) - a(1)) + (point(3) - a(3))
    local%d(2) = (point(2) - a(2)) + (point(4) - a(4))
    local%square = max(local%t(1)**2 + local%t(2)**2, tiny(1.0_wp))
    local%along = local%d(1)*local%t(1) + local%d(2)*local%t(2)
    local%across = local%d(1)*local%t(2) - local%d(2)*local%t(1)
  end function coordinates_on_segment

  !> Squared distance of the point from its closest point on the segment.
  pure function closest_distance(local) result(square)
    type(local_coordinates_t), intent(in) :: local
    real(wp) :: square !! m^2

    if (local%along < 0.0_wp) then
      square = local%d(1)**2 + local%d(2)**2
    else if (local%along > local%square) then
      square = (local%d(1) - local%t(1))**2 + (local%d(2) - local%t(2))**2
    else
      square = local%across**2/local%square
    end if
  end function closest_distance

  !> Gap: signed distance from the line of the segment, m, negative on the inner side.
  pure function local_gap(local) result(gap)
    type(local_coordinates_t), intent(in) :: local
    real(wp) :: gap

    gap = local%across/sqrt(local%square)
  end function local_gap

  !> Outward unit normal of the segment.
  pure function local_normal(local) result(normal)
    type(local_coordinates_t), intent(in) :: local
    real(wp) :: normal(2)

    normal = [local%t(2), -local%t(1)]/sqrt(local%square)
  end function local_normal

  !> Length of the segment between two positions, m.
  pure function segment_length(a, b) result(length)
    real(wp), intent(in) :: a(4), b(4)
    real(wp) :: length

    length = sqrt(((b(1) - a(1)) + (b(3) - a(3)))**2 + ((b(2) - a(2)) + (b(4) - a(4)))**2)
  end function segment_length

end module geometry_m
