! SPDX-License-Identifier: MIT
!> Stable step of one-point round quads: a lower bound of that of the single free element with its
!> row-sum masses in its present shape, hourglass control and bulk viscosity included, and so of
!> every mesh (doc/theory/elements.md, "Stable step of round quads").
module round_time_step_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use parts_m, only : hourglass_t, material_t, hourglass_viscous
  use round_chunk_m, only : round_chunk_t
  implicit none
  private
  public :: round_step, single_round_steps

  !> Of one chunk, over the masses: bounds of omega^2 of strain and of its part by volume (over
  !> lambda); of hourglass control gamma.gamma, and the square of its coupling to strain.
  type :: step_sums_t
    real(wp), dimension(chunk_size) :: strain, dilation, pattern, coupling
  end type step_sums_t

contains

  !> Smallest stable step of the chunk, and its smallest volume ratio. With x = omega^2 dt^2/4 of
  !> strain, y the same of hourglass control and z^2 the coupling, the element is stable where
  !> (1 - x)(1 - y) >= z^2, and so where y <= 1/2 and x + 2 z^2 <= 1.
  pure subroutine round_step(material, hourglass, inverse_mass, stride, chunk, round, limit, volume)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass      !! bulk viscosity too
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *) !! density over mass, first slot of the chunk; 0
                                                    !! at the fourth node of a triangle
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(in) :: round        !! present shape, resistance to hourglassing
    real(wp), intent(out) :: limit                  !! s
    real(wp), intent(out) :: volume                 !! smallest V/V0; below 0 where an area is
    type(step_sums_t) :: sums
    real(wp) :: largest, pattern, coupled, factor, lame, shear
    integer :: i

    shear = 2.0_wp*material%shear/material%density
    lame = max(0.0_wp, material%bulk/material%density - shear/3.0_wp)
    call form_strain_sums(lame, shear, inverse_mass, stride, round, sums)
    call form_pattern_sums(lame, shear, inverse_mass, stride, round, sums)
    largest = 0.0_wp
    pattern = 0.0_wp
    volume = huge(1.0_wp)
    !$omp simd reduction(max : largest, pattern) reduction(min : volume)
    do i = 1, chunk_size
      largest = max(largest, sums%strain(i))
      pattern = max(pattern, round%resistance(i)*sums%pattern(i))
      volume = min(volume, min(1.0_wp + chunk%stretch(i), &
        sign(1.0e3_wp, round%area(i))))
    end do
    pattern = max(pattern/material%density, tiny(1.0_wp))
    ! Resistances of the viscous form act on velocities, those of the stiffness form on their sum.
    if (hourglass%form == hourglass_viscous) then
      factor = 2.0_wp/(material%density*sqrt(largest))
    else
      factor = 2.0_wp/(material%density*largest)
    end if
    coupled = 0.0_wp
    !$omp simd reduction(max : coupled)
    do i = 1, chunk_size
      coupled = max(coupled, sums%strain(i) + factor*round%resistance(i)*sums%coupling(i))
    end do
    if (hourglass%form == hourglass_viscous) then
      limit = min(2.0_wp/sqrt(coupled), 1.0_wp/pattern)
    else
      limit = 2.0_wp/sqrt(max(coupled, 2.0_wp*pattern))
    end if
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) &
      call limit_bulk_viscosity(hourglass, material%sound_speed, chunk, sums, limit)
  end subroutine round_step

  !> The steps of the elements, each by the same bound alone.
  pure subroutine single_round_steps(material, hourglass, inverse_mass, stride, chunk, round, &
      single)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *) !! as above
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(out) :: single(chunk_size)     !! s
    real(wp), dimension(chunk_size) :: pattern, coupled
    type(element_chunk_t) :: one
    type(step_sums_t) :: sums, alone
    real(wp) :: lame, shear
    integer :: i

    shear = 2.0_wp*material%shear/material%density
    lame = max(0.0_wp, material%bulk/material%density - shear/3.0_wp)
    call form_strain_sums(lame, shear, inverse_mass, stride, round, sums)
    call form_pattern_sums(lame, shear, inverse_mass, stride, round, sums)
    pattern = max(round%resistance*sums%pattern/material%density, tiny(1.0_wp))
    if (hourglass%form == hourglass_viscous) then
      coupled = sums%strain + 2.0_wp/(material%density*sqrt(sums%strain))*round%resistance &
        *sums%coupling
      single = min(2.0_wp/sqrt(coupled), 1.0_wp/pattern)
    else
      coupled = sums%strain + 2.0_wp/(material%density*sums%strain)*round%resistance*sums%coupling
      single = 2.0_wp/sqrt(max(coupled, 2.0_wp*pattern))
    end if
    if (.not. (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp)) return
    do i = 1, chunk_size
      one%trace = chunk%trace(i)
      one%area = chunk%area(i)
      one%stretch = chunk%stretch(i)
      alone%dilation = sums%dilation(i)
      call limit_bulk_viscosity(hourglass, material%sound_speed, one, alone, single(i))
    end do
  end subroutine single_round_steps

  !> The sums over the nodes for strain. With p, q, o, t, u, w the sums of b_r^2, b_z^2, b_r b_z,
  !> M^2, M b_r, M b_z over m V: omega^2 <= 2G Lambda + lambda (p + q + t + 2 u), where Lambda is
  !> the largest row sum (Gershgorin) of the matrix [p o u; o q w; u w t].
  pure subroutine form_strain_sums(lame, shear, inverse_mass, stride, round, sums)
    real(wp), intent(in) :: lame, shear            !! lambda/rho and 2G/rho
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *)
    type(round_chunk_t), intent(in) :: round
    type(step_sums_t), intent(inout) :: sums       !! `strain` and `dilation` out
    real(wp) :: p, q, o, t, u, w, r, z, m, vr, vz, both
    integer :: i

    !$omp simd private(p, q, o, t, u, w, r, z, m, vr, vz, both)
    do i = 1, chunk_size
      both = merge(1.0_wp, 0.0_wp, inverse_mass(i, 4) <= 0.0_wp)
      r = round%rad_h(i) - round%rad_a(i)
      z = round%axi_h(i) - round%axi_a(i)
      m = round%mean_s(i) - round%mean_a(i)
      vr = inverse_mass(i, 1)*r
      vz = inverse_mass(i, 1)*z
      p = vr*r
      q = vz*z
      o = vr*z
      u = vr*m
      w = vz*m
      t = inverse_mass(i, 1)*m*m
      ! With signs that leave the sums as they are.
      r = round%rad_h(i) + round%rad_b(i)
      z = round%axi_h(i) + round%axi_b(i)
      m = round%mean_b(i) - round%mean_s(i)
      vr = inverse_mass(i, 2)*r
      vz = inverse_mass(i, 2)*z
      p = p + vr*r
      q = q + vz*z
      o = o + vr*z
      u = u + vr*m
      w = w + vz*m
      t = t + inverse_mass(i, 2)*m*m
      ! Node 4, and node 3, which in a triangle has the place of node 4 too.
      r = round%rad_b(i) - round%rad_h(i)
      z = round%axi_b(i) - round%axi_h(i)
      m = round%mean_s(i) + round%mean_b(i)
      vr = inverse_mass(i, 4)*r
      vz = inverse_mass(i, 4)*z
      p = p + vr*r
      q = q + vz*z
      o = o + vr*z
      u = u + vr*m
      w = w + vz*m
      t = t + inverse_mass(i, 4)*m*m
      r = (round%rad_h(i) + round%rad_a(i)) + both*r
      z = (round%axi_h(i) + round%axi_a(i)) + both*z
      m = (round%mean_s(i) + round%mean_a(i)) + both*m
      vr = inverse_mass(i, 3)*r
      vz = inverse_mass(i, 3)*z
      p = p + vr*r
      q = q + vz*z
      o = o + vr*z
      u = u + vr*m
      w = w + vz*m
      t = t + inverse_mass(i, 3)*m*m
      sums%dilation(i) = round%inverse_volume(i)*((p + q) + (t + 2.0_wp*u))
      m = max(p + (abs(o) + abs(u)), q + (abs(o) + abs(w)), t + (abs(u) + abs(w)))
      sums%strain(i) = round%inverse_volume(i)*shear*m + lame*sums%dilation(i)
    end do
  end subroutine form_strain_sums

  !> The same for hourglass control: gamma^2 over m, and the square of the coupling to strain.
  pure subroutine form_pattern_sums(lame, shear, inverse_mass, stride, round, sums)
    real(wp), intent(in) :: lame, shear            !! lambda/rho and 2G/rho
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *)
    type(round_chunk_t), intent(in) :: round
    type(step_sums_t), intent(inout) :: sums       !! `pattern` and `coupling` out
    real(wp) :: gr, gz, gm, gg, r, z, m, g, vg, both
    integer :: i

    !$omp simd private(gr, gz, gm, gg, r, z, m, g, vg, both)
    do i = 1, chunk_size
      both = merge(1.0_wp, 0.0_wp, inverse_mass(i, 4) <= 0.0_wp)
      r = round%rad_h(i) - round%rad_a(i)
      z = round%axi_h(i) - round%axi_a(i)
      m = round%mean_s(i) - round%mean_a(i)
      g = 1.0_wp - round%gamma_a(i)
      vg = inverse_mass(i, 1)*g
      gr = vg*r
      gz = vg*z
      gm = vg*m
      gg = vg*g
      ! With signs that leave the sums as they are.
      r = round%rad_h(i) + round%rad_b(i)
      z = round%axi_h(i) + round%axi_b(i)
      m = round%mean_b(i) - round%mean_s(i)
      g = 1.0_wp + round%gamma_b(i)
      vg = inverse_mass(i, 2)*g
      gr = gr + vg*r
      gz = gz + vg*z
      gm = gm + vg*m
      gg = gg + vg*g
      ! Node 4, and node 3, which in a triangle has the place of node 4 too.
      r = round%rad_b(i) - round%rad_h(i)
      z = round%axi_b(i) - round%axi_h(i)
      m = round%mean_s(i) + round%mean_b(i)
      g = round%gamma_b(i) - 1.0_wp
      vg = inverse_mass(i, 4)*g
      gr = gr + vg*r
      gz = gz + vg*z
      gm = gm + vg*m
      gg = gg + vg*g
      r = (round%rad_h(i) + round%rad_a(i)) + both*r
      z = (round%axi_h(i) + round%axi_a(i)) + both*z
      m = (round%mean_s(i) + round%mean_a(i)) + both*m
      g = (1.0_wp + round%gamma_a(i)) + both*g
      vg = inverse_mass(i, 3)*g
      gr = gr + vg*r
      gz = gz + vg*z
      gm = gm + vg*m
      gg = gg + vg*g
      sums%pattern(i) = gg
      sums%coupling(i) = round%inverse_volume(i)*(shear*(1.5_wp*(gr*gr + gz*gz) + gm*gm) &
        + lame*((gr + gm)**2 + gz*gz))
    end do
  end subroutine form_pattern_sums

  !> Bulk viscosity in compression has a rate of its own, which is added: x + y <= theta at a share
  !> theta <= 1 of the step without it.
  pure subroutine limit_bulk_viscosity(viscosity, sound_speed, chunk, sums, limit)
    type(hourglass_t), intent(in) :: viscosity
    real(wp), intent(in) :: sound_speed
    type(element_chunk_t), intent(in) :: chunk
    type(step_sums_t), intent(in) :: sums
    real(wp), intent(inout) :: limit
    real(wp) :: length, rate
    integer :: i

    rate = 0.0_wp
    do i = 1, chunk_size
      if (.not. chunk%trace(i) < 0.0_wp) cycle
      length = sqrt(chunk%area(i))
      rate = max(rate, length/(1.0_wp + chunk%stretch(i))*(viscosity%linear*sound_speed &
        - viscosity%quadratic*length*chunk%trace(i))*sums%dilation(i))
    end do
    limit = limit/(1.0_wp + 0.5_wp*limit*rate)
  end subroutine limit_bulk_viscosity

end module round_time_step_m
