! SPDX-License-Identifier: MIT
!> Types 1 to 3, classical NTS, NTS-AR and two-pass NTS-AR: a point at each slave node in contact;
!> in the second pass at each master node over the slave chain (doc/theory/contact.md, sections 5.1
!> to 5.3).
module place_nts_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use point_list_m, only : append_touching, set_lengths, weigh_nodes
  implicit none
  private
  public :: place_nts, place_nts_ar, place_two_pass_ar

contains

  !> Type 1: a spring of eps [N/m] at each node, whatever the mesh.
  pure subroutine place_nts(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    call append_touching(memory%slave_tracking, contact%master, [0, memory%n_slave], 1.0_wp, &
      memory%node_penalty, memory%points)
    if (contact%is_round) call weigh_slaves(contact, memory)
  end subroutine place_nts

  !> In axisymmetry: the points at slave nodes, which are the first.
  pure subroutine weigh_slaves(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    call weigh_nodes(memory%slave_tracking, contact%slave, memory%places(:, :memory%n_slave), 1, &
      memory%points)
  end subroutine weigh_slaves

  !> Type 2: the competence length of the node as area.
  pure subroutine place_nts_ar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory

    call append_touching(memory%slave_tracking, contact%master, [0, memory%n_slave], 0.0_wp, &
      memory%slave_penalty, memory%points)
    call set_lengths(memory%slave_tracking, contact%slave, memory%places(:, :memory%n_slave), &
      contact%is_round, 1, memory%points)
    if (contact%is_round .and. .not. memory%slave_tracking%pass%is_closed) &
      call weigh_slaves(contact, memory)
  end subroutine place_nts_ar

  !> Type 3: type 2, and again with the roles of slave and master exchanged; nothing is halved.
  pure subroutine place_two_pass_ar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: first

    call place_nts_ar(contact, memory)
    first = memory%points%n + 1
    call append_touching(memory%master_tracking, contact%slave, [memory%n_slave, 0], 0.0_wp, &
      memory%master_penalty, memory%points)
    call set_lengths(memory%master_tracking, contact%master, &
      memory%places(:, memory%n_slave + 1:), contact%is_round, first, memory%points)
    if (contact%is_round .and. .not. memory%master_tracking%pass%is_closed) &
      call weigh_nodes(memory%master_tracking, contact%master, &
      memory%places(:, memory%n_slave + 1:), first, memory%points)
  end subroutine place_two_pass_ar

end module place_nts_m
