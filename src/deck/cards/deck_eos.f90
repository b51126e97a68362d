! SPDX-License-Identifier: MIT
!> *EOS_LINEAR_POLYNOMIAL and *EOS_GRUNEISEN.
module deck_eos_m
  use kinds_m, only : wp
  use eos_m, only : eos_t, eos_linear_polynomial, eos_gruneisen
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_parameter_table_m, only : parameters_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of, reals_of, is_bad
  use deck_checks_m, only : require_id, refuse_negative
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: read_linear_polynomial, read_gruneisen

contains

  !> *EOS_LINEAR_POLYNOMIAL.
  subroutine read_linear_polynomial(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, start
    type(eos_t) :: eos

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, parameters, cursor, 1, card)
    call require_id(deck, cursor, card, 'EOSID')
    eos%kind = eos_linear_polynomial
    eos%id = integer_of(card, 'EOSID')
    eos%c = reals_of(card, 'C0', 'C6')
    call next_card(deck, parameters, cursor, 2, start)
    eos%energy = real_of(start, 'E0')
    call check_start(deck, cursor, start)
    call append_eos(raw, eos, card)
    call check_rest(deck, cursor)
  end subroutine read_linear_polynomial

  !> *EOS_GRUNEISEN.
  subroutine read_gruneisen(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, start
    type(eos_t) :: eos

    call open_cursor(deck, i_block, cursor)
    call skip_title(deck, cursor)
    call next_card(deck, parameters, cursor, 1, card)
    call require_id(deck, cursor, card, 'EOSID')
    if (.not. real_of(card, 'C') > 0.0_wp) call report_field(deck, cursor, card, 'C', &
      'is not a speed (more than 0): shocks of no strength run with it')
    call refuse_negative(deck, cursor, card, 'GAMAO')
    eos%kind = eos_gruneisen
    eos%id = integer_of(card, 'EOSID')
    eos%speed = real_of(card, 'C')
    eos%s = reals_of(card, 'S1', 'S3')
    eos%gamma = real_of(card, 'GAMAO')
    eos%correction = real_of(card, 'A')
    eos%energy = real_of(card, 'E0')
    call next_card(deck, parameters, cursor, 2, start)
    call check_start(deck, cursor, start)
    call append_eos(raw, eos, card)
    call check_rest(deck, cursor)
  end subroutine read_gruneisen

  !> V0: bodies start with the density of their material.
  subroutine check_start(deck, cursor, card)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card

    if (abs(real_of(card, 'V0')) > 0.0_wp .and. abs(real_of(card, 'V0') - 1.0_wp) > 0.0_wp) &
      call report_field(deck, cursor, card, 'V0', 'is a volume at the start that is not that of ' &
      //'the density RO, which this version does not have (0 or 1)')
  end subroutine check_start

  !> One more equation of state.
  subroutine append_eos(raw, eos, card)
    type(raw_t), intent(inout) :: raw
    type(eos_t), intent(in) :: eos
    type(card_t), intent(in) :: card

    if (is_bad(card, 'EOSID')) raw%lost%equations = .true.
    if (is_bad(card, 'EOSID')) return
    raw%equations = [raw%equations, eos]
    raw%equation_line = [raw%equation_line, card%line]
  end subroutine append_eos

end module deck_eos_m
