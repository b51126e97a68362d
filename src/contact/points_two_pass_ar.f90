! SPDX-License-Identifier: MIT
!> Type 3, two-pass NTS-AR: type 2, and type 2 again with the roles of slave and master exchanged;
!> nothing is halved (doc/theory/contact.md, section 5.3).
module points_two_pass_ar_m
  use contact_placing_m, only : add_touching_nodes, competence_length
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use points_nts_ar_m, only : place_nts_ar
  implicit none
  private
  public :: place_two_pass_ar

contains

  !> Place the points of both passes.
  pure subroutine place_two_pass_ar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: p, n_slave_pass

    call place_nts_ar(contact, memory)
    n_slave_pass = memory%points%n
    call add_touching_nodes(memory%master_tracking, contact%slave, memory%n_slave, 0, memory%points)
    do p = n_slave_pass + 1, memory%points%n
      memory%points%area(p) = competence_length(contact%master, &
        memory%places(:, memory%n_slave + 1:), memory%points%slave_nodes(1, p) - memory%n_slave)
      memory%points%stiffness(p) = memory%master_penalty
    end do
  end subroutine place_two_pass_ar

end module points_two_pass_ar_m
