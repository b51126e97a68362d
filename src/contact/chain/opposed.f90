! SPDX-License-Identifier: MIT
!> Whether two surfaces are opposed: the outward normal of a face against those of the segments that
!> a point is on (doc/theory/contact.md, section 3.3).
module opposed_m
  use foot_m, only : face_on, side_on, gentle_turn
  use geometry_m, only : separation
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: segments_at, segments_of, is_opposed, turns_sharply

  !> Sine of the angle by which a direction lies between two others (10 degrees).
  real(wp), parameter :: well_between = 0.17_wp

contains

  !> The segments before and after a node of a surface; 0: none there.
  pure function segments_at(surface, node) result(segments)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: node
    integer :: segments(2)

    segments(1) = surface%incoming(node)
    segments(2) = surface%outgoing(node)
  end function segments_at

  !> The segments that a contact point is on: those at a node, or one segment twice.
  pure function segments_of(surface, n_on_segment, i) result(segments)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: n_on_segment !! points of a segment; 0: points at nodes
    integer, intent(in) :: i            !! point
    integer :: segments(2)

    if (n_on_segment == 0) then
      segments = segments_at(surface, i)
    else
      segments = 1 + (i - 1)/n_on_segment
    end if
  end function segments_of

  !> Whether a face is opposed to a point: its outward normal is opposite to that of one of the
  !> point's segments within 60 degrees (points between nodes: 84 degrees), or lies opposite between
  !> both of them at a convex vertex, by 10 degrees at least: else the nodes of a body that slides
  !> on over a ramp would be held by the end face in front of it. At an end of an open surface the
  !> tangent that leads out of it takes the place of the missing normal there.
  pure function is_opposed(own, places, segments, normal) result(opposed)
    type(surface_t), intent(in) :: own
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    integer, intent(in) :: segments(2)               !! of the point, 0: none
    real(wp), intent(in) :: normal(2)                !! outward, of the face
    logical :: opposed
    real(wp) :: t(2, 2), normals(2, 2), limit
    integer :: k

    opposed = .false.
    do k = 1, 2
      if (segments(k) == 0) cycle
      t(:, k) = separation(places(:, own%segments(2, segments(k))), &
        places(:, own%segments(1, segments(k))))
      t(:, k) = t(:, k)/max(norm2(t(:, k)), tiny(1.0_wp))
      normals(:, k) = [t(2, k), -t(1, k)]
    end do
    if (segments(1) == 0) normals(:, 1) = -t(:, 2)
    if (segments(2) == 0) normals(:, 2) = t(:, 1)
    limit = merge(side_on, face_on, segments(1) == segments(2))
    do k = 1, 2
      if (segments(k) == 0) cycle
      opposed = dot_product(normals(:, k), normal) < limit
      if (opposed) return
    end do
    ! The opposite of the normal turns counter-clockwise from the first to the second of the
    ! normals.
    opposed = cross(normals(:, 1), normals(:, 2)) > 0.0_wp .and. &
      cross(normals(:, 1), -normal) > well_between .and. &
      cross(-normal, normals(:, 2)) > well_between
  end function is_opposed

  !> Whether a surface turns by more than 60 degrees from one segment to the next.
  pure function turns_sharply(surface, places, segment, next) result(sharply)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node) of this surface
    integer, intent(in) :: segment, next
    logical :: sharply
    real(wp) :: one(2), two(2)

    one = separation(places(:, surface%segments(2, segment)), &
      places(:, surface%segments(1, segment)))
    two = separation(places(:, surface%segments(2, next)), places(:, surface%segments(1, next)))
    sharply = dot_product(one, two) < gentle_turn*norm2(one)*norm2(two)
  end function turns_sharply

  !> Sine of the angle from one unit vector to another.
  pure function cross(a, b)
    real(wp), intent(in) :: a(2), b(2)
    real(wp) :: cross

    cross = a(1)*b(2) - a(2)*b(1)
  end function cross

end module opposed_m
