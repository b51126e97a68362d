! SPDX-License-Identifier: MIT
!> Stable step of one-point round quads: a lower bound of that of the single free element with its
!> row-sum masses in its present shape, hourglass control and bulk viscosity included, and so of
!> every mesh (doc/theory/elements.md, "Stable step of round quads").
module round_time_step_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use parts_m, only : hourglass_t, material_t, hourglass_viscous
  use round_chunk_m, only : round_chunk_t, reference_mass
  implicit none
  private
  public :: round_step, round_limits

  !> Of one chunk: squares of the frequency of strain and its part by volume, and what hourglass
  !> control adds: gamma.gamma/m, and its coupling to strain.
  type :: step_sums_t
    real(wp), dimension(chunk_size) :: strain, dilation, pattern, coupling
  end type step_sums_t

contains

  !> Smallest stable step of the chunk, and its smallest volume ratio.
  pure subroutine round_step(material, hourglass, reference, stride, chunk, round, limit, volume)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass   !! bulk viscosity too
    integer, intent(in) :: stride
    real(wp), intent(in) :: reference(stride, *) !! first slot of the chunk
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(out) :: limit               !! s
    real(wp), intent(out) :: volume              !! smallest V/V0; not above 0 where an area is not
    real(wp) :: limits(chunk_size)
    integer :: i

    call round_limits(material, hourglass, reference(1, reference_mass), stride, chunk, round, &
      limits)
    limit = huge(1.0_wp)
    volume = huge(1.0_wp)
    !$omp simd reduction(min : limit, volume)
    do i = 1, chunk_size
      limit = min(limit, limits(i))
      volume = min(volume, merge(1.0_wp + chunk%stretch(i), -1.0_wp, round%now%area(i) > 0.0_wp))
    end do
  end subroutine round_step

  !> Stable step of each element of a chunk.
  pure subroutine round_limits(material, hourglass, inverse_mass, stride, chunk, round, limits)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, 4) !! density over mass; 0 at the fourth node of a
                                                    !! triangle
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(in) :: round
    real(wp), intent(out) :: limits(chunk_size)
    type(step_sums_t) :: sums

    call form_step_sums(max(0.0_wp, material%bulk - 2.0_wp*material%shear/3.0_wp) &
      /material%density, 2.0_wp*material%shear/material%density, inverse_mass, stride, round, sums)
    if (hourglass%form == hourglass_viscous) then
      call limit_viscous(0.25_wp*hourglass%coefficient*material%sound_speed, round, sums, limits)
    else
      call limit_stiff(0.25_wp*hourglass%coefficient*material%sound_speed**2, round, sums, limits)
    end if
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) &
      call limit_bulk_viscosity(hourglass, material%sound_speed, chunk, sums, limits)
  end subroutine round_limits

  !> The sums over the nodes. With b_a the gradients over V, G their Gram matrix times V with 1/m
  !> between: omega^2 <= 2G Lambda + lambda tr, Lambda the larger eigenvalue of [mu n; n t],
  !> mu that of [p o; o q], n^2 = u^2 + w^2.
  pure subroutine form_step_sums(lame, shear, inverse_mass, stride, round, sums)
    real(wp), intent(in) :: lame, shear             !! lambda/rho and 2G/rho
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, 4)
    type(round_chunk_t), intent(in) :: round
    type(step_sums_t), intent(inout) :: sums
    real(wp) :: p, q, o, t, u, w, gr, gz, gm, gg, r, z, m, g, v, both, wr, wz, mu, inverse, ga, gb
    integer :: i

    associate (now => round%now)
      !$omp simd private(p, q, o, t, u, w, gr, gz, gm, gg, r, z, m, g, v, both, wr, wz, mu, &
      !$omp& inverse, ga, gb)
      do i = 1, chunk_size
        wr = 0.5_wp/now%area(i)
        wz = now%hz(i)*wr
        wr = now%hr(i)*wr
        ga = wz*now%br(i) - wr*now%bz(i)
        gb = wr*now%az(i) - wz*now%ar(i)
        ! Node 1, and then 2, 3, 4 on top.
        r = now%rad_h(i) - now%rad_a(i)
        z = now%axi_h(i) - now%axi_a(i)
        m = now%mean_s(i) - now%mean_a(i)
        g = 1.0_wp - ga
        v = inverse_mass(i, 1)
        p = v*r*r
        q = v*z*z
        o = v*r*z
        t = v*m*m
        u = v*r*m
        w = v*z*m
        gr = v*g*r
        gz = v*g*z
        gm = v*g*m
        gg = v*g*g
        r = -(now%rad_h(i) + now%rad_b(i))
        z = -(now%axi_h(i) + now%axi_b(i))
        m = now%mean_s(i) - now%mean_b(i)
        g = -(1.0_wp + gb)
        v = inverse_mass(i, 2)
        p = p + v*r*r
        q = q + v*z*z
        o = o + v*r*z
        t = t + v*m*m
        u = u + v*r*m
        w = w + v*z*m
        gr = gr + v*g*r
        gz = gz + v*g*z
        gm = gm + v*g*m
        gg = gg + v*g*g
        ! The third node of a triangle has both places.
        both = merge(1.0_wp, 0.0_wp, inverse_mass(i, 4) <= 0.0_wp)
        r = (now%rad_h(i) + now%rad_a(i)) + both*(now%rad_b(i) - now%rad_h(i))
        z = (now%axi_h(i) + now%axi_a(i)) + both*(now%axi_b(i) - now%axi_h(i))
        m = (now%mean_s(i) + now%mean_a(i)) + both*(now%mean_s(i) + now%mean_b(i))
        g = (1.0_wp + ga) + both*(gb - 1.0_wp)
        v = inverse_mass(i, 3)
        p = p + v*r*r
        q = q + v*z*z
        o = o + v*r*z
        t = t + v*m*m
        u = u + v*r*m
        w = w + v*z*m
        gr = gr + v*g*r
        gz = gz + v*g*z
        gm = gm + v*g*m
        gg = gg + v*g*g
        r = now%rad_b(i) - now%rad_h(i)
        z = now%axi_b(i) - now%axi_h(i)
        m = now%mean_s(i) + now%mean_b(i)
        g = gb - 1.0_wp
        v = inverse_mass(i, 4)
        p = p + v*r*r
        q = q + v*z*z
        o = o + v*r*z
        t = t + v*m*m
        u = u + v*r*m
        w = w + v*z*m
        gr = gr + v*g*r
        gz = gz + v*g*z
        gm = gm + v*g*m
        gg = gg + v*g*g
        inverse = 1.0_wp/now%volume(i)
        mu = 0.5_wp*(p + q) + sqrt(0.25_wp*(p - q)**2 + o*o)
        mu = 0.5_wp*(mu + t) + sqrt(0.25_wp*(mu - t)**2 + (u*u + w*w))
        sums%dilation(i) = inverse*((p + q) + (t + 2.0_wp*u))
        sums%strain(i) = inverse*shear*mu + lame*sums%dilation(i)
        sums%pattern(i) = gg
        sums%coupling(i) = inverse*(shear*(1.5_wp*(gr*gr + gz*gz) + gm*gm) &
          + lame*((gr + gm)**2 + gz*gz))
      end do
    end associate
  end subroutine form_step_sums

  !> With viscous hourglass control k gamma gamma, the largest eigenvalue of dt^2 K/4 + dt C/2 (over
  !> the masses) is at most 1 where (1 - x)(1 - y) >= z^2, x = (dt omega/2)^2, y = dt k gg/2, z^2 the
  !> coupling, or where x + y <= 1: the larger of two steps that are sure to have it.
  pure subroutine limit_viscous(factor, round, sums, limits)
    real(wp), intent(in) :: factor   !! Q_h c/4
    type(round_chunk_t), intent(in) :: round
    type(step_sums_t), intent(in) :: sums
    real(wp), intent(out) :: limits(chunk_size)
    real(wp) :: k, omega, b, d, apart, together
    integer :: i

    !$omp simd private(k, omega, b, d, apart, together)
    do i = 1, chunk_size
      k = factor*round%now%volume(i)/sqrt(round%now%area(i))
      omega = sqrt(sums%strain(i))
      b = k*sums%pattern(i)/omega
      d = k*sums%coupling(i)/(omega*sums%strain(i))
      together = sqrt(1.0_wp + 0.25_wp*b*b) - 0.5_wp*b
      apart = sqrt(max(0.0_wp, 1.0_wp - d/max(1.0_wp - b, tiny(1.0_wp)**0.5_wp)))
      limits(i) = 2.0_wp*max(together, apart)/omega
    end do
  end subroutine limit_viscous

  !> With stiff hourglass control: the larger eigenvalue of [omega^2 z; z k gg].
  pure subroutine limit_stiff(factor, round, sums, limits)
    real(wp), intent(in) :: factor   !! Q_h c^2/4
    type(round_chunk_t), intent(in) :: round
    type(step_sums_t), intent(in) :: sums
    real(wp), intent(out) :: limits(chunk_size)
    real(wp) :: k, own
    integer :: i

    associate (now => round%now)
      !$omp simd private(k, own)
      do i = 1, chunk_size
        k = 0.5_wp*factor*((now%ar(i)**2 + now%az(i)**2) + (now%br(i)**2 + now%bz(i)**2)) &
          *now%volume(i)/(now%area(i)*now%area(i))
        own = k*sums%pattern(i)
        limits(i) = 2.0_wp/sqrt(0.5_wp*(sums%strain(i) + own) &
          + sqrt(0.25_wp*(sums%strain(i) - own)**2 + k*sums%coupling(i)))
      end do
    end associate
  end subroutine limit_stiff

  !> Bulk viscosity in compression has a rate of its own, which is added: x + y <= theta at a share
  !> theta <= 1 of the step without it.
  pure subroutine limit_bulk_viscosity(viscosity, sound_speed, chunk, sums, limits)
    type(hourglass_t), intent(in) :: viscosity
    real(wp), intent(in) :: sound_speed
    type(element_chunk_t), intent(in) :: chunk
    type(step_sums_t), intent(in) :: sums
    real(wp), intent(inout) :: limits(chunk_size)
    real(wp) :: length, rate
    integer :: i

    do i = 1, chunk_size
      if (.not. chunk%trace(i) < 0.0_wp) cycle
      length = sqrt(chunk%area(i))
      rate = length/(1.0_wp + chunk%stretch(i))*(viscosity%linear*sound_speed &
        - viscosity%quadratic*length*chunk%trace(i))*sums%dilation(i)
      limits(i) = limits(i)/(1.0_wp + 0.5_wp*limits(i)*rate)
    end do
  end subroutine limit_bulk_viscosity

end module round_time_step_m
