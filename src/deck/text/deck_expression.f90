! SPDX-License-Identifier: MIT
!> Value of a Fortran-like expression of *PARAMETER_EXPRESSION: + - * / **, parentheses, functions,
!> names of parameters (with or without &). Nothing in it can raise an arithmetic exception: every
!> step is checked before it is taken; powers and functions are defined wherever that can not be.
module deck_expression_m
  use kinds_m, only : wp, pi
  use text_m, only : upper_case, read_real, number_good
  implicit none
  private
  public :: evaluate, named_value_t, name_characters

  !> What names are made of (upper case).
  character(*), parameter :: name_characters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_'
  !> Nested parentheses, signs and powers.
  integer, parameter :: max_depth = 100
  !> Largest magnitude of any intermediate value.
  real(wp), parameter :: largest = 1.0e300_wp

  !> A name and its value.
  type :: named_value_t
    character(20) :: name = ''   !! upper case
    real(wp) :: value = 0.0_wp
  end type named_value_t

  !> Where the reading stands.
  type :: scanner_t
    character(:), allocatable :: text
    integer :: at = 1
    integer :: depth = 0
    type(named_value_t), allocatable :: names(:)
    character(:), allocatable :: trouble !! first mistake
  end type scanner_t

contains

  !> Value of `text`; `trouble` is allocated when there is none.
  subroutine evaluate(text, names, value, trouble)
    character(*), intent(in) :: text
    type(named_value_t), intent(in) :: names(:)
    real(wp), intent(out) :: value
    character(:), allocatable, intent(out) :: trouble
    type(scanner_t) :: scanner

    scanner%text = trim(upper_case(text))//' '
    scanner%names = names
    call take_sum(scanner, value)
    call skip_blanks(scanner)
    if (.not. allocated(scanner%trouble) .and. scanner%at < len(scanner%text)) &
      call complain(scanner, 'cannot read "'//trim(scanner%text(scanner%at:))//'"')
    if (allocated(scanner%trouble)) then
      trouble = scanner%trouble
      value = 0.0_wp
    end if
  end subroutine evaluate

  !> Keep the first mistake.
  subroutine complain(scanner, message)
    type(scanner_t), intent(inout) :: scanner
    character(*), intent(in) :: message

    if (.not. allocated(scanner%trouble)) scanner%trouble = message
    scanner%at = len(scanner%text)
  end subroutine complain

  !> Move to the next character that is not blank; the text ends with one blank.
  subroutine skip_blanks(scanner)
    type(scanner_t), intent(inout) :: scanner

    do while (scanner%at < len(scanner%text))
      if (scanner%text(scanner%at:scanner%at) /= ' ') exit
      scanner%at = scanner%at + 1
    end do
  end subroutine skip_blanks

  !> Whether `word` comes next; it is taken if so.
  function take(scanner, word) result(taken)
    type(scanner_t), intent(inout) :: scanner
    character(*), intent(in) :: word
    logical :: taken

    call skip_blanks(scanner)
    taken = .false.
    if (scanner%at + len(word) - 1 > len(scanner%text)) return
    taken = scanner%text(scanner%at:scanner%at + len(word) - 1) == word
    if (taken) scanner%at = scanner%at + len(word)
  end function take

  !> term {+ term | - term}
  recursive subroutine take_sum(scanner, value)
    type(scanner_t), intent(inout) :: scanner
    real(wp), intent(out) :: value
    real(wp) :: term

    value = 0.0_wp
    scanner%depth = scanner%depth + 1
    if (scanner%depth > max_depth) call complain(scanner, 'too many parentheses or signs')
    call take_product(scanner, value)
    do while (.not. allocated(scanner%trouble))
      if (take(scanner, '+')) then
        call take_product(scanner, term)
        value = value + term
      else if (take(scanner, '-')) then
        call take_product(scanner, term)
        value = value - term
      else
        exit
      end if
      if (abs(value) > largest) call complain(scanner, 'the value is too large')
    end do
    scanner%depth = scanner%depth - 1
  end subroutine take_sum

  !> factor {* factor | / factor}
  recursive subroutine take_product(scanner, value)
    type(scanner_t), intent(inout) :: scanner
    real(wp), intent(out) :: value
    real(wp) :: factor

    value = 0.0_wp
    call take_signed(scanner, value)
    do while (.not. allocated(scanner%trouble))
      if (take(scanner, '*')) then
        call take_signed(scanner, factor)
        if (exponent(value) + exponent(factor) > 996) then
          call complain(scanner, 'the value is too large')
        else
          value = value*factor
        end if
      else if (take(scanner, '/')) then
        call take_signed(scanner, factor)
        if (.not. abs(factor) > 0.0_wp) then
          call complain(scanner, 'division by zero')
        else if (exponent(value) - exponent(factor) > 995) then
          call complain(scanner, 'the value is too large')
        else
          value = value/factor
        end if
      else
        exit
      end if
    end do
  end subroutine take_product

  !> A factor with signs before it; a power binds stronger than a sign, as in Fortran.
  recursive subroutine take_signed(scanner, value)
    type(scanner_t), intent(inout) :: scanner
    real(wp), intent(out) :: value
    logical :: negative

    negative = .false.
    do
      if (take(scanner, '-')) then
        negative = .not. negative
      else if (.not. take(scanner, '+')) then
        exit
      end if
    end do
    call take_power(scanner, value)
    if (negative) value = -value
  end subroutine take_signed

  !> base [** power], taken from the right
  recursive subroutine take_power(scanner, value)
    type(scanner_t), intent(inout) :: scanner
    real(wp), intent(out) :: value
    real(wp) :: power
    character(:), allocatable :: trouble

    call take_primary(scanner, value)
    if (allocated(scanner%trouble)) return
    if (.not. take(scanner, '**')) return
    scanner%depth = scanner%depth + 1
    if (scanner%depth > max_depth) call complain(scanner, 'too many powers')
    call take_signed(scanner, power)
    scanner%depth = scanner%depth - 1
    if (allocated(scanner%trouble)) return
    call raise_power(power, value, trouble)
    if (len(trouble) > 0) call complain(scanner, trouble)
  end subroutine take_power

  !> A number, a name, a function or an expression in parentheses.
  recursive subroutine take_primary(scanner, value)
    type(scanner_t), intent(inout) :: scanner
    real(wp), intent(out) :: value
    character(:), allocatable :: word
    integer :: n, i

    value = 0.0_wp
    if (take(scanner, '(')) then
      call take_sum(scanner, value)
      if (.not. take(scanner, ')')) call complain(scanner, 'a ")" is missing')
      return
    end if
    if (take(scanner, '&')) continue
    n = verify(scanner%text(scanner%at:), name_characters) - 1
    if (scan(scanner%text(scanner%at:scanner%at), '0123456789.') == 1) then
      call take_number(scanner, value)
      return
    else if (n == 0) then
      call complain(scanner, 'a number or a name is missing')
      return
    end if
    word = scanner%text(scanner%at:scanner%at + n - 1)
    scanner%at = scanner%at + n
    do i = size(scanner%names), 1, -1
      if (scanner%names(i)%name == word) exit
    end do
    if (i > 0) then
      value = scanner%names(i)%value
    else if (word == 'PI') then
      value = pi
    else if (take(scanner, '(')) then
      call take_function(scanner, word, value)
    else
      call complain(scanner, 'there is no parameter '//word//' up to here')
    end if
  end subroutine take_primary

  !> A number: digits, point, exponent with its letter and sign.
  subroutine take_number(scanner, value)
    type(scanner_t), intent(inout) :: scanner
    real(wp), intent(out) :: value
    integer :: n, m, status

    associate (rest => scanner%text(scanner%at:))
      n = verify(rest, '0123456789.') - 1
      if (scan(rest(n + 1:n + 1), 'ED') == 1) then
        m = n + 1
        if (scan(rest(m + 1:min(m + 1, len(rest))), '+-') == 1) m = m + 1
        if (scan(rest(m + 1:min(m + 1, len(rest))), '0123456789') == 1) &
          n = m + verify(rest(m + 1:), '0123456789') - 1
      end if
      call read_real(rest(:n), value, status)
    end associate
    if (status == number_good) then
      scanner%at = scanner%at + n
    else
      call complain(scanner, 'cannot read "'//trim(scanner%text(scanner%at:))//'"')
    end if
  end subroutine take_number

  !> The arguments of a function (its opening parenthesis has been taken) and its value.
  recursive subroutine take_function(scanner, word, value)
    type(scanner_t), intent(inout) :: scanner
    character(*), intent(in) :: word
    real(wp), intent(out) :: value
    real(wp) :: arguments(10)
    character(:), allocatable :: trouble
    integer :: n

    value = 0.0_wp
    n = 0
    do
      n = n + 1
      if (n > size(arguments)) call complain(scanner, word//' has more than 10 arguments')
      if (allocated(scanner%trouble)) return
      call take_sum(scanner, arguments(n))
      if (.not. take(scanner, ',')) exit
    end do
    if (allocated(scanner%trouble)) return
    if (.not. take(scanner, ')')) call complain(scanner, 'a ")" is missing after '//word)
    if (allocated(scanner%trouble)) return
    call apply_function(word, arguments(:n), value, trouble)
    if (len(trouble) > 0) call complain(scanner, trouble)
  end subroutine take_function

  !> value = value ** power where that is defined and not too large.
  pure subroutine raise_power(power, value, trouble)
    real(wp), intent(in) :: power
    real(wp), intent(inout) :: value
    character(:), allocatable, intent(out) :: trouble !! empty when all is well
    logical :: whole

    trouble = ''
    whole = abs(power) < 1.0e6_wp
    if (whole) whole = abs(power - anint(power)) <= 0.0_wp
    if (.not. abs(value) > 0.0_wp) then
      if (power < 0.0_wp) trouble = 'division by zero'
      if (abs(power) > 0.0_wp) then
        value = 0.0_wp
      else
        value = 1.0_wp
      end if
    else if (value < 0.0_wp .and. .not. whole) then
      trouble = 'a negative number to a power that is not whole'
    else if (exponent(power) > 60 .or. exponent(value) > 1000) then
      trouble = 'the value is too large'
    else if (power*log(abs(value)) > 690.0_wp) then
      trouble = 'the value is too large'
    else if (power*log(abs(value)) < -700.0_wp) then
      value = 0.0_wp
    else if (whole) then
      value = value**nint(power)
    else
      value = value**power
    end if
  end subroutine raise_power

  !> Value of a function.
  pure subroutine apply_function(word, a, value, trouble)
    character(*), intent(in) :: word
    real(wp), intent(in) :: a(:)
    real(wp), intent(out) :: value
    character(:), allocatable, intent(out) :: trouble !! empty when all is well
    logical :: inside

    trouble = ''
    value = 0.0_wp
    inside = abs(a(1)) < 1.0e15_wp
    select case (word)
    case ('MIN', 'MAX', 'MOD', 'SIGN', 'ATAN2')
      if (size(a) < 2) trouble = word//' needs two arguments'
    case default
      if (size(a) /= 1) trouble = word//' takes one argument'
    end select
    if (len(trouble) > 0) return
    select case (word)
    case ('SIN'); if (inside) value = sin(a(1))
    case ('COS'); if (inside) value = cos(a(1))
    case ('TAN'); if (inside) value = tan(a(1))
    case ('ASIN', 'ACOS')
      inside = abs(a(1)) <= 1.0_wp
      if (inside .and. word == 'ASIN') value = asin(a(1))
      if (inside .and. word == 'ACOS') value = acos(a(1))
    case ('ATAN'); value = atan(a(1)); inside = .true.
    case ('ATAN2')
      inside = abs(a(1)) > 0.0_wp .or. abs(a(2)) > 0.0_wp
      if (inside) value = atan2(a(1), a(2))
    case ('SQRT')
      inside = a(1) >= 0.0_wp
      if (inside) value = sqrt(a(1))
    case ('EXP')
      inside = a(1) <= 690.0_wp
      if (inside .and. a(1) > -700.0_wp) value = exp(a(1))
    case ('LOG', 'LOG10')
      inside = a(1) > 0.0_wp
      if (inside .and. word == 'LOG') value = log(a(1))
      if (inside .and. word == 'LOG10') value = log10(a(1))
    case ('ABS'); value = abs(a(1)); inside = .true.
    case ('INT'); if (inside) value = aint(a(1))
    case ('NINT'); if (inside) value = anint(a(1))
    case ('MOD')
      inside = abs(a(2)) > 0.0_wp .and. exponent(a(1)) - exponent(a(2)) < 52
      if (inside) value = mod(a(1), a(2))
    case ('SIGN'); value = sign(a(1), a(2)); inside = .true.
    case ('MIN'); value = minval(a); inside = .true.
    case ('MAX'); value = maxval(a); inside = .true.
    case default
      trouble = 'there is no function '//word
      return
    end select
    if (.not. inside) trouble = word//' is not defined there'
  end subroutine apply_function

end module deck_expression_m
