! SPDX-License-Identifier: MIT
!> Cards: their specification from one line of the table in `deck_schema_tables_m`; fields by column
!> or between commas, numbers and defaults; messages about fields.
module deck_fields_m
  use kinds_m, only : wp
  use, intrinsic :: iso_fortran_env, only : error_unit
  use text_m, only : read_real, read_integer, number_good, number_range, number_fraction
  use log_m, only : to_text
  use deck_schema_m, only : expectations, text_of_field
  use deck_report_m, only : finding_t, add_error, count_only
  use deck_lines_m, only : deck_t, line_text, where_text, line_warning, line_finding, line_error, &
    given_by, words_of, order_line, block_of_line, written_text, shown_text, marked_line, &
    flag_comma, format_long, format_i10, max_field
  implicit none
  private
  public :: begin_card, card_spec_t, make_spec, field_number, range_text, card_t, cut_card, &
    cut_text, read_numbers, field_text, field_error, largest_value, smallest_value

  !> Specification of a card.
  type :: card_spec_t
    integer :: n = 0                            !! fields
    integer :: number = 1                       !! card number in messages
    integer :: row = 0                          !! of the table
    character(12) :: names(max_field) = ''
    character :: kinds(max_field) = 'x'         !! i integer, f real, a text, x not used
    character :: treatments(max_field) = 'h'    !! h honoured, s silently ignored, w ignored with a
                                                !! warning, r refused unless it is the default
    integer :: widths(max_field) = 10
    real(wp) :: defaults(max_field) = 0.0_wp
    character :: zeros(max_field) = ''          !! meaning of a 0 where blank is not 0: = the
                                                !! default, ~ 0
    character(32) :: ranges(max_field) = ''     !! as in the table; blank: any value
    real(wp) :: least(max_field) = -huge(1.0_wp), most(max_field) = huge(1.0_wp) !! bounds of the
                                                !! range; an empty range for lists
  end type card_spec_t

  !> Numbers above the largest are errors, numbers below the smallest are zero, so that products of
  !> deck values stay finite. Both are beyond the range of single precision.
  real(wp), parameter :: largest_value = 1.0e40_wp, smallest_value = 1.0e-40_wp

  !> One card as read, blank fields with their defaults. `deck_values_m` gets values by field name.
  type :: card_t
    integer :: line = 0                     !! line in the deck
    integer :: number = 1                   !! card number
    integer :: row = -1                     !! of the table of keywords
    logical :: present = .false.            !! the deck has this card
    integer :: first(max_field) = 1         !! characters of each field in the line, trimmed;
    integer :: last(max_field) = 0          !! last < first: blank
    logical :: blank(max_field) = .true.
    logical :: bad(max_field) = .false.     !! an error has been reported for the field
    character(12) :: names(max_field) = ''
    character :: kinds(max_field) = 'x'     !! as in `card_spec_t`
    integer :: i(max_field) = 0             !! values of integer fields
    real(wp) :: r(max_field) = 0.0_wp       !! values of integer and real fields
  end type card_t

