! SPDX-License-Identifier: MIT
!> Value of a Fortran-like expression of *PARAMETER_EXPRESSION: + - * / **, parentheses, functions,
!> names of parameters (with or without &). Undefined and too large values are detected after the
!> operation, with arithmetic traps off.
module deck_expression_m
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use, intrinsic :: ieee_exceptions, only : ieee_all, ieee_set_flag, &
    ieee_set_halting_mode
  use deck_parameter_table_m, only : parameters_t, find_parameter
  use kinds_m, only : wp, pi
  use text_m, only : upper_case, read_real, number_good
  implicit none
  private
  public :: evaluate

  !> Maximum nesting of parentheses and powers.
  integer, parameter :: max_depth = 100
  !> Largest magnitude of any intermediate value.
  real(wp), parameter :: largest = 1.0e300_wp
  !> Operators of a sum and of a product.
  character(2), parameter :: operators(2) = ['+-', '*/']

  !> State of the parser.
  type :: scanner_t
    character(:), allocatable :: text
    integer :: at = 1                    !! next character
    integer :: depth = 0
    integer :: source = 0                !! file of the expression
    real(wp), allocatable :: time        !! value of TIME, where the expression has one
    character(:), allocatable :: message !! first error
  end type scanner_t

contains

  !> Value of `text`; `message` is allocated when there is none.
  subroutine evaluate(text, parameters, source, value, message, time)
    character(*), intent(in) :: text
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: source !! file of the text
    real(wp), intent(out) :: value
    character(:), allocatable, intent(out) :: message
    real(wp), intent(in), optional :: time !! value of TIME
    type(scanner_t) :: scanner

    scanner%text = trim(upper_case(text))//' '
    scanner%source = source
    if (present(time)) scanner%time = time
    call parse_terms(scanner, parameters, 1, value)
    if (accept(scanner, '')) continue
    if (scanner%at < len(scanner%text)) &
      call set_error(scanner, 'cannot read "'//trim(scanner%text(scanner%at:))//'"')
    if (allocated(scanner%message)) then
      call move_alloc(scanner%message, message)
      value = 0.0_wp
    end if
  end subroutine evaluate

  !> Store the first error and stop parsing.
  subroutine set_error(scanner, message)
    type(scanner_t), intent(inout) :: scanner
    character(*), intent(in) :: message

    if (.not. allocated(scanner%message)) scanner%message = message
    scanner%at = len(scanner%text)
  end subroutine set_error

  !> Skip blanks, and accept `word` if it comes next. The text ends with a blank.
  function accept(scanner, word) result(accepted)
    type(scanner_t), intent(inout) :: scanner
    character(*), intent(in) :: word
    logical :: accepted
    integer :: n

    n = verify(scanner%text(scanner%at:), ' ') - 1
    if (n < 0) n = len(scanner%text) - scanner%at
    scanner%at = scanner%at + n
    accepted = index(scanner%text(scanner%at:), word) == 1
    if (accepted) scanner%at = scanner%at + len(word)
  end function accept

  !> Parse a sum (level 1) of products (level 2) of factors: operand {operator operand}.
  recursive subroutine parse_terms(scanner, parameters, level, value)
    type(scanner_t), intent(inout) :: scanner
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: level
    real(wp), intent(out) :: value
    real(wp) :: operand
    character :: operator

    call parse_operand(value)
    do while (.not. allocated(scanner%message))
      if (accept(scanner, operators(level)(1:1))) then
        operator = operators(level)(1:1)
      else if (accept(scanner, operators(level)(2:2))) then
        operator = operators(level)(2:2)
      else
        return
      end if
      call parse_operand(operand)
      if (operator == '/' .and. .not. abs(operand) > 0.0_wp) &
        call set_error(scanner, 'division by zero')
      if (.not. allocated(scanner%message)) call operate(scanner, operator, operand, value)
    end do

  contains

    !> Parse the next operand.
    recursive subroutine parse_operand(next)
      real(wp), intent(out) :: next

      if (level == 1) call parse_terms(scanner, parameters, 2, next)
      if (level == 2) call parse_factor(scanner, parameters, next)
    end subroutine parse_operand

  end subroutine parse_terms

  !> value = value operator operand; ^ stands for a power.
  subroutine operate(scanner, operator, operand, value)
    type(scanner_t), intent(inout) :: scanner
    character, intent(in) :: operator
    real(wp), intent(in) :: operand
    real(wp), intent(inout) :: value
    logical :: is_whole

    call ieee_set_halting_mode(ieee_all, .false.)
    select case (operator)
    case ('+'); value = value + operand
    case ('-'); value = value - operand
    case ('*'); value = value*operand
    case ('/'); value = value/operand
    case ('^')
      is_whole = abs(operand) < 1.0e6_wp .and. .not. abs(operand - anint(operand)) > 0.0_wp
      if (.not. abs(value) > 0.0_wp .and. operand < 0.0_wp) &
        call set_error(scanner, 'division by zero')
      if (value < 0.0_wp .and. .not. is_whole) &
        call set_error(scanner, 'a negative number to a power that is not whole')
      if (is_whole) then
        value = value**nint(operand)
      else
        value = value**operand
      end if
    end select
    if (.not. abs(value) <= largest) call set_error(scanner, 'the value is too large')
    call ieee_set_flag(ieee_all, .false.) ! what is reported must not stop a checked build later
  end subroutine operate

  !> Parse signs, a primary, and powers from the right, which bind stronger than a sign, as in
  !> Fortran.
  recursive subroutine parse_factor(scanner, parameters, value)
    type(scanner_t), intent(inout) :: scanner
    type(parameters_t), intent(in) :: parameters
    real(wp), intent(out) :: value
    real(wp) :: power
    logical :: is_negative

    is_negative = .false.
    do
      if (accept(scanner, '-')) then
        is_negative = .not. is_negative
      else if (.not. accept(scanner, '+')) then
        exit
      end if
    end do
    scanner%depth = scanner%depth + 1
    if (scanner%depth > max_depth) call set_error(scanner, 'too many parentheses or powers')
    call parse_primary(scanner, parameters, value)
    if (accept(scanner, '**')) then
      call parse_factor(scanner, parameters, power)
      if (.not. allocated(scanner%message)) call operate(scanner, '^', power, value)
    end if
    scanner%depth = scanner%depth - 1
    if (is_negative) value = -value
  end subroutine parse_factor

  !> Parse a number, a name, a function or an expression in parentheses.
  recursive subroutine parse_primary(scanner, parameters, value)
    type(scanner_t), intent(inout) :: scanner
    type(parameters_t), intent(in) :: parameters
    real(wp), intent(out) :: value
    character(:), allocatable :: word
    integer :: n, i, status

    value = 0.0_wp
    if (accept(scanner, '(')) then
      call parse_terms(scanner, parameters, 1, value)
      if (.not. accept(scanner, ')')) call set_error(scanner, 'a ")" is missing')
      return
    end if
    if (accept(scanner, '&')) continue
    n = verify(scanner%text(scanner%at:), 'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_') - 1
    if (scan(scanner%text(scanner%at:scanner%at), '0123456789.') == 1) then
      call parse_number(scanner, value)
      return
    else if (n == 0) then
      call set_error(scanner, 'a number or a name is missing')
      return
    end if
    word = scanner%text(scanner%at:scanner%at + n - 1)
    scanner%at = scanner%at + n
    i = find_parameter(parameters, word, scanner%source, .true.)
    if (allocated(scanner%time) .and. word == 'TIME') then
      value = scanner%time
    else if (i > 0) then
      call read_real(parameters%items(i)%text, value, status)
    else if (word == 'PI') then
      value = pi
    else if (accept(scanner, '(')) then
      call parse_function(scanner, parameters, word, value)
    else
      call set_error(scanner, 'parameter '//word//' is not defined up to here')
    end if
  end subroutine parse_primary

  !> Parse a number: digits, point, exponent with letter and sign.
  subroutine parse_number(scanner, value)
    type(scanner_t), intent(inout) :: scanner
    real(wp), intent(out) :: value
    character(*), parameter :: digits = '0123456789'
    integer :: n, m, status

    associate (rest => scanner%text(scanner%at:))
      n = verify(rest, digits//'.') - 1
      if (scan(rest(n + 1:n + 1), 'ED') == 1) then
        m = n + 1 + scan(rest(n + 2:n + 2), '+-')
        if (scan(rest(m + 1:m + 1), digits) == 1) n = m + verify(rest(m + 1:), digits) - 1
      end if
      call read_real(rest(:n), value, status)
    end associate
    if (status == number_good) then
      scanner%at = scanner%at + n
    else
      call set_error(scanner, 'cannot read "'//trim(scanner%text(scanner%at:))//'"')
    end if
  end subroutine parse_number

  !> Parse the arguments of a function after its opening parenthesis, and evaluate it.
  recursive subroutine parse_function(scanner, parameters, word, value)
    type(scanner_t), intent(inout) :: scanner
    type(parameters_t), intent(in) :: parameters
    character(*), intent(in) :: word
    real(wp), intent(out) :: value
    real(wp) :: arguments(10)
    integer :: n

    value = 0.0_wp
    n = 0
    do
      n = n + 1
      if (n > size(arguments)) call set_error(scanner, word//' has more than 10 arguments')
      if (allocated(scanner%message)) return
      call parse_terms(scanner, parameters, 1, arguments(n))
      if (.not. accept(scanner, ',')) exit
    end do
    if (.not. accept(scanner, ')')) call set_error(scanner, 'a ")" is missing after '//word)
    select case (word)
    case ('MIN', 'MAX', 'MOD', 'SIGN', 'ATAN2')
      if (n < 2) call set_error(scanner, word//' needs two arguments')
    case ('STEP')
      if (n /= 5) call set_error(scanner, 'STEP takes five arguments')
    case ('IF')
      if (n /= 4) call set_error(scanner, 'IF takes four arguments')
    case ('SIN', 'COS', 'TAN', 'ASIN', 'ACOS', 'ATAN', 'SQRT', 'EXP', 'LOG', 'LOG10', 'ABS', &
      'INT', 'NINT')
      if (n /= 1) call set_error(scanner, word//' takes one argument')
    case default
      call set_error(scanner, 'there is no function '//word)
    end select
    if (.not. allocated(scanner%message)) call apply_function(scanner, word, arguments(:n), value)
  end subroutine parse_function

  !> Value of a function.
  subroutine apply_function(scanner, word, a, value)
    type(scanner_t), intent(inout) :: scanner
    character(*), intent(in) :: word
    real(wp), intent(in) :: a(:)
    real(wp), intent(out) :: value
    real(wp) :: s

    call ieee_set_halting_mode(ieee_all, .false.)
    value = 0.0_wp
    select case (word)
    case ('SIN'); value = sin(a(1))
    case ('COS'); value = cos(a(1))
    case ('TAN'); value = tan(a(1))
    case ('ASIN'); value = asin(a(1))
    case ('ACOS'); value = acos(a(1))
    case ('ATAN'); value = atan(a(1))
    case ('ATAN2')
      value = atan2(a(1), a(2))
      if (.not. maxval(abs(a(:2))) > 0.0_wp) call set_error(scanner, 'ATAN2 is not defined there')
    case ('SQRT'); value = sqrt(a(1))
    case ('EXP'); value = exp(a(1))
    case ('LOG'); value = log(a(1))
    case ('LOG10'); value = log10(a(1))
    case ('ABS'); value = abs(a(1))
    case ('INT'); value = aint(a(1))
    case ('NINT'); value = anint(a(1))
    case ('MOD'); value = mod(a(1), a(2))
    case ('SIGN'); value = sign(a(1), a(2))
    case ('MIN'); value = minval(a)
    case ('MAX'); value = maxval(a)
    case ('IF'); value = merge(a(2), merge(a(4), a(3), a(1) > 0.0_wp), a(1) < 0.0_wp)
    case ('STEP')
      ! From h0 before x0 to h1 after x1, by a polynomial of third degree.
      if (.not. a(4) > a(2)) call set_error(scanner, 'STEP(x, x0, h0, x1, h1) needs x1 above x0')
      s = min(max((a(1) - a(2))/max(a(4) - a(2), tiny(s)), 0.0_wp), 1.0_wp)
      value = a(3) + (a(5) - a(3))*s**2*(3.0_wp - 2.0_wp*s)
    end select
    if (.not. ieee_is_finite(value)) call set_error(scanner, word//' is not defined there')
    call ieee_set_flag(ieee_all, .false.)
  end subroutine apply_function

end module deck_expression_m
