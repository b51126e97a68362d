! SPDX-License-Identifier: MIT
!> Friction of interfaces: the cards that give it, *CONTROL_CONTACT for those that do not, the
!> command line over both, and the rules that all of them keep.
module deck_friction_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : friction_rule_t, has_friction, is_tied, breaks
  use deck_lines_m, only : deck_t, deck_error, line_warning
  use deck_fields_m, only : card_t, smallest_value
  use deck_cards_m, only : cursor_t, report_field, warn_of_field
  use deck_overrides_m, only : overrides_t, override_real, override_text, override_phrase
  use deck_raw_m, only : raw_t, raw_contact_t
  use deck_values_m, only : real_of, is_bad, place_of, refuse_negative
  implicit none
  private
  public :: take_friction, take_stock_friction, take_penalty_friction, take_default_friction, &
    settle_friction

  character(*), parameter :: bad_share = &
    'is not a tangential over the normal penalty (above 0, at most 1)'

contains

  !> *CONTACT_2D_SLIDELINE: FD follows FS where it is blank or 0.
  subroutine take_friction(deck, cursor, cards, overrides, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    type(overrides_t), intent(in) :: overrides
    type(raw_contact_t), intent(inout) :: entry

    call take_coefficients(deck, cursor, cards, overrides, entry)
    associate (rule => entry%contact%friction)
      if (.not. abs(rule%sliding) > 0.0_wp) rule%sliding = rule%at_rest
      rule%stiffness = real_of(cards(3), 'TFAC')
      if (is_commanded(overrides, 'TFAC', entry)) return
      if (rule%stiffness <= 0.0_wp .or. rule%stiffness > 1.0_wp) call report_field(deck, cursor, &
        cards(3), 'TFAC', bad_share)
    end associate
  end subroutine take_friction

  !> *CONTACT_2D_AUTOMATIC_: FD 0 is what it says. As our own card means FS by it, the smallest
  !> number stands for it: a deck that is written with our card then gives the same bits.
  subroutine take_stock_friction(deck, cursor, cards, overrides, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    type(overrides_t), intent(in) :: overrides
    type(raw_contact_t), intent(inout) :: entry

    call take_coefficients(deck, cursor, cards, overrides, entry)
    associate (rule => entry%contact%friction)
      entry%takes_default = .not. max(abs(rule%at_rest), abs(rule%sliding), abs(rule%decay), &
        abs(rule%most)) > 0.0_wp
      call keep_zero(rule)
    end associate
  end subroutine take_stock_friction

  !> FS, FD and DC of card 1, VC of card 3.
  subroutine take_coefficients(deck, cursor, cards, overrides, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    type(overrides_t), intent(in) :: overrides
    type(raw_contact_t), intent(inout) :: entry
    character(2), parameter :: names(4) = ['FS', 'FD', 'DC', 'VC']
    integer, parameter :: on(4) = [1, 1, 1, 3]
    integer :: i

    do i = 1, 4
      if (.not. is_commanded(overrides, names(i), entry)) call refuse_negative(deck, cursor, &
        cards(on(i)), names(i))
    end do
    entry%friction_place = place_of(cards(1), 'FS')
    entry%contact%friction = friction_rule_t(at_rest=real_of(cards(1), 'FS'), &
      sliding=real_of(cards(1), 'FD'), decay=real_of(cards(1), 'DC'), most=real_of(cards(3), 'VC'))
    if (.not. entry%contact%friction%at_rest > 0.0_wp .and. &
      entry%contact%friction%sliding > 0.0_wp) entry%friction_place = place_of(cards(1), 'FD')
  end subroutine take_coefficients

  !> Whether the command line gives a value of an interface.
  pure function is_commanded(overrides, name, entry) result(yes)
    type(overrides_t), intent(in) :: overrides
    character(*), intent(in) :: name
    type(raw_contact_t), intent(in) :: entry
    logical :: yes

    yes = len(override_text(overrides, name, entry%contact%id)) > 0
  end function is_commanded

  !> A coefficient in fast sliding of 0 where there is one at rest.
  pure subroutine keep_zero(rule)
    type(friction_rule_t), intent(inout) :: rule

    if (rule%at_rest > 0.0_wp .and. .not. abs(rule%sliding) > 0.0_wp) rule%sliding = smallest_value
  end subroutine keep_zero

  !> *CONTACT_2D_PENALTY_FRICTION: FRIC alone, or FRIC_L and FRIC_H as FS and FD. The card has no
  !> decay between two that differ.
  subroutine take_penalty_friction(deck, cursor, card, overrides, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(overrides_t), intent(in) :: overrides
    type(raw_contact_t), intent(inout) :: entry
    character(6), parameter :: names(3) = ['FRIC  ', 'FRIC_L', 'FRIC_H']
    integer :: i

    associate (rule => entry%contact%friction)
      entry%friction_place = place_of(card, names(1))
      do i = 1, size(names)
        if (.not. is_commanded(overrides, 'FS', entry)) call refuse_negative(deck, cursor, card, &
          trim(names(i)))
        if (is_bad(card, names(i)) .or. .not. real_of(card, names(i)) > 0.0_wp) cycle
        if (.not. rule%at_rest > 0.0_wp) then
          rule%at_rest = real_of(card, names(i))
          entry%friction_place = place_of(card, names(i))
        else if (abs(real_of(card, names(i)) - rule%at_rest) > 0.0_wp) then
          call report_field(deck, cursor, card, names(i), 'is not '//trim( &
            entry%friction_place%name)//' "'//to_text(rule%at_rest)//'", and the card does not ' &
            //'say at which speeds they act; *CONTACT_2D_SLIDELINE has FS, FD and the decay DC')
        end if
      end do
      rule%sliding = rule%at_rest
    end associate
  end subroutine take_penalty_friction

  !> SFRIC, DFRIC, EDC and VFC of *CONTROL_CONTACT.
  subroutine take_default_friction(card, raw)
    type(card_t), intent(in) :: card
    type(raw_t), intent(inout) :: raw

    raw%friction = friction_rule_t(at_rest=real_of(card, 'SFRIC'), sliding=real_of(card, 'DFRIC'), &
      decay=real_of(card, 'EDC'), most=real_of(card, 'VFC'))
    call keep_zero(raw%friction)
    raw%friction_place = place_of(card, 'SFRIC')
    if (.not. raw%friction%at_rest > 0.0_wp .and. raw%friction%sliding > 0.0_wp) &
      raw%friction_place = place_of(card, 'DFRIC')
  end subroutine take_default_friction

  !> Friction of all interfaces, once all cards have been read.
  subroutine settle_friction(deck, overrides, raw)
    type(deck_t), intent(inout) :: deck
    type(overrides_t), intent(in) :: overrides
    type(raw_t), intent(inout) :: raw
    logical :: is_given
    integer :: i

    is_given = max(raw%friction%at_rest, raw%friction%sliding) > 0.0_wp
    do i = 1, size(raw%contacts)
      associate (entry => raw%contacts(i))
        if (is_tied(entry%contact) .and. .not. breaks(entry%contact)) then
          call warn_of_tie(deck, overrides, entry)
          cycle
        end if
        if (is_given .and. entry%takes_default) then
          entry%contact%friction = raw%friction
          entry%friction_place = raw%friction_place
        end if
        call override_friction(deck, overrides, entry)
        call warn_of_rule(deck, entry)
      end associate
    end do
    if (is_given .and. .not. any(raw%contacts%takes_default)) call warn_of_field(deck, &
      raw%friction_place, 'has no effect here: it is the friction of *CONTACT_2D_AUTOMATIC_ ' &
      //'cards that have none (FS, FD, DC and VC 0)')
  end subroutine settle_friction

  !> Friction that words give passes ties by.
  subroutine warn_of_tie(deck, overrides, entry)
    type(deck_t), intent(inout) :: deck
    type(overrides_t), intent(in) :: overrides
    type(raw_contact_t), intent(in) :: entry
    character(4), parameter :: names(5) = ['FS  ', 'FD  ', 'DC  ', 'VC  ', 'TFAC']
    integer :: i

    do i = 1, size(names)
      if (is_commanded(overrides, trim(names(i)), entry)) call line_warning(deck, &
        deck%blocks(entry%block)%keyword, 'override '//names(i)//' of a tie' &
        //to_text(entry%contact%id), 'interface '//to_text(entry%contact%id)//' is tied: ' &
        //override_phrase(overrides, trim(names(i)), entry%contact%id)//' has no effect on it')
    end do
  end subroutine warn_of_tie

  !> The values of the command line. FD follows FS where the deck makes them the same, and is FS
  !> where the command line gives 0.
  subroutine override_friction(deck, overrides, entry)
    type(deck_t), intent(inout) :: deck
    type(overrides_t), intent(in) :: overrides
    type(raw_contact_t), intent(inout) :: entry
    logical :: given, follows, given_at_rest, given_sliding

    given = .false.
    given_at_rest = .false.
    given_sliding = .false.
    associate (rule => entry%contact%friction, id => entry%contact%id)
      follows = .not. abs(rule%sliding - rule%at_rest) > 0.0_wp
      call override_real(overrides, 'FS', id, rule%at_rest, given_at_rest)
      if (follows) rule%sliding = rule%at_rest
      if (.not. (rule%at_rest > 0.0_wp .or. rule%sliding > smallest_value)) rule%sliding = 0.0_wp
      call override_real(overrides, 'FD', id, rule%sliding, given_sliding)
      if (given_sliding .and. .not. rule%sliding > 0.0_wp) rule%sliding = rule%at_rest
      call override_real(overrides, 'DC', id, rule%decay, given)
      call override_real(overrides, 'VC', id, rule%most, given)
      call override_real(overrides, 'TFAC', id, rule%stiffness, given)
      if (is_commanded(overrides, 'TFAC', entry) .and. rule%stiffness > 1.0_wp) call deck_error( &
        deck, override_phrase(overrides, 'TFAC', id)//' '//bad_share)
      if (given_at_rest .or. given_sliding) entry%friction_place%line = 0
      entry%overridden = entry%overridden .or. given .or. given_at_rest .or. given_sliding
    end associate
  end subroutine override_friction

  !> Coefficients that are allowed and are likely not what is meant.
  subroutine warn_of_rule(deck, entry)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    character(:), allocatable :: id
    integer :: line

    line = entry%friction_place%line
    id = to_text(entry%contact%id)
    associate (rule => entry%contact%friction)
      if (rule%sliding > max(0.0_wp, rule%at_rest)) call line_warning(deck, line, &
        'friction rises'//id, 'the coefficient of friction in fast sliding (FD) of interface ' &
        //id//', "'//to_text(rule%sliding)//'", is above that at rest (FS), "' &
        //to_text(rule%at_rest)//'"')
      if (abs(rule%sliding - rule%at_rest) > 0.0_wp .and. rule%sliding > smallest_value .and. &
        .not. rule%decay > 0.0_wp) call line_warning(deck, line, 'friction decay'//id, &
        'without a decay (DC) the coefficient of friction of interface '//id//' is that at ' &
        //'rest (FS) at any speed: the one in fast sliding (FD) has no effect')
      if (rule%most > 0.0_wp .and. .not. has_friction(entry%contact)) call line_warning(deck, &
        line, 'friction cap'//id, 'the largest friction stress (VC) of interface '//id &
        //' has no effect without a coefficient of friction (FS)')
    end associate
  end subroutine warn_of_rule

end module deck_friction_m