contains

  !> Specification of a card from its line of the table, with words
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

  !> Set the range of the last field: `>0`, `>=0`, `<1`, `<=1`, two of them, or a list of integers
  !> as in `|1|2|4`.
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

  !> Whether a range is a list of integers that contains a value.
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

  !> Position of a field by its name. A name that the card does not have is a bug and stops the
  !> program.
  function field_number(names, name) result(k)
    character(*), intent(in) :: names(:)   !! of the card, in order
    character(*), intent(in) :: name
    integer :: k

    do k = 1, size(names)
      if (names(k) == name) return
    end do
    write (error_unit, '(*(a))') 'slideline: internal error: no field ', name, &
      ' on the card with ', (trim(names(k)), ' ', k=1, size(names))
    error stop 'internal error: unknown field name'
  end function field_number

  !> Split a line into the fields of a card, with a warning about text beyond the last field.
  subroutine cut_card(deck, spec, source, line, card)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    integer, intent(in) :: source
    integer, intent(in) :: line
    type(card_t), intent(inout) :: card
    character(:), allocatable :: where
    integer :: rest

    call begin_card(spec, line, card)
    card%present = .true.
    card%bad = .false.
    call cut_text(deck%sources(merge(0, source, deck%first(line) < 0))%text(abs(deck%first(line)): &
      deck%last(line)), spec, iand(deck%flags(line), flag_comma) /= 0, card, rest)
    if (rest == 0) return
    where = where_text(deck, line)
    call line_warning(deck, line, 'extra'//where(index(where, '*', back=.true.):), &
      'text after the last field (column '//to_text(rest)//') is ignored')
  end subroutine cut_card

  !> Set line, number and names of a card, the names only where it was a different card before.
  pure subroutine begin_card(spec, line, card)
    type(card_spec_t), intent(in) :: spec
    integer, intent(in) :: line
    type(card_t), intent(inout) :: card

    card%line = line
    if (card%row == spec%row) return
    card%row = spec%row
    card%number = spec%number
    card%names = spec%names
    card%kinds = spec%kinds
  end subroutine begin_card

  !> Split a text by columns, or at commas.
  pure subroutine cut_text(text, spec, comma, card, rest)
    character(*), intent(in) :: text
    type(card_spec_t), intent(in) :: spec
    logical, intent(in) :: comma
    type(card_t), intent(inout) :: card
    integer, intent(out) :: rest !! column of text beyond the last field, or 0
    integer :: k, start, finish, first, last, width

    start = 1
    rest = 0
    do k = 1, spec%n
      if (comma) then
        width = 0
        if (start <= len(text)) width = index(text(start:), ',')
        finish = merge(start + width - 2, len(text), width > 0)
      else
        finish = min(start + spec%widths(k) - 1, len(text))
      end if
      first = start
      last = start - 1 + len_trim(text(start:finish))
      do while (first < last)
        if (iachar(text(first:first)) /= iachar(' ')) exit ! as integers: no library call
        first = first + 1
      end do
      card%first(k) = first
      card%last(k) = last
      card%blank(k) = last < first
      if (comma) then
        start = finish + 2
      else
        start = start + spec%widths(k)
      end if
    end do
    if (start > len(text)) return
    first = verify(text(start:), ' ,')
    if (first > 0) rest = start + first - 1
  end subroutine cut_text

  !> Read the numbers of a card that has been split, with defaults for blank fields.
  subroutine read_numbers(deck, spec, source, card)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    integer, intent(in) :: source
    type(card_t), intent(inout) :: card
    integer :: k, status, before, from

    before = 0
    from = source
    if (card%present) before = abs(deck%first(card%line)) - 1
    if (card%present .and. deck%first(max(card%line, 1)) < 0) from = 0
    do k = 1, spec%n
      call set_default(spec, card, k)
      if (spec%kinds(k) == 'x' .or. spec%kinds(k) == 'a') cycle
      if (.not. card%blank(k)) then
        associate (text => deck%sources(from)%text(before + card%first(k):before + card%last(k)))
          if (spec%kinds(k) == 'i') then
            call read_integer(text, card%i(k), status)
            card%r(k) = real(card%i(k), wp)
          else
            call read_real(text, card%r(k), status)
            if (abs(card%r(k)) > largest_value) status = number_range
            if (abs(card%r(k)) < smallest_value) card%r(k) = 0.0_wp
          end if
        end associate
        if (status /= number_good) then
          call number_error(deck, spec, card, k, status)
          cycle
        end if
        if (.not. abs(card%r(k)) > 0.0_wp) call interpret_zero(deck, spec, card, k)
      end if
      if (card%r(k) < spec%least(k) .or. card%r(k) > spec%most(k)) &
        call check_range(deck, spec, card, k)
    end do
  end subroutine read_numbers

  !> Report a number outside the bounds of its field, unless it is in a list.
  subroutine check_range(deck, spec, card, k)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    character(:), allocatable :: words, range

    if (card%bad(k) .or. is_listed(spec%ranges(k), card%r(k))) return
    words = text_of_field(expectations, deck%blocks(block_of_line(deck, card%line))%given, &
      trim(spec%names(k)))
    range = range_text(spec%ranges(k))
    if (len(words) == 0 .and. spec%ranges(k)(:3) == '>=0' .and. card%r(k) < 0.0_wp) then
      call field_error(deck, card, k, 'is negative')
      return
    else if (len(words) == 0) then
      words = range
      if (spec%ranges(k)(1:1) /= '|') words = 'a number '//trim(merge('of', '  ', &
        range(1:1) <= '9'))//' '//range
    else if (index(words, '(') == 0) then
      words = words//' ('//range//')'
    end if
    call field_error(deck, card, k, 'is not '//words)
  end subroutine check_range

  !> Interpret a 0 in a field with another default, by `zeros`. The log lists the first such field
  !> of each name and keyword.
  subroutine interpret_zero(deck, spec, card, k)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    character(:), allocatable :: name, location

    if (spec%zeros(k) == ' ') return
    name = to_text(spec%defaults(k))
    if (abs(spec%defaults(k)) < 1.0e6_wp .and. .not. abs(spec%defaults(k) &
      - anint(spec%defaults(k))) > 0.0_wp) name = to_text(nint(spec%defaults(k)))
    name = trim(spec%names(k))//' = '//name//' of *' &
      //deck%blocks(block_of_line(deck, card%line))%given
    location = where_text(deck, card%line)
    location = ' ('//location(:index(location, ': *', back=.true.) - 1)//')'
    if (spec%zeros(k) == '~') then
      call append_zero(deck%kept_zeros)
      return
    end if
    call append_zero(deck%default_zeros)
    call set_default(spec, card, k)

  contains

    !> Append a field to a list, unless its name is listed.
    subroutine append_zero(list)
      character(:), allocatable, intent(inout) :: list

      if (.not. allocated(list)) list = ''
      if (index(', '//list, ', '//name//' (') > 0) return
      if (len(list) > 0) list = list//', '
      list = list//name//location
    end subroutine append_zero

  end subroutine interpret_zero

  !> Report a field that is not a valid number.
  subroutine number_error(deck, spec, card, k, status)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    integer, intent(in) :: status
    character(:), allocatable :: text, message

    text = field_text(deck, card, k)
    message = 'is not a '//trim(merge('whole number', 'number      ', status == number_fraction &
      .or. spec%kinds(k) == 'i'))
    if (status == number_range) message = 'is too large: '//trim(merge( &
      'whole numbers reach 2147483647', 'numbers reach 1e40            ', spec%kinds(k) == 'i'))
    if (text(1:1) == '<' .or. index(text, '&(') == 1 .or. index(text, '-&(') == 1) message = &
      'is an inline expression, which is not supported; define it by *PARAMETER_EXPRESSION'
    call field_error(deck, card, k, message)
    call set_default(spec, card, k)
  end subroutine number_error

  !> Set a field to its default.
  pure subroutine set_default(spec, card, k)
    type(card_spec_t), intent(in) :: spec
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k

    card%r(k) = spec%defaults(k)
    card%i(k) = 0
    if (spec%kinds(k) == 'i') card%i(k) = int(spec%defaults(k))
  end subroutine set_default

  !> Text of a field, trimmed.
  pure function field_text(deck, card, k) result(text)
    type(deck_t), intent(in) :: deck
    type(card_t), intent(in) :: card
    integer, intent(in) :: k
    character(:), allocatable :: text

    text = ''
    if (.not. card%present .or. card%blank(k)) return
    text = line_text(deck, card%line)
    text = text(card%first(k):card%last(k))
  end function field_text

  !> Report an error of a field: `file:line: *KEYWORD card c field k (NAME): "text" message`, the
  !> line, and a mark below the field.
  subroutine field_error(deck, card, k, message)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    character(*), intent(in) :: message
    character(:), allocatable :: text, written
    type(finding_t) :: finding
    logical :: is_done

    card%bad(k) = .true.
    if (len(given_by(deck, card%line, k)) > 0) then
      call line_error(deck, 0, given_by(deck, card%line, k)//' '//message)
      return
    end if
    call count_only(deck%report, deck%blocks(block_of_line(deck, card%line))%given, card%names(k), &
      message, is_done)
    if (is_done) return
    text = where_text(deck, card%line)//' card '//to_text(card%number)//' field '//to_text(k) &
      //' ('//trim(card%names(k))//'): '
    if (card%present .and. .not. card%blank(k)) then
      text = text//'"'//shown_text(field_text(deck, card, k))//'"'
    else
      text = text//'blank'
    end if
    if (message(1:1) /= ':') text = text//' '
    text = text//message
    if (card%present) text = text//new_line('a')//marked_line(line_text(deck, card%line), &
      card%first(k), max(card%last(k), card%first(k)))
    written = written_text(deck, card%line)
    if (len(written) > 0) text = text//new_line('a')//'  | written: '//trim(shown_text(written))
    finding = line_finding(deck, card%line, message)
    finding%card = card%number
    finding%field = k
    finding%name = card%names(k)
    finding%found = shown_text(field_text(deck, card, k))
    if (card%present .and. len(written) == 0) then
      finding%first = card%first(k)
      finding%last = max(card%last(k), card%first(k))
    end if
    call add_error(deck%report, order_line(deck, card%line), text//words_of(deck, card%line), &
      finding)
  end subroutine field_error

end module deck_fields_m
