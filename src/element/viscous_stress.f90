! SPDX-License-Identifier: MIT
!> Stress in proportion to the rate of deformation, of damping by stiffness
!> (doc/theory/elements.md, "Stiffness damping").
module viscous_stress_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: add_viscous_deviator, add_viscous_pressure, trace_of

contains

  !> Add 2 G beta times the deviator of the rate of deformation, and its work.
  pure subroutine add_viscous_deviator(shear, times, area, stress, work)
    real(wp), intent(in) :: shear                 !! G
    real(wp), intent(in) :: times(chunk_size)     !! beta
    real(wp), intent(in) :: area(chunk_size)      !! mid-step
    type(stress_chunk_t), intent(inout) :: stress
    real(wp), intent(inout) :: work
    real(wp) :: factor, third, x, y, inverse, sum
    integer :: i

    if (.not. stress%dt > 0.0_wp) return
    inverse = 2.0_wp*shear/stress%dt
    sum = 0.0_wp
    !$omp simd private(factor, third, x, y) reduction(+ : sum)
    do i = 1, chunk_size
      factor = inverse*times(i)
      ! Rates of a round body stand here less the hoop rate, which leaves their deviator.
      third = (stress%dxx(i) + stress%dyy(i))/3.0_wp
      x = stress%dxx(i) - third
      y = stress%dyy(i) - third
      stress%sxx(i) = stress%sxx(i) + factor*x
      stress%syy(i) = stress%syy(i) + factor*y
      stress%sxy(i) = stress%sxy(i) + factor*stress%dxy(i)
      sum = sum + factor*area(i)*(x*x + y*y + third*third + 2.0_wp*stress%dxy(i)**2)
    end do
    work = work + sum
  end subroutine add_viscous_deviator

  !> Add K beta times the rate of the volume, and its work.
  pure subroutine add_viscous_pressure(bulk, times, trace, area, dt, pressure, work)
    real(wp), intent(in) :: bulk                     !! K
    real(wp), intent(in) :: times(chunk_size)        !! beta
    real(wp), intent(in) :: trace(chunk_size)        !! rate of the volume over the volume
    real(wp), intent(in) :: area(chunk_size)         !! mid-step
    real(wp), intent(in) :: dt
    real(wp), intent(inout) :: pressure(chunk_size)  !! tension positive
    real(wp), intent(inout) :: work
    real(wp) :: more, sum
    integer :: i

    sum = 0.0_wp
    !$omp simd private(more) reduction(+ : sum)
    do i = 1, chunk_size
      more = bulk*times(i)*trace(i)
      pressure(i) = pressure(i) + more
      sum = sum + more*trace(i)*area(i)
    end do
    work = work + dt*sum
  end subroutine add_viscous_pressure

  !> Rate of the volume from the increments of a step; 0 where there was none.
  pure function trace_of(stress) result(trace)
    type(stress_chunk_t), intent(in) :: stress
    real(wp) :: trace(chunk_size)

    trace = 0.0_wp
    if (.not. stress%dt > 0.0_wp) return
    trace = (stress%dxx + stress%dyy)/stress%dt
    if (stress%has_hoop) trace = trace + 3.0_wp*stress%hoop/stress%dt
  end function trace_of

end module viscous_stress_m
