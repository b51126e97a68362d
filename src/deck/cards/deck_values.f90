! SPDX-License-Identifier: MIT
!> Values of a card by field name, and indices of the entities that they refer to. A wrong name or
!> kind is a bug and stops the program.
module deck_values_m
  use kinds_m, only : wp
  use deck_ids_m, only : id_map_t, map_ids, index_of, kind_names, a_node, an_element, a_part
  use deck_lines_m, only : location_t, deck_t, line_error, where_text
  use deck_fields_m, only : field_number, card_t
  use log_m, only : to_text
  use deck_cards_m, only : reject_field, report_field
  implicit none
  private
  public :: integer_of, real_of, reals_of, has_field, is_blank, is_bad, location_of, &
    read_active_time, define, map_defined, find_id, resolve_id, refuse_duplicates, note_refused

  !> Directions x, y and z of the direction codes TC, DOF and CON (0 to 7).
  logical, parameter, public :: along_axes(3, 0:7) = reshape([.false., .false., .false., .true., &
    .false., .false., .false., .true., .false., .false., .false., .true., .true., .true., .false., &
    .false., .true., .true., .true., .false., .true., .true., .true., .true.], [3, 8])
  !> Index of the entity that a field refers to.
  interface find_id
    module procedure find_by_name, find_by_position
  end interface find_id

