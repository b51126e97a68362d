! SPDX-License-Identifier: MIT
!> What spots are paired with that are not in contact, where others near them are: their segments
!> have a part in types 5 to 7 (doc/theory/contact.md, section 4).
module pairing_m
  use contact_state_m, only : contact_state_t, tracking_t
  use foot_m, only : foot_t, see_segment, closest_foot, walk_to_closest, end_tolerance
  use geometry_m, only : sight_t, closest_distance
  use grid_m, only : nearest_t, find_nearest
  use kinds_m, only : wp
  use self_search_m, only : find_nearest_other, may_meet
  use surfaces_m, only : surface_t
  use tracking_m, only : most_facing
  implicit none
  private
  public :: present_pair, has_chains

contains

  !> Whether the master has several chains: only then it matters which segment a spot is paired
  !> with, since feet are found along a chain. Of chains as they stand the last one ends the list;
  !> of runs the first one may.
  pure function has_chains(memory, master) result(several)
    type(contact_state_t), intent(in) :: memory
    type(surface_t), intent(in) :: master
    logical :: several

    several = memory%facing%is_used
    if (.not. several) several = master%chain(master%n_segment) > 1
  end function has_chains

  !> Master segment that a spot which is not in contact is paired with at its present place: that of
  !> its last look, unless it sleeps and another one has become the closest since.
  pure function present_pair(tracking, surface, chain, spots, i, travel) result(segment)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i
    real(wp), intent(in) :: travel
    integer :: segment
    type(nearest_t) :: nearest
    type(foot_t) :: foot
    integer :: face

    segment = tracking%segment(i)
    if (segment == 0 .or. .not. travel < tracking%wake(i)) return
    if (is_kept(segment)) return
    foot = closest_foot(surface, chain, spots(:, i), &
      walk_to_closest(surface, chain, spots(:, i), segment))
    if (foot%distance > min(tracking%reach, tracking%recheck(i) - travel) &
      .or. .not. may_meet(tracking, surface, chain, spots, i, foot%segment)) then
      if (tracking%own_spots < 0) then
        call find_nearest(tracking%grid, surface, chain, spots(:, i), travel, tracking%reach, &
          nearest)
      else
        call find_nearest_other(tracking, surface, chain, spots, i, travel, .false., nearest)
      end if
      segment = nearest%segment
      if (segment == 0) return
      foot = closest_foot(surface, chain, spots(:, i), segment)
    end if
    segment = foot%segment
    face = most_facing(tracking, surface, chain, spots, i, foot, .false.)
    if (face > 0) segment = face

  contains

    !> Whether no other chain than that of the last look is nearer yet, the spot being next to
    !> neither end of its segment.
    pure function is_kept(segment) result(kept)
      integer, intent(in) :: segment
      logical :: kept
      type(sight_t) :: sight

      sight = see_segment(surface, chain, spots(:, i), segment)
      kept = min(sight%along, sight%square - sight%along) > end_tolerance*sight%square &
        .and. closest_distance(sight) <= max(0.0_wp, min(tracking%reach, &
        tracking%recheck(i) - travel))**2
      if (kept) kept = may_meet(tracking, surface, chain, spots, i, segment)
    end function is_kept

  end function present_pair

end module pairing_m
