! SPDX-License-Identifier: MIT
!> Which segments of two surfaces face each other (doc/theory/contact.md, section 3.7). A place of a
!> segment faces a segment of the other surface where the outward normals are against each other
!> within 60 degrees and the place stands over that segment, within `capture` before it and its
!> depth behind it. Who faces a whole outline from outside is found so, whichever way it came.
module facing_m
  use contact_state_m, only : bucket_grid_t
  use foot_m, only : face_on, is_over_segment
  use geometry_m, only : sight_t, sight_of_segment, sight_gap, sight_normal, separation
  use grid_m, only : cell_of, bucket_of
  use kinds_m, only : wp
  use runs_m, only : turn_t, turn_at
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: side_view_t, find_facing, is_own

  !> Sine of the angle by which a direction lies between two others (10 degrees).
  real(wp), parameter :: well_between = 0.17_wp
  !> Places of a segment that are looked at.
  real(wp), parameter :: looked_at(3) = [0.1_wp, 0.5_wp, 0.9_wp]

  !> What is known of a surface at a look.
  type :: side_view_t
    real(wp), allocatable :: places(:, :) !! (4, n_node)
    real(wp), allocatable :: depth(:)     !! (n_segment) m
    type(bucket_grid_t) :: grid           !! of its segments, filled now
  end type side_view_t

