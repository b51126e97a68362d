! SPDX-License-Identifier: MIT
!> *CONTROL_ cards, and the *DATABASE_ cards that say how often files are written.
module deck_control_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use text_m, only : upper_case
  use units_m, only : units_t, find_unit, set_force
  use controls_m, only : length_by_side, length_by_diagonal
  use deck_lines_m, only : deck_t, line_warning, given_by
  use deck_fields_m, only : card_t, field_text
  use deck_card_specs_m, only : field_number
  use deck_cards_m, only : cursor_t, open_cursor, next_card, check_rest, report_field, warn_of_field
  use deck_values_m, only : integer_of, real_of, place_of, is_blank, is_bad
  use deck_implicit_m, only : take_implicit, take_dynamics, take_solution, take_automatic
  use deck_raw_m, only : raw_t, history_t, output_plot
  use history_tables_m, only : table_of_keyword
  use deck_friction_m, only : take_default_friction
  use deck_part_m, only : hourglass_form, hourglass_coefficient
  implicit none
  private
  public :: read_control, read_database, check_step

contains

  !> One *CONTROL_ keyword: its cards in order, then what they mean.
  subroutine read_control(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: cards(6)
    integer :: k

    call open_cursor(deck, i_block, cursor)
    do k = 1, cursor%n_card
      if (k == 3 .and. deck%blocks(i_block)%name == 'CONTROL_IMPLICIT_SOLUTION') then
        ! The card of strict tolerances comes with a negative DNORM alone.
        if (integer_of(cards(2), 'DNORM') >= 0) cycle
      end if
      call next_card(deck, cursor, k, cards(k))
    end do
    call check_rest(deck, cursor)
    call warn_of_repetition(deck, i_block)
    select case (deck%blocks(i_block)%name)
    case ('CONTROL_TERMINATION')
      call take_termination(cards(1), raw)
    case ('CONTROL_TIMESTEP')
      call take_timestep(cards(1), raw)
    case ('CONTROL_DYNAMIC_RELAXATION')
      call take_relaxation(cards(1), raw)
    case ('CONTROL_HOURGLASS')
      call hourglass_form(deck, cards(1), 'IHQ', raw%hourglass_default%form)
      call hourglass_coefficient(deck, cards(1), 'QH', &
        raw%hourglass_default%coefficient)
    case ('CONTROL_BULK_VISCOSITY')
      ! Off without the keyword; blank fields of it are LS-DYNA's defaults.
      raw%hourglass_default%quadratic = real_of(cards(1), 'Q1')
      raw%hourglass_default%linear = real_of(cards(1), 'Q2')
    case ('CONTROL_CONTACT')
      raw%controls%penalty_scale = real_of(cards(1), 'SLSFAC')
      raw%controls%contact_step = integer_of(cards(2), 'ECDT')
      call note_explicit(cards(2), 'ECDT', raw)
      call take_default_friction(cards(3), raw)
    case ('CONTROL_IMPLICIT_GENERAL')
      call take_implicit(deck, cards(1), raw)
    case ('CONTROL_IMPLICIT_DYNAMICS')
      call take_dynamics(deck, cards(1), raw)
    case ('CONTROL_IMPLICIT_SPECTRAL_RADIUS')
      raw%spectral_radius = real_of(cards(1), 'RHO')
      if (is_blank(cards(1), 'RHO')) call report_field(deck, cards(1), 'RHO', &
        'is not a spectral radius (0 to 1)')
    case ('CONTROL_IMPLICIT_SOLUTION')
      call take_solution(cards(1), raw%controls%implicit)
    case ('CONTROL_IMPLICIT_AUTO')
      call take_automatic(deck, cards(1), raw%controls%implicit)
    case ('CONTROL_UNITS')
      call take_units(deck, cards(1), raw)
    case ('CONTROL_OUTPUT')
      raw%controls%output%status_interval = integer_of(cards(1), 'IKEDIT')
    end select
  end subroutine read_control

  !> A control that is given again: the later one counts.
  subroutine warn_of_repetition(deck, i_block)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    integer :: i

    do i = 1, i_block - 1
      if (deck%blocks(i)%name /= deck%blocks(i_block)%name) cycle
      call line_warning(deck, deck%blocks(i_block)%keyword, 'again'//to_text(i_block), &
        'is given again; this one counts')
      return
    end do
  end subroutine warn_of_repetition

  !> *CONTROL_TERMINATION.
  subroutine take_termination(card, raw)
    type(card_t), intent(in) :: card
    type(raw_t), intent(inout) :: raw

    raw%terminated = .true.
    raw%controls%end_time = real_of(card, 'ENDTIM')
    raw%controls%end_cycle = integer_of(card, 'ENDCYC')
    raw%controls%dt_floor = real_of(card, 'DTMIN')
    raw%controls%energy_limit = real_of(card, 'ENDENG')
    raw%controls%most_added = real_of(card, 'ENDMAS')
    raw%controls%check_only = integer_of(card, 'NOSOL') == 1
  end subroutine take_termination

  !> *CONTROL_TIMESTEP.
  subroutine take_timestep(card, raw)
    type(card_t), intent(in) :: card
    type(raw_t), intent(inout) :: raw
    character(6), parameter :: names(5) = [character(6) :: 'DTINIT', 'TSSFAC', 'ISDO', 'LCTM', &
      'DT2MS']
    integer :: k

    do k = 1, size(names)
      call note_explicit(card, trim(names(k)), raw)
    end do
    raw%erodes_by_step = integer_of(card, 'ERODE') == 1
    raw%controls%dt_initial = real_of(card, 'DTINIT')
    raw%controls%dt_scale = real_of(card, 'TSSFAC')
    raw%controls%length_rule = merge(length_by_diagonal, length_by_side, &
      integer_of(card, 'ISDO') == 1)
    raw%controls%mass_step = real_of(card, 'DT2MS')
    raw%controls%masses_stay = integer_of(card, 'MS1ST') == 1
    raw%step_line = card%line
    raw%dt_curve = integer_of(card, 'LCTM')
    raw%dt_curve_place = place_of(card, 'LCTM')
    raw%scale_place = place_of(card, 'TSSFAC')
  end subroutine take_timestep

  !> *CONTROL_DYNAMIC_RELAXATION. Whether it takes place may depend on the curves too.
  subroutine take_relaxation(card, raw)
    type(card_t), intent(in) :: card
    type(raw_t), intent(inout) :: raw

    associate (relaxation => raw%controls%relaxation)
      relaxation%is_on = integer_of(card, 'IDRFLG') == 1
      raw%never_relaxes = integer_of(card, 'IDRFLG') == -999
      raw%relaxation_line = card%line
      relaxation%check_cycles = integer_of(card, 'NRCYCK')
      relaxation%tolerance = real_of(card, 'DRTOL')
      relaxation%factor = real_of(card, 'DRFCTR')
      if (real_of(card, 'DRTERM') > 0.0_wp) relaxation%most_time = real_of(card, 'DRTERM')
      relaxation%step_scale = real_of(card, 'TSSFDR')
    end associate
  end subroutine take_relaxation

  !> A field that the implicit method leaves, where it asks for something.
  subroutine note_explicit(card, name, raw)
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    type(raw_t), intent(inout) :: raw
    integer :: k

    k = field_number(card%names, name)
    if (.not. card%blank(k) .and. abs(card%r(k)) > 0.0_wp) &
      raw%explicit_only = [raw%explicit_only, place_of(card, name)]
  end subroutine note_explicit

  !> Rules of the step, from the card or from a word.
  subroutine check_step(deck, raw)
    type(deck_t), intent(inout) :: deck
    type(raw_t), intent(in) :: raw
    character(:), allocatable :: given

    if (raw%controls%implicit%is_on .or. raw%step_line == 0) return
    given = given_by(deck, raw%step_line, raw%scale_place%field)
    if (len(given) == 0) given = 'TSSFAC'
    if (raw%controls%dt_scale > 1.0_wp) call line_warning(deck, raw%step_line, 'tssfac', given &
      //' is above 1: the run may become unstable')
    given = given_by(deck, raw%step_line, raw%dt_curve_place%field)
    if (len(given) == 0) given = 'the curve LCTM'
    if (raw%controls%dt_initial > 0.0_wp .and. raw%dt_curve > 0) call line_warning(deck, &
      raw%step_line, 'dtinit', 'DTINIT has no effect beside '//given)
  end subroutine check_step

  !> *CONTROL_UNITS: names for messages alone. A word that is not known leaves them without.
  subroutine take_units(deck, card, raw)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(raw_t), intent(inout) :: raw
    character(*), parameter :: fields(3) = ['LENGTH', 'TIME  ', 'MASS  '], &
      defaults(3) = ['M  ', 'SEC', 'KG ']
    character(*), parameter :: known(3) = [character(40) :: 'm, cm, mm, in, ft', &
      'sec, ms, micro_s', 'kg, g, mg, mtrc_ton, lb, slug, slinch']
    character(:), allocatable :: word
    real(wp) :: values(3)
    integer :: k

    raw%controls%units = units_t()
    do k = 1, 3
      word = upper_case(field_text(deck, card, field_number(card%names, fields(k))))
      if (len(word) == 0) word = trim(defaults(k))
      call find_unit(k, word, raw%controls%units%names(k), values(k))
      if (len_trim(raw%controls%units%names(k)) > 0) cycle
      call warn_of_field(deck, place_of(card, fields(k)), 'is no unit that messages know (' &
        //trim(known(k))//'), so that they name none')
      values(k) = 0.0_wp
    end do
    if (all(values > 0.0_wp)) call set_force(values, raw%controls%units)
  end subroutine take_units

  !> One *DATABASE_ keyword with an interval.
  subroutine read_database(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, rest
    type(history_t) :: history
    character(4) :: curve
    integer :: file, k

    call open_cursor(deck, i_block, cursor)
    call next_card(deck, cursor, 1, card)
    do k = 2, cursor%n_card
      call next_card(deck, cursor, k, rest)
    end do
    call check_rest(deck, cursor)
    select case (deck%blocks(i_block)%name)
    case ('DATABASE_BINARY_D3PLOT')
      file = output_plot
    case ('DATABASE_BINARY_D3DUMP')
      call take_cycles(deck, card, raw%controls%output%dump_cycles)
      return
    case ('DATABASE_BINARY_RUNRSF')
      call take_cycles(deck, card, raw%controls%output%running_cycles)
      return
    case default
      file = table_of_keyword(deck%blocks(i_block)%name)
    end select
    curve = merge('LCDT', 'LCUR', file == output_plot)
    history%dt = real_of(card, 'DT')
    history%curve = integer_of(card, curve)
    history%place = place_of(card, curve)
    if (file == output_plot) then
      history%n_state = max(integer_of(card, 'NPLTC'), 0)
    else
      history%is_text = integer_of(card, 'BINARY') /= 2
      history%is_binout = integer_of(card, 'BINARY') >= 2
    end if
    raw%outputs(file) = history
  end subroutine read_database

  !> Cycles between two restart files.
  subroutine take_cycles(deck, card, cycles)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(out) :: cycles

    cycles = 0
    if (.not. is_bad(card, 'CYCL')) cycles = nint(real_of(card, 'CYCL'))
    if (abs(real_of(card, 'CYCL') - cycles) > 0.0_wp) call report_field(deck, card, 'CYCL', &
      'is not a whole number of cycles')
  end subroutine take_cycles

end module deck_control_m
