! SPDX-License-Identifier: MIT
!> *TERMINATION_: nodes, rigid bodies and interfaces that end a run.
module deck_ends_m
  use kinds_m, only : wp
  use contacts_m, only : n_told
  use controls_m, only : end_condition_t, end_node_place, end_node_touch, end_body_place, &
    end_body_way, end_contact
  use model_m, only : model_t
  use deck_cards_m, only : cursor_t, next_of, report_field
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_node
  use deck_lines_m, only : deck_t, count_rows
  use deck_supports_m, only : find_body
  use deck_values_m, only : integer_of, real_of, is_blank, has_field, find_id
  implicit none
  private
  public :: read_ends

contains

  !> All of them. Rigid bodies and interfaces of the model are known.
  subroutine read_ends(deck, model, sound)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    logical, intent(in) :: sound !! the interfaces have their surfaces
    type(end_condition_t), allocatable :: ends(:)
    type(end_condition_t) :: ending
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: n

    allocate (ends(count_rows(deck, 'TERMINATION_')))
    if (size(ends) == 0) return
    n = 0
    do while (next_of(deck, 'TERMINATION_', cursor, card))
      ending = end_condition_t()
      if (has_field(card, 'CID')) then
        call take_contact(deck, card, model, ending)
      else if (has_field(card, 'NID')) then
        call take_bounds(deck, card, end_node_place, end_node_touch, ending)
        ending%id = integer_of(card, 'NID')
        call find_id(deck, a_node, card, 'NID', ending%where)
        if (ending%kind == end_node_touch .and. ending%where > 0 .and. sound) then
          if (.not. is_in_contact(model, ending%where)) call report_field(deck, card, 'NID', &
            'is no node of an interface')
        end if
      else
        call take_bounds(deck, card, end_body_place, end_body_way, ending)
        ending%id = integer_of(card, 'PID')
        call find_body(deck, card, model, '', ending%where)
      end if
      n = n + 1
      ends(n) = ending
    end do
    model%controls%ends = ends(:n)
  end subroutine read_ends

  !> *TERMINATION_CONTACT.
  subroutine take_contact(deck, card, model, ending)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    type(end_condition_t), intent(out) :: ending

    ending = end_condition_t(kind=end_contact, id=integer_of(card, 'CID'), &
      direction=integer_of(card, 'DOF'), start=real_of(card, 'ACTIM'), &
      duration=real_of(card, 'DUR'), threshold=real_of(card, 'THRES'))
    if (any(card%bad)) return
    ending%where = findloc(model%contacts(:n_told(model%contacts))%id, ending%id, 1)
    if (ending%where == 0) then
      if (.not. deck%incomplete) call report_field(deck, card, 'CID', &
        'is no interface of this deck')
    else if (model%contacts(ending%where)%is_self) then
      call report_field(deck, card, 'CID', 'is an interface of a surface with itself, whose ' &
        //'forces cancel')
    end if
  end subroutine take_contact

  !> Bounds of a node or a rigid body. A bound that is blank, of bodies also 0, does not count.
  subroutine take_bounds(deck, card, along, other, ending)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(in) :: along, other      !! kind of STOP 1 and 2, of STOP 4
    type(end_condition_t), intent(inout) :: ending
    logical :: is_open(2)

    ending%kind = merge(other, along, integer_of(card, 'STOP') == 4)
    if (ending%kind == along) ending%direction = integer_of(card, 'STOP')
    if (ending%kind == end_node_touch .or. any(card%bad)) return
    is_open = [is_blank(card, 'MAXC'), is_blank(card, 'MINC')]
    if (along == end_body_place) is_open = is_open .or. [abs(real_of(card, 'MAXC')), &
      abs(real_of(card, 'MINC'))] <= 0.0_wp
    if (ending%kind == end_body_way) is_open(2) = .true.
    if (all(is_open)) call report_field(deck, card, 'MAXC', 'is no bound, nor is MINC: ' &
      //'nothing would end the run')
    if (.not. is_open(1)) ending%most = real_of(card, 'MAXC')
    if (.not. is_open(2)) ending%least = real_of(card, 'MINC')
    if (ending%least >= ending%most) call report_field(deck, card, 'MINC', 'is not below MAXC')
  end subroutine take_bounds

  !> Whether some interface has the node.
  pure function is_in_contact(model, node) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: node
    logical :: yes
    integer :: i

    yes = .false.
    do i = 1, size(model%contacts)
      yes = yes .or. any(model%contacts(i)%slave%nodes == node) &
        .or. any(model%contacts(i)%master%nodes == node)
    end do
  end function is_in_contact

end module deck_ends_m
