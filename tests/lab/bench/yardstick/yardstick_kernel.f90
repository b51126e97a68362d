! SPDX-License-Identifier: MIT
!> The arithmetic of one explicit step of a plastic one-point quad, on elements whose nodes are gathered already.
!> It is a unit of measure: it stays as it is, whatever the program learns. No step of such elements can do with less.
module yardstick_kernel_m
  use, intrinsic :: iso_fortran_env, only : wp => real64
  implicit none
  private

  integer, parameter, public :: n_element = 96
  real(wp), parameter :: young = 70.0e9_wp, poisson = 0.33_wp, density = 2700.0_wp, yield = 2.0e8_wp
  real(wp), parameter :: shear = 0.5_wp*young/(1.0_wp + poisson), bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
  real(wp), parameter :: coefficient = 0.1_wp ! of viscous hourglass control
  real(wp), parameter :: impedance = 0.25_wp*coefficient*sqrt(0.5_wp*density*(bulk + 4.0_wp*shear/3.0_wp))

  !> What a step adds up: work per time, largest sum of B.B/A^2 (the step limit) and largest square of the argument
  !> of the series for ln J.
  type, public :: yardstick_sums_t
    real(wp) :: power = 0.0_wp, stiffest = 0.0_wp, argument = 0.0_wp
  end type yardstick_sums_t

  public :: advance_yardstick

