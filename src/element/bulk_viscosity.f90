! SPDX-License-Identifier: MIT
!> Bulk viscosity (von Neumann & Richtmyer 1950, linear term of Landshoff), compression only.
module bulk_viscosity_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use element_chunk_m, only : element_chunk_t
  implicit none
  private
  public :: add_bulk_viscosity

contains

  !> Add q = rho l (Q1 l t^2 - Q2 c t) as a pressure where the volumetric
  !> strain rate t < 0; l = sqrt(A). Its work is that of the mean of it and of the one before: it
  !> acts over half of the step that it was formed from and half of the next, in which the element
  !> may expand.
  pure subroutine add_bulk_viscosity(quadratic, linear, density, sound_speed, dt, chunk, last, work)
    real(wp), intent(in) :: quadratic, linear     !! Q1, Q2
    real(wp), intent(in) :: density               !! initial density
    real(wp), intent(in) :: sound_speed
    real(wp), intent(in) :: dt
    type(element_chunk_t), intent(inout) :: chunk !! pressure in and out
    real(wp), intent(inout) :: last(chunk_size)   !! q of the step before; then the present one
    real(wp), intent(out) :: work                 !! dissipated in the step
    real(wp) :: length, rate, q
    integer :: i

    work = 0.0_wp
    !$omp simd private(length, rate, q) reduction(+ : work)
    do i = 1, chunk_size
      length = sqrt(abs(chunk%area(i)))
      rate = min(0.0_wp, chunk%trace(i))
      q = density/(1.0_wp + chunk%stretch(i))*length*rate &
        *(quadratic*length*rate - linear*sound_speed)
      chunk%pressure(i) = chunk%pressure(i) - q
      work = work - (last(i) + q)*chunk%trace(i)*chunk%mid_area(i)
      last(i) = q
    end do
    work = 0.5_wp*dt*work
  end subroutine add_bulk_viscosity

end module bulk_viscosity_m
