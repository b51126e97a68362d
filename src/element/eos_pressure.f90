! SPDX-License-Identifier: MIT
!> Pressure of materials that have more than K ln J, of one chunk: of an equation of state, or of
!> the law itself, of rubber or of crushable foam. Energy, pressure and volume are kept once for
!> each element; all its points share one pressure and one dilatation, and the pressure of a law is
!> the mean of theirs over the initial volume.
module eos_pressure_m
  use block_state_m, only : block_state_t
  use deformation_gradient_m, only : form_gradient, form_round_gradient
  use element_chunk_m, only : element_chunk_t
  use eos_dispatch_m, only : eos_chunk_t, form_eos, advance_energy, find_stiffness
  use eos_m, only : eos_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_dispatch_m, only : find_failed, break_points, history_size
  use parts_m, only : hourglass_t, material_t, gives_pressure, may_fail, spall_pressure, &
    spall_stress
  use quad_points_m, only : n_point
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: n_eos_value, n_law_value, load_point_state, start_point_values, add_point_values, &
    form_element_pressure, form_shared_pressure, take_now, finish_limits, is_too_dense, &
    look_for_failed

  !> Values of each element: energy, pressure, V/V0 - 1, bulk viscosity, speed of sound squared.
  integer, parameter :: n_eos_value = 5
  !> The speed of sound is never told below this share of that of the undeformed body.
  real(wp), parameter :: least_share = 1.0e-3_wp
  !> The same of a law: energy, pressure, V/V0 - 1, bulk viscosity, bulk and shear modulus.
  integer, parameter :: n_law_value = 6

