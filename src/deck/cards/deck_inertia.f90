! SPDX-License-Identifier: MIT
!> *PART_INERTIA: mass, centre of mass, moment of inertia and velocity of a rigid part.
module deck_inertia_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use rigids_m, only : rigid_t
  use deck_cards_m, only : cursor_t, next_card, reject_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node
  use deck_lines_m, only : deck_t, line_warning, where_text
  use deck_values_m, only : integer_of, real_of, reals_of, location_of, resolve_id
  implicit none
  private
  public :: inertia_t, read_inertia, set_inertias

  !> Cards of one part.
  type :: inertia_t
    integer :: part = 0    !! index
    type(card_t) :: cards(3:5)
  end type inertia_t

contains

  !> Read the cards of a part after its first one.
  subroutine read_inertia(deck, cursor, part, inertias)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    integer, intent(in) :: part            !! 0: refused
    type(inertia_t), allocatable, intent(inout) :: inertias(:)
    type(inertia_t) :: inertia
    type(card_t) :: axes
    integer :: k

    inertia%part = part
    do k = 3, 5
      call next_card(deck, cursor, k, inertia%cards(k))
    end do
    if (integer_of(inertia%cards(3), 'IRCS') == 1) call next_card(deck, cursor, 6, axes)
    if (part > 0) inertias = [inertias, inertia]
  end subroutine read_inertia

  !> Give the rigid bodies their inertia. Mesh, bodies and nodal masses have been made.
  subroutine set_inertias(deck, inertias, model)
    type(deck_t), intent(inout) :: deck
    type(inertia_t), intent(in) :: inertias(:)
    type(model_t), intent(inout) :: model
    integer :: i, k, node

    do i = 1, size(inertias)
      associate (cards => inertias(i)%cards)
        k = findloc(model%rigids%part, inertias(i)%part, dim=1)
        if (k == 0) then
          if (model%parts(inertias(i)%part)%material > 0) call reject_field(deck, &
            location_of(cards(3), 'TM'), 'is the mass of a part that is not rigid (*MAT_RIGID)')
          cycle
        end if
        if (model%is_axisymmetric) call reject_field(deck, location_of(cards(3), 'TM'), &
          'is the mass of an axisymmetric part, which has that of its elements')
        associate (body => model%rigids(k))
          body%has_inertia = .true.
          body%source = where_text(deck, cards(3)%line)
          call warn_of_shared(deck, cards(3)%line, model, body)
          body%given_mass = real_of(cards(3), 'TM')
          body%given_centre = reals_of(cards(3), 'XC', 'YC')
          body%given_moment = real_of(cards(4), 'IZZ')
          body%velocity = [reals_of(cards(5), 'VTX', 'VTY'), real_of(cards(5), 'VRZ')]
          if (integer_of(cards(3), 'NODEID') == 0) cycle
          call resolve_id(deck, a_node, integer_of(cards(3), 'NODEID'), location_of(cards(3), &
            'NODEID'), node)
          if (node > 0) body%given_centre = model%mesh%coordinates(:, node)
        end associate
      end associate
    end do
  end subroutine set_inertias

  !> Warn of nodes with other masses, of elements of other parts or *ELEMENT_MASS: they are part
  !> of TM.
  subroutine warn_of_shared(deck, line, model, body)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    type(model_t), intent(in) :: model
    type(rigid_t), intent(in) :: body
    logical :: is_own(0:model%mesh%n_node), is_shared(0:model%mesh%n_node)
    integer :: i

    is_own = .false.
    is_own(body%nodes) = .true.
    is_shared = .false.
    do i = 1, model%mesh%n_element
      if (model%mesh%element_part(i) == body%part) cycle
      is_shared(model%mesh%element_nodes(:, i)) = .true.
    end do
    if (allocated(model%conditions%lumped_masses)) &
      is_shared(model%conditions%lumped_masses%node) = .true.
    i = count(is_own .and. is_shared)
    if (i > 0) call line_warning(deck, line, 'shared inertia'//to_text(line), to_text(i) &
      //' nodes of this part have an *ELEMENT_MASS or belong to elements of other parts too: ' &
      //'that mass counts as part of TM')
  end subroutine warn_of_shared

end module deck_inertia_m
