! SPDX-License-Identifier: MIT
!> Pressure of one chunk for materials beyond K ln J: from an equation of state, or from the law
!> itself (rubber, crushable foam). Energy, pressure and volume are stored once per element; all its
!> points share one pressure and one dilatation, and the pressure of a law is the mean over the
!> initial volume.
module eos_pressure_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_dispatch_m, only : find_failed, column_damage, history_size
  use parts_m, only : hourglass_t, material_t, gives_pressure, may_fail, spall_pressure, &
    spall_stress, condensed_bulk
  use plane_stress_m, only : n_law_value
  use quad_kinematics_m, only : form_gradient
  use quad_points_m, only : n_point
  use stable_step_m, only : moduli_t, moduli_of
  use stress_chunk_m, only : stress_chunk_t
  use volumetric_m, only : eos_chunk_t, form_eos, advance_energy, find_stiffness
  implicit none
  private
  public :: n_eos_value, load_point_state, start_point_values, add_point_values, &
    add_law_values, form_shared_pressure, present_moduli, finish_limits, &
    find_failed_elements

  !> Values of each element with an equation of state: energy, pressure, V/V0 - 1, bulk viscosity,
  !> speed of sound squared.
  integer, parameter :: n_eos_value = 5
  !> Lower bound of the speed of sound, as a share of that of the undeformed material.
  real(wp), parameter :: least_share = 1.0e-3_wp

