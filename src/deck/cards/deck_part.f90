! SPDX-License-Identifier: MIT
!> *PART, *SECTION_SHELL and *HOURGLASS cards.
module deck_part_m
  use kinds_m, only : wp
  use text_m, only : read_integer, number_good
  use log_m, only : to_text
  use parts_m, only : section_t, hourglass_t, hourglass_viscous, hourglass_stiffness, &
    hourglass_assumed, form_one_point, form_full, form_round_one_point, form_round_full
  use deck_ids_m, only : a_part, a_section, an_hourglass
  use deck_maps_m, only : lose
  use deck_lines_m, only : deck_t, line_text, line_error, line_warning, flag_blank
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, skip_title, next_card, next_row, next_text, &
    row_comes, report_field, find_field
  use deck_values_m, only : integer_of, real_of, is_blank, is_bad, require_id, refuse_negative
  use deck_raw_m, only : raw_t, raw_part_t
  implicit none
  private
  public :: read_part, read_section, read_hourglass, hourglass_form, hourglass_coefficient, &
    check_viscosity

  !> Largest coefficients: they have no unit, and the stable step falls with them to none.
  real(wp), parameter :: most_hourglass = 10.0_wp, most_viscosity = 100.0_wp

contains

  !> *PART: a heading and a card for each part.
  subroutine read_part(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(raw_part_t) :: part
    logical :: found

    call open_cursor(deck, i_block, cursor)
    do
      call skip_separators(deck, cursor)
      if (cursor%line > cursor%last) exit
      call next_text(deck, cursor, part%title)
      part%title = trim(adjustl(part%title))
      call next_row(deck, cursor, 2, card, found)
      if (.not. found) then
        call line_error(deck, cursor%line - 1, 'a heading without the card of its part after it')
        exit
      end if
      call require_id(deck, cursor, card, 'PID')
      call require_id(deck, cursor, card, 'SECID')
      call require_id(deck, cursor, card, 'MID')
      if (integer_of(card, 'EOSID') < 0) call report_field(deck, cursor, card, 'EOSID', &
        'is not a number of 0 or more')
      if (integer_of(card, 'HGID') < 0) call report_field(deck, cursor, card, 'HGID', &
        'is not a number of 0 or more')
      part%id = integer_of(card, 'PID')
      part%section = integer_of(card, 'SECID')
      part%material = integer_of(card, 'MID')
      part%eos = integer_of(card, 'EOSID')
      part%hourglass = integer_of(card, 'HGID')
      part%line = card%line
      if (is_bad(card, 'PID')) then
        call lose(deck, [a_part])
      else
        raw%n_part = raw%n_part + 1
        raw%parts(raw%n_part) = part
      end if
    end do
  end subroutine read_part

  !> Move past blank lines between parts; a blank line right before a card of numbers is a heading.
  subroutine skip_separators(deck, cursor)
    type(deck_t), intent(in) :: deck
    type(cursor_t), intent(inout) :: cursor
    character(:), allocatable :: text
    integer :: number, status, width

    width = cursor%specs(2)%widths(find_field(cursor, 2, 'PID'))
    do while (cursor%line <= cursor%last)
      if (iand(deck%flags(cursor%line), flag_blank) == 0) return
      if (cursor%line < cursor%last) then
        text = line_text(deck, cursor%line + 1)
        if (index(text, ',') > 0) text = text(:index(text, ',') - 1)
        call read_integer(text(:min(width, len(text))), number, status)
        if (status == number_good) return
      end if
      cursor%line = cursor%line + 1
    end do
  end subroutine skip_separators

  !> *SECTION_SHELL: two cards each; only the element form matters.
  subroutine read_section(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card, thickness
    type(section_t) :: section
    logical :: found

    call open_cursor(deck, i_block, cursor)
    do
      call skip_title(deck, cursor)
      call next_card(deck, cursor, 1, card)
      call check_section(deck, cursor, card)
      section%id = integer_of(card, 'SECID')
      section%is_full = integer_of(card, 'NIP') == 4
      section%is_round = integer_of(card, 'ELFORM') == 15
      section%element_form = merge(form_full, form_one_point, section%is_full)
      if (section%is_round) section%element_form = merge(form_round_full, form_round_one_point, &
        section%is_full)
      if (is_bad(card, 'SECID')) then
        call lose(deck, [a_section])
      else
        raw%n_section = raw%n_section + 1
        raw%sections(raw%n_section) = section
        raw%section_line(raw%n_section) = card%line
      end if
      call next_card(deck, cursor, 2, thickness)
      call row_comes(deck, cursor, found)
      if (.not. found) exit
    end do
  end subroutine read_section

  !> Fields of card 1 of *SECTION_SHELL.
  subroutine check_section(deck, cursor, card)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card

    call require_id(deck, cursor, card, 'SECID')
    select case (integer_of(card, 'ELFORM'))
    case (13, 15)
      continue
    case (12)
      call report_field(deck, cursor, card, 'ELFORM', 'is plane stress, which this version does ' &
        //'not have; 13 (plane strain) and 15 (axisymmetric) are what it has')
    case (14)
      call report_field(deck, cursor, card, 'ELFORM', 'is axisymmetric and area weighted, which ' &
        //'this version does not have; 15 (axisymmetric, volume weighted) is what it has')
    case default
      call report_field(deck, cursor, card, 'ELFORM', 'is not an element form for the plane; 13 ' &
        //'(plane strain) and 15 (axisymmetric) are what this version has')
    end select
    select case (integer_of(card, 'NIP'))
    case (0:2, 4)
      continue
    case default
      call report_field(deck, cursor, card, 'NIP', 'is not a number of points (0, 1, 2 or blank: ' &
        //'one point; 4: two by two, full integration)')
    end select
  end subroutine check_section

  !> *HOURGLASS: one card each.
  subroutine read_hourglass(deck, i_block, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: card
    type(hourglass_t) :: hourglass
    logical :: found, given(2)

    call open_cursor(deck, i_block, cursor)
    do
      call skip_title(deck, cursor)
      call next_row(deck, cursor, 1, card, found)
      if (.not. found) exit
      call require_id(deck, cursor, card, 'HGID')
      hourglass%id = integer_of(card, 'HGID')
      call hourglass_form(deck, cursor, card, 'IHQ', hourglass%form)
      call hourglass_coefficient(deck, cursor, card, 'QM', hourglass%coefficient)
      call check_viscosity(deck, cursor, card, 'Q1')
      call check_viscosity(deck, cursor, card, 'Q2')
      hourglass%quadratic = real_of(card, 'Q1')
      hourglass%linear = real_of(card, 'Q2')
      given = .not. [is_blank(card, 'Q1'), is_blank(card, 'Q2')]
      if (is_bad(card, 'HGID')) call lose(deck, [an_hourglass])
      if (is_bad(card, 'HGID')) cycle
      raw%n_hourglass = raw%n_hourglass + 1
      raw%hourglasses(raw%n_hourglass) = hourglass
      raw%hourglass_line(raw%n_hourglass) = card%line
      raw%bulk_given(:, raw%n_hourglass) = given
    end do
  end subroutine read_hourglass

  !> The form in the field of a name.
  subroutine hourglass_form(deck, cursor, card, name, form)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    integer, intent(out) :: form

    form = hourglass_viscous
    select case (integer_of(card, name))
    case (0:3)
      continue
    case (4, 5)
      form = hourglass_stiffness
    case (6)
      form = hourglass_assumed
    case (7)
      call report_field(deck, cursor, card, name, 'is the total form of 6, whose forces pull ' &
        //'back to the initial shape whatever has yielded since; this version has the form in ' &
        //'increments (6), which is the same while the strains are small and elastic')
    case default
      call report_field(deck, cursor, card, name, &
        'is not an hourglass form (1 to 3 viscous, 4 and 5 stiffness, 6 assumed strain)')
    end select
  end subroutine hourglass_form

  !> A coefficient of bulk viscosity in the field of a name.
  subroutine check_viscosity(deck, cursor, card, name)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name

    call refuse_negative(deck, cursor, card, name)
    if (real_of(card, name) > most_viscosity) call report_field(deck, cursor, card, name, &
      'is not a coefficient of bulk viscosity (at most 100; Q1 1.5 and Q2 0.06 are usual)')
  end subroutine check_viscosity

  !> Hourglass coefficient in the field of a name: 0 and blank are 0.1, as in LS-DYNA.
  subroutine hourglass_coefficient(deck, cursor, card, name, coefficient)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name
    real(wp), intent(out) :: coefficient
    real(wp) :: given

    coefficient = 0.1_wp
    given = real_of(card, name)
    if (given < 0.0_wp) then
      call report_field(deck, cursor, card, name, 'is negative')
    else if (given > most_hourglass) then
      call report_field(deck, cursor, card, name, &
        'is not an hourglass coefficient (at most 10; 0.05 to 0.15 are usual)')
    else if (given > 0.0_wp) then
      coefficient = given
    else if (.not. is_blank(card, name) .and. .not. is_bad(card, name)) then
      call line_warning(deck, card%line, 'qh'//to_text(card%line), &
        'an hourglass coefficient of 0 means the default 0.1; give a very small one for almost ' &
        //'none')
    end if
  end subroutine hourglass_coefficient

end module deck_part_m
