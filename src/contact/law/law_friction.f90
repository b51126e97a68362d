! SPDX-License-Identifier: MIT
!> The law of friction: a tangential spring that slips at a limit (regularised Coulomb,
!> doc/theory/contact.md, section 6.2).
module law_friction_m
  use contacts_m, only : friction_rule_t
  use dual_m, only : dual_t, constant, operator(+), operator(*)
  use friction_state_m, only : sticks, slips
  use kinds_m, only : wp
  implicit none
  private
  public :: coefficient_of, find_limits, return_traction, return_tractions, vary_traction

contains

  !> Coefficient of friction at a speed of sliding: FD + (FS - FD) exp(-DC speed).
  pure function coefficient_of(rule, speed) result(coefficient)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: speed !! m/s, >= 0
    real(wp) :: coefficient

    coefficient = rule%sliding + (rule%at_rest - rule%sliding)
    ! The exponential costs as much as all the rest.
    if (rule%decay > 0.0_wp) coefficient = rule%sliding &
      + (rule%at_rest - rule%sliding)*exp(-rule%decay*speed)
  end function coefficient_of

  !> Largest tractions of some places at their speeds; rules without a decay do not ask for these.
  pure subroutine find_limits(rule, n, dt, slip, pressure, limit)
    type(friction_rule_t), intent(in) :: rule
    integer, intent(in) :: n
    real(wp), intent(in) :: dt              !! step that made the slips, s
    real(wp), intent(in) :: slip(n)         !! m
    real(wp), intent(in) :: pressure(n)     !! N/m^2
    real(wp), intent(inout) :: limit(n)     !! N/m^2
    integer :: i

    if (rule%decay > 0.0_wp .and. dt > 0.0_wp) then
      do i = 1, n
        limit(i) = coefficient_of(rule, abs(slip(i))/dt)*pressure(i)
      end do
    else
      limit = coefficient_of(rule, 0.0_wp)*pressure
    end if
  end subroutine find_limits

  !> Tractions of some places: springs over their slips, no more than the limits.
  pure subroutine return_tractions(n, former, stiffness, slip, limit, traction, state)
    integer, intent(in) :: n
    real(wp), intent(in) :: former(n)       !! traction before, N/m^2
    real(wp), intent(in) :: stiffness(n)    !! tangential, N/m^3
    real(wp), intent(in) :: slip(n), limit(n)
    real(wp), intent(inout) :: traction(n)
    integer, intent(inout) :: state(n)
    integer :: i

    do i = 1, n
      call return_traction(former(i) + stiffness(i)*slip(i), limit(i), traction(i), state(i))
    end do
  end subroutine return_tractions

  !> Return of a trial traction to the limit.
  elemental subroutine return_traction(trial, limit, traction, state)
    real(wp), intent(in) :: trial     !! former traction plus stiffness times slip, N/m^2
    real(wp), intent(in) :: limit     !! largest traction, N/m^2, >= 0
    real(wp), intent(out) :: traction !! N/m^2
    integer, intent(out) :: state     !! sticks or slips

    state = merge(slips, sticks, abs(trial) > limit)
    traction = merge(sign(limit, trial), trial, abs(trial) > limit)
  end subroutine return_traction

  !> The traction of a place in contact with its derivatives. One that touches without pressure has
  !> none yet, and sticks.
  pure function vary_traction(rule, former, slip, pressure, stiffness, most, dt, goes_on) &
      result(traction)
    type(friction_rule_t), intent(in) :: rule
    type(dual_t), intent(in) :: former   !! traction before, N/m^2
    type(dual_t), intent(in) :: slip     !! of the step, m
    type(dual_t), intent(in) :: pressure !! N/m^2
    real(wp), intent(in) :: stiffness    !! tangential, N/m^3
    type(dual_t), intent(in) :: most     !! largest traction whatever the pressure, N/m^2
    real(wp), intent(in) :: dt           !! step that made the slip, s
    logical, intent(in) :: goes_on       !! at the limit, wherever the trial is
    type(dual_t) :: traction
    type(dual_t) :: coefficient, limit

    traction = stiffness*slip
    if (.not. pressure%value > 0.0_wp) then
      traction%value = 0.0_wp
      return
    end if
    traction = former + traction
    coefficient = constant(coefficient_of(rule, 0.0_wp))
    if (dt > 0.0_wp) then
      coefficient%value = coefficient_of(rule, abs(slip%value)/dt)
      coefficient%slope = (-sign(rule%decay/dt, slip%value) &
        *(coefficient%value - rule%sliding))*slip%slope
    end if
    limit = coefficient*pressure
    if (most%value < limit%value) limit = most
    if (abs(traction%value) > limit%value .or. goes_on) &
      traction = sign(1.0_wp, traction%value)*limit
  end function vary_traction

end module law_friction_m
