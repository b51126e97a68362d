! SPDX-License-Identifier: MIT
!> The segments of a surface from near a point outwards, sorted once along the longer side of their
!> box: the closest of them is found without asking those that are farther away along it.
module near_segments_m
  use kinds_m, only : wp, long
  use sorting_m, only : sorted_order
  use surfaces_m, only : surface_t, has_closed_chain
  implicit none
  private
  public :: near_segments_t, cursor_t, sort_segments, start_near, next_near

  !> Segments of a surface by their middles.
  type :: near_segments_t
    logical :: is_closed = .false.    !! the surface has a closed chain
    integer :: axis = 1               !! the coordinate they are sorted by
    real(wp) :: margin = 0.0_wp       !! half of the longest segment, with room for round-off, m
    integer, allocatable :: order(:)  !! (n_segment) segments
    real(wp), allocatable :: at(:)    !! (n_segment) coordinates of their middles, rising, m
  end type near_segments_t

  !> What has been asked so far: those between `low` and `high`.
  type :: cursor_t
    real(wp) :: x = 0.0_wp            !! of the point, m
    integer :: low = 0, high = 0
  end type cursor_t

contains

  !> Sorts the segments of a surface.
  pure subroutine sort_segments(surface, polyline, near)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: polyline(:, :) !! (4, n_node) positions, m
    type(near_segments_t), intent(out) :: near
    real(wp), allocatable :: middle(:, :)
    integer :: s

    allocate (middle(2, surface%n_segment))
    do s = 1, surface%n_segment
      associate (one => polyline(1:2, surface%segments(1, s)), &
        two => polyline(1:2, surface%segments(2, s)))
        middle(:, s) = 0.5_wp*(one + two)
        near%margin = max(near%margin, 0.51_wp*norm2(two - one))
      end associate
    end do
    near%is_closed = has_closed_chain(surface)
    near%axis = maxloc(maxval(middle, 2) - minval(middle, 2), 1)
    ! Reals that are not negative rise as their bits do.
    near%at = middle(near%axis, :)
    near%order = sorted_order(transfer(near%at - minval(near%at), [0_long]))
    near%at = near%at(near%order)
  end subroutine sort_segments

  !> A cursor at a point.
  pure function start_near(near, point) result(cursor)
    type(near_segments_t), intent(in) :: near
    real(wp), intent(in) :: point(:) !! (2 or more) position, m
    type(cursor_t) :: cursor
    integer :: middle

    cursor = cursor_t(x=point(near%axis), low=0, high=size(near%at) + 1)
    do while (cursor%high - cursor%low > 1)
      middle = (cursor%low + cursor%high)/2
      if (near%at(middle) < cursor%x) then
        cursor%low = middle
      else
        cursor%high = middle
      end if
    end do
  end function start_near

  !> The next segment, on either side of the point; 0 where no other can be within a distance.
  pure subroutine next_near(near, within, cursor, segment)
    type(near_segments_t), intent(in) :: near
    real(wp), intent(in) :: within !! m
    type(cursor_t), intent(inout) :: cursor
    integer, intent(out) :: segment
    real(wp) :: below, above

    below = huge(1.0_wp)
    above = huge(1.0_wp)
    if (cursor%low > 0) below = cursor%x - near%at(cursor%low)
    if (cursor%high <= size(near%at)) above = near%at(cursor%high) - cursor%x
    segment = 0
    if (min(below, above) > within + near%margin) return
    if (below <= above) then
      segment = near%order(cursor%low)
      cursor%low = cursor%low - 1
    else
      segment = near%order(cursor%high)
      cursor%high = cursor%high + 1
    end if
  end subroutine next_near

end module near_segments_m
