! SPDX-License-Identifier: MIT
!> Kinematics and forces of the one-point quad, plane or round (gradients averaged over its volume:
!> doc/theory/elements.md, "Axisymmetric bodies").
!> With B_x3 = y42/2, B_y3 = -x42/2, B_x4 = -y31/2, B_y4 = x31/2 (and opposite signs at nodes 1 and
!> 2): A = (x31 y42 - x42 y31)/2, L_ix = (v31 y42 - v42 y31)/(2A), L_iy = (x31 v42 - x42 v31)/(2A).
!> In axisymmetric bodies, a = d31 and b = d42, the volume per radian is (in these patterns)
!>   V = s A/4 + (h_r (a_r b_z + b_r a_z) - 2 a_r b_r h_z)/24.
module quad_kinematics_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use element_chunk_m, only : element_chunk_t, reference_inverse, reference_sum
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: form_shape, form_present_shape, form_axisym_shape, form_increments, &
    form_plane_increments, form_axisym_increments, form_forces, form_axisym_forces, &
    add_pressure_forces, inverse_start, form_gradient, form_rubber_forces

  real(wp), parameter :: part = 1.0_wp/24.0_wp, eighth = 0.125_wp

contains

  !> Present shape of a chunk.
  pure subroutine form_shape(reference, stride, chunk)
    integer, intent(in) :: stride                 !! length of one stream
    real(wp), intent(in) :: reference(stride, *)  !! first slot of this chunk
    type(element_chunk_t), intent(inout) :: chunk

    if (chunk%is_axisymmetric) then
      call form_axisym_shape(reference, stride, chunk)
    else
      call form_present_shape(reference, stride, chunk)
    end if
  end subroutine form_shape

  !> Strain increments, spin and hourglass velocity of the step, in the mid-step geometry.
  pure subroutine form_increments(dt, chunk, stress)
    real(wp), intent(in) :: dt                      !! step to the present instant
    type(element_chunk_t), intent(inout) :: chunk
    type(stress_chunk_t), intent(inout) :: stress   !! increments and rotation out

    if (chunk%is_axisymmetric) then
      call form_axisym_increments(dt, chunk, stress)
    else
      call form_plane_increments(dt, chunk, stress)
    end if
  end subroutine form_increments

  !> 1/V0 of the elements: of the area or of the volume.
  pure function inverse_start(chunk) result(inverse)
    type(element_chunk_t), intent(in) :: chunk
    real(wp) :: inverse(chunk_size)

    if (chunk%is_axisymmetric) then
      inverse = (1.0_wp + chunk%stretch)*chunk%inverse_volume
    else
      inverse = (1.0_wp + chunk%stretch)*chunk%inverse_area
    end if
  end function inverse_start

  !> Present diagonals, area and volume ratio of plane quads. A - A0 is formed from the
  !> displacement, so that a nearly undeformed element keeps all digits of its strain.
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

  !> Strain increments, spin and hourglass velocity of plane quads, in the mid-step geometry.
  pure subroutine form_plane_increments(dt, chunk, stress)
    real(wp), intent(in) :: dt                      !! step to the present instant
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
      ! Mid-step increments are rotated by half the rotation, into the frame of the rotated stress.
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
  end subroutine form_plane_increments

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

  !> Of axisymmetric quads: present volume and its gradients, V/V0 - 1. V - V0 is formed from the
  !> displacement, so that a nearly undeformed element keeps all digits of its strain. The hourglass
  !> pattern, (b x h)/(2 A) and (h x a)/(2 A) of the diagonals, is -12/A and 12/A times the
  !> gradients M: who needs it takes them.
  pure subroutine form_axisym_shape(reference, stride, chunk)
    integer, intent(in) :: stride                 !! length of one stream
    real(wp), intent(in) :: reference(stride, *)  !! first slot of this chunk, see `element_chunk`
    type(element_chunk_t), intent(inout) :: chunk !! patterns, area and `stretch` out
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
      s = eighth*(reference(i, reference_sum) + chunk%us(i))
      chunk%x31(i) = ar
      chunk%y31(i) = az
      chunk%x42(i) = br
      chunk%y42(i) = bz
      chunk%hx(i) = hr
      chunk%hy(i) = hz
      chunk%radii(i) = s
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
        + chunk%us(i)*area) + (reference(i, 5)*(first_growth + second_growth) &
        + chunk%hu(1, i)*cross) - 2.0_wp*(reference(i, 6)*pair_growth + chunk%hu(2, i)*pair))
      chunk%stretch(i) = growth*reference(i, reference_inverse)
      hr = part*hr
      hz = part*hz
      chunk%rad_a(i) = s*bz - br*hz
      chunk%rad_b(i) = -(s*az + ar*hz)
      chunk%rad_h(i) = part*cross
      chunk%axi_a(i) = br*(hr - s)
      chunk%axi_b(i) = ar*(hr + s)
      chunk%axi_h(i) = -2.0_wp*part*pair
      chunk%mean_a(i) = hr*bz - hz*br
      chunk%mean_b(i) = hr*az - hz*ar
      chunk%mean_s(i) = eighth*area
      volume = s*area + (ar*chunk%mean_a(i) + br*chunk%mean_b(i))
      chunk%volume(i) = volume
      area = 0.5_wp*area
      chunk%area(i) = area
      ! One division for two.
      both = 1.0_wp/(area*volume)
      chunk%inverse_volume(i) = both*area
      chunk%inverse_area(i) = both*volume
    end do
  end subroutine form_axisym_shape

  !> Strain increments, spin and hourglass velocity of axisymmetric quads, in the mid-step geometry.
  !> The hoop rate is subtracted from both in-plane rates: laws see the same deviator with D_zz = 0.
  pure subroutine form_axisym_increments(dt, chunk, stress)
    real(wp), intent(in) :: dt                    !! step to the present instant
    type(element_chunk_t), intent(inout) :: chunk !! trace, gamma.v and mid-step volume out
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
      s = chunk%radii(i) - eighth*back*chunk%vs(i)
      ! The gradients of `form_axisym_shape`; `area` is twice the area.
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
      ltt = (first + second) + eighth*area*chunk%vs(i)
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
  end subroutine form_axisym_increments

  !> Nodal forces f_ra = b_ra s_rr + b_za s_rz + M_a s_tt, f_za = b_ra s_rz + b_za s_zz, and
  !> q gamma_a: the parts of the diagonals, of h, and that of all four nodes.
  pure subroutine form_axisym_forces(stress, chunk)
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: chunk !! forces out
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
      chunk%force3(1, i) = chunk%rad_a(i)*rr + chunk%axi_a(i)*rz + chunk%mean_a(i)*(tt - qr)
      chunk%force3(2, i) = chunk%rad_a(i)*rz + chunk%axi_a(i)*zz - chunk%mean_a(i)*qz
      chunk%force4(1, i) = chunk%rad_b(i)*rr + chunk%axi_b(i)*rz + chunk%mean_b(i)*(tt + qr)
      chunk%force4(2, i) = chunk%rad_b(i)*rz + chunk%axi_b(i)*zz + chunk%mean_b(i)*qz
      chunk%swing(1, i) = chunk%rad_h(i)*rr + chunk%axi_h(i)*rz + chunk%qx(i)
      chunk%swing(2, i) = chunk%rad_h(i)*rz + chunk%axi_h(i)*zz + chunk%qy(i)
      chunk%hoop(i) = chunk%mean_s(i)*tt
    end do
  end subroutine form_axisym_forces

  !> Add the forces of the pressure shared by the points of an element; their gradients of the
  !> volume are exact.
  pure subroutine add_pressure_forces(chunk)
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: half
    integer :: i

    if (.not. chunk%is_axisymmetric) then
      !$omp simd private(half)
      do i = 1, chunk_size
        half = 0.5_wp*chunk%pressure(i)
        chunk%force3(1, i) = chunk%force3(1, i) + half*chunk%y42(i)
        chunk%force3(2, i) = chunk%force3(2, i) - half*chunk%x42(i)
        chunk%force4(1, i) = chunk%force4(1, i) - half*chunk%y31(i)
        chunk%force4(2, i) = chunk%force4(2, i) + half*chunk%x31(i)
      end do
      return
    end if
    associate (p => chunk%pressure)
      do i = 1, chunk_size
        chunk%force3(1, i) = chunk%force3(1, i) + p(i)*(chunk%rad_a(i) + chunk%mean_a(i))
        chunk%force3(2, i) = chunk%force3(2, i) + p(i)*chunk%axi_a(i)
        chunk%force4(1, i) = chunk%force4(1, i) + p(i)*(chunk%rad_b(i) + chunk%mean_b(i))
        chunk%force4(2, i) = chunk%force4(2, i) + p(i)*chunk%axi_b(i)
        chunk%swing(1, i) = chunk%swing(1, i) + p(i)*chunk%rad_h(i)
        chunk%swing(2, i) = chunk%swing(2, i) + p(i)*chunk%axi_h(i)
        chunk%hoop(i) = chunk%hoop(i) + p(i)*chunk%mean_s(i)
      end do
    end associate
  end subroutine add_pressure_forces

  !> Deformation gradient F - 1 from the displacement and the reference shape, for laws without a
  !> history (doc/theory/elements.md, "Deformation gradient"): at a point, or of a one-point plane
  !> quad, both parallelograms; of an axisymmetric one the mean over the reference volume. In
  !> axisymmetric bodies F_33 is what makes det F the volume ratio of the point. Where the
  !> dilatation is that of the element, F is scaled to it.
  pure subroutine form_gradient(chunk, stress)
    type(element_chunk_t), intent(in) :: chunk
    type(stress_chunk_t), intent(inout) :: stress !! V/V0 - 1 of the element in `stretch`
    real(wp) :: x31, y31, x42, y42, factor, g(6)
    integer :: i

    if (.not. chunk%is_axisymmetric) then
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
    else
      do i = 1, chunk_size
        g = start_gradients(chunk, i)
        factor = chunk%inverse_volume(i)*(1.0_wp + chunk%stretch(i))
        stress%hxx(i) = factor*(g(1)*chunk%u31(1, i) + g(2)*chunk%u42(1, i) + g(3)*chunk%hu(1, i))
        stress%hyx(i) = factor*(g(1)*chunk%u31(2, i) + g(2)*chunk%u42(2, i) + g(3)*chunk%hu(2, i))
        stress%hxy(i) = factor*(g(4)*chunk%u31(1, i) + g(5)*chunk%u42(1, i) + g(6)*chunk%hu(1, i))
        stress%hyy(i) = factor*(g(4)*chunk%u31(2, i) + g(5)*chunk%u42(2, i) + g(6)*chunk%hu(2, i))
      end do
    end if
    call finish_gradient(chunk%stretch, stress)
  end subroutine form_gradient

  !> `rad` and `axi` of the patterns a, b, h at time zero (see `form_axisym_shape`).
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

  !> Out-of-plane component, and scaling to the dilatation of the element.
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

  !> Nodal forces of a one-point axisymmetric quad that are the derivative of W: with F of the plane
  !> the mean over the reference volume and F_33 = J/det F,
  !>   dW V0 = (sigma - s_33 1) : (dF J F^-1) V0 + s_33 dV,
  !> so that gradients of time zero, J F^-T of them, stand where `form_axisym_forces` has present
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

end module quad_kinematics_m
