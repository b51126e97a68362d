! SPDX-License-Identifier: MIT
!> Ties: what their cards give, and the rules that they keep.
module deck_tie_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : contact_t, friction_rule_t, is_tied, breaks, penalty_per_node, &
    penalty_factor, penalty_share, tie_always, tie_breaks, tie_factor
  use deck_lines_m, only : deck_t, line_error, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : report_field, warn_of_field
  use deck_values_m, only : integer_of, real_of, is_bad, place_of
  implicit none
  private
  public :: take_tie, take_stock_tie, check_tie

contains

  !> *CONTACT_2D_SLIDELINE: with TIE 1 or 2 SRCH is the reach of the tie. Without PEN its penalty is
  !> the factor of the program where the unit is a factor, or not given (blank and 0 are the same);
  !> PENT stays where it is given.
  subroutine take_tie(deck, cards, contact)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: cards(:)
    type(contact_t), intent(inout) :: contact

    call take_strength(deck, cards(3), contact)
    if (.not. any(integer_of(cards(3), 'TIE') == [tie_always, tie_breaks])) return
    contact%tie = integer_of(cards(3), 'TIE')
    contact%tie_reach = contact%search_depth
    contact%search_depth = 0.0_wp
    if (abs(contact%penalty) > 0.0_wp) return
    if (all(contact%penalty_unit /= [penalty_factor, penalty_per_node])) return
    if (abs(contact%master_penalty) > 0.0_wp) then
      if (contact%penalty_unit == penalty_per_node) call report_field(deck, cards(2), 'PENT', &
        'is a force per length (PUNIT 0) beside a blank PEN, which ties take as a factor on ' &
        //'the built-in estimate; give PEN too, or PUNIT 2')
    else
      contact%master_penalty = tie_factor
    end if
    contact%penalty_unit = penalty_factor
    contact%penalty = tie_factor
  end subroutine take_tie

  !> NFLS and SFLS: both, where ties break.
  subroutine take_strength(deck, card, contact)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(contact_t), intent(inout) :: contact
    character(4), parameter :: names(2) = ['NFLS', 'SFLS']
    integer :: k

    do k = 1, 2
      contact%strength(k) = real_of(card, names(k))
      if (integer_of(card, 'TIE') == tie_breaks) then
        if (.not. contact%strength(k) > 0.0_wp .and. .not. is_bad(card, names(k))) &
          call report_field(deck, card, names(k), 'is not a strength: ties that break (TIE 2) ' &
          //'need NFLS and SFLS, more than 0')
      else if (abs(contact%strength(k)) > 0.0_wp) then
        call warn_of_field(deck, place_of(card, names(k)), 'has no effect: only ties that break ' &
          //'(TIE 2) have strengths')
        contact%strength(k) = 0.0_wp
      end if
    end do
  end subroutine take_strength

  !> Stock keywords of ties: SFACT multiplies the factor of the program. What they have for contact
  !> that opens has no effect: friction, damping, FREQ.
  pure subroutine take_stock_tie(reach, contact)
    real(wp), intent(in) :: reach !! TIEDGAP; 0 = the default
    type(contact_t), intent(inout) :: contact

    contact%tie = tie_always
    contact%tie_reach = reach
    contact%penalty = tie_factor*contact%penalty
    contact%master_penalty = contact%penalty
    contact%search_interval = 0
    contact%damping = 0.0_wp
  end subroutine take_stock_tie

  !> What ties do not have: an error, or without effect. Ties that break hand damping, friction and
  !> FREQ to the contact behind them.
  subroutine check_tie(deck, line, contact)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line !! of the keyword
    type(contact_t), intent(inout) :: contact
    character(:), allocatable :: what

    if (.not. is_tied(contact)) return
    what = 'interface '//to_text(contact%id)//' is tied'
    if (contact%is_self) call line_error(deck, line, what &
      //': a surface can not be tied to itself (SURFB 0)')
    if (contact%penalty_unit == penalty_share) call line_error(deck, line, what//': its ' &
      //'penalty can not be a share of the largest stable one (PUNIT 3)')
    if (contact%birth > 0.0_wp) call line_error(deck, line, what//' in the reference geometry: ' &
      //'a time from which on it acts (TBIRTH) is not supported')
    if (breaks(contact)) return
    if (contact%damping > 0.0_wp) call line_error(deck, line, what &
      //': contact damping (VDC) of ties is not supported')
    if (len(useless_fields(contact)) > 0) call line_warning(deck, line, &
      'friction of a tie'//to_text(contact%id), what//': '//useless_fields(contact) &
      //' of contact that opens has no effect')
    contact%friction = friction_rule_t()
    contact%search_interval = 0
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
