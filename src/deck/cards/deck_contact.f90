! SPDX-License-Identifier: MIT
!> *CONTACT_2D_ cards. Contact types are numbers and names handed in by the caller; the stock
!> keywords stand for types that must be among them.
module deck_contact_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contact_types_m, only : type_nts, type_nts_ar, type_two_pass_ar, type_nts_mar, &
    type_segmented_mortar, type_missing
  use contacts_m, only : contact_kind_t, penalty_factor, tie_none, tie_always, tie_breaks
  use deck_lines_m, only : deck_t, line_error
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, check_rest, &
    report_field
  use deck_values_m, only : integer_of, real_of, is_blank, is_bad, place_of, refuse_negative, &
    take_life
  use deck_contact_values_m, only : find_commanded, take_overrides, check_values, kind_names, &
    name_of, of_penalty, of_master_penalty
  use deck_friction_m, only : take_friction, take_stock_friction, take_penalty_friction
  use deck_tie_m, only : take_tie, take_stock_tie, check_tie
  use deck_output_m, only : settle_number
  use deck_raw_m, only : raw_t, raw_contact_t
  use deck_overrides_m, only : overrides_t, contact_names
  implicit none
  private
  public :: read_contact

  !> Fields of the two sides.
  character(5), parameter :: side_fields(2) = ['SURFA', 'SURFB']
  !> Fields of the times between which an interface acts.
  character(6), parameter :: life(2) = ['TBIRTH', 'TDEATH']

