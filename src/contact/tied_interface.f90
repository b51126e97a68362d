! SPDX-License-Identifier: MIT
!> The start of a tied interface, placed once in the reference geometry, and what breaks at the end
!> of an implicit step.
module tied_interface_m
  use contact_dispatch_m, only : generate_points, formulation_t, formulation_of
  use contact_penalty_m, only : mean_length
  use contact_state_m, only : contact_state_t, allocate_tractions
  use contacts_m, only : contact_t, breaks
  use kinds_m, only : wp
  use model_m, only : model_t
  use tiebreak_m, only : start_breaking
  use ties_m, only : freeze_ties, break_ties
  implicit none
  private
  public :: start_ties, break_at_end, tie_reach

contains

  !> After the first search, which takes gaps within reach as closed: generate the contact points
  !> and freeze them.
  subroutine start_ties(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(formulation_t) :: formulation
    real(wp) :: reach

    call allocate_tractions(memory%points)
    formulation = formulation_of(contact)
    reach = tie_reach(contact, model)
    call generate_points(contact, memory)
    memory%closed_gap = 0.0_wp
    call freeze_ties(contact, reach, memory)
    if (breaks(contact)) call start_breaking(contact, formulation%has_unit_area, &
      formulation%has_two_passes, memory)
  end subroutine start_ties

  !> How far apart positions may lie that are tied, m.
  pure function tie_reach(contact, model) result(reach)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp) :: reach

    reach = contact%tie_reach
    if (.not. abs(reach) > 0.0_wp) reach = -1.0_wp
    if (reach < 0.0_wp) reach = -0.01_wp*reach*mean_length(contact%master, model)
  end function tie_reach

  !> Break what reaches its strength in equilibrium.
  pure subroutine break_at_end(contact, time, memory, n_new)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: time
    type(contact_state_t), intent(inout) :: memory
    integer, intent(out) :: n_new !! positions that have broken

    n_new = 0
    if (breaks(contact) .and. memory%points%n > 0) &
      call break_ties(contact%strength, time, memory, n_new)
  end subroutine break_at_end

end module tied_interface_m
