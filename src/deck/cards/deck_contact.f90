! SPDX-License-Identifier: MIT
!> *CONTACT_2D_ cards. Contact types are numbers and names handed in by the caller; the stock
!> keywords stand for types that must be among them. A stock card that the command line changes, or
!> that leaves the type to the program, is written as our own card first.
module deck_contact_m
  use kinds_m, only : wp
  use number_text_m, only : shortest
  use log_m, only : to_text
  use contact_types_m, only : type_nts, type_nts_ar, type_two_pass_ar, type_nts_mar, &
    type_segmented_mortar, type_missing, type_chosen
  use contacts_m, only : contact_t, contact_kind_t, friction_rule_t, kind_text, is_tied, breaks, &
    penalty_distributed, penalty_factor, penalty_share, penalty_implicit, implicit_factor, &
    tie_none, tie_always, tie_breaks
  use deck_lines_m, only : deck_t, line_error, given_by
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, check_rest, &
    report_field
  use deck_edits_m, only : given_number, set_field, rewrite_block
  use deck_values_m, only : integer_of, real_of, is_blank, is_bad, place_of, take_life
  use deck_friction_m, only : take_friction, take_stock_friction, take_penalty_friction, &
    warn_of_rule
  use deck_tie_m, only : take_tie, take_stock_tie, check_tie
  use deck_raw_m, only : raw_t, raw_contact_t
  use deck_overrides_m, only : contact_names, find_word, edit_contact
  implicit none
  private
  public :: read_contact, leaves_type, write_choice

  !> Fields of the two sides, of the times between which an interface acts.
  character(5), parameter :: side_fields(2) = ['SURFA', 'SURFB']
  character(6), parameter :: life(2) = ['TBIRTH', 'TDEATH']
  character(*), parameter :: our_own = 'CONTACT_2D_SLIDELINE', &
    transducer = 'CONTACT_2D_FORCE_TRANSDUCER'

