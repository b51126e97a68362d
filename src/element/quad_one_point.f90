! SPDX-License-Identifier: MIT
!> One chunk of one-point quads, plane or round: from nodal motion to nodal forces, stress updated
!> on the way.
module quad_one_point_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use deformation_gradient_m, only : form_rubber_forces
  use element_chunk_m, only : element_chunk_t, gather_motion, reference_mass
  use eos_pressure_m, only : finish_limits, load_point_state, form_element_pressure
  use hourglass_m, only : resist
  use layout_m, only : chunk_size
  use material_dispatch_m, only : update_stress
  use model_m, only : model_t
  use parts_m, only : hourglass_t, material_t
  use quad_plain_m, only : is_plain, advance_plain
  use quad_kinematics_m, only : form_shape, form_increments, form_forces, form_round_forces, &
    inverse_start
  use stable_step_m, only : stable_step, axisymmetric_step
  use stress_chunk_m, only : stress_chunk_t, load_deviator, store_deviator, work_of_deviator
  use viscous_stress_m, only : add_bulk_viscosity, viscous_start, add_viscous_deviator, &
    add_viscous_pressure
  use volumetric_m, only : volumetric_stress, largest_size
  implicit none
  private
  public :: advance_one_point

contains

  !> Advance one chunk by the step `dt` that led to the present motion (dt = 0: forces only) and
  !> leave its forces in `chunk`, of round quads per radian.
  pure subroutine advance_one_point(model, i_chunk, nodes, motion, dt, elements, chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk     !! forces out
    type(stress_chunk_t) :: stress
    integer :: first, n_slot

    associate (part => model%parts(model%layout%chunk_part(i_chunk)), material => &
      model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      if (is_plain(model, part, material, elements)) then
        chunk%is_round = .false.
        call advance_plain(i_chunk, nodes, motion, material, part%hourglass%coefficient, dt, &
          elements, chunk)
        return
      end if
      first = (i_chunk - 1)*chunk_size + 1
      n_slot = size(elements%reference, 1)
      call gather_motion(model%is_round, nodes, motion, chunk)
      call form_shape(elements%reference(first, 1), n_slot, chunk)
      call form_increments(dt, chunk, stress)
      elements%volume_change(i_chunk) = dt*largest_size(chunk%trace)
      call load_deviator(elements%deviator(first, 1), n_slot, stress)
      if (allocated(material%eos)) call load_point_state(i_chunk, material, chunk%mid_area &
        *inverse_start(chunk), chunk, chunk, elements, stress)
      if (elements%history_start(i_chunk) > 0) then
        call update_stress(material, stress, elements%history(elements%history_start(i_chunk)))
      else
        call update_stress(material, stress)
      end if
      call store_deviator(stress, n_slot, elements%deviator(first, 1))
      if (allocated(material%eos)) then
        call finish_with_eos(model, i_chunk, nodes, material, part%hourglass, stress, elements, &
          chunk)
        return
      end if
      elements%deviatoric_work(i_chunk) = elements%deviatoric_work(i_chunk) &
        + work_of_deviator(stress%work, chunk%mid_area)
      call volumetric_stress(material%bulk, chunk%stretch, chunk%pressure)
      call add_viscosities(i_chunk, material, part%hourglass, stress, elements, chunk)
      call resist(i_chunk, material, part%hourglass, stress, elements, chunk)
      call form_chunk_forces(material, stress, chunk)
      call limit_chunk(model, i_chunk, nodes, material, part%hourglass, elements, chunk)
    end associate
  end subroutine advance_one_point

  !> Bulk viscosity, and stress of damping by stiffness.
  pure subroutine add_viscosities(i_chunk, material, hourglass, stress, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(inout) :: stress
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: work
    integer :: first

    first = (i_chunk - 1)*chunk_size + 1
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) then
      call add_bulk_viscosity(hourglass%quadratic, hourglass%linear, material%density, &
        material%sound_speed, stress%dt, chunk, elements%viscous_pressure(first), work)
      elements%viscous_work(i_chunk) = elements%viscous_work(i_chunk) + work
    end if
    if (.not. allocated(elements%retardation)) return
    associate (n => viscous_start(i_chunk, 1))
      call add_viscous_deviator(material%shear, elements%retardation(first), chunk%mid_area, &
        stress, elements%damping_stress(n), elements%damping_work(i_chunk))
      call add_viscous_pressure(material%bulk, elements%retardation(first), chunk%trace, &
        chunk%mid_area, stress%dt, chunk%pressure, elements%damping_stress(n + 3*chunk_size), &
        elements%damping_work(i_chunk))
    end associate
  end subroutine add_viscosities

  !> The rest of the step where the pressure has a memory: what else an element does heats it.
  pure subroutine finish_with_eos(model, i_chunk, nodes, material, hourglass, stress, elements, &
    chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(stress_chunk_t), intent(in) :: stress
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(material_t) :: now

    call form_element_pressure(i_chunk, material, hourglass, inverse_start(chunk), stress, &
      elements, chunk, now)
    call resist(i_chunk, material, hourglass, stress, elements, chunk)
    call form_chunk_forces(material, stress, chunk)
    call limit_chunk(model, i_chunk, nodes, now, hourglass, elements, chunk)
    call finish_limits(material, now, chunk%stretch, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
  end subroutine finish_with_eos

  !> Nodal forces, of stress and hourglass control.
  pure subroutine form_chunk_forces(material, stress, chunk)
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: chunk

    if (.not. chunk%is_round) then
      call form_forces(stress, chunk)
    else if (allocated(material%rubber)) then
      call form_rubber_forces(stress, chunk)
    else
      call form_round_forces(stress, chunk)
    end if
  end subroutine form_chunk_forces

  !> Stable step and smallest volume ratio.
  pure subroutine limit_chunk(model, i_chunk, nodes, now, hourglass, elements, chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    type(material_t), intent(in) :: now               !! with its present moduli
    type(hourglass_t), intent(in) :: hourglass
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk

    if (chunk%is_round) then
      call axisymmetric_step(now, hourglass, elements%reference((i_chunk - 1)*chunk_size + 1, &
        reference_mass), size(elements%reference, 1), chunk, elements%time_limit(i_chunk), &
        elements%volume_limit(i_chunk))
    else
      call stable_step(model%controls%length_rule, now%sound_speed, hourglass, nodes, chunk, &
        elements%time_limit(i_chunk), elements%volume_limit(i_chunk))
    end if
  end subroutine limit_chunk

end module quad_one_point_m
