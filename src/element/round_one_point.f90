! SPDX-License-Identifier: MIT
!> One chunk of one-point round quads: from nodal motion to nodal forces, stress updated on the way.
module round_one_point_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use bulk_viscosity_m, only : add_bulk_viscosity
  use deformation_gradient_m, only : form_rubber_forces
  use element_chunk_m, only : element_chunk_t
  use eos_pressure_m, only : finish_limits
  use hourglass_m, only : stop_failed, drop_failed, note_works
  use law_pressure_m, only : load_round_state, form_element_pressure
  use layout_m, only : chunk_size
  use material_dispatch_m, only : update_stress
  use parts_m, only : hourglass_t, material_t, hourglass_viscous, hourglass_assumed
  use round_chunk_m, only : round_chunk_t, gather_round, reference_mass
  use round_hourglass_m, only : form_resistance, form_assumed_resistance, &
    resist_round_viscously, resist_round_elastically, resist_round_by_assumed_strain
  use round_kinematics_m, only : form_round_shape, form_round_increments, form_round_forces
  use round_time_step_m, only : round_step
  use stress_chunk_m, only : stress_chunk_t, load_deviator, store_deviator, work_of_deviator
  use viscous_stress_m, only : viscous_start, add_viscous_deviator, add_viscous_pressure
  use volumetric_m, only : volumetric_stress, largest_size
  implicit none
  private
  public :: advance_round_one_point

contains

  !> Advance one chunk by the step `dt` that led to the present motion (dt = 0: forces only) and
  !> leave its forces, per radian, in `round`.
  pure subroutine advance_round_one_point(i_chunk, nodes, motion, material, hourglass, dt, &
    elements, round)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(round_chunk_t), intent(inout) :: round       !! forces out
    type(element_chunk_t) :: chunk
    type(stress_chunk_t) :: stress
    real(wp) :: work
    integer :: first, n_slot

    first = (i_chunk - 1)*chunk_size + 1
    n_slot = size(elements%reference, 1)
    call gather_round(nodes, motion, chunk, round)
    call form_round_shape(elements%reference(first, 1), n_slot, chunk, round)
    call form_round_increments(dt, chunk, round, stress)
    elements%volume_change(i_chunk) = dt*largest_size(chunk%trace)
    call load_deviator(elements%deviator(first, 1), n_slot, stress)
    if (allocated(material%eos)) call load_round_state(i_chunk, material, chunk%mid_area &
      *(1.0_wp + chunk%stretch)*round%inverse_volume, chunk, round, elements, stress)
    if (elements%history_start(i_chunk) > 0) then
      call update_stress(material, stress, elements%history(elements%history_start(i_chunk)))
    else
      call update_stress(material, stress)
    end if
    call store_deviator(stress, n_slot, elements%deviator(first, 1))
    if (allocated(material%eos)) then
      call finish_with_eos(i_chunk, material, hourglass, stress, round, elements, chunk)
      return
    end if
    elements%deviatoric_work(i_chunk) = elements%deviatoric_work(i_chunk) &
      + work_of_deviator(stress%work, chunk%mid_area)
    call volumetric_stress(material%bulk, chunk%stretch, chunk%pressure)
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) then
      call add_bulk_viscosity(hourglass%quadratic, hourglass%linear, material%density, &
        material%sound_speed, dt, chunk, elements%viscous_pressure(first), work)
      elements%viscous_work(i_chunk) = elements%viscous_work(i_chunk) + work
    end if
    if (allocated(elements%retardation)) then
      associate (n => viscous_start(i_chunk, 1))
        call add_viscous_deviator(material%shear, elements%retardation(first), chunk%mid_area, &
          stress, elements%damping_stress(n), elements%damping_work(i_chunk))
        call add_viscous_pressure(material%bulk, elements%retardation(first), chunk%trace, &
          chunk%mid_area, dt, chunk%pressure, elements%damping_stress(n + 3*chunk_size), &
          elements%damping_work(i_chunk))
      end associate
    end if
    call resist(i_chunk, material, hourglass, stress, round, elements, chunk)
    call form_round_forces(stress, chunk, round)
    call round_step(material, hourglass, elements%reference(first, reference_mass), n_slot, chunk, &
      round, elements%time_limit(i_chunk), elements%volume_limit(i_chunk))
  end subroutine advance_round_one_point

  !> The rest of the step where the pressure has a memory: what else an element does heats it.
  pure subroutine finish_with_eos(i_chunk, material, hourglass, stress, round, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(in) :: stress
    type(round_chunk_t), intent(inout) :: round
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(material_t) :: now
    integer :: first

    first = (i_chunk - 1)*chunk_size + 1
    call form_element_pressure(i_chunk, material, hourglass, (1.0_wp + chunk%stretch) &
      *round%inverse_volume, stress, elements, chunk, now)
    call resist(i_chunk, material, hourglass, stress, round, elements, chunk)
    if (allocated(material%rubber)) then
      call form_rubber_forces(stress, chunk, round)
    else
      call form_round_forces(stress, chunk, round)
    end if
    call round_step(now, hourglass, elements%reference(first, reference_mass), &
      size(elements%reference, 1), chunk, round, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
    call finish_limits(material, now, chunk%stretch, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
  end subroutine finish_with_eos

  !> Hourglass control of one chunk, with its work.
  pure subroutine resist(i_chunk, material, hourglass, stress, round, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(in) :: stress
    type(round_chunk_t), intent(inout) :: round
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: work
    integer :: first

    if (allocated(elements%n_failed)) call stop_failed(i_chunk, material, elements, chunk)
    first = elements%hourglass_start(i_chunk)
    if (hourglass%form == hourglass_assumed) then
      call form_assumed_resistance(material, hourglass, chunk, round)
      call resist_round_by_assumed_strain(material, hourglass, stress, round, &
        elements%hourglass_strain(first), elements%hourglass_strain(first + chunk_size), chunk, &
        work)
    else if (hourglass%form == hourglass_viscous) then
      call form_resistance(material, hourglass, chunk, round)
      call resist_round_viscously(stress%dt, round, elements%hourglass_strain(first), &
        elements%hourglass_strain(first + chunk_size), chunk, work)
    else
      call form_resistance(material, hourglass, chunk, round)
      call resist_round_elastically(stress%dt, stress, round, elements%hourglass_strain(first), &
        elements%hourglass_strain(first + chunk_size), chunk, work)
    end if
    if (allocated(elements%n_failed)) call drop_failed(i_chunk, material, stress%dt, elements, &
      chunk, work)
    elements%hourglass_work(i_chunk) = elements%hourglass_work(i_chunk) + work
    if (allocated(elements%erosion)) call note_works(i_chunk, elements, chunk)
  end subroutine resist

end module round_one_point_m