contains

  !> One interface, or one *CONTACT_2D_FORCE_TRANSDUCER: a surface on which forces are added up.
  subroutine read_contact(deck, i_block, kinds, raw)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(contact_kind_t), intent(in) :: kinds(:)
    type(raw_t), intent(inout) :: raw
    type(raw_contact_t) :: entry
    integer :: n_error, k
    logical :: is_stock

    is_stock = deck%blocks(i_block)%name /= our_own
    n_error = deck%report%n_error
    call read_number(deck, i_block, raw, entry)
    if (deck%blocks(i_block)%name == transducer) then
      call read_cards(deck, i_block, kinds, raw, entry)
      raw%n_transducer = raw%n_transducer + 1
      raw%transducers(raw%n_transducer) = entry
      return
    end if
    if (any([(find_word(deck, trim(contact_names(k)), entry%contact%id) > 0, k=1, &
      size(contact_names))])) then
      if (is_stock) then
        call leave_negatives(deck, i_block, entry%contact%id)
        call read_cards(deck, i_block, kinds, raw, entry)
        if (deck%report%n_error == n_error) call write_as_ours(deck, entry)
      end if
      if (deck%report%n_error == n_error) call edit_contact(deck, i_block, entry%contact%id)
    end if
    if (deck%report%n_error == n_error) call read_cards(deck, i_block, kinds, raw, entry)
    entry%contact%chosen_by_keyword = is_stock .and. find_word(deck, 'CTYPE', entry%contact%id) == 0
    if (entry%contact%chosen_by_keyword .and. .not. any(kinds%number &
      == entry%contact%contact_type)) call line_error(deck, deck%blocks(i_block)%keyword, &
      'stands for contact type '//to_text(entry%contact%contact_type)//', which this version ' &
      //'does not have'//kind_names(kinds))
    if (.not. is_tied(entry%contact) .or. breaks(entry%contact)) call warn_of_rule(deck, entry)
    raw%n_contact = raw%n_contact + 1
    raw%contacts(raw%n_contact) = entry
  end subroutine read_contact

  !> The title and the number of an interface or transducer: its own, or its position in the deck.
  subroutine read_number(deck, i_block, raw, entry)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: i_block
    type(raw_t), intent(in) :: raw
    type(raw_contact_t), intent(inout) :: entry
    type(cursor_t) :: cursor

    call open_cursor(deck, i_block, cursor)
    entry%contact%title = ''
    if (deck%blocks(i_block)%titled) call next_heading(deck, cursor, entry%contact%id, &
      entry%contact%title)
    entry%block = i_block
    if (entry%contact%id == 0) entry%contact%id = raw%n_contact + raw%n_transducer + 1
  end subroutine read_number

  !> The cards of an interface with what they mean, and their rules.
  subroutine read_cards(deck, i_block, kinds, raw, entry)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(contact_kind_t), intent(in) :: kinds(:)
    type(raw_t), intent(inout) :: raw
    type(raw_contact_t), intent(out) :: entry
    type(cursor_t) :: cursor
    type(card_t) :: cards(4)
    character(:), allocatable :: name
    integer :: k

    call read_number(deck, i_block, raw, entry)
    call open_cursor(deck, i_block, cursor)
    if (deck%blocks(i_block)%titled) cursor%line = cursor%line + 1
    do k = 1, cursor%n_card
      call next_card(deck, cursor, k, cards(k))
    end do
    call check_rest(deck, cursor)
    name = trim(deck%blocks(i_block)%name)
    associate (contact => entry%contact)
      call take_sides(deck, cards(1), name, entry)
      if (name == transducer) return
      contact%contact_type = stock_type(name)
      select case (name)
      case (our_own)
        call take_slideline(deck, cards, entry)
        call take_tie(deck, cards, entry)
        call take_friction(cards, entry)
      case ('CONTACT_2D_PENALTY', 'CONTACT_2D_PENALTY_FRICTION', 'CONTACT_2D_SLIDING_VOIDS')
        call take_penalty(deck, cards, entry)
        if (cursor%n_card > 2) call take_penalty_friction(deck, cards(3), entry)
      case ('CONTACT_2D_TIED_SLIDING')
        call take_penalty(deck, cards, entry)
        call take_stock_tie(0.0_wp, entry)
      case ('CONTACT_2D_AUTOMATIC_TIED', 'CONTACT_2D_AUTOMATIC_TIED_ONE_WAY')
        call take_automatic(deck, cards, entry)
        call take_stock_tie(real_of(cards(3), 'TIEDGAP'), entry)
      case default
        call take_automatic(deck, cards, entry)
        call take_stock_friction(cards, raw, entry)
      end select
      contact%damping = entry%per_cent/100.0_wp
      call check_tie(deck, deck%blocks(i_block)%keyword, entry)
      if (name == our_own) call check_slideline(deck, cards, kinds, entry)
    end associate
  end subroutine read_cards

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
  subroutine take_sides(deck, card, name, entry)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    character(*), intent(in) :: name !! of the keyword
    type(raw_contact_t), intent(inout) :: entry
    character(:), allocatable :: of_itself
    logical :: is_single
    integer :: k

    is_single = index(name, '_SINGLE_SURFACE') > 0
    entry%contact%is_self = is_single
    if (name == our_own) entry%contact%is_self = integer_of(card, 'SURFA') > 0 &
      .and. integer_of(card, 'SURFB') == 0 .and. .not. is_bad(card, 'SURFB')
    if (is_single .and. integer_of(card, 'SURFA') < 0) call report_field(deck, card, 'SURFA', &
      'is not a part set (more than 0): contact of a surface with itself is that of whole outlines')
    of_itself = ''
    do k = 1, merge(1, 2, name == transducer)
      if (k == 2 .and. entry%contact%is_self) then
        entry%places(k) = entry%places(1)
        return
      end if
      if (k == 2 .and. name == our_own) of_itself = '; SURFA with itself (0) only where that is ' &
        //'a part set'
      if (integer_of(card, side_fields(k)) == 0) call report_field(deck, card, side_fields(k), &
        'is not a surface (more than 0: part set, less than 0: node set)'//of_itself)
      entry%places(k) = place_of(card, side_fields(k))
      if (.not. is_bad(card, side_fields(k))) entry%sides(k) = integer_of(card, side_fields(k))
    end do
  end subroutine take_sides

  !> *CONTACT_2D_SLIDELINE.
  subroutine take_slideline(deck, cards, entry)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(raw_contact_t), intent(inout) :: entry

    associate (contact => entry%contact)
      contact%contact_type = integer_of(cards(1), 'CTYPE')
      if (is_blank(cards(1), 'CTYPE')) contact%contact_type = type_missing
      contact%n_gauss = integer_of(cards(1), 'NGAUSS')
      contact%penalty = real_of(cards(1), 'PEN')
      contact%penalty_unit = integer_of(cards(2), 'PUNIT')
      entry%unit_place = place_of(cards(2), 'PUNIT')
      contact%master_penalty = contact%penalty
      if (real_of(cards(2), 'PENT') > 0.0_wp) contact%master_penalty = real_of(cards(2), 'PENT')
      call take_life(deck, cards(2), life, contact%birth, contact%death)
      entry%per_cent = real_of(cards(2), 'VDC')
      contact%strict = integer_of(cards(2), 'IPF') == 1
      call take_search(cards(2), entry)
      contact%search_depth = real_of(cards(2), 'SRCH')
      if (contact%search_depth < 0.0_wp .and. all(integer_of(cards(3), 'TIE') /= [tie_always, &
        tie_breaks])) call report_field(deck, cards(2), 'SRCH', 'is negative')
      contact%target = real_of(cards(3), 'TARGET')
    end associate
    call take_interference(deck, cards(3), entry)
  end subroutine take_slideline

  !> LCINT: the curve by which an initial overlap grows.
  subroutine take_interference(deck, card, entry)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(raw_contact_t), intent(inout) :: entry

    if (integer_of(card, 'LCINT') == 0) return
    if (integer_of(card, 'TIE') /= tie_none) call report_field(deck, card, 'LCINT', &
      'asks for an overlap that grows, which a tie does not have (it keeps its gaps)')
    if (entry%contact%is_self) call report_field(deck, card, 'LCINT', &
      'asks for an overlap that grows, which is not supported of a surface with itself (SURFB 0)')
    if (entry%contact%birth > 0.0_wp) call report_field(deck, card, 'LCINT', &
      'asks for the overlap of time zero to grow; the interface must act from then on (TBIRTH 0)')
    if (is_bad(card, 'LCINT')) return
    entry%interference = integer_of(card, 'LCINT')
    entry%interference_place = place_of(card, 'LCINT')
  end subroutine take_interference

  !> *CONTACT_2D_AUTOMATIC_: penalty as a factor on the built-in estimate.
  subroutine take_automatic(deck, cards, entry)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(raw_contact_t), intent(inout) :: entry

    associate (contact => entry%contact)
      contact%penalty_unit = penalty_factor
      contact%penalty = real_of(cards(1), 'SFACT')
      contact%master_penalty = contact%penalty
      call take_search(cards(1), entry)
      call take_life(deck, cards(2), life, contact%birth, contact%death)
      entry%per_cent = real_of(cards(3), 'VDC')
    end associate
  end subroutine take_automatic

  !> *CONTACT_2D_PENALTY and its kin with friction: node sets, written with a positive number there;
  !> PEN is the factor on the built-in estimate that the others multiply from SFACT and SLSFAC.
  subroutine take_penalty(deck, cards, entry)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(raw_contact_t), intent(inout) :: entry
    integer :: k

    associate (contact => entry%contact)
      contact%penalty_unit = penalty_factor
      do k = 1, 2
        if (entry%sides(k) < 0) call report_field(deck, cards(1), side_fields(k), &
          'is not a node set number (1 or more)')
        entry%sides(k) = -abs(entry%sides(k))
      end do
      contact%penalty = real_of(cards(2), 'PEN')/0.1_wp
      contact%master_penalty = contact%penalty
      call take_life(deck, cards(1), life, contact%birth, contact%death)
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

  !> Rules of the type and the penalty of *CONTACT_2D_SLIDELINE; PUNIT 4 has a PEN where that is
  !> blank.
  subroutine check_slideline(deck, cards, kinds, entry)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(contact_kind_t), intent(in) :: kinds(:)
    type(raw_contact_t), intent(inout) :: entry
    character(:), allocatable :: name
    logical :: leaves_penalty

    associate (contact => entry%contact)
      name = 'type '//to_text(contact%contact_type)
      if (any(kinds%number == contact%contact_type)) &
        name = kind_text(kinds(findloc(kinds%number, contact%contact_type, 1)))
      if (contact%penalty_unit == penalty_implicit .and. .not. abs(contact%penalty) > 0.0_wp) &
        contact%penalty = implicit_factor
      leaves_penalty = leaves_type(contact) .and. .not. abs(contact%penalty) > 0.0_wp &
        .and. contact%penalty_unit /= penalty_distributed
      if (.not. any([type_chosen, kinds%number] == contact%contact_type)) call report_field(deck, &
        cards(1), 'CTYPE', 'is not a contact type'//kind_names(kinds))
      if (contact%penalty <= 0.0_wp .and. contact%penalty_unit /= penalty_implicit &
        .and. .not. leaves_penalty) call report_field(deck, cards(1), 'PEN', &
        'is not a penalty (more than 0)')
      if (contact%penalty_unit == penalty_implicit .and. any(kinds%number == contact%contact_type &
        .and. .not. kinds%has_implicit_springs)) call report_field(deck, cards(2), 'PUNIT', &
        'asks for implicit springs'//implicit_names(kinds))
      if (len(given_by(deck, cards(3)%line, findloc(cards(3)%names, 'TARGET', 1))) > 0 &
        .and. .not. leaves_type(contact)) call report_field(deck, cards(3), 'TARGET', &
        'is for types that the program chooses (CTYPE 0); interface '//to_text(contact%id) &
        //' has '//name)
      if (contact%penalty_unit == penalty_share .and. contact%penalty > 1.0_wp) call report_field( &
        deck, cards(1), 'PEN', &
        'is not a share of the largest stable penalty (PUNIT 3: above 0, at most 1)')
    end associate
  end subroutine check_slideline

  !> Whether the type is the program's to choose.
  pure function leaves_type(contact) result(leaves)
    type(contact_t), intent(in) :: contact
    logical :: leaves

    leaves = type_chosen == contact%contact_type
  end function leaves_type

  !> Fields of a stock card that are below 0 and that the command line replaces are left blank.
  subroutine leave_negatives(deck, i_block, id)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    integer, intent(in) :: id
    character(6), parameter :: fields(10) = [character(6) :: 'SFACT', 'PEN', 'FS', 'FRIC', &
      'FRIC_L', 'FRIC_H', 'FD', 'DC', 'VC', 'VDC'], &
      words(10) = [character(6) :: 'PEN', 'PEN', 'FS', 'FS', 'FS', 'FS', 'FD', 'DC', 'VC', 'VDC']
    real(wp) :: value
    integer :: k

    do k = 1, size(fields)
      if (find_word(deck, trim(words(k)), id) == 0) cycle
      call given_number(deck, i_block, trim(fields(k)), value)
      if (value < 0.0_wp) call set_field(deck, i_block, trim(fields(k)), '')
    end do
  end subroutine leave_negatives

  !> Write a stock card as *CONTACT_2D_SLIDELINE. What is as without a field is left blank.
  subroutine write_as_ours(deck, entry)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    character(*), parameter :: end_of_line = new_line('a')
    character(:), allocatable :: text, third
    character(10) :: id
    type(friction_rule_t) :: default

    deck%blocks(entry%block)%titled = .true.
    write (id, '(ss,i10)') entry%contact%id
    associate (c => entry%contact, rule => entry%contact%friction)
      text = id//c%title//end_of_line//to_text(entry%sides(1))//','//to_text(entry%sides(2)) &
        //','//to_text(c%contact_type)//','//to_text(c%n_gauss)//','//shortest(c%penalty)
      if (max(rule%at_rest, rule%sliding, rule%decay) > 0.0_wp) text = text//',' &
        //shortest(rule%at_rest)//','//shortest(rule%sliding)//','//shortest(rule%decay)
      text = text//end_of_line//shortest(c%birth)//','//shortest(c%death)//',' &
        //to_text(c%penalty_unit)//','//shortest(c%master_penalty)//','//shortest(entry%per_cent) &
        //','//to_text(merge(1, 0, c%strict))//','//to_text(c%search_interval)//',' &
        //shortest(merge(c%tie_reach, c%search_depth, is_tied(c)))//end_of_line
      third = ''
      if (is_tied(c)) then
        third = '0,1,'//to_text(c%tie)//end_of_line
      else if (rule%most > 0.0_wp .or. abs(rule%stiffness - default%stiffness) > 0.0_wp) then
        third = shortest(rule%most)//','//shortest(rule%stiffness)//end_of_line
      end if
    end associate
    call rewrite_block(deck, entry%block, our_own, text//third)
  end subroutine write_as_ours

  !> Write what the program chose into the card.
  subroutine write_choice(deck, i_block, contact)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: i_block
    type(contact_t), intent(in) :: contact

    call set_field(deck, i_block, 'CTYPE', to_text(contact%contact_type))
    call set_field(deck, i_block, 'PEN', shortest(contact%penalty))
    call set_field(deck, i_block, 'PUNIT', to_text(contact%penalty_unit))
    call set_field(deck, i_block, 'PENT', shortest(max(contact%master_penalty, 0.0_wp)))
    call set_field(deck, i_block, 'TARGET', shortest(contact%target))
  end subroutine write_choice

  !> `, which only name (type n) has`.
  pure function implicit_names(kinds) result(text)
    type(contact_kind_t), intent(in) :: kinds(:)
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(kinds)
      if (.not. kinds(i)%has_implicit_springs) cycle
      if (len(text) > 0) text = text//' and '
      text = text//kind_text(kinds(i))
    end do
    text = ', which only '//text//' has (CTYPE)'
  end function implicit_names

  !> ` (1 name, 2 name, ...)`.
  pure function kind_names(kinds) result(text)
    type(contact_kind_t), intent(in) :: kinds(:)
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(kinds)
      text = text//merge(' (', ', ', i == 1)//to_text(kinds(i)%number)//' '//trim(kinds(i)%name)
    end do
    if (size(kinds) > 0) text = text//')'
  end function kind_names

end module deck_contact_m
