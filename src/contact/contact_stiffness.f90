! SPDX-License-Identifier: MIT
!> The tangent of one interface: the exact derivative of what evaluate_contact gives
!> (doc/theory/contact.md, section 9).
module contact_stiffness_m
  use contact_dispatch_m, only : add_tangent
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t, is_tied
  use sparse_m, only : sparse_t
  use tangent_ties_m, only : add_tie_tangent
  implicit none
  private
  public :: add_contact_stiffness

contains

  !> Add the derivative of minus the contact forces, as evaluate_contact has left them in the
  !> memory, with respect to u; which point is on which segment and which nodes cut which segment is
  !> held.
  pure subroutine add_contact_stiffness(contact, memory, equation, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: equation(:, :)   !! (2, n_node) of the mesh, 0 = not an unknown
    type(sparse_t), intent(inout) :: matrix !! started, not yet compressed
    integer, allocatable :: equations(:, :) !! by local number

    if (memory%points%n == 0) return
    equations = equation(:, memory%nodes)
    if (is_tied(contact)) then
      call add_tie_tangent(memory, equations, matrix)
    else
      call add_tangent(contact, memory, equations, matrix)
    end if
  end subroutine add_contact_stiffness

end module contact_stiffness_m
