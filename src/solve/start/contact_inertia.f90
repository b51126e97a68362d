! SPDX-License-Identifier: MIT
!> Inverse masses that the energy law of contact sees (doc/theory/contact.md, section 6.1).
module contact_inertia_m
  use kinds_m, only : wp
  use model_m, only : model_t
  use rigid_start_m, only : is_held
  use state_m, only : state_t
  implicit none
  private
  public :: weigh_contacts

contains

  !> 1/m of the nodes of all interfaces, 0 where the motion is held or prescribed. A node of a rigid
  !> body has the mass that contact feels there, with which no force does more to it than to the
  !> body; 0 where the body can not turn and does not move in that direction during the whole run.
  subroutine weigh_contacts(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), allocatable :: inverse(:, :)
    integer :: i

    if (size(state%contacts) == 0) return
    allocate (inverse(2, model%layout%n_special))
    inverse = state%inverse_mass(:, :model%layout%n_special)
    if (allocated(model%conditions%common_motions)) call weigh_common(model, state%mass, inverse)
    do i = 1, size(model%rigids)
      call weigh_rigid(model, i, state%contact_mass, inverse)
    end do
    do i = 1, size(state%contacts)
      if (.not. allocated(state%contacts(i)%limit%inverse_mass)) cycle
      associate (limit => state%contacts(i)%limit)
        ! The bound of the forces before was formed with the masses of before.
        if (any(abs(limit%inverse_mass - inverse(:, state%contacts(i)%nodes)) > 0.0_wp)) &
          limit%recoil = huge(1.0_wp)
        limit%inverse_mass = inverse(:, state%contacts(i)%nodes)
      end associate
    end do
  end subroutine weigh_contacts

  !> Nodes that move alike: their own mass, the least that a force on one of them moves. Nodes that
  !> have lost theirs with their last element have no contact any more.
  subroutine weigh_common(model, mass, inverse)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: mass(:)            !! (n_node)
    real(wp), intent(inout) :: inverse(:, :)   !! (2, n_special)
    integer :: i, k

    do i = 1, size(model%conditions%common_motions)
      associate (common => model%conditions%common_motions(i))
        do k = 1, size(common%nodes)
          if (mass(common%nodes(k)) > 0.0_wp) inverse(:, common%nodes(k)) = merge(1.0_wp &
            /mass(common%nodes(k)), inverse(:, common%nodes(k)), common%along)
        end do
      end associate
    end do
  end subroutine weigh_common

  !> The nodes of one rigid body.
  subroutine weigh_rigid(model, i_body, contact_mass, inverse)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_body
    real(wp), intent(in) :: contact_mass(:)    !! (n_special)
    real(wp), intent(inout) :: inverse(:, :)   !! (2, n_special)
    logical :: held(3)
    integer :: k

    held = is_held(model, i_body)
    do k = 1, size(model%rigids(i_body)%nodes)
      associate (node => model%rigids(i_body)%nodes(k))
        if (node > model%layout%n_special) exit
        inverse(:, node) = merge(0.0_wp, 1.0_wp/contact_mass(node), held(1:2) .and. held(3))
      end associate
    end do
  end subroutine weigh_rigid

end module contact_inertia_m
