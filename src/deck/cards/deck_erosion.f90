! SPDX-License-Identifier: MIT
!> *MAT_ADD_EROSION.
module deck_erosion_m
  use kinds_m, only : wp
  use erosion_m, only : erosion_t
  use log_m, only : to_text
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, first_card, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of, is_blank, place_of, require_id, refuse_negative
  use deck_raw_m, only : raw_t, raw_erosion_t
  implicit none
  private
  public :: read_erosion

  !> Most integration points of an element.
  integer, parameter :: most_points = 4

contains

  !> Criteria of one material. A field that is blank, or equal to EXCL, is none.
  subroutine read_erosion(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, more, unused, rest
    type(raw_erosion_t) :: entry
    real(wp) :: none

    call first_card(deck, i_block, cursor, card)
    call require_id(deck, cursor, card, 'MID')
    call next_card(deck, cursor, 2, more)
    call next_card(deck, cursor, 3, unused)
    call next_card(deck, cursor, 4, unused)
    call next_card(deck, cursor, 5, rest)
    call check_rest(deck, cursor)
    none = real_of(card, 'EXCL')
    entry%material = integer_of(card, 'MID')
    entry%place = place_of(card, 'MID')
    call take_first(deck, cursor, card, none, entry%erosion)
    call take_second(deck, cursor, more, none, entry%erosion)
    call refuse_negative(deck, cursor, rest, 'DTMIN')
    if (real_of(rest, 'DTMIN') > 0.0_wp) entry%erosion%least_step = real_of(rest, 'DTMIN')
    call take_counts(deck, cursor, card, entry%erosion)
    raw%n_erosion = raw%n_erosion + 1
    raw%erosions(raw%n_erosion) = entry
  end subroutine read_erosion

  !> Whether a field gives a criterion.
  function is_given(card, name, none) result(given)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    real(wp), intent(in) :: none !! EXCL
    logical :: given

    given = .not. is_blank(card, name) .and. abs(real_of(card, name) - none) > 0.0_wp
  end function is_given

  !> A criterion that is above 0.
  subroutine take_positive(deck, cursor, card, name, none, value, n_given)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    real(wp), intent(in) :: none
    real(wp), intent(inout) :: value
    integer, intent(inout) :: n_given

    if (.not. is_given(card, name, none)) return
    n_given = n_given + 1
    if (real_of(card, name) > 0.0_wp) then
      value = real_of(card, name)
    else
      call report_field(deck, cursor, card, name, 'is not a limit of this version (more than 0; ' &
        //'below 0 it would be a curve)')
    end if
  end subroutine take_positive

  !> A criterion of either sign.
  subroutine take_any(card, name, none, value, n_given)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    real(wp), intent(in) :: none
    real(wp), intent(inout) :: value
    integer, intent(inout) :: n_given

    if (.not. is_given(card, name, none)) return
    n_given = n_given + 1
    value = real_of(card, name)
  end subroutine take_any

  !> Card 1.
  subroutine take_first(deck, cursor, card, none, erosion)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    real(wp), intent(in) :: none
    type(erosion_t), intent(inout) :: erosion

    associate (n => erosion%n_given)
      call take_any(card, 'MXPRES', none, erosion%most_pressure, n)
      call take_any(card, 'MNEPS', none, erosion%least_strain, n)
      call take_positive(deck, cursor, card, 'EFFEPS', none, erosion%effective_strain, n)
      if (.not. is_given(card, 'VOLEPS', none)) return
      n = n + 1
      if (real_of(card, 'VOLEPS') > 0.0_wp) erosion%most_volume = real_of(card, 'VOLEPS')
      if (real_of(card, 'VOLEPS') < 0.0_wp) erosion%least_volume = real_of(card, 'VOLEPS')
      if (.not. abs(real_of(card, 'VOLEPS')) > 0.0_wp) call report_field(deck, cursor, card, &
        'VOLEPS', 'is no volumetric strain at failure (more than 0 in tension, less than 0 in ' &
        //'compression)')
    end associate
  end subroutine take_first

  !> Card 2.
  subroutine take_second(deck, cursor, card, none, erosion)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    real(wp), intent(in) :: none
    type(erosion_t), intent(inout) :: erosion

    associate (n => erosion%n_given)
      call take_any(card, 'MNPRES', none, erosion%least_pressure, n)
      call take_positive(deck, cursor, card, 'SIGP1', none, erosion%principal_stress, n)
      call take_positive(deck, cursor, card, 'SIGVM', none, erosion%mises, n)
      call take_positive(deck, cursor, card, 'MXEPS', none, erosion%most_strain, n)
      call take_positive(deck, cursor, card, 'EPSSH', none, erosion%shear_strain, n)
      call take_positive(deck, cursor, card, 'IMPULSE', none, erosion%impulse, n)
      call take_positive(deck, cursor, card, 'FAILTM', none, erosion%time, n)
    end associate
    if (.not. is_given(card, 'SIGTH', none)) return
    call refuse_negative(deck, cursor, card, 'SIGTH')
    erosion%threshold = max(0.0_wp, real_of(card, 'SIGTH'))
    if (.not. is_given(card, 'IMPULSE', none)) call report_field(deck, cursor, card, 'SIGTH', &
      'is a threshold without the impulse IMPULSE that it belongs to')
  end subroutine take_second

  !> NUMFIP and NCS.
  subroutine take_counts(deck, cursor, card, erosion)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(erosion_t), intent(inout) :: erosion
    real(wp) :: points, criteria

    points = real_of(card, 'NUMFIP')
    criteria = real_of(card, 'NCS')
    if (.not. (points >= 0.0_wp .and. points <= most_points)) then
      call report_field(deck, cursor, card, 'NUMFIP', 'is not a number of points of an element ' &
        //'(1 to '//to_text(most_points)//')')
    else
      erosion%n_point = max(1, nint(points))
    end if
    if (erosion%n_given == 0 .and. .not. erosion%least_step > 0.0_wp) then
      call report_field(deck, cursor, card, 'MID', 'gets no criterion: all of them are blank or ' &
        //'EXCL')
    else if (.not. (criteria >= 0.0_wp .and. criteria <= max(1, erosion%n_given))) then
      call report_field(deck, cursor, card, 'NCS', 'is not a number of criteria that may hold at ' &
        //'once (1 to '//to_text(max(1, erosion%n_given))//', which are given)')
    else
      erosion%n_criteria = max(1, nint(criteria))
    end if
  end subroutine take_counts

end module deck_erosion_m
