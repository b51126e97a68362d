! SPDX-License-Identifier: MIT
!> Kinematics of the one-point quad.
!> With B_x3 = y42/2, B_y3 = -x42/2, B_x4 = -y31/2, B_y4 = x31/2 (and opposite signs at nodes 1 and
!> 2): A = (x31 y42 - x42 y31)/2, L_ix = (v31 y42 - v42 y31)/(2A), L_iy = (x31 v42 - x42 v31)/(2A).
module quad_kinematics_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use element_chunk_m, only : element_chunk_t
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: form_present_shape, form_increments, form_forces

contains

  !> Present diagonals, area and volume ratio. A - A0 is formed from the displacement, so that a
  !> nearly undeformed element keeps all digits of its strain.
  pure subroutine form_present_shape(reference, stride, chunk)
    integer, intent(in) :: stride                 !! length of one stream
    real(wp), intent(in) :: reference(stride, *)  !! first slot of this chunk; X31 Y31 X42 Y42 h.X
                                                  !! h.Y
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: growth, start, both
    integer :: i

    !$omp simd private(growth, start, both)
    do i = 1, chunk_size
      chunk%x31(i) = reference(i, 1) + chunk%u31(1, i)
      chunk%y31(i) = reference(i, 2) + chunk%u31(2, i)
      chunk%x42(i) = reference(i, 3) + chunk%u42(1, i)
      chunk%y42(i) = reference(i, 4) + chunk%u42(2, i)
      chunk%hx(i) = reference(i, 5) + chunk%hu(1, i)
      chunk%hy(i) = reference(i, 6) + chunk%hu(2, i)
      start = 0.5_wp*(reference(i, 1)*reference(i, 4) - reference(i, 3)*reference(i, 2))
      growth = 0.5_wp*((reference(i, 1)*chunk%u42(2, i) + chunk%u31(1, i)*chunk%y42(i)) &
        - (reference(i, 3)*chunk%u31(2, i) + chunk%u42(1, i)*chunk%y31(i)))
      chunk%area(i) = start + growth
      ! One division for two: divisions are what the loops wait for.
      both = 1.0_wp/(start*(start + growth))
      chunk%inverse_area(i) = both*start
      chunk%stretch(i) = growth*(both*(start + growth))
    end do
  end subroutine form_present_shape

  !> Strain increments, spin and hourglass velocity of the step, in the mid-step geometry.
  pure subroutine form_increments(dt, chunk, stress)
    real(wp), intent(in) :: dt                      !! step that led here
    type(element_chunk_t), intent(inout) :: chunk
    type(stress_chunk_t), intent(inout) :: stress   !! increments and rotation out
    real(wp) :: x31, y31, x42, y42, back, factor, lxx, lxy, lyx, lyy, area, turn, square, &
      both, inverse, cosine, sine, mean, half, shear
    integer :: i

    stress%dt = dt
    back = 0.5_wp*dt
    !$omp simd private(x31, y31, x42, y42, factor, lxx, lxy, lyx, lyy, area, turn, square, &
    !$omp& both, inverse, cosine, sine, mean, half, shear)
    do i = 1, chunk_size
      x31 = chunk%x31(i) - back*chunk%v31(1, i)
      y31 = chunk%y31(i) - back*chunk%v31(2, i)
      x42 = chunk%x42(i) - back*chunk%v42(1, i)
      y42 = chunk%y42(i) - back*chunk%v42(2, i)
      area = 0.5_wp*(x31*y42 - x42*y31)
      chunk%mid_area(i) = area
      ! tan(half the rotation) = turn/A; one division gives 1/A and 1/(A^2 + turn^2).
      turn = 0.125_wp*dt*((chunk%v31(2, i)*y42 - chunk%v42(2, i)*y31) &
        - (x31*chunk%v42(1, i) - x42*chunk%v31(1, i)))
      square = area*area + turn*turn
      both = 1.0_wp/(area*square)
      factor = 0.5_wp*(both*square)
      inverse = both*area
      lxx = factor*(chunk%v31(1, i)*y42 - chunk%v42(1, i)*y31)
      lxy = factor*(x31*chunk%v42(1, i) - x42*chunk%v31(1, i))
      lyx = factor*(chunk%v31(2, i)*y42 - chunk%v42(2, i)*y31)
      lyy = factor*(x31*chunk%v42(2, i) - x42*chunk%v31(2, i))
      chunk%trace(i) = lxx + lyy
      cosine = (area*area - turn*turn)*inverse
      sine = 2.0_wp*area*turn*inverse
      stress%cosine(i) = cosine
      stress%sine(i) = sine
      stress%cos2(i) = cosine*cosine - sine*sine
      stress%sin2(i) = 2.0_wp*cosine*sine
      ! Mid-step increments turn by half the rotation to stand beside the rotated stress.
      mean = back*(lxx + lyy)
      half = back*(lxx - lyy)
      shear = back*(lxy + lyx)
      stress%dxx(i) = mean + (cosine*half - sine*shear)
      stress%dyy(i) = mean - (cosine*half - sine*shear)
      stress%dxy(i) = cosine*shear + sine*half
      x31 = chunk%hx(i) - back*chunk%hv(1, i)
      y31 = chunk%hy(i) - back*chunk%hv(2, i)
      chunk%gx(i) = chunk%hv(1, i) - (lxx*x31 + lxy*y31)
      chunk%gy(i) = chunk%hv(2, i) - (lyx*x31 + lyy*y31)
    end do
  end subroutine form_increments

  !> Nodal forces f_a = sigma B_a + q gamma_a, gamma_a = h_a - (B_xa h.x + B_ya h.y)/A: the second
  !> part of gamma joins the stress.
  pure subroutine form_forces(stress, chunk)
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: chunk !! `force3`, `force4` and `swing` out
    real(wp) :: wx, wy, txx, txy, tyx, tyy
    integer :: i

    !$omp simd private(wx, wy, txx, txy, tyx, tyy)
    do i = 1, chunk_size
      wx = chunk%hx(i)*chunk%inverse_area(i)
      wy = chunk%hy(i)*chunk%inverse_area(i)
      txx = 0.5_wp*((stress%sxx(i) + chunk%pressure(i)) - chunk%qx(i)*wx)
      txy = 0.5_wp*(stress%sxy(i) - chunk%qx(i)*wy)
      tyx = 0.5_wp*(stress%sxy(i) - chunk%qy(i)*wx)
      tyy = 0.5_wp*((stress%syy(i) + chunk%pressure(i)) - chunk%qy(i)*wy)
      chunk%force3(1, i) = txx*chunk%y42(i) - txy*chunk%x42(i)
      chunk%force3(2, i) = tyx*chunk%y42(i) - tyy*chunk%x42(i)
      chunk%force4(1, i) = txy*chunk%x31(i) - txx*chunk%y31(i)
      chunk%force4(2, i) = tyy*chunk%x31(i) - tyx*chunk%y31(i)
      chunk%swing(1, i) = chunk%qx(i)
      chunk%swing(2, i) = chunk%qy(i)
    end do
  end subroutine form_forces

end module quad_kinematics_m
