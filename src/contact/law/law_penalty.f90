! SPDX-License-Identifier: MIT
!> The penalty law: a spring at each site, which pushes and never pulls.
module law_penalty_m
  use kinds_m, only : wp
  implicit none
  private
  public :: apply_penalty

contains

  !> Pressures p = stiffness * max(0, -gap) of some sites, their slopes by the gap in contact, and
  !> what the sites store: the integral of p over the way from closing.
  pure subroutine apply_penalty(n, stiffness, gap, pressure, slope, energy)
    integer, intent(in) :: n
    real(wp), intent(in) :: stiffness(n)   !! N/m^2
    real(wp), intent(in) :: gap(n)         !! m
    real(wp), intent(inout) :: pressure(n) !! N/m
    real(wp), intent(inout) :: slope(n)    !! N/m^2, < 0, also where the gap is zero or open
    real(wp), intent(inout) :: energy(n)   !! J/m^2

    pressure = stiffness*max(0.0_wp, -gap)
    slope = -stiffness
    energy = 0.5_wp*stiffness*max(0.0_wp, -gap)**2
  end subroutine apply_penalty

end module law_penalty_m