contains

  !> Value of an integer field.
  function integer_of(card, name) result(value)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    integer :: value
    integer :: k

    k = field_number(card%names, name)
    if (card%kinds(k) /= 'i') error stop 'internal error: the field is not an integer'
    value = card%i(k)
  end function integer_of

  !> Value of a real field.
  function real_of(card, name) result(value)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    real(wp) :: value
    integer :: k

    k = field_number(card%names, name)
    if (card%kinds(k) /= 'f') error stop 'internal error: the field is not a real'
    value = card%r(k)
  end function real_of

  !> Values of the real fields from one name to another.
  function reals_of(card, first, last) result(values)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: first, last
    real(wp), allocatable :: values(:)

    values = card%r(field_number(card%names, first):field_number(card%names, last))
  end function reals_of

  !> Whether a card has a field.
  pure function has_field(card, name) result(yes)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    logical :: yes

    yes = any(card%names == name)
  end function has_field

  !> Whether a field is blank.
  function is_blank(card, name) result(yes)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    logical :: yes

    yes = card%blank(field_number(card%names, name))
  end function is_blank

  !> Whether an error of a field has been reported.
  function is_bad(card, name) result(yes)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    logical :: yes

    yes = card%bad(field_number(card%names, name))
  end function is_bad

  !> Location of a field, for later messages.
  function location_of(card, name) result(location)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    type(location_t) :: location

    location = location_t(line=card%line, card=card%number, name=name, &
      field=field_number(card%names, name))
  end function location_of

  !> Birth and death time; the default death time, also of 0, is never.
  subroutine read_active_time(deck, card, names, birth, death)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: names(2)     !! of the two fields
    real(wp), intent(out) :: birth, death

    birth = real_of(card, names(1))
    death = real_of(card, names(2))
    if (death <= birth) then
      call report_field(deck, card, names(2), 'is not after '//trim(names(1))//' "' &
        //to_text(birth)//'"')
    else if (death <= 0.0_wp) then
      call report_field(deck, card, names(2), 'is before the run begins (0 means never)')
    end if
  end subroutine read_active_time

  !> Define an entity by the number in the first field of its card; index 0 where the number is
  !> refused.
  subroutine define(deck, kind, card, n)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind
    type(card_t), intent(in) :: card
    integer, intent(out) :: n

    n = 0
    if (card%bad(1)) then
      call note_refused(deck, [kind])
      return
    end if
    associate (map => deck%maps(kind))
      if (.not. allocated(map%ids)) allocate (map%ids(64), map%lines(64))
      if (map%n == size(map%ids)) then
        map%ids = [map%ids, map%ids]
        map%lines = [map%lines, map%lines]
      end if
      map%n = map%n + 1
      n = map%n
      map%ids(n) = card%i(1)
      map%lines(n) = card%line
    end associate
  end subroutine define

  !> Build the map of a kind after all definitions, and report repeated ids.
  subroutine map_defined(deck, kind, field, of_beams)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind
    character(*), intent(in) :: field            !! of the ids
    logical, intent(in), optional :: of_beams(:) !! sets with the number of a beam part
    integer, allocatable :: ids(:), lines(:), duplicates(:)
    type(id_map_t) :: map
    character(12) :: name
    integer :: i, n

    n = deck%maps(kind)%n
    allocate (ids(n), lines(n))
    if (n > 0) ids = deck%maps(kind)%ids(:n)
    if (n > 0) lines = deck%maps(kind)%lines(:n)
    call map_ids(ids, map, duplicates)
    map%n = n
    map%has_refused = deck%maps(kind)%has_refused .or. deck%incomplete
    map%incomplete = map%has_refused .or. (any(kind == [a_node, an_element]) .and. n == 0)
    call move_alloc(ids, map%ids)
    call move_alloc(lines, map%lines)
    deck%maps(kind) = map
    do i = 1, size(duplicates)
      name = field
      if (present(of_beams)) name = merge('PID         ', name, of_beams(duplicates(i)))
      call reject_field(deck, location_t(map%lines(duplicates(i)), merge(2, 1, kind == a_part), &
        trim(name)), 'is the number of another '//trim(kind_names(kind))//' (' &
        //where_text(deck, map%lines(index_of(map, map%ids(duplicates(i)))))//')')
    end do
  end subroutine map_defined

  !> Note that definitions of these kinds have been refused, so that references are not errors.
  pure subroutine note_refused(deck, kinds)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kinds(:)

    deck%maps(kinds)%has_refused = .true.
    deck%maps(kinds)%incomplete = .true.
  end subroutine note_refused

  !> Index of the entity that a field refers to, by field name; 0 with an error where there is none.
  subroutine find_by_name(deck, kind, card, name, found)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    integer, intent(out) :: found

    call find_by_position(deck, kind, card, field_number(card%names, name), found)
  end subroutine find_by_name

  !> Index of the entity that a field refers to, by field position; 0 with an error where there is
  !> none.
  subroutine find_by_position(deck, kind, card, k, found)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    integer, intent(out) :: found

    found = index_of(deck%maps(kind), card%i(k))
    if (found == 0 .and. .not. deck%maps(kind)%incomplete) call report_field(deck, card, k, &
      'matches no '//trim(kind_names(kind))//' of this deck')
  end subroutine find_by_position

  !> Index of an entity, for a card that was read before (see `find_id`).
  subroutine resolve_id(deck, kind, id, location, found, suffix)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind, id
    type(location_t), intent(in) :: location
    integer, intent(out) :: found
    character(*), intent(in), optional :: suffix !! end of the message
    character(:), allocatable :: message

    found = index_of(deck%maps(kind), id)
    if (found > 0 .or. deck%maps(kind)%incomplete) return
    message = 'matches no '//trim(kind_names(kind))//' of this deck'
    if (present(suffix)) message = message//suffix
    call reject_field(deck, location, message)
  end subroutine resolve_id

  !> Report the lines of repeated numbers.
  subroutine refuse_duplicates(deck, ids, lines, what, owner)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: ids(:), lines(:)   !! in the order of the deck
    character(*), intent(in) :: what, owner   !! kind of number, kind of its owner
    type(id_map_t) :: map
    integer, allocatable :: duplicates(:)
    integer :: i

    call map_ids(ids, map, duplicates)
    do i = 1, size(duplicates)
      call line_error(deck, lines(duplicates(i)), 'the '//what//to_text(ids(duplicates(i))) &
        //' belongs to an earlier '//owner)
    end do
  end subroutine refuse_duplicates

end module deck_values_m
