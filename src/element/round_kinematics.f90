! SPDX-License-Identifier: MIT
!> Kinematics and forces of the one-point round quad with gradients averaged over its volume
!> (doc/theory/elements.md, "Round bodies"). x is the radius r, y the axis z.
module round_kinematics_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use round_chunk_m, only : round_chunk_t, reference_sum
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: form_growth, form_round_increments, form_round_forces

contains

  !> V/V0 - 1 of the present shape. V - V0 is formed from the displacement, so that a nearly
  !> undeformed element keeps all digits of its strain.
  pure subroutine form_growth(reference, stride, chunk, round)
    integer, intent(in) :: stride                !! length of one stream
    real(wp), intent(in) :: reference(stride, *) !! first slot of this chunk, see round_chunk
    type(element_chunk_t), intent(inout) :: chunk !! `stretch` out
    type(round_chunk_t), intent(inout) :: round   !! inverses of area and volume out
    real(wp) :: start, growth, cross, cross_growth, pair, pair_growth, area, area_growth, first, &
      second, all
    integer :: i

    associate (now => round%shape)
      !$omp simd private(start, growth, cross, cross_growth, pair, pair_growth, area, &
      !$omp& area_growth, first, second, all)
      do i = 1, chunk_size
        first = reference(i, 1)*reference(i, 4)
        second = reference(i, 3)*reference(i, 2)
        area = 0.5_wp*(first - second)
        cross = first + second
        first = reference(i, 1)*chunk%u42(2, i) + chunk%u31(1, i)*now%bz(i)
        second = reference(i, 3)*chunk%u31(2, i) + chunk%u42(1, i)*now%az(i)
        area_growth = 0.5_wp*(first - second)
        cross_growth = first + second
        pair = reference(i, 1)*reference(i, 3)
        pair_growth = reference(i, 1)*chunk%u42(1, i) + chunk%u31(1, i)*now%br(i)
        start = 0.25_wp*reference(i, reference_sum)*area + (1.0_wp/24.0_wp)*(reference(i, 5)*cross &
          - 2.0_wp*pair*reference(i, 6))
        growth = 0.25_wp*(reference(i, reference_sum)*area_growth &
          + round%us(1, i)*(area + area_growth)) &
          + (1.0_wp/24.0_wp)*((reference(i, 5)*cross_growth &
          + chunk%hu(1, i)*(cross + cross_growth)) - 2.0_wp*(pair*chunk%hu(2, i) &
          + pair_growth*now%hz(i)))
        ! One division for three.
        all = 1.0_wp/(start*(now%area(i)*now%volume(i)))
        chunk%stretch(i) = growth*(all*(now%area(i)*now%volume(i)))
        round%inverse_area(i) = all*(start*now%volume(i))
        round%inverse_volume(i) = all*(start*now%area(i))
      end do
    end associate
  end subroutine form_growth

  !> Strain increments, spin and hourglass velocity of the step, from the shape half a step ago. The
  !> hoop rate is taken from both rates in the plane: laws see the same deviator, and their D_zz is 0.
  pure subroutine form_round_increments(dt, chunk, round, stress)
    real(wp), intent(in) :: dt                    !! step that led here
    type(element_chunk_t), intent(inout) :: chunk !! trace, gamma.v and mid-step volume out
    type(round_chunk_t), intent(in) :: round      !! `shape` of the middle of the step
    type(stress_chunk_t), intent(inout) :: stress !! increments and rotation out
    real(wp) :: inverse, lrr, lrz, lzr, lzz, ltt, turn, square, all, cosine, sine, mean, half, &
      shear, back, grr, grz, gzr, gzz
    integer :: i

    stress%dt = dt
    stress%has_hoop = .true.
    back = 0.5_wp*dt
    associate (mid => round%shape)
      !$omp simd private(inverse, lrr, lrz, lzr, lzz, ltt, turn, square, all, cosine, sine, mean, &
      !$omp& half, shear, grr, grz, gzr, gzz)
      do i = 1, chunk_size
        chunk%mid_area(i) = mid%volume(i)
        lrr = mid%rad_a(i)*chunk%v31(1, i) + mid%rad_b(i)*chunk%v42(1, i) &
          + mid%rad_h(i)*chunk%hv(1, i)
        lrz = mid%axi_a(i)*chunk%v31(1, i) + mid%axi_b(i)*chunk%v42(1, i) &
          + mid%axi_h(i)*chunk%hv(1, i)
        lzr = mid%rad_a(i)*chunk%v31(2, i) + mid%rad_b(i)*chunk%v42(2, i) &
          + mid%rad_h(i)*chunk%hv(2, i)
        lzz = mid%axi_a(i)*chunk%v31(2, i) + mid%axi_b(i)*chunk%v42(2, i) &
          + mid%axi_h(i)*chunk%hv(2, i)
        ltt = mid%mean_a(i)*chunk%v31(1, i) + mid%mean_b(i)*chunk%v42(1, i) &
          + mid%mean_s(i)*round%vs(1, i)
        ! tan(half the rotation) = turn/V; one division gives 1/V, 1/(V^2 + turn^2) and 1/A.
        turn = 0.5_wp*back*(lzr - lrz)
        square = mid%volume(i)*mid%volume(i) + turn*turn
        all = 1.0_wp/((mid%volume(i)*mid%area(i))*square)
        inverse = all*(square*mid%area(i))
        cosine = (mid%volume(i)*mid%volume(i) - turn*turn)*(all*(mid%volume(i)*mid%area(i)))
        sine = 2.0_wp*mid%volume(i)*turn*(all*(mid%volume(i)*mid%area(i)))
        stress%cosine(i) = cosine
        stress%sine(i) = sine
        stress%cos2(i) = cosine*cosine - sine*sine
        stress%sin2(i) = 2.0_wp*cosine*sine
        ! What hourglass control sees is not linear in the plane.
        grr = 0.5_wp*all*(square*mid%volume(i))
        gzr = grr*(chunk%v31(2, i)*mid%bz(i) - chunk%v42(2, i)*mid%az(i))
        gzz = grr*(mid%ar(i)*chunk%v42(2, i) - mid%br(i)*chunk%v31(2, i))
        grz = grr*(mid%ar(i)*chunk%v42(1, i) - mid%br(i)*chunk%v31(1, i))
        grr = grr*(chunk%v31(1, i)*mid%bz(i) - chunk%v42(1, i)*mid%az(i))
        chunk%gx(i) = chunk%hv(1, i) - (grr*mid%hr(i) + grz*mid%hz(i))
        chunk%gy(i) = chunk%hv(2, i) - (gzr*mid%hr(i) + gzz*mid%hz(i))
        ! Mid-step increments turn by half the rotation to stand beside the rotated stress.
        chunk%trace(i) = inverse*((lrr + lzz) + ltt)
        inverse = back*inverse
        ltt = 2.0_wp*inverse*ltt
        stress%hoop(i) = ltt
        mean = inverse*(lrr + lzz) - ltt
        half = inverse*(lrr - lzz)
        shear = inverse*(lrz + lzr)
        lrr = cosine*half - sine*shear
        stress%dxx(i) = mean + lrr
        stress%dyy(i) = mean - lrr
        stress%dxy(i) = cosine*shear + sine*half
      end do
    end associate
  end subroutine form_round_increments

  !> Nodal forces f_ra = b_ra s_rr + b_za s_rz + M_a s_tt, f_za = b_ra s_rz + b_za s_zz, and
  !> q gamma_a: the parts of the diagonals, of h, and that of all four nodes.
  pure subroutine form_round_forces(stress, chunk, round)
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: chunk !! `force` and `swing` out
    type(round_chunk_t), intent(inout) :: round   !! `hoop` out
    real(wp) :: rr, zz, rz, tt, wr, wz, gamma_a, gamma_b
    integer :: i

    associate (now => round%shape)
      !$omp simd private(rr, zz, rz, tt, wr, wz, gamma_a, gamma_b)
      do i = 1, chunk_size
        rr = stress%sxx(i) + chunk%pressure(i)
        zz = stress%syy(i) + chunk%pressure(i)
        rz = stress%sxy(i)
        tt = chunk%pressure(i) - (stress%sxx(i) + stress%syy(i))
        wr = 0.5_wp*round%inverse_area(i)
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
        round%hoop(1, i) = now%mean_s(i)*tt
        round%hoop(2, i) = 0.0_wp
      end do
    end associate
  end subroutine form_round_forces

end module round_kinematics_m
