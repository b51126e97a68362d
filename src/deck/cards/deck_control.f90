! SPDX-License-Identifier: MIT
!> *TITLE, *CONTROL_ cards (except the implicit method and contact), *DATABASE_ cards with output
!> intervals, and *TERMINATION_.
module deck_control_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use text_m, only : upper_case
  use units_m, only : units_t, find_unit, set_force
  use controls_m, only : controls_t, interval_t, is_asked, length_by_side, length_by_diagonal, &
    end_condition_t, end_node_coordinate, end_node_contact, end_body_displacement, &
    end_body_distance, end_contact
  use curves_m, only : curve_t
  use parts_m, only : hourglass_t
  use model_m, only : model_t
  use deck_lines_m, only : deck_t, blocks_of, count_rows, line_error, line_warning, given_by, &
    shown_text, block_of_line
  use deck_fields_m, only : field_number, card_t, field_text
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_text, next_of, row_comes, &
    check_rest, report_field, warn_of_field
  use deck_ids_m, only : a_node, a_curve
  use deck_supports_m, only : find_body
  use deck_values_m, only : integer_of, real_of, location_of, is_blank, has_field, find_id
  use history_tables_m, only : history_tables, n_table, table_of_keyword, table_nodout, &
    table_elout, table_nodfor, table_secforc
  use deck_part_m, only : hourglass_form, hourglass_coefficient
  implicit none
  private
  public :: control_cards, warn_of_explicit, read_controls, read_outputs, read_relaxation, read_ends

  !> Index of the states; histories have their `table_` constants.
  integer, parameter :: output_plot = 0

