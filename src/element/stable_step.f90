! SPDX-License-Identifier: MIT
!> Stable step of a chunk of elements of any form (doc/theory/elements.md, "Stable step").
!> One-point plane quads: L/c with L = area over the longest side or diagonal (ISDO of
!> *CONTROL_TIMESTEP), and L/(Q + sqrt(Q^2 + c^2)), Q = Q2 c + Q1 L |t|, in compression under bulk
!> viscosity; never above the step that hourglass control allows. All others: a lower bound of
!> 2/omega_max of the single element with its masses, and so of every mesh of them.
module stable_step_m
  use controls_m, only : length_by_diagonal
  use element_chunk_m, only : element_chunk_t
  use hourglass_m, only : largest_spread
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_dispatch_m, only : has_mean_dilatation
  use parts_m, only : hourglass_t, material_t, hourglass_viscous, hourglass_assumed
  use quad_points_m, only : step_sums_t
  implicit none
  private
  public :: moduli_t, moduli_of, stable_step, axisymmetric_step, full_step, &
    axisymmetric_full_step, harmless_coefficient

  !> Coefficient up to which hourglass control never asks for less than L/c in a convex quad of its
  !> initial area (doc/theory/elements.md).
  real(wp), parameter :: harmless_coefficient = 0.25_wp

  !> Material data of stable steps, of the present state.
  type :: moduli_t
    real(wp) :: density             !! of the undeformed body, kg/m^3
    real(wp) :: bulk, shear         !! K and G
    real(wp) :: sound_speed
    logical :: has_mean_dilatation
  end type moduli_t

  !> One-point axisymmetric quads, divided by the masses: bounds of omega^2 of strain and of its
  !> volumetric part (over lambda); gamma.gamma of hourglass control, and its squared coupling to
  !> strain, both times the resistance.
  type :: axisymmetric_sums_t
    real(wp), dimension(chunk_size) :: strain, dilation, pattern, coupling
  end type axisymmetric_sums_t

