! SPDX-License-Identifier: MIT
!> What a card may hold, from one line of the table in `deck_schema_tables_m`. The same lines drive
!> every message.
module deck_card_specs_m
  use kinds_m, only : wp
  use, intrinsic :: iso_fortran_env, only : error_unit
  use text_m, only : read_real, read_integer
  use log_m, only : to_text
  use deck_lines_m, only : format_long, format_i10, max_field
  implicit none
  private
  public :: card_spec_t, make_spec, field_number, is_listed, range_text

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
    character(32) :: ranges(max_field) = ''     !! as in the table; blank: any value
    real(wp) :: least(max_field) = -huge(1.0_wp), most(max_field) = huge(1.0_wp) !! of the range;
                                                !! between those of a list there is no number
  end type card_spec_t

contains

  !> A card from its line of the table: words
  !> `NAME:kind[treatment][width][=default][range]`, or ~default.
  subroutine make_spec(text, number, layout, spec)
    character(*), intent(in) :: text
    integer, intent(in) :: number
    integer, intent(in) :: layout   !! one of the `format_` constants
    type(card_spec_t), intent(out) :: spec
    integer :: start, next, finish, colon, at, status, last

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
      next = finish + 1
      spec%n = spec%n + 1
      at = scan(text(start:finish), '<>|')
      if (at > 0) then
        call set_range(text(start + at - 1:finish), spec)
        finish = start + at - 2
      end if
      colon = index(text(start:finish), ':') + start - 1
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
      start = next
    end do
    if (layout == format_long) spec%widths = max(spec%widths, 20)
    if (layout == format_i10) spec%widths = max(spec%widths, 10)
  end subroutine make_spec

  !> The range of the last field: `>0`, `>=0`, `<1`, `<=1`, two of them, or whole numbers, as in
  !> `|1|2|4`.
  subroutine set_range(text, spec)
    character(*), intent(in) :: text
    type(card_spec_t), intent(inout) :: spec
    real(wp) :: bound
    integer :: at, finish, status

    spec%ranges(spec%n) = text
    if (text(1:1) == '|') spec%most(spec%n) = -huge(1.0_wp)
    at = 1
    do while (at <= len(text) .and. text(1:1) /= '|')
      finish = scan(text(at + 1:)//' ', '<> ') + at - 1
      call read_real(text(at + verify(text(at:), '<>=') - 1:finish), bound, status)
      if (text(at + 1:at + 1) /= '=') bound = nearest(bound, merge(1.0_wp, -1.0_wp, &
        text(at:at) == '>'))
      if (text(at:at) == '>') spec%least(spec%n) = bound
      if (text(at:at) == '<') spec%most(spec%n) = bound
      at = finish + 1
    end do
  end subroutine set_range

  !> Whether a range is a list of whole numbers that has the number.
  pure function is_listed(range, value) result(yes)
    character(*), intent(in) :: range    !! as in the table
    real(wp), intent(in) :: value
    logical :: yes

    yes = .false.
    if (range(1:1) == '|' .and. abs(value) < 1.0e6_wp .and. .not. abs(value - anint(value)) &
      > 0.0_wp) yes = index(trim(range)//'|', '|'//to_text(nint(value))//'|') > 0
  end function is_listed

  !> The range of a field in words.
  pure function range_text(range) result(text)
    character(*), intent(in) :: range    !! as in the table
    character(:), allocatable :: text
    integer :: at, last

    text = trim(range(2:))
    if (range(1:1) == '|') then
      do
        at = index(text, '|')
        if (at == 0) return
        last = index(text, '|', back=.true.)
        text = text(:at - 1)//trim(merge(' or', ',  ', at == last))//' '//text(at + 1:)
      end do
    end if
    at = scan(text, '<>')
    if (at == 0) then
      text = bound_text(trim(range), ' or more', ' or less')
    else if (range(2:2) == '=' .and. text(at + 1:at + 1) == '=') then
      text = text(2:at - 1)//' to '//text(at + 2:)
    else
      text = bound_text(trim(range(:at)), '', '')//', '//bound_text(text(at:), '', '')
    end if
  end function range_text

  !> One bound in words.
  pure function bound_text(bound, or_more, or_less) result(text)
    character(*), intent(in) :: bound, or_more, or_less
    character(:), allocatable :: text

    if (bound(2:2) /= '=') then
      text = merge('above ', 'below ', bound(1:1) == '>')//bound(2:)
    else if (len(or_more) > 0) then
      text = bound(3:)//merge(or_more, or_less, bound(1:1) == '>')
    else
      text = merge('at least ', 'at most  ', bound(1:1) == '>')
      text = trim(text)//' '//bound(3:)
    end if
  end function bound_text

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
