! SPDX-License-Identifier: MIT
!> Kinematics and forces of the one-point round quad with gradients averaged over its volume
!> (doc/theory/elements.md, "Round bodies"). x is the radius r, y the axis z.
module round_kinematics_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use round_chunk_m, only : round_chunk_t, reference_inverse, reference_sum
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: form_round_shape, form_round_increments, form_round_forces

  real(wp), parameter :: part = 1.0_wp/24.0_wp, eighth = 0.125_wp

contains

  !> Present volume and its gradients, V/V0 - 1. V - V0 is formed from the displacement, so that a
  !> nearly undeformed element keeps all digits of its strain. The hourglass pattern, (b x h)/(2 A)
  !> and (h x a)/(2 A) of the diagonals, is -12/A and 12/A times the gradients M: who needs it takes
  !> them.
  pure subroutine form_round_shape(reference, stride, chunk, round)
    integer, intent(in) :: stride                 !! length of one stream
    real(wp), intent(in) :: reference(stride, *)  !! first slot of this chunk, see round_chunk
    type(element_chunk_t), intent(inout) :: chunk !! patterns, area and `stretch` out
    type(round_chunk_t), intent(inout) :: round
    real(wp) :: ar, az, br, bz, hr, hz, s, area, volume, growth, first, second, cross, pair, &
      first_growth, second_growth, pair_growth, both
    integer :: i

    !$omp simd private(ar, az, br, bz, hr, hz, s, area, volume, growth, first, second, cross, &
    !$omp& pair, first_growth, second_growth, pair_growth, both)
    do i = 1, chunk_size
      ar = reference(i, 1) + chunk%u31(1, i)
      az = reference(i, 2) + chunk%u31(2, i)
      br = reference(i, 3) + chunk%u42(1, i)
      bz = reference(i, 4) + chunk%u42(2, i)
      hr = reference(i, 5) + chunk%hu(1, i)
      hz = reference(i, 6) + chunk%hu(2, i)
      s = eighth*(reference(i, reference_sum) + round%us(i))
      chunk%x31(i) = ar
      chunk%y31(i) = az
      chunk%x42(i) = br
      chunk%y42(i) = bz
      chunk%hx(i) = hr
      chunk%hy(i) = hz
      round%radii(i) = s
      ! The products a_r b_z, b_r a_z and a_r b_r, and what they have grown by.
      first = ar*bz
      second = br*az
      pair = ar*br
      first_growth = reference(i, 1)*chunk%u42(2, i) + chunk%u31(1, i)*bz
      second_growth = reference(i, 3)*chunk%u31(2, i) + chunk%u42(1, i)*az
      pair_growth = reference(i, 1)*chunk%u42(1, i) + chunk%u31(1, i)*br
      cross = first + second
      area = first - second
      growth = part*(3.0_wp*(reference(i, reference_sum)*(first_growth - second_growth) &
        + round%us(i)*area) + (reference(i, 5)*(first_growth + second_growth) &
        + chunk%hu(1, i)*cross) - 2.0_wp*(reference(i, 6)*pair_growth + chunk%hu(2, i)*pair))
      chunk%stretch(i) = growth*reference(i, reference_inverse)
      hr = part*hr
      hz = part*hz
      round%rad_a(i) = s*bz - br*hz
      round%rad_b(i) = -(s*az + ar*hz)
      round%rad_h(i) = part*cross
      round%axi_a(i) = br*(hr - s)
      round%axi_b(i) = ar*(hr + s)
      round%axi_h(i) = -2.0_wp*part*pair
      round%mean_a(i) = hr*bz - hz*br
      round%mean_b(i) = hr*az - hz*ar
      round%mean_s(i) = eighth*area
      volume = s*area + (ar*round%mean_a(i) + br*round%mean_b(i))
      round%volume(i) = volume
      area = 0.5_wp*area
      chunk%area(i) = area
      ! One division for two.
      both = 1.0_wp/(area*volume)
      round%inverse_volume(i) = both*area
      chunk%inverse_area(i) = both*volume
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
      half, shear, back, first, second
    integer :: i

    stress%dt = dt
    stress%has_hoop = .true.
    back = 0.5_wp*dt
    !$omp simd private(ar, az, br, bz, hr, hz, s, area, volume, rad_a, rad_b, rad_h, axi_a, axi_b, &
    !$omp& axi_h, mean_a, mean_b, inverse, lrr, lrz, lzr, lzz, ltt, turn, square, all, cosine, &
    !$omp& sine, mean, half, shear, first, second)
    do i = 1, chunk_size
      ar = chunk%x31(i) - back*chunk%v31(1, i)
      az = chunk%y31(i) - back*chunk%v31(2, i)
      br = chunk%x42(i) - back*chunk%v42(1, i)
      bz = chunk%y42(i) - back*chunk%v42(2, i)
      hr = part*(chunk%hx(i) - back*chunk%hv(1, i))
      hz = part*(chunk%hy(i) - back*chunk%hv(2, i))
      s = round%radii(i) - eighth*back*round%vs(i)
      ! The gradients of `form_round_shape`; `area` is twice the area.
      first = ar*bz
      second = br*az
      area = first - second
      rad_a = s*bz - br*hz
      rad_b = -(s*az + ar*hz)
      rad_h = part*(first + second)
      axi_a = br*(hr - s)
      axi_b = ar*(hr + s)
      axi_h = -2.0_wp*part*(ar*br)
      mean_a = hr*bz - hz*br
      mean_b = hr*az - hz*ar
      volume = s*area + (ar*mean_a + br*mean_b)
      chunk%mid_area(i) = volume
      lrr = rad_a*chunk%v31(1, i) + rad_b*chunk%v42(1, i) + rad_h*chunk%hv(1, i)
      lrz = axi_a*chunk%v31(1, i) + axi_b*chunk%v42(1, i) + axi_h*chunk%hv(1, i)
      lzr = rad_a*chunk%v31(2, i) + rad_b*chunk%v42(2, i) + rad_h*chunk%hv(2, i)
      lzz = axi_a*chunk%v31(2, i) + axi_b*chunk%v42(2, i) + axi_h*chunk%hv(2, i)
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
      ! gamma.v, with the pattern from the gradients M.
      all = 24.0_wp*all*(square*volume)
      first = mean_a*chunk%v31(1, i)
      second = mean_b*chunk%v42(1, i)
      ltt = (first + second) + eighth*area*round%vs(i)
      chunk%gx(i) = chunk%hv(1, i) + all*(second - first)
      chunk%gy(i) = chunk%hv(2, i) + all*(mean_b*chunk%v42(2, i) - mean_a*chunk%v31(2, i))
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
    real(wp) :: rr, zz, rz, tt, qr, qz
    integer :: i

    !$omp simd private(rr, zz, rz, tt, qr, qz)
    do i = 1, chunk_size
      rr = stress%sxx(i) + chunk%pressure(i)
      zz = stress%syy(i) + chunk%pressure(i)
      rz = stress%sxy(i)
      tt = chunk%pressure(i) - (stress%sxx(i) + stress%syy(i))
      qr = 12.0_wp*chunk%inverse_area(i)*chunk%qx(i)
      qz = 12.0_wp*chunk%inverse_area(i)*chunk%qy(i)
      round%force(1, i) = round%rad_a(i)*rr + round%axi_a(i)*rz + round%mean_a(i)*(tt - qr)
      round%force(2, i) = round%rad_a(i)*rz + round%axi_a(i)*zz - round%mean_a(i)*qz
      round%force(3, i) = round%rad_b(i)*rr + round%axi_b(i)*rz + round%mean_b(i)*(tt + qr)
      round%force(4, i) = round%rad_b(i)*rz + round%axi_b(i)*zz + round%mean_b(i)*qz
      round%swing(1, i) = round%rad_h(i)*rr + round%axi_h(i)*rz + chunk%qx(i)
      round%swing(2, i) = round%rad_h(i)*rz + round%axi_h(i)*zz + chunk%qy(i)
      round%hoop(i) = round%mean_s(i)*tt
    end do
  end subroutine form_round_forces

end module round_kinematics_m
