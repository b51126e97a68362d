! SPDX-License-Identifier: MIT
!> Feet of places that are near a known master segment.
module contact_local_foot_m
  use contact_plain_foot_m, only : plain_foot, corner_behind, is_plainly_behind, is_well_inside
  use contact_projection_m, only : foot_t, closest_foot, face_foot, follow_contact, &
    walk_to_closest, see_segment
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t
  use kinds_m, only : wp
  implicit none
  private
  public :: free_foot, local_foot

contains

  !> Closest foot of a place on the master chain, found by walking.
  pure function free_foot(contact, memory, place, start) result(foot)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: place(4)
    integer, intent(in) :: start !! master segment
    type(foot_t) :: foot
    logical :: is_found

    associate (chain => memory%places(:, memory%n_slave + 1:))
      call plain_foot(contact%master, chain, place, start, is_found, foot)
      if (.not. is_found) foot = closest_foot(contact%master, chain, place, &
        walk_to_closest(contact%master, chain, place, start))
    end associate
  end function free_foot

  !> Foot of a place that is known to be near a master segment: behind the surface it belongs to the
  !> face that it came through, outside to the closest one.
  pure function local_foot(contact, memory, place, start) result(foot)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: place(4)
    integer, intent(in) :: start !! master segment
    type(foot_t) :: foot
    type(foot_t) :: closest
    type(sight_t) :: sight
    logical :: is_found

    associate (chain => memory%places(:, memory%n_slave + 1:))
      sight = see_segment(contact%master, chain, place, start)
      if (is_plainly_behind(sight) .and. is_well_inside(sight)) then
        ! What follows would find no foot in front and stay on this face.
        foot = face_foot(sight, start)
        return
      end if
      call corner_behind(contact%master, chain, place, start, sight, is_found, foot)
      if (is_found) return
      call plain_foot(contact%master, chain, place, start, is_found, closest)
      if (is_found .and. closest%gap >= 0.0_wp) then
        foot = closest
        return
      end if
      foot = follow_contact(contact%master, chain, place, start)
      if (foot%is_on .and. foot%gap < 0.0_wp) return
      if (is_found) then
        foot = closest
      else
        foot = closest_foot(contact%master, chain, place, &
          walk_to_closest(contact%master, chain, place, start))
      end if
    end associate
  end function local_foot

end module contact_local_foot_m