contains

  !> One interface.
  subroutine read_contact(deck, i_block, kinds, overrides, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(contact_kind_t), intent(in) :: kinds(:)
    type(overrides_t), intent(in) :: overrides
    type(raw_t), intent(inout) :: raw
    type(cursor_t) :: cursor
    type(card_t) :: cards(4)
    type(raw_contact_t) :: entry, before
    logical :: commanded(size(contact_names))
    integer :: k

    call open_cursor(deck, i_block, cursor)
    entry%contact%title = ''
    if (deck%blocks(i_block)%titled) call next_heading(deck, cursor, entry%contact%id, &
      entry%contact%title)
    entry%block = i_block
    call settle_number(raw, entry)
    do k = 1, cursor%n_card
      call next_card(deck, cursor, k, cards(k))
    end do
    call check_rest(deck, cursor)
    call take_sides(deck, cursor, cards(1), trim(deck%blocks(i_block)%name), entry)
    entry%block = i_block
    commanded = find_commanded(overrides, entry%contact%id)
    entry%contact%contact_type = stock_type(trim(deck%blocks(i_block)%name))
    select case (deck%blocks(i_block)%name)
    case ('CONTACT_2D_SLIDELINE')
      call take_slideline(deck, cursor, cards, commanded, entry)
      call take_tie(deck, cursor, cards, commanded, entry)
      call take_friction(deck, cursor, cards, overrides, entry)
    case ('CONTACT_2D_PENALTY', 'CONTACT_2D_PENALTY_FRICTION', 'CONTACT_2D_SLIDING_VOIDS')
      call take_penalty(deck, cursor, cards, commanded, entry)
      if (cursor%n_card > 2) call take_penalty_friction(deck, cursor, cards(3), overrides, entry)
    case ('CONTACT_2D_TIED_SLIDING')
      call take_penalty(deck, cursor, cards, commanded, entry)
      call take_stock_tie(0.0_wp, entry)
    case ('CONTACT_2D_AUTOMATIC_TIED', 'CONTACT_2D_AUTOMATIC_TIED_ONE_WAY')
      call take_automatic(deck, cursor, cards, commanded, entry)
      call take_stock_tie(real_of(cards(3), 'TIEDGAP'), entry)
    case default
      call take_automatic(deck, cursor, cards, commanded, entry)
      call take_stock_friction(deck, cursor, cards, overrides, entry)
    end select
    before = entry
    call take_overrides(overrides, entry)
    call check_tie(deck, deck%blocks(i_block)%keyword, overrides, commanded, before, &
      entry)
    call check_values(deck, cursor, cards, kinds, overrides, commanded, entry)
    if (entry%contact%chosen_by_keyword) then
      if (.not. any(kinds%number == entry%contact%contact_type)) call line_error(deck, &
        deck%blocks(i_block)%keyword, 'stands for contact type ' &
        //to_text(entry%contact%contact_type)//', which this version does not have' &
        //kind_names(kinds))
    end if
    entry%kind = name_of(kinds, entry%contact%contact_type)
    raw%n_contact = raw%n_contact + 1
    raw%contacts(raw%n_contact) = entry
  end subroutine read_contact

  !> The type that a stock keyword stands for; 0 for our own.
  pure function stock_type(name) result(contact_type)
    character(*), intent(in) :: name
    integer :: contact_type

    select case (name)
    case ('CONTACT_2D_AUTOMATIC_NODE_TO_SURFACE')
      contact_type = type_nts
    case ('CONTACT_2D_AUTOMATIC_ONE_WAY_SURFACE_TO_SURFACE')
      contact_type = type_nts_ar
    case ('CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE', 'CONTACT_2D_PENALTY', &
        'CONTACT_2D_PENALTY_FRICTION', 'CONTACT_2D_SLIDING_VOIDS')
      contact_type = type_two_pass_ar
    case ('CONTACT_2D_AUTOMATIC_TIED', 'CONTACT_2D_AUTOMATIC_TIED_ONE_WAY', &
        'CONTACT_2D_TIED_SLIDING', 'CONTACT_2D_AUTOMATIC_SINGLE_SURFACE')
      contact_type = type_nts_mar
    case ('CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE_MORTAR', &
        'CONTACT_2D_AUTOMATIC_SINGLE_SURFACE_MORTAR')
      contact_type = type_segmented_mortar
    case default
      contact_type = 0
    end select
  end function stock_type

  !> SURFA and SURFB. A surface with itself is a part set: our keyword says so by SURFB 0, those of
  !> a single surface by their name.
  subroutine take_sides(deck, cursor, card, name, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name !! of the keyword
    type(raw_contact_t), intent(inout) :: entry
    logical :: is_single
    integer :: k

    is_single = index(name, '_SINGLE_SURFACE') > 0
    entry%contact%is_self = is_single
    if (name == 'CONTACT_2D_SLIDELINE') entry%contact%is_self = integer_of(card, 'SURFA') > 0 &
      .and. integer_of(card, 'SURFB') == 0 .and. .not. is_bad(card, 'SURFB')
    if (is_single .and. integer_of(card, 'SURFA') < 0) call report_field(deck, cursor, card, &
      'SURFA', 'is not a part set (more than 0): contact of a surface with itself is that of ' &
      //'whole outlines')
    do k = 1, 2
      if (k == 2 .and. entry%contact%is_self) then
        entry%places(k) = entry%places(1)
        return
      end if
      if (integer_of(card, side_fields(k)) == 0) call report_field(deck, cursor, card, &
        side_fields(k), 'is not a surface (more than 0: part set, less than 0: node set)' &
        //of_itself(k, name))
      entry%places(k) = place_of(card, side_fields(k))
      if (.not. is_bad(card, side_fields(k))) entry%sides(k) = integer_of(card, side_fields(k))
    end do
  end subroutine take_sides

  !> What SURFB 0 needs.
  pure function of_itself(side, name) result(text)
    integer, intent(in) :: side
    character(*), intent(in) :: name !! of the keyword
    character(:), allocatable :: text

    text = ''
    if (side == 2 .and. name == 'CONTACT_2D_SLIDELINE') text = '; SURFA with itself (0) only ' &
      //'where that is a part set'
  end function of_itself

  !> *CONTACT_2D_SLIDELINE.
  subroutine take_slideline(deck, cursor, cards, commanded, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    logical, intent(in) :: commanded(:)
    type(raw_contact_t), intent(inout) :: entry

    associate (contact => entry%contact)
      contact%contact_type = integer_of(cards(1), 'CTYPE')
      if (is_blank(cards(1), 'CTYPE')) contact%contact_type = type_missing
      contact%n_gauss = integer_of(cards(1), 'NGAUSS')
      contact%penalty = real_of(cards(1), 'PEN')
      contact%penalty_unit = integer_of(cards(2), 'PUNIT')
      entry%unit_place = place_of(cards(2), 'PUNIT')
      contact%master_penalty = contact%penalty
      if (abs(real_of(cards(2), 'PENT')) > 0.0_wp) &
        contact%master_penalty = real_of(cards(2), 'PENT')
      if (real_of(cards(2), 'PENT') < 0.0_wp .and. .not. commanded(of_master_penalty)) &
        call report_field(deck, cursor, cards(2), 'PENT', 'is not a penalty (more than 0)')
      call take_life(deck, cursor, cards(2), life, contact%birth, contact%death)
      entry%per_cent = real_of(cards(2), 'VDC')
      contact%strict = integer_of(cards(2), 'IPF') == 1
      call take_search(cards(2), entry)
      if (.not. any(integer_of(cards(3), 'TIE') == [tie_always, tie_breaks])) &
        call refuse_negative(deck, cursor, cards(2), 'SRCH')
      contact%search_depth = real_of(cards(2), 'SRCH')
      contact%target = real_of(cards(3), 'TARGET')
    end associate
    call take_interference(deck, cursor, cards(3), entry)
  end subroutine take_slideline

  !> LCINT: the curve by which an initial overlap grows.
  subroutine take_interference(deck, cursor, card, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_contact_t), intent(inout) :: entry

    if (integer_of(card, 'LCINT') == 0) return
    if (integer_of(card, 'TIE') /= tie_none) call report_field(deck, cursor, card, 'LCINT', &
      'asks for an overlap that grows, which a tie does not have (it keeps its gaps)')
    if (entry%contact%is_self) call report_field(deck, cursor, card, 'LCINT', &
      'asks for an overlap that grows, which is not supported of a surface with itself (SURFB 0)')
    if (entry%contact%birth > 0.0_wp) call report_field(deck, cursor, card, 'LCINT', &
      'asks for the overlap of time zero to grow; the interface must act from then on (TBIRTH 0)')
    if (is_bad(card, 'LCINT')) return
    entry%interference = integer_of(card, 'LCINT')
    entry%interference_place = place_of(card, 'LCINT')
  end subroutine take_interference

  !> *CONTACT_2D_AUTOMATIC_: penalty as a factor on the built-in estimate.
  subroutine take_automatic(deck, cursor, cards, commanded, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    logical, intent(in) :: commanded(:)
    type(raw_contact_t), intent(inout) :: entry

    associate (contact => entry%contact)
      contact%chosen_by_keyword = .true.
      contact%penalty_unit = penalty_factor
      contact%penalty = 1.0_wp
      if (real_of(cards(1), 'SFACT') < 0.0_wp .and. .not. commanded(of_penalty)) &
        call report_field(deck, cursor, cards(1), 'SFACT', 'is negative')
      if (real_of(cards(1), 'SFACT') > 0.0_wp) contact%penalty = real_of(cards(1), 'SFACT')
      contact%master_penalty = contact%penalty
      call take_search(cards(1), entry)
      call take_life(deck, cursor, cards(2), life, contact%birth, contact%death)
      entry%per_cent = real_of(cards(3), 'VDC')
    end associate
  end subroutine take_automatic

  !> *CONTACT_2D_PENALTY and its kin with friction: node sets, written with a positive number there;
  !> PEN is the factor on the built-in estimate that the others multiply from SFACT and SLSFAC.
  subroutine take_penalty(deck, cursor, cards, commanded, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    logical, intent(in) :: commanded(:)
    type(raw_contact_t), intent(inout) :: entry
    integer :: k

    associate (contact => entry%contact)
      contact%chosen_by_keyword = .true.
      contact%penalty_unit = penalty_factor
      do k = 1, 2
        if (entry%sides(k) < 0) call report_field(deck, cursor, cards(1), side_fields(k), &
          'is not a node set number (1 or more)')
        entry%sides(k) = -abs(entry%sides(k))
      end do
      if (real_of(cards(2), 'PEN') < 0.0_wp .and. .not. commanded(of_penalty)) &
        call report_field(deck, cursor, cards(2), 'PEN', 'is negative')
      contact%penalty = 1.0_wp
      if (real_of(cards(2), 'PEN') > 0.0_wp) contact%penalty = real_of(cards(2), 'PEN')/0.1_wp
      contact%master_penalty = contact%penalty
      call take_life(deck, cursor, cards(1), life, contact%birth, contact%death)
    end associate
  end subroutine take_penalty

  !> FREQ: cycles between two searches. Their sum with the cycle of a run must stay a whole number.
  subroutine take_search(card, entry)
    type(card_t), intent(in) :: card
    type(raw_contact_t), intent(inout) :: entry

    if (is_bad(card, 'FREQ')) return
    entry%contact%search_interval = integer_of(card, 'FREQ')
    entry%search_place = place_of(card, 'FREQ')
  end subroutine take_search

end module deck_contact_m
