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
  !> lambda); of hourglass control its gamma.gamma, and the square of its coupling to strain, both
  !> times the resistance.
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
    type(round_chunk_t), intent(inout) :: round     !! present shape, resistance to hourglassing;
                                                    !! gradients of triangles are changed
    real(wp), intent(out) :: limit                  !! s
    real(wp), intent(out) :: volume                 !! smallest V/V0; below 0 where an area is
    type(step_sums_t) :: sums
    real(wp) :: largest, pattern, coupled, factor, lame, shear
    integer :: i

    shear = 2.0_wp*material%shear/material%density
    lame = max(0.0_wp, material%bulk/material%density - shear/3.0_wp)
    call join_third_nodes(inverse_mass(1, 4), round)
    call form_sums(lame, shear, inverse_mass, stride, chunk%inverse_area, round, sums)
    largest = 0.0_wp
    pattern = 0.0_wp
    volume = huge(1.0_wp)
    !$omp simd reduction(max : largest, pattern) reduction(min : volume)
    do i = 1, chunk_size
      largest = max(largest, sums%strain(i))
      pattern = max(pattern, sums%pattern(i))
      volume = min(volume, min(1.0_wp + chunk%stretch(i), sign(1.0e3_wp, chunk%area(i))))
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
      coupled = max(coupled, sums%strain(i) + factor*sums%coupling(i))
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
    type(round_chunk_t), intent(inout) :: round
    real(wp), intent(out) :: single(chunk_size)     !! s
    real(wp), dimension(chunk_size) :: pattern, coupled
    type(element_chunk_t) :: one
    type(step_sums_t) :: sums, alone
    real(wp) :: lame, shear
    integer :: i

    shear = 2.0_wp*material%shear/material%density
    lame = max(0.0_wp, material%bulk/material%density - shear/3.0_wp)
    call join_third_nodes(inverse_mass(1, 4), round)
    call form_sums(lame, shear, inverse_mass, stride, chunk%inverse_area, round, sums)
    pattern = max(sums%pattern/material%density, tiny(1.0_wp))
    if (hourglass%form == hourglass_viscous) then
      coupled = sums%strain + 2.0_wp/(material%density*sqrt(sums%strain))*sums%coupling
      single = min(2.0_wp/sqrt(coupled), 1.0_wp/pattern)
    else
      coupled = sums%strain + 2.0_wp/(material%density*sums%strain)*sums%coupling
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

  !> A triangle's third node has the place of its fourth too: the gradients whose pattern gives it
  !> both shares and leaves none, and no hourglass.
  pure subroutine join_third_nodes(inverse_mass, round)
    real(wp), intent(in) :: inverse_mass(chunk_size) !! of the fourth nodes
    type(round_chunk_t), intent(inout) :: round
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
      r = 0.5_wp*(round%rad_b(i) - round%rad_h(i))
      z = 0.5_wp*(round%axi_b(i) - round%axi_h(i))
      m = 0.5_wp*(round%mean_b(i) + round%mean_s(i))
      round%rad_a(i) = round%rad_a(i) + r
      round%rad_b(i) = round%rad_b(i) - r
      round%rad_h(i) = round%rad_h(i) + r
      round%axi_a(i) = round%axi_a(i) + z
      round%axi_b(i) = round%axi_b(i) - z
      round%axi_h(i) = round%axi_h(i) + z
      round%mean_a(i) = round%mean_a(i) + m
      round%mean_b(i) = round%mean_b(i) + m
      round%mean_s(i) = round%mean_s(i) + m
      round%resistance(i) = 0.0_wp
    end do
  end subroutine join_third_nodes

  !> The sums over the nodes. With p, q, o, t, u, w the sums of b_r^2, b_z^2, b_r b_z, M^2, M b_r,
  !> M b_z over m V: omega^2 <= 2G Lambda + lambda (p + q + t + 2 u), where Lambda is the largest
  !> row sum (Gershgorin) of the matrix [p o u; o q w; u w t]. In the patterns nodes 1 and 3 have
  !> b = h -+ a, nodes 2 and 4 have -h -+ b (M: s -+ a and s -+ b), so that the sum v and the
  !> difference d of two opposite nodes' 1/m give the weights v a + d h and v h + d a of a pattern.
  pure subroutine form_sums(lame, shear, inverse_mass, stride, inverse_area, round, sums)
    real(wp), intent(in) :: lame, shear            !! lambda/rho and 2G/rho
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *)
    real(wp), intent(in) :: inverse_area(chunk_size)
    type(round_chunk_t), intent(in) :: round
    type(step_sums_t), intent(inout) :: sums
    real(wp) :: va, da, vb, db, wa, wb, wha, whb, ga, gb, gr, gz, gm, p, q, o, t, u, w
    integer :: i

    !$omp simd private(va, da, vb, db, wa, wb, wha, whb, ga, gb, gr, gz, gm, p, q, o, t, u, w)
    do i = 1, chunk_size
      va = inverse_mass(i, 3) + inverse_mass(i, 1)
      da = inverse_mass(i, 3) - inverse_mass(i, 1)
      vb = inverse_mass(i, 2) + inverse_mass(i, 4)
      db = inverse_mass(i, 2) - inverse_mass(i, 4)
      ga = -12.0_wp*inverse_area(i)*round%mean_a(i)
      gb = 12.0_wp*inverse_area(i)*round%mean_b(i)
      ! Gradients in r, weighted, and their products with all others.
      wa = va*round%rad_a(i) + da*round%rad_h(i)
      wb = vb*round%rad_b(i) + db*round%rad_h(i)
      wha = va*round%rad_h(i) + da*round%rad_a(i)
      whb = vb*round%rad_h(i) + db*round%rad_b(i)
      p = round%rad_a(i)*wa + round%rad_b(i)*wb + round%rad_h(i)*(wha + whb)
      o = round%axi_a(i)*wa + round%axi_b(i)*wb + round%axi_h(i)*(wha + whb)
      u = round%mean_a(i)*wa + round%mean_b(i)*wb + round%mean_s(i)*(wha - whb)
      gr = ga*wa + gb*wb + (wha + whb)
      ! In z.
      wa = va*round%axi_a(i) + da*round%axi_h(i)
      wb = vb*round%axi_b(i) + db*round%axi_h(i)
      wha = va*round%axi_h(i) + da*round%axi_a(i)
      whb = vb*round%axi_h(i) + db*round%axi_b(i)
      q = round%axi_a(i)*wa + round%axi_b(i)*wb + round%axi_h(i)*(wha + whb)
      w = round%mean_a(i)*wa + round%mean_b(i)*wb + round%mean_s(i)*(wha - whb)
      gz = ga*wa + gb*wb + (wha + whb)
      ! The integrals M.
      wa = va*round%mean_a(i) + da*round%mean_s(i)
      wb = vb*round%mean_b(i) - db*round%mean_s(i)
      wha = va*round%mean_s(i) + da*round%mean_a(i)
      whb = vb*round%mean_s(i) - db*round%mean_b(i)
      t = round%mean_a(i)*wa + round%mean_b(i)*wb + round%mean_s(i)*(wha + whb)
      gm = ga*wa + gb*wb + (wha - whb)
      sums%pattern(i) = round%resistance(i)*((ga*(va*ga + da) + gb*(vb*gb + db)) &
        + ((va + da*ga) + (vb + db*gb)))
      sums%coupling(i) = round%resistance(i)*round%inverse_volume(i)*(shear*(1.5_wp*(gr*gr &
        + gz*gz) + gm*gm) + lame*((gr + gm)**2 + gz*gz))
      sums%dilation(i) = round%inverse_volume(i)*((p + q) + (t + 2.0_wp*u))
      t = max(p + (abs(o) + abs(u)), q + (abs(o) + abs(w)), t + (abs(u) + abs(w)))
      sums%strain(i) = round%inverse_volume(i)*shear*t + lame*sums%dilation(i)
    end do
  end subroutine form_sums

  !> Bulk viscosity has a rate of its own, which is added: x + y <= theta at a share theta <= 1 of
  !> the step without it. It counts in expansion too: two steps later the fastest mode is in
  !> compression.
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
      length = sqrt(abs(chunk%area(i)))
      rate = max(rate, length/abs(1.0_wp + chunk%stretch(i))*(viscosity%linear*sound_speed &
        + viscosity%quadratic*length*abs(chunk%trace(i)))*sums%dilation(i))
    end do
    limit = limit/(1.0_wp + 0.5_wp*limit*rate)
  end subroutine limit_bulk_viscosity

end module round_time_step_m