contains

  !> What a law must know of a point of a material whose pressure has a memory or comes from the
  !> law: with an equation of state the mean stress at the start of the step and the
  !> volume in its middle, else F and both volumes.
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
    stress%former = elements%eos_state(first:first + chunk_size - 1)
    stress%stretch = chunk%stretch
    if (point%is_round) then
      call form_round_gradient(point, stress)
    else
      call form_gradient(point, stress)
    end if
  end subroutine load_point_state

  !> No point has been summed yet.
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

  !> What the law has left for one of several points. F of rubber is scaled to the dilatation of the
  !> element: what that adds to the second derivative of the energy is at most |s| L:L beside a
  !> lambda not below two thirds of the mean stress (doc/theory/elements.md).
  pure subroutine add_point_values(material, point, stress, chunk)
    type(material_t), intent(in) :: material
    type(element_chunk_t), intent(in) :: point !! its volumes are those that it stands for
    type(stress_chunk_t), intent(inout) :: stress
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: lame
    integer :: i

    chunk%heat = chunk%heat + stress%work*point%mid_area
    if (.not. gives_pressure(material)) return
    if (allocated(material%rubber)) then
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

  !> What the law has left, for its share of the initial volume.
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

  !> Pressure and energy of a one-point element, whether of its equation of state or of its law.
  pure subroutine form_element_pressure(i_chunk, material, viscosity, inverse_start, stress, &
    elements, chunk, now)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity
    real(wp), intent(in) :: inverse_start(chunk_size) !! 1/V0
    type(stress_chunk_t), intent(in) :: stress
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk     !! pressure out (tension positive)
    type(material_t), intent(out) :: now

    call start_point_values(material, chunk)
    chunk%heat = stress%work*chunk%mid_area
    if (gives_pressure(material)) call add_law_values(material, 1.0_wp/inverse_start, stress, chunk)
    call form_shared_pressure(i_chunk, material, viscosity, inverse_start, elements, chunk, now)
  end subroutine form_element_pressure

  !> The same where several points have been summed.
  pure subroutine form_shared_pressure(i_chunk, material, viscosity, inverse_start, elements, &
    chunk, now)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity
    real(wp), intent(in) :: inverse_start(chunk_size)
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(material_t), intent(out) :: now

    if (gives_pressure(material)) then
      call form_law_pressure(i_chunk, material, viscosity, inverse_start, elements, chunk, now)
    else
      call form_eos_pressure(i_chunk, material, viscosity, inverse_start, elements, chunk, now)
    end if
  end subroutine form_shared_pressure

  !> Pressure and energy at the end of the step, bulk viscosity apart from the energy. `now` has the
  !> stiffest element's moduli.
  pure subroutine form_law_pressure(i_chunk, material, viscosity, inverse_start, elements, chunk, &
    now)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity        !! its Q1 and Q2 count
    real(wp), intent(in) :: inverse_start(chunk_size) !! 1/V0
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk     !! pressure out (tension positive)
    type(material_t), intent(out) :: now
    real(wp), dimension(chunk_size) :: pressure, growth, speed_squared, q
    integer :: first

    first = elements%eos_start(i_chunk)
    pressure = -chunk%law_mean*inverse_start
    associate (last => first + chunk_size - 1, values => elements%eos_state)
      growth = chunk%stretch - values(first + 2*chunk_size:last + 2*chunk_size)
      speed_squared = (max(material%bulk, values(first + 4*chunk_size:last + 4*chunk_size)) &
        + 4.0_wp*max(material%shear, values(first + 5*chunk_size:last + 5*chunk_size))/3.0_wp) &
        *(1.0_wp + chunk%stretch)/material%density
      call form_viscous_pressure(viscosity, material%density, speed_squared, chunk, q)
      ! The forces of viscosity are those of the two ends of the step; what they do is no strain.
      elements%viscous_work(i_chunk) = elements%viscous_work(i_chunk) - sum(0.5_wp*growth*(q &
        + values(first + 3*chunk_size:last + 3*chunk_size))/inverse_start)
      if (allocated(material%rubber)) then
        values(first:last) = chunk%law_energy*inverse_start
      else
        values(first:last) = values(first:last) + chunk%heat*inverse_start - 0.5_wp*growth &
          *(pressure + values(first + chunk_size:last + chunk_size))
      end if
      values(first + chunk_size:last + chunk_size) = pressure
      values(first + 2*chunk_size:last + 2*chunk_size) = chunk%stretch
      values(first + 3*chunk_size:last + 3*chunk_size) = q
      values(first + 4*chunk_size:last + 4*chunk_size) = chunk%law_bulk
      values(first + 5*chunk_size:last + 5*chunk_size) = chunk%law_shear
    end associate
    chunk%pressure = -(pressure + q)
    call stiffen_by_law(material, maxval(chunk%law_bulk), maxval(chunk%law_shear), &
      maxval(chunk%stretch), now)
  end subroutine form_law_pressure

  !> The material with present moduli, as far as stable steps ask; never softer than at the start,
  !> which hourglass control and the linear viscosity count with.
  pure subroutine stiffen_by_law(material, bulk, shear, stretch, now)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: bulk, shear, stretch
    type(material_t), intent(inout) :: now

    now%density = material%density
    now%poisson = 0.5_wp ! mean dilatation
    now%shear = max(shear, material%shear)
    now%bulk = max(bulk, material%bulk)
    now%sound_speed = sqrt((now%bulk + 4.0_wp*now%shear/3.0_wp)*(1.0_wp + max(0.0_wp, stretch)) &
      /material%density)
  end subroutine stiffen_by_law

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

  !> Bulk viscosity (see `viscous_stress`) with the speed of sound that each element had before.
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

  !> The material with the moduli that the element in a slot has now; the material itself where its
  !> moduli do not change.
  pure subroutine take_now(material, elements, i_slot, now)
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
    if (gives_pressure(material)) then
      call stiffen_by_law(material, elements%eos_state(first + 4*chunk_size), &
        elements%eos_state(first + 5*chunk_size), stretch(1), now)
      return
    end if
    call form_eos(material%eos, stretch, state)
    call find_stiffness(state, stretch, energy, pressure, stiffness)
    call stiffen(material, stiffness, 1.0_wp + stretch, now)
  end subroutine take_now

  !> Limits of a chunk whose pressure has a memory: the step that a viscous fluid allows, and no
  !> volume where the pressure of some element has no bound.
  pure subroutine finish_limits(material, now, stretch, step, volume)
    type(material_t), intent(in) :: material
    type(material_t), intent(in) :: now
    real(wp), intent(in) :: stretch(chunk_size) !! V/V0 - 1
    real(wp), intent(inout) :: step, volume     !! smallest of the chunk
    real(wp) :: damping

    if (material%viscosity > 0.0_wp) then
      ! Damping of the shortest waves by 4/3 of the viscosity: L/(Q + sqrt(Q^2 + c^2)) with
      ! Q = 4/3 viscosity/(rho L); the largest volume thins the fluid most.
      damping = 4.0_wp*material%viscosity*(1.0_wp + maxval(stretch)) &
        /(3.0_wp*material%density*now%sound_speed**2*step)
      step = step/(damping + sqrt(damping**2 + 1.0_wp))
    end if
    if (any(is_too_dense(material%eos, stretch))) volume = 0.0_wp
  end subroutine finish_limits

  !> Whether the pressure of an equation of state has next to no bound at v = 1 + stretch.
  pure elemental function is_too_dense(eos, stretch) result(yes)
    type(eos_t), intent(in) :: eos
    real(wp), intent(in) :: stretch
    logical :: yes

    yes = 1.0_wp + stretch < eos%least_ratio
  end function is_too_dense

end module eos_pressure_m
