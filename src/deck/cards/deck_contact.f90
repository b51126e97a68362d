! SPDX-License-Identifier: MIT
!> *CONTACT_2D_ cards. The caller passes numbers and names of the contact types; the types of stock
!> keywords must be among them. A stock card that the command line changes is rewritten as
!> *CONTACT_2D_SLIDELINE first.
module deck_contact_m
  use kinds_m, only : wp
  use text_m, only : shortest
  use log_m, only : to_text
  use model_m, only : model_t
  use contacts_m, only : type_nts, type_nts_ar, type_two_pass_ar, type_nts_mar, &
    type_segmented_mortar, type_missing, type_chosen, contact_t, contact_kind_t, friction_rule_t, &
    kind_text, is_tied, breaks, penalty_per_node, penalty_distributed, penalty_factor, &
    penalty_share, penalty_implicit, implicit_factor, tie_always, tie_breaks, tie_factor
  use deck_lines_m, only : deck_t, location_t, line_error, line_warning, given_by
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, open_cursor, next_card, next_heading, check_rest, &
    report_field, warn_of_field
  use deck_edits_m, only : given_number, set_field, rewrite_block
  use deck_values_m, only : integer_of, real_of, is_blank, is_bad, location_of, read_active_time
  use deck_friction_m, only : default_friction_t, read_friction, read_stock_friction, &
    read_penalty_friction, warn_of_rule
  use deck_interference_m, only : read_interference
  use deck_overrides_m, only : contact_names, find_word, edit_contact
  implicit none
  private
  public :: contact_cards_t, transducer, side_fields, read_contact

  !> One interface or transducer with its cards, for messages about its surfaces.
  type :: contact_cards_t
    integer :: block = 0                !! keyword block in the deck
    integer :: position = 0             !! among those of the deck
    type(contact_t) :: contact
    type(card_t) :: cards(4)
    integer :: sides(2) = 0             !! SURFA, SURFB: > 0 part set, < 0 node set
    integer :: friction_line = 0        !! line of the coefficient of friction
  end type contact_cards_t

  !> Fields of the two sides, and of birth and death time.
  character(5), parameter :: side_fields(2) = ['SURFA', 'SURFB']
  character(6), parameter :: active_time(2) = ['TBIRTH', 'TDEATH']
  character(*), parameter :: slideline_keyword = 'CONTACT_2D_SLIDELINE', &
    transducer = 'CONTACT_2D_FORCE_TRANSDUCER'

  !> One degree, rad, and the largest turn of segments that stand for arcs where the deck does not
  !> say (SMOOTH 0): 24 segments on a circle turn by 15 degrees.
  real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp, usual_turn = 16.0_wp*degree

