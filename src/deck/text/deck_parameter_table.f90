! SPDX-License-Identifier: MIT
!> The table of parameters: names with values, some private to a file, some from the command line.
module deck_parameter_table_m
  use kinds_m, only : wp
  use text_m, only : upper_case, read_real, number_good
  use log_m, only : to_text
  use deck_lines_m, only : deck_t, parameter_t, parameters_t, again_error, line_error, line_warning
  use deck_expression_m, only : named_value_t, name_characters
  implicit none
  private
  public :: override_parameter, settle_parameter, named_values, look_up, parameter_comment, &
    again_warn_keep

  !> What happens when a name is defined again (*PARAMETER_DUPLICATION DFLAG); by default a second
  !> definition with another value is an error.
  integer, parameter :: again_warn_keep = 1, again_warn_replace = 2, again_error_keep = 3, &
    again_replace = 4, again_keep = 5

contains

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

  !> A parameter as a comment line for the effective deck; empty for one that the deck lacks.
  pure function parameter_comment(parameters, i) result(text)
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i
    character(:), allocatable :: text

    text = ''
    if (parameters%items(i)%found) text = '$ parameter '//trim(parameters%items(i)%name)//' = ' &
      //parameters%items(i)%text//new_line('a')
  end function parameter_comment

end module deck_parameter_table_m
