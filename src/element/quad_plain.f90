! SPDX-License-Identifier: MIT
!> Fast path for the frequent one-point quad (`quad`) in three loops: an elastic material, or J2
!> plasticity without back stress, with viscous hourglass control and nothing else. The equations
!> are those of `quad_kinematics`, `material_j2`, `volumetric`, `hourglass` and `stable_step`; it
!> saves a tenth of the instructions of a run (doc/theory/elements.md). A single loop is too long
!> for a processor to overlap divisions and roots of consecutive elements: on x86-64-v3 it takes a
!> sixth fewer instructions and a quarter more time.
module quad_plain_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use controls_m, only : length_by_diagonal
  use element_chunk_m, only : element_chunk_t, gather_motion
  use layout_m, only : chunk_size
  use material_dispatch_m, only : is_elastic, returns_radially
  use model_m, only : model_t
  use parts_m, only : material_t, part_t, hourglass_viscous
  use quad_kinematics_m, only : form_present_shape
  use stable_step_m, only : harmless_coefficient
  use volumetric_m, only : atanh_series, log_ratio, largest_size
  implicit none
  private
  public :: is_plain, advance_plain

  !> Differences of the nodal motion u_x, u_y, v_x, v_y; h: node 1 - node 2 + node 3 - node 4.
  type :: diagonals_t
    real(wp), dimension(4, chunk_size) :: d31, d42, h
  end type diagonals_t

  !> Values passed from loop to loop.
  type :: shape_t
    real(wp), dimension(chunk_size) :: x31, y31, x42, y42, hx, hy !! present diagonals, h.x
    real(wp), dimension(chunk_size) :: a2, of_a2      !! 2A and 1/2A now
    real(wp), dimension(chunk_size) :: m2             !! 2A half a step ago
    real(wp), dimension(chunk_size) :: z              !! (A - A0)/(A + A0), ln(A/A0) = 2 atanh(z)
    real(wp), dimension(chunk_size) :: gx, gy         !! hourglass velocity gamma.v
    real(wp), dimension(chunk_size) :: cosine, sine   !! of the rotation of the step
    real(wp), dimension(chunk_size) :: mean, half, shear !! strain increments (xx + yy)/2,
                                                         !! (xx - yy)/2 and xy in the mid-step frame
  end type shape_t

  !> Results of the chunk.
  type :: found_t
    real(wp) :: power          !! of the hourglass forces of both ends of the step
    real(wp) :: longest        !! largest (longest side/A)^2
    real(wp) :: least, largest !! z
  end type found_t

