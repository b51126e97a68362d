! SPDX-License-Identifier: MIT
!> *EOS_LINEAR_POLYNOMIAL and *EOS_GRUNEISEN.
module deck_eos_m
  use kinds_m, only : wp
  use eos_m, only : eos_t, eos_linear_polynomial, eos_gruneisen
  use deck_lines_m, only : deck_t
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, first_card, next_card, check_rest, report_field
  use deck_values_m, only : integer_of, real_of, reals_of, is_bad, require_id, refuse_large, &
    refuse_negative
  use deck_raw_m, only : raw_t
  implicit none
  private
  public :: read_linear_polynomial, read_gruneisen

  !> Largest pressure and energy, speed, and pure number that constants may be: below them squares
  !> and cubes stay numbers in any units, and no material is anywhere near.
  real(wp), parameter :: most_pressure = 1.0e30_wp, most_speed = 1.0e12_wp, most_number = 100.0_wp

contains

  !> *EOS_LINEAR_POLYNOMIAL.
  subroutine read_linear_polynomial(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, start
    type(eos_t) :: eos
    integer :: k

    call read_cards(deck, i_block, cursor, card, start)
    do k = 0, 6
      call refuse_large(deck, cursor, card, 'C'//achar(iachar('0') + k), merge(most_pressure, &
        most_number, k < 4))
    end do
    eos%kind = eos_linear_polynomial
    eos%c = reals_of(card, 'C0', 'C6')
    eos%energy = real_of(start, 'E0')
    call refuse_large(deck, cursor, start, 'E0', most_pressure)
    call append_eos(deck, cursor, card, eos, raw)
  end subroutine read_linear_polynomial

  !> *EOS_GRUNEISEN.
  subroutine read_gruneisen(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, start
    type(eos_t) :: eos
    character(5), parameter :: numbers(5) = [character(5) :: 'S1', 'S2', 'S3', 'GAMAO', 'A']
    integer :: k

    call read_cards(deck, i_block, cursor, card, start)
    if (.not. real_of(card, 'C') > 0.0_wp) call report_field(deck, cursor, card, 'C', &
      'is not a speed (more than 0): shocks of no strength run with it')
    call refuse_large(deck, cursor, card, 'C', most_speed)
    call refuse_negative(deck, cursor, card, 'GAMAO')
    do k = 1, size(numbers)
      call refuse_large(deck, cursor, card, trim(numbers(k)), most_number)
    end do
    call refuse_large(deck, cursor, card, 'E0', most_pressure)
    eos%kind = eos_gruneisen
    eos%speed = real_of(card, 'C')
    eos%s = reals_of(card, 'S1', 'S3')
    eos%gamma = real_of(card, 'GAMAO')
    eos%correction = real_of(card, 'A')
    eos%energy = real_of(card, 'E0')
    call append_eos(deck, cursor, card, eos, raw)
  end subroutine read_gruneisen

  !> The two cards that both have: EOSID on the first and V0 on the second. Bodies start with the
  !> density of their material.
  subroutine read_cards(deck, i_block, cursor, card, start)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(cursor_t), intent(out) :: cursor
    type(card_t), intent(out) :: card, start

    call first_card(deck, i_block, cursor, card)
    call require_id(deck, cursor, card, 'EOSID')
    call next_card(deck, cursor, 2, start)
    if (abs(real_of(start, 'V0') - 1.0_wp) > 0.0_wp) call report_field(deck, cursor, start, &
      'V0', 'is a volume at the start that is not that of the density RO, which this version ' &
      //'does not have (0 or 1)')
  end subroutine read_cards

  !> One more equation of state.
  subroutine append_eos(deck, cursor, card, eos, raw)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(inout) :: cursor
    type(card_t), intent(in) :: card
    type(eos_t), intent(inout) :: eos
    type(raw_t), intent(inout) :: raw

    call check_rest(deck, cursor)
    if (is_bad(card, 'EOSID')) raw%lost%equations = .true.
    if (is_bad(card, 'EOSID')) return
    eos%id = integer_of(card, 'EOSID')
    raw%n_equation = raw%n_equation + 1
    raw%equations(raw%n_equation) = eos
    raw%equation_line(raw%n_equation) = card%line
  end subroutine append_eos

end module deck_eos_m
