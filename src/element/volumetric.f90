! SPDX-License-Identifier: MIT
!> Volumetric response sigma_vol = K ln(J) (Kang, Lee & Shin 2023 print the pressure, A1); equations
!> of state of one chunk, p = A + B E with mu = 1/v - 1, and their energy, with the selection of the
!> kind; stresses of the rate of deformation: bulk viscosity in compression (von Neumann & Richtmyer
!> 1950, linear term of Landshoff), and stiffness damping (*DAMPING_PART_STIFFNESS): the elastic law
!> with the rate of deformation in place of the strain, times a retardation time of each element
!> (doc/theory/elements.md, "Stiffness damping").
module volumetric_m
  use element_chunk_m, only : element_chunk_t
  use eos_m, only : eos_t, eos_logarithmic, eos_linear_polynomial, eos_gruneisen
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use stress_chunk_m, only : stress_chunk_t, rotate_deviator
  use vector_functions_m, only : form_log_ratios
  implicit none
  private
  public :: volumetric_stress, volumetric_energy, log_ratio, atanh_series, largest_size, &
    add_bulk_viscosity, add_viscous_deviator, add_viscous_pressure, &
    eos_chunk_t, form_eos, advance_energy, find_stiffness, form_gruneisen, form_linear_polynomial

  !> Equation of state of one chunk at given volumes.
  type :: eos_chunk_t
    real(wp), dimension(chunk_size) :: a, b             !! A (Pa) and B
    real(wp), dimension(chunk_size) :: a_slope, b_slope !! dA/dmu and dB/dmu
  end type eos_chunk_t

