! SPDX-License-Identifier: MIT
!> Table of the parameters of a deck by case-insensitive name; parameters may be local to a file or
!> come from the command line.
module deck_parameter_table_m
  use text_m, only : upper_case
  implicit none
  private
  public :: parameter_t, parameters_t, add_parameter, find_given, find_parameter, look_up

  !> Number of hash values, for fast reading of decks with many parameters.
  integer, parameter :: n_hash = 4096

  !> One parameter.
  type :: parameter_t
    character(20) :: name = ''            !! upper case
    character :: kind = 'R'               !! R real, I integer, C text
    character(:), allocatable :: text     !! its value
    integer :: source = 0                 !! file it is local to, 0 = the whole deck
    logical :: fixed = .false.            !! given on the command line
    logical :: found = .false.            !! defined by the deck
    integer :: next = 0                   !! previous parameter with the same hash
  end type parameter_t

  !> All parameters, in the order of their definitions.
  type :: parameters_t
    type(parameter_t), allocatable :: items(:)
    integer :: n = 0
    integer :: last(0:n_hash - 1) = 0     !! last parameter of each hash
    integer :: duplicates = 0             !! treatment of second definitions (DFLAG)
  end type parameters_t

contains

  !> Append a parameter.
  subroutine add_parameter(parameters, item)
    type(parameters_t), intent(inout) :: parameters
    type(parameter_t), intent(in) :: item
    integer :: k

    if (.not. allocated(parameters%items)) allocate (parameters%items(16))
    if (parameters%n == size(parameters%items)) &
      parameters%items = [parameters%items, parameters%items]
    parameters%n = parameters%n + 1
    parameters%items(parameters%n) = item
    k = name_hash(item%name)
    parameters%items(parameters%n)%next = parameters%last(k)
    parameters%last(k) = parameters%n
  end subroutine add_parameter

  !> Hash of a name.
  pure function name_hash(name) result(k)
    character(*), intent(in) :: name
    integer :: k
    integer :: i

    k = 0
    do i = 1, len_trim(name)
      k = modulo(31*k + iachar(name(i:i)), n_hash)
    end do
  end function name_hash

  !> Index of an existing parameter that a definition in a file repeats: of the same file or from
  !> the command line; 0 where there is none.
  pure function find_given(parameters, name, source) result(i)
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: name
    integer, intent(in) :: source
    integer :: i

    i = parameters%last(name_hash(name))
    do while (i > 0)
      associate (item => parameters%items(i))
        if (item%name == name .and. (item%source == source .or. item%fixed)) return
        i = item%next
      end associate
    end do
  end function find_given

  !> Index of the parameter visible in a file: a local one before one of the whole deck; 0 where
  !> there is none.
  pure function find_parameter(parameters, name, source, is_number) result(found)
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: name
    integer, intent(in) :: source
    logical, intent(in) :: is_number   !! skip text parameters
    integer :: found
    integer :: i

    found = 0
    i = parameters%last(name_hash(name))
    do while (i > 0)
      associate (item => parameters%items(i))
        if (item%name == name .and. item%found .and. .not. (is_number .and. item%kind == 'C')) then
          if (item%source == source .or. (item%source == 0 .and. found == 0)) found = i
          if (item%source == source) return
        end if
        i = item%next
      end associate
    end do
  end function find_parameter

  !> Value text of a reference `&name`, `-&name` or `+&name`; empty when there is none.
  subroutine look_up(parameters, reference, source, text)
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: reference
    integer, intent(in) :: source
    character(:), allocatable, intent(inout) :: text
    character(:), allocatable :: value
    integer :: i

    value = ''
    i = find_parameter(parameters, trim(adjustl(upper_case(reference(index(reference, '&') + &
      1:)))), source, .false.)
    if (i > 0) value = parameters%items(i)%text
    if (len(value) > 0 .and. reference(1:1) == '-') then
      value = '-'//value
      if (scan(value(2:2), '+-') == 1) value = merge(' ', '-', value(2:2) == '-')//value(3:)
      value = trim(adjustl(value))
    end if
    text = value
  end subroutine look_up

end module deck_parameter_table_m
