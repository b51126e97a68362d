! SPDX-License-Identifier: MIT
!> Values of a card by the names that the table of keywords gives its fields. A name that is not
!> there, or a kind that is another, is a fault of the program and ends it.
module deck_values_m
  use kinds_m, only : wp
  use deck_lines_m, only : place_t
  use deck_card_specs_m, only : field_number
  use deck_fields_m, only : card_t
  implicit none
  private
  public :: integer_of, real_of, reals_of, has_field, is_blank, is_bad, place_of

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
  function place_of(card, name) result(place)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    type(place_t) :: place

    place = place_t(line=card%line, card=card%number, name=name, &
      field=field_number(card%names, name))
  end function place_of

end module deck_values_m
