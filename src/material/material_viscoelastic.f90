! SPDX-License-Identifier: MIT
!> Linear viscoelastic deviator: G(t) = GI + (G0 - GI) exp(-beta t), Jaumann rate. s = s_inf + q,
!> ds_inf = 2 GI de, q(n+1) = a q(n) + 2 (G0 - GI) b de, a = exp(-beta dt), b = (1 - a)/(beta dt):
!> exact for a constant rate in the step.
module material_viscoelastic_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : material_t
  use stress_chunk_m, only : stress_chunk_t, rotate_deviator
  implicit none
  private
  public :: update_viscoelastic

contains

  !> Update the deviator of a chunk and its overstress q.
  pure subroutine update_viscoelastic(material, chunk, qxx, qyy, qxy)
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(inout) :: chunk !! increments in, deviator in and out, work out
    real(wp), intent(inout), dimension(chunk_size) :: qxx, qyy, qxy !! overstress, a deviator
    real(wp) :: decay, slow, fast, third, exx, eyy, exy, work, x
    integer :: i

    call rotate_deviator(chunk%cos2, chunk%sin2, qxx, qyy, qxy)
    x = material%decay*chunk%dt
    decay = exp(-x)
    slow = 2.0_wp*material%long_shear
    ! (1 - exp(-x))/x; its series where digits would be lost.
    fast = 1.0_wp - 0.5_wp*x + x**2/6.0_wp
    if (x > 1.0e-4_wp) fast = (1.0_wp - decay)/x
    fast = 2.0_wp*(material%shear - material%long_shear)*fast
    !$omp simd private(third, exx, eyy, exy, work)
    do i = 1, chunk_size
      third = (1.0_wp/3.0_wp)*(chunk%dxx(i) + chunk%dyy(i))
      exx = chunk%dxx(i) - third
      eyy = chunk%dyy(i) - third
      exy = chunk%dxy(i)
      work = chunk%sxx(i)*chunk%dxx(i) + chunk%syy(i)*chunk%dyy(i) + 2.0_wp*chunk%sxy(i)*exy
      chunk%sxx(i) = chunk%sxx(i) + (slow + fast)*exx - (1.0_wp - decay)*qxx(i)
      chunk%syy(i) = chunk%syy(i) + (slow + fast)*eyy - (1.0_wp - decay)*qyy(i)
      chunk%sxy(i) = chunk%sxy(i) + (slow + fast)*exy - (1.0_wp - decay)*qxy(i)
      qxx(i) = decay*qxx(i) + fast*exx
      qyy(i) = decay*qyy(i) + fast*eyy
      qxy(i) = decay*qxy(i) + fast*exy
      chunk%work(i) = 0.5_wp*(work + chunk%sxx(i)*chunk%dxx(i) + chunk%syy(i)*chunk%dyy(i) &
        + 2.0_wp*chunk%sxy(i)*exy)
    end do
  end subroutine update_viscoelastic

end module material_viscoelastic_m