contains

  !> Moduli of the undeformed body.
  pure function moduli_of(material) result(moduli)
    type(material_t), intent(in) :: material
    type(moduli_t) :: moduli

    moduli = moduli_t(material%density, material%bulk, material%shear, material%sound_speed, &
      has_mean_dilatation(material))
  end function moduli_of

  !> Smallest stable step of a chunk of one-point plane quads, and its smallest volume ratio.
  pure subroutine stable_step(length_rule, sound_speed, hourglass, nodes, chunk, limit, volume, &
      single)
    integer, intent(in) :: length_rule
    real(wp), intent(in) :: sound_speed
    type(hourglass_t), intent(in) :: hourglass  !! bulk viscosity too
    integer, intent(in) :: nodes(4, chunk_size) !! a triangle repeats its third
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: limit             !! s
    real(wp), intent(out) :: volume            !! smallest A/A0
    real(wp), intent(out), optional :: single(chunk_size) !! steps of the elements
    real(wp) :: squared(chunk_size), largest
    integer :: i

    if (length_rule == length_by_diagonal) then
      !$omp simd
      do i = 1, chunk_size
        squared(i) = max(chunk%x31(i)**2 + chunk%y31(i)**2, chunk%x42(i)**2 + chunk%y42(i)**2)
      end do
    else
      call longest_sides(chunk, squared)
    end if
    largest = 0.0_wp
    volume = huge(1.0_wp)
    !$omp simd reduction(max : largest) reduction(min : volume)
    do i = 1, chunk_size
      squared(i) = squared(i)*(chunk%inverse_area(i)*chunk%inverse_area(i))
      largest = max(largest, squared(i))
      volume = min(volume, 1.0_wp + chunk%stretch(i))
    end do
    limit = 1.0_wp/(sound_speed*sqrt(largest))
    if (present(single)) single = 1.0_wp/(sound_speed*sqrt(squared))
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) then
      squared = viscous_limit(1.0_wp/sqrt(squared), sound_speed, hourglass%quadratic, &
        hourglass%linear, chunk%trace)
      limit = minval(squared)
      if (present(single)) single = squared
    end if
    if (.not. hourglass%coefficient > harmless_coefficient) return
    squared = hourglass_steps(hourglass, sound_speed, nodes, chunk)
    limit = min(limit, minval(squared))
    if (present(single)) single = min(single, squared)
  end subroutine stable_step

  !> Stable step of one element with bulk viscosity.
  pure elemental function viscous_limit(length, sound_speed, quadratic, linear, trace) result(limit)
    real(wp), intent(in) :: length, sound_speed, quadratic, linear, trace
    real(wp) :: limit
    real(wp) :: q

    q = 0.0_wp
    if (trace < 0.0_wp) q = linear*sound_speed - quadratic*length*trace
    limit = length/(q + sqrt(q*q + sound_speed*sound_speed))
  end function viscous_limit

  !> Square of the longest side: with d = d31 -+ d42, opposite sides are (d +- h)/2.
  pure subroutine longest_sides(chunk, squared)
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: squared(chunk_size)
    real(wp) :: ax, ay, bx, by, hx, hy
    integer :: i

    !$omp simd private(ax, ay, bx, by, hx, hy)
    do i = 1, chunk_size
      ax = 0.5_wp*(chunk%x31(i) - chunk%x42(i))
      ay = 0.5_wp*(chunk%y31(i) - chunk%y42(i))
      bx = 0.5_wp*(chunk%x31(i) + chunk%x42(i))
      by = 0.5_wp*(chunk%y31(i) + chunk%y42(i))
      hx = 0.5_wp*chunk%hx(i)
      hy = 0.5_wp*chunk%hy(i)
      ! |a +- h|^2 is largest with the sign of a.h.
      squared(i) = hx*hx + hy*hy + max(ax*ax + ay*ay + 2.0_wp*abs(ax*hx + ay*hy), &
        bx*bx + by*by + 2.0_wp*abs(bx*hx + by*hy))
    end do
  end subroutine longest_sides

  !> Steps that hourglass control of the elements allows. With masses rho A0/4 and
  !> gamma.gamma = 4 + (|d31 x h.x|^2 + |d42 x h.x|^2)/(2 A^2): 2/omega of the stiffness form,
  !> omega^2 = Q_h c^2 (B.B) gamma.gamma/(A A0); 2/rate of the viscous one, whose force is that of
  !> v(n-1/2), rate = Q_h c sqrt(A) gamma.gamma/A0; of assumed strain, with E/(1 - nu^2) <= rho c^2
  !> and the spread S, omega^2 = QM c^2 S gamma.gamma/(6 A A0). A triangle has no hourglass.
  pure function hourglass_steps(hourglass, sound_speed, nodes, chunk) result(steps)
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: sound_speed
    integer, intent(in) :: nodes(4, chunk_size)  !! a triangle repeats its third
    type(element_chunk_t), intent(in) :: chunk
    real(wp) :: steps(chunk_size)                !! s
    real(wp) :: pattern(chunk_size), inverse(chunk_size)
    integer :: i

    do i = 1, chunk_size
      inverse(i) = abs(chunk%inverse_area(i))
      pattern(i) = 4.0_wp + 0.5_wp*inverse(i)**2 &
        *((chunk%x31(i)*chunk%hy(i) - chunk%y31(i)*chunk%hx(i))**2 &
        + (chunk%x42(i)*chunk%hy(i) - chunk%y42(i)*chunk%hx(i))**2)
      pattern(i) = pattern(i)*abs(1.0_wp + chunk%stretch(i))
      if (nodes(4, i) == nodes(3, i)) pattern(i) = 0.0_wp
    end do
    if (hourglass%form == hourglass_viscous) then
      steps = 2.0_wp/max(hourglass%coefficient*sound_speed*(pattern*sqrt(inverse)), tiny(1.0_wp))
      return
    end if
    if (hourglass%form == hourglass_assumed) then
      pattern = pattern*inverse**2*largest_spread(chunk%x31, chunk%y31, chunk%x42, chunk%y42)/6.0_wp
    else
      pattern = 0.5_wp*pattern*inverse**2 &
        *(chunk%x31**2 + chunk%y31**2 + chunk%x42**2 + chunk%y42**2)
    end if
    steps = 2.0_wp/(sound_speed*sqrt(max(hourglass%coefficient*pattern, tiny(1.0_wp))))
  end function hourglass_steps

  !> Smallest stable step of a chunk of one-point axisymmetric quads, with hourglass control and
  !> bulk viscosity. With x = omega^2 dt^2/4 of strain, y of hourglass control and z^2 of the
  !> coupling, the element is stable where (1 - x)(1 - y) >= z^2, and so where y <= 1/2 and x + 2
  !> z^2 <= 1. The volume is negative where an area is.
  pure subroutine axisymmetric_step(material, hourglass, inverse_mass, stride, chunk, limit, &
      volume, single)
    type(moduli_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass      !! bulk viscosity too
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *) !! density over mass, first slot of the chunk; 0
                                                    !! at the fourth node of a triangle
    type(element_chunk_t), intent(inout) :: chunk   !! present shape, resistance to hourglassing;
                                                    !! gradients of triangles are changed
    real(wp), intent(out) :: limit                  !! s
    real(wp), intent(out) :: volume
    real(wp), intent(out), optional :: single(chunk_size) !! steps of the elements, each alone
    type(axisymmetric_sums_t) :: sums
    real(wp) :: largest, pattern, coupled, factor, lame, shear
    integer :: i

    shear = 2.0_wp*material%shear/material%density
    lame = max(0.0_wp, material%bulk/material%density - shear/3.0_wp)
    call join_third_nodes(inverse_mass(1, 4), chunk)
    call form_sums(lame, shear, inverse_mass, stride, chunk, sums)
    largest = 0.0_wp
    pattern = 0.0_wp
    volume = huge(1.0_wp)
    !$omp simd reduction(max : largest, pattern) reduction(min : volume)
    do i = 1, chunk_size
      largest = max(largest, sums%strain(i))
      pattern = max(pattern, sums%pattern(i))
      volume = min(volume, min(1.0_wp + chunk%stretch(i), sign(1.0e3_wp, chunk%area(i))))
    end do
    factor = coupling_factor(hourglass%form, material%density, largest)
    coupled = 0.0_wp
    !$omp simd reduction(max : coupled)
    do i = 1, chunk_size
      coupled = max(coupled, sums%strain(i) + factor*sums%coupling(i))
    end do
    limit = coupled_step(hourglass%form, coupled, pattern/material%density)
    if (present(single)) single = coupled_step(hourglass%form, sums%strain + coupling_factor( &
      hourglass%form, material%density, sums%strain)*sums%coupling, sums%pattern/material%density)
    if (.not. (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp)) return
    call form_viscous_rates(hourglass, material%sound_speed, chunk, sums%dilation, largest)
    limit = limit/(1.0_wp + 0.5_wp*limit*largest)
    if (present(single)) single = single/(1.0_wp + 0.5_wp*single*sums%dilation)
  end subroutine axisymmetric_step

  !> Factor of the squared coupling. Resistances of the viscous form act on velocities, those of the
  !> stiffness form on their sum.
  pure elemental function coupling_factor(form, density, strain) result(factor)
    integer, intent(in) :: form         !! of hourglass control
    real(wp), intent(in) :: density
    real(wp), intent(in) :: strain      !! bound of omega^2 of strain
    real(wp) :: factor

    if (form == hourglass_viscous) then
      factor = 2.0_wp/(density*sqrt(strain))
    else
      factor = 2.0_wp/(density*strain)
    end if
  end function coupling_factor

  !> Stable step of strain with the coupling, and of hourglass control.
  pure elemental function coupled_step(form, coupled, pattern) result(step)
    integer, intent(in) :: form
    real(wp), intent(in) :: coupled, pattern
    real(wp) :: step

    if (form == hourglass_viscous) then
      step = min(2.0_wp/sqrt(coupled), 1.0_wp/max(pattern, tiny(1.0_wp)))
    else
      step = 2.0_wp/sqrt(max(coupled, 2.0_wp*max(pattern, tiny(1.0_wp))))
    end if
  end function coupled_step

  !> Rates of bulk viscosity, which are added: x + y <= theta at a share theta <= 1 of the step
  !> without it. It counts in expansion too: two steps later the fastest mode is in compression.
  pure subroutine form_viscous_rates(viscosity, sound_speed, chunk, dilation, largest)
    type(hourglass_t), intent(in) :: viscosity
    real(wp), intent(in) :: sound_speed
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(inout) :: dilation(chunk_size) !! bound of omega^2 by volume over lambda; then
                                                    !! the rates
    real(wp), intent(out) :: largest
    real(wp) :: length
    integer :: i

    largest = 0.0_wp
    !$omp simd private(length) reduction(max : largest)
    do i = 1, chunk_size
      length = sqrt(abs(chunk%area(i)))
      dilation(i) = length/abs(1.0_wp + chunk%stretch(i))*(viscosity%linear*sound_speed &
        + viscosity%quadratic*length*abs(chunk%trace(i)))*dilation(i)
      largest = max(largest, dilation(i))
    end do
  end subroutine form_viscous_rates

  !> Merge the fourth node of triangles into the third, in gradients and patterns; triangles have no
  !> hourglass mode.
  pure subroutine join_third_nodes(inverse_mass, chunk)
    real(wp), intent(in) :: inverse_mass(chunk_size) !! of the fourth nodes
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: r, z, m, least
    integer :: i

    least = huge(1.0_wp)
    !$omp simd reduction(min : least)
    do i = 1, chunk_size
      least = min(least, inverse_mass(i))
    end do
    if (least > 0.0_wp) return
    do i = 1, chunk_size
      if (inverse_mass(i) > 0.0_wp) cycle
      r = 0.5_wp*(chunk%rad_b(i) - chunk%rad_h(i))
      z = 0.5_wp*(chunk%axi_b(i) - chunk%axi_h(i))
      m = 0.5_wp*(chunk%mean_b(i) + chunk%mean_s(i))
      chunk%rad_a(i) = chunk%rad_a(i) + r
      chunk%rad_b(i) = chunk%rad_b(i) - r
      chunk%rad_h(i) = chunk%rad_h(i) + r
      chunk%axi_a(i) = chunk%axi_a(i) + z
      chunk%axi_b(i) = chunk%axi_b(i) - z
      chunk%axi_h(i) = chunk%axi_h(i) + z
      chunk%mean_a(i) = chunk%mean_a(i) + m
      chunk%mean_b(i) = chunk%mean_b(i) + m
      chunk%mean_s(i) = chunk%mean_s(i) + m
      chunk%resistance(i) = 0.0_wp
    end do
  end subroutine join_third_nodes

  !> Sums over the nodes of axisymmetric quads. With p, q, o, t, u, w the sums of b_r^2, b_z^2, b_r
  !> b_z, M^2, M b_r, M b_z over m V: omega^2 <= 2G Lambda + lambda (p + q + t + 2 u), where Lambda
  !> is the largest row sum (Gershgorin) of the matrix [p o u; o q w; u w t]. In the patterns nodes
  !> 1 and 3 have b = h -+ a, nodes 2 and 4 have -h -+ b (M: s -+ a and s -+ b), so that the sum v
  !> and the difference d of 1/m of two opposite nodes give the weights v a + d h and v h + d a of a
  !> pattern.
  pure subroutine form_sums(lame, shear, inverse_mass, stride, chunk, sums)
    real(wp), intent(in) :: lame, shear            !! lambda/rho and 2G/rho
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *)
    type(element_chunk_t), intent(in) :: chunk
    type(axisymmetric_sums_t), intent(inout) :: sums
    real(wp) :: va, da, vb, db, wa, wb, wha, whb, ga, gb, gr, gz, gm, p, q, o, t, u, w
    integer :: i

    !$omp simd private(va, da, vb, db, wa, wb, wha, whb, ga, gb, gr, gz, gm, p, q, o, t, u, w)
    do i = 1, chunk_size
      va = inverse_mass(i, 3) + inverse_mass(i, 1)
      da = inverse_mass(i, 3) - inverse_mass(i, 1)
      vb = inverse_mass(i, 2) + inverse_mass(i, 4)
      db = inverse_mass(i, 2) - inverse_mass(i, 4)
      ga = -12.0_wp*chunk%inverse_area(i)*chunk%mean_a(i)
      gb = 12.0_wp*chunk%inverse_area(i)*chunk%mean_b(i)
      ! Gradients in r, weighted, and their products with all others.
      wa = va*chunk%rad_a(i) + da*chunk%rad_h(i)
      wb = vb*chunk%rad_b(i) + db*chunk%rad_h(i)
      wha = va*chunk%rad_h(i) + da*chunk%rad_a(i)
      whb = vb*chunk%rad_h(i) + db*chunk%rad_b(i)
      p = chunk%rad_a(i)*wa + chunk%rad_b(i)*wb + chunk%rad_h(i)*(wha + whb)
      o = chunk%axi_a(i)*wa + chunk%axi_b(i)*wb + chunk%axi_h(i)*(wha + whb)
      u = chunk%mean_a(i)*wa + chunk%mean_b(i)*wb + chunk%mean_s(i)*(wha - whb)
      gr = ga*wa + gb*wb + (wha + whb)
      ! In z.
      wa = va*chunk%axi_a(i) + da*chunk%axi_h(i)
      wb = vb*chunk%axi_b(i) + db*chunk%axi_h(i)
      wha = va*chunk%axi_h(i) + da*chunk%axi_a(i)
      whb = vb*chunk%axi_h(i) + db*chunk%axi_b(i)
      q = chunk%axi_a(i)*wa + chunk%axi_b(i)*wb + chunk%axi_h(i)*(wha + whb)
      w = chunk%mean_a(i)*wa + chunk%mean_b(i)*wb + chunk%mean_s(i)*(wha - whb)
      gz = ga*wa + gb*wb + (wha + whb)
      ! The integrals M.
      wa = va*chunk%mean_a(i) + da*chunk%mean_s(i)
      wb = vb*chunk%mean_b(i) - db*chunk%mean_s(i)
      wha = va*chunk%mean_s(i) + da*chunk%mean_a(i)
      whb = vb*chunk%mean_s(i) - db*chunk%mean_b(i)
      t = chunk%mean_a(i)*wa + chunk%mean_b(i)*wb + chunk%mean_s(i)*(wha + whb)
      gm = ga*wa + gb*wb + (wha - whb)
      sums%pattern(i) = chunk%resistance(i)*((ga*(va*ga + da) + gb*(vb*gb + db)) &
        + ((va + da*ga) + (vb + db*gb)))
      sums%coupling(i) = chunk%resistance(i)*chunk%inverse_volume(i)*(shear*(1.5_wp*(gr*gr &
        + gz*gz) + gm*gm) + lame*((gr + gm)**2 + gz*gz))
      sums%dilation(i) = chunk%inverse_volume(i)*((p + q) + (t + 2.0_wp*u))
      t = max(p + (abs(o) + abs(u)), q + (abs(o) + abs(w)), t + (abs(u) + abs(w)))
      sums%strain(i) = chunk%inverse_volume(i)*shear*t + lame*sums%dilation(i)
    end do
  end subroutine form_sums

  !> Smallest step of a chunk of fully integrated plane quads, and its smallest volume ratio at a
  !> point. With the largest modulus C of the plane, v.K v <= C sum_p A_p |grad v|^2, so
  !> omega^2 <= 4 C lambda/(rho A0) with lambda the largest eigenvalue of the scalar matrix
  !> sum_p A_p (grad N)(grad N)^T, and lambda <= (trace of its 16th power)^(1/16). A triangle has
  !> three nodes and one gradient; there lambda <= trace.
  pure subroutine full_step(material, viscosity, nodes, chunk, sums, limit, volume, single)
    type(moduli_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity  !! its Q1 and Q2 count
    integer, intent(in) :: nodes(4, chunk_size) !! a triangle repeats its third
    type(element_chunk_t), intent(in) :: chunk
    type(step_sums_t), intent(in) :: sums
    real(wp), intent(out) :: limit              !! s
    real(wp), intent(out) :: volume             !! smallest J
    real(wp), intent(out), optional :: single(chunk_size) !! steps of the elements
    real(wp) :: squared(chunk_size), step(chunk_size), modulus
    integer :: i

    modulus = 2.0_wp*max(material%bulk + material%shear/3.0_wp, material%shear)
    call squared_frequency(sums%h, squared)
    volume = huge(1.0_wp)
    do i = 1, chunk_size
      if (nodes(4, i) == nodes(3, i)) squared(i) = triangle_part(chunk, i)
    end do
    !$omp simd reduction(min : volume)
    do i = 1, chunk_size
      squared(i) = squared(i)*modulus/material%density &
        *abs(chunk%inverse_area(i)*(1.0_wp + chunk%stretch(i)))
      step(i) = 2.0_wp/sqrt(squared(i))
      volume = min(volume, sums%volume(i))
    end do
    if (viscosity%quadratic > 0.0_wp .or. viscosity%linear > 0.0_wp) &
      step = viscous_step(step, 2.0_wp*material%density/modulus/(1.0_wp + chunk%stretch) &
      *sqrt(abs(chunk%area))*(viscosity%linear*material%sound_speed &
      + viscosity%quadratic*sqrt(abs(chunk%area))*abs(chunk%trace)))
    limit = minval(step)
    if (present(single)) single = step
  end subroutine full_step

  !> Step under viscous pressure: damping of the fastest mode at most zeta = (2 viscosity/C)/step.
  !> It counts in expansion too: two steps later the fastest mode is in compression.
  pure elemental function viscous_step(step, viscosity) result(limit)
    real(wp), intent(in) :: step      !! without viscosity
    real(wp), intent(in) :: viscosity !! 2 q/(|t| C), s
    real(wp) :: limit
    real(wp) :: zeta

    zeta = viscosity/step
    limit = step/(zeta + sqrt(zeta*zeta + 1.0_wp))
  end function viscous_step

  !> 4 lambda of quads: with orthonormal patterns d31/sqrt(2), d42/sqrt(2), h/2 the matrix is
  !> symmetric 3x3; scaled by its trace it is squared four times.
  pure subroutine squared_frequency(h, squared)
    real(wp), intent(in) :: h(chunk_size, 6)
    real(wp), intent(out) :: squared(chunk_size)
    real(wp), parameter :: root_eight = sqrt(8.0_wp)
    real(wp) :: trace, scale, a11, a22, a33, a12, a13, a23, b11, b22, b33, b12, b13, b23
    integer :: i, k

    !$omp simd private(trace, scale, a11, a22, a33, a12, a13, a23, b11, b22, b33, b12, b13, b23, k)
    do i = 1, chunk_size
      trace = 2.0_wp*(h(i, 1) + h(i, 2)) + 4.0_wp*h(i, 6)
      scale = 1.0_wp/trace
      a11 = 2.0_wp*h(i, 1)*scale
      a22 = 2.0_wp*h(i, 2)*scale
      a12 = 2.0_wp*h(i, 3)*scale
      a13 = root_eight*h(i, 4)*scale
      a23 = root_eight*h(i, 5)*scale
      a33 = 4.0_wp*h(i, 6)*scale
      do k = 1, 3
        b11 = a11*a11 + a12*a12 + a13*a13
        b22 = a12*a12 + a22*a22 + a23*a23
        b33 = a13*a13 + a23*a23 + a33*a33
        b12 = a11*a12 + a12*a22 + a13*a23
        b13 = a11*a13 + a12*a23 + a13*a33
        b23 = a12*a13 + a22*a23 + a23*a33
        a11 = b11
        a22 = b22
        a33 = b33
        a12 = b12
        a13 = b13
        a23 = b23
      end do
      ! The trace of the square is the sum of the squares.
      squared(i) = 4.0_wp*trace*sqrt(sqrt(sqrt(sqrt(a11*a11 + a22*a22 + a33*a33 &
        + 2.0_wp*(a12*a12 + a13*a13 + a23*a23)))))
    end do
  end subroutine squared_frequency

  !> 3 lambda of a triangle, by the trace of A (grad N)(grad N)^T.
  pure function triangle_part(chunk, i) result(squared)
    type(element_chunk_t), intent(in) :: chunk
    integer, intent(in) :: i
    real(wp) :: squared
    real(wp) :: sides

    ! Sides x3 - x1, x3 - x2 and x2 - x1.
    sides = (chunk%x31(i)**2 + chunk%y31(i)**2) + (chunk%x42(i)**2 + chunk%y42(i)**2) &
      + ((chunk%x31(i) - chunk%x42(i))**2 + (chunk%y31(i) - chunk%y42(i))**2)
    squared = 0.75_wp*sides*abs(chunk%inverse_area(i))
  end function triangle_part

  !> Of fully integrated axisymmetric quads, in their present shape, u_r = 0 on the axis. With H the
  !> matrix of |grad v|^2 and T that of (v_r/r)^2 of nodes off the axis over the masses, their
  !> largest row sums bound their eigenvalues, and with D:C:D <= 2G (|grad v|^2 + (v_r/r)^2) +
  !> lambda (div v + v_r/r)^2
  !>   omega^2 <= 2G (H + T) + lambda (sqrt(2H) + sqrt(T))^2,   K for lambda with mean dilatation.
  pure subroutine axisymmetric_full_step(material, viscosity, chunk, sums, limit, volume, single)
    type(moduli_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity      !! its Q1 and Q2 count
    type(element_chunk_t), intent(in) :: chunk
    type(step_sums_t), intent(in) :: sums
    real(wp), intent(out) :: limit                  !! s
    real(wp), intent(out) :: volume                 !! smallest J
    real(wp), intent(out), optional :: single(chunk_size) !! steps of the elements
    real(wp) :: modulus, largest
    real(wp), dimension(chunk_size) :: both, squared
    integer :: i

    modulus = material%bulk
    if (.not. material%has_mean_dilatation) &
      modulus = max(0.0_wp, material%bulk - 2.0_wp*material%shear/3.0_wp)
    largest = 0.0_wp
    volume = huge(1.0_wp)
    !$omp simd reduction(max : largest) reduction(min : volume)
    do i = 1, chunk_size
      both(i) = 2.0_wp*sums%plane(i) + sums%hoop(i) + 2.0_wp*sqrt(2.0_wp*sums%plane(i)*sums%hoop(i))
      squared(i) = 2.0_wp*material%shear*(sums%plane(i) + sums%hoop(i)) + modulus*both(i)
      largest = max(largest, squared(i))
      volume = min(volume, sums%volume(i))
    end do
    limit = 2.0_wp/sqrt(largest/material%density)
    if (present(single)) single = 2.0_wp/sqrt(squared/material%density)
    if (.not. (viscosity%quadratic > 0.0_wp .or. viscosity%linear > 0.0_wp)) return
    call form_viscous_rates(viscosity, material%sound_speed, chunk, both, largest)
    limit = limit/(1.0_wp + 0.5_wp*limit*largest)
    if (present(single)) single = single/(1.0_wp + 0.5_wp*single*both)
  end subroutine axisymmetric_full_step

end module stable_step_m
