! SPDX-License-Identifier: MIT
!> What the command line changes of a deck: `name=value`, `name.interface=value`, `p:NAME=value`.
module deck_overrides_m
  use kinds_m, only : wp
  use text_m, only : upper_case, read_real, read_integer, number_good, number_wrong
  use deck_fields_m, only : largest_value, smallest_value
  use deck_lines_m, only : deck_t, line_error
  use deck_parameters_m, only : override_parameter
  implicit none
  private
  public :: overrides_t, is_override, override_mistake, read_overrides, override_text, &
    override_phrase, override_real, override_integer, contact_names, run_names

  !> Overrides of interfaces; the others are those of the run.
  integer, parameter :: n_contact_name = 12
  character(6), parameter :: contact_names(n_contact_name) = [character(6) :: 'CTYPE', 'NGAUSS', &
    'PEN', 'PUNIT', 'PENT', 'VDC', 'FS', 'FD', 'DC', 'VC', 'TFAC', &
    'TARGET']
  !> Those that may be 0.
  character(6), parameter :: zero_names(5) = [character(6) :: 'VDC', 'FS', 'FD', 'DC', 'VC']
  !> PUNIT 4 has a meaning of PEN below 0; interfaces check the sign with their unit.
  character(6), parameter :: signed_names(1) = [character(6) :: 'PEN']
  character(6), parameter :: run_names(3) = [character(6) :: 'ENDTIM', 'DT', 'TSSFAC']

  !> One override.
  type :: override_t
    character(:), allocatable :: name   !! upper case
    integer :: interface = 0            !! 0 = all
    character(:), allocatable :: text   !! value
    character(:), allocatable :: phrase !! `"WORD" on the command line`, for messages
  end type override_t

  !> All of them, in the order of the command line.
  type :: overrides_t
    type(override_t), allocatable :: items(:)
  end type overrides_t