contains

  !> Forces of all elements and their new history after a step of dt, s.
  !> Flanagan & Belytschko (1981): mean gradients, hourglass control; Jaumann rate; Wilkins (1964): radial return.
  subroutine advance_yardstick(r, v, first_2, dt, s, strain, f, sums)
    real(wp), intent(in) :: r(n_element, 4, 2)       !! places of the nodes in turn around each element, m
    real(wp), intent(in) :: v(n_element, 4, 2)       !! their velocities, m/s
    real(wp), intent(in) :: first_2(n_element)       !! twice the area at the start, m^2
    real(wp), intent(in) :: dt                       !! s
    real(wp), intent(inout) :: s(n_element, 3)       !! deviator xx, yy, xy, Pa
    real(wp), intent(inout) :: strain(n_element)     !! equivalent plastic strain
    real(wp), intent(out) :: f(n_element, 4, 2)      !! nodal forces, N per m of thickness
    type(yardstick_sums_t), intent(inout) :: sums
    real(wp), parameter :: third = 1.0_wp/3.0_wp, per_3_shear = 1.0_wp/(3.0_wp*shear)
    real(wp) :: px, py, qx, qy, ux, uy, wx, wy, area_2, over, lxx, lxy, lyx, lyy, mean, dxy_2, turn, turned, sxx, syy, sxy
    real(wp) :: mises, back, z, zz, series, stress, fx, fy, gx, gy, hx, hy, viscosity, along
    real(wp) :: power_2, stiffest, argument, half_dt, stiffness, half_stiffness
    integer :: e

    half_dt = 0.5_wp*dt
    stiffness = 2.0_wp*shear*dt
    half_stiffness = shear*dt
    power_2 = 2.0_wp*sums%power
    stiffest = sums%stiffest
    argument = sums%argument
    !$omp simd reduction(+: power_2) reduction(max: stiffest, argument) &
    !$omp& private(px, py, qx, qy, ux, uy, wx, wy, area_2, over, lxx, lxy, lyx, lyy, mean, dxy_2, turn, turned, sxx) &
    !$omp& private(syy, sxy, mises, back, z, zz, series, stress, fx, fy, gx, gy, hx, hy, viscosity, along)
    do e = 1, n_element
      ! Diagonals p (1 to 3), q (2 to 4), velocities u, w along them. 2 B of nodes 1 to 4: -q, p, q, -p, turned.
      px = r(e, 3, 1) - r(e, 1, 1)
      py = r(e, 3, 2) - r(e, 1, 2)
      qx = r(e, 4, 1) - r(e, 2, 1)
      qy = r(e, 4, 2) - r(e, 2, 2)
      ux = v(e, 3, 1) - v(e, 1, 1)
      uy = v(e, 3, 2) - v(e, 1, 2)
      wx = v(e, 4, 1) - v(e, 2, 1)
      wy = v(e, 4, 2) - v(e, 2, 2)
      area_2 = px*qy - py*qx
      over = 1.0_wp/area_2
      lxx = over*(qy*ux - py*wx)
      lxy = over*(px*wx - qx*ux)
      lyx = over*(qy*uy - py*wy)
      lyy = over*(px*wy - qx*uy)
      ! Deviator: turned with the element, elastic, then back to the yield surface.
      mean = third*(lxx + lyy)
      dxy_2 = lxy + lyx
      turn = half_dt*(lxy - lyx)
      turned = 2.0_wp*turn*s(e, 3)
      sxx = s(e, 1) + stiffness*(lxx - mean) + turned
      syy = s(e, 2) + stiffness*(lyy - mean) - turned
      sxy = s(e, 3) + half_stiffness*dxy_2 + turn*(s(e, 2) - s(e, 1))
      mises = sqrt(3.0_wp*(sxx*(sxx + syy) + syy*syy + sxy*sxy))
      back = yield/max(mises, yield)
      strain(e) = strain(e) + per_3_shear*max(mises - yield, 0.0_wp)
      sxx = back*sxx
      syy = back*syy
      sxy = back*sxy
      s(e, 1) = sxx
      s(e, 2) = syy
      s(e, 3) = sxy
      ! ln(A/A0) = 2 artanh z, seven terms.
      z = (area_2 - first_2(e))/(area_2 + first_2(e))
      zz = z*z
      argument = max(argument, zz)
      series = 1.0_wp/11.0_wp + zz*(1.0_wp/13.0_wp + zz*(1.0_wp/15.0_wp))
      series = 1.0_wp/5.0_wp + zz*(1.0_wp/7.0_wp + zz*(1.0_wp/9.0_wp + zz*series))
      stress = (2.0_wp*bulk)*z*(1.0_wp + zz*(1.0_wp/3.0_wp + zz*series))
      fx = stress + sxx
      fy = stress + syy
      power_2 = power_2 + area_2*(fx*lxx + fy*lyy + sxy*dxy_2)
      stiffest = max(stiffest, over*over*(px*px + py*py + qx*qx + qy*qy))
      ! Hourglass: the alternating part h of the places and g of the velocities, g without what the gradient explains.
      hx = r(e, 1, 1) - r(e, 2, 1) + r(e, 3, 1) - r(e, 4, 1)
      hy = r(e, 1, 2) - r(e, 2, 2) + r(e, 3, 2) - r(e, 4, 2)
      viscosity = impedance*sqrt(area_2)
      gx = viscosity*(v(e, 1, 1) - v(e, 2, 1) + v(e, 3, 1) - v(e, 4, 1) - lxx*hx - lxy*hy)
      gy = viscosity*(v(e, 1, 2) - v(e, 2, 2) + v(e, 3, 2) - v(e, 4, 2) - lyx*hx - lyy*hy)
      ! Forces: stress times B and gamma times g. Opposite nodes have the same but for signs.
      along = over*(qy*hx - qx*hy)
      fx = 0.5_wp*fx
      fy = 0.5_wp*fy
      sxy = 0.5_wp*sxy
      ux = fx*qy - sxy*qx - along*gx
      uy = sxy*qy - fy*qx - along*gy
      along = over*(py*hx - px*hy)
      wx = fx*py - sxy*px - along*gx
      wy = sxy*py - fy*px - along*gy
      f(e, 1, 1) = ux - gx
      f(e, 2, 1) = gx - wx
      f(e, 3, 1) = -ux - gx
      f(e, 4, 1) = gx + wx
      f(e, 1, 2) = uy - gy
      f(e, 2, 2) = gy - wy
      f(e, 3, 2) = -uy - gy
      f(e, 4, 2) = gy + wy
    end do
    sums%power = 0.5_wp*power_2
    sums%stiffest = stiffest
    sums%argument = argument
  end subroutine advance_yardstick

end module yardstick_kernel_m
