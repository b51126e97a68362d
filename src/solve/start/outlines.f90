! SPDX-License-Identifier: MIT
!> Surfaces of interfaces follow the elements that leave the mesh.
module outlines_m
  use rigid_start_m, only : weigh_contacts
  use contacts_m, only : contact_t
  use block_state_m, only : stays
  use exposed_quads_m, only : find_exposed
  use kinds_m, only : wp
  use model_m, only : model_t
  use renewal_m, only : renew_contact, close_contact, reshape_contact
  use state_m, only : state_t
  use surface_building_m, only : surface_left
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: follow_outlines, resume_outlines

contains

  !> After elements have left: interfaces whose surfaces have lost some, or came to light, go on
  !> with what is left, in the order of the deck. Their springs that are not there any more are
  !> booked as eroded.
  subroutine follow_outlines(model, has_lost, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: has_lost(:) !! (n_part) elements in this cycle
    type(state_t), intent(inout) :: state
    type(contact_t), allocatable :: former
    logical, allocatable :: is_left(:)
    real(wp) :: lost
    integer :: i

    is_left = state%elements%erosion%status(model%layout%element_slot) == stays
    call expose_elements(model, is_left, state)
    do i = 1, size(state%outlines)
      if (.not. (loses(state%outlines(i)%slave) .or. loses(state%outlines(i)%master))) cycle
      former = state%outlines(i)
      ! What is no node of the interface any more feels no force of it.
      state%force_special(:, state%contacts(i)%nodes) = 0.0_wp
      call take_left(model, i, is_left, state%outlines(i))
      if (state%outlines(i)%birth >= huge(1.0_wp)) then
        call close_contact(state%outlines(i), model, state%motion, state%dt, state%contacts(i), &
          lost)
      else
        call renew_contact(former, state%outlines(i), model, state%motion, state%contacts(i), lost)
      end if
      state%elements%erosion%took(4) = state%elements%erosion%took(4) + lost
    end do
    call weigh_contacts(model, state)

  contains

    !> Whether a surface is another one now.
    function loses(surface)
      type(surface_t), intent(in) :: surface
      logical :: loses

      if (allocated(surface%parts)) then
        loses = any(has_lost(surface%parts))
      else
        loses = .not. all(is_left(surface%segment_element))
      end if
    end function loses

  end subroutine follow_outlines

  !> Quads whose neighbours have left.
  subroutine expose_elements(model, is_left, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_left(:)  !! (n_element)
    type(state_t), intent(inout) :: state
    real(wp), allocatable :: shares(:, :)

    shares = find_exposed(model, is_left)
    if (.not. allocated(state%elements%mass_shares)) then
      if (.not. any(shares > 0.0_wp)) return
      allocate (state%elements%mass_shares(4, model%layout%n_slot))
    end if
    state%elements%mass_shares = 0.0_wp
    state%elements%mass_shares(:, model%layout%element_slot) = shares
  end subroutine expose_elements

  !> The interface that is left of one of the deck; that of the deck, never born, where a side has
  !> nothing left.
  subroutine take_left(model, i, is_left, contact)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    logical, intent(in) :: is_left(:)
    type(contact_t), intent(inout) :: contact
    type(surface_t) :: slave, master

    call surface_left(model%mesh, is_left, model%contacts(i)%slave, slave)
    call surface_left(model%mesh, is_left, model%contacts(i)%master, master)
    if (min(slave%n_segment, master%n_segment) > 0) then
      contact%slave = slave
      contact%master = master
    else
      contact%slave = model%contacts(i)%slave
      contact%master = model%contacts(i)%master
      contact%birth = huge(1.0_wp)
    end if
  end subroutine take_left

  !> Before a state is read in which elements have left: interfaces get the shapes that they had.
  subroutine resume_outlines(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, allocatable :: is_left(:)
    integer :: i

    is_left = state%elements%erosion%status(model%layout%element_slot) == stays
    if (all(is_left)) return
    call expose_elements(model, is_left, state)
    do i = 1, size(state%outlines)
      call take_left(model, i, is_left, state%outlines(i))
      call reshape_contact(state%outlines(i), model, state%contacts(i))
    end do
  end subroutine resume_outlines

end module outlines_m
