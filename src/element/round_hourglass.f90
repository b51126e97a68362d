! SPDX-License-Identifier: MIT
!> Hourglass control of the one-point round quad: the pattern and the force of the plane one
!> (Flanagan & Belytschko 1981, or assumed strain), times V/A.
module round_hourglass_m
  use kinds_m, only : wp
  use assumed_strain_m, only : form_moduli, largest_spread, resist_by_assumed_strain
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use parts_m, only : hourglass_t, material_t, hourglass_viscous
  use round_chunk_m, only : round_chunk_t
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: form_resistance, form_assumed_resistance, resist_round_viscously, &
    resist_round_elastically, resist_round_by_assumed_strain

contains

  !> Force over gamma.v, (Q_h rho c sqrt(A)/4) V/A; or over its integral,
  !> (Q_h/4)(K + 4G/3)((B_x.B_x + B_y.B_y)/A) V/A.
  pure subroutine form_resistance(material, hourglass, chunk, round)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(inout) :: round !! `resistance` out
    real(wp) :: factor
    integer :: i

    if (hourglass%form == hourglass_viscous) then
      factor = 0.25_wp*hourglass%coefficient*material%density*material%sound_speed
      !$omp simd
      do i = 1, chunk_size
        round%resistance(i) = factor*round%volume(i)*(chunk%inverse_area(i)*sqrt(chunk%area(i)))
      end do
    else
      factor = 0.125_wp*hourglass%coefficient*(material%bulk + 4.0_wp*material%shear/3.0_wp)
      !$omp simd
      do i = 1, chunk_size
        round%resistance(i) = factor*(chunk%x31(i)**2 + chunk%y31(i)**2 + chunk%x42(i)**2 &
          + chunk%y42(i)**2)*round%volume(i)*chunk%inverse_area(i)**2
      end do
    end if
  end subroutine form_resistance

  !> A bound of the force over gamma.v's integral for assumed strain,
  !> QM E/(16 (1 - nu^2)) (2/(3A)) S V/A with S the spread of the diagonals.
  pure subroutine form_assumed_resistance(material, hourglass, chunk, round)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(element_chunk_t), intent(in) :: chunk  !! present shape
    type(round_chunk_t), intent(inout) :: round !! `resistance` out
    real(wp) :: factor, lateral
    integer :: i

    call form_moduli(material, hourglass, factor, lateral)
    factor = factor*2.0_wp/3.0_wp
    !$omp simd
    do i = 1, chunk_size
      round%resistance(i) = factor*largest_spread(chunk%x31(i), chunk%y31(i), chunk%x42(i), &
        chunk%y42(i))*round%volume(i)*chunk%inverse_area(i)**2
    end do
  end subroutine form_assumed_resistance

  !> Assumed strain: the force of the plane times the mean radius V/A.
  pure subroutine resist_round_by_assumed_strain(material, hourglass, stress, round, stress_x, &
    stress_y, chunk, work)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(in) :: stress      !! rotation of the step
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(inout), dimension(chunk_size) :: stress_x, stress_y
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y and their work out
    real(wp), intent(out) :: work                   !! of all of them in the step
    real(wp) :: radius
    integer :: i

    call resist_by_assumed_strain(material, hourglass, stress, stress_x, stress_y, chunk, work)
    !$omp simd private(radius)
    do i = 1, chunk_size
      radius = round%volume(i)*chunk%inverse_area(i)
      chunk%qx(i) = radius*chunk%qx(i)
      chunk%qy(i) = radius*chunk%qy(i)
    end do
  end subroutine resist_round_by_assumed_strain

  !> Viscous form, with its work as in the plane (`resist_viscously`).
  pure subroutine resist_round_viscously(dt, round, last_x, last_y, chunk, work)
    real(wp), intent(in) :: dt
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(inout), dimension(chunk_size) :: last_x, last_y !! q of the step before; then
                                                  !! the present one
    type(element_chunk_t), intent(inout) :: chunk !! q_x, q_y and their work out
    real(wp), intent(out) :: work                 !! of all of them in the step
    integer :: i

    work = 0.0_wp
    !$omp simd reduction(+ : work)
    do i = 1, chunk_size
      chunk%qx(i) = round%resistance(i)*chunk%gx(i)
      chunk%qy(i) = round%resistance(i)*chunk%gy(i)
      chunk%hourglass_work(i) = 0.5_wp*dt*((last_x(i) + chunk%qx(i))*chunk%gx(i) &
        + (last_y(i) + chunk%qy(i))*chunk%gy(i))
      last_x(i) = chunk%qx(i)
      last_y(i) = chunk%qy(i)
      work = work + chunk%hourglass_work(i)
    end do
  end subroutine resist_round_viscously

  !> Stiffness form: the hourglass strain turns with the element as in the plane
  !> (`resist_elastically`).
  pure subroutine resist_round_elastically(dt, stress, round, strain_x, strain_y, chunk, work)
    real(wp), intent(in) :: dt
    type(stress_chunk_t), intent(in) :: stress      !! rotation of the step
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(inout), dimension(chunk_size) :: strain_x, strain_y
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y and their work out
    real(wp), intent(out) :: work                   !! of all of them in the step
    real(wp) :: half_x, half_y, old_x, old_y, growth_x, growth_y
    integer :: i

    work = 0.0_wp
    !$omp simd private(half_x, half_y, old_x, old_y, growth_x, growth_y) reduction(+ : work)
    do i = 1, chunk_size
      half_x = 0.5_wp*dt*chunk%gx(i)
      half_y = 0.5_wp*dt*chunk%gy(i)
      old_x = stress%cosine(i)*strain_x(i) - stress%sine(i)*strain_y(i)
      old_y = stress%sine(i)*strain_x(i) + stress%cosine(i)*strain_y(i)
      growth_x = half_x + (stress%cosine(i)*half_x - stress%sine(i)*half_y)
      growth_y = half_y + (stress%sine(i)*half_x + stress%cosine(i)*half_y)
      strain_x(i) = old_x + growth_x
      strain_y(i) = old_y + growth_y
      chunk%qx(i) = round%resistance(i)*strain_x(i)
      chunk%qy(i) = round%resistance(i)*strain_y(i)
      chunk%hourglass_work(i) = 0.5_wp*round%resistance(i)*((strain_x(i) + old_x)*growth_x &
        + (strain_y(i) + old_y)*growth_y)
      work = work + chunk%hourglass_work(i)
    end do
  end subroutine resist_round_elastically

end module round_hourglass_m