contains

  !> Whether `name` may stand before the = of an override.
  pure function is_override(name) result(known)
    character(*), intent(in) :: name
    logical :: known
    character(len(name)) :: upper
    integer :: dot

    upper = upper_case(name)
    dot = index(name, '.')
    known = any(contact_names == upper) .or. any(run_names == upper) .or. index(upper, 'P:') == 1
    if (dot > 1 .and. dot < len(name)) known = known .or. (any(contact_names == upper(:dot - 1)) &
      .and. verify(name(dot + 1:), '0123456789') == 0)
  end function is_override

  !> What is wrong with an override by itself, whatever the deck has; empty where nothing is.
  pure function override_mistake(word) result(mistake)
    character(*), intent(in) :: word
    character(:), allocatable :: mistake
    type(override_t) :: item

    call take_apart(word, item, mistake)
    if (len(mistake) > 0) mistake = '"'//word//'"'//mistake
  end function override_mistake

  !> Take the texts apart; those of parameters go straight to the parameters.
  subroutine read_overrides(texts, deck, overrides)
    character(*), intent(in) :: texts(:)
    type(deck_t), intent(inout) :: deck
    type(overrides_t), intent(out) :: overrides
    type(override_t) :: item
    character(:), allocatable :: mistake
    integer :: i

    allocate (overrides%items(0))
    do i = 1, size(texts)
      call take_apart(texts(i), item, mistake)
      item%phrase = '"'//trim(adjustl(texts(i)))//'" on the command line'
      if (len(mistake) > 0) call line_error(deck, 0, item%phrase//mistake)
      if (index(item%name, 'P:') == 1) then
        call override_parameter(deck%parameters, item%name(3:), item%text)
      else if (len(item%name) > 0) then
        overrides%items = [overrides%items, item]
      end if
    end do
  end subroutine read_overrides

  !> Name, interface and value of a text; what is wrong with it goes on from `"TEXT"`.
  pure subroutine take_apart(text, item, mistake)
    character(*), intent(in) :: text
    type(override_t), intent(out) :: item              !! without a name where it is none, without
                                                       !! a value where that is wrong
    character(:), allocatable, intent(out) :: mistake  !! empty: none
    integer :: equals, dot, status

    mistake = ''
    item%name = ''
    equals = index(text, '=')
    if (equals < 2 .or. len_trim(text(equals + 1:)) == 0) then
      mistake = ' is not NAME=VALUE'
      return
    end if
    item%name = upper_case(trim(adjustl(text(:equals - 1))))
    item%text = trim(adjustl(text(equals + 1:)))
    if (index(item%name, 'P:') == 1) return
    status = number_good
    if (.not. is_override(item%name)) status = number_wrong
    dot = index(item%name, '.')
    if (status == number_good .and. dot > 1) then
      call read_integer(item%name(dot + 1:), item%interface, status)
      item%name = item%name(:dot - 1)
    end if
    if (status /= number_good) then
      item%name = ''
      mistake = ' is not known: endtim=, dt=, tssfac=; ctype=, ngauss=, pen=, punit=, pent=, ' &
        //'vdc=, fs=, fd=, dc=, vc=, tfac=, target= for all interfaces or, as in ctype.2=, for ' &
        //'one; p:NAME= for a parameter'
      return
    end if
    call check_number(item, mistake)
  end subroutine take_apart

  !> The value must be a number of the right kind.
  pure subroutine check_number(item, mistake)
    type(override_t), intent(inout) :: item
    character(:), allocatable, intent(inout) :: mistake
    character(:), allocatable :: range
    integer :: whole, status
    real(wp) :: value

    select case (item%name)
    case ('CTYPE', 'NGAUSS', 'PUNIT')
      call read_integer(item%text, whole, status)
      if (status == number_good) return
      mistake = ': the value is not a whole number'
    case default
      call read_real(item%text, value, status)
      if (status == number_good) then
        if (any(signed_names == item%name)) value = abs(value)
        if (value >= smallest_value .and. value <= largest_value) return
        if (any(zero_names == item%name) .and. .not. abs(value) > 0.0_wp) return
      end if
      range = 'above 0'
      if (any(zero_names == item%name)) range = 'of 0 or more'
      if (any(signed_names == item%name)) range = 'other than 0'
      mistake = ': the value is not a number '//range//' (numbers reach 1e40)'
    end select
    item%text = ''
  end subroutine check_number

  !> Value text for an interface (0: the run), the last one given; empty when there is none.
  pure function override_text(overrides, name, interface) result(text)
    type(overrides_t), intent(in) :: overrides
    character(*), intent(in) :: name
    integer, intent(in) :: interface
    character(:), allocatable :: text
    integer :: i

    text = ''
    i = find_override(overrides, name, interface)
    if (i > 0) text = overrides%items(i)%text
  end function override_text

  !> Where a value is given, as in `"ctype.2=5" on the command line`; empty when it is nowhere.
  pure function override_phrase(overrides, name, interface) result(text)
    type(overrides_t), intent(in) :: overrides
    character(*), intent(in) :: name
    integer, intent(in) :: interface
    character(:), allocatable :: text
    integer :: i

    text = ''
    i = find_override(overrides, name, interface)
    if (i > 0) text = overrides%items(i)%phrase
  end function override_phrase

  !> The override that counts for an interface (0: the run), the last one given; 0 when there is
  !> none.
  pure function find_override(overrides, name, interface) result(found)
    type(overrides_t), intent(in) :: overrides
    character(*), intent(in) :: name
    integer, intent(in) :: interface
    integer :: found
    integer :: i

    found = 0
    do i = 1, size(overrides%items)
      if (overrides%items(i)%name == name .and. overrides%items(i)%interface == 0) found = i
    end do
    ! What is meant for one interface wins over what is meant for all.
    do i = 1, size(overrides%items)
      if (overrides%items(i)%name /= name .or. overrides%items(i)%interface == 0) cycle
      if (overrides%items(i)%interface == interface) found = i
    end do
  end function find_override

  !> Replace a real by its override, if there is one.
  pure subroutine override_real(overrides, name, interface, value, changed)
    type(overrides_t), intent(in) :: overrides
    character(*), intent(in) :: name
    integer, intent(in) :: interface
    real(wp), intent(inout) :: value
    logical, intent(inout) :: changed   !! set when there is one
    character(:), allocatable :: text
    integer :: status

    text = override_text(overrides, name, interface)
    if (len(text) == 0) return
    call read_real(text, value, status)
    changed = .true.
  end subroutine override_real

  !> Replace an integer by its override, if there is one.
  pure subroutine override_integer(overrides, name, interface, value, changed)
    type(overrides_t), intent(in) :: overrides
    character(*), intent(in) :: name
    integer, intent(in) :: interface
    integer, intent(inout) :: value
    logical, intent(inout) :: changed
    character(:), allocatable :: text
    integer :: status

    text = override_text(overrides, name, interface)
    if (len(text) == 0) return
    call read_integer(text, value, status)
    changed = .true.
  end subroutine override_integer

end module deck_overrides_m
