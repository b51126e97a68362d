! SPDX-License-Identifier: MIT
!> Ties: what their cards give, and the rules that they keep.
module deck_tie_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : contact_t, friction_rule_t, is_tied, breaks, penalty_per_node, &
    penalty_factor, penalty_share, tie_always, tie_breaks, tie_factor
  use deck_lines_m, only : deck_t, line_error, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t, report_field, warn_of_field
  use deck_contact_values_m, only : of_penalty, of_unit, of_damping
  use deck_overrides_m, only : overrides_t, override_phrase
  use deck_values_m, only : integer_of, real_of, is_bad, place_of
  use deck_raw_m, only : raw_contact_t
  implicit none
  private
  public :: take_tie, take_stock_tie, check_tie

contains

  !> *CONTACT_2D_SLIDELINE: with TIE 1 or 2 SRCH is the reach of the tie.
  subroutine take_tie(deck, cursor, cards, commanded, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    logical, intent(in) :: commanded(:) !! values that the command line gives
    type(raw_contact_t), intent(inout) :: entry

    call take_strength(deck, cursor, cards(3), entry)
    associate (contact => entry%contact)
      if (.not. any(integer_of(cards(3), 'TIE') == [tie_always, tie_breaks])) return
      contact%tie = integer_of(cards(3), 'TIE')
      contact%tie_reach = contact%search_depth
      contact%search_depth = 0.0_wp
      if (.not. (abs(contact%penalty) > 0.0_wp .or. any(commanded([of_penalty, of_unit]))) .and. &
        abs(contact%master_penalty) > 0.0_wp .and. contact%penalty_unit == penalty_per_node) &
        call report_field(deck, cursor, cards(2), 'PENT', 'is a force per length (PUNIT 0) ' &
        //'beside a blank PEN, which ties take as a factor on the built-in estimate; give PEN ' &
        //'too, or PUNIT 2')
    end associate
  end subroutine take_tie

  !> The factor of the program where there is no PEN and the unit is a factor, or is not given
  !> (blank and 0 are the same). PENT stays where it is given.
  pure subroutine take_default(has_unit, contact)
    logical, intent(in) :: has_unit !! the command line gives it
    type(contact_t), intent(inout) :: contact

    if (abs(contact%penalty) > 0.0_wp) return
    if (contact%penalty_unit /= penalty_factor .and. (has_unit .or. contact%penalty_unit &
      /= penalty_per_node)) return
    contact%penalty_unit = penalty_factor
    contact%penalty = tie_factor
    if (.not. abs(contact%master_penalty) > 0.0_wp) contact%master_penalty = tie_factor
  end subroutine take_default

  !> NFLS and SFLS: both, where ties break.
  subroutine take_strength(deck, cursor, card, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: card
    type(raw_contact_t), intent(inout) :: entry
    character(4), parameter :: names(2) = ['NFLS', 'SFLS']
    integer :: k

    do k = 1, 2
      entry%contact%strength(k) = real_of(card, names(k))
      if (integer_of(card, 'TIE') == tie_breaks) then
        if (.not. entry%contact%strength(k) > 0.0_wp .and. .not. is_bad(card, names(k))) &
          call report_field(deck, cursor, card, names(k), 'is not a strength: ties that break ' &
          //'(TIE 2) need NFLS and SFLS, more than 0')
      else if (abs(entry%contact%strength(k)) > 0.0_wp) then
        call warn_of_field(deck, place_of(card, names(k)), 'has no effect: only ties that break ' &
          //'(TIE 2) have strengths')
        entry%contact%strength(k) = 0.0_wp
      end if
    end do
  end subroutine take_strength

  !> Stock keywords of ties: SFACT multiplies the factor of the program. What they have for contact
  !> that opens has no effect: friction, damping, FREQ.
  pure subroutine take_stock_tie(reach, entry)
    real(wp), intent(in) :: reach !! TIEDGAP; 0 = the default
    type(raw_contact_t), intent(inout) :: entry

    associate (contact => entry%contact)
      contact%tie = tie_always
      contact%tie_reach = reach
      contact%penalty = tie_factor*contact%penalty
      contact%master_penalty = contact%penalty
      contact%search_interval = 0
    end associate
    entry%per_cent = 0.0_wp
  end subroutine take_stock_tie

  !> What ties do not have. What the command line asks of all interfaces passes them by; what the
  !> deck asks for is an error, or has no effect. Ties that break hand damping, friction and FREQ to
  !> the contact behind them.
  subroutine check_tie(deck, line, overrides, commanded, before, entry)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line !! of the keyword
    type(overrides_t), intent(in) :: overrides
    logical, intent(in) :: commanded(:)         !! values that the command line gives
    type(raw_contact_t), intent(in) :: before   !! it was so before the command line
    type(raw_contact_t), intent(inout) :: entry
    character(:), allocatable :: what

    if (.not. is_tied(entry%contact)) return
    what = 'interface '//to_text(entry%contact%id)//' is tied'
    if (entry%contact%is_self) call line_error(deck, line, what &
      //': a surface can not be tied to itself (SURFB 0)')
    associate (contact => entry%contact)
      if (commanded(of_unit) .and. contact%penalty_unit == penalty_share) then
        call pass_by('PUNIT', 'its penalty can not be a share of the largest stable one')
        contact%penalty_unit = before%contact%penalty_unit
        contact%penalty = before%contact%penalty
        contact%master_penalty = before%contact%master_penalty
        call take_default(.false., contact)
      else if (.not. commanded(of_penalty)) then
        call take_default(commanded(of_unit), contact)
      end if
      if (contact%penalty_unit == penalty_share) call line_error(deck, line, what//': its ' &
        //'penalty can not be a share of the largest stable one (PUNIT 3)')
      if (contact%birth > 0.0_wp) call line_error(deck, line, what//' in the reference geometry: ' &
        //'a time from which on it acts (TBIRTH) is not supported')
      if (breaks(contact)) return
      if (commanded(of_damping) .and. entry%per_cent > 0.0_wp) then
        call pass_by('VDC', 'ties have no contact damping')
        entry%per_cent = before%per_cent
        contact%damping = entry%per_cent/100.0_wp
      end if
      if (entry%per_cent > 0.0_wp) call line_error(deck, line, what &
        //': contact damping (VDC) of ties is not supported')
      if (len(useless_fields(contact)) > 0) call line_warning(deck, line, &
        'friction of a tie'//to_text(contact%id), what//': '//useless_fields(contact) &
        //' of contact that opens has no effect')
      contact%friction = friction_rule_t()
      contact%search_interval = 0
    end associate

  contains

    !> A value of the command line that this interface does not take.
    subroutine pass_by(name, why)
      character(*), intent(in) :: name, why

      call line_warning(deck, line, 'override '//name//' of a tie'//to_text(entry%contact%id), &
        what//': '//why//'; '//override_phrase(overrides, name, entry%contact%id) &
        //' has no effect on it')
    end subroutine pass_by

  end subroutine check_tie

  !> Names of the fields that are given and that ties have no use for.
  pure function useless_fields(contact) result(names)
    type(contact_t), intent(in) :: contact
    character(:), allocatable :: names
    type(friction_rule_t) :: none

    names = ''
    associate (rule => contact%friction)
      if (abs(rule%at_rest) > 0.0_wp) names = names//', FS'
      if (abs(rule%sliding - rule%at_rest) > 0.0_wp) names = names//', FD'
      if (abs(rule%decay) > 0.0_wp) names = names//', DC'
      if (abs(rule%most) > 0.0_wp) names = names//', VC'
      if (abs(rule%stiffness - none%stiffness) > 0.0_wp) names = names//', TFAC'
      if (contact%search_interval > 0) names = names//', FREQ'
    end associate
    names = names(min(3, len(names) + 1):)
  end function useless_fields

end module deck_tie_m
