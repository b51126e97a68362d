! SPDX-License-Identifier: MIT
!> *DEFINE_CURVE, *DEFINE_CURVE_FUNCTION, *DEFINE_TABLE and *DEFINE_COORDINATE_SYSTEM (axes in the
!> plane).
module deck_curves_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use curves_m, only : curve_t
  use model_m, only : model_t
  use deck_ids_m, only : a_curve, a_table, a_system, index_of
  use deck_lines_m, only : deck_t, blocks_of, line_error
  use deck_fields_m, only : field_number, card_t
  use deck_cards_m, only : cursor_t, first_card, next_row, report_field, next_card, &
    check_rest
  use deck_functions_m, only : read_function
  use deck_values_m, only : integer_of, real_of, reals_of, define, map_defined
  implicit none
  private
  public :: table_t, read_curves, read_systems

  !> One *DEFINE_TABLE: its values, and the first and last of its curves, which follow it in the
  !> deck. The last is less than the first where curves are missing.
  type :: table_t
    real(wp), allocatable :: values(:)
    integer :: curves(2) = [1, 0]
  end type table_t

contains

  !> Read all curves and tables, with scale factors and offsets applied: x = SFA*(x + OFFA).
  subroutine read_curves(deck, model, tables)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(table_t), allocatable, intent(out) :: tables(:)
    type(curve_t), allocatable :: curves(:)
    type(cursor_t) :: cursor
    type(card_t) :: head
    real(wp), allocatable :: points(:, :)
    real(wp) :: scale(2)
    integer, allocatable :: blocks(:)
    integer :: of_block(deck%n_block), i, n

    blocks = blocks_of(deck, 'DEFINE_CURVE')
    allocate (curves(size(blocks)))
    of_block = 0
    do i = 1, size(blocks)
      call first_card(deck, blocks(i), cursor, head)
      call define(deck, a_curve, head, n)
      of_block(blocks(i)) = n
      if (deck%blocks(blocks(i))%name == 'DEFINE_CURVE') then
        scale = reals_of(head, 'SFA', 'SFO')
        scale(1) = abs(scale(1)) ! a negative one has been refused
        call read_rows(deck, ['A1', 'O1'], scale, reals_of(head, 'OFFA', 'OFFO'), &
          'is not beyond the point before it: abscissas must increase', cursor, points)
        if (size(points, 2) == 0) call line_error(deck, head%line, 'the curve has no points')
      else
        call read_function(deck, cursor, head, points)
      end if
      if (size(points, 2) == 0) points = reshape([0.0_wp, 0.0_wp], [2, 1])
      if (n == 0) cycle
      curves(n)%phase = integer_of(head, 'SIDR')
      curves(n)%is_function = deck%blocks(blocks(i))%name == 'DEFINE_CURVE_FUNCTION'
      curves(n)%id = integer_of(head, 'LCID')
      curves(n)%abscissa = points(1, :)
      curves(n)%ordinate = points(2, :)
    end do
    model%curves = curves(:deck%maps(a_curve)%n)
    call map_defined(deck, a_curve, 'LCID')
    call read_tables(deck, of_block, tables)
  end subroutine read_curves

  !> *DEFINE_TABLE: a number, and a value for each of the next curves.
  subroutine read_tables(deck, of_block, tables)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: of_block(:)   !! curve of each block, 0 for none
    type(table_t), allocatable, intent(out) :: tables(:)
    type(cursor_t) :: cursor
    type(card_t) :: head
    real(wp), allocatable :: values(:, :)
    integer, allocatable :: blocks(:)
    integer :: i, k, m, n

    blocks = blocks_of(deck, 'DEFINE_TABLE')
    allocate (tables(size(blocks)))
    do i = 1, size(blocks)
      call first_card(deck, blocks(i), cursor, head)
      call read_rows(deck, ['VALUE'], [abs(real_of(head, 'SFA'))], [real_of(head, 'OFFA')], &
        'is not beyond the value before it: the values of a table must increase', cursor, values)
      if (size(values, 2) == 0) call line_error(deck, head%line, 'the table has no values')
      call define(deck, a_table, head, n)
      if (n == 0) cycle
      tables(n)%values = values(1, :)
      if (index_of(deck%maps(a_curve), integer_of(head, 'TBID')) > 0) call &
        report_field(deck, head, 'TBID', 'is the number of a curve too')
      ! Its curves are the next blocks.
      associate (table => tables(n), n_value => size(tables(n)%values))
        m = 0
        do k = blocks(i) + 1, deck%n_block
          if (m == n_value) exit
          if (deck%blocks(k)%dropped) cycle
          if (deck%blocks(k)%name /= 'DEFINE_CURVE') exit
          m = m + 1
          if (of_block(k) == 0) exit ! its error has been reported
          if (m == 1) table%curves(1) = of_block(k)
          if (m == n_value) table%curves(2) = of_block(k)
        end do
        if (m < n_value .and. .not. deck%maps(a_curve)%has_refused) call line_error(deck, &
          head%line, &
          'table '//to_text(integer_of(head, 'TBID'))//' has '//to_text(n_value)//' values but ' &
          //to_text(m)//' *DEFINE_CURVE right after it; it needs one for each value, in this order')
      end associate
    end do
    call map_defined(deck, a_table, 'TBID')
  end subroutine read_tables

  !> Read the rows of a curve or table, scale*(value + offset) in each column; the first column must
  !> increase.
  subroutine read_rows(deck, names, scale, offset, not_beyond, cursor, rows)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: names(:)               !! (n_column) fields of a row
    real(wp), intent(in) :: scale(:), offset(:)        !! (n_column)
    character(*), intent(in) :: not_beyond             !! message where it does not
    type(cursor_t), intent(inout) :: cursor
    real(wp), allocatable, intent(out) :: rows(:, :)   !! (n_column, n_row)
    type(card_t) :: card
    real(wp) :: last
    logical :: is_sound
    integer :: i, n, columns(size(names))

    columns = [(field_number(cursor%specs(2)%names, names(i)), i=1, size(names))]
    allocate (rows(size(scale), max(cursor%last - cursor%line + 1, 0)))
    n = 0
    last = -huge(1.0_wp)
    is_sound = .true.
    do while (next_row(deck, cursor, 2, card))
      n = n + 1
      rows(:, n) = scale*(card%r(columns) + offset)
      is_sound = is_sound .and. .not. card%bad(columns(1))
      if (card%bad(columns(1))) cycle
      if (rows(1, n) <= last) call report_field(deck, card, columns(1), not_beyond)
      is_sound = is_sound .and. rows(1, n) > last
      last = rows(1, n)
    end do
    rows = rows(:, :n)
    ! Refused rows are checked further with increasing values.
    if (.not. is_sound) rows(1, :) = [(real(i, wp), i=0, n - 1)]
  end subroutine read_rows

  !> *DEFINE_COORDINATE_SYSTEM: the x axis points from the origin to point L; point P is on the side
  !> of the y axis.
  subroutine read_systems(deck)
    type(deck_t), intent(inout) :: deck
    character(*), parameter :: out_of_plane = 'tilts the axes out of the plane of the model'
    type(cursor_t) :: cursor
    type(card_t) :: card, more
    integer, allocatable :: blocks(:)
    real(wp) :: origin(2), to_l(2), to_p(2), across
    integer :: i, n

    blocks = blocks_of(deck, 'DEFINE_COORDINATE_SYSTEM')
    allocate (deck%axes(2, 2, size(blocks)))
    do i = 1, size(blocks)
      call first_card(deck, blocks(i), cursor, card)
      call next_card(deck, cursor, 2, more)
      call check_rest(deck, cursor)
      call define(deck, a_system, card, n)
      if (n == 0) cycle
      if (abs(real_of(more, 'ZP') - real_of(card, 'ZO')) > 0.0_wp) &
        call report_field(deck, more, 'ZP', out_of_plane)
      origin = reals_of(card, 'XO', 'YO')
      to_l = reals_of(card, 'XL', 'YL') - origin
      to_p = reals_of(more, 'XP', 'YP') - origin
      across = to_l(1)*to_p(2) - to_l(2)*to_p(1)
      if (abs(real_of(card, 'ZL') - real_of(card, 'ZO')) > 0.0_wp) then
        call report_field(deck, card, 'ZL', out_of_plane)
      else if (.not. norm2(to_l) > 0.0_wp) then
        call report_field(deck, card, 'XL', ': the point on the x axis is the origin')
      else if (.not. abs(across) > 0.0_wp) then
        call report_field(deck, more, 'XP', &
          ': the point on the side of the y axis lies on the x axis')
      end if
      if (norm2(to_l) > 0.0_wp) to_l = to_l/norm2(to_l)
      deck%axes(:, 1, n) = to_l
      deck%axes(:, 2, n) = sign(1.0_wp, across)*[-to_l(2), to_l(1)]
    end do
    call map_defined(deck, a_system, 'CID')
  end subroutine read_systems

end module deck_curves_m
