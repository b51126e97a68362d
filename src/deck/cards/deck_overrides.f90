! SPDX-License-Identifier: MIT
!> Overrides of the command line, `name=value`, `name.interface=value` and `p:NAME=value`, as edits
!> of the deck before its cards are read.
module deck_overrides_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use text_m, only : upper_case, read_real, read_integer, number_good
  use deck_fields_m, only : largest_value, smallest_value
  use deck_lines_m, only : deck_t, word_t, line_error, line_warning
  use deck_edits_m, only : given_number, set_field, append_block
  use deck_parameter_table_m, only : parameter_t, add_parameter, find_given
  implicit none
  private
  public :: is_override, override_error, read_words, edit_controls, edit_contact, find_word, &
    check_words, contact_names, run_names

  !> Overrides of interfaces (fields of *CONTACT_2D_SLIDELINE), and of the run.
  character(6), parameter :: contact_names(13) = [character(6) :: 'CTYPE', 'NGAUSS', 'PEN', &
    'PUNIT', 'PENT', 'VDC', 'FS', 'FD', 'DC', 'VC', 'TFAC', 'TARGET', 'SMOOTH']
  character(6), parameter :: run_names(3) = [character(6) :: 'ENDTIM', 'DT', 'TSSFAC']
  !> Overrides that may be 0, integers, and friction.
  character(6), parameter :: zero_names(5) = [character(6) :: 'VDC', 'FS', 'FD', 'DC', 'VC'], &
    whole_names(4) = [character(6) :: 'CTYPE', 'NGAUSS', 'PUNIT', 'SMOOTH'], &
    friction_names(5) = [character(6) :: 'FS', 'FD', 'DC', 'VC', 'TFAC']

