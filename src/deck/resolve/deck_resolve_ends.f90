! SPDX-License-Identifier: MIT
!> Nodes, rigid bodies and interfaces that end a run.
module deck_resolve_ends_m
  use contacts_m, only : n_told
  use controls_m, only : end_node_place, end_node_touch, end_body_place, end_body_way
  use model_m, only : model_t
  use deck_cards_m, only : reject_field
  use deck_ids_m, only : a_node, a_part
  use deck_lines_m, only : deck_t
  use deck_maps_m, only : resolve_id
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: resolve_ends

contains

  !> All of them. Rigid bodies and interfaces of the model are known.
  subroutine resolve_ends(deck, raw, model, sound)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    type(model_t), intent(inout) :: model
    logical, intent(in) :: sound !! the interfaces have their surfaces
    integer :: i, part

    if (size(raw%ends) == 0) return
    allocate (model%controls%ends(size(raw%ends)))
    do i = 1, size(raw%ends)
      associate (entry => raw%ends(i), ending => model%controls%ends(i))
        ending = entry%condition
        select case (ending%kind)
        case (end_node_place, end_node_touch)
          call resolve_id(deck, a_node, ending%id, entry%id_place, ending%where)
          if (ending%kind == end_node_touch .and. ending%where > 0 .and. sound) then
            if (.not. is_in_contact(model, ending%where)) call reject_field(deck, &
              entry%id_place, 'is no node of an interface')
          end if
        case (end_body_place, end_body_way)
          call resolve_id(deck, a_part, ending%id, entry%id_place, part)
          if (part == 0) cycle
          ending%where = findloc(model%rigids%part, part, 1)
          if (ending%where == 0 .and. model%parts(part)%material > 0) call reject_field(deck, &
            entry%id_place, 'is no rigid part (*MAT_RIGID)')
        case default
          ending%where = findloc(model%contacts(:n_told(model%contacts))%id, ending%id, 1)
          if (ending%where == 0) then
            if (.not. deck%incomplete) call reject_field(deck, entry%id_place, &
              'is no interface of this deck')
          else if (model%contacts(ending%where)%is_self) then
            call reject_field(deck, entry%id_place, &
              'is an interface of a surface with itself, whose forces cancel')
          end if
        end select
      end associate
    end do
  end subroutine resolve_ends

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

end module deck_resolve_ends_m
