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
  public :: form_round_shape, form_round_increments, form_round_forces

  real(wp), parameter :: part = 1.0_wp/24.0_wp, eighth = 0.125_wp

contains

  !> Present volumes and their gradients, V/V0 - 1, hourglass pattern. V - V0 is formed from the
  !> displacement, so that a nearly undeformed element keeps all digits of its strain.
  pure subroutine form_round_shape(reference, stride, chunk, round)
    integer, intent(in) :: stride                 !! length of one stream
    real(wp), intent(in) :: reference(stride, *)  !! first slot of this chunk, see round_chunk
    type(element_chunk_t), intent(inout) :: chunk !! patterns and `stretch` out
    type(round_chunk_t), intent(inout) :: round
    real(wp) :: ar, az, br, bz, hr, hz, s, area, volume, start, start_area, growth, cross, &
      cross_growth, pair, pair_growth, area_growth, first, second, all
    integer :: i

    !$omp simd private(ar, az, br, bz, hr, hz, s, area, volume, start, start_area, growth, cross, &
    !$omp& cross_growth, pair, pair_growth, area_growth, first, second, all)
    do i = 1, chunk_size
      ar = reference(i, 1) + chunk%u31(1, i)
      az = reference(i, 2) + chunk%u31(2, i)
      br = reference(i, 3) + chunk%u42(1, i)
      bz = reference(i, 4) + chunk%u42(2, i)
      hr = reference(i, 5) + chunk%hu(1, i)
      hz = reference(i, 6) + chunk%hu(2, i)
      s = reference(i, reference_sum) + round%us(i)
      chunk%x31(i) = ar
      chunk%y31(i) = az
      chunk%x42(i) = br
      chunk%y42(i) = bz
      chunk%hx(i) = hr
      chunk%hy(i) = hz
      round%s(i) = s
      s = eighth*s
      first = reference(i, 1)*reference(i, 4)
      second = reference(i, 3)*reference(i, 2)
      start_area = 0.5_wp*(first - second)
      cross = first + second
      first = reference(i, 1)*chunk%u42(2, i) + chunk%u31(1, i)*bz
      second = reference(i, 3)*chunk%u31(2, i) + chunk%u42(1, i)*az
      area_growth = 0.5_wp*(first - second)
      cross_growth = first + second
      pair = reference(i, 1)*reference(i, 3)
      pair_growth = reference(i, 1)*chunk%u42(1, i) + chunk%u31(1, i)*br
      start = 0.25_wp*reference(i, reference_sum)*start_area + part*(reference(i, 5)*cross &
        - 2.0_wp*pair*reference(i, 6))
      area = start_area + area_growth
      growth = 0.25_wp*(reference(i, reference_sum)*area_growth + round%us(i)*area) &
        + part*((reference(i, 5)*cross_growth + chunk%hu(1, i)*(cross + cross_growth)) &
        - 2.0_wp*(pair*chunk%hu(2, i) + pair_growth*hz))
      volume = start + growth
      ! One division for three.
      all = 1.0_wp/(start*(area*volume))
      chunk%stretch(i) = growth*(all*(area*volume))
      round%inverse_volume(i) = all*(start*area)
      all = all*(start*volume)
      round%inverse_area(i) = all
      round%area(i) = area
      round%volume(i) = volume
      round%span(i) = (ar*ar + az*az) + (br*br + bz*bz)
      round%gamma_a(i) = 0.5_wp*all*(hz*br - hr*bz)
      round%gamma_b(i) = 0.5_wp*all*(hr*az - hz*ar)
      hr = part*hr
      hz = part*hz
      round%rad_a(i) = s*bz - br*hz
      round%rad_b(i) = -(s*az + ar*hz)
      round%rad_h(i) = part*(ar*bz + br*az)
      round%axi_a(i) = -br*(s - hr)
      round%axi_b(i) = ar*(s + hr)
      round%axi_h(i) = -2.0_wp*part*ar*br
      round%mean_a(i) = hr*bz - hz*br
      round%mean_b(i) = hr*az - hz*ar
      round%mean_s(i) = 0.25_wp*area
    end do
  end subroutine form_round_shape

  !> Strain increments, spin and hourglass velocity of the step, from the shape half a step ago.
  !> The hoop rate is taken from both rates in the plane: laws see the same deviator, their D_zz
  !> is 0.
  pure subroutine form_round_increments(dt, chunk, round, stress)
    real(wp), intent(in) :: dt                    !! step that led here
    type(element_chunk_t), intent(inout) :: chunk !! trace, gamma.v and mid-step volume out
    type(round_chunk_t), intent(in) :: round
    type(stress_chunk_t), intent(inout) :: stress !! increments and rotation out
    real(wp) :: ar, az, br, bz, hr, hz, s, area, volume, rad_a, rad_b, rad_h, axi_a, axi_b, axi_h, &
      mean_a, mean_b, inverse, lrr, lrz, lzr, lzz, ltt, turn, square, all, cosine, sine, mean, &
      half, shear, back, grr, grz, gzr, gzz
    integer :: i

    stress%dt = dt
    stress%has_hoop = .true.
    back = 0.5_wp*dt
    !$omp simd private(ar, az, br, bz, hr, hz, s, area, volume, rad_a, rad_b, rad_h, axi_a, axi_b, &
    !$omp& axi_h, mean_a, mean_b, inverse, lrr, lrz, lzr, lzz, ltt, turn, square, all, cosine, &
    !$omp& sine, mean, half, shear, grr, grz, gzr, gzz)
    do i = 1, chunk_size
      ar = chunk%x31(i) - back*chunk%v31(1, i)
      az = chunk%y31(i) - back*chunk%v31(2, i)
      br = chunk%x42(i) - back*chunk%v42(1, i)
      bz = chunk%y42(i) - back*chunk%v42(2, i)
      hr = chunk%hx(i) - back*chunk%hv(1, i)
      hz = chunk%hy(i) - back*chunk%hv(2, i)
      s = eighth*(round%s(i) - back*round%vs(i))
      ! The gradients of `form_round_shape`.
      area = 0.5_wp*(ar*bz - br*az)
      rad_a = s*bz - part*br*hz
      rad_b = -(s*az + part*ar*hz)
      rad_h = part*(ar*bz + br*az)
      axi_a = -br*(s - part*hr)
      axi_b = ar*(s + part*hr)
      axi_h = -2.0_wp*part*ar*br
      mean_a = part*(hr*bz - hz*br)
      mean_b = part*(hr*az - hz*ar)
      volume = 2.0_wp*s*area + (ar*mean_a + br*mean_b)
      chunk%mid_area(i) = volume
      lrr = rad_a*chunk%v31(1, i) + rad_b*chunk%v42(1, i) + rad_h*chunk%hv(1, i)
      lrz = axi_a*chunk%v31(1, i) + axi_b*chunk%v42(1, i) + axi_h*chunk%hv(1, i)
      lzr = rad_a*chunk%v31(2, i) + rad_b*chunk%v42(2, i) + rad_h*chunk%hv(2, i)
      lzz = axi_a*chunk%v31(2, i) + axi_b*chunk%v42(2, i) + axi_h*chunk%hv(2, i)
      ltt = mean_a*chunk%v31(1, i) + mean_b*chunk%v42(1, i) + 0.25_wp*area*round%vs(i)
      ! tan(half the rotation) = turn/V; one division gives 1/V, 1/(V^2 + turn^2) and 1/A.
      turn = 0.5_wp*back*(lzr - lrz)
      square = volume*volume + turn*turn
      all = 1.0_wp/((volume*area)*square)
      inverse = all*(square*area)
      cosine = (volume*volume - turn*turn)*(all*(volume*area))
      sine = 2.0_wp*volume*turn*(all*(volume*area))
      stress%cosine(i) = cosine
      stress%sine(i) = sine
      stress%cos2(i) = cosine*cosine - sine*sine
      stress%sin2(i) = 2.0_wp*cosine*sine
      ! What hourglass control sees is not linear in the plane.
      grr = 0.5_wp*all*(square*volume)
      gzr = grr*(chunk%v31(2, i)*bz - chunk%v42(2, i)*az)
      gzz = grr*(ar*chunk%v42(2, i) - br*chunk%v31(2, i))
      grz = grr*(ar*chunk%v42(1, i) - br*chunk%v31(1, i))
      grr = grr*(chunk%v31(1, i)*bz - chunk%v42(1, i)*az)
      chunk%gx(i) = chunk%hv(1, i) - (grr*hr + grz*hz)
      chunk%gy(i) = chunk%hv(2, i) - (gzr*hr + gzz*hz)
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
  end subroutine form_round_increments

  !> Nodal forces f_ra = b_ra s_rr + b_za s_rz + M_a s_tt, f_za = b_ra s_rz + b_za s_zz, and
  !> q gamma_a: the parts of the diagonals, of h, and that of all four nodes.
  pure subroutine form_round_forces(stress, chunk, round)
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(inout) :: round   !! forces out
    real(wp) :: rr, zz, rz, tt
    integer :: i

    !$omp simd private(rr, zz, rz, tt)
    do i = 1, chunk_size
      rr = stress%sxx(i) + chunk%pressure(i)
      zz = stress%syy(i) + chunk%pressure(i)
      rz = stress%sxy(i)
      tt = chunk%pressure(i) - (stress%sxx(i) + stress%syy(i))
      round%force(1, i) = round%rad_a(i)*rr + round%axi_a(i)*rz + round%mean_a(i)*tt &
        + round%gamma_a(i)*chunk%qx(i)
      round%force(2, i) = round%rad_a(i)*rz + round%axi_a(i)*zz + round%gamma_a(i)*chunk%qy(i)
      round%force(3, i) = round%rad_b(i)*rr + round%axi_b(i)*rz + round%mean_b(i)*tt &
        + round%gamma_b(i)*chunk%qx(i)
      round%force(4, i) = round%rad_b(i)*rz + round%axi_b(i)*zz + round%gamma_b(i)*chunk%qy(i)
      round%swing(1, i) = round%rad_h(i)*rr + round%axi_h(i)*rz + chunk%qx(i)
      round%swing(2, i) = round%rad_h(i)*rz + round%axi_h(i)*zz + chunk%qy(i)
      round%hoop(1, i) = round%mean_s(i)*tt
      round%hoop(2, i) = 0.0_wp
    end do
  end subroutine form_round_forces

end module round_kinematics_m
