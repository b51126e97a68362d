! SPDX-License-Identifier: MIT
!> Places that may touch before the step ends. Springs that push by the gaps of the end of the step
!> need their points before anything is closed: for as long as points are placed, spots that stand
!> before a face within reach are in contact with it.
module look_ahead_m
  use closing_m, only : slave_length
  use contact_state_m, only : contact_state_t, contact_scratch_t, is_in_front
  use contacts_m, only : contact_t
  use foot_m, only : foot_t, face_foot, see_segment
  use kinds_m, only : wp
  use tracking_m, only : list_touching, begin_contact, put_off
  implicit none
  private
  public :: look_ahead, look_back

  !> How far is looked ahead at most, as part of the mean slave segment: a node moves by less in a
  !> stable step.
  real(wp), parameter :: most_reach = 0.5_wp
  !> How far at least, since the next step may move nodes by more than the last one has: a strain of
  !> that much in one step.
  real(wp), parameter :: least_reach = 0.02_wp
  !> Times what they have moved in the last one is added to that.
  real(wp), parameter :: ahead_factor = 2.0_wp

contains

  !> Have the placement take gaps within reach as closed.
  pure subroutine look_ahead(contact, is_first, moved, memory)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: is_first !! nothing is known of a step before
    real(wp), intent(in) :: moved   !! bound on what nodes have moved relative to each other, m
    type(contact_state_t), intent(inout) :: memory
    type(foot_t) :: foot
    integer :: i, n_released

    memory%closed_gap = reach_of(contact, is_first, moved, memory)
    call provide_ahead(memory%slave_tracking%n, memory%scratch)
    associate (tracking => memory%slave_tracking, gap => memory%closed_gap, &
      n => memory%scratch%n_ahead, slave => memory%places(:, :memory%n_slave), &
      master => memory%places(:, memory%n_slave + 1:))
      do i = 1, tracking%n
        if (tracking%status(i) /= is_in_front .or. tracking%wake(i) - gap > memory%travel) cycle
        foot = face_foot(see_segment(contact%master, master, slave(:, i), tracking%segment(i)), &
          tracking%segment(i))
        if (.not. foot%is_on) cycle
        if (foot%gap >= gap) then
          call put_off(tracking, contact%master, master, slave(:, i), i, memory%travel)
          cycle
        end if
        n = n + 1
        memory%scratch%ahead(n) = i
        memory%scratch%ahead_wake(n) = tracking%wake(i)
        call begin_contact(tracking, i, foot, n_released)
      end do
      if (n > 0) call list_touching(tracking)
    end associate
    if (memory%segments%next_wake - memory%closed_gap > memory%travel) return
    where (memory%segments%wake - memory%closed_gap <= memory%travel) &
      memory%segments%wake = -huge(1.0_wp)
    memory%segments%next_wake = -huge(1.0_wp)
  end subroutine look_ahead

  !> Once the points are placed: what is not closed stands before its face as it did.
  pure subroutine look_back(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: k

    if (memory%scratch%n_ahead == 0) return
    associate (tracking => memory%slave_tracking, scratch => memory%scratch)
      do k = 1, scratch%n_ahead
        tracking%status(scratch%ahead(k)) = is_in_front
        tracking%wake(scratch%ahead(k)) = scratch%ahead_wake(k)
      end do
      call list_touching(tracking)
    end associate
  end subroutine look_back

  !> An empty list with room for all spots.
  pure subroutine provide_ahead(n, scratch)
    integer, intent(in) :: n
    type(contact_scratch_t), intent(inout) :: scratch

    scratch%n_ahead = 0
    if (allocated(scratch%ahead)) then
      if (size(scratch%ahead) >= n) return
      deallocate (scratch%ahead, scratch%ahead_wake)
    end if
    allocate (scratch%ahead(n), scratch%ahead_wake(n))
  end subroutine provide_ahead

  !> How far is looked ahead, m.
  pure function reach_of(contact, is_first, moved, memory) result(reach)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: is_first
    real(wp), intent(in) :: moved !! as above
    type(contact_state_t), intent(in) :: memory
    real(wp) :: reach, segment

    segment = slave_length(contact, memory)/max(1, contact%slave%n_segment)
    reach = most_reach*segment
    if (.not. is_first) reach = min(reach, least_reach*segment + ahead_factor*moved)
  end function reach_of

end module look_ahead_m
