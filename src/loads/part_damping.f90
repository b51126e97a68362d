! SPDX-License-Identifier: MIT
!> Rates of damping by mass: *DAMPING_GLOBAL and *DAMPING_PART_MASS.
module part_damping_m
  use curves_m, only : curve_value
  use external_force_m, only : damping_rate
  use kinds_m, only : wp
  use model_m, only : model_t
  implicit none
  private
  public :: part_damping_rate, damping_rates

contains

  !> D per direction at `time` of each part, and in the last column of masses on nodes, which belong
  !> to no part: that of *DAMPING_GLOBAL.
  pure function damping_rates(model, time) result(rates)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp) :: rates(2, size(model%parts) + 1) !! 1/s
    integer :: i

    rates = spread(damping_rate(model%conditions, model%curves, time), 2, size(rates, 2))
    do i = 1, size(model%parts)
      rates(:, i) = rates(:, i) + part_damping_rate(model, i, time)
    end do
  end function damping_rates

  !> D per direction that the masses of a part have at `time`; cards of one part add up.
  pure function part_damping_rate(model, part, time) result(rate)
    type(model_t), intent(in) :: model
    integer, intent(in) :: part
    real(wp), intent(in) :: time
    real(wp) :: rate(2)
    integer :: i

    rate = 0.0_wp
    if (.not. allocated(model%conditions%part_damping)) return
    do i = 1, size(model%conditions%part_damping)
      associate (damping => model%conditions%part_damping(i))
        if (damping%part == part) rate = rate + damping%scale*damping%factor &
          *curve_value(model%curves(damping%curve), time)
      end associate
    end do
  end function part_damping_rate

end module part_damping_m