contains

  !> Read the cards of a *CONTROL_ keyword. A repeated keyword replaces the previous one.
  subroutine control_cards(deck, i_block, cards)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(card_t), intent(out) :: cards(6)
    type(cursor_t) :: cursor
    integer :: k

    call open_cursor(deck, i_block, cursor)
    do k = 1, cursor%n_card
      if (k == 3 .and. deck%blocks(i_block)%name == 'CONTROL_IMPLICIT_SOLUTION') then
        ! The card of strict tolerances is present with a negative DNORM only.
        if (integer_of(cards(2), 'DNORM') >= 0) cycle
      end if
      call next_card(deck, cursor, k, cards(k))
    end do
    call check_rest(deck, cursor)
    if (any(deck%blocks(:i_block - 1)%name == deck%blocks(i_block)%name)) call line_warning(deck, &
      deck%blocks(i_block)%keyword, 'again'//to_text(i_block), 'is given twice; this one is used')
  end subroutine control_cards

  !> Warn of a field that has no effect with the implicit method, where it is not 0.
  subroutine warn_of_explicit(deck, card, name)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    character(*), intent(in) :: name
    integer :: k

    k = field_number(card%names, name)
    if (.not. card%blank(k) .and. (card%i(k) /= 0 .or. abs(card%r(k)) > 0.0_wp)) call &
      warn_of_field(deck, location_of(card, name), 'has no effect with the implicit method')
  end subroutine warn_of_explicit

  !> Read termination, time step, units and the default hourglass control. Curves and IMFLAG have
  !> been read.
  subroutine read_controls(deck, model, hourglass, erodes, step_line)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(hourglass_t), intent(out) :: hourglass !! of parts without HGID
    logical, intent(out) :: erodes              !! ERODE of *CONTROL_TIMESTEP
    integer, intent(out) :: step_line           !! its card, 0 = none
    type(card_t) :: cards(6), step
    type(cursor_t) :: cursor
    character(:), allocatable :: text
    integer, allocatable :: blocks(:)
    integer :: i

    model%controls%title = ''
    blocks = blocks_of(deck, 'TITLE')
    if (size(blocks) > 0) then
      ! The last one given.
      call open_cursor(deck, blocks(size(blocks)), cursor)
      if (row_comes(deck, cursor)) call next_text(deck, cursor, text)
      if (allocated(text)) model%controls%title = trim(adjustl(shown_text(text)))
    end if
    blocks = blocks_of(deck, 'CONTROL_')
    do i = 1, size(blocks)
      associate (name => deck%blocks(blocks(i))%name)
        if (any([index(name, '_IMPLICIT'), index(name, '_CONTACT'), index(name, '_DYNAMIC')] > 0)) &
          cycle
        call control_cards(deck, blocks(i), cards)
        select case (name)
        case ('CONTROL_TERMINATION')
          call read_termination(deck, cards(1), model%controls)
        case ('CONTROL_TIMESTEP')
          step = cards(1)
          call read_timestep(deck, step, model%controls)
        case ('CONTROL_HOURGLASS')
          call hourglass_form(deck, cards(1), 'IHQ', hourglass%form)
          call hourglass_coefficient(deck, cards(1), 'QH', hourglass%coefficient)
        case ('CONTROL_BULK_VISCOSITY')
          ! Off without the keyword; blank fields of it are LS-DYNA's defaults.
          hourglass%quadratic = real_of(cards(1), 'Q1')
          hourglass%linear = real_of(cards(1), 'Q2')
        case ('CONTROL_UNITS')
          call read_units(deck, cards(1), model%controls%units)
        case ('CONTROL_OUTPUT')
          model%controls%output%status_interval = integer_of(cards(1), 'IKEDIT')
        end select
      end associate
    end do
    erodes = .false.
    step_line = step%line
    if (step_line == 0) return
    erodes = integer_of(step, 'ERODE') == 1
    call check_step(deck, step, model)
  end subroutine read_controls

  !> *CONTROL_TERMINATION.
  subroutine read_termination(deck, card, controls)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(controls_t), intent(inout) :: controls

    controls%end_time = real_of(card, 'ENDTIM')
    controls%end_cycle = integer_of(card, 'ENDCYC')
    controls%dt_floor = real_of(card, 'DTMIN')
    controls%energy_limit = real_of(card, 'ENDENG')
    controls%most_added = real_of(card, 'ENDMAS')
    controls%check_only = integer_of(card, 'NOSOL') == 1
    if (controls%implicit%is_on .and. controls%dt_floor > 0.0_wp) call line_warning(deck, &
      deck%blocks(block_of_line(deck, card%line))%keyword, 'implicit step floor', &
      'DTMIN has no effect with the implicit method; DTMIN of *CONTROL_IMPLICIT_AUTO is its ' &
      //'shortest step')
  end subroutine read_termination

  !> *CONTROL_TIMESTEP.
  subroutine read_timestep(deck, card, controls)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(controls_t), intent(inout) :: controls
    character(6), parameter :: names(5) = [character(6) :: 'DTINIT', 'TSSFAC', 'ISDO', 'LCTM', &
      'DT2MS']
    integer :: k

    do k = 1, size(names)
      if (controls%implicit%is_on) call warn_of_explicit(deck, card, trim(names(k)))
    end do
    controls%dt_initial = real_of(card, 'DTINIT')
    controls%dt_scale = real_of(card, 'TSSFAC')
    controls%length_rule = merge(length_by_diagonal, length_by_side, integer_of(card, 'ISDO') == 1)
    controls%mass_step = real_of(card, 'DT2MS')
    controls%masses_stay = integer_of(card, 'MS1ST') == 1
  end subroutine read_timestep

  !> Read LCTM, and check fields of the time step from the card or the command line.
  subroutine check_step(deck, card, model)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(inout) :: model
    character(:), allocatable :: given

    associate (controls => model%controls, k => model%controls%dt_curve)
      if (integer_of(card, 'LCTM') > 0) then
        call find_id(deck, a_curve, card, 'LCTM', k)
        if (k > 0) then
          if (minval(model%curves(k)%ordinate) <= 0.0_wp) call line_error(deck, &
            deck%maps(a_curve)%lines(k), 'curve '//to_text(integer_of(card, 'LCTM')) &
            //' limits the time step (LCTM) and must be above 0 everywhere')
        end if
      end if
      if (controls%implicit%is_on) return
      given = given_by(deck, card%line, field_number(card%names, 'TSSFAC'))
      if (len(given) == 0) given = 'TSSFAC'
      if (controls%dt_scale > 1.0_wp) call line_warning(deck, card%line, 'tssfac', given &
        //' is above 1: the run may become unstable')
      given = given_by(deck, card%line, field_number(card%names, 'LCTM'))
      if (len(given) == 0) given = 'the curve LCTM'
      if (controls%dt_initial > 0.0_wp .and. integer_of(card, 'LCTM') > 0) call line_warning(deck, &
        card%line, 'dtinit', 'DTINIT has no effect with '//given)
    end associate
  end subroutine check_step

  !> *CONTROL_UNITS: names of units for messages; none with an unknown word.
  subroutine read_units(deck, card, units)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(in) :: card
    type(units_t), intent(out) :: units
    character(*), parameter :: fields(3) = ['LENGTH', 'TIME  ', 'MASS  '], &
      defaults(3) = ['M  ', 'SEC', 'KG ']
    character(*), parameter :: known(3) = [character(40) :: 'm, cm, mm, in, ft', &
      'sec, ms, micro_s', 'kg, g, mg, mtrc_ton, lb, slug, slinch']
    character(:), allocatable :: word
    real(wp) :: values(3)
    integer :: k

    do k = 1, 3
      word = upper_case(field_text(deck, card, field_number(card%names, fields(k))))
      if (len(word) == 0) word = trim(defaults(k))
      call find_unit(k, word, units%names(k), values(k))
      if (len_trim(units%names(k)) > 0) cycle
      call warn_of_field(deck, location_of(card, fields(k)), 'is not a known unit (' &
        //trim(known(k))//'): messages have no units')
      values(k) = 0.0_wp
    end do
    if (all(values > 0.0_wp)) call set_force(values, units)
  end subroutine read_units

  !> *CONTROL_DYNAMIC_RELAXATION and SIDR of curves; report what relaxation does not support. The
  !> rest of the model has been read.
  subroutine read_relaxation(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(card_t) :: cards(6)
    integer, allocatable :: blocks(:)
    logical :: never
    integer :: i, line

    never = .false.
    line = 0
    associate (relaxation => model%controls%relaxation, conditions => model%conditions)
      blocks = blocks_of(deck, 'CONTROL_DYNAMIC_RELAXATION')
      do i = 1, size(blocks)
        call control_cards(deck, blocks(i), cards)
        line = cards(1)%line
        never = integer_of(cards(1), 'IDRFLG') == -999
        relaxation%is_on = integer_of(cards(1), 'IDRFLG') == 1
        relaxation%check_cycles = integer_of(cards(1), 'NRCYCK')
        relaxation%tolerance = real_of(cards(1), 'DRTOL')
        relaxation%factor = real_of(cards(1), 'DRFCTR')
        if (real_of(cards(1), 'DRTERM') > 0.0_wp) relaxation%most_time = real_of(cards(1), 'DRTERM')
        relaxation%step_scale = real_of(cards(1), 'TSSFDR')
      end do
      relaxation%is_on = relaxation%is_on .or. (any(model%curves%phase > 0) .and. .not. never)
      if (.not. relaxation%is_on) return
      if (line == 0) line = deck%maps(a_curve)%lines(findloc(model%curves%phase > 0, .true., &
        dim=1))
      if (model%controls%implicit%is_on) call refuse('with the implicit method')
      if (size(model%contacts) > 0) call refuse('with contact')
      if (model%erodes) call refuse('with elements that may erode')
      if (allocated(model%walls)) call refuse('with rigid walls')
      if (size(model%rigids) > 0) call refuse('with rigid bodies')
      if (size(conditions%motions) > 0) call refuse('with prescribed motion')
      if (allocated(conditions%common_motions)) call refuse('with *CONSTRAINED_NODE_SET')
      if (allocated(model%mesh%hanging)) call refuse('with hanging nodes')
    end associate

  contains

    !> Report an error.
    subroutine refuse(what)
      character(*), intent(in) :: what

      call line_error(deck, line, 'asks for dynamic relaxation '//what &
        //', which this version does not have')
    end subroutine refuse

  end subroutine read_relaxation

  !> *DATABASE_ keywords with an interval; a repeated keyword replaces the previous one. End time
  !> and curves have been read.
  subroutine read_outputs(deck, model)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    type(card_t) :: card, rest, plans(output_plot:n_table)
    type(cursor_t) :: cursor
    integer, allocatable :: blocks(:)
    integer :: i, k

    blocks = blocks_of(deck, 'DATABASE_')
    do i = 1, size(blocks)
      associate (name => deck%blocks(blocks(i))%name, output => model%controls%output)
        if (any([index(name, '_HISTORY'), index(name, '_NODAL'), index(name, '_CROSS')] > 0)) cycle
        call open_cursor(deck, blocks(i), cursor)
        call next_card(deck, cursor, 1, card)
        do k = 2, cursor%n_card
          call next_card(deck, cursor, k, rest)
        end do
        call check_rest(deck, cursor)
        select case (name)
        case ('DATABASE_BINARY_D3PLOT')
          plans(output_plot) = card
        case ('DATABASE_BINARY_D3DUMP')
          output%dump_cycles = integer_of(card, 'CYCL')
        case ('DATABASE_ERROR_INDICATOR')
          output%has_errors = .true.
        case ('DATABASE_BINARY_RUNRSF')
          output%running_cycles = integer_of(card, 'CYCL')
        case default
          plans(table_of_keyword(name)) = card
        end select
      end associate
    end do
    associate (output => model%controls%output)
      if (plans(output_plot)%line > 0) then
        call read_interval(deck, 'LCDT', model%curves, plans(output_plot), output%plot)
        k = integer_of(plans(output_plot), 'NPLTC')
        if (k > 0) output%plot%dt = model%controls%end_time/real(k, wp)
      end if
      do i = 1, n_table
        if (plans(i)%line == 0) cycle
        call read_interval(deck, 'LCUR', model%curves, plans(i), output%histories(i))
        k = integer_of(plans(i), 'BINARY')
        output%histories(i)%is_text = k /= 2
        output%histories(i)%is_binout = k >= 2
        call warn_of_empty(deck, plans(i)%line, i, output%histories(i))
      end do
    end associate
  end subroutine read_outputs

  !> Read the interval of one output file.
  subroutine read_interval(deck, name, curves, card, interval)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: name            !! of the field of its curve
    type(curve_t), intent(in) :: curves(:)
    type(card_t), intent(inout) :: card
    type(interval_t), intent(out) :: interval

    interval%dt = real_of(card, 'DT')
    if (integer_of(card, name) == 0) return
    call find_id(deck, a_curve, card, name, interval%curve)
    if (interval%curve == 0) return
    if (.not. minval(curves(interval%curve)%ordinate) > 0.0_wp) call line_error(deck, &
      card%line, 'curve '//to_text(integer_of(card, name)) &
      //' is an output interval and must be above 0 everywhere')
  end subroutine read_interval

  !> Warn of a history without a file, because the keyword with its entities is missing.
  subroutine warn_of_empty(deck, line, table, interval)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line, table
    type(interval_t), intent(in) :: interval
    integer, parameter :: tables(4) = [table_nodout, table_elout, table_nodfor, table_secforc]
    character(26), parameter :: needed(4) = [character(26) :: 'DATABASE_HISTORY_NODE', &
      'DATABASE_HISTORY_SHELL', 'DATABASE_NODAL_FORCE_GROUP', 'DATABASE_CROSS_SECTION_SET']
    integer :: k

    k = findloc(tables, table, 1)
    if (k == 0 .or. deck%incomplete) return
    if (is_asked(interval) .and. size(blocks_of(deck, trim(needed(k)))) == 0) call &
      line_warning(deck, line, 'empty '//history_tables(table)%name, 'asks for a history, but ' &
      //'the deck has no *'//trim(needed(k))//': no file is written')
  end subroutine warn_of_empty

  !> *TERMINATION_: termination by nodes, rigid bodies and interfaces. Rigid bodies and interfaces
  !> have been read.
  subroutine read_ends(deck, model, sound)
    type(deck_t), intent(inout) :: deck
    type(model_t), intent(inout) :: model
    logical, intent(in) :: sound !! the interfaces have their surfaces
    type(end_condition_t), allocatable :: ends(:)
    type(end_condition_t) :: ending
    type(cursor_t) :: cursor
    type(card_t) :: card
    integer :: n

    allocate (ends(count_rows(deck, 'TERMINATION_')))
    if (size(ends) == 0) return
    n = 0
    do while (next_of(deck, 'TERMINATION_', cursor, card))
      ending = end_condition_t()
      if (has_field(card, 'CID')) then
        call read_contact_end(deck, card, model, ending)
      else if (has_field(card, 'NID')) then
        call read_end_bounds(deck, card, end_node_coordinate, end_node_contact, ending)
        ending%id = integer_of(card, 'NID')
        call find_id(deck, a_node, card, 'NID', ending%where)
        if (ending%kind == end_node_contact .and. ending%where > 0 .and. sound) then
          if (.not. is_in_contact(model, ending%where)) call report_field(deck, card, 'NID', &
            'is not a node of an interface')
        end if
      else
        call read_end_bounds(deck, card, end_body_displacement, end_body_distance, ending)
        ending%id = integer_of(card, 'PID')
        call find_body(deck, card, model, '', ending%where)
      end if
      n = n + 1
      ends(n) = ending
    end do
    model%controls%ends = ends(:n)
  end subroutine read_ends

  !> *TERMINATION_CONTACT.
  subroutine read_contact_end(deck, card, model, ending)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    type(end_condition_t), intent(out) :: ending

    ending = end_condition_t(kind=end_contact, id=integer_of(card, 'CID'), &
      direction=integer_of(card, 'DOF'), start=real_of(card, 'ACTIM'), &
      duration=real_of(card, 'DUR'), threshold=real_of(card, 'THRES'))
    if (any(card%bad)) return
    ending%where = findloc(model%contacts%id, ending%id, 1)
    if (ending%where == 0) then
      if (.not. deck%incomplete) call report_field(deck, card, 'CID', &
        'matches no interface of this deck')
    else if (model%contacts(ending%where)%is_self) then
      call report_field(deck, card, 'CID', 'is an interface with self contact, whose total force ' &
        //'is 0')
    end if
  end subroutine read_contact_end

  !> Read the bounds of a node or a rigid body. Blank bounds, for bodies also 0, are not used.
  subroutine read_end_bounds(deck, card, along, other, ending)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    integer, intent(in) :: along, other      !! kind of STOP 1 and 2, of STOP 4
    type(end_condition_t), intent(inout) :: ending
    logical :: is_open(2)

    ending%kind = merge(other, along, integer_of(card, 'STOP') == 4)
    if (ending%kind == along) ending%direction = integer_of(card, 'STOP')
    if (ending%kind == end_node_contact .or. any(card%bad)) return
    is_open = [is_blank(card, 'MAXC'), is_blank(card, 'MINC')]
    if (along == end_body_displacement) is_open = is_open .or. [abs(real_of(card, 'MAXC')), &
      abs(real_of(card, 'MINC'))] <= 0.0_wp
    if (ending%kind == end_body_distance) is_open(2) = .true.
    if (all(is_open)) call report_field(deck, card, 'MAXC', 'is not a bound, nor is MINC: the ' &
      //'condition would never end the run')
    if (.not. is_open(1)) ending%most = real_of(card, 'MAXC')
    if (.not. is_open(2)) ending%least = real_of(card, 'MINC')
    if (ending%least >= ending%most) call report_field(deck, card, 'MINC', 'is not below MAXC')
  end subroutine read_end_bounds

  !> Whether a node belongs to an interface.
  pure function is_in_contact(model, node) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: node
    logical :: yes
    integer :: i

    yes = .false.
    do i = 1, size(model%contacts)
      yes = yes .or. any(model%contacts(i)%slave%nodes == node) &
        .or. any(model%contacts(i)%master%nodes == node)
    end do
  end function is_in_contact

end module deck_control_m
