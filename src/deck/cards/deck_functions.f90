! SPDX-License-Identifier: MIT
!> *DEFINE_CURVE_FUNCTION: a function of TIME, which becomes a curve of many points.
module deck_functions_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use text_m, only : upper_case
  use deck_cards_m, only : cursor_t, first_card
  use deck_expression_m, only : evaluate
  use deck_fields_m, only : card_t
  use deck_ids_m, only : a_curve
  use deck_lines_m, only : deck_t, blocks_of, line_error, line_text, replace_line
  use deck_parameter_table_m, only : find_parameter
  use deck_report_m, only : report_t
  use deck_values_m, only : real_of
  implicit none
  private
  public :: read_function, check_functions

  !> Largest difference from the function as part of its largest value, shortest interval as part of
  !> the end time (at kinks and jumps), and largest number of points.
  real(wp), parameter :: tolerance = 1.0e-6_wp, shortest = 1.0e-10_wp
  integer, parameter :: most_points = 1000000
  !> Intervals to begin with: no feature longer than two of them is missed. A prime number, so that
  !> they are in step with no period.
  integer, parameter :: n_first = 10007
  !> Positions in an interval at which it is compared with a straight line, besides the middle.
  real(wp), parameter :: compared(2) = [0.38_wp, 0.71_wp]