contains

  !> Largest absolute value of a chunk.
  pure function largest_size(values) result(largest)
    real(wp), intent(in) :: values(chunk_size)
    real(wp) :: largest
    integer :: i

    largest = 0.0_wp
    !$omp simd reduction(max : largest)
    do i = 1, chunk_size
      largest = max(largest, abs(values(i)))
    end do
  end function largest_size

  !> K ln(1 + stretch) for a chunk. ln(J) = 2 atanh(z), z = s/(2 + s), as a series where
  !> |z| <= 0.1 (its truncation is below round-off there), the library's logarithm for a chunk
  !> with any element outside.
  pure subroutine volumetric_stress(bulk, stretch, stress)
    real(wp), intent(in) :: bulk
    real(wp), intent(in) :: stretch(chunk_size)  !! J - 1
    real(wp), intent(out) :: stress(chunk_size)
    real(wp) :: z, largest
    integer :: i

    largest = 0.0_wp
    !$omp simd private(z) reduction(max : largest)
    do i = 1, chunk_size
      z = stretch(i)/(2.0_wp + stretch(i))
      largest = max(largest, abs(z))
      stress(i) = 2.0_wp*bulk*atanh_series(z)
    end do
    if (largest <= 0.1_wp) return
    do i = 1, chunk_size
      stress(i) = bulk*log_ratio(stretch(i))
    end do
  end subroutine volumetric_stress

  !> z + z^3/3 + ... + z^15/15.
  pure elemental function atanh_series(z) result(y)
    !$omp declare simd(atanh_series)
    real(wp), intent(in) :: z
    real(wp) :: y
    real(wp) :: w

    w = z*z
    y = z + z*w*(1.0_wp/3.0_wp + w*(1.0_wp/5.0_wp + w*(1.0_wp/7.0_wp + w*(1.0_wp/9.0_wp &
      + w*(1.0_wp/11.0_wp + w*(1.0_wp/13.0_wp + w*(1.0_wp/15.0_wp)))))))
  end function atanh_series

  !> ln(1 + stretch) to full relative precision; a large negative number where the volume is not
  !> positive (the driver stops on the volume).
  pure elemental function log_ratio(stretch) result(y)
    real(wp), intent(in) :: stretch
    real(wp) :: y
    real(wp) :: z

    if (.not. 1.0_wp + stretch > 0.0_wp) then
      y = -huge(1.0_wp)**0.25_wp
      return
    end if
    z = stretch/(2.0_wp + stretch)
    if (abs(z) <= 0.1_wp) then
      y = 2.0_wp*atanh_series(z)
    else
      y = log(1.0_wp + stretch)
    end if
  end function log_ratio

  !> Energy per initial volume of the volumetric stress: K (J ln J - J + 1), the integral of
  !> K ln(J) dJ.
  pure elemental function volumetric_energy(bulk, stretch) result(energy)
    real(wp), intent(in) :: bulk
    real(wp), intent(in) :: stretch
    real(wp) :: energy

    if (abs(stretch) < 1.0e-3_wp) then
      ! Series where the closed form would lose its digits.
      energy = bulk*stretch**2*(1.0_wp/2.0_wp - stretch*(1.0_wp/6.0_wp - stretch*(1.0_wp/12.0_wp &
        - stretch*(1.0_wp/20.0_wp - stretch/30.0_wp))))
    else
      energy = bulk*((1.0_wp + stretch)*log_ratio(stretch) - stretch)
    end if
  end function volumetric_energy

  !> Add q = rho l (Q1 l t^2 - Q2 c t) as a pressure where the volumetric strain rate t < 0; l =
  !> sqrt(A). The work is that of the mean of the present and the previous q: it acts over half of
  !> the step that it was formed from and half of the next, in which the element may expand.
  pure subroutine add_bulk_viscosity(quadratic, linear, density, sound_speed, dt, chunk, last, work)
    real(wp), intent(in) :: quadratic, linear     !! Q1, Q2
    real(wp), intent(in) :: density               !! initial density
    real(wp), intent(in) :: sound_speed
    real(wp), intent(in) :: dt
    type(element_chunk_t), intent(inout) :: chunk !! pressure in and out
    real(wp), intent(inout) :: last(chunk_size)   !! q of the previous step in, of this one out
    real(wp), intent(out) :: work                 !! dissipated in the step
    real(wp) :: length, rate, q
    integer :: i

    work = 0.0_wp
    !$omp simd private(length, rate, q) reduction(+ : work)
    do i = 1, chunk_size
      length = sqrt(abs(chunk%area(i)))
      rate = min(0.0_wp, chunk%trace(i))
      q = density/(1.0_wp + chunk%stretch(i))*length*rate &
        *(quadratic*length*rate - linear*sound_speed)
      chunk%pressure(i) = chunk%pressure(i) - q
      work = work - (last(i) + q)*chunk%trace(i)*chunk%mid_area(i)
      last(i) = q
    end do
    work = 0.5_wp*dt*work
  end subroutine add_bulk_viscosity

  !> Add 2 G beta times the deviator of the rate of deformation, and the work of the mean of the
  !> present and the previous stress: a force acts over half of the step that it was formed from and
  !> half of the next.
  pure subroutine add_viscous_deviator(shear, times, area, stress, last, work)
    real(wp), intent(in) :: shear                 !! G
    real(wp), intent(in) :: times(chunk_size)     !! beta
    real(wp), intent(in) :: area(chunk_size)      !! mid-step
    type(stress_chunk_t), intent(inout) :: stress
    real(wp), intent(inout) :: last(chunk_size, 3) !! of the previous step in, of this one out
    real(wp), intent(inout) :: work
    real(wp) :: factor, third, x, y, shear_part, inverse, sum
    integer :: i

    if (.not. stress%dt > 0.0_wp) return
    inverse = 2.0_wp*shear/stress%dt
    sum = 0.0_wp
    call rotate_deviator(stress%cos2, stress%sin2, last(:, 1), last(:, 2), last(:, 3))
    !$omp simd private(factor, third, x, y, shear_part) reduction(+ : sum)
    do i = 1, chunk_size
      factor = inverse*times(i)
      ! Rates of an axisymmetric body stand here less the hoop rate, which leaves their deviator.
      third = (stress%dxx(i) + stress%dyy(i))/3.0_wp
      x = stress%dxx(i) - third
      y = stress%dyy(i) - third
      shear_part = stress%dxy(i)
      sum = sum + area(i)*((last(i, 1) + factor*x)*x + (last(i, 2) + factor*y)*y &
        + (last(i, 1) + last(i, 2) + factor*third)*third &
        + 2.0_wp*(last(i, 3) + factor*shear_part)*shear_part)
      last(i, 1) = factor*x
      last(i, 2) = factor*y
      last(i, 3) = factor*shear_part
      stress%sxx(i) = stress%sxx(i) + last(i, 1)
      stress%syy(i) = stress%syy(i) + last(i, 2)
      stress%sxy(i) = stress%sxy(i) + last(i, 3)
    end do
    work = work + 0.5_wp*sum
  end subroutine add_viscous_deviator

  !> Add K beta times the volumetric rate, and the work of the mean of the present and the previous
  !> pressure.
  pure subroutine add_viscous_pressure(bulk, times, trace, area, dt, pressure, last, work)
    real(wp), intent(in) :: bulk                     !! K
    real(wp), intent(in) :: times(chunk_size)        !! beta
    real(wp), intent(in) :: trace(chunk_size)        !! rate of the volume over the volume
    real(wp), intent(in) :: area(chunk_size)         !! mid-step
    real(wp), intent(in) :: dt
    real(wp), intent(inout) :: pressure(chunk_size)  !! tension positive
    real(wp), intent(inout) :: last(chunk_size)      !! of the previous step in, of this one out
    real(wp), intent(inout) :: work
    real(wp) :: more, sum
    integer :: i

    if (.not. dt > 0.0_wp) return
    sum = 0.0_wp
    !$omp simd private(more) reduction(+ : sum)
    do i = 1, chunk_size
      more = bulk*times(i)*trace(i)
      pressure(i) = pressure(i) + more
      sum = sum + (last(i) + more)*trace(i)*area(i)
      last(i) = more
    end do
    work = work + 0.5_wp*dt*sum
  end subroutine add_viscous_pressure

  !> A and B at v = 1 + stretch, and their derivatives.
  pure subroutine form_eos(eos, stretch, state)
    type(eos_t), intent(in) :: eos
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state

    select case (eos%kind)
    case (eos_logarithmic)
      call form_logarithmic(eos%stiffness, stretch, state)
    case (eos_linear_polynomial)
      call form_linear_polynomial(eos%c, stretch, state)
    case (eos_gruneisen)
      call form_gruneisen(eos, stretch, state)
    end select
  end subroutine form_eos

  !> Pressure and energy at the end of a step from v0 to v1, both of the same instant:
  !>   E1 = E0 + heat - (p0 + p1)/2 (v1 - v0),  p1 = A1 + B1 E1,
  !> solved in closed form since p is linear in E. A pressure beyond a bound is the bound.
  pure subroutine advance_energy(state, growth, heat, least, most, energy, pressure)
    type(eos_chunk_t), intent(in) :: state         !! at the end of the step
    real(wp), intent(in) :: growth(chunk_size)     !! v1 - v0
    real(wp), intent(in) :: heat(chunk_size)       !! other work, J per initial volume
    real(wp), intent(in) :: least(chunk_size), most(chunk_size) !! bounds of the pressure
    real(wp), intent(inout) :: energy(chunk_size), pressure(chunk_size)
    real(wp) :: start
    integer :: i

    !$omp simd private(start)
    do i = 1, chunk_size
      start = energy(i) + (heat(i) - 0.5_wp*pressure(i)*growth(i))
      pressure(i) = min(most(i), max(least(i), (state%a(i) + state%b(i)*start) &
        /(1.0_wp + 0.5_wp*state%b(i)*growth(i))))
      energy(i) = start - 0.5_wp*pressure(i)*growth(i)
    end do
  end subroutine advance_energy

  !> Adiabatic bulk modulus -v dp/dv of each slot, with dE = -p dv:
  !> (1 + mu)(A' + B' E + B p v^2); not below 0.
  pure subroutine find_stiffness(state, stretch, energy, pressure, stiffness)
    type(eos_chunk_t), intent(in) :: state
    real(wp), intent(in), dimension(chunk_size) :: stretch, energy, pressure
    real(wp), intent(out) :: stiffness(chunk_size)
    real(wp) :: v
    integer :: i

    !$omp simd private(v)
    do i = 1, chunk_size
      v = 1.0_wp + stretch(i)
      stiffness(i) = max(0.0_wp, (state%a_slope(i) + state%b_slope(i)*energy(i) &
        + state%b(i)*pressure(i)*v*v)/v)
    end do
  end subroutine find_stiffness

  !> Mie and Gruneisen's pressure about a Hugoniot given by the shock velocity
  !> U = C + S1 u + S2 (u/U) u + S3 (u/U)^2 u:
  !>   mu > 0: A = rho0 C^2 mu (1 + (1 - gamma/2) mu - a/2 mu^2)/d^2,
  !>           d = 1 - (S1 - 1) mu - S2 mu^2/(1 + mu) - S3 mu^3/(1 + mu)^2
  !>   else:   A = rho0 C^2 mu;   B = gamma + a mu.
  pure subroutine form_gruneisen(eos, stretch, state)
    type(eos_t), intent(in) :: eos
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state
    real(wp) :: mu, x, y, top, top_slope, low, low_slope, half
    integer :: i

    half = 0.5_wp*eos%correction
    !$omp simd private(mu, x, y, top, top_slope, low, low_slope)
    do i = 1, chunk_size
      mu = -stretch(i)/(1.0_wp + stretch(i))
      ! In expansion x = 0 leaves top = low = 1 and A = rho0 C^2 mu. y = x/(1 + x).
      x = max(0.0_wp, mu)
      y = x/(1.0_wp + x)
      top = 1.0_wp + x*((1.0_wp - 0.5_wp*eos%gamma) - half*x)
      top_slope = (1.0_wp - 0.5_wp*eos%gamma) - eos%correction*x
      low = 1.0_wp - x*((eos%s(1) - 1.0_wp) + y*(eos%s(2) + eos%s(3)*y))
      low_slope = -((eos%s(1) - 1.0_wp) + y*((2.0_wp - y)*eos%s(2) &
        + y*(3.0_wp - 2.0_wp*y)*eos%s(3)))
      state%a(i) = eos%stiffness*mu*top/(low*low)
      state%a_slope(i) = eos%stiffness*(top/(low*low) &
        + x*(top_slope*low - 2.0_wp*top*low_slope)/(low*low*low))
      state%b(i) = eos%gamma + eos%correction*mu
      state%b_slope(i) = eos%correction
    end do
  end subroutine form_gruneisen

  !> p = C0 + C1 mu + C2 mu^2 + C3 mu^3 + (C4 + C5 mu + C6 mu^2) E; C2 and C6 count in compression.
  pure subroutine form_linear_polynomial(c, stretch, state)
    real(wp), intent(in) :: c(0:6)
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state
    real(wp) :: mu, pressed
    integer :: i

    !$omp simd private(mu, pressed)
    do i = 1, chunk_size
      mu = -stretch(i)/(1.0_wp + stretch(i))
      pressed = max(0.0_wp, mu)
      state%a(i) = c(0) + mu*(c(1) + c(2)*pressed + c(3)*mu*mu)
      state%a_slope(i) = c(1) + 2.0_wp*c(2)*pressed + 3.0_wp*c(3)*mu*mu
      state%b(i) = c(4) + mu*(c(5) + c(6)*pressed)
      state%b_slope(i) = c(5) + 2.0_wp*c(6)*pressed
    end do
  end subroutine form_linear_polynomial

  !> p = -K ln(v), without energy: the pressure of laws that have no equation of state.
  pure subroutine form_logarithmic(stiffness, stretch, state)
    real(wp), intent(in) :: stiffness           !! K
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state
    real(wp), parameter :: least = -1.0_wp + epsilon(1.0_wp)
    real(wp), dimension(chunk_size) :: safe, logarithm
    integer :: i

    safe = max(least, stretch)
    call form_log_ratios(chunk_size, safe, logarithm)
    !$omp simd
    do i = 1, chunk_size
      state%a(i) = -stiffness*merge(logarithm(i), -huge(1.0_wp)**0.25_wp, stretch(i) > -1.0_wp)
      state%a_slope(i) = stiffness*(1.0_wp + stretch(i))
      state%b(i) = 0.0_wp
      state%b_slope(i) = 0.0_wp
    end do
  end subroutine form_logarithmic

end module volumetric_m
