! SPDX-License-Identifier: MIT
!> Hourglass control of the one-point round quad: the pattern and the force of the plane one
!> (Flanagan & Belytschko 1981), times V/A.
module round_hourglass_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use round_chunk_m, only : round_chunk_t
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: resist_round_viscously, resist_round_elastically

contains

  !> Viscous form: q = (Q_h rho c sqrt(A)/4) (V/A) gamma.v.
  pure subroutine resist_round_viscously(factor, dt, round, chunk, work)
    real(wp), intent(in) :: factor                !! Q_h rho c/4
    real(wp), intent(in) :: dt
    type(round_chunk_t), intent(in) :: round
    type(element_chunk_t), intent(inout) :: chunk !! q_x, q_y out
    real(wp), intent(out) :: work                 !! work of the step
    real(wp) :: viscosity
    integer :: i

    work = 0.0_wp
    !$omp simd private(viscosity) reduction(+ : work)
    do i = 1, chunk_size
      viscosity = factor*round%now%volume(i)/sqrt(round%now%area(i))
      chunk%qx(i) = viscosity*chunk%gx(i)
      chunk%qy(i) = viscosity*chunk%gy(i)
      work = work + (chunk%qx(i)*chunk%gx(i) + chunk%qy(i)*chunk%gy(i))
    end do
    work = dt*work
  end subroutine resist_round_viscously

  !> Stiffness form: (Q_h/4)(K + 4G/3)((B_x.B_x + B_y.B_y)/A)(V/A) times the hourglass strain, which
  !> turns with the element as in the plane (`resist_elastically`).
  pure subroutine resist_round_elastically(factor, dt, stress, round, strain_x, strain_y, chunk, &
    work)
    real(wp), intent(in) :: factor                  !! Q_h (K + 4G/3)/4
    real(wp), intent(in) :: dt
    type(stress_chunk_t), intent(in) :: stress      !! rotation of the step
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(inout), dimension(chunk_size) :: strain_x, strain_y
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y out
    real(wp), intent(out) :: work                   !! work of the step
    real(wp) :: stiffness, half_x, half_y, old_x, old_y, growth_x, growth_y
    integer :: i

    work = 0.0_wp
    associate (now => round%now)
      !$omp simd private(stiffness, half_x, half_y, old_x, old_y, growth_x, growth_y) &
      !$omp& reduction(+ : work)
      do i = 1, chunk_size
        stiffness = 0.5_wp*factor*((now%ar(i)**2 + now%az(i)**2) + (now%br(i)**2 + now%bz(i)**2)) &
          *now%volume(i)/(now%area(i)*now%area(i))
        half_x = 0.5_wp*dt*chunk%gx(i)
        half_y = 0.5_wp*dt*chunk%gy(i)
        old_x = stress%cosine(i)*strain_x(i) - stress%sine(i)*strain_y(i)
        old_y = stress%sine(i)*strain_x(i) + stress%cosine(i)*strain_y(i)
        growth_x = half_x + (stress%cosine(i)*half_x - stress%sine(i)*half_y)
        growth_y = half_y + (stress%sine(i)*half_x + stress%cosine(i)*half_y)
        strain_x(i) = old_x + growth_x
        strain_y(i) = old_y + growth_y
        chunk%qx(i) = stiffness*strain_x(i)
        chunk%qy(i) = stiffness*strain_y(i)
        work = work + stiffness*((strain_x(i) + old_x)*growth_x + (strain_y(i) + old_y)*growth_y)
      end do
    end associate
    work = 0.5_wp*work
  end subroutine resist_round_elastically

end module round_hourglass_m