contains

  !> Read the lines of the expression, and sample it from time 0 to the end time.
  subroutine read_function(deck, cursor, head, points)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(in) :: head
    real(wp), allocatable, intent(out) :: points(:, :) !! (2, n), none where there is an error
    character(:), allocatable :: text, line, message
    real(wp) :: end_time

    text = ''
    do while (cursor%line <= cursor%last)
      line = with_values(deck, line_text(deck, cursor%line), cursor%source)
      ! The deck as run has no parameters.
      if (line /= line_text(deck, cursor%line)) call replace_line(deck, cursor%line, line)
      cursor%line = cursor%line + 1
      text = text//line
    end do
    allocate (points(2, 0))
    if (len_trim(text) == 0) call line_error(deck, head%line, 'the function is missing')
    if (len_trim(text) == 0) return
    end_time = end_time_of(deck)
    if (end_time > 0.0_wp) call sample(deck, text, cursor%source, end_time, points, message)
    if (.not. allocated(message)) return
    call line_error(deck, min(head%line + 1, cursor%last), 'the function cannot be computed: ' &
      //message)
    points = reshape([0.0_wp, 0.0_wp], [2, 1])
  end subroutine read_function

  !> The text with the values of parameters for their names.
  function with_values(deck, text, source) result(resolved)
    type(deck_t), intent(in) :: deck
    character(*), intent(in) :: text
    integer, intent(in) :: source
    character(:), allocatable :: resolved
    character(*), parameter :: digits = '0123456789.', letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZ_'
    character(len(text) + 1) :: upper
    integer :: at, i, n

    upper = upper_case(text)//' '
    resolved = ''
    at = 1
    do while (at <= len(text))
      n = max(verify(upper(at:), letters//digits) - 1, 1)
      if (scan(upper(at:at), digits) == 1) then
        ! A number: digits, letter, sign and digits of an exponent.
        n = verify(upper(at:), digits) - 1
        if (scan(upper(at + n:at + n), 'ED') == 1) then
          n = n + 1
          if (scan(upper(at + n:at + n), '+-') == 1) n = n + 1
          n = n + verify(upper(at + n:)//' ', digits) - 1
        end if
      end if
      i = 0
      if (upper(at:at + n - 1) /= 'TIME') i = find_parameter(deck%parameters, &
        upper(at:at + n - 1), source, .true.)
      if (i > 0) then
        if (len(resolved) > 0) resolved = resolved(:len(resolved) - merge(1, 0, &
          resolved(len(resolved):) == '&'))
        resolved = resolved//'('//deck%parameters%items(i)%text//')'
      else
        resolved = resolved//text(at:at + n - 1)
      end if
      at = at + n
    end do
  end function with_values

  !> Points between which the function differs from a straight line by the tolerance at most, found
  !> by halving intervals.
  subroutine sample(deck, text, source, end_time, points, message)
    type(deck_t), intent(in) :: deck
    character(*), intent(in) :: text
    integer, intent(in) :: source
    real(wp), intent(in) :: end_time
    real(wp), allocatable, intent(inout) :: points(:, :)
    character(:), allocatable, intent(out) :: message
    real(wp), allocatable :: middle(:, :), merged(:, :)
    logical, allocatable :: is_open(:), next_open(:)  !! intervals to be halved further
    real(wp) :: largest
    integer :: i, n

    points = reshape([(i*end_time/n_first, 0.0_wp, i=0, n_first)], [2, n_first + 1])
    do i = 1, n_first + 1
      call value_at(points(:, i))
    end do
    allocate (is_open(n_first), source=.true.)
    do while (any(is_open) .and. .not. allocated(message))
      if (size(points, 2) + count(is_open) > most_points) message = 'it needs more than ' &
        //to_text(most_points)//' points up to the end time '//to_text(end_time)
      if (allocated(message)) return
      largest = maxval(abs(points(2, :)))
      allocate (middle(2, size(is_open)), merged(2, size(points, 2) + count(is_open)))
      allocate (next_open(size(merged, 2) - 1), source=.false.)
      n = 0
      do i = 1, size(is_open)
        n = n + 1
        merged(:, n) = points(:, i)
        if (.not. is_open(i)) cycle
        middle(:, i) = 0.5_wp*(points(:, i) + points(:, i + 1))
        n = n + 1
        merged(1, n) = middle(1, i)
        call value_at(merged(:, n))
        if (middle(1, i) - points(1, i) > shortest*end_time) &
          next_open(n - 1:n) = bends(points(:, i), points(:, i + 1), merged(2, n))
      end do
      merged(:, n + 1) = points(:, size(points, 2))
      call move_alloc(merged, points)
      call move_alloc(next_open, is_open)
      deallocate (middle)
    end do

  contains

    !> Whether the function between two points is not the straight line.
    logical function bends(first, last, middle)
      real(wp), intent(in) :: first(2), last(2)
      real(wp), intent(in) :: middle !! value in the middle
      real(wp) :: point(2)
      integer :: k

      bends = abs(middle - 0.5_wp*(first(2) + last(2))) > tolerance*max(largest, abs(middle))
      do k = 1, size(compared)
        if (bends) return
        point = first + compared(k)*(last - first)
        call value_at(point)
        bends = abs(point(2) - (first(2) + compared(k)*(last(2) - first(2)))) &
          > tolerance*max(largest, abs(point(2)))
      end do
    end function bends

    !> Evaluate the function at the abscissa of a point.
    subroutine value_at(point)
      real(wp), intent(inout) :: point(2)
      character(:), allocatable :: reason

      call evaluate(text, deck%parameters, source, point(2), reason, point(1))
      if (allocated(reason) .and. .not. allocated(message)) message = reason//' (at TIME ' &
        //to_text(point(1))//')'
    end subroutine value_at

  end subroutine sample

  !> ENDTIM, whose errors are reported when the card is read for the run; 0 where there is none.
  function end_time_of(deck) result(end_time)
    type(deck_t), intent(inout) :: deck
    real(wp) :: end_time
    type(report_t) :: report
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer, allocatable :: blocks(:)

    end_time = 0.0_wp
    blocks = blocks_of(deck, 'CONTROL_TERMINATION')
    if (size(blocks) == 0) return
    report = deck%report
    call first_card(deck, blocks(size(blocks)), cursor, card)
    deck%report = report
    if (.not. any(card%bad)) end_time = real_of(card, 'ENDTIM')
  end function end_time_of

  !> Report functions of time as curves of materials.
  subroutine check_functions(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(in) :: model
    integer :: i

    do i = 1, size(model%curves)
      associate (curve => model%curves(i))
        if (curve%is_function .and. .not. curve%is_of_time) call line_error(deck, &
          deck%maps(a_curve)%lines(i), 'a material uses this function of TIME; give it a ' &
          //'*DEFINE_CURVE')
      end associate
    end do
  end subroutine check_functions

end module deck_functions_m
