! SPDX-License-Identifier: MIT
!> What the command line changes of a deck: `name=value`, `name.interface=value`, `p:NAME=value`.
module deck_overrides_m
  use kinds_m, only : wp
  use text_m, only : upper_case, read_real, read_integer, number_good
  use deck_fields_m, only : largest_value, smallest_value
  use deck_lines_m, only : deck_t, line_error
  use deck_parameter_table_m, only : parameters_t, override_parameter
  implicit none
  private
  public :: overrides_t, read_overrides, override_text, override_word, override_real, &
    override_integer, contact_names

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
    character(:), allocatable :: word   !! as it was given
  end type override_t

  !> All of them, in the order of the command line.
  type :: overrides_t
    type(override_t), allocatable :: items(:)
  end type overrides_t

contains

  !> Take the texts apart; those of parameters go straight to the parameters.
  subroutine read_overrides(texts, deck, parameters, overrides)
    character(*), intent(in) :: texts(:)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(inout) :: parameters
    type(overrides_t), intent(out) :: overrides
    type(override_t) :: item
    integer :: i, equals, dot, status

    allocate (overrides%items(0))
    do i = 1, size(texts)
      equals = index(texts(i), '=')
      if (equals < 2 .or. len_trim(texts(i)(equals + 1:)) == 0) then
        call line_error(deck, 0, '"'//trim(texts(i))//'" on the command line is not NAME=VALUE')
        cycle
      end if
      item%word = trim(adjustl(texts(i)))
      item%name = upper_case(trim(adjustl(texts(i)(:equals - 1))))
      item%text = trim(adjustl(texts(i)(equals + 1:)))
      item%interface = 0
      if (index(item%name, 'P:') == 1) then
        call override_parameter(parameters, item%name(3:), item%text)
        cycle
      end if
      dot = index(item%name, '.')
      status = number_good
      if (dot > 1) then
        call read_integer(item%name(dot + 1:), item%interface, status)
        item%name = item%name(:dot - 1)
      end if
      if (.not. known_name(item, dot > 0) .or. status /= number_good) then
        call line_error(deck, 0, '"'//trim(texts(i))//'" on the command line is not known: ' &
          //'endtim=, dt=, tssfac=; ctype=, ngauss=, pen=, punit=, pent=, vdc=, fs=, ' &
          //'fd=, dc=, vc=, tfac=, target= for all interfaces or, as in ctype.2=, for one; ' &
          //'p:NAME= for a parameter')
        cycle
      end if
      call check_number(deck, item, trim(texts(i)))
      overrides%items = [overrides%items, item]
    end do
  end subroutine read_overrides

  !> Whether there is an override of this name.
  pure function known_name(item, for_one) result(known)
    type(override_t), intent(in) :: item
    logical, intent(in) :: for_one
    logical :: known

    known = any(contact_names == item%name)
    if (.not. for_one) known = known .or. any(run_names == item%name)
  end function known_name

  !> The value must be a number of the right kind.
  subroutine check_number(deck, item, text)
    type(deck_t), intent(inout) :: deck
    type(override_t), intent(inout) :: item
    character(*), intent(in) :: text
    integer :: whole, status
    real(wp) :: value

    select case (item%name)
    case ('CTYPE', 'NGAUSS', 'PUNIT')
      call read_integer(item%text, whole, status)
      if (status == number_good) return
      call line_error(deck, 0, '"'//text//'" on the command line: the value is not a whole number')
      item%text = ''
    case default
      call read_real(item%text, value, status)
      if (status == number_good) then
        if (any(signed_names == item%name)) value = abs(value)
        if (value >= smallest_value .and. value <= largest_value) return
        if (any(zero_names == item%name) .and. .not. abs(value) > 0.0_wp) return
      end if
      call line_error(deck, 0, '"'//text//'" on the command line: the value is not a number ' &
        //range_of(item%name)//' (numbers reach 1e40)')
      item%text = ''
    end select
  end subroutine check_number

  !> What numbers a name takes.
  pure function range_of(name) result(text)
    character(*), intent(in) :: name
    character(:), allocatable :: text

    text = 'above 0'
    if (any(zero_names == name)) text = 'of 0 or more'
    if (any(signed_names == name)) text = 'other than 0'
  end function range_of

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

  !> The word of the command line that gives a value, as in `ctype.2=5`; empty when there is none.
  pure function override_word(overrides, name, interface) result(text)
    type(overrides_t), intent(in) :: overrides
    character(*), intent(in) :: name
    integer, intent(in) :: interface
    character(:), allocatable :: text
    integer :: i

    text = ''
    i = find_override(overrides, name, interface)
    if (i > 0) text = overrides%items(i)%word
  end function override_word

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