contains

  !> Set the data of a point for a law: with an equation of state the mean stress at the start of
  !> the step and the volume in its middle, else F and the volumes at both ends.
  pure subroutine load_point_state(i_chunk, material, ratio, chunk, point, elements, stress)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: ratio(chunk_size)   !! V/V0 of the point in the middle of the step
    type(element_chunk_t), intent(in) :: chunk  !! of the element
    type(element_chunk_t), intent(in) :: point  !! of the point
    type(block_state_t), intent(in) :: elements
    type(stress_chunk_t), intent(inout) :: stress
    integer :: first

    first = elements%eos_start(i_chunk)
    if (.not. gives_pressure(material)) then
      stress%mean = -elements%eos_state(first + chunk_size:first + 2*chunk_size - 1)
      stress%ratio = ratio
      return
    end if
    first = first + 2*chunk_size
    stress%start_stretch = elements%eos_state(first:first + chunk_size - 1)
    stress%stretch = chunk%stretch
    if (material%is_plane_stress) then
      if (.not. allocated(material%rubber)) return
      stress%stretch = point%stretch
    end if
    call form_gradient(point, stress)
  end subroutine load_point_state

  !> Initialise the sums over the points.
  pure subroutine start_point_values(material, chunk)
    type(material_t), intent(in) :: material
    type(element_chunk_t), intent(inout) :: chunk

    chunk%heat = 0.0_wp
    if (.not. gives_pressure(material)) return
    chunk%law_mean = 0.0_wp
    chunk%law_energy = 0.0_wp
    chunk%law_bulk = 0.0_wp
    chunk%law_shear = 0.0_wp
  end subroutine start_point_values

  !> Add the results of the law for one of several points. F of rubber is scaled to the dilatation
  !> of the element: this adds at most |s| L:L to the second derivative of the energy, beside a
  !> lambda of at least two thirds of the mean stress (doc/theory/elements.md).
  pure subroutine add_point_values(material, point, stress, chunk)
    type(material_t), intent(in) :: material
    type(element_chunk_t), intent(in) :: point !! with its own volumes
    type(stress_chunk_t), intent(inout) :: stress
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: lame
    integer :: i

    chunk%heat = chunk%heat + stress%work*point%mid_area
    if (.not. gives_pressure(material)) return
    if (allocated(material%rubber) .and. .not. material%is_plane_stress) then
      !$omp simd private(lame)
      do i = 1, chunk_size
        lame = max(stress%bulk(i) - 2.0_wp*stress%shear(i)/3.0_wp, 2.0_wp*stress%mean(i)/3.0_wp)
        stress%shear(i) = stress%shear(i) + 0.5_wp*sqrt(2.0_wp*(stress%sxx(i)**2 &
          + stress%syy(i)**2 + stress%sxx(i)*stress%syy(i) + stress%sxy(i)**2))
        stress%bulk(i) = lame + 2.0_wp*stress%shear(i)/3.0_wp
      end do
    end if
    call add_law_values(material, point%volume/(1.0_wp + point%stretch), stress, chunk)
  end subroutine add_point_values

  !> Add the results of the law, weighted with the initial volume.
  pure subroutine add_law_values(material, start, stress, chunk)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: start(chunk_size) !! initial volume of the point
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: chunk

    chunk%law_mean = chunk%law_mean + start*stress%mean
    if (allocated(material%rubber)) chunk%law_energy = chunk%law_energy + start*stress%energy
    chunk%law_bulk = max(chunk%law_bulk, stress%bulk)
    chunk%law_shear = max(chunk%law_shear, stress%shear)
  end subroutine add_law_values

  !> Pressure and energy shared by the points of an element, from the sums over them.
  pure subroutine form_shared_pressure(i_chunk, material, viscosity, inverse_start, elements, &
    chunk, now)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity        !! its Q1 and Q2 count
    real(wp), intent(in) :: inverse_start(chunk_size) !! 1/V0
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk     !! pressure out (tension positive)
    type(moduli_t), intent(inout) :: now              !! moduli of the stiffest element out
    real(wp) :: start(chunk_size)
    logical :: failed(chunk_size), keeps_pressure
    integer :: first

    first = elements%eos_start(i_chunk)
    if (gives_pressure(material)) then
      if (may_fail(material)) call find_failed_elements(i_chunk, material, elements, failed, &
        keeps_pressure)
      call form_law_pressure(material, viscosity, inverse_start, elements%eos_state(first), &
        elements%viscous_work(i_chunk), chunk, now)
    else
      call find_failed_elements(i_chunk, material, elements, failed, keeps_pressure)
      start = 0.0_wp
      if (allocated(elements%start_dilatation)) start = elements%start_dilatation((i_chunk &
        - 1)*chunk_size + 1:i_chunk*chunk_size, 1)
      chunk%heat = chunk%heat*inverse_start
      call form_eos_pressure(material, viscosity, failed, keeps_pressure, start, &
        elements%eos_state(first), chunk, now)
      call apply_spall(i_chunk, material, elements)
    end if
  end subroutine form_shared_pressure

  !> Pressure and energy at the end of the step, with bulk viscosity separate from the energy.
  pure subroutine form_law_pressure(material, viscosity, inverse_start, values, viscous_work, &
    chunk, now)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity
    real(wp), intent(in) :: inverse_start(chunk_size) !! 1/V0
    real(wp), intent(inout) :: values(chunk_size, n_law_value)
    real(wp), intent(inout) :: viscous_work
    type(element_chunk_t), intent(inout) :: chunk
    type(moduli_t), intent(inout) :: now
    real(wp), dimension(chunk_size) :: pressure, growth, speed_squared, q, bulk, shear

    pressure = -chunk%law_mean*inverse_start
    growth = chunk%stretch - values(:, 3)
    bulk = max(material%bulk, values(:, 5))
    shear = max(material%shear, values(:, 6))
    if (material%is_plane_stress) bulk = condensed_bulk(bulk, shear)
    speed_squared = (bulk + 4.0_wp*shear/3.0_wp)*(1.0_wp + chunk%stretch)/material%density
    call form_viscous_pressure(viscosity, material%density, speed_squared, chunk, q)
    ! Viscous forces act at both ends of the step; their work is not strain energy.
    viscous_work = viscous_work - sum(0.5_wp*growth*(q + values(:, 4))/inverse_start)
    if (material%is_plane_stress) then
      values(:, 1) = values(:, 1) + chunk%heat*inverse_start
    else if (allocated(material%rubber)) then
      values(:, 1) = chunk%law_energy*inverse_start
    else
      values(:, 1) = values(:, 1) + chunk%heat*inverse_start - 0.5_wp*growth &
        *(pressure + values(:, 2))
    end if
    values(:, 2) = pressure
    values(:, 3) = chunk%stretch
    values(:, 4) = q
    values(:, 5) = chunk%law_bulk
    values(:, 6) = chunk%law_shear
    chunk%pressure = -(pressure + q)
    ! In plane stress points have their own.
    if (material%is_plane_stress) chunk%pressure = -q
    now = moduli_by_law(material, maxval(chunk%law_bulk), maxval(chunk%law_shear), &
      maxval(chunk%stretch))
  end subroutine form_law_pressure

  !> Present moduli, at least those of the undeformed material, which hourglass control and linear
  !> viscosity use.
  pure function moduli_by_law(material, bulk, shear, stretch) result(now)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: bulk, shear, stretch
    type(moduli_t) :: now

    now = moduli_t(material%density, max(bulk, material%bulk), max(shear, material%shear), 0.0_wp, &
      .true.)
    if (material%is_plane_stress) now%bulk = condensed_bulk(now%bulk, now%shear)
    now%sound_speed = sqrt((now%bulk + 4.0_wp*now%shear/3.0_wp)*(1.0_wp + max(0.0_wp, stretch)) &
      /material%density)
  end function moduli_by_law

  !> Energy and pressure at the end of the step, with bulk viscosity, whose work heats; failed
  !> points have none.
  pure subroutine form_eos_pressure(material, viscosity, failed, keeps_pressure, start, values, &
    chunk, now)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity
    logical, intent(in) :: failed(chunk_size)             !! all points of an element
    logical, intent(in) :: keeps_pressure                 !! in compression
    real(wp), intent(in) :: start(chunk_size)             !! ln(V/V0) of the stage before
    real(wp), intent(inout) :: values(chunk_size, n_eos_value)
    type(element_chunk_t), intent(inout) :: chunk         !! `heat` per initial volume in
    type(moduli_t), intent(inout) :: now
    type(eos_chunk_t) :: state
    real(wp), dimension(chunk_size) :: growth, heat, least, most, q, stiffness

    growth = chunk%stretch - values(:, 3)
    call form_eos(material%eos, chunk%stretch, state)
    state%a = state%a - material%bulk*start
    call form_viscous_pressure(viscosity, material%density, values(:, 5), chunk, q)
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
    ! Work of the viscous forces, which act at both ends of the step.
    heat = chunk%heat - 0.5_wp*growth*(q + values(:, 4))
    call advance_energy(state, growth, heat, least, most, values(:, 1), values(:, 2))
    call find_stiffness(state, chunk%stretch, values(:, 1), values(:, 2), stiffness)
    now = moduli_by_eos(material, stiffness, 1.0_wp + chunk%stretch)
    chunk%pressure = -(values(:, 2) + q)
    values(:, 3) = chunk%stretch
    values(:, 4) = q
    values(:, 5) = (stiffness + 4.0_wp*material%shear/3.0_wp)*(1.0_wp + chunk%stretch) &
      /material%density
  end subroutine form_eos_pressure

  !> Bulk viscosity (see `add_bulk_viscosity`) with the previous speed of sound of each element.
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

  !> Elements with all points failed; updates the number of failed points.
  pure subroutine find_failed_elements(i_chunk, material, elements, failed, keeps_pressure)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(block_state_t), intent(inout) :: elements
    logical, intent(out) :: failed(chunk_size), keeps_pressure
    logical :: one(chunk_size)
    integer :: k, n_failed

    failed = .false.
    keeps_pressure = .false.
    if (.not. may_fail(material)) return
    failed = .true.
    n_failed = 0
    do k = 1, merge(n_point, 1, elements%point_start(i_chunk) > 0)
      call find_failed(material, elements%history(elements%history_start(i_chunk) &
        + (k - 1)*chunk_size*history_size(material)), one, keeps_pressure)
      failed = failed .and. one
      n_failed = n_failed + count(one)
    end do
    elements%n_failed(i_chunk) = n_failed
  end subroutine find_failed_elements

  !> Fail all points of elements that spall, from the next step on.
  pure subroutine apply_spall(i_chunk, material, elements)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(block_state_t), intent(inout) :: elements
    real(wp) :: largest(chunk_size)
    logical :: broken(chunk_size)
    integer :: k, first

    if (material%spall == spall_pressure) return
    largest = 0.0_wp
    if (material%spall == spall_stress) then
      first = (i_chunk - 1)*chunk_size + 1
      associate (s => elements%deviator(first:first + chunk_size - 1, :))
        largest = max(0.5_wp*(s(:, 1) + s(:, 2)) + sqrt(0.25_wp*(s(:, 1) - s(:, 2))**2 &
          + s(:, 3)**2), -(s(:, 1) + s(:, 2)))
      end associate
    end if
    first = elements%eos_start(i_chunk) + chunk_size
    broken = largest - elements%eos_state(first:first + chunk_size - 1) > -material%cutoff
    if (.not. any(broken)) return
    do k = 1, merge(n_point, 1, elements%point_start(i_chunk) > 0)
      first = elements%history_start(i_chunk) + chunk_size*((k - 1)*history_size(material) &
        + column_damage - 1)
      associate (damage => elements%history(first:first + chunk_size - 1))
        where (broken) damage = max(1.0_wp, damage)
      end associate
    end do
  end subroutine apply_spall

  !> Moduli of the stiffest of some elements.
  pure function moduli_by_eos(material, stiffness, ratio) result(now)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: stiffness(chunk_size), ratio(chunk_size) !! adiabatic bulk modulus, V/V0
    type(moduli_t) :: now

    now = moduli_t(material%density, max(maxval(stiffness), least_share**2*material%bulk), &
      material%shear, max(sqrt(maxval((stiffness + 4.0_wp*material%shear/3.0_wp)*ratio) &
      /material%density), least_share*material%sound_speed), .true.)
  end function moduli_by_eos

  !> Present moduli of the element in a slot.
  pure function present_moduli(material, elements, i_slot) result(now)
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_slot
    type(moduli_t) :: now
    type(eos_chunk_t) :: state
    real(wp), dimension(chunk_size) :: energy, pressure, stretch, stiffness
    integer :: first

    now = moduli_of(material)
    if (.not. allocated(material%eos)) return
    first = elements%eos_start((i_slot - 1)/chunk_size + 1) + mod(i_slot - 1, chunk_size)
    energy = elements%eos_state(first)
    pressure = elements%eos_state(first + chunk_size)
    stretch = elements%eos_state(first + 2*chunk_size)
    if (gives_pressure(material)) then
      now = moduli_by_law(material, elements%eos_state(first + 4*chunk_size), &
        elements%eos_state(first + 5*chunk_size), stretch(1))
    else
      call form_eos(material%eos, stretch, state)
      call find_stiffness(state, stretch, energy, pressure, stiffness)
      now = moduli_by_eos(material, stiffness, 1.0_wp + stretch)
    end if
  end function present_moduli

  !> Complete the limits of a chunk with an equation of state or law pressure: the step of a viscous
  !> fluid, and no volume where the pressure is unbounded.
  pure subroutine finish_limits(material, now, stretch, step, volume)
    type(material_t), intent(in) :: material
    type(moduli_t), intent(in) :: now
    real(wp), intent(in) :: stretch(chunk_size) !! V/V0 - 1
    real(wp), intent(inout) :: step, volume     !! smallest of the chunk
    real(wp) :: damping

    if (material%viscosity > 0.0_wp) then
      ! Damping of the shortest waves by 4/3 of the viscosity: L/(Q + sqrt(Q^2 + c^2)) with
      ! Q = 4/3 viscosity/(rho L); the largest volume follows_strain the fluid most.
      damping = 4.0_wp*material%viscosity*(1.0_wp + maxval(stretch)) &
        /(3.0_wp*material%density*now%sound_speed**2*step)
      step = step/(damping + sqrt(damping**2 + 1.0_wp))
    end if
    if (any(1.0_wp + stretch < material%eos%least_ratio)) volume = 0.0_wp
  end subroutine finish_limits

end module eos_pressure_m
