! SPDX-License-Identifier: MIT
!> Touching without penetration. Explicit steps know contact only where a gap is negative. A static
!> step must not start with two bodies that touch as free ones: for its first tangent, gaps that are
!> zero but for round-off count as contact, without any pressure (doc/theory/contact.md, section
!> 9.6).
module closing_m
  use foot_m, only : foot_t, closest_foot, face_foot, see_segment
  use contact_state_m, only : contact_state_t, tracking_t, is_touching, is_behind
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, segment_length, sight_gap
  use kinds_m, only : wp
  use surfaces_m, only : surface_t
  use tracking_m, only : list_touching, most_facing, begin_contact
  implicit none
  private
  public :: close_contacts, closed_gap_of, slave_length

  !> Gaps smaller than this part of the mean slave segment are closed.
  real(wp), parameter :: closed_part = 1.0e-8_wp

contains

  !> The gap of an interface below which places touch, m.
  pure function closed_gap_of(contact, memory) result(gap)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp) :: gap

    gap = closed_part*slave_length(contact, memory)/contact%slave%n_segment
  end function closed_gap_of

  !> Length of the slave chain as it lies now, m.
  pure function slave_length(contact, memory) result(length)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp) :: length
    integer :: s

    length = 0.0_wp
    do s = 1, contact%slave%n_segment
      length = length + segment_length(memory%places(:, contact%slave%segments(1, s)), &
        memory%places(:, contact%slave%segments(2, s)))
    end do
  end function slave_length

  !> Let all tracked spots with a gap below the given one be in contact, after a search, and the
  !> placement know of it.
  pure subroutine close_contacts(contact, gap, memory)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: gap !! m
    type(contact_state_t), intent(inout) :: memory

    memory%closed_gap = gap
    associate (slave => memory%places(:, :memory%n_slave), &
      master => memory%places(:, memory%n_slave + 1:))
      if (allocated(memory%spots)) then
        call close_spots(memory%slave_tracking, contact%master, master, memory%spots, gap)
      else
        call close_spots(memory%slave_tracking, contact%master, master, slave, gap)
      end if
      if (memory%master_tracking%n > 0) &
        call close_spots(memory%master_tracking, contact%slave, slave, master, gap)
    end associate
    if (.not. allocated(memory%segments%wake)) return
    memory%segments%wake = -huge(1.0_wp)
    memory%segments%next_wake = -huge(1.0_wp)
  end subroutine close_contacts

  !> The spots of one tracking; those just in contact too, since beside a corner round-off has
  !> chosen their face.
  pure subroutine close_spots(tracking, surface, chain, spots, gap)
    type(tracking_t), intent(inout) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :) !! (4, n) places
    real(wp), intent(in) :: gap
    type(foot_t) :: foot
    integer :: i, n_released

    n_released = 0
    do i = 1, tracking%n
      if (tracking%segment(i) > 0 .and. tracking%status(i) /= is_behind) then
        foot = closed_foot(tracking, surface, chain, spots, i, gap)
        if (foot%segment > 0) then
          call begin_contact(tracking, i, foot, n_released)
          tracking%next_wake = -huge(1.0_wp)
        end if
      end if
    end do
    call list_touching(tracking)
  end subroutine close_spots

  !> Foot of a spot that touches a face without gap, unless it has one already. Beside a sharp
  !> corner it is on the face that the spot's own surface faces most. Segment 0: none.
  pure function closed_foot(tracking, surface, chain, spots, i, gap) result(foot)
    type(tracking_t), intent(in) :: tracking
    type(surface_t), intent(in) :: surface
    real(wp), intent(in), contiguous :: chain(:, :), spots(:, :)
    integer, intent(in) :: i
    real(wp), intent(in) :: gap
    type(foot_t) :: foot, other
    type(sight_t) :: sight, facing
    integer :: face

    other = closest_foot(surface, chain, spots(:, i), tracking%segment(i))
    if (.not. other%is_on .or. abs(other%gap) >= gap) return
    sight = see_segment(surface, chain, spots(:, i), other%segment)
    if (tracking%status(i) /= is_touching) foot = face_foot(sight, other%segment)
    face = most_facing(tracking, surface, chain, spots, i, other, .true.)
    if (face == 0 .or. face == other%segment) return
    facing = see_segment(surface, chain, spots(:, i), face)
    if (abs(sight_gap(facing)) < gap) foot = face_foot(facing, face)
  end function closed_foot

end module closing_m
