! SPDX-License-Identifier: MIT
!> Type 3, two-pass NTS-AR: type 2, and type 2 again with the roles of slave and master exchanged;
!> nothing is halved (doc/theory/contact.md, section 5.3).
module points_two_pass_ar_m
  use contact_competence_m, only : put_competence
  use contact_placing_m, only : add_touching_nodes
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
    integer :: first
    logical :: is_known

    call place_nts_ar(contact, memory)
    first = memory%points%n + 1
    call add_touching_nodes(memory%master_tracking, contact%slave, memory%n_slave, 0, &
      memory%points, is_known)
    if (memory%points%n < first) return
    call put_competence(contact%master, memory%places(:, memory%n_slave + 1:), &
      memory%points%n - first + 1, memory%points%slave_nodes(1, first), memory%n_slave, &
      memory%points%area(first))
    memory%points%stiffness(first:memory%points%n) = memory%master_penalty
  end subroutine place_two_pass_ar

end module points_two_pass_ar_m
