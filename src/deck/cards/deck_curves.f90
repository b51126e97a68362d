! SPDX-License-Identifier: MIT
!> *DEFINE_CURVE, *DEFINE_TABLE and *DEFINE_COORDINATE_SYSTEM (axes in the plane).
module deck_curves_m
  use kinds_m, only : wp
  use curves_m, only : curve_t
  use deck_ids_m, only : a_curve, a_table
  use deck_maps_m, only : lose
  use deck_lines_m, only : deck_t, line_error
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, first_card, next_row, report_field, find_field, next_card, &
    check_rest
  use deck_values_m, only : integer_of, real_of, reals_of, is_bad, require_id, refuse_outside
  use deck_raw_m, only : raw_t, raw_table_t, raw_system_t
  implicit none
  private
  public :: read_curve, read_table, read_system

contains

  !> *DEFINE_CURVE: points, then scale factors and offsets applied, x = SFA*(x + OFFA).
  subroutine read_curve(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: head
    type(curve_t) :: curve
    real(wp), allocatable :: points(:, :)
    real(wp) :: scale(2)

    call read_head(deck, i_block, ['LCID', 'SFA '], 'is negative: it would turn the curve round', &
      cursor, head)
    scale = reals_of(head, 'SFA', 'SFO')
    scale(1) = abs(scale(1)) ! a negative one has been refused
    call refuse_outside(deck, cursor, head, 'SIDR', 0, 2, &
      'is not a phase (0 run, 1 dynamic relaxation, 2 both)')
    curve%phase = integer_of(head, 'SIDR')
    call read_rows(deck, ['A1', 'O1'], scale, reals_of(head, 'OFFA', 'OFFO'), &
      'is not beyond the point before it: abscissas must increase', cursor, points)
    if (size(points, 2) == 0) call line_error(deck, head%line, 'the curve has no points')
    if (is_bad(head, 'LCID')) call lose(deck, [a_curve])
    if (is_bad(head, 'LCID')) return
    if (size(points, 2) == 0) points = reshape([0.0_wp, 0.0_wp], [2, 1])
    curve%id = integer_of(head, 'LCID')
    curve%abscissa = points(1, :)
    curve%ordinate = points(2, :)
    raw%n_curve = raw%n_curve + 1
    raw%curves(raw%n_curve) = curve
    raw%curve_line(raw%n_curve) = head%line
  end subroutine read_curve

  !> *DEFINE_TABLE: a number, and a value for each of the curves that come next.
  subroutine read_table(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: head
    type(raw_table_t) :: table
    real(wp), allocatable :: values(:, :)
    real(wp) :: scale

    call read_head(deck, i_block, ['TBID', 'SFA '], 'is negative: it would turn the table round', &
      cursor, head)
    scale = abs(real_of(head, 'SFA')) ! a negative one has been refused
    call read_rows(deck, ['VALUE'], [scale], [real_of(head, 'OFFA')], &
      'is not beyond the value before it: the values of a table must increase', cursor, values)
    if (size(values, 2) == 0) call line_error(deck, head%line, 'the table has no values')
    if (is_bad(head, 'TBID')) call lose(deck, [a_table])
    if (is_bad(head, 'TBID')) return
    table = raw_table_t(integer_of(head, 'TBID'), head%line, i_block, values(1, :))
    raw%n_table = raw%n_table + 1
    raw%tables(raw%n_table) = table
  end subroutine read_table

  !> The first card: the number, and the scale factor of what must increase.
  subroutine read_head(deck, i_block, names, negative, cursor, head)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    character(*), intent(in) :: names(2)    !! of the number and of the factor
    character(*), intent(in) :: negative    !! what to say of a factor below 0
    type(cursor_t), intent(out) :: cursor
    type(card_t), intent(out) :: head

    call first_card(deck, i_block, cursor, head)
    call require_id(deck, cursor, head, names(1))
    if (real_of(head, names(2)) < 0.0_wp) call report_field(deck, cursor, head, names(2), negative)
  end subroutine read_head

  !> The rows behind it, scale*(value + offset) in each column; the first column must increase.
  subroutine read_rows(deck, names, scale, offset, not_beyond, cursor, rows)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: names(:)               !! (n_column) fields of a row
    real(wp), intent(in) :: scale(:), offset(:)        !! (n_column)
    character(*), intent(in) :: not_beyond             !! what to say where it does not
    type(cursor_t), intent(inout) :: cursor
    real(wp), allocatable, intent(out) :: rows(:, :)   !! (n_column, n_row)
    type(card_t) :: card
    real(wp) :: last
    logical :: found, is_sound
    integer :: i, n, columns(size(names))

    columns = [(find_field(cursor, 2, names(i)), i=1, size(names))]
    allocate (rows(size(scale), max(cursor%last - cursor%line + 1, 0)))
    n = 0
    last = -huge(1.0_wp)
    is_sound = .true.
    do
      call next_row(deck, cursor, 2, card, found)
      if (.not. found) exit
      n = n + 1
      rows(:, n) = scale*(card%r(columns) + offset)
      is_sound = is_sound .and. .not. card%bad(columns(1))
      if (card%bad(columns(1))) cycle
      if (rows(1, n) <= last) call report_field(deck, cursor, card, columns(1), not_beyond)
      is_sound = is_sound .and. rows(1, n) > last
      last = rows(1, n)
    end do
    rows = rows(:, :n)
    ! What has been refused is looked at further, with values that at least increase.
    if (.not. is_sound) rows(1, :) = [(real(i, wp), i=0, n - 1)]
  end subroutine read_rows

  !> The x axis goes from the origin to the point L; the point P is on the side of the y axis.
  subroutine read_system(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    character(*), parameter :: leaves = 'takes the axes out of the plane of the model'
    type(cursor_t) :: cursor
    type(card_t) :: cards(2)
    type(raw_system_t) :: system
    real(wp) :: origin(2), to_p(2), across
    logical :: in_plane

    call first_card(deck, i_block, cursor, cards(1))
    call next_card(deck, cursor, 2, cards(2))
    call check_rest(deck, cursor)
    call require_id(deck, cursor, cards(1), 'CID')
    if (is_bad(cards(1), 'CID')) call lose(deck, [a_curve])
    if (is_bad(cards(1), 'CID')) return
    system%id = integer_of(cards(1), 'CID')
    system%line = cards(1)%line
    in_plane = .not. abs(real_of(cards(1), 'ZL') - real_of(cards(1), 'ZO')) > 0.0_wp
    if (.not. in_plane) call report_field(deck, cursor, cards(1), 'ZL', leaves)
    if (abs(real_of(cards(2), 'ZP') - real_of(cards(1), 'ZO')) > 0.0_wp) &
      call report_field(deck, cursor, cards(2), 'ZP', leaves)
    origin = reals_of(cards(1), 'XO', 'YO')
    system%axes(:, 1) = reals_of(cards(1), 'XL', 'YL') - origin
    to_p = reals_of(cards(2), 'XP', 'YP') - origin
    across = system%axes(1, 1)*to_p(2) - system%axes(2, 1)*to_p(1)
    if (.not. norm2(system%axes(:, 1)) > 0.0_wp) then
      if (in_plane) call report_field(deck, cursor, cards(1), 'XL', &
        ': the point on the x axis is the origin')
      system%axes(:, 1) = [1.0_wp, 0.0_wp]
    else if (.not. abs(across) > 0.0_wp) then
      call report_field(deck, cursor, cards(2), 'XP', &
        ': the point in the plane of the axes lies on the x axis')
    end if
    system%axes(:, 1) = system%axes(:, 1)/norm2(system%axes(:, 1))
    system%axes(:, 2) = sign(1.0_wp, across)*[-system%axes(2, 1), system%axes(1, 1)]
    raw%n_system = raw%n_system + 1
    raw%systems(raw%n_system) = system
  end subroutine read_system

end module deck_curves_m