contains

  !> Whether a part needs nothing beyond `advance_plain`.
  pure function is_plain(model, part, material, elements) result(yes)
    type(model_t), intent(in) :: model
    type(part_t), intent(in) :: part
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    logical :: yes

    associate (hourglass => part%hourglass)
      yes = (is_elastic(material) .or. returns_radially(material)) .and. &
        .not. model%is_axisymmetric .and. hourglass%form == hourglass_viscous &
        .and. .not. hourglass%coefficient > harmless_coefficient &
        .and. .not. (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) &
        .and. .not. (allocated(elements%retardation) .or. allocated(elements%erosion) &
        .or. allocated(elements%start_dilatation)) &
        .and. model%controls%length_rule /= length_by_diagonal
    end associate
  end function is_plain

  !> Advance one chunk as `advance_one_point`.
  pure subroutine advance_plain(i_chunk, nodes, motion, material, coefficient, dt, elements, chunk)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: coefficient               !! Q_h
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk     !! forces out
    type(diagonals_t) :: diagonals
    type(shape_t) :: shape
    type(found_t) :: found
    real(wp) :: work
    integer :: first, n_slot

    first = (i_chunk - 1)*chunk_size + 1
    n_slot = size(elements%reference, 1)
    call gather_diagonals(nodes, motion, diagonals)
    call form_shape(dt, n_slot, elements%reference(first, 1), diagonals, shape)
    if (is_elastic(material)) then
      call strain_elastic(material%shear, shape, n_slot, elements%deviator(first, 1), work)
    else
      call strain_plastic(material, shape, n_slot, elements%deviator(first, 1), &
        elements%history(elements%history_start(i_chunk)), work)
    end if
    elements%deviatoric_work(i_chunk) = elements%deviatoric_work(i_chunk) + work
    call form_plain_forces(material%bulk, 0.25_wp*coefficient*material%density &
      *material%sound_speed, shape, n_slot, elements%deviator(first, 1), &
      elements%hourglass_strain(elements%hourglass_start(i_chunk)), chunk, found)
    elements%hourglass_work(i_chunk) = elements%hourglass_work(i_chunk) + 0.5_wp*dt*found%power
    ! Below 2 % of volume change nothing limits the step.
    elements%volume_change(i_chunk) = 0.0_wp
    if (found%least < -0.01_wp .or. found%largest > 0.01_wp) &
      elements%volume_change(i_chunk) = 2.0_wp*largest_size(shape%mean)
    elements%time_limit(i_chunk) = 1.0_wp/(material%sound_speed*sqrt(found%longest))
    elements%volume_limit(i_chunk) = (1.0_wp + found%least)/(1.0_wp - found%least)
    if (found%least >= -0.1_wp .and. found%largest <= 0.1_wp) return
    call gather_motion(.false., nodes, motion, chunk)
    call correct_pressure(material%bulk, n_slot, elements%reference(first, 1), chunk)
    elements%volume_limit(i_chunk) = 1.0_wp + minval(chunk%stretch)
  end subroutine advance_plain

  !> Differences of the nodal motion as in `gather_motion`, by vectors of four.
  pure subroutine gather_diagonals(nodes, motion, diagonals)
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: motion(4, *)
    type(diagonals_t), intent(out) :: diagonals
    integer :: i, k, n(4)

    !GCC$ NOVECTOR
    do i = 1, chunk_size
      n = nodes(:, i)
      !$omp simd simdlen(4)
      do k = 1, 4
        diagonals%d31(k, i) = motion(k, n(3)) - motion(k, n(1))
        diagonals%d42(k, i) = motion(k, n(4)) - motion(k, n(2))
        diagonals%h(k, i) = (motion(k, n(1)) - motion(k, n(2))) &
          + (motion(k, n(3)) - motion(k, n(4)))
      end do
    end do
  end subroutine gather_diagonals

  !> Present and mid-step shape, strain increments, rotation and hourglass velocity. Areas stand
  !> twice: a2 = 2A now, s2 at time zero, m2 half a step ago.
  pure subroutine form_shape(dt, n_slot, reference, diagonals, shape)
    real(wp), intent(in) :: dt                      !! step to the present instant
    integer, intent(in) :: n_slot
    real(wp), intent(in) :: reference(n_slot, *)
    type(diagonals_t), intent(in) :: diagonals
    type(shape_t), intent(inout) :: shape           !! set here
    real(wp) :: back, x31, y31, x42, y42, s2, growth, a2, u31, v31, u42, v42, x, y, xx, yy, m2, &
      nxx, nxy, nyx, nyy, turn, square, p, q, r, all, lxx, lxy, lyx, lyy, hx, hy, sine
    integer :: i

    back = 0.5_wp*dt
    !$omp simd private(x31, y31, x42, y42, s2, growth, a2, u31, v31, u42, v42, x, y, xx, yy, m2, &
    !$omp& nxx, nxy, nyx, nyy, turn, square, p, q, r, all, lxx, lxy, lyx, lyy, hx, hy, sine)
    do i = 1, chunk_size
      ! A - A0 from the displacement, so that small strains keep their digits.
      x31 = reference(i, 1) + diagonals%d31(1, i)
      y31 = reference(i, 2) + diagonals%d31(2, i)
      x42 = reference(i, 3) + diagonals%d42(1, i)
      y42 = reference(i, 4) + diagonals%d42(2, i)
      s2 = reference(i, 1)*reference(i, 4) - reference(i, 3)*reference(i, 2)
      growth = (reference(i, 1)*diagonals%d42(2, i) + diagonals%d31(1, i)*y42) &
        - (reference(i, 3)*diagonals%d31(2, i) + diagonals%d42(1, i)*y31)
      a2 = s2 + growth
      ! Mid-step shape, and 2A L of the velocity gradient L in it; turn/2A = tan(half the rotation).
      u31 = diagonals%d31(3, i)
      v31 = diagonals%d31(4, i)
      u42 = diagonals%d42(3, i)
      v42 = diagonals%d42(4, i)
      x = x31 - back*u31
      y = y31 - back*v31
      xx = x42 - back*u42
      yy = y42 - back*v42
      m2 = x*yy - xx*y
      nxx = u31*yy - u42*y
      nxy = x*u42 - xx*u31
      nyx = v31*yy - v42*y
      nyy = x*v42 - xx*v31
      turn = (0.5_wp*back)*(nyx - nxy)
      square = m2*m2 + turn*turn
      ! One division for 1/a2, z, 1/m2 and 1/square: divisions take longest.
      p = s2*a2
      q = m2*square
      r = s2 + a2
      all = 1.0_wp/(p*q*r)
      shape%z(i) = growth*(all*(p*q))
      all = all*r
      shape%of_a2(i) = all*(q*s2)
      all = all*p
      sine = (turn + turn)*(all*m2)
      shape%cosine(i) = 1.0_wp - sine*turn
      shape%sine(i) = sine*m2
      all = all*square
      lxx = all*nxx
      lxy = all*nxy
      lyx = all*nyx
      lyy = all*nyy
      shape%mean(i) = back*(lxx + lyy)
      shape%half(i) = back*(lxx - lyy)
      shape%shear(i) = back*(lxy + lyx)
      hx = reference(i, 5) + diagonals%h(1, i)
      hy = reference(i, 6) + diagonals%h(2, i)
      x = hx - back*diagonals%h(3, i)
      y = hy - back*diagonals%h(4, i)
      shape%gx(i) = diagonals%h(3, i) - (lxx*x + lxy*y)
      shape%gy(i) = diagonals%h(4, i) - (lyx*x + lyy*y)
      shape%x31(i) = x31
      shape%y31(i) = y31
      shape%x42(i) = x42
      shape%y42(i) = y42
      shape%hx(i) = hx
      shape%hy(i) = hy
      shape%a2(i) = a2
      shape%m2(i) = m2
    end do
  end subroutine form_shape

  !> Deviator of elastic elements, as mean (s_xx + s_yy)/2, half (s_xx - s_yy)/2 and shear s_xy,
  !> updated in the mid-step frame: half of the rotation before, half after the strain increment.
  pure subroutine strain_elastic(modulus, shape, n_slot, deviator, work)
    real(wp), intent(in) :: modulus               !! G
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: n_slot
    real(wp), intent(inout) :: deviator(n_slot, *)
    real(wp), intent(out) :: work                 !! of the deviator in the step
    real(wp) :: mean, half, shear, old, density
    integer :: i

    work = 0.0_wp
    !$omp simd private(mean, half, shear, old, density) reduction(+ : work)
    do i = 1, chunk_size
      mean = 0.5_wp*(deviator(i, 1) + deviator(i, 2))
      old = deviator(i, 1) - mean
      half = shape%cosine(i)*old - shape%sine(i)*deviator(i, 3)
      shear = shape%cosine(i)*deviator(i, 3) + shape%sine(i)*old
      density = mean*shape%mean(i) + half*shape%half(i) + shear*shape%shear(i)
      mean = mean + (2.0_wp/3.0_wp)*modulus*shape%mean(i)
      half = half + 2.0_wp*modulus*shape%half(i)
      shear = shear + 2.0_wp*modulus*shape%shear(i)
      density = density + mean*shape%mean(i) + half*shape%half(i) + shear*shape%shear(i)
      work = work + shape%m2(i)*density
      old = half
      half = shape%cosine(i)*old - shape%sine(i)*shear
      deviator(i, 1) = mean + half
      deviator(i, 2) = mean - half
      deviator(i, 3) = shape%cosine(i)*shear + shape%sine(i)*old
    end do
    work = 0.5_wp*work
  end subroutine strain_elastic

  !> Deviator with radial return: see `update_j2_isotropic`.
  pure subroutine strain_plastic(material, shape, n_slot, deviator, plastic_strain, work)
    type(material_t), intent(in) :: material
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: n_slot
    real(wp), intent(inout) :: deviator(n_slot, *)
    real(wp), intent(inout) :: plastic_strain(chunk_size)
    real(wp), intent(out) :: work
    real(wp) :: modulus, yield, hardening, inverse, mean, half, shear, old, density, mises, &
      growth, factor
    integer :: i

    modulus = material%shear
    yield = material%yield
    hardening = material%hardening
    inverse = 1.0_wp/(3.0_wp*modulus + hardening)
    work = 0.0_wp
    !$omp simd private(mean, half, shear, old, density, mises, growth, factor) reduction(+ : work)
    do i = 1, chunk_size
      mean = 0.5_wp*(deviator(i, 1) + deviator(i, 2))
      old = deviator(i, 1) - mean
      half = shape%cosine(i)*old - shape%sine(i)*deviator(i, 3)
      shear = shape%cosine(i)*deviator(i, 3) + shape%sine(i)*old
      density = mean*shape%mean(i) + half*shape%half(i) + shear*shape%shear(i)
      mean = mean + (2.0_wp/3.0_wp)*modulus*shape%mean(i)
      half = half + 2.0_wp*modulus*shape%half(i)
      shear = shear + 2.0_wp*modulus*shape%shear(i)
      mises = sqrt(3.0_wp*(3.0_wp*mean*mean + half*half + shear*shear))
      growth = max(0.0_wp, mises - yield - hardening*plastic_strain(i))*inverse
      factor = 1.0_wp - 3.0_wp*modulus*growth/max(mises, tiny(1.0_wp))
      plastic_strain(i) = plastic_strain(i) + growth
      mean = factor*mean
      half = factor*half
      shear = factor*shear
      density = density + mean*shape%mean(i) + half*shape%half(i) + shear*shape%shear(i)
      work = work + shape%m2(i)*density
      old = half
      half = shape%cosine(i)*old - shape%sine(i)*shear
      deviator(i, 1) = mean + half
      deviator(i, 2) = mean - half
      deviator(i, 3) = shape%cosine(i)*shear + shape%sine(i)*old
    end do
    work = 0.5_wp*work
  end subroutine strain_plastic

  !> Pressure K ln(J), viscous hourglass forces q = (Q_h rho c sqrt(A)/4) gamma.v, and nodal forces
  !> sigma B_a + q gamma_a (see `form_forces`); limits of the chunk.
  pure subroutine form_plain_forces(bulk, viscosity, shape, n_slot, deviator, last, chunk, found)
    real(wp), intent(in) :: bulk
    real(wp), intent(in) :: viscosity                !! Q_h rho c/4
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: n_slot
    real(wp), intent(in) :: deviator(n_slot, *)
    real(wp), intent(inout) :: last(chunk_size, 2)   !! q of the previous step in, of this one out
    type(element_chunk_t), intent(inout) :: chunk    !! `force3`, `force4` and `swing` out
    type(found_t), intent(out) :: found
    real(wp) :: z, w, pressure, root, qx, qy, wx, wy, txx, txy, tyx, tyy, ax, ay, bx, by, power, &
      longest, least, largest
    integer :: i

    power = 0.0_wp
    longest = 0.0_wp
    least = huge(1.0_wp)
    largest = -huge(1.0_wp)
    !$omp simd private(z, w, pressure, root, qx, qy, wx, wy, txx, txy, tyx, tyy, ax, ay, bx, by) &
    !$omp& reduction(+ : power) reduction(max : longest, largest) reduction(min : least)
    do i = 1, chunk_size
      z = shape%z(i)
      w = z*z
      ! Half the pressure: bulk*atanh(z).
      pressure = bulk*(z + z*w*(1.0_wp/3.0_wp + w*(1.0_wp/5.0_wp + w*(1.0_wp/7.0_wp &
        + w*(1.0_wp/9.0_wp + w*(1.0_wp/11.0_wp + w*(1.0_wp/13.0_wp + w*(1.0_wp/15.0_wp))))))))
      root = viscosity*sqrt(0.5_wp*abs(shape%a2(i)))
      qx = root*shape%gx(i)
      qy = root*shape%gy(i)
      power = power + ((last(i, 1) + qx)*shape%gx(i) + (last(i, 2) + qy)*shape%gy(i))
      last(i, 1) = qx
      last(i, 2) = qy
      wx = shape%hx(i)*shape%of_a2(i)
      wy = shape%hy(i)*shape%of_a2(i)
      txx = (pressure + 0.5_wp*deviator(i, 1)) - qx*wx
      txy = 0.5_wp*deviator(i, 3) - qx*wy
      tyx = 0.5_wp*deviator(i, 3) - qy*wx
      tyy = (pressure + 0.5_wp*deviator(i, 2)) - qy*wy
      chunk%force3(1, i) = txx*shape%y42(i) - txy*shape%x42(i)
      chunk%force3(2, i) = tyx*shape%y42(i) - tyy*shape%x42(i)
      chunk%force4(1, i) = txy*shape%x31(i) - txx*shape%y31(i)
      chunk%force4(2, i) = tyy*shape%x31(i) - tyx*shape%y31(i)
      chunk%swing(1, i) = qx
      chunk%swing(2, i) = qy
      ! Sides are (a +- h)/2 and (b +- h)/2; |a +- h|^2 is largest with the sign of a.h.
      ax = shape%x31(i) - shape%x42(i)
      ay = shape%y31(i) - shape%y42(i)
      bx = shape%x31(i) + shape%x42(i)
      by = shape%y31(i) + shape%y42(i)
      longest = max(longest, (shape%of_a2(i)*shape%of_a2(i)) &
        *(shape%hx(i)*shape%hx(i) + shape%hy(i)*shape%hy(i) &
        + max(ax*ax + ay*ay + 2.0_wp*abs(ax*shape%hx(i) + ay*shape%hy(i)), &
        bx*bx + by*by + 2.0_wp*abs(bx*shape%hx(i) + by*shape%hy(i)))))
      least = min(least, z)
      largest = max(largest, z)
    end do
    found = found_t(power, longest, least, largest)
  end subroutine form_plain_forces

  !> Correct the pressure of elements beyond the range of the series for ln(J).
  pure subroutine correct_pressure(bulk, n_slot, reference, chunk)
    real(wp), intent(in) :: bulk
    integer, intent(in) :: n_slot
    real(wp), intent(in) :: reference(n_slot, *)
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: z, missing
    integer :: i

    call form_present_shape(reference, n_slot, chunk)
    do i = 1, chunk_size
      z = chunk%stretch(i)/(2.0_wp + chunk%stretch(i))
      if (abs(z) <= 0.1_wp) cycle
      missing = 0.5_wp*bulk*(log_ratio(chunk%stretch(i)) - 2.0_wp*atanh_series(z))
      chunk%force3(:, i) = chunk%force3(:, i) + missing*[chunk%y42(i), -chunk%x42(i)]
      chunk%force4(:, i) = chunk%force4(:, i) + missing*[-chunk%y31(i), chunk%x31(i)]
    end do
  end subroutine correct_pressure

end module quad_plain_m
