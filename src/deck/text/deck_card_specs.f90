! SPDX-License-Identifier: MIT
!> What a card may hold, from one line of the table in `deck_schema_tables_m`. The same lines drive
!> every message.
module deck_card_specs_m
  use kinds_m, only : wp
  use, intrinsic :: iso_fortran_env, only : error_unit
  use text_m, only : read_real, read_integer
  use deck_lines_m, only : format_long, format_i10
  implicit none
  private
  public :: card_spec_t, make_spec, field_number, max_field

  !> Fields of one card at most.
  integer, parameter :: max_field = 16

  !> What a card may hold.
  type :: card_spec_t
    integer :: n = 0                            !! fields
    integer :: number = 1                       !! card number in messages
    character(12) :: names(max_field) = ''
    character :: kinds(max_field) = 'x'         !! i integer, f real, a text, x not used
    character :: treatments(max_field) = 'h'    !! h honoured, s silently ignored, w ignored with a
                                                !! warning, r refused unless it is the default
    integer :: widths(max_field) = 10
    real(wp) :: defaults(max_field) = 0.0_wp
    character :: zeros(max_field) = ''          !! what a 0 means where blank is another value: =
                                                !! the default, ~ 0
  end type card_spec_t

contains

  !> A card from its line of the table: words
  !> `NAME:kind[treatment][width][=default]`, or ~default.
  subroutine make_spec(text, number, layout, spec)
    character(*), intent(in) :: text
    integer, intent(in) :: number
    integer, intent(in) :: layout   !! one of the `format_` constants
    type(card_spec_t), intent(out) :: spec
    integer :: start, finish, colon, at, status, last

    spec%number = number
    start = 1
    last = len_trim(text)
    do
      do while (start <= last)
        if (text(start:start) /= ' ') exit
        start = start + 1
      end do
      if (start > last .or. spec%n == max_field) exit
      finish = index(text(start:)//' ', ' ') + start - 2
      colon = index(text(start:finish), ':') + start - 1
      spec%n = spec%n + 1
      spec%names(spec%n) = text(start:colon - 1)
      spec%kinds(spec%n) = text(colon + 1:colon + 1)
      at = colon + 2
      if (at <= finish) then
        if (scan(text(at:at), 'swr') == 1) then
          spec%treatments(spec%n) = text(at:at)
          at = at + 1
        end if
      end if
      colon = scan(text(start:finish), '=~') + start - 1
      if (colon >= start) then
        call read_real(text(colon + 1:finish), spec%defaults(spec%n), status)
        if (spec%treatments(spec%n) == 'h') spec%zeros(spec%n) = text(colon:colon)
      else
        colon = finish + 1
      end if
      if (at < colon) call read_integer(text(at:colon - 1), spec%widths(spec%n), status)
      start = finish + 1
    end do
    if (layout == format_long) spec%widths = max(spec%widths, 20)
    if (layout == format_i10) spec%widths = max(spec%widths, 10)
  end subroutine make_spec

  !> Position of a field by its name. Names are written in this program, never in a deck: one that
  !> the card does not have is a fault of the program and ends it.
  function field_number(names, name) result(k)
    character(*), intent(in) :: names(:)   !! of the card, in order
    character(*), intent(in) :: name
    integer :: k

    do k = 1, size(names)
      if (names(k) == name) return
    end do
    write (error_unit, '(*(a))') 'slideline: fault of the program: no field ', name, &
      ' on the card with ', (trim(names(k)), ' ', k=1, size(names))
    error stop 'a field was asked for by a name that the table of keywords does not have'
  end function field_number

end module deck_card_specs_m
