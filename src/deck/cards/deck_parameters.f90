! SPDX-License-Identifier: MIT
!> *PARAMETER and its relatives: names with values, put in place of `&name` and `-&name`.
!> All definitions are read before any other keyword, so that a name may be used before the line
!> that defines it. Names compare without regard to case; some are private to a file, some come from
!> the command line.
module deck_parameters_m
  use kinds_m, only : wp
  use text_m, only : upper_case, read_real, shortest, number_good
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, parameters_t, again_error, line_text, line_error, parameter_t, &
    line_warning, block_of_line
  use deck_spelling_m, only : first_too_far, keep_nearer
  use deck_expression_m, only : evaluate, named_value_t, name_characters
  use deck_card_specs_m, only : card_spec_t, make_spec
  use deck_fields_m, only : card_t, cut_card, read_numbers, field_text, field_error
  use deck_schema_m, only : keyword_cards, max_card
  implicit none
  private
  public :: read_parameters, substitute, look_up, override_parameter

  !> What happens when a name is defined again (*PARAMETER_DUPLICATION DFLAG); by default a second
  !> definition with another value is an error.
  integer, parameter :: again_warn_keep = 1, again_warn_replace = 2, again_error_keep = 3, &
    again_replace = 4, again_keep = 5

contains

  !> Read all parameter keywords of the deck.
  subroutine read_parameters(deck)
    type(deck_t), intent(inout) :: deck
    integer :: i_block, i

    if (.not. allocated(deck%parameters%items)) allocate (deck%parameters%items(16))
    do i_block = 1, deck%n_block
      if (deck%blocks(i_block)%name(:9) /= 'PARAMETER') cycle
      deck%blocks(i_block)%dropped = .true.
      select case (deck%blocks(i_block)%name)
      case ('PARAMETER', 'PARAMETER_LOCAL')
        call read_values(deck, i_block)
      case ('PARAMETER_EXPRESSION', 'PARAMETER_EXPRESSION_LOCAL')
        call read_expressions(deck, i_block)
      case ('PARAMETER_DUPLICATION')
        call read_policy(deck, i_block)
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

  !> `; the nearest is NAME`, at most two letters away; nothing where no name is so near.
  pure function nearest_name(parameters, given) result(text)
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: given
    character(:), allocatable :: text
    character(len(parameters%items%name)) :: nearest
    integer :: i, least

    text = ''
    nearest = ''
    least = first_too_far(given)
    do i = 1, parameters%n
      if (parameters%items(i)%found) &
        call keep_nearer(trim(parameters%items(i)%name), given, least, nearest)
    end do
    if (len_trim(nearest) > 0) text = '; the nearest is '//trim(nearest)
  end function nearest_name

  !> Pairs of name and value, four to a line.
  subroutine read_values(deck, i_block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(card_spec_t) :: spec
    type(card_t) :: card
    integer :: line, k
    character(:), allocatable :: text

    call block_spec(deck, i_block, spec)
    do line = deck%blocks(i_block)%first, deck%blocks(i_block)%last
      call cut_card(deck, spec, deck%blocks(i_block)%source, line, card)
      do k = 1, 8, 2
        if (card%blank(k) .and. card%blank(k + 1)) cycle
        if (card%blank(k) .or. card%blank(k + 1)) then
          call field_error(deck, card, k, 'a parameter needs a name and a value (without a ' &
            //'comma a field ends at its column)')
          cycle
        end if
        text = field_text(deck, card, k + 1)
        if (index(text, '&') > 0) &
          call look_up(deck%parameters, text, deck%blocks(i_block)%source, text)
        if (len(text) == 0) then
          call field_error(deck, card, k + 1, 'is not defined by *PARAMETER up to here')
        else
          call define(deck, spec, card, k, text)
        end if
      end do
    end do
  end subroutine read_values

  !> Expressions, one to a line; a line with a blank name goes on with the one before.
  subroutine read_expressions(deck, i_block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(card_spec_t) :: spec
    type(card_t) :: card
    character(:), allocatable :: text, formula, trouble, line_here
    integer :: line, width, comma
    real(wp) :: value

    call block_spec(deck, i_block, spec)
    formula = ''
    do line = deck%blocks(i_block)%first, deck%blocks(i_block)%last
      line_here = line_text(deck, line)
      if (len_trim(line_here) == 0) cycle
      width = min(spec%widths(1), len(line_here))
      comma = index(line_here(:width), ',')
      text = line_here(:width)
      if (comma > 0) text = line_here(:comma - 1)
      if (comma > 0) width = comma
      if (len_trim(text) > 0) then
        card%line = line
        card%number = 1
        card%names = spec%names
        card%present = .true.
        card%bad = .false.
        card%first(1) = verify(text, ' ')
        card%last(1) = len_trim(text)
        card%blank(1) = .false.
        formula = ''
      else if (.not. card%present) then
        call line_error(deck, line, 'a parameter needs a name')
        cycle
      end if
      formula = formula//line_here(width + 1:)
      if (line < deck%blocks(i_block)%last) then
        text = line_text(deck, line + 1)
        if (len_trim(text) > 0 .and. len_trim(text(:min(spec%widths(1), len(text)))) == 0) cycle
      end if
      call evaluate(formula, named_values(deck%parameters, deck%blocks(i_block)%source, &
        formula), value, trouble)
      if (allocated(trouble)) then
        call field_error(deck, card, 1, 'cannot be computed: '//trouble)
      else
        call define(deck, spec, card, 1, shortest(value))
      end if
    end do
  end subroutine read_expressions

  !> *PARAMETER_DUPLICATION.
  subroutine read_policy(deck, i_block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(card_spec_t) :: spec
    type(card_t) :: card

    call block_spec(deck, i_block, spec)
    if (deck%blocks(i_block)%last < deck%blocks(i_block)%first) return
    call cut_card(deck, spec, deck%blocks(i_block)%source, deck%blocks(i_block)%first, card)
    call read_numbers(deck, spec, deck%blocks(i_block)%source, card)
    if (.not. card%bad(1)) deck%parameters%again = card%i(1)
  end subroutine read_policy

  !> The one card of a parameter keyword.
  subroutine block_spec(deck, i_block, spec)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: i_block
    type(card_spec_t), intent(out) :: spec
    character(160) :: cards(max_card)
    integer :: n_card

    call keyword_cards(deck%blocks(i_block)%name, cards, n_card)
    call make_spec(cards(1), 1, deck%blocks(i_block)%layout, spec)
  end subroutine block_spec

  !> Define the parameter named in field `k` of a card (type letter first), for its file alone where
  !> the keyword says so.
  subroutine define(deck, spec, card, k, given)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    type(card_t), intent(inout) :: card
    integer, intent(in) :: k
    character(*), intent(in) :: given
    character(:), allocatable :: name, text
    character :: kind
    integer :: status, number
    real(wp) :: value

    name = upper_case(field_text(deck, card, k))
    kind = name(1:1)
    name = trim(adjustl(name(2:)))
    if (scan(kind, 'RIC') == 0 .or. len(name) == 0 .or. len(name) > 20) then
      call field_error(deck, card, k, 'is not a type letter (R, I or C) and a name')
      return
    end if
    text = given
    number = 0
    if (kind /= 'C') then
      call read_real(text, value, status)
      if (status /= number_good) then
        call field_error(deck, card, min(k + 1, spec%n), 'is not a number')
        return
      end if
      if (kind == 'I') then
        ! An expression may miss a whole number by rounding; otherwise the fraction is cut off.
        if (abs(value - anint(value)) <= 1.0e-9_wp*max(1.0_wp, abs(value))) value = anint(value)
        if (abs(value) > real(huge(number), wp)) then
          call field_error(deck, card, k, 'is too large for an integer parameter')
          return
        end if
        number = int(value)
        text = to_text(number)
      end if
    end if
    associate (block => deck%blocks(block_of_line(deck, card%line)))
      call settle_parameter(deck, card%line, name, kind, text, merge(block%source, 0, &
        index(block%name, '_LOCAL') > 0))
    end associate
  end subroutine define

  !> The line of a card with its references replaced, in free format.
  subroutine substitute(deck, spec, source, card, text)
    type(deck_t), intent(inout) :: deck
    type(card_spec_t), intent(in) :: spec
    integer, intent(in) :: source
    type(card_t), intent(inout) :: card
    character(:), allocatable, intent(out) :: text
    character(:), allocatable :: field, value
    integer :: k, last

    last = 0
    do k = 1, spec%n
      if (.not. card%blank(k)) last = k
    end do
    text = ''
    do k = 1, last
      field = field_text(deck, card, k)
      if (index(field, '&') == 1 .or. index(field, '-&') == 1 .or. index(field, '+&') == 1) then
        if (index(field, '&(') == 0) then
          call look_up(deck%parameters, field, source, value)
          if (len(value) == 0 .and. .not. deck%incomplete) call field_error(deck, card, k, &
            'is not defined by any *PARAMETER')
          field = value
        end if
      end if
      text = text//field
      if (k < last .or. last == 1) text = text//','
    end do
  end subroutine substitute

  !> A value from the command line, which wins over the deck.
  subroutine override_parameter(parameters, name, text)
    type(parameters_t), intent(inout) :: parameters
    character(*), intent(in) :: name
    character(*), intent(in) :: text

    call add_parameter(parameters, upper_case(name), '?', text, 0)
    parameters%items(parameters%n)%fixed = .true.
  end subroutine override_parameter

  !> Put a definition into the table, minding one of the same name that is there.
  subroutine settle_parameter(deck, line, name, kind, text, source)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line
    character(*), intent(in) :: name
    character, intent(in) :: kind
    character(*), intent(in) :: text
    integer, intent(in) :: source
    real(wp) :: value
    integer :: i, status

    associate (parameters => deck%parameters)
      i = first_of(parameters, name)
      do while (i > 0)
        if (parameters%items(i)%name == name .and. (parameters%items(i)%source == source &
          .or. parameters%items(i)%fixed)) exit
        i = parameters%items(i)%next
      end do
      if (i == 0) then
        call add_parameter(parameters, name, kind, text, source)
        parameters%items(parameters%n)%found = .true.
        return
      end if
      if (.not. parameters%items(i)%found .and. kind /= 'C') then
        ! A value from the command line must be a number where the parameter is one.
        call read_real(parameters%items(i)%text, value, status)
        if (status /= number_good) call line_error(deck, 0, 'p:'//name &
          //' on the command line: "'//parameters%items(i)%text//'" is not a number')
      end if
      parameters%items(i)%found = .true.
      if (parameters%items(i)%fixed .or. parameters%items(i)%text == text) return
      select case (parameters%again)
      case (again_error, again_error_keep)
        call line_error(deck, line, 'parameter '//name//' is defined again with another value ("' &
          //text//'", before "'//parameters%items(i)%text//'")')
      case (again_warn_keep, again_warn_replace)
        call line_warning(deck, line, 'parameter '//name//to_text(line), 'parameter '//name &
          //' is defined again; the '//merge('first ', 'second', &
          parameters%again == again_warn_keep)//' value counts')
      end select
      if (parameters%again == again_warn_replace .or. parameters%again == again_replace) &
        parameters%items(i)%text = text
    end associate
  end subroutine settle_parameter

  !> Append a parameter.
  subroutine add_parameter(parameters, name, kind, text, source)
    type(parameters_t), intent(inout) :: parameters
    character(*), intent(in) :: name
    character, intent(in) :: kind
    character(*), intent(in) :: text
    integer, intent(in) :: source
    type(parameter_t), allocatable :: longer(:)
    integer :: i

    if (.not. allocated(parameters%items)) allocate (parameters%items(16))
    if (parameters%n == size(parameters%items)) then
      allocate (longer(2*parameters%n))
      longer(:parameters%n) = parameters%items
      call move_alloc(longer, parameters%items)
    end if
    parameters%n = parameters%n + 1
    parameters%items(parameters%n) = parameter_t(name=name, kind=kind, text=text, source=source)
    if (allocated(parameters%first)) then
      if (parameters%n <= size(parameters%first)) then
        call chain_parameter(parameters, parameters%n)
        return
      end if
      deallocate (parameters%first, parameters%last)
    end if
    allocate (parameters%first(2*size(parameters%items)), source=0)
    allocate (parameters%last(2*size(parameters%items)), source=0)
    do i = 1, parameters%n
      call chain_parameter(parameters, i)
    end do
  end subroutine add_parameter

  !> Put a parameter behind those of the same hash.
  subroutine chain_parameter(parameters, i)
    type(parameters_t), intent(inout) :: parameters
    integer, intent(in) :: i
    integer :: k

    k = name_hash(parameters%items(i)%name, size(parameters%first))
    parameters%items(i)%next = 0
    if (parameters%first(k) == 0) then
      parameters%first(k) = i
    else
      parameters%items(parameters%last(k))%next = i
    end if
    parameters%last(k) = i
  end subroutine chain_parameter

  !> The first parameter of the hash of a name, 0 where there is none.
  pure function first_of(parameters, name) result(i)
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: name
    integer :: i

    i = 0
    if (allocated(parameters%first)) i = parameters%first(name_hash(name, size(parameters%first)))
  end function first_of

  !> Hash of a name, 1 to `n`.
  pure function name_hash(name, n) result(k)
    character(*), intent(in) :: name
    integer, intent(in) :: n
    integer :: k
    integer :: i

    k = 0
    do i = 1, len_trim(name)
      k = modulo(31*k + iachar(name(i:i)), 16777213)
    end do
    k = modulo(k, n) + 1
  end function name_hash

  !> The parameter of a name that a file can see, one private to it before one of the whole deck; 0
  !> where there is none.
  pure function find_parameter(parameters, name, source, is_number) result(found)
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: name
    integer, intent(in) :: source
    logical, intent(in) :: is_number   !! texts do not count
    integer :: found
    integer :: i

    found = 0
    i = first_of(parameters, name)
    do while (i > 0)
      associate (item => parameters%items(i))
        if (item%name == name .and. item%found .and. .not. (is_number .and. item%kind == 'C')) then
          if (item%source == source) then
            found = i
            return
          else if (item%source == 0) then
            found = i
          end if
        end if
        i = item%next
      end associate
    end do
  end function find_parameter

  !> Names and values of the numbers that a file can see, of the names in a formula.
  function named_values(parameters, source, formula) result(names)
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: source
    character(*), intent(in) :: formula
    type(named_value_t), allocatable :: names(:)
    character(len(formula)) :: text
    integer :: i, n, first, last, status

    text = upper_case(formula)
    allocate (names(len(formula)))
    n = 0
    last = 0
    do
      first = scan(text(last + 1:), name_characters) + last
      if (first == last) exit
      last = verify(text(first:)//' ', name_characters) + first - 2
      i = find_parameter(parameters, text(first:last), source, .true.)
      if (i == 0) cycle
      n = n + 1
      names(n)%name = parameters%items(i)%name
      call read_real(parameters%items(i)%text, names(n)%value, status)
    end do
    names = names(:n)
  end function named_values

  !> Value text of a reference `&name`, `-&name` or `+&name`; empty when there is none.
  subroutine look_up(parameters, reference, source, text)
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: reference
    integer, intent(in) :: source
    character(:), allocatable, intent(inout) :: text
    character(:), allocatable :: name, value
    integer :: i, at
    logical :: negative

    at = index(reference, '&')
    negative = reference(1:1) == '-'
    name = trim(adjustl(upper_case(reference(at + 1:))))
    value = ''
    i = find_parameter(parameters, name, source, .false.)
    if (i > 0) value = parameters%items(i)%text
    if (len(value) > 0 .and. negative) then
      if (value(1:1) == '-') then
        value = value(2:)
      else if (value(1:1) == '+') then
        value = '-'//value(2:)
      else
        value = '-'//value
      end if
    end if
    text = value
  end subroutine look_up

end module deck_parameters_m
