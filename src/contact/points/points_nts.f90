! SPDX-License-Identifier: MIT
!> Types 1 to 3, classical NTS, NTS-AR and two-pass NTS-AR: a point at each slave node in contact;
!> in the second pass at each master node over the slave surface (doc/theory/contact.md, sections
!> 5.1 to 5.3).
module points_nts_m
  use contact_state_m, only : contact_state_t, contact_points_t
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use tributary_lengths_m, only : put_lengths
  use point_list_m, only : append_active
  implicit none
  private
  public :: points_nts, points_nts_ar, points_two_pass_ar

contains

  !> Type 1: a spring of eps [N/m] at each node, whatever the mesh; in axisymmetry times the mean
  !> radius of its tributary length.
  pure subroutine points_nts(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points
    real(wp), allocatable :: lengths(:)

    call append_active(memory%slave_status, contact%master, [0, memory%n_slave], 1.0_wp, &
      memory%node_penalty, points)
    if (.not. contact%is_round) return
    allocate (lengths(points%n))
    associate (slave_positions => memory%positions(:, :memory%n_slave), &
      areas => points%area(:points%n))
      call put_lengths(contact%slave, slave_positions, .true., memory%slave_status, areas)
      call put_lengths(contact%slave, slave_positions, .false., memory%slave_status, lengths)
      areas = areas/max(lengths, tiny(1.0_wp))
    end associate
  end subroutine points_nts

  !> Type 2: the tributary length of the node as area.
  pure subroutine points_nts_ar(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points

    call append_active(memory%slave_status, contact%master, [0, memory%n_slave], 0.0_wp, &
      memory%slave_penalty, points)
    call put_lengths(contact%slave, memory%positions(:, :memory%n_slave), contact%is_round, &
      memory%slave_status, points%area(:points%n))
  end subroutine points_nts_ar

  !> Type 3: type 2, and again with the roles of slave and master exchanged; nothing is halved.
  pure subroutine points_two_pass_ar(contact, memory, points)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(inout) :: points
    integer :: first

    call points_nts_ar(contact, memory, points)
    first = points%n + 1
    call append_active(memory%master_status, contact%slave, [memory%n_slave, 0], 0.0_wp, &
      memory%master_penalty, points)
    call put_lengths(contact%master, memory%positions(:, memory%n_slave + 1:), contact%is_round, &
      memory%master_status, points%area(first:points%n))
  end subroutine points_two_pass_ar

end module points_nts_m