contains

  !> Note all segments of one surface that face the other, and those that they face: of each place
  !> the nearest one. A sharp corner faces by its node where no side of it does.
  pure subroutine find_facing(own, own_view, target, view, capture, is_same, faces, faced, opposite)
    type(surface_t), intent(in) :: own, target
    type(side_view_t), intent(in) :: own_view, view
    real(wp), intent(in) :: capture      !! m
    logical, intent(in) :: is_same       !! both are one surface
    logical, intent(inout) :: faces(:)   !! (segments of `own`)
    logical, intent(inout) :: faced(:)   !! (segments of `target`)
    integer, intent(inout), optional :: opposite(:, :) !! (4, segments of `own`) what each of their
                                         !! places faces, and the corner behind, 0: nothing
    logical, allocatable :: by_place(:) !! what the other surface has found says nothing of corners
    real(wp) :: place(4), normal(2)
    integer :: s, k, found

    allocate (by_place(own%n_segment), source=.false.)
    do s = 1, own%n_segment
      associate (a => own_view%places(:, own%segments(1, s)), &
        b => own_view%places(:, own%segments(2, s)))
        if (.not. is_near(view, a, b, capture)) cycle
        normal = normal_of(own, own_view%places, s)
        do k = 1, size(looked_at)
          place = (1.0_wp - looked_at(k))*a + looked_at(k)*b
          found = nearest_faced(target, view, place, normal, normal, capture, [s, s], is_same)
          if (present(opposite)) opposite(k, s) = found
          if (found == 0) cycle
          by_place(s) = .true.
          faced(found) = .true.
        end do
      end associate
    end do
    faces = faces .or. by_place
    call find_facing_corners(own, own_view, target, view, capture, is_same, by_place, faces, &
      faced, opposite)
  end subroutine find_facing

  !> Sharp convex corners neither side of which faces by its places: by the normals between those of
  !> the sides. Of these count those within 60 degrees of the target, or both where none is.
  pure subroutine find_facing_corners(own, own_view, target, view, capture, is_same, by_place, &
      faces, faced, opposite)
    type(surface_t), intent(in) :: own, target
    type(side_view_t), intent(in) :: own_view, view
    real(wp), intent(in) :: capture
    logical, intent(in) :: is_same
    logical, intent(in) :: by_place(:)           !! segments that face by their own places
    logical, intent(inout) :: faces(:), faced(:)
    integer, intent(inout), optional :: opposite(:, :)
    type(turn_t) :: turn
    real(wp) :: cosines(2)
    integer :: s, next, node, found

    do s = 1, own%n_segment
      next = own%next(s)
      if (next == 0 .or. by_place(s)) cycle
      if (by_place(next)) cycle
      turn = turn_at(own, own_view%places, s, next)
      if (.not. (turn%is_sharp .and. turn%is_convex)) cycle
      node = own%segments(2, s)
      associate (place => own_view%places(:, node), one => normal_of(own, own_view%places, s), &
        two => normal_of(own, own_view%places, next))
        if (.not. is_near(view, place, place, capture)) cycle
        found = nearest_faced(target, view, place, one, two, capture, [s, next], is_same)
      end associate
      if (present(opposite)) opposite(size(looked_at) + 1, s) = found
      if (found == 0) cycle
      faced(found) = .true.
      cosines = [dot_product(normal_of(own, own_view%places, s), normal_of(target, view%places, &
        found)), dot_product(normal_of(own, own_view%places, next), normal_of(target, view%places, &
        found))]
      if (minval(cosines) >= face_on) cosines = -1.0_wp
      faces(s) = faces(s) .or. cosines(1) < face_on
      faces(next) = faces(next) .or. cosines(2) < face_on
    end do
  end subroutine find_facing_corners

  !> Outward normal of a segment.
  pure function normal_of(surface, places, segment) result(normal)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node)
    integer, intent(in) :: segment
    real(wp) :: normal(2), t(2)

    t = separation(places(:, surface%segments(2, segment)), places(:, surface%segments(1, segment)))
    normal = [t(2), -t(1)]/max(norm2(t), tiny(1.0_wp))
  end function normal_of

  !> Whether a segment from a to b may be within `capture` of a surface, by the box of that.
  pure function is_near(view, a, b, capture) result(near)
    type(side_view_t), intent(in) :: view
    real(wp), intent(in) :: a(4), b(4), capture
    logical :: near
    real(wp) :: y(2), z(2)

    y = separation(a, view%places(:, 1))
    z = separation(b, view%places(:, 1))
    near = all(min(y, z) <= view%grid%high + capture .and. max(y, z) >= view%grid%low - capture)
  end function is_near

  !> The segment of a surface that a place faces, of several the one whose line is nearest; 0: none.
  !> The normals from `first` on to `last`, counter-clockwise, are those of the place.
  pure function nearest_faced(target, view, place, first, last, capture, beside, &
      is_same) result(found)
    type(surface_t), intent(in) :: target
    type(side_view_t), intent(in) :: view
    real(wp), intent(in) :: place(4), first(2), last(2), capture
    integer, intent(in) :: beside(2) !! segments that the place is on, of this surface or another
    logical, intent(in) :: is_same
    integer :: found
    real(wp) :: gap, nearest
    integer :: low(2), high(2), ix, iy, bucket, i
    type(sight_t) :: sight

    found = 0
    nearest = huge(1.0_wp)
    associate (y => separation(place, view%places(:, 1)), grid => view%grid, &
      ends => target%segments)
      low = cell_of(grid, max(y - capture, grid%low))
      high = cell_of(grid, min(y + capture, grid%high))
      do iy = low(2), high(2)
        do ix = low(1), high(1)
          bucket = bucket_of(grid, ix, iy)
          do i = grid%first(bucket) + 1, grid%first(bucket + 1)
            associate (t => grid%items(i))
              sight = sight_of_segment(place, view%places(:, ends(1, t)), &
                view%places(:, ends(2, t)))
              if (.not. is_over_segment(sight)) cycle
              gap = sight_gap(sight)
              if (gap >= capture .or. gap <= -view%depth(t) .or. abs(gap) >= nearest) cycle
              if (is_same) then
                if (is_own(target, view%places, beside, t)) cycle
                if (beside(1) /= beside(2) .and. any(ends(:, t) == ends(1, beside(1)) &
                  .or. ends(:, t) == ends(2, beside(2)))) cycle
              end if
              if (.not. is_against(first, last, sight_normal(sight))) cycle
              found = t
              nearest = abs(gap)
            end associate
          end do
        end do
      end do
    end associate
  end function nearest_faced

  !> Whether a segment is part of the same side of the body as a place, or its back. A segment that
  !> shares a node with it is its own unless the side folds there, and none may be met before that;
  !> what has the same element behind it is the far side of a thin wall.
  pure function is_own(surface, places, beside, segment) result(own)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: places(:, :) !! (4, n_node)
    integer, intent(in) :: beside(2) !! segments that the place is on, 0: none
    integer, intent(in) :: segment
    logical :: own
    type(turn_t) :: turn
    integer :: k

    own = any(beside == segment)
    associate (ends => surface%segments, element => surface%segment_element)
      do k = 1, 2
        if (beside(k) == 0 .or. own) cycle
        if (ends(2, beside(k)) == ends(1, segment)) then
          turn = turn_at(surface, places, beside(k), segment)
        else if (ends(1, beside(k)) == ends(2, segment)) then
          turn = turn_at(surface, places, segment, beside(k))
        else
          own = element(beside(k)) == element(segment)
          cycle
        end if
        own = turn%is_convex
      end do
    end associate
  end function is_own

  !> Whether the opposite of a normal lies within 60 degrees of that of a segment, or well between
  !> those of the two at a corner. Next to one of these the side lies along the target, and faces
  !> or does not by its own places.
  pure function is_against(first, last, normal) result(against)
    real(wp), intent(in), dimension(2) :: first, last !! of the segment, or before and behind the
                                                      !! corner
    real(wp), intent(in) :: normal(2)
    logical :: against

    if (all(abs(first - last) <= 0.0_wp)) then
      against = dot_product(first, normal) < face_on
    else
      against = first(1)*normal(2) - first(2)*normal(1) < -well_between .and. &
        normal(1)*last(2) - normal(2)*last(1) < -well_between
    end if
  end function is_against

end module facing_m
