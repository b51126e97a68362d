! SPDX-License-Identifier: MIT
!> Maps from user ids to indices, and what fields refer to; ids given twice are errors.
module deck_maps_m
  use log_m, only : to_text
  use deck_cards_m, only : reject_field, report_field
  use deck_card_specs_m, only : field_number
  use deck_fields_m, only : card_t
  use deck_ids_m, only : id_map_t, map_ids, index_of, kind_names, a_node, an_element, a_part
  use deck_lines_m, only : deck_t, place_t, line_error, where_text
  implicit none
  private
  public :: map_kind, find_id, resolve_id, refuse_again, lose

  !> Index of what a field refers to.
  interface find_id
    module procedure find_by_name, find_by_position
  end interface find_id

contains

  !> The map of one kind, with an error for each id that comes again.
  subroutine map_kind(deck, kind, ids, lines, field, of_beams)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind
    integer, intent(in) :: ids(:), lines(:)      !! of all, and where each stands
    character(*), intent(in) :: field            !! of the ids
    logical, intent(in), optional :: of_beams(:) !! the number of a set is that of a part
    integer, allocatable :: twice(:)
    type(id_map_t) :: map
    character(5) :: name
    integer :: i

    call map_ids(ids, map, twice)
    map%lines = lines
    map%lost = deck%maps(kind)%lost .or. deck%incomplete
    map%incomplete = map%lost .or. (any(kind == [a_node, an_element]) .and. size(ids) == 0)
    deck%maps(kind) = map
    do i = 1, size(twice)
      name = field
      if (present(of_beams)) name = merge('PID  ', name, of_beams(twice(i)))
      call reject_field(deck, place_t(lines(twice(i)), merge(2, 1, kind == a_part), trim(name)), &
        'is the number of another '//trim(kind_names(kind))//' (' &
        //where_text(deck, lines(index_of(map, ids(twice(i)))))//')')
    end do
  end subroutine map_kind

  !> Definitions of a kind that were refused: a reference to them is no further mistake.
  pure subroutine lose(deck, kinds)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kinds(:)

    deck%maps(kinds)%lost = .true.
    deck%maps(kinds)%incomplete = .true.
  end subroutine lose

  !> Index of what a field of a card just read refers to, by the field's name; 0 with an error of
  !> the field where there is none.
  subroutine find_by_name(deck, kind, card, name, found)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    integer, intent(out) :: found

    call find_by_position(deck, kind, card, field_number(card%names, name), found)
  end subroutine find_by_name

  !> The same by the position of the field.
  subroutine find_by_position(deck, kind, card, k, found)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    integer, intent(out) :: found

    found = index_of(deck%maps(kind), card%i(k))
    if (found == 0 .and. .not. deck%maps(kind)%incomplete) call report_field(deck, card, k, &
      'is no '//trim(kind_names(kind))//' of this deck')
  end subroutine find_by_position

  !> As `find_id`, of a card that was read some time ago.
  subroutine resolve_id(deck, kind, id, place, found, hint)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind, id
    type(place_t), intent(in) :: place
    integer, intent(out) :: found
    character(*), intent(in), optional :: hint !! how the message goes on
    character(:), allocatable :: message

    found = index_of(deck%maps(kind), id)
    if (found > 0 .or. deck%maps(kind)%incomplete) return
    message = 'is no '//trim(kind_names(kind))//' of this deck'
    if (present(hint)) message = message//hint
    call reject_field(deck, place, message)
  end subroutine resolve_id

  !> An error of the line of each number that has come before.
  subroutine refuse_again(deck, ids, lines, what, owner)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: ids(:), lines(:)   !! in the order of the deck
    character(*), intent(in) :: what, owner   !! kind of number, what it is the number of
    type(id_map_t) :: map
    integer, allocatable :: twice(:)
    integer :: i

    call map_ids(ids, map, twice)
    do i = 1, size(twice)
      call line_error(deck, lines(twice(i)), 'the '//what//to_text(ids(twice(i))) &
        //' belongs to an earlier '//owner)
    end do
  end subroutine refuse_again

end module deck_maps_m
