! SPDX-License-Identifier: MIT
!> Kinematics and forces of the one-point round quad with gradients averaged over its volume
!> (doc/theory/elements.md, "Round bodies"). x is the radius r, y the axis z.
module round_kinematics_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use round_chunk_m, only : round_chunk_t, round_shape_t, reference_sum, form_gradients
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: form_round_shape, form_round_increments, form_round_forces

contains

  !> Present shape and V/V0 - 1. V - V0 is formed from the displacement, so that a nearly undeformed
  !> element keeps all digits of its strain.
  pure subroutine form_round_shape(reference, stride, chunk, round)
    integer, intent(in) :: stride                !! length of one stream
    real(wp), intent(in) :: reference(stride, *) !! first slot of this chunk, see round_chunk
    type(element_chunk_t), intent(inout) :: chunk
    type(round_chunk_t), intent(inout) :: round
    real(wp) :: start, growth, cross, cross_growth, pair, pair_growth, area, area_growth
    integer :: i

    associate (now => round%now)
      !$omp simd
      do i = 1, chunk_size
        now%ar(i) = reference(i, 1) + chunk%u31(1, i)
        now%az(i) = reference(i, 2) + chunk%u31(2, i)
        now%br(i) = reference(i, 3) + chunk%u42(1, i)
        now%bz(i) = reference(i, 4) + chunk%u42(2, i)
        now%hr(i) = reference(i, 5) + chunk%hu(1, i)
        now%hz(i) = reference(i, 6) + chunk%hu(2, i)
        now%s(i) = reference(i, reference_sum) + round%us(i)
      end do
      call form_gradients(now)
      !$omp simd private(start, growth, cross, cross_growth, pair, pair_growth, area, area_growth)
      do i = 1, chunk_size
        area = 0.5_wp*(reference(i, 1)*reference(i, 4) - reference(i, 3)*reference(i, 2))
        area_growth = 0.5_wp*((reference(i, 1)*chunk%u42(2, i) + chunk%u31(1, i)*now%bz(i)) &
          - (reference(i, 3)*chunk%u31(2, i) + chunk%u42(1, i)*now%az(i)))
        cross = reference(i, 1)*reference(i, 4) + reference(i, 3)*reference(i, 2)
        cross_growth = (reference(i, 1)*chunk%u42(2, i) + chunk%u31(1, i)*now%bz(i)) &
          + (reference(i, 3)*chunk%u31(2, i) + chunk%u42(1, i)*now%az(i))
        pair = reference(i, 1)*reference(i, 3)
        pair_growth = reference(i, 1)*chunk%u42(1, i) + chunk%u31(1, i)*now%br(i)
        start = 0.25_wp*reference(i, reference_sum)*area + (1.0_wp/24.0_wp)*(reference(i, 5)*cross &
          - 2.0_wp*pair*reference(i, 6))
        growth = 0.25_wp*(reference(i, reference_sum)*area_growth &
          + round%us(i)*(area + area_growth)) + (1.0_wp/24.0_wp)*((reference(i, 5)*cross_growth &
          + chunk%hu(1, i)*(cross + cross_growth)) - 2.0_wp*(pair*chunk%hu(2, i) &
          + pair_growth*now%hz(i)))
        chunk%stretch(i) = growth/start
      end do
      ! What loops over plane and round chunks alike read.
      chunk%area = now%area
    end associate
  end subroutine form_round_shape

  !> Strain increments, spin and hourglass velocity of the step, in the mid-step geometry. The hoop
  !> rate is taken from both rates in the plane: laws see the same deviator, and their D_zz is 0.
  pure subroutine form_round_increments(dt, chunk, round, stress)
    real(wp), intent(in) :: dt                    !! step that led here
    type(element_chunk_t), intent(inout) :: chunk !! trace, gamma.v and mid-step volume out
    type(round_chunk_t), intent(in) :: round
    type(stress_chunk_t), intent(inout) :: stress !! increments and rotation out
    type(round_shape_t) :: mid
    real(wp) :: inverse, lrr, lrz, lzr, lzz, ltt, tangent, cosine, sine, mean, half, shear, back, &
      grr, grz, gzr, gzz
    integer :: i

    stress%dt = dt
    stress%has_hoop = .true.
    back = 0.5_wp*dt
    call form_mid_shape(back, chunk, round, mid)
    !$omp simd private(inverse, lrr, lrz, lzr, lzz, ltt, tangent, cosine, sine, mean, half, shear, &
    !$omp& grr, grz, gzr, gzz)
    do i = 1, chunk_size
      chunk%mid_area(i) = mid%volume(i)
      inverse = 1.0_wp/mid%volume(i)
      lrr = inverse*(mid%rad_a(i)*chunk%v31(1, i) + mid%rad_b(i)*chunk%v42(1, i) &
        + mid%rad_h(i)*chunk%hv(1, i))
      lrz = inverse*(mid%axi_a(i)*chunk%v31(1, i) + mid%axi_b(i)*chunk%v42(1, i) &
        + mid%axi_h(i)*chunk%hv(1, i))
      lzr = inverse*(mid%rad_a(i)*chunk%v31(2, i) + mid%rad_b(i)*chunk%v42(2, i) &
        + mid%rad_h(i)*chunk%hv(2, i))
      lzz = inverse*(mid%axi_a(i)*chunk%v31(2, i) + mid%axi_b(i)*chunk%v42(2, i) &
        + mid%axi_h(i)*chunk%hv(2, i))
      ltt = inverse*(mid%mean_a(i)*chunk%v31(1, i) + mid%mean_b(i)*chunk%v42(1, i) &
        + mid%mean_s(i)*round%vs(i))
      chunk%trace(i) = (lrr + lzz) + ltt
      tangent = 0.5_wp*back*(lzr - lrz)
      sine = 1.0_wp/(1.0_wp + tangent*tangent)
      cosine = (1.0_wp - tangent*tangent)*sine
      sine = 2.0_wp*tangent*sine
      stress%cosine(i) = cosine
      stress%sine(i) = sine
      stress%cos2(i) = cosine*cosine - sine*sine
      stress%sin2(i) = 2.0_wp*cosine*sine
      ! Mid-step increments turn by half the rotation to stand beside the rotated stress.
      stress%hoop(i) = dt*ltt
      mean = back*(lrr + lzz) - dt*ltt
      half = back*(lrr - lzz)
      shear = back*(lrz + lzr)
      stress%dxx(i) = mean + (cosine*half - sine*shear)
      stress%dyy(i) = mean - (cosine*half - sine*shear)
      stress%dxy(i) = cosine*shear + sine*half
      ! Hourglass control sees what is not linear in the plane.
      inverse = 0.5_wp/mid%area(i)
      grr = inverse*(chunk%v31(1, i)*mid%bz(i) - chunk%v42(1, i)*mid%az(i))
      grz = inverse*(mid%ar(i)*chunk%v42(1, i) - mid%br(i)*chunk%v31(1, i))
      gzr = inverse*(chunk%v31(2, i)*mid%bz(i) - chunk%v42(2, i)*mid%az(i))
      gzz = inverse*(mid%ar(i)*chunk%v42(2, i) - mid%br(i)*chunk%v31(2, i))
      chunk%gx(i) = chunk%hv(1, i) - (grr*mid%hr(i) + grz*mid%hz(i))
      chunk%gy(i) = chunk%hv(2, i) - (gzr*mid%hr(i) + gzz*mid%hz(i))
    end do
  end subroutine form_round_increments

  !> The shape half a step ago.
  pure subroutine form_mid_shape(back, chunk, round, mid)
    real(wp), intent(in) :: back !! half of the step
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(in) :: round
    type(round_shape_t), intent(inout) :: mid
    integer :: i

    !$omp simd
    do i = 1, chunk_size
      mid%ar(i) = round%now%ar(i) - back*chunk%v31(1, i)
      mid%az(i) = round%now%az(i) - back*chunk%v31(2, i)
      mid%br(i) = round%now%br(i) - back*chunk%v42(1, i)
      mid%bz(i) = round%now%bz(i) - back*chunk%v42(2, i)
      mid%hr(i) = round%now%hr(i) - back*chunk%hv(1, i)
      mid%hz(i) = round%now%hz(i) - back*chunk%hv(2, i)
      mid%s(i) = round%now%s(i) - back*round%vs(i)
    end do
    call form_gradients(mid)
  end subroutine form_mid_shape

  !> Nodal forces f_ra = b_ra s_rr + b_za s_rz + M_a s_tt, f_za = b_ra s_rz + b_za s_zz, and
  !> q gamma_a: the parts of the diagonals, of h, and that of all four nodes.
  pure subroutine form_round_forces(stress, chunk, round)
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: chunk !! `force` and `swing` out
    type(round_chunk_t), intent(inout) :: round   !! `hoop` out
    real(wp) :: rr, zz, rz, tt, wr, wz, gamma_a, gamma_b
    integer :: i

    associate (now => round%now)
      !$omp simd private(rr, zz, rz, tt, wr, wz, gamma_a, gamma_b)
      do i = 1, chunk_size
        rr = stress%sxx(i) + chunk%pressure(i)
        zz = stress%syy(i) + chunk%pressure(i)
        rz = stress%sxy(i)
        tt = chunk%pressure(i) - (stress%sxx(i) + stress%syy(i))
        wr = 0.5_wp/now%area(i)
        wz = now%hz(i)*wr
        wr = now%hr(i)*wr
        gamma_a = wz*now%br(i) - wr*now%bz(i)
        gamma_b = wr*now%az(i) - wz*now%ar(i)
        chunk%force(1, i) = now%rad_a(i)*rr + now%axi_a(i)*rz + now%mean_a(i)*tt &
          + gamma_a*chunk%qx(i)
        chunk%force(2, i) = now%rad_a(i)*rz + now%axi_a(i)*zz + gamma_a*chunk%qy(i)
        chunk%force(3, i) = now%rad_b(i)*rr + now%axi_b(i)*rz + now%mean_b(i)*tt &
          + gamma_b*chunk%qx(i)
        chunk%force(4, i) = now%rad_b(i)*rz + now%axi_b(i)*zz + gamma_b*chunk%qy(i)
        chunk%swing(1, i) = now%rad_h(i)*rr + now%axi_h(i)*rz + chunk%qx(i)
        chunk%swing(2, i) = now%rad_h(i)*rz + now%axi_h(i)*zz + chunk%qy(i)
        round%hoop(i) = now%mean_s(i)*tt
      end do
    end associate
  end subroutine form_round_forces

end module round_kinematics_m
