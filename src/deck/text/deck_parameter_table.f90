! SPDX-License-Identifier: MIT
!> The table of parameters: names with values, some private to a file, some from the command line.
module deck_parameter_table_m
  use kinds_m, only : wp
  use text_m, only : upper_case, read_real, number_good
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, line_error, line_warning
  use deck_expression_m, only : named_value_t
  implicit none
  private
  public :: parameters_t, override_parameter, settle_parameter, named_values, look_up, &
    parameter_comments, again_error, again_warn_keep

  !> What happens when a name is defined again (*PARAMETER_DUPLICATION DFLAG); by default a second
  !> definition with another value is an error.
  integer, parameter :: again_error = 0, again_warn_keep = 1, again_warn_replace = 2, &
    again_error_keep = 3, again_replace = 4, again_keep = 5

  !> One parameter.
  type :: parameter_t
    character(20) :: name = ''            !! upper case
    character :: kind = 'R'               !! R real, I integer, C text
    character(:), allocatable :: text     !! what is put in its place
    integer :: source = 0                 !! file it is private to, 0 = the whole deck
    logical :: fixed = .false.            !! given on the command line
    character(:), allocatable :: where    !! then: `on the command line`, for messages
    logical :: found = .false.            !! the deck defines it
  end type parameter_t

  !> All parameters.
  type :: parameters_t
    type(parameter_t), allocatable :: items(:)
    integer :: n = 0
    integer :: again = again_error
  end type parameters_t

contains

  !> A value from the command line, which wins over the deck.
  subroutine override_parameter(parameters, name, text, where)
    type(parameters_t), intent(inout) :: parameters
    character(*), intent(in) :: name
    character(*), intent(in) :: text
    character(*), intent(in) :: where !! it is given, for messages

    call add_parameter(parameters, upper_case(name), '?', text, 0)
    parameters%items(parameters%n)%fixed = .true.
    parameters%items(parameters%n)%where = where
  end subroutine override_parameter

  !> Put a definition into the table, minding one of the same name that is there.
  subroutine settle_parameter(deck, parameters, line, name, kind, text, source)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(inout) :: parameters
    integer, intent(in) :: line
    character(*), intent(in) :: name
    character, intent(in) :: kind
    character(*), intent(in) :: text
    integer, intent(in) :: source
    integer :: i

    do i = 1, parameters%n
      if (parameters%items(i)%name == name .and. (parameters%items(i)%source == source &
        .or. parameters%items(i)%fixed)) exit
    end do
    if (i > parameters%n) then
      call add_parameter(parameters, name, kind, text, source)
      parameters%items(parameters%n)%found = .true.
      return
    end if
    if (.not. parameters%items(i)%found .and. kind /= 'C') call check_override(i)
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

  contains

    !> A value from the command line must be a number where the parameter is one.
    subroutine check_override(k)
      integer, intent(in) :: k
      real(wp) :: value
      integer :: status

      call read_real(parameters%items(k)%text, value, status)
      if (status /= number_good) call line_error(deck, 0, 'p:'//name//' ' &
        //parameters%items(k)%where//': "'//parameters%items(k)%text//'" is not a number')
    end subroutine check_override

  end subroutine settle_parameter

  !> Append a parameter.
  subroutine add_parameter(parameters, name, kind, text, source)
    type(parameters_t), intent(inout) :: parameters
    character(*), intent(in) :: name
    character, intent(in) :: kind
    character(*), intent(in) :: text
    integer, intent(in) :: source
    type(parameter_t), allocatable :: longer(:)

    if (.not. allocated(parameters%items)) allocate (parameters%items(16))
    if (parameters%n == size(parameters%items)) then
      allocate (longer(2*parameters%n))
      longer(:parameters%n) = parameters%items
      call move_alloc(longer, parameters%items)
    end if
    parameters%n = parameters%n + 1
    parameters%items(parameters%n) = parameter_t(name=name, kind=kind, text=text, source=source)
  end subroutine add_parameter

  !> Names and values of the numbers that a file can see, those private to it first.
  function named_values(parameters, source) result(names)
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: source
    type(named_value_t), allocatable :: names(:)
    integer :: i, n, status, pass

    allocate (names(parameters%n))
    n = 0
    do pass = 1, 2
      do i = 1, parameters%n
        if (parameters%items(i)%source /= merge(source, 0, pass == 1)) cycle
        if (parameters%items(i)%kind == 'C' .or. .not. parameters%items(i)%found) cycle
        n = n + 1
        names(n)%name = parameters%items(i)%name
        call read_real(parameters%items(i)%text, names(n)%value, status)
      end do
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
    do i = 1, parameters%n
      if (parameters%items(i)%name /= name .or. .not. parameters%items(i)%found) cycle
      if (parameters%items(i)%source == source) then
        value = parameters%items(i)%text
        exit
      else if (parameters%items(i)%source == 0) then
        value = parameters%items(i)%text
      end if
    end do
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

  !> The parameters as comment lines for the effective deck.
  function parameter_comments(parameters) result(text)
    type(parameters_t), intent(in) :: parameters
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, parameters%n
      if (.not. parameters%items(i)%found) cycle
      text = text//'$ parameter '//trim(parameters%items(i)%name)//' = '//parameters%items(i)%text &
        //new_line('a')
    end do
  end function parameter_comments

end module deck_parameter_table_m
