! SPDX-License-Identifier: MIT
!> Values of a card by the names that the table of keywords gives its fields, and what they refer
!> to. A name that is not there, or a kind that is another, is a fault of the program and ends it.
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

  !> Directions x, y and z of the codes TC, DOF and CON: 0 none, 1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7
  !> xyz.
  logical, parameter, public :: along_axes(3, 0:7) = reshape([.false., .false., .false., .true., &
    .false., .false., .false., .true., .false., .false., .false., .true., .true., .true., .false., &
    .false., .true., .true., .true., .false., .true., .true., .true., .true.], [3, 8])
  !> Index of what a field refers to.
  interface find_id
    module procedure find_by_name, find_by_position
  end interface find_id

contains

  !> A whole number.
  function integer_of(card, name) result(value)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    integer :: value
    integer :: k

    k = field_number(card%names, name)
    if (card%kinds(k) /= 'i') error stop 'a field that is no whole number was asked for one'
    value = card%i(k)
  end function integer_of

  !> A real number.
  function real_of(card, name) result(value)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    real(wp) :: value
    integer :: k

    k = field_number(card%names, name)
    if (card%kinds(k) /= 'f') error stop 'a field that is no real number was asked for one'
    value = card%r(k)
  end function real_of

  !> Real numbers of the fields from one name to another.
  function reals_of(card, first, last) result(values)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: first, last
    real(wp), allocatable :: values(:)

    values = card%r(field_number(card%names, first):field_number(card%names, last))
  end function reals_of

  !> Whether a card has a field of a name.
  pure function has_field(card, name) result(yes)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    logical :: yes

    yes = any(card%names == name)
  end function has_field

  !> Whether a field was left blank.
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

  !> Where a field stands, for what is found later.
  function location_of(card, name) result(location)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    type(location_t) :: location

    location = location_t(line=card%line, card=card%number, name=name, &
      field=field_number(card%names, name))
  end function location_of

  !> Times from which and until when something acts; the default of the end, also that of 0, is
  !> never.
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

  !> One more thing of a kind, which has its number in the first field of a card: its index, 0 where
  !> the number was refused.
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

  !> The map of a kind of which all are defined, with an error for each id that comes again.
  subroutine map_defined(deck, kind, field, of_beams)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind
    character(*), intent(in) :: field            !! of the ids
    logical, intent(in), optional :: of_beams(:) !! the number of a set is that of a part
    integer, allocatable :: ids(:), lines(:), duplicates(:)
    type(id_map_t) :: map
    character(5) :: name
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
      if (present(of_beams)) name = merge('PID  ', name, of_beams(duplicates(i)))
      call reject_field(deck, location_t(map%lines(duplicates(i)), merge(2, 1, kind == a_part), &
        trim(name)), 'is the number of another '//trim(kind_names(kind))//' (' &
        //where_text(deck, map%lines(index_of(map, map%ids(duplicates(i)))))//')')
    end do
  end subroutine map_defined

  !> Definitions of a kind that were refused: a reference to them is no further mistake.
  pure subroutine note_refused(deck, kinds)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kinds(:)

    deck%maps(kinds)%has_refused = .true.
    deck%maps(kinds)%incomplete = .true.
  end subroutine note_refused

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
  subroutine resolve_id(deck, kind, id, location, found, suffix)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: kind, id
    type(location_t), intent(in) :: location
    integer, intent(out) :: found
    character(*), intent(in), optional :: suffix !! how the message goes on
    character(:), allocatable :: message

    found = index_of(deck%maps(kind), id)
    if (found > 0 .or. deck%maps(kind)%incomplete) return
    message = 'is no '//trim(kind_names(kind))//' of this deck'
    if (present(suffix)) message = message//suffix
    call reject_field(deck, location, message)
  end subroutine resolve_id

  !> An error of the line of each number that has come before.
  subroutine refuse_duplicates(deck, ids, lines, what, owner)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: ids(:), lines(:)   !! in the order of the deck
    character(*), intent(in) :: what, owner   !! kind of number, what it is the number of
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
