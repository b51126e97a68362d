! SPDX-License-Identifier: MIT
!> Type 1, classical NTS: a point at each slave node, with a spring of eps [N/m] whatever the
!> mesh (doc/theory/contact.md, section 5.1).
module points_nts_m
  use contact_placing_m, only : add_touching_nodes, put_stiffness
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: place_nts

contains

  !> Place the points.
  pure subroutine place_nts(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    logical :: is_known

    call add_touching_nodes(memory%slave_tracking, contact%master, 0, memory%n_slave, &
      memory%points, is_known)
    if (.not. is_known) memory%points%area(:memory%points%n) = 1.0_wp
    call put_stiffness(memory%node_penalty, is_known, memory%points)
  end subroutine place_nts

end module points_nts_m
