! SPDX-License-Identifier: MIT
!> Deformation gradient of a chunk from the displacement and the reference shape, for laws that have
!> no history (doc/theory/elements.md, "Deformation gradient").
module deformation_gradient_m
  use element_chunk_m, only : element_chunk_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: form_gradient, form_round_gradient, form_rubber_forces

  real(wp), parameter :: part = 1.0_wp/24.0_wp, eighth = 0.125_wp

contains

  !> F - 1 at a point, or of a one-point quad: both are parallelograms. In round bodies F_33 is what
  !> makes det F the volume ratio of the point. Where the dilatation is that of the element, F is
  !> scaled to it.
  pure subroutine form_gradient(chunk, stress)
    type(element_chunk_t), intent(in) :: chunk
    type(stress_chunk_t), intent(inout) :: stress !! V/V0 - 1 of the element in `stretch`
    real(wp) :: x31, y31, x42, y42, factor
    integer :: i

    !$omp simd private(x31, y31, x42, y42, factor)
    do i = 1, chunk_size
      x31 = chunk%x31(i) - chunk%u31(1, i)
      y31 = chunk%y31(i) - chunk%u31(2, i)
      x42 = chunk%x42(i) - chunk%u42(1, i)
      y42 = chunk%y42(i) - chunk%u42(2, i)
      factor = 1.0_wp/(x31*y42 - x42*y31)
      stress%hxx(i) = factor*(chunk%u31(1, i)*y42 - chunk%u42(1, i)*y31)
      stress%hxy(i) = factor*(x31*chunk%u42(1, i) - x42*chunk%u31(1, i))
      stress%hyx(i) = factor*(chunk%u31(2, i)*y42 - chunk%u42(2, i)*y31)
      stress%hyy(i) = factor*(x31*chunk%u42(2, i) - x42*chunk%u31(2, i))
    end do
    call finish_gradient(chunk%stretch, stress)
  end subroutine form_gradient

  !> F - 1 of a one-point round quad: the mean over the reference volume.
  pure subroutine form_round_gradient(chunk, stress)
    type(element_chunk_t), intent(in) :: chunk
    type(stress_chunk_t), intent(inout) :: stress
    real(wp) :: g(6), inverse
    integer :: i

    do i = 1, chunk_size
      g = start_gradients(chunk, i)
      inverse = chunk%inverse_volume(i)*(1.0_wp + chunk%stretch(i))
      stress%hxx(i) = inverse*(g(1)*chunk%u31(1, i) + g(2)*chunk%u42(1, i) + g(3)*chunk%hu(1, i))
      stress%hyx(i) = inverse*(g(1)*chunk%u31(2, i) + g(2)*chunk%u42(2, i) + g(3)*chunk%hu(2, i))
      stress%hxy(i) = inverse*(g(4)*chunk%u31(1, i) + g(5)*chunk%u42(1, i) + g(6)*chunk%hu(1, i))
      stress%hyy(i) = inverse*(g(4)*chunk%u31(2, i) + g(5)*chunk%u42(2, i) + g(6)*chunk%hu(2, i))
    end do
    call finish_gradient(chunk%stretch, stress)
  end subroutine form_round_gradient

  !> `rad` and `axi` of the patterns a, b, h at time zero (see `form_round_shape`).
  pure function start_gradients(chunk, i) result(g)
    type(element_chunk_t), intent(in) :: chunk
    integer, intent(in) :: i
    real(wp) :: g(6)
    real(wp) :: ar, az, br, bz, hr, hz, s

    ar = chunk%x31(i) - chunk%u31(1, i)
    az = chunk%y31(i) - chunk%u31(2, i)
    br = chunk%x42(i) - chunk%u42(1, i)
    bz = chunk%y42(i) - chunk%u42(2, i)
    hr = part*(chunk%hx(i) - chunk%hu(1, i))
    hz = part*(chunk%hy(i) - chunk%hu(2, i))
    s = chunk%radii(i) - eighth*chunk%us(i)
    g = [s*bz - br*hz, -(s*az + ar*hz), part*(ar*bz + br*az), -br*(s - hr), ar*(s + hr), &
      -2.0_wp*part*ar*br]
  end function start_gradients

  !> The part out of the plane, and the dilatation of the element in place of the point's own.
  pure subroutine finish_gradient(own, stress)
    real(wp), intent(in) :: own(chunk_size)
    type(stress_chunk_t), intent(inout) :: stress
    real(wp) :: z, share, hoop
    integer :: i

    hoop = merge(1.0_wp, 0.0_wp, stress%has_hoop)
    do i = 1, chunk_size
      stress%volume(i) = 1.0_wp + own(i)
      z = stress%hxx(i) + stress%hyy(i) + (stress%hxx(i)*stress%hyy(i) - stress%hxy(i) &
        *stress%hyx(i))
      stress%hzz(i) = hoop*(own(i) - z)/(1.0_wp + z)
      ! ((1 + stretch)/(1 + own))^(1/3) - 1
      z = max(-0.9_wp, (stress%stretch(i) - own(i))/(2.0_wp + (stress%stretch(i) + own(i))))
      share = tanh(atanh(z)*(1.0_wp/3.0_wp))
      share = 2.0_wp*share/(1.0_wp - share)
      stress%hxx(i) = stress%hxx(i) + share*(1.0_wp + stress%hxx(i))
      stress%hyy(i) = stress%hyy(i) + share*(1.0_wp + stress%hyy(i))
      stress%hzz(i) = stress%hzz(i) + share*(1.0_wp + stress%hzz(i))
      stress%hxy(i) = stress%hxy(i) + share*stress%hxy(i)
      stress%hyx(i) = stress%hyx(i) + share*stress%hyx(i)
    end do
  end subroutine finish_gradient

  !> Nodal forces of a one-point round quad that are the derivative of W: with F of the plane the
  !> mean over the reference volume and F_33 = J/det F,
  !>   dW V0 = (sigma - s_33 1) : (dF J F^-1) V0 + s_33 dV,
  !> so that gradients of time zero, J F^-T of them, stand where `form_round_forces` has present
  !> ones.
  pure subroutine form_rubber_forces(stress, chunk)
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: chunk !! forces out
    real(wp) :: g(6), rr, zz, rz, tt, qr, qz, turned(2, 2), factor
    integer :: i, k

    do i = 1, chunk_size
      g = start_gradients(chunk, i)
      tt = chunk%pressure(i) - (stress%sxx(i) + stress%syy(i))
      ! sigma - s_33 1, times J F^-T = F_33 (F22, -F21; -F12, F11).
      rr = 2.0_wp*stress%sxx(i) + stress%syy(i)
      zz = stress%sxx(i) + 2.0_wp*stress%syy(i)
      rz = stress%sxy(i)
      factor = 1.0_wp + stress%hzz(i)
      turned(1, 1) = factor*(rr*(1.0_wp + stress%hyy(i)) - rz*stress%hxy(i))
      turned(1, 2) = factor*(rz*(1.0_wp + stress%hxx(i)) - rr*stress%hyx(i))
      turned(2, 1) = factor*(rz*(1.0_wp + stress%hyy(i)) - zz*stress%hxy(i))
      turned(2, 2) = factor*(zz*(1.0_wp + stress%hxx(i)) - rz*stress%hyx(i))
      do k = 1, 2
        chunk%force3(k, i) = turned(k, 1)*g(1) + turned(k, 2)*g(4)
        chunk%force4(k, i) = turned(k, 1)*g(2) + turned(k, 2)*g(5)
        chunk%swing(k, i) = turned(k, 1)*g(3) + turned(k, 2)*g(6)
      end do
      qr = 12.0_wp*chunk%inverse_area(i)*chunk%qx(i)
      qz = 12.0_wp*chunk%inverse_area(i)*chunk%qy(i)
      chunk%force3(1, i) = chunk%force3(1, i) + tt*(chunk%rad_a(i) + chunk%mean_a(i)) &
        - chunk%mean_a(i)*qr
      chunk%force3(2, i) = chunk%force3(2, i) + tt*chunk%axi_a(i) - chunk%mean_a(i)*qz
      chunk%force4(1, i) = chunk%force4(1, i) + tt*(chunk%rad_b(i) + chunk%mean_b(i)) &
        + chunk%mean_b(i)*qr
      chunk%force4(2, i) = chunk%force4(2, i) + tt*chunk%axi_b(i) + chunk%mean_b(i)*qz
      chunk%swing(1, i) = chunk%swing(1, i) + tt*chunk%rad_h(i) + chunk%qx(i)
      chunk%swing(2, i) = chunk%swing(2, i) + tt*chunk%axi_h(i) + chunk%qy(i)
      chunk%hoop(i) = tt*chunk%mean_s(i)
    end do
  end subroutine form_rubber_forces

end module deformation_gradient_m
