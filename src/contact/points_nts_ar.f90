! SPDX-License-Identifier: MIT
!> Type 2, NTS-AR: a point at each slave node, with its competence length as area
!> (doc/theory/contact.md, section 5.2).
module points_nts_ar_m
  use contact_competence_m, only : put_competence
  use contact_placing_m, only : add_touching_nodes, put_stiffness
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  implicit none
  private
  public :: place_nts_ar

contains

  !> Place the points.
  pure subroutine place_nts_ar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    logical :: is_known

    call add_touching_nodes(memory%slave_tracking, contact%master, 0, memory%n_slave, &
      memory%points, is_known)
    if (memory%points%n == 0) return
    call put_competence(contact%slave, memory%places(:, :memory%n_slave), memory%points%n, &
      memory%points%slave_nodes, 0, memory%points%area)
    call put_stiffness(memory%slave_penalty, is_known, memory%points)
  end subroutine place_nts_ar

end module points_nts_ar_m
