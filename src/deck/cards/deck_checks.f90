! SPDX-License-Identifier: MIT
!> Checks that many cards have, by the names of their fields.
module deck_checks_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use deck_lines_m, only : deck_t
  use deck_card_specs_m, only : field_number
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, report_field
  use deck_values_m, only : integer_of, real_of
  implicit none
  private
  public :: refuse_negative, refuse_large, refuse_outside, require_id, take_life

contains

  !> A number that user ids are: 1 or more.
  subroutine require_id(deck, cursor, card, name)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name

    if (integer_of(card, name) < 1) call report_field(deck, cursor, card, name, &
      'is not a number of 1 or more')
  end subroutine require_id

  !> Times from which and until when something acts; the default of the end, also that of 0, is
  !> never.
  subroutine take_life(deck, cursor, card, names, birth, death)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: names(2)     !! of the two fields
    real(wp), intent(out) :: birth, death

    birth = real_of(card, names(1))
    death = real_of(card, names(2))
    if (death <= birth) then
      call report_field(deck, cursor, card, names(2), 'is not after '//trim(names(1))//' "' &
        //to_text(birth)//'"')
    else if (death <= 0.0_wp) then
      call report_field(deck, cursor, card, names(2), 'is before the run begins (0 means never)')
    end if
  end subroutine take_life

  !> A number below 0 where there may be none.
  subroutine refuse_negative(deck, cursor, card, name)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    integer :: k

    k = field_number(card%names, name)
    if (card%r(k) < 0.0_wp .or. card%i(k) < 0) call report_field(deck, cursor, card, k, &
      'is negative')
  end subroutine refuse_negative

  !> A number whose size is beyond what its place can mean.
  subroutine refuse_large(deck, cursor, card, name, most)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    real(wp), intent(in) :: most

    if (abs(real_of(card, name)) > most) call report_field(deck, cursor, card, name, &
      'is out of reach (at most '//to_text(most)//' by size)')
  end subroutine refuse_large

  !> A whole number that is below the least or above the most.
  subroutine refuse_outside(deck, cursor, card, name, least, most, message)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    integer, intent(in) :: least, most
    character(*), intent(in) :: message
    integer :: k

    k = field_number(card%names, name)
    if (card%i(k) < least .or. card%i(k) > most) call report_field(deck, cursor, card, k, message)
  end subroutine refuse_outside

end module deck_checks_m