contains

  !> Whether `name` is the name of an override.
  pure function is_override(name) result(known)
    character(*), intent(in) :: name
    logical :: known
    character(len(name)) :: upper
    integer :: dot

    upper = upper_case(name)
    dot = index(name//'.', '.')
    known = any(run_names == upper) .or. index(upper, 'P:') == 1
    if (dot /= len(name)) known = known .or. (any(contact_names == upper(:dot - 1)) &
      .and. verify(name(dot + 1:), '0123456789') == 0)
  end function is_override

  !> Message about an override that is invalid for any deck; empty where it is valid.
  pure function override_error(text) result(problem)
    character(*), intent(in) :: text
    character(:), allocatable :: problem
    type(word_t) :: word

    call parse_override(text, word, problem)
    if (len(problem) > 0) problem = '"'//text//'"'//problem
  end function override_error

  !> Read the overrides of the command line; those of parameters are added to the parameters.
  subroutine read_words(texts, deck)
    character(*), intent(in) :: texts(:)
    type(deck_t), intent(inout) :: deck
    type(word_t) :: word
    type(parameter_t) :: item
    character(:), allocatable :: problem
    integer :: i

    do i = 1, size(texts)
      call parse_override(texts(i), word, problem)
      if (len(problem) > 0) then
        call line_error(deck, 0, word%phrase//problem)
      else if (index(word%name, 'P:') == 1) then
        if (find_given(deck%parameters, word%name(3:), 0) > 0) then
          call line_error(deck, 0, word%phrase//': the parameter is given twice')
          cycle
        end if
        ! A value from the command line prevails over the deck.
        item = parameter_t(name=word%name(3:), kind='?', fixed=.true.)
        item%text = word%text
        call add_parameter(deck%parameters, item)
      else
        deck%words = [deck%words, word]
      end if
    end do
  end subroutine read_words

  !> Parse an override into name, interface and value.
  pure subroutine parse_override(text, word, problem)
    character(*), intent(in) :: text
    type(word_t), intent(out) :: word
    character(:), allocatable, intent(out) :: problem  !! message after `"WORD"`, empty: none
    integer :: equals, dot, status

    problem = ''
    word%phrase = '"'//trim(adjustl(text))//'" on the command line'
    equals = index(text, '=')
    if (equals < 2 .or. len_trim(text(equals + 1:)) == 0) then
      problem = ' is not NAME=VALUE'
      return
    end if
    word%name = upper_case(trim(adjustl(text(:equals - 1))))
    word%text = trim(adjustl(text(equals + 1:)))
    if (index(word%name, 'P:') == 1) return
    status = merge(number_good, number_good + 1, is_override(word%name))
    dot = index(word%name, '.')
    if (status == number_good .and. dot > 1) then
      call read_integer(word%name(dot + 1:), word%interface, status)
      word%name = word%name(:dot - 1)
    end if
    if (status == number_good) then
      problem = value_error(word)
    else
      problem = ' is not known: endtim=, dt=, tssfac=; ctype=, ngauss=, pen=, punit=, pent=, ' &
        //'vdc=, fs=, fd=, dc=, vc=, tfac=, target=, smooth= for all interfaces or, as in ' &
        //'ctype.2=, for one; p:NAME= for a parameter'
    end if
  end subroutine parse_override

  !> Message about an invalid value of an override; PEN may be negative.
  pure function value_error(word) result(problem)
    type(word_t), intent(in) :: word
    character(:), allocatable :: problem
    integer :: whole, status
    real(wp) :: value

    problem = ''
    if (any(whole_names == word%name)) then
      call read_integer(word%text, whole, status)
      if (status /= number_good) problem = ': the value is not a whole number'
      return
    end if
    call read_real(word%text, value, status)
    if (word%name == 'PEN') value = abs(value)
    if (status == number_good .and. value >= smallest_value .and. value <= largest_value) return
    if (status == number_good .and. any(zero_names == word%name) .and. .not. abs(value) > 0.0_wp) &
      return
    problem = 'above 0'
    if (any(zero_names == word%name)) problem = 'of 0 or more'
    if (word%name == 'PEN') problem = 'other than 0'
    problem = ': the value is not a number '//problem//' (numbers reach 1e40)'
  end function value_error

  !> Index of the override of a name for an interface (0: the run): the last one, one for this
  !> interface before one for all; 0: none.
  pure function find_word(deck, name, interface) result(found)
    type(deck_t), intent(in) :: deck
    character(*), intent(in) :: name
    integer, intent(in) :: interface
    integer :: found
    integer :: i

    found = 0
    do i = 1, size(deck%words)
      if (deck%words(i)%name /= name) cycle
      if (all(deck%words(i)%interface /= [0, interface])) cycle
      if (found > 0) then
        if (deck%words(found)%interface > deck%words(i)%interface) cycle
      end if
      found = i
    end do
  end function find_word

  !> Apply the overrides of the run. dt= is DT0 of an implicit deck, else a constant curve in LCTM.
  subroutine edit_controls(deck)
    type(deck_t), intent(inout) :: deck
    character(:), allocatable :: number, text
    real(wp) :: is_implicit
    integer :: i, word

    call edit_control(deck, 'CONTROL_TERMINATION', 'ENDTIM', find_word(deck, 'ENDTIM', 0))
    call edit_control(deck, 'CONTROL_TIMESTEP', 'TSSFAC', find_word(deck, 'TSSFAC', 0))
    word = find_word(deck, 'DT', 0)
    if (word == 0) return
    is_implicit = 0.0_wp
    do i = 1, deck%n_block
      if (deck%blocks(i)%name == 'CONTROL_IMPLICIT_GENERAL') &
        call given_number(deck, i, 'IMFLAG', is_implicit)
    end do
    if (is_implicit > 0.0_wp) then
      call edit_control(deck, 'CONTROL_IMPLICIT_GENERAL', 'DT0', word)
      return
    end if
    number = unused_number(deck)
    call edit_control(deck, 'CONTROL_TIMESTEP', 'LCTM', word, number)
    text = ','//deck%words(word)%text//new_line('a')
    call append_block(deck, 'DEFINE_CURVE', number//','//new_line('a')//'0.0'//text//'1.0e20'//text)
  end subroutine edit_controls

  !> Set a field of all keywords of a name to the value of an override; append the keyword where
  !> there is none.
  subroutine edit_control(deck, keyword, field, word, text)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: keyword, field
    integer, intent(in) :: word                      !! 0: none
    character(*), intent(in), optional :: text       !! replaces the value
    character(:), allocatable :: value
    integer :: i
    logical :: found

    if (word == 0) return
    value = deck%words(word)%text
    if (present(text)) value = text
    found = any([(deck%blocks(i)%name == keyword, i=1, deck%n_block)])
    if (.not. found) call append_block(deck, keyword, '')
    do i = 1, deck%n_block
      if (deck%blocks(i)%name == keyword) call set_field(deck, i, field, value, word)
    end do
  end subroutine edit_control

  !> A number for a new curve that does not occur in the deck, so that references to missing curves
  !> stay errors. It is high, so that changes at a restart are unlikely to use it.
  function unused_number(deck) result(number)
    type(deck_t), intent(in) :: deck
    character(:), allocatable :: number
    integer, parameter :: high = 90000001
    integer :: i, k

    do k = high, huge(k) - 1
      number = to_text(k)
      if (any([(index(deck%sources(i)%text, number) > 0, i=1, deck%n_source)])) cycle
      if (any([(index(deck%parameters%items(i)%text, number) > 0, i=1, deck%parameters%n)])) cycle
      return
    end do
  end function unused_number

  !> Apply the overrides of an interface to its *CONTACT_2D_SLIDELINE. PENT and FD follow PEN and FS
  !> where they are equal in the deck; a nonzero CTYPE removes TARGET.
  subroutine edit_contact(deck, i_block, id)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    integer, intent(in) :: id                     !! of the interface
    real(wp) :: value, other, given
    integer :: k, word, status
    logical :: passed(size(contact_names))

    call pass_tie(deck, i_block, id, passed)
    do k = 1, size(contact_names)
      if (passed(k)) cycle
      word = find_word(deck, trim(contact_names(k)), id)
      if (word == 0) cycle
      call given_number(deck, i_block, trim(contact_names(k)), value)
      select case (contact_names(k))
      case ('PEN')
        call given_number(deck, i_block, 'PENT', other)
        if (.not. abs(value - other) > 0.0_wp) call set_field(deck, i_block, 'PENT', '')
      case ('FS')
        call given_number(deck, i_block, 'FD', other)
        call read_real(deck%words(word)%text, given, status)
        ! FD 0 of a stock card has been replaced by the smallest number.
        if (.not. abs(value - other) > 0.0_wp .or. max(given, abs(other)) <= smallest_value) &
          call set_field(deck, i_block, 'FD', '')
      case ('CTYPE')
        if (verify(deck%words(word)%text, '+-0') > 0) call set_field(deck, i_block, 'TARGET', '')
      end select
      call set_field(deck, i_block, trim(contact_names(k)), deck%words(word)%text, word)
    end do
  end subroutine edit_contact

  !> Find overrides that do not apply to a tie, with a warning: friction, damping, a share of the
  !> largest stable penalty. Tiebreak has friction and damping, for contact after failure.
  subroutine pass_tie(deck, i_block, id, passed)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    integer, intent(in) :: id
    logical, intent(out) :: passed(:)             !! of `contact_names`
    character(:), allocatable :: why
    real(wp) :: tie, value
    integer :: k, word, status

    passed = .false.
    call given_number(deck, i_block, 'TIE', tie)
    if (nint(tie) < 1 .or. nint(tie) > 2) return
    do k = 1, size(contact_names)
      word = find_word(deck, trim(contact_names(k)), id)
      if (word == 0) cycle
      call read_real(deck%words(word)%text, value, status)
      why = ''
      if (contact_names(k) == 'PUNIT' .and. nint(value) == 3) then
        why = 'its penalty cannot be a share of the largest stable penalty; '
        where (contact_names == 'PEN' .or. contact_names == 'PENT') passed = .true.
      else if (nint(tie) == 2) then
        cycle
      else if (contact_names(k) == 'VDC' .and. value > 0.0_wp) then
        why = 'ties have no contact damping; '
      else if (all(friction_names /= contact_names(k))) then
        cycle
      end if
      passed(k) = .true.
      call line_warning(deck, deck%blocks(i_block)%keyword, 'override '//contact_names(k) &
        //' of a tie'//to_text(id), 'interface '//to_text(id)//' is tied: '//why &
        //deck%words(word)%phrase//' has no effect on it')
    end do
  end subroutine pass_tie

  !> Report overrides of interfaces that the deck does not have; warn of overrides of all interfaces
  !> where there are none.
  subroutine check_words(deck, ids)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: ids(:) !! of the interfaces
    integer :: i

    do i = 1, size(deck%words)
      associate (word => deck%words(i))
        if (.not. any(contact_names == word%name)) cycle
        if (word%interface /= 0) then
          if (deck%incomplete .or. any(ids == word%interface)) cycle
          call line_error(deck, 0, word%phrase//' changes interface '//to_text(word%interface) &
            //', which the deck does not have')
        else if (size(ids) == 0) then
          call line_warning(deck, 0, 'override '//word%name, word%phrase//' changes ' &
            //word%name//' of all interfaces, but the deck has none')
        end if
      end associate
    end do
  end subroutine check_words

end module deck_overrides_m
