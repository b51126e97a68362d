! SPDX-License-Identifier: MIT
!> Hourglass control by assumed strain (Belytschko & Bindeman 1991, the field of optimal bending):
!> the elastic stress of the hourglass strain, in a frame that turns with the element, integrated
!> in closed form (doc/theory/elements.md, "Assumed strain").
module assumed_strain_m
  use element_chunk_m, only : element_chunk_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : hourglass_t, material_t
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: resist_by_assumed_strain, form_moduli, largest_spread

contains

  !> Step the generalised stress Q of the element's frame,
  !>   Q' = factor [H_xx, -lateral H_xy; -lateral H_xy, H_yy] (gamma.v in that frame),
  !> with H of the mid-step shape, so that a motion and its reverse leave nothing behind.
  pure subroutine resist_by_assumed_strain(material, hourglass, stress, stress_x, stress_y, chunk, &
    work)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(in) :: stress      !! step, and rotation in it
    real(wp), intent(inout), dimension(chunk_size) :: stress_x, stress_y !! Q
    type(element_chunk_t), intent(inout) :: chunk   !! q_x, q_y out, per unit of depth; their work
    real(wp), intent(out) :: work                   !! of all of them in the step
    real(wp) :: factor, lateral, back, x31, y31, x42, y42, cosine, sine, scale, area, weight, mxx, &
      mxy, myy, half, grown_x, grown_y, added_x, added_y
    integer :: i

    call form_moduli(material, hourglass, factor, lateral)
    back = 0.5_wp*stress%dt
    work = 0.0_wp
    !$omp simd private(x31, y31, x42, y42, cosine, sine, scale, area, weight, mxx, mxy, myy, half, &
    !$omp& grown_x, grown_y, added_x, added_y) reduction(+ : work)
    do i = 1, chunk_size
      x31 = chunk%x31(i) - back*chunk%v31(1, i)
      y31 = chunk%y31(i) - back*chunk%v31(2, i)
      x42 = chunk%x42(i) - back*chunk%v42(1, i)
      y42 = chunk%y42(i) - back*chunk%v42(2, i)
      area = 0.5_wp*(x31*y42 - x42*y31)
      ! The frame: rotation of the polar decomposition of the mean Jacobian.
      cosine = (x31 - x42) + (y31 + y42)
      sine = (y31 - y42) - (x31 + x42)
      scale = 1.0_wp/sqrt(cosine*cosine + sine*sine)
      cosine = scale*cosine
      sine = scale*sine
      added_x = cosine*x31 + sine*y31
      added_y = cosine*y31 - sine*x31
      grown_x = cosine*x42 + sine*y42
      grown_y = cosine*y42 - sine*x42
      weight = 2.0_wp*factor/(3.0_wp*area)
      mxx = weight*(added_y*added_y + grown_y*grown_y)
      myy = weight*(added_x*added_x + grown_x*grown_x)
      mxy = weight*lateral*(added_x*added_y + grown_x*grown_y)
      grown_x = cosine*chunk%gx(i) + sine*chunk%gy(i)
      grown_y = cosine*chunk%gy(i) - sine*chunk%gx(i)
      ! gamma.v of an element that turns is too large by one over the cosine of half the angle.
      half = stress%dt*sqrt(0.5_wp + 0.5_wp*stress%cosine(i))
      grown_x = half*grown_x
      grown_y = half*grown_y
      cosine = (chunk%x31(i) - chunk%x42(i)) + (chunk%y31(i) + chunk%y42(i))
      sine = (chunk%y31(i) - chunk%y42(i)) - (chunk%x31(i) + chunk%x42(i))
      scale = 1.0_wp/sqrt(cosine*cosine + sine*sine)
      cosine = scale*cosine
      sine = scale*sine
      added_x = mxx*grown_x + mxy*grown_y
      added_y = mxy*grown_x + myy*grown_y
      ! In round bodies `mid_area` is the volume per radian.
      chunk%hourglass_work(i) = chunk%mid_area(i)/area*((stress_x(i) + 0.5_wp*added_x)*grown_x &
        + (stress_y(i) + 0.5_wp*added_y)*grown_y)
      work = work + chunk%hourglass_work(i)
      stress_x(i) = stress_x(i) + added_x
      stress_y(i) = stress_y(i) + added_y
      chunk%qx(i) = cosine*stress_x(i) - sine*stress_y(i)
      chunk%qy(i) = sine*stress_x(i) + cosine*stress_y(i)
    end do
  end subroutine resist_by_assumed_strain

  !> QM E/(16 (1 - nu^2)) and nu/(1 - nu).
  pure subroutine form_moduli(material, hourglass, factor, lateral)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(out) :: factor, lateral
    real(wp) :: wave

    wave = 3.0_wp*material%bulk + 4.0_wp*material%shear
    factor = 0.25_wp*hourglass%coefficient*material%shear*(3.0_wp*material%bulk + material%shear) &
      /wave
    lateral = (3.0_wp*material%bulk - 2.0_wp*material%shear)/wave
  end subroutine form_moduli

  !> Larger eigenvalue of d31 d31 + d42 d42 (dyads): H, and with it the stiffness over `factor`,
  !> has none above 2/(3A) of it.
  pure elemental function largest_spread(x31, y31, x42, y42) result(spread)
    !$omp declare simd(largest_spread)
    real(wp), intent(in) :: x31, y31, x42, y42
    real(wp) :: spread
    real(wp) :: xx, yy, xy

    xx = x31*x31 + x42*x42
    yy = y31*y31 + y42*y42
    xy = x31*y31 + x42*y42
    spread = 0.5_wp*((xx + yy) + sqrt((xx - yy)**2 + 4.0_wp*xy*xy))
  end function largest_spread

end module assumed_strain_m
