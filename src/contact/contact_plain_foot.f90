! SPDX-License-Identifier: MIT
!> The common cases of contact_projection, told by signs of products alone: a spot that is over a
!> segment and not nearer to any neighbour of it than to it. No distance is formed; the foot costs
!> one root, the segment alone none.
module contact_plain_foot_m
  use contact_projection_m, only : foot_t, face_foot, corner_foot, see_segment, is_before
  use geometry_m, only : sight_t, sight_of_segment, separation
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: plain_foot, corner_behind, see_plain_segment, is_plainly_behind, is_well_inside, &
    well_inside

  !> Part of a segment next to its ends where round-off may decide which node or segment is closer.
  real(wp), parameter :: well_inside = 1.0e-9_wp
  !> Segments looked at on the way to the closest one.
  integer, parameter :: n_walk = 3

contains

  !> Whether a place behind a face stays on it without a look at its neighbours (as `follow_contact`
  !> has it).
  pure function is_plainly_behind(sight) result(is_behind)
    type(sight_t), intent(in) :: sight
    logical :: is_behind

    is_behind = sight%across < 0.0_wp .and. sight%across + sight%along >= 0.0_wp &
      .and. sight%across + sight%square >= sight%along
  end function is_plainly_behind

  !> What `walk_to_closest` and `closest_foot` find where a segment at or next to the start has the
  !> spot over it, while the closest points of all neighbours seen on the way are the nodes in
  !> common, which are farther away.
  pure subroutine plain_foot(surface, chain, spot, start, is_found, foot)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: start
    logical, intent(out) :: is_found
    type(foot_t), intent(inout) :: foot !! left alone unless found
    type(sight_t) :: sight
    integer :: segment

    call see_plain_segment(surface, chain, spot, start, segment, sight)
    is_found = segment > 0
    if (is_found) foot = face_foot(sight, segment)
  end subroutine plain_foot

  !> Foot of a spot behind the node between a segment and its neighbour, over neither of them: there
  !> `plain_foot` finds nothing and `follow_contact` goes no further. In a valley many spots are of
  !> this kind.
  pure subroutine corner_behind(surface, chain, spot, segment, sight, is_found, foot)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: segment
    type(sight_t), intent(in) :: sight !! the spot seen from it
    logical, intent(out) :: is_found
    type(foot_t), intent(inout) :: foot
    type(sight_t) :: other
    integer :: neighbour
    logical :: backwards

    is_found = .false.
    backwards = sight%along < 0.0_wp
    if (.not. (backwards .or. sight%along > sight%square)) return
    neighbour = merge(surface%previous(segment), surface%next(segment), backwards)
    if (neighbour == 0) return
    other = see_segment(surface, chain, spot, neighbour)
    if (.not. is_before(other, backwards)) return
    foot = corner_foot(sight, other, segment)
    is_found = foot%gap < 0.0_wp
  end subroutine corner_behind

  !> That segment, and the spot seen from it.
  pure subroutine see_plain_segment(surface, chain, spot, start, segment, sight)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: start
    integer, intent(out) :: segment !! 0: another case
    type(sight_t), intent(out) :: sight

    call walk_to_plain(surface%segments, surface%previous, surface%next, chain, spot, start, &
      segment, sight)
  end subroutine see_plain_segment

  !> The same on arrays of known shape.
  pure subroutine walk_to_plain(ends, previous, next, chain, spot, start, segment, sight)
    integer, intent(in) :: ends(2, *), previous(*), next(*) !! of the segments
    real(wp), intent(in) :: chain(4, *), spot(4)
    integer, intent(in) :: start
    integer, intent(out) :: segment
    type(sight_t), intent(out) :: sight
    integer :: here, i_step
    logical :: backwards

    segment = 0
    here = start
    sight = sight_of_segment(spot, chain(:, ends(1, here)), chain(:, ends(2, here)))
    backwards = sight%along < 0.0_wp
    do i_step = 1, n_walk
      if (is_well_inside(sight)) exit
      if (i_step == n_walk .or. (backwards .neqv. sight%along < 0.0_wp)) return
      if (i_step == 1) then
        if (backwards .and. along_neighbour(ends, next(here), chain, sight%d - sight%t) > 0.0_wp) &
          return
        if (.not. backwards .and. along_neighbour(ends, previous(here), chain, sight%d) < 0.0_wp) &
          return
      end if
      here = merge(previous(here), next(here), backwards)
      if (here == 0) return
      sight = sight_of_segment(spot, chain(:, ends(1, here)), chain(:, ends(2, here)))
    end do
    ! The closest point of either neighbour is the node in common.
    if (along_neighbour(ends, previous(here), chain, sight%d) < 0.0_wp) return
    if (along_neighbour(ends, next(here), chain, sight%d - sight%t) <= 0.0_wp) segment = here
  end subroutine walk_to_plain

  !> Whether a place is over a segment and not at its ends.
  pure function is_well_inside(sight) result(is_inside)
    type(sight_t), intent(in) :: sight
    logical :: is_inside

    is_inside = sight%along > well_inside*sight%square &
      .and. sight%along < (1.0_wp - well_inside)*sight%square
  end function is_well_inside

  !> How far a way leads along a neighbour, times the length of that, m^2; 0 where there is none.
  pure function along_neighbour(ends, neighbour, chain, way) result(along)
    integer, intent(in) :: ends(2, *)
    integer, intent(in) :: neighbour !! 0: none
    real(wp), intent(in) :: chain(4, *)
    real(wp), intent(in) :: way(2)
    real(wp) :: along
    real(wp) :: t(2)

    along = 0.0_wp
    if (neighbour == 0) return
    t = separation(chain(:, ends(2, neighbour)), chain(:, ends(1, neighbour)))
    along = way(1)*t(1) + way(2)*t(2)
  end function along_neighbour

end module contact_plain_foot_m
