! SPDX-License-Identifier: MIT
!> The law of friction: a tangential spring that slips at a limit (regularised Coulomb,
!> doc/theory/contact.md, section 6.2).
module law_friction_m
  use contacts_m, only : friction_rule_t
  use dual_m, only : dual_t, constant, operator(+), operator(*)
  use law_state_m, only : sticks, slips
  use kinds_m, only : wp
  implicit none
  private
  public :: coefficient_of, has_decay, sliding_speed, return_traction, linearise_traction, &
    goes_on, holds_on

  !> What slips on in the first tangent of a step, in which nothing has moved yet.
  integer, parameter :: goes_on = -1
  !> What slips where the tangent of slipping is singular: its spring stands for it.
  integer, parameter :: holds_on = -2

  !> Passes of Newton's method for the speed of sliding. Where two roots all but meet each halves
  !> the error.
  integer, parameter :: most_passes = 100

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

  !> Whether the coefficient depends on the speed of sliding.
  pure function has_decay(rule)
    type(friction_rule_t), intent(in) :: rule
    logical :: has_decay

    has_decay = rule%decay > 0.0_wp .and. abs(rule%at_rest - rule%sliding) > 0.0_wp
  end function has_decay

  !> Speed of sliding of a site, m/s: that of the slip that does not come back, by v = (trial -
  !> limit(v))/stiffness with limit(v) = min(mu(v) p, most); 0 where it sticks
  !> (doc/theory/contact.md, section 6.2).
  pure function sliding_speed(rule, trial, pressure, most, stiffness, slid) result(speed)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: trial     !! size of the trial traction, N/m^2
    real(wp), intent(in) :: pressure  !! N/m^2, > 0
    real(wp), intent(in) :: most      !! largest traction whatever the pressure, N/m^2
    real(wp), intent(in) :: stiffness !! tangential, times the step, N s/m^3, > 0
    logical, intent(in) :: slid       !! the same way in the step before
    real(wp) :: speed
    real(wp) :: x, previous, beyond, height, fall
    integer :: pass

    speed = 0.0_wp
    ! With x = DC v: x + height exp(-x) = beyond, whose left side is least at x = log(height).
    beyond = rule%decay*(trial - rule%sliding*pressure)/stiffness
    height = rule%decay*(rule%at_rest - rule%sliding)*pressure/stiffness
    if (trial <= min(coefficient_of(rule, speed)*pressure, most)) then
      if (.not. (slid .and. height > 1.0_wp)) return
      if (beyond < 1.0_wp + log(height)) return
    else if (trial > most) then
      speed = (trial - most)/stiffness
      if (coefficient_of(rule, speed)*pressure >= most) return
    end if
    ! Where the coefficient falls the left side is convex, and Newton's method comes down to its
    ! last root from the right; where it rises the left side is concave and increases, and it comes
    ! up to its only one from the left. Neither passes the root.
    x = merge(beyond, 0.0_wp, height > 0.0_wp)
    do pass = 1, most_passes
      previous = x
      fall = height*exp(-x)
      if (fall >= 1.0_wp) exit
      x = x - (x + fall - beyond)/(1.0_wp - fall)
      if (abs(x - previous) <= 2.0_wp*spacing(x)) exit
    end do
    speed = max(x, 0.0_wp)/rule%decay
  end function sliding_speed

  !> Return of a trial traction to the limit.
  elemental subroutine return_traction(trial, limit, traction, state)
    real(wp), intent(in) :: trial     !! previous traction plus stiffness times slip, N/m^2
    real(wp), intent(in) :: limit     !! largest traction, N/m^2, >= 0
    real(wp), intent(out) :: traction !! N/m^2
    integer, intent(out) :: state     !! sticks or slips

    state = merge(slips, sticks, abs(trial) > limit)
    traction = merge(sign(limit, trial), trial, abs(trial) > limit)
  end subroutine return_traction

  !> The traction of a site in contact with its derivatives. One that touches without pressure has
  !> none yet, and sticks.
  pure function linearise_traction(rule, previous, slip, pressure, stiffness, most, times, before) &
      result(traction)
    type(friction_rule_t), intent(in) :: rule
    type(dual_t), intent(in) :: previous !! traction before, N/m^2
    type(dual_t), intent(in) :: slip     !! of the step, m
    type(dual_t), intent(in) :: pressure !! N/m^2
    real(wp), intent(in) :: stiffness    !! tangential, N/m^3
    type(dual_t), intent(in) :: most     !! largest traction whatever the pressure, N/m^2
    real(wp), intent(in) :: times(2)     !! step that made the slip, and lag of what sticks, s
    integer, intent(in) :: before        !! state before; `goes_on`: at the limit, wherever the
                                         !! trial is
    type(dual_t) :: traction
    type(dual_t) :: trial, damped, limit
    real(wp) :: speed

    traction = stiffness*slip
    if (.not. pressure%value > 0.0_wp) then
      traction%value = 0.0_wp
      return
    end if
    traction = previous + traction
    trial = sign(1.0_wp, traction%value)*traction
    limit = coefficient_of(rule, 0.0_wp)*pressure
    if (most%value < limit%value) limit = most
    if (before == holds_on) then
      traction%value = sign(min(limit%value, trial%value), traction%value)
      return
    end if
    speed = 0.0_wp
    if (has_decay(rule) .and. stiffness*times(1) > 0.0_wp) then
      if (before == sticks) then
        damped = traction + (times(2)/times(1)*stiffness)*slip
        if (sign(1.0_wp, traction%value)*damped%value < trial%value) &
          trial = sign(1.0_wp, traction%value)*damped
        traction = damped
      end if
      speed = sliding_speed(rule, trial%value, pressure%value, most%value, stiffness*times(1), &
        (before == slips .or. before == goes_on) .and. traction%value*previous%value > 0.0_wp)
    end if
    if (speed > 0.0_wp) then
      limit = linearise_sliding_limit(rule, speed, trial, pressure, most, stiffness*times(1))
    else if (.not. (abs(traction%value) > limit%value .or. before == goes_on)) then
      return
    end if
    traction = sign(1.0_wp, traction%value)*limit
  end function linearise_traction

  !> The limit at a speed of sliding with its derivatives, from those of the equation that the speed
  !> solves.
  pure function linearise_sliding_limit(rule, speed, trial, pressure, most, stiffness) result(limit)
    type(friction_rule_t), intent(in) :: rule
    real(wp), intent(in) :: speed     !! m/s
    type(dual_t), intent(in) :: trial !! size of the trial traction, N/m^2
    type(dual_t), intent(in) :: pressure, most
    real(wp), intent(in) :: stiffness !! tangential, times the step, N s/m^3
    type(dual_t) :: limit
    real(wp) :: coefficient, fall

    coefficient = coefficient_of(rule, speed)
    limit = coefficient*pressure
    if (.not. most%value > limit%value) then
      limit = most
      return
    end if
    ! Not as steep as where two roots meet.
    fall = rule%decay*(coefficient - rule%sliding)*pressure%value/stiffness
    limit%slope = limit%slope - fall/max(1.0_wp - fall, sqrt(epsilon(fall))) &
      *(trial%slope - limit%slope)
  end function linearise_sliding_limit

end module law_friction_m
