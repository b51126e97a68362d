! SPDX-License-Identifier: MIT
!> Pressure with a memory: one chunk of elements of a material that has an equation of state.
!> Energy, pressure and volume are kept once for each element; full integration has mean dilatation.
module eos_pressure_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t
  use eos_dispatch_m, only : eos_chunk_t, form_eos, advance_energy, find_stiffness
  use eos_m, only : eos_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_dispatch_m, only : find_failed, break_points, history_size
  use parts_m, only : hourglass_t, material_t, may_fail, spall_pressure, spall_stress
  use quad_points_m, only : n_point
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: n_eos_value, load_eos_state, form_eos_pressure, take_present, finish_limits, &
    form_viscous_pressure, is_too_dense, look_for_failed

  !> Values of each element: energy, pressure, V/V0 - 1, bulk viscosity, speed of sound squared.
  integer, parameter :: n_eos_value = 5
  !> The speed of sound is never told below this share of that of the undeformed body.
  real(wp), parameter :: least_share = 1.0e-3_wp

contains

  !> Mean stress at the start of the step, and volume in its middle, for laws that ask.
  pure subroutine load_eos_state(i_chunk, ratio, elements, stress)
    integer, intent(in) :: i_chunk
    real(wp), intent(in) :: ratio(chunk_size) !! V/V0 of the point
    type(block_state_t), intent(in) :: elements
    type(stress_chunk_t), intent(inout) :: stress
    integer :: first

    first = elements%eos_start(i_chunk)
    stress%mean = -elements%eos_state(first + chunk_size:first + 2*chunk_size - 1)
    stress%ratio = ratio
  end subroutine load_eos_state

  !> Energy and pressure at the end of the step, bulk viscosity included, whose work heats; points
  !> that have failed have none. `now` has the stiffest element's moduli.
  pure subroutine form_eos_pressure(i_chunk, material, viscosity, inverse_start, elements, chunk, &
    now)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity            !! its Q1 and Q2 count
    real(wp), intent(in) :: inverse_start(chunk_size)     !! 1/V0
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk         !! pressure out (tension positive)
    type(material_t), intent(out) :: now
    type(eos_chunk_t) :: state
    real(wp), dimension(chunk_size) :: energy, pressure, growth, heat, least, most, q, &
      stiffness
    logical :: failed(chunk_size), keeps_pressure
    integer :: first

    first = elements%eos_start(i_chunk)
    energy = elements%eos_state(first:first + chunk_size - 1)
    pressure = elements%eos_state(first + chunk_size:first + 2*chunk_size - 1)
    growth = chunk%stretch - elements%eos_state(first + 2*chunk_size:first + 3*chunk_size - 1)
    call form_eos(material%eos, chunk%stretch, state)
    call form_viscous_pressure(viscosity, material%density, elements%eos_state(first &
      + 4*chunk_size), chunk, q)
    call look_for_failed(i_chunk, material, elements, failed, keeps_pressure)
    least = -huge(1.0_wp)
    most = huge(1.0_wp)
    if (material%spall == spall_pressure) least = material%cutoff
    where (failed) least = 0.0_wp
    if (.not. keeps_pressure) then
      where (failed)
        most = 0.0_wp
        q = 0.0_wp
      end where
    end if
    ! The work of the forces of viscosity, which are those of the two ends of the step.
    heat = chunk%heat*inverse_start - 0.5_wp*growth*(q + elements%eos_state(first + 3*chunk_size: &
      first + 4*chunk_size - 1))
    call advance_energy(state, growth, heat, least, most, energy, pressure)
    call look_for_spall(i_chunk, material, pressure, elements)
    call find_stiffness(state, chunk%stretch, energy, pressure, stiffness)
    call stiffen(material, stiffness, 1.0_wp + chunk%stretch, now)
    chunk%pressure = -(pressure + q)
    elements%eos_state(first:first + chunk_size - 1) = energy
    elements%eos_state(first + chunk_size:first + 2*chunk_size - 1) = pressure
    elements%eos_state(first + 2*chunk_size:first + 3*chunk_size - 1) = chunk%stretch
    elements%eos_state(first + 3*chunk_size:first + 4*chunk_size - 1) = q
    elements%eos_state(first + 4*chunk_size:first + 5*chunk_size - 1) = (stiffness &
      + 4.0_wp*material%shear/3.0_wp)*(1.0_wp + chunk%stretch)/material%density
  end subroutine form_eos_pressure

  !> Bulk viscosity (see `bulk_viscosity`) with the speed of sound that each element had before.
  pure subroutine form_viscous_pressure(viscosity, initial_density, speed_squared, chunk, q)
    type(hourglass_t), intent(in) :: viscosity
    real(wp), intent(in) :: initial_density
    real(wp), intent(in) :: speed_squared(chunk_size)
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: q(chunk_size)
    real(wp) :: length, rate, density, speed
    integer :: i

    q = 0.0_wp
    if (.not. (viscosity%quadratic > 0.0_wp .or. viscosity%linear > 0.0_wp)) return
    !$omp simd private(length, rate, density, speed)
    do i = 1, chunk_size
      length = sqrt(abs(chunk%area(i)))
      rate = min(0.0_wp, chunk%trace(i))
      density = initial_density/(1.0_wp + chunk%stretch(i))
      speed = sqrt(speed_squared(i))
      q(i) = density*length*rate*(viscosity%quadratic*length*rate - viscosity%linear*speed)
    end do
  end subroutine form_viscous_pressure

  !> Elements all of whose points have failed; how many points have is kept.
  pure subroutine look_for_failed(i_chunk, material, elements, failed, keeps_pressure)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(block_state_t), intent(inout) :: elements
    logical, intent(out) :: failed(chunk_size), keeps_pressure
    logical :: one(chunk_size)
    integer :: k, n, n_failed

    failed = .false.
    keeps_pressure = .false.
    if (.not. may_fail(material)) return
    n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
    failed = .true.
    n_failed = 0
    do k = 1, n
      call find_failed(material, elements%history(elements%history_start(i_chunk) &
        + (k - 1)*chunk_size*history_size(material)), one, keeps_pressure)
      failed = failed .and. one
      n_failed = n_failed + count(one)
    end do
    elements%n_failed(i_chunk) = n_failed
  end subroutine look_for_failed

  !> Elements that break by tension: all their points, from the next step on.
  pure subroutine look_for_spall(i_chunk, material, pressure, elements)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: pressure(chunk_size)
    type(block_state_t), intent(inout) :: elements
    real(wp) :: largest(chunk_size)
    logical :: broken(chunk_size)
    integer :: k, n, first

    if (material%spall == spall_pressure) return
    largest = 0.0_wp
    if (material%spall == spall_stress) then
      first = (i_chunk - 1)*chunk_size + 1
      associate (s => elements%deviator(first:first + chunk_size - 1, :))
        largest = max(0.5_wp*(s(:, 1) + s(:, 2)) + sqrt(0.25_wp*(s(:, 1) - s(:, 2))**2 &
          + s(:, 3)**2), -(s(:, 1) + s(:, 2)))
      end associate
    end if
    broken = largest - pressure > -material%cutoff
    if (.not. any(broken)) return
    n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
    do k = 1, n
      call break_points(broken, elements%history(elements%history_start(i_chunk) &
        + (k - 1)*chunk_size*history_size(material)))
    end do
  end subroutine look_for_spall

  !> The material with the moduli of the stiffest of some elements, as far as stable steps ask.
  pure subroutine stiffen(material, stiffness, ratio, now)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: stiffness(chunk_size), ratio(chunk_size) !! adiabatic bulk modulus, V/V0
    type(material_t), intent(inout) :: now

    now%density = material%density
    now%shear = material%shear
    now%poisson = 0.5_wp ! mean dilatation
    now%bulk = max(maxval(stiffness), least_share**2*material%bulk)
    now%sound_speed = max(sqrt(maxval((stiffness + 4.0_wp*material%shear/3.0_wp)*ratio) &
      /material%density), least_share*material%sound_speed)
  end subroutine stiffen

  !> The same of one element as its memory has it; those of the material where it has none.
  pure subroutine take_present(material, elements, i_slot, now)
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_slot
    type(material_t), intent(out) :: now
    type(eos_chunk_t) :: state
    real(wp), dimension(chunk_size) :: energy, pressure, stretch, stiffness
    integer :: first

    now%law = material%law
    now%viscosity = material%viscosity
    if (.not. allocated(material%eos)) then
      now%density = material%density
      now%bulk = material%bulk
      now%shear = material%shear
      now%poisson = material%poisson
      now%sound_speed = material%sound_speed
      return
    end if
    first = elements%eos_start((i_slot - 1)/chunk_size + 1) + mod(i_slot - 1, chunk_size)
    energy = elements%eos_state(first)
    pressure = elements%eos_state(first + chunk_size)
    stretch = elements%eos_state(first + 2*chunk_size)
    call form_eos(material%eos, stretch, state)
    call find_stiffness(state, stretch, energy, pressure, stiffness)
    call stiffen(material, stiffness, 1.0_wp + stretch, now)
  end subroutine take_present

  !> Limits of a chunk whose pressure has a memory: the step that a viscous fluid allows, and no
  !> volume where the pressure of some element has no bound.
  pure subroutine finish_limits(material, now, stretch, step, volume)
    type(material_t), intent(in) :: material
    type(material_t), intent(in) :: now
    real(wp), intent(in) :: stretch(chunk_size) !! V/V0 - 1
    real(wp), intent(inout) :: step, volume     !! smallest of the chunk

    if (material%viscosity > 0.0_wp) step = viscous_fluid_step(material, now, 1.0_wp &
      + maxval(stretch), step)
    if (any(is_too_dense(material%eos, stretch))) volume = 0.0_wp
  end subroutine finish_limits

  !> Whether the pressure of an equation of state has next to no bound at v = 1 + stretch.
  pure elemental function is_too_dense(eos, stretch) result(yes)
    type(eos_t), intent(in) :: eos
    real(wp), intent(in) :: stretch
    logical :: yes

    yes = 1.0_wp + stretch < eos%least_ratio
  end function is_too_dense

  !> Step of a viscous fluid from that without viscosity, L/c: damping of the shortest waves by
  !> 4/3 of the viscosity, L/(Q + sqrt(Q^2 + c^2)) with Q = 4/3 viscosity/(rho L).
  pure function viscous_fluid_step(material, now, largest_ratio, step) result(limit)
    type(material_t), intent(in) :: material
    type(material_t), intent(in) :: now
    real(wp), intent(in) :: largest_ratio !! V/V0, thins the fluid most
    real(wp), intent(in) :: step
    real(wp) :: limit
    real(wp) :: damping

    damping = 4.0_wp*material%viscosity*largest_ratio/(3.0_wp*material%density*now%sound_speed**2 &
      *step)
    limit = step/(damping + sqrt(damping**2 + 1.0_wp))
  end function viscous_fluid_step

end module eos_pressure_m
