! SPDX-License-Identifier: MIT
!> Pressure that the law of a material gives itself: one chunk of rubber or of crushable foam. As
!> with equations of state all points of an element share one pressure and one dilatation; the
!> pressure is the mean of theirs over the initial volume.
module law_pressure_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t
  use eos_pressure_m, only : form_viscous_pressure
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : hourglass_t, material_t
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: n_law_value, load_law_state, start_law_values, add_law_values, add_point_values, &
    form_law_pressure, take_law_present

  !> Values of each element: energy, pressure, V/V0 - 1, bulk viscosity, bulk and shear modulus.
  integer, parameter :: n_law_value = 6

contains

  !> Volume of the element at both ends of the step.
  pure subroutine load_law_state(i_chunk, chunk, elements, stress)
    integer, intent(in) :: i_chunk
    type(element_chunk_t), intent(in) :: chunk
    type(block_state_t), intent(in) :: elements
    type(stress_chunk_t), intent(inout) :: stress
    integer :: first

    first = elements%eos_start(i_chunk) + 2*chunk_size
    stress%former = elements%eos_state(first:first + chunk_size - 1)
    stress%stretch = chunk%stretch
  end subroutine load_law_state

  !> No point has been summed yet.
  pure subroutine start_law_values(chunk)
    type(element_chunk_t), intent(inout) :: chunk

    chunk%law_mean = 0.0_wp
    chunk%law_energy = 0.0_wp
    chunk%law_bulk = 0.0_wp
    chunk%law_shear = 0.0_wp
  end subroutine start_law_values

  !> What the law has left for one point.
  pure subroutine add_law_values(start, material, stress, chunk)
    real(wp), intent(in) :: start(chunk_size) !! initial volume of the point
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: chunk

    chunk%law_mean = chunk%law_mean + start*stress%mean
    if (allocated(material%rubber)) chunk%law_energy = chunk%law_energy &
      + start*stress%energy
    chunk%law_bulk = max(chunk%law_bulk, stress%bulk)
    chunk%law_shear = max(chunk%law_shear, stress%shear)
  end subroutine add_law_values

  !> The same where elements have several points, whose F is scaled to the dilatation of the element:
  !> what that adds to the second derivative of the energy is at most |s| L:L beside a lambda not
  !> below two thirds of the mean stress (doc/theory/elements.md, "Deformation gradient").
  pure subroutine add_point_values(start, material, stress, chunk)
    real(wp), intent(in) :: start(chunk_size)
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(inout) :: stress
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: lame
    integer :: i

    if (allocated(material%rubber)) then
      !$omp simd private(lame)
      do i = 1, chunk_size
        lame = max(stress%bulk(i) - 2.0_wp*stress%shear(i)/3.0_wp, 2.0_wp*stress%mean(i)/3.0_wp)
        stress%shear(i) = stress%shear(i) + 0.5_wp*sqrt(2.0_wp*(stress%sxx(i)**2 &
          + stress%syy(i)**2 + stress%sxx(i)*stress%syy(i) + stress%sxy(i)**2))
        stress%bulk(i) = lame + 2.0_wp*stress%shear(i)/3.0_wp
      end do
    end if
    call add_law_values(start, material, stress, chunk)
  end subroutine add_point_values

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

  !> The same of one element as its memory has it.
  pure subroutine take_law_present(material, elements, i_slot, now)
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_slot
    type(material_t), intent(out) :: now
    integer :: first

    first = elements%eos_start((i_slot - 1)/chunk_size + 1) + mod(i_slot - 1, chunk_size)
    call stiffen(material, elements%eos_state(first + 4*chunk_size), &
      elements%eos_state(first + 5*chunk_size), elements%eos_state(first + 2*chunk_size), now)
  end subroutine take_law_present

end module law_pressure_m