contains

  !> Read one interface or one *CONTACT_2D_FORCE_TRANSDUCER. Curves have been read.
  subroutine read_contact(deck, entry, kinds, model, default)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(inout) :: entry         !! has its block and position
    type(contact_kind_t), intent(in) :: kinds(:)          !! contact types that exist
    type(model_t), intent(in) :: model
    type(default_friction_t), intent(inout) :: default    !! of *CONTROL_CONTACT
    type(cursor_t) :: cursor
    integer :: n_error, k
    logical :: is_stock

    n_error = deck%report%n_error
    call read_number(deck, entry, cursor)
    is_stock = deck%blocks(entry%block)%name /= slideline_keyword
    if (deck%blocks(entry%block)%name == transducer) then
      call read_cards(deck, kinds, model, default, entry)
      return
    end if
    if (any([(find_word(deck, trim(contact_names(k)), entry%contact%id) > 0, k=1, &
      size(contact_names))])) then
      if (is_stock) then
        call blank_negatives(deck, entry%block, entry%contact%id)
        call read_cards(deck, kinds, model, default, entry)
        if (deck%report%n_error == n_error) call write_as_slideline(deck, entry)
      end if
      if (deck%report%n_error == n_error) call edit_contact(deck, entry%block, entry%contact%id)
    end if
    if (deck%report%n_error == n_error) call read_cards(deck, kinds, model, default, entry)
    associate (contact => entry%contact)
      contact%damping = contact%damping/100.0_wp
      contact%chosen_by_keyword = is_stock .and. find_word(deck, 'CTYPE', contact%id) == 0
      if (contact%chosen_by_keyword .and. .not. any(kinds%number == contact%contact_type)) &
        call line_error(deck, deck%blocks(entry%block)%keyword, 'means contact type ' &
        //to_text(contact%contact_type)//', which this version does not have'//kind_names(kinds))
      if (.not. is_tied(contact) .or. breaks(contact)) call warn_of_rule(deck, &
        entry%friction_line, contact)
    end associate
  end subroutine read_contact

  !> Read title and number of an interface or transducer; the default number is its position in the
  !> deck.
  subroutine read_number(deck, entry, cursor)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(inout) :: entry
    type(cursor_t), intent(out) :: cursor         !! at the first card

    call open_cursor(deck, entry%block, cursor)
    entry%contact%title = ''
    if (deck%blocks(entry%block)%titled) call next_heading(deck, cursor, entry%contact%id, &
      entry%contact%title)
    if (entry%contact%id == 0) entry%contact%id = entry%position
  end subroutine read_number

  !> Read the cards of an interface and check their rules.
  subroutine read_cards(deck, kinds, model, default, entry)
    type(deck_t), intent(inout) :: deck
    type(contact_kind_t), intent(in) :: kinds(:)
    type(model_t), intent(in) :: model
    type(default_friction_t), intent(inout) :: default
    type(contact_cards_t), intent(inout) :: entry
    type(cursor_t) :: cursor
    type(location_t) :: location       !! of the coefficient of friction
    character(:), allocatable :: name
    integer :: k

    entry = contact_cards_t(block=entry%block, position=entry%position)
    call read_number(deck, entry, cursor)
    do k = 1, cursor%n_card
      call next_card(deck, cursor, k, entry%cards(k))
    end do
    call check_rest(deck, cursor)
    name = trim(deck%blocks(entry%block)%name)
    associate (contact => entry%contact, cards => entry%cards)
      call read_sides(deck, name, entry)
      if (name == transducer) return
      contact%contact_type = stock_type(name)
      contact%largest_turn = usual_turn
      select case (name)
      case (slideline_keyword)
        call read_slideline(deck, cards, contact)
        call read_interference(deck, cards(3), model, contact)
        call read_tie(deck, cards, contact)
        call read_friction(cards, contact%friction, location)
      case ('CONTACT_2D_PENALTY', 'CONTACT_2D_PENALTY_FRICTION', 'CONTACT_2D_SLIDING_VOIDS', &
          'CONTACT_2D_TIED_SLIDING')
        call read_penalty(deck, entry)
        if (cursor%n_card > 2) call read_penalty_friction(deck, cards(3), contact%friction, &
          location)
      case default
        call read_automatic(deck, cards, contact)
        if (index(name, '_TIED') > 0) then
          contact%tie_distance = real_of(cards(3), 'TIEDGAP')
        else
          call read_stock_friction(cards, default, contact%friction, location)
        end if
      end select
      if (index(name, '_TIED') > 0) then
        ! SFACT multiplies the default penalty of ties; damping and FREQ have no effect.
        contact%tie = tie_always
        contact%penalty = tie_factor*contact%penalty
        contact%master_penalty = contact%penalty
        contact%search_interval = 0
        contact%damping = 0.0_wp
      end if
      entry%friction_line = location%line
      call check_tie(deck, deck%blocks(entry%block)%keyword, contact)
      if (name == slideline_keyword) call check_slideline(deck, cards, kinds, contact)
    end associate
  end subroutine read_cards

  !> The contact type of a stock keyword; 0 for *CONTACT_2D_SLIDELINE.
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

  !> SURFA and SURFB. Self contact needs a part set: SURFB 0 of *CONTACT_2D_SLIDELINE, or a
  !> _SINGLE_SURFACE keyword.
  subroutine read_sides(deck, name, entry)
    type(deck_t), intent(inout) :: deck
    character(*), intent(in) :: name !! of the keyword
    type(contact_cards_t), intent(inout) :: entry
    character(:), allocatable :: of_itself
    logical :: is_single
    integer :: k

    is_single = index(name, '_SINGLE_SURFACE') > 0
    of_itself = ''
    associate (card => entry%cards(1), is_self => entry%contact%is_self)
      is_self = is_single
      if (name == slideline_keyword) is_self = integer_of(card, 'SURFA') > 0 &
        .and. integer_of(card, 'SURFB') == 0 .and. .not. is_bad(card, 'SURFB')
      if (is_single .and. integer_of(card, 'SURFA') < 0) call report_field(deck, card, 'SURFA', &
        'is not a part set (more than 0): self contact needs closed boundaries')
      do k = 1, merge(1, 2, name == transducer .or. is_self)
        if (k == 2 .and. name == slideline_keyword) of_itself = &
          '; self contact (0) needs a part set in SURFA'
        if (integer_of(card, side_fields(k)) == 0) call report_field(deck, card, side_fields(k), &
          'is not a surface (more than 0: part set, less than 0: node set)'//of_itself)
        if (.not. is_bad(card, side_fields(k))) entry%sides(k) = integer_of(card, side_fields(k))
      end do
    end associate
  end subroutine read_sides

  !> *CONTACT_2D_SLIDELINE. VDC is in per cent here.
  subroutine read_slideline(deck, cards, contact)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(contact_t), intent(inout) :: contact

    contact%contact_type = integer_of(cards(1), 'CTYPE')
    if (is_blank(cards(1), 'CTYPE')) contact%contact_type = type_missing
    contact%n_gauss = integer_of(cards(1), 'NGAUSS')
    contact%penalty = real_of(cards(1), 'PEN')
    contact%penalty_unit = integer_of(cards(2), 'PUNIT')
    contact%master_penalty = contact%penalty
    if (real_of(cards(2), 'PENT') > 0.0_wp) contact%master_penalty = real_of(cards(2), 'PENT')
    call read_active_time(deck, cards(2), active_time, contact%birth, contact%death)
    contact%damping = real_of(cards(2), 'VDC')
    contact%strict = integer_of(cards(2), 'IPF') == 1
    if (.not. is_bad(cards(2), 'FREQ')) contact%search_interval = integer_of(cards(2), 'FREQ')
    contact%search_depth = real_of(cards(2), 'SRCH')
    if (contact%search_depth < 0.0_wp .and. all(integer_of(cards(3), 'TIE') /= [tie_always, &
      tie_breaks])) call report_field(deck, cards(2), 'SRCH', 'is negative')
    contact%target = real_of(cards(3), 'TARGET')
    select case (integer_of(cards(3), 'SMOOTH'))
    case (-1); contact%largest_turn = 0.0_wp
    case (1:89); contact%largest_turn = integer_of(cards(3), 'SMOOTH')*degree
    end select
  end subroutine read_slideline

  !> *CONTACT_2D_AUTOMATIC_: penalty as a factor on the built-in estimate.
  subroutine read_automatic(deck, cards, contact)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(contact_t), intent(inout) :: contact

    contact%penalty_unit = penalty_factor
    contact%penalty = real_of(cards(1), 'SFACT')
    contact%master_penalty = contact%penalty
    if (.not. is_bad(cards(1), 'FREQ')) contact%search_interval = integer_of(cards(1), 'FREQ')
    call read_active_time(deck, cards(2), active_time, contact%birth, contact%death)
    contact%damping = real_of(cards(3), 'VDC')
  end subroutine read_automatic

  !> *CONTACT_2D_PENALTY, _PENALTY_FRICTION, _SLIDING_VOIDS and _TIED_SLIDING: node sets with
  !> positive numbers; PEN corresponds to SFACT times SLSFAC of the other keywords.
  subroutine read_penalty(deck, entry)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(inout) :: entry
    integer :: k

    associate (contact => entry%contact, cards => entry%cards)
      contact%penalty_unit = penalty_factor
      do k = 1, 2
        if (entry%sides(k) < 0) call report_field(deck, cards(1), side_fields(k), &
          'is not a node set number (1 or more)')
        entry%sides(k) = -abs(entry%sides(k))
      end do
      contact%penalty = real_of(cards(2), 'PEN')/0.1_wp
      contact%master_penalty = contact%penalty
      call read_active_time(deck, cards(1), active_time, contact%birth, contact%death)
    end associate
  end subroutine read_penalty

  !> Check type and penalty of *CONTACT_2D_SLIDELINE; set the default PEN of PUNIT 4.
  subroutine check_slideline(deck, cards, kinds, contact)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(contact_kind_t), intent(in) :: kinds(:)
    type(contact_t), intent(inout) :: contact
    character(:), allocatable :: name
    logical :: lacks_penalty

    name = 'type '//to_text(contact%contact_type)
    if (any(kinds%number == contact%contact_type)) &
      name = kind_text(kinds(findloc(kinds%number, contact%contact_type, 1)))
    if (contact%penalty_unit == penalty_implicit .and. .not. abs(contact%penalty) > 0.0_wp) &
      contact%penalty = implicit_factor
    lacks_penalty = type_chosen == contact%contact_type .and. .not. abs(contact%penalty) > 0.0_wp &
      .and. contact%penalty_unit /= penalty_distributed
    if (.not. any([type_chosen, kinds%number] == contact%contact_type)) call report_field(deck, &
      cards(1), 'CTYPE', 'is not a contact type'//kind_names(kinds, 'the program chooses'))
    if (contact%penalty <= 0.0_wp .and. contact%penalty_unit /= penalty_implicit &
      .and. .not. lacks_penalty) call report_field(deck, cards(1), 'PEN', &
      'is not a penalty (more than 0)')
    if (contact%penalty_unit == penalty_implicit .and. any(kinds%number == contact%contact_type &
      .and. .not. kinds%has_implicit_springs)) call report_field(deck, cards(2), 'PUNIT', &
      'asks for implicit springs, which only '//kind_text(kinds(findloc( &
      kinds%has_implicit_springs, .true., 1)))//' has (CTYPE)')
    if (len(given_by(deck, cards(3)%line, findloc(cards(3)%names, 'TARGET', 1))) > 0 &
      .and. type_chosen /= contact%contact_type) call report_field(deck, cards(3), 'TARGET', &
      'needs CTYPE 0 (the program chooses the type); interface '//to_text(contact%id) &
      //' has '//name)
    if (contact%penalty_unit == penalty_share .and. contact%penalty > 1.0_wp) call report_field( &
      deck, cards(1), 'PEN', &
      'is not a share of the largest stable penalty (PUNIT 3: above 0, at most 1)')
  end subroutine check_slideline

  !> TIE, NFLS and SFLS of *CONTACT_2D_SLIDELINE. With TIE 1 or 2 SRCH is the largest gap that is
  !> tied. PEN 0 with PUNIT 0 or 2 means the default factor of ties.
  subroutine read_tie(deck, cards, contact)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(contact_t), intent(inout) :: contact

    call read_strength(deck, cards(3), contact)
    if (.not. any(integer_of(cards(3), 'TIE') == [tie_always, tie_breaks])) return
    contact%tie = integer_of(cards(3), 'TIE')
    contact%tie_distance = contact%search_depth
    contact%search_depth = 0.0_wp
    if (abs(contact%penalty) > 0.0_wp) return
    if (all(contact%penalty_unit /= [penalty_factor, penalty_per_node])) return
    if (abs(contact%master_penalty) > 0.0_wp) then
      if (contact%penalty_unit == penalty_per_node) call report_field(deck, cards(2), 'PENT', &
        'is a force per length (PUNIT 0), but the default of PEN for ties is a factor on the ' &
        //'built-in estimate; give PEN too, or PUNIT 2')
    else
      contact%master_penalty = tie_factor
    end if
    contact%penalty_unit = penalty_factor
    contact%penalty = tie_factor
  end subroutine read_tie

  !> NFLS and SFLS, which tiebreak needs both.
  subroutine read_strength(deck, card, contact)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(contact_t), intent(inout) :: contact
    character(4), parameter :: names(2) = ['NFLS', 'SFLS']
    integer :: k

    do k = 1, 2
      contact%strength(k) = real_of(card, names(k))
      if (integer_of(card, 'TIE') == tie_breaks) then
        if (.not. contact%strength(k) > 0.0_wp .and. .not. is_bad(card, names(k))) &
          call report_field(deck, card, names(k), 'is not a strength: tiebreak (TIE 2) needs ' &
          //'NFLS and SFLS above 0')
      else if (abs(contact%strength(k)) > 0.0_wp) then
        call warn_of_field(deck, location_of(card, names(k)), &
          'has no effect: only tiebreak (TIE 2) has strengths')
        contact%strength(k) = 0.0_wp
      end if
    end do
  end subroutine read_strength

  !> Report fields that ties do not support, and fields without effect. Tiebreak has damping,
  !> friction and FREQ, for contact after failure.
  subroutine check_tie(deck, line, contact)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line !! of the keyword
    type(contact_t), intent(inout) :: contact
    character(4), parameter :: fields(6) = [character(4) :: 'FS', 'FD', 'DC', 'VC', 'TFAC', 'FREQ']
    character(:), allocatable :: what, ignored
    type(friction_rule_t) :: none
    logical :: is_given(size(fields))
    integer :: k

    if (.not. is_tied(contact)) return
    what = 'interface '//to_text(contact%id)//' is tied'
    if (contact%is_self) call line_error(deck, line, what &
      //': a surface cannot be tied to itself (SURFB 0)')
    if (contact%penalty_unit == penalty_share) call line_error(deck, line, what//': its ' &
      //'penalty cannot be a share of the largest stable penalty (PUNIT 3)')
    if (contact%birth > 0.0_wp) call line_error(deck, line, what//' in the reference geometry: ' &
      //'a birth time (TBIRTH) is not supported')
    if (breaks(contact)) return
    if (contact%damping > 0.0_wp) call line_error(deck, line, what &
      //': contact damping (VDC) of ties is not supported')
    associate (rule => contact%friction)
      is_given = abs([rule%at_rest, rule%sliding - rule%at_rest, rule%decay, rule%most, &
        rule%stiffness - none%stiffness, real(contact%search_interval, wp)]) > 0.0_wp
    end associate
    ignored = ''
    do k = 1, size(fields)
      if (is_given(k)) ignored = ignored//', '//trim(fields(k))
    end do
    if (any(is_given)) call line_warning(deck, line, 'friction of a tie'//to_text(contact%id), &
      what//': '//ignored(3:)//' without effect')
    contact%friction = friction_rule_t()
    contact%search_interval = 0
  end subroutine check_tie

  !> Blank the negative fields of a stock card that the command line replaces.
  subroutine blank_negatives(deck, i_block, id)
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
  end subroutine blank_negatives

  !> Rewrite a stock card as *CONTACT_2D_SLIDELINE; fields with default values are blank.
  subroutine write_as_slideline(deck, entry)
    type(deck_t), intent(inout) :: deck
    type(contact_cards_t), intent(in) :: entry
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
        //to_text(c%penalty_unit)//','//shortest(c%master_penalty)//','//shortest(c%damping) &
        //','//to_text(merge(1, 0, c%strict))//','//to_text(c%search_interval)//',' &
        //shortest(merge(c%tie_distance, c%search_depth, is_tied(c)))//end_of_line
      third = ''
      if (is_tied(c)) then
        third = '0,1,'//to_text(c%tie)//end_of_line
      else if (rule%most > 0.0_wp .or. abs(rule%stiffness - default%stiffness) > 0.0_wp) then
        third = shortest(rule%most)//','//shortest(rule%stiffness)//end_of_line
      end if
    end associate
    call rewrite_block(deck, entry%block, slideline_keyword, text//third)
  end subroutine write_as_slideline

  !> ` (1 name, 2 name, ...)`, with type 0 where it has a name.
  pure function kind_names(kinds, zero_name) result(text)
    type(contact_kind_t), intent(in) :: kinds(:)
    character(*), intent(in), optional :: zero_name
    character(:), allocatable :: text
    integer :: i

    text = ''
    if (present(zero_name)) text = ', 0 '//zero_name
    do i = 1, size(kinds)
      text = text//', '//to_text(kinds(i)%number)//' '//trim(kinds(i)%name)
    end do
    if (len(text) > 0) text = ' ('//text(3:)//')'
  end function kind_names

end module deck_contact_m
