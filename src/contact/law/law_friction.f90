! SPDX-License-Identifier: MIT
!> The law of friction: a tangential spring that slips at a limit (regularised Coulomb,
!> doc/theory/contact.md, section 6.2).
module law_friction_m
  use contacts_m, only : friction_rule_t
  use friction_state_m, only : sticks, slips
  use kinds_m, only : wp
  implicit none
  private
  public :: coefficient_of, return_traction

contains

  !> Coefficient of friction at a speed of sliding: FD + (FS - FD) exp(-DC speed).
  pure function coefficient_of(rule, speed) result(coefficient)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: speed !! m/s, >= 0
    real(wp) :: coefficient

    coefficient = rule%sliding + (rule%at_rest - rule%sliding)*exp(-rule%decay*speed)
  end function coefficient_of

  !> Return of a trial traction to the limit.
  elemental subroutine return_traction(trial, limit, traction, state)
    real(wp), intent(in) :: trial     !! former traction plus stiffness times slip, N/m^2
    real(wp), intent(in) :: limit     !! largest traction, N/m^2, >= 0
    real(wp), intent(out) :: traction !! N/m^2
    integer, intent(out) :: state     !! sticks or slips

    state = merge(slips, sticks, abs(trial) > limit)
    traction = merge(sign(limit, trial), trial, abs(trial) > limit)
  end subroutine return_traction

end module law_friction_m
