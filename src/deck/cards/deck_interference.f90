! SPDX-License-Identifier: MIT
!> Interference curves (LCINT of *CONTACT_2D_SLIDELINE).
module deck_interference_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use units_m, only : in_units
  use model_m, only : model_t
  use contacts_m, only : contact_t, tie_none
  use deck_lines_m, only : deck_t, line_warning
  use deck_fields_m, only : card_t
  use deck_cards_m, only : report_field, reject_field
  use deck_ids_m, only : a_curve
  use deck_values_m, only : integer_of, is_bad, location_of, find_id
  implicit none
  private
  public :: read_interference

  !> Tolerance of the first and last ordinate of an interference curve, 0 and 1.
  real(wp), parameter :: round_off = 1.0e-12_wp

contains

  !> LCINT: the curve of the active share of an initial overlap, from 0 to 1.
  subroutine read_interference(deck, card, model, contact)
    type(deck_t), intent(inout) :: deck
    type(card_t), intent(inout) :: card
    type(model_t), intent(in) :: model
    type(contact_t), intent(inout) :: contact
    integer :: found, n

    if (integer_of(card, 'LCINT') == 0) return
    if (integer_of(card, 'TIE') /= tie_none) call report_field(deck, card, 'LCINT', &
      'asks for an interference curve, which ties do not have (a tie keeps its gaps)')
    if (contact%is_self) call report_field(deck, card, 'LCINT', &
      'asks for an interference curve, which self contact (SURFB 0) does not have')
    if (contact%birth > 0.0_wp) call report_field(deck, card, 'LCINT', &
      'asks for an interference curve, which needs contact from time zero on (TBIRTH 0)')
    if (is_bad(card, 'LCINT')) return
    allocate (contact%interference)
    call find_id(deck, a_curve, card, 'LCINT', found)
    if (found == 0) return
    associate (curve => model%curves(found))
      n = size(curve%ordinate)
      if (n == 0) return
      if (abs(curve%ordinate(1)) > round_off) call refuse('begins at ' &
        //to_text(curve%ordinate(1))//', not at 0')
      if (abs(curve%ordinate(n) - 1.0_wp) > round_off) call refuse('ends at ' &
        //to_text(curve%ordinate(n))//', not at 1')
      if (minval(curve%ordinate) < -round_off .or. maxval(curve%ordinate) > 1.0_wp + round_off) &
        call refuse('leaves the range from 0 to 1')
      if (curve%abscissa(1) < 0.0_wp) call refuse('begins at the time ' &
        //to_text(curve%abscissa(1))//', before the run')
      if (curve%abscissa(n) > model%controls%end_time) call line_warning(deck, card%line, &
        'interference'//to_text(contact%id), 'interface '//to_text(contact%id)//': its ' &
        //'interference curve ends at '//to_text(curve%abscissa(n)) &
        //in_units(model%controls%units, 'T')//', after the end time; the full overlap is not ' &
        //'reached')
      contact%interference = curve
    end associate

  contains

    !> Report an error of the curve.
    subroutine refuse(what)
      character(*), intent(in) :: what

      call reject_field(deck, location_of(card, 'LCINT'), 'is an interference curve that '//what)
    end subroutine refuse

  end subroutine read_interference

end module deck_interference_m
