! SPDX-License-Identifier: MIT
!> *PARAMETER_: values of references `&name` and `-&name`. All definitions are read before other
!> keywords, so that a name may be used before its definition.
module deck_parameters_m
  use kinds_m, only : wp
  use text_m, only : upper_case, read_real, shortest, number_good
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, line_text, line_error, line_warning, block_of_line
  use deck_schema_m, only : distance_limit, update_nearest
  use deck_expression_m, only : evaluate
  use deck_parameter_table_m, only : parameter_t, parameters_t, add_parameter, find_given, look_up
  use deck_cards_m, only : cursor_t, open_cursor, next_card
  use deck_fields_m, only : card_t, cut_card, field_text, field_error
  implicit none
  private
  public :: read_parameters

  !> Treatment of a second definition with another value (*PARAMETER_DUPLICATION DFLAG); the default
  !> is an error.
  integer, parameter :: duplicate_error = 0, duplicate_warn_keep = 1, duplicate_warn_replace = 2, &
    duplicate_error_keep = 3, duplicate_replace = 4

contains

  !> Read all parameter keywords of the deck.
  subroutine read_parameters(deck)
    type(deck_t), intent(inout) :: deck
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: i_block, i

    do i_block = 1, deck%n_block
      if (deck%blocks(i_block)%name(:9) /= 'PARAMETER') cycle
      deck%blocks(i_block)%dropped = .true.
      call open_cursor(deck, i_block, cursor)
      select case (deck%blocks(i_block)%name)
      case ('PARAMETER', 'PARAMETER_LOCAL')
        call read_values(deck, cursor)
      case ('PARAMETER_EXPRESSION', 'PARAMETER_EXPRESSION_LOCAL')
        call read_expressions(deck, cursor)
      case ('PARAMETER_DUPLICATION')
        call next_card(deck, cursor, 1, card)
        if (card%present .and. .not. card%bad(1)) deck%parameters%duplicates = card%i(1)
      end select
    end do
    do i = 1, deck%parameters%n
      associate (item => deck%parameters%items(i))
        if (item%fixed .and. .not. (item%found .or. deck%incomplete)) call line_error(deck, 0, &
          'p:'//trim(item%name)//' on the command line: the deck has no such parameter' &
          //nearest_name(deck%parameters, trim(item%name)))
      end associate
    end do
  end subroutine read_parameters

  !> `; the nearest is NAME`, at most two letters different; empty where there is none.
  pure function nearest_name(parameters, given) result(text)
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: given
    character(:), allocatable :: text
    character(len(parameters%items%name)) :: nearest
    integer :: i, least

    text = ''
    nearest = ''
    least = distance_limit(given)
    do i = 1, parameters%n
      if (parameters%items(i)%found) &
        call update_nearest(trim(parameters%items(i)%name), given, least, nearest)
    end do
    if (len_trim(nearest) > 0) text = '; the nearest is '//trim(nearest)
  end function nearest_name

  !> Read pairs of name and value, four on a line.
  subroutine read_values(deck, cursor)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t) :: card
    integer :: line, k
    character(:), allocatable :: text

    do line = cursor%line, cursor%last
      call cut_card(deck, cursor%specs(1), cursor%source, line, card)
      do k = 1, 8, 2
        if (card%blank(k) .and. card%blank(k + 1)) cycle
        if (card%blank(k) .or. card%blank(k + 1)) then
          call field_error(deck, card, k, 'a parameter needs a name and a value (without a ' &
            //'comma a field ends at its column)')
          cycle
        end if
        text = field_text(deck, card, k + 1)
        if (index(text, '&') > 0) call look_up(deck%parameters, text, cursor%source, text)
        if (len(text) == 0) then
          call field_error(deck, card, k + 1, 'is not defined by *PARAMETER up to here')
        else
          call define(deck, card, k, k + 1, text)
        end if
      end do
    end do
  end subroutine read_values

  !> Read expressions, one on a line; a line with a blank name continues the previous one.
  subroutine read_expressions(deck, cursor)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t) :: card
    character(:), allocatable :: text, formula, message
    integer :: line, width
    real(wp) :: value

    do line = cursor%line, cursor%last
      text = line_text(deck, line)
      if (len_trim(text) == 0) cycle
      width = min(cursor%specs(1)%widths(1), len(text))
      if (index(text(:width), ',') > 0) width = index(text, ',')
      associate (name => text(:width - merge(1, 0, text(width:width) == ',')))
        if (len_trim(name) > 0) then
          card = card_t(line=line, present=.true., names=cursor%specs(1)%names)
          card%first(1) = verify(name, ' ')
          card%last(1) = len_trim(name)
          card%blank(1) = .false.
          formula = ''
        else if (.not. card%present) then
          call line_error(deck, line, 'a parameter needs a name')
          cycle
        end if
      end associate
      formula = formula//text(width + 1:)
      if (line < cursor%last) then
        text = line_text(deck, line + 1)
        if (len_trim(text) > 0 .and. len_trim(text(:min(cursor%specs(1)%widths(1), len(text)))) &
          == 0) cycle
      end if
      call evaluate(formula, deck%parameters, cursor%source, value, message)
      if (allocated(message)) then
        call field_error(deck, card, 1, 'cannot be computed: '//message)
      else
        call define(deck, card, 1, 2, shortest(value))
      end if
    end do
  end subroutine read_expressions

  !> Define the parameter in field `k` of a card (type letter first), local to its file with _LOCAL.
  subroutine define(deck, card, k, k_value, given)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k, k_value       !! fields of name and value
    character(*), intent(in) :: given       !! value
    type(parameter_t) :: item
    character(:), allocatable :: name, text
    character :: kind
    integer :: status
    real(wp) :: value

    name = upper_case(field_text(deck, card, k))
    kind = name(1:1)
    name = trim(adjustl(name(2:)))
    if (scan(kind, 'RIC') == 0 .or. len(name) == 0 .or. len(name) > 20) then
      call field_error(deck, card, k, 'is not a type letter (R, I or C) and a name')
      return
    end if
    text = given
    if (kind /= 'C') then
      call read_real(text, value, status)
      if (status /= number_good) then
        call field_error(deck, card, k_value, 'is not a number')
        return
      end if
    end if
    if (kind == 'I') then
      ! Round values within round-off of an integer; otherwise truncate.
      if (abs(value - anint(value)) <= 1.0e-9_wp*max(1.0_wp, abs(value))) value = anint(value)
      if (abs(value) > real(huge(k), wp)) then
        call field_error(deck, card, k, 'is too large for an integer parameter')
        return
      end if
      text = to_text(int(value))
    end if
    associate (block => deck%blocks(block_of_line(deck, card%line)))
      item = parameter_t(name=name, kind=kind, source=merge(block%source, 0, index(block%name, &
        '_LOCAL') > 0), found=.true.)
    end associate
    item%text = text
    call store_parameter(deck, card%line, item)
  end subroutine define

  !> Store a definition in the table, or treat it as a duplicate.
  subroutine store_parameter(deck, line, item)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    type(parameter_t), intent(in) :: item
    character(:), allocatable :: name
    real(wp) :: value
    integer :: i, status

    name = trim(item%name)
    i = find_given(deck%parameters, name, item%source)
    if (i == 0) then
      call add_parameter(deck%parameters, item)
      return
    end if
    associate (given => deck%parameters%items(i), duplicates => deck%parameters%duplicates)
      if (.not. given%found .and. item%kind /= 'C') then
        ! A value from the command line must be a number where the parameter is one.
        call read_real(given%text, value, status)
        if (status /= number_good) call line_error(deck, 0, 'p:'//name//' on the command line: "' &
          //given%text//'" is not a number')
      end if
      given%found = .true.
      if (given%fixed .or. given%text == item%text) return
      select case (duplicates)
      case (duplicate_error, duplicate_error_keep)
        call line_error(deck, line, 'parameter '//name//' is defined again with another value ("' &
          //item%text//'", before "'//given%text//'")')
      case (duplicate_warn_keep, duplicate_warn_replace)
        call line_warning(deck, line, 'parameter '//name//to_text(line), 'parameter '//name &
          //' is defined again; the '//merge('first ', 'second', &
          duplicates == duplicate_warn_keep)//' value counts')
      end select
      if (duplicates == duplicate_warn_replace .or. duplicates == duplicate_replace) given%text = &
        item%text
    end associate
  end subroutine store_parameter

end module deck_parameters_m
