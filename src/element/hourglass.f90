! SPDX-License-Identifier: MIT
!> Flanagan-Belytschko hourglass control of the one-point quad (METHODS section 1; Flanagan &
!> Belytschko 1981), from the hourglass velocity gamma.v.
module hourglass_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use element_chunk_m, only : element_chunk_t
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: resist_viscously, resist_elastically

contains

  !> Viscous form: q = (Q_h rho c sqrt(A)/4) gamma.v.
  pure subroutine resist_viscously(factor, dt, chunk, work)
    real(wp), intent(in) :: factor                !! Q_h rho c/4
    real(wp), intent(in) :: dt
    type(element_chunk_t), intent(inout) :: chunk !! q_x, q_y out
    real(wp), intent(out) :: work                 !! work of the step
    real(wp) :: viscosity
    integer :: i

    work = 0.0_wp
    !$omp simd private(viscosity) reduction(+ : work)
    do i = 1, chunk_size
      viscosity = factor*sqrt(chunk%area(i))
      chunk%qx(i) = viscosity*chunk%gx(i)
      chunk%qy(i) = viscosity*chunk%gy(i)
      work = work + (chunk%qx(i)*chunk%gx(i) + chunk%qy(i)*chunk%gy(i))
    end do
    work = dt*work
  end subroutine resist_viscously

  !> Stiffness form: the hourglass strain grows by dt gamma.v and turns with the element;
  !> force (Q_h/4)(K + 4G/3)((B_x.B_x + B_y.B_y)/A) times that strain.
  pure subroutine resist_elastically(factor, dt, stress, strain_x, strain_y, chunk, work)
    real(wp), intent(in) :: factor                  !! Q_h (K + 4G/3)/4
    real(wp), intent(in) :: dt
    type(stress_chunk_t), intent(in) :: stress      !! rotation of the step
    real(wp), intent(inout), dimension(chunk_size) :: strain_x, strain_y
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y out
    real(wp), intent(out) :: work                   !! work of the step
    real(wp) :: stiffness, old_x, old_y
    integer :: i

    work = 0.0_wp
    !$omp simd private(stiffness, old_x, old_y) reduction(+ : work)
    do i = 1, chunk_size
      stiffness = 0.5_wp*factor*(chunk%x31(i)**2 + chunk%y31(i)**2 + chunk%x42(i)**2 &
        + chunk%y42(i)**2)*chunk%inverse_area(i)
      old_x = stress%cosine(i)*strain_x(i) - stress%sine(i)*strain_y(i)
      old_y = stress%sine(i)*strain_x(i) + stress%cosine(i)*strain_y(i)
      strain_x(i) = old_x + dt*chunk%gx(i)
      strain_y(i) = old_y + dt*chunk%gy(i)
      chunk%qx(i) = stiffness*strain_x(i)
      chunk%qy(i) = stiffness*strain_y(i)
      work = work + stiffness*((strain_x(i) + old_x)*chunk%gx(i) + (strain_y(i) + old_y)*chunk%gy(i))
    end do
    work = 0.5_wp*dt*work
  end subroutine resist_elastically

end module hourglass_m
