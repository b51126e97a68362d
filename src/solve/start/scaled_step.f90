! SPDX-License-Identifier: MIT
!> The step that the deck makes of a stable one.
module scaled_step_m
  use curves_m, only : curve_value, curve_is_constant
  use kinds_m, only : wp
  use model_m, only : model_t
  implicit none
  private
  public :: scaled_step

contains

  !> TSSFAC times the limit, or the curve that caps it: s, at `time`. A curve above the limit has
  !> no say; a constant one below it takes the place of TSSFAC.
  pure function scaled_step(model, limit, time) result(dt)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: limit, time
    real(wp) :: dt, cap

    dt = model%controls%dt_scale*limit
    if (model%controls%dt_curve == 0) return
    associate (curve => model%curves(model%controls%dt_curve))
      cap = curve_value(curve, time)
      if (cap > limit) return
      if (.not. curve_is_constant(curve)) cap = min(cap, dt)
      dt = cap
    end associate
  end function scaled_step

end module scaled_step_m
