! SPDX-License-Identifier: MIT
!> Gaps below which points are contact although they are not penetrated: touching bodies at the
!> first tangent of an implicit step, and what may touch before the step ahead ends, for springs
!> that push by the gaps of the end of the step (doc/theory/contact.md, sections 6.6 and 9.6).
module closed_gap_m
  use candidates_m, only : mean_length
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: closed_gap_of, gap_ahead

  !> Gaps smaller than this part of the mean slave segment are closed.
  real(wp), parameter :: closed_part = 1.0e-8_wp
  !> Largest gap that counts for the step ahead, as a part of the mean slave segment: a node moves
  !> by less in a stable step.
  real(wp), parameter :: most_ahead = 0.5_wp
  !> Least: a strain of that much in one step.
  real(wp), parameter :: least_ahead = 0.02_wp
  !> Times what nodes have moved in the last step is added to that.
  real(wp), parameter :: ahead_factor = 2.0_wp

contains

  !> The gap of an interface below which bodies touch, m.
  pure function closed_gap_of(contact, memory) result(gap)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp) :: gap

    gap = closed_part*mean_length(contact%slave, memory%positions(:, :memory%n_slave))
  end function closed_gap_of

  !> The gap that may close in the step ahead, m.
  pure function gap_ahead(contact, is_first, memory) result(gap)
    type(contact_t), intent(in) :: contact
    logical, intent(in) :: is_first !! nothing is known of a step before
    type(contact_state_t), intent(in) :: memory
    real(wp) :: gap, segment

    segment = mean_length(contact%slave, memory%positions(:, :memory%n_slave))
    gap = most_ahead*segment
    if (.not. is_first) gap = min(gap, least_ahead*segment + ahead_factor*memory%advance)
  end function gap_ahead

end module closed_gap_m
