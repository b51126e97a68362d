! SPDX-License-Identifier: MIT
!> *DATABASE_ cards: what is written and how often.
module deck_output_m
  use kinds_m, only : wp
  use deck_lines_m, only : deck_t, place_t
  use deck_fields_m, only : card_t
  use deck_parameter_table_m, only : parameters_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, check_rest, report_field
  use deck_raw_m, only : raw_t, history_t, output_plot, output_glstat, output_matsum, &
    output_rcforc, output_nodout, output_rwforc, output_sleout, output_spcforc
  implicit none
  private
  public :: read_database

  !> Most cycles between two restart files.
  real(wp), parameter :: most_cycles = 2.0e9_wp

contains

  !> One *DATABASE_ keyword with an interval.
  subroutine read_database(deck, parameters, i_block, raw)
    type(deck_t), intent(inout) :: deck
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, rest
    type(history_t) :: history
    integer :: k_curve, file, k

    call open_cursor(deck, i_block, cursor)
    call next_card(deck, parameters, cursor, 1, card)
    do k = 2, cursor%n_card
      call next_card(deck, parameters, cursor, k, rest)
    end do
    call check_rest(deck, cursor)
    select case (deck%blocks(i_block)%name)
    case ('DATABASE_BINARY_D3PLOT')
      file = output_plot
    case ('DATABASE_BINARY_D3DUMP')
      call take_cycles(deck, cursor, card, raw%controls%output%dump_cycles)
      return
    case ('DATABASE_BINARY_RUNRSF')
      call take_cycles(deck, cursor, card, raw%controls%output%running_cycles)
      return
    case ('DATABASE_GLSTAT')
      file = output_glstat
    case ('DATABASE_MATSUM')
      file = output_matsum
    case ('DATABASE_RCFORC')
      file = output_rcforc
    case ('DATABASE_RWFORC')
      file = output_rwforc
    case ('DATABASE_SLEOUT')
      file = output_sleout
    case ('DATABASE_SPCFORC')
      file = output_spcforc
    case default
      file = output_nodout
    end select
    k_curve = merge(2, 3, file == output_plot)
    if (card%r(1) < 0.0_wp) call report_field(deck, cursor, card, 1, 'is negative')
    if (card%i(k_curve) < 0) call report_field(deck, cursor, card, k_curve, 'is not a curve number')
    history%dt = card%r(1)
    history%curve = card%i(k_curve)
    history%place = place_t(line=card%line, card=1, field=k_curve)
    if (file == output_plot) then
      if (card%i(4) < 0) call report_field(deck, cursor, card, 4, 'is negative')
      history%n_state = max(card%i(4), 0)
    else if (file /= output_rwforc) then
      if (card%i(2) < 0 .or. card%i(2) > 3) call report_field(deck, cursor, card, 2, &
        'is none of 0, 1 (text file), 2 (binout) and 3 (both)')
      history%is_text = card%i(2) /= 2
      history%is_binout = card%i(2) >= 2
    end if
    raw%outputs(file) = history
  end subroutine read_database

  !> Cycles between two restart files.
  subroutine take_cycles(deck, cursor, card, cycles)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    integer, intent(out) :: cycles

    cycles = 0
    if (.not. (card%r(1) >= 0.0_wp .and. card%r(1) <= most_cycles)) then
      call report_field(deck, cursor, card, 1, 'is not a number of cycles')
    else if (abs(card%r(1) - anint(card%r(1))) > 0.0_wp) then
      call report_field(deck, cursor, card, 1, 'is not a whole number of cycles')
    else
      cycles = nint(card%r(1))
    end if
  end subroutine take_cycles

end module deck_output_m
