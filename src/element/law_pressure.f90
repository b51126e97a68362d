! SPDX-License-Identifier: MIT
!> Pressure of materials that have more than K ln J: of an equation of state (`eos_pressure`), or of
!> the law itself, one chunk of rubber or of crushable foam. All points of an element share one
!> pressure and one dilatation; the pressure of a law is the mean of theirs over the initial volume.
module law_pressure_m
  use block_state_m, only : block_state_t
  use deformation_gradient_m, only : form_gradient, form_round_gradient
  use element_chunk_m, only : element_chunk_t
  use eos_pressure_m, only : form_eos_pressure, form_viscous_pressure, load_eos_state, &
    take_present
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : hourglass_t, material_t, gives_pressure
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: n_law_value, load_point_state, start_point_values, add_point_values, &
    form_element_pressure, form_shared_pressure, take_now

  !> Values of each element: energy, pressure, V/V0 - 1, bulk viscosity, bulk and shear modulus.
  integer, parameter :: n_law_value = 6

contains

  !> What a law must know of a point of a material whose pressure has a memory or comes from the
  !> law: with an equation of state what `load_eos_state` says, else F and both volumes.
  pure subroutine load_point_state(i_chunk, material, ratio, chunk, point, elements, stress)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: ratio(chunk_size)   !! V/V0 of the point in the middle of the step
    type(element_chunk_t), intent(in) :: chunk  !! of the element
    type(element_chunk_t), intent(in) :: point  !! of the point
    type(block_state_t), intent(in) :: elements
    type(stress_chunk_t), intent(inout) :: stress
    integer :: first

    if (.not. gives_pressure(material)) then
      call load_eos_state(i_chunk, ratio, elements, stress)
      return
    end if
    first = elements%eos_start(i_chunk) + 2*chunk_size
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
    if (gives_pressure(material)) call start_law_values(chunk)
  end subroutine start_point_values

  !> Nothing of a law has been summed yet.
  pure subroutine start_law_values(chunk)
    type(element_chunk_t), intent(inout) :: chunk

    chunk%law_mean = 0.0_wp
    chunk%law_energy = 0.0_wp
    chunk%law_bulk = 0.0_wp
    chunk%law_shear = 0.0_wp
  end subroutine start_law_values

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

    chunk%heat = stress%work*chunk%mid_area
    if (gives_pressure(material)) then
      call start_law_values(chunk)
      call add_law_values(material, 1.0_wp/inverse_start, stress, chunk)
    end if
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
    call stiffen(material, maxval(chunk%law_bulk), maxval(chunk%law_shear), &
      maxval(chunk%stretch), now)
  end subroutine form_law_pressure

  !> The material with present moduli, as far as stable steps ask; never softer than at the start,
  !> which hourglass control and the linear viscosity count with.
  pure subroutine stiffen(material, bulk, shear, stretch, now)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: bulk, shear, stretch
    type(material_t), intent(inout) :: now

    now%density = material%density
    now%poisson = 0.5_wp ! mean dilatation
    now%shear = max(shear, material%shear)
    now%bulk = max(bulk, material%bulk)
    now%sound_speed = sqrt((now%bulk + 4.0_wp*now%shear/3.0_wp)*(1.0_wp + max(0.0_wp, stretch)) &
      /material%density)
  end subroutine stiffen

  !> The material with the moduli that the element in a slot has now; the material itself where its
  !> moduli do not change.
  pure subroutine take_now(material, elements, i_slot, now)
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_slot
    type(material_t), intent(out) :: now
    integer :: first

    if (.not. gives_pressure(material)) then
      call take_present(material, elements, i_slot, now)
      return
    end if
    first = elements%eos_start((i_slot - 1)/chunk_size + 1) + mod(i_slot - 1, chunk_size)
    call stiffen(material, elements%eos_state(first + 4*chunk_size), &
      elements%eos_state(first + 5*chunk_size), elements%eos_state(first + 2*chunk_size), now)
  end subroutine take_now

end module law_pressure_m
