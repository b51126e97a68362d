! SPDX-License-Identifier: MIT
!> What implicit penalties (PUNIT 4) do not have: refused by name.
module deck_implicit_penalty_m
  use contacts_m, only : is_tied, penalty_implicit
  use deck_cards_m, only : reject_field
  use deck_lines_m, only : deck_t
  use deck_raw_m, only : raw_t, raw_contact_t
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  implicit none
  private
  public :: check_implicit_penalties

contains

  !> All interfaces with such penalties.
  subroutine check_implicit_penalties(deck, raw, model, sound)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(in) :: model
    logical, intent(in) :: sound !! the interfaces have their surfaces
    integer :: i

    do i = 1, size(raw%contacts)
      if (raw%contacts(i)%contact%penalty_unit /= penalty_implicit) cycle
      call check_kind(deck, raw%contacts(i), model)
      if (sound) call check_nodes(deck, raw, i, model)
    end do
  end subroutine check_implicit_penalties

  !> What the interface itself asks for.
  subroutine check_kind(deck, entry, model)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(model_t), intent(in) :: model

    associate (contact => entry%contact)
      if (contact%is_self) call refuse(deck, entry, 'do not act between a surface and itself')
      if (is_tied(contact)) call refuse(deck, entry, 'only push: a tie (TIE) has other springs')
      if (contact%damping > 0.0_wp) call refuse(deck, entry, 'have no damping of their own (VDC)')
      if (entry%interference > 0) call refuse(deck, entry, &
        'have no initial overlap that grows (LCINT)')
      if (model%erodes) call refuse(deck, entry, 'do not act where elements may leave the mesh')
    end associate
  end subroutine check_kind

  !> What else acts on its nodes.
  subroutine check_nodes(deck, raw, i_contact, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    integer, intent(in) :: i_contact
    type(model_t), intent(in) :: model
    logical :: is_own(model%mesh%n_node)
    integer :: i

    associate (entry => raw%contacts(i_contact), own => model%contacts(i_contact))
      is_own = .false.
      is_own(own%slave%nodes) = .true.
      is_own(own%master%nodes) = .true.
      do i = 1, size(raw%contacts)
        if (i == i_contact) cycle
        associate (other => model%contacts(i))
          call refuse_shared(deck, entry, is_own, [other%slave%nodes, other%master%nodes], &
            'interface '//to_text(other%id), model)
        end associate
      end do
      call refuse_shared_bodies(deck, raw, i_contact, is_own, model)
      if (allocated(model%walls)) then
        do i = 1, size(model%walls)
          call refuse_shared(deck, entry, is_own, model%walls(i)%nodes, 'rigid wall ' &
            //to_text(model%walls(i)%id), model)
        end do
      end if
      if (allocated(model%conditions%common_motions)) then
        do i = 1, size(model%conditions%common_motions)
          call refuse_shared(deck, entry, is_own, model%conditions%common_motions(i)%nodes, &
            'a set of nodes that move alike', model)
        end do
      end if
      if (allocated(model%conditions%skew_supports)) call refuse_shared(deck, entry, is_own, &
        [model%conditions%skew_supports%node], 'a support along neither x nor y', model)
    end associate
  end subroutine check_nodes

  !> One error for each rigid body, free to move, that another such interface presses too: the
  !> pressures of both would depend on each other.
  subroutine refuse_shared_bodies(deck, raw, i_contact, is_own, model)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    integer, intent(in) :: i_contact
    logical, intent(in) :: is_own(:)   !! (n_node)
    type(model_t), intent(in) :: model
    logical :: is_others(size(is_own))
    integer :: i

    is_others = .false.
    do i = 1, size(raw%contacts)
      if (i == i_contact) cycle
      if (raw%contacts(i)%contact%penalty_unit /= penalty_implicit) cycle
      is_others(model%contacts(i)%slave%nodes) = .true.
      is_others(model%contacts(i)%master%nodes) = .true.
    end do
    do i = 1, size(model%rigids)
      associate (body => model%rigids(i))
        if (all(body%is_fixed)) cycle
        if (any(is_own(body%nodes)) .and. any(is_others(body%nodes))) call refuse(deck, &
          raw%contacts(i_contact), 'share no rigid body that may move: part ' &
          //to_text(model%parts(body%part)%id)//' is pressed by another interface of PUNIT 4 too')
      end associate
    end do
  end subroutine refuse_shared_bodies

  !> One error where nodes are among those of the interface.
  subroutine refuse_shared(deck, entry, is_own, nodes, whose, model)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    logical, intent(in) :: is_own(:)   !! (n_node)
    integer, intent(in) :: nodes(:)
    character(*), intent(in) :: whose
    type(model_t), intent(in) :: model
    integer :: i

    do i = 1, size(nodes)
      if (.not. is_own(nodes(i))) cycle
      call refuse(deck, entry, 'share no nodes with others: node ' &
        //to_text(model%mesh%node_id(nodes(i)))//' belongs to '//whose//' too')
      return
    end do
  end subroutine refuse_shared

  !> An error of such an interface.
  subroutine refuse(deck, entry, message)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    character(*), intent(in) :: message

    call reject_field(deck, entry%unit_place, 'asks for implicit springs, which in this version ' &
      //message)
  end subroutine refuse

end module deck_implicit_penalty_m
