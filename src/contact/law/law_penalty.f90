! SPDX-License-Identifier: MIT
!> The penalty law: a spring at each place, which pushes and never pulls.
module law_penalty_m
  use dual_m, only : dual_t, operator(*)
  use kinds_m, only : wp
  implicit none
  private
  public :: press_penalty, vary_penalty, energy_penalty

contains

  !> p = stiffness * max(0, -gap).
  pure subroutine press_penalty(n, stiffness, gap, pressure)
    integer, intent(in) :: n
    real(wp), intent(in) :: stiffness(n) !! N/m^2
    real(wp), intent(in) :: gap(n)       !! m
    real(wp), intent(inout) :: pressure(n) !! N/m
    integer :: p

    do p = 1, n
      pressure(p) = stiffness(p)*max(0.0_wp, -gap(p))
    end do
  end subroutine press_penalty

  !> The same with its derivatives, of a place in contact.
  pure function vary_penalty(stiffness, gap) result(pressure)
    real(wp), intent(in) :: stiffness
    type(dual_t), intent(in) :: gap
    type(dual_t) :: pressure

    pressure = (-stiffness)*gap
  end function vary_penalty

  !> What a place stores: the integral of the pressure over the way from its closing.
  pure function energy_penalty(stiffness, gap) result(density)
    real(wp), intent(in) :: stiffness !! N/m^2
    real(wp), intent(in) :: gap       !! m
    real(wp) :: density               !! J/m^2

    density = 0.5_wp*stiffness*max(0.0_wp, -gap)**2
  end function energy_penalty

end module law_penalty_m
