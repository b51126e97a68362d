! SPDX-License-Identifier: MIT
!> The common cases of contact_projection, told by signs of products alone: a spot that is over a segment and not nearer to
!> any neighbour of it than to it. No distance is formed; the foot costs one root, the segment alone none.
module contact_plain_foot_m
  use contact_projection_m, only : foot_t, see_segment, face_foot
  use geometry_m, only : sight_t, separation
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: plain_foot, see_plain_segment, is_plainly_behind, is_plainly_over, &
    is_well_inside, well_inside

  !> Part of a segment next to its ends where round-off may decide which node or segment is closer.
  real(wp), parameter :: well_inside = 1.0e-9_wp
  !> Segments looked at on the way to the closest one.
  integer, parameter :: n_walk = 3

contains

  !> Whether a place behind a face stays on it without a look at its neighbours (as `follow_contact` has it).
  pure function is_plainly_behind(sight) result(is_behind)
    type(sight_t), intent(in) :: sight
    logical :: is_behind

    is_behind = sight%across < 0.0_wp .and. sight%across + sight%along >= 0.0_wp &
      .and. sight%across + sight%square >= sight%along
  end function is_plainly_behind

  !> Whether a place, on either side of a face, is over that and over no neighbour of it.
  pure function is_plainly_over(surface, chain, sight, segment) result(is_over)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :) !! (4, n_node) places
    type(sight_t), intent(in) :: sight  !! of the place from the segment
    integer, intent(in) :: segment
    logical :: is_over

    is_over = is_well_inside(sight)
    if (is_over) is_over = is_past(surface, chain, sight, segment, .true.)
    if (is_over) is_over = is_past(surface, chain, sight, segment, .false.)
  end function is_plainly_over

  !> What `walk_to_closest` and `closest_foot` find where a segment at or next to the start has the spot over it, while
  !> the closest points of all neighbours seen on the way are the nodes in common, which are farther away.
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

  !> That segment, and the spot seen from it.
  pure subroutine see_plain_segment(surface, chain, spot, start, segment, sight)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    real(wp), intent(in) :: spot(4)
    integer, intent(in) :: start
    integer, intent(out) :: segment !! 0: another case
    type(sight_t), intent(out) :: sight
    integer :: here, i_step
    logical :: backwards

    segment = 0
    here = start
    sight = see_segment(surface, chain, spot, here)
    backwards = sight%along < 0.0_wp
    do i_step = 1, n_walk
      if (is_well_inside(sight)) exit
      if (i_step == n_walk .or. (backwards .neqv. sight%along < 0.0_wp)) return
      if (i_step == 1 .and. .not. is_past(surface, chain, sight, here, .not. backwards)) return
      here = merge(surface%previous(here), surface%next(here), backwards)
      if (here == 0) return
      sight = see_segment(surface, chain, spot, here)
    end do
    if (is_plainly_over(surface, chain, sight, here)) segment = here
  end subroutine see_plain_segment

  !> Whether a place is over a segment and not at its ends.
  pure function is_well_inside(sight) result(is_inside)
    type(sight_t), intent(in) :: sight
    logical :: is_inside

    is_inside = sight%along > well_inside*sight%square &
      .and. sight%along < (1.0_wp - well_inside)*sight%square
  end function is_well_inside

  !> Whether the closest point of a neighbour is the node in common with the segment that the spot is seen from.
  pure function is_past(surface, chain, sight, segment, backwards)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :)
    type(sight_t), intent(in) :: sight
    integer, intent(in) :: segment
    logical, intent(in) :: backwards !! of the neighbour before, else after
    logical :: is_past
    real(wp) :: t(2)
    integer :: neighbour

    neighbour = merge(surface%previous(segment), surface%next(segment), backwards)
    is_past = neighbour == 0
    if (is_past) return
    associate (ends => surface%segments(:, neighbour))
      t = separation(chain(:, ends(2)), chain(:, ends(1)))
    end associate
    if (backwards) then
      is_past = sight%d(1)*t(1) + sight%d(2)*t(2) >= 0.0_wp
    else
      is_past = (sight%d(1) - sight%t(1))*t(1) + (sight%d(2) - sight%t(2))*t(2) <= 0.0_wp
    end if
  end function is_past

end module contact_plain_foot_m
