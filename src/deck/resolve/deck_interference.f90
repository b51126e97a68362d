! SPDX-License-Identifier: MIT
!> The curve by which the initial overlap of an interface grows (LCINT).
module deck_interference_m
  use kinds_m, only : wp
  use log_m, only : to_text
  use contacts_m, only : contact_t
  use model_m, only : model_t
  use units_m, only : in_units
  use deck_ids_m, only : a_curve
  use deck_lines_m, only : deck_t, line_warning
  use deck_cards_m, only : reject_field
  use deck_raw_m, only : raw_contact_t
  use deck_values_m, only : resolve_id
  implicit none
  private
  public :: resolve_interference

  !> How near to 0 and 1 the ends of the curve must be: that is round-off of factors on it.
  real(wp), parameter :: round_off = 1.0e-12_wp

contains

  !> Give the interface its curve, which must lead from 0 to 1.
  subroutine resolve_interference(deck, entry, model, contact)
    type(deck_t), intent(inout) :: deck
    type(raw_contact_t), intent(in) :: entry
    type(model_t), intent(in) :: model
    type(contact_t), intent(inout) :: contact
    integer :: found, n

    found = 0
    if (entry%interference > 0) call resolve_id(deck, a_curve, entry%interference, &
      entry%interference_place, found)
    if (found == 0) return
    associate (curve => model%curves(found))
      n = size(curve%ordinate)
      if (n == 0) return
      if (abs(curve%ordinate(1)) > round_off) call refuse('begins at '//to_text(curve%ordinate(1)) &
        //', not at 0')
      if (abs(curve%ordinate(n) - 1.0_wp) > round_off) call refuse('ends at ' &
        //to_text(curve%ordinate(n))//', not at 1')
      if (minval(curve%ordinate) < -round_off .or. maxval(curve%ordinate) > 1.0_wp + round_off) &
        call refuse('leaves the range from 0 to 1')
      if (curve%abscissa(1) < 0.0_wp) call refuse('begins at the time ' &
        //to_text(curve%abscissa(1))//', before the run')
      if (curve%abscissa(n) > model%controls%end_time) call line_warning(deck, &
        entry%interference_place%line, 'interference'//to_text(contact%id), 'interface ' &
        //to_text(contact%id)//': the curve of its interference ends at '//to_text( &
        curve%abscissa(n))//in_units(model%controls%units, 'T') &
        //', after the run; the overlap does not act in full')
      contact%interference = curve
    end associate

  contains

    !> What is wrong with the curve.
    subroutine refuse(what)
      character(*), intent(in) :: what

      call reject_field(deck, entry%interference_place, 'is a curve of interference that '//what)
    end subroutine refuse

  end subroutine resolve_interference

end module deck_interference_m
