! SPDX-License-Identifier: MIT
!> Ties: what their cards give, and the rules that they keep.
module deck_tie_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : friction_rule_t, is_tied, penalty_per_node, penalty_factor, &
    penalty_share, tie_always, tie_factor, tie_none
  use deck_lines_m, only : deck_t, line_error, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : cursor_t
  use deck_checks_m, only : refuse_outside
  use deck_values_m, only : integer_of
  use deck_raw_m, only : raw_contact_t
  implicit none
  private
  public :: take_tie, take_stock_tie, check_tie

contains

  !> *CONTACT_2D_SLIDELINE: with TIE 1 a blank PEN stands for the factor of the program, and SRCH is
  !> the reach of the tie.
  subroutine take_tie(deck, cursor, cards, is_commanded, entry)
    type(deck_t), intent(inout) :: deck
    type(cursor_t), intent(in) :: cursor
    type(card_t), intent(inout) :: cards(:)
    logical, intent(in) :: is_commanded !! the command line gives PEN
    type(raw_contact_t), intent(inout) :: entry

    call refuse_outside(deck, cursor, cards(3), 'TIE', tie_none, tie_always, 'is not 0 (contact) ' &
      //'or 1 (tied); ties that break (2) are not supported')
    associate (contact => entry%contact)
      if (integer_of(cards(3), 'TIE') /= tie_always) return
      contact%tie = tie_always
      contact%tie_reach = contact%search_depth
      contact%search_depth = 0.0_wp
      if (.not. (abs(contact%penalty) > 0.0_wp .or. is_commanded) &
        .and. any(contact%penalty_unit == [penalty_per_node, penalty_factor])) then
        contact%penalty_unit = penalty_factor
        contact%penalty = tie_factor
        contact%master_penalty = tie_factor
      end if
    end associate
  end subroutine take_tie

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

  !> What ties do not have, wherever it comes from. Friction waits for what breaks.
  subroutine check_tie(deck, line, entry)
    type(deck_t), intent(inout) :: deck
    integer, intent(in) :: line !! of the keyword
    type(raw_contact_t), intent(inout) :: entry
    character(:), allocatable :: what

    if (.not. is_tied(entry%contact)) return
    what = 'interface '//to_text(entry%contact%id)//' is tied'
    if (entry%contact%is_self) call line_error(deck, line, what &
      //': a surface can not be tied to itself (SURFB 0)')
    associate (contact => entry%contact)
      if (contact%penalty_unit == penalty_share) call line_error(deck, line, what//': its ' &
        //'penalty can not be a share of the largest stable one (PUNIT 3)')
      if (entry%per_cent > 0.0_wp) call line_error(deck, line, what &
        //': contact damping (VDC) of ties is not supported')
      if (contact%birth > 0.0_wp) call line_error(deck, line, what//' in the reference geometry: ' &
        //'a time from which on it acts (TBIRTH) is not supported')
      if (max(contact%friction%at_rest, contact%friction%sliding) > 0.0_wp) then
        call line_warning(deck, line, 'friction of a tie'//to_text(contact%id), what &
          //': its friction (FS, FD) has no effect')
      end if
      contact%friction = friction_rule_t()
    end associate
  end subroutine check_tie

end module deck_tie_m
