! SPDX-License-Identifier: MIT
!> One chunk of fully integrated quads (2x2 Gauss points, in round bodies weighted by their radius):
!> at each point the equations of the one-point plane quad without hourglass control, and the hoop
!> strain v_r/r. The volumetric stress is K ln J of the point, or with mean dilatation K ln(V/V0) of
!> the element at all four (Nagtegaal, Parks & Rice 1974).
module quad_full_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, gather_motion, reference_mass
  use eos_pressure_m, only : finish_limits, load_point_state, start_point_values, &
    add_point_values, form_shared_pressure
  use layout_m, only : chunk_size
  use material_dispatch_m, only : update_stress, history_size, has_mean_dilatation
  use model_m, only : model_t
  use parts_m, only : hourglass_t, material_t
  use quad_kinematics_m, only : form_shape, form_increments, form_forces, add_pressure_forces, &
    inverse_start
  use quad_points_m, only : n_point, round_point_t, step_sums_t, form_point, form_radii, &
    add_hoop_strain, add_hoop_force, add_point_force, start_sums, add_point_sums, &
    form_row_sums
  use stable_step_m, only : full_step, axisymmetric_full_step
  use stress_chunk_m, only : stress_chunk_t, load_deviator, store_deviator, work_of_deviator
  use viscous_stress_m, only : add_bulk_viscosity, viscous_start, add_viscous_deviator, &
    add_viscous_pressure, trace_of
  use volumetric_m, only : volumetric_stress, largest_size
  implicit none
  private
  public :: advance_full

  !> What the points leave: what the stable step takes, round ones themselves, and the sum of
  !> deviator times volume.
  type :: sums_t
    type(step_sums_t) :: step
    type(round_point_t) :: places(n_point)
    real(wp) :: deviator(chunk_size, 3)
  end type sums_t

contains

  !> Advance one chunk by the step `dt` that led to the present motion (dt = 0: forces only) and
  !> leave its forces in `chunk`, of round quads per radian. Of hourglass control only the bulk
  !> viscosity counts.
  pure subroutine advance_full(model, i_chunk, nodes, motion, dt, elements, chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk     !! forces out
    type(element_chunk_t) :: point
    type(sums_t) :: sums
    integer :: first, j, k, n_slot

    first = (i_chunk - 1)*chunk_size + 1
    n_slot = size(elements%reference, 1)
    associate (part => model%parts(model%layout%chunk_part(i_chunk)), material => &
      model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      call gather_motion(model%is_round, nodes, motion, chunk)
      call form_shape(elements%reference(first, 1), n_slot, chunk)
      call form_mean_pressure(i_chunk, material, part%hourglass, dt, elements, chunk)
      chunk%force3 = 0.0_wp
      chunk%force4 = 0.0_wp
      chunk%swing = 0.0_wp
      if (chunk%is_round) chunk%hoop = 0.0_wp
      sums%deviator = 0.0_wp
      point%is_round = .false.
      point%hu = 0.0_wp
      point%hv = 0.0_wp
      point%qx = 0.0_wp
      point%qy = 0.0_wp
      if (.not. chunk%is_round) call start_sums(sums%step)
      elements%volume_change(i_chunk) = 0.0_wp
      do k = 1, n_point
        call advance_point(i_chunk, k, material, dt, elements, chunk, point, sums)
      end do
      ! The mean deviator, for output.
      do j = 1, 3
        if (chunk%is_round) then
          elements%deviator(first:first + chunk_size - 1, j) = sums%deviator(:, j) &
            *chunk%inverse_volume
        else
          elements%deviator(first:first + chunk_size - 1, j) = sums%deviator(:, j) &
            *chunk%inverse_area
        end if
      end do
      if (allocated(material%eos)) then
        call finish_with_eos(i_chunk, nodes, material, part%hourglass, sums, elements, chunk)
        return
      end if
      call limit_chunk(i_chunk, nodes, material, part%hourglass, sums, elements, chunk)
    end associate
  end subroutine advance_full

  !> The rest of the step where the pressure has a memory: what the points have done heats it, and
  !> all of them share it.
  pure subroutine finish_with_eos(i_chunk, nodes, material, hourglass, sums, elements, chunk)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(sums_t), intent(inout) :: sums
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(material_t) :: now

    call form_shared_pressure(i_chunk, material, hourglass, inverse_start(chunk), elements, chunk, &
      now)
    call add_pressure_forces(chunk)
    call limit_chunk(i_chunk, nodes, now, hourglass, sums, elements, chunk)
    call finish_limits(material, now, chunk%stretch, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
  end subroutine finish_with_eos

  !> Stable step and smallest volume ratio.
  pure subroutine limit_chunk(i_chunk, nodes, now, hourglass, sums, elements, chunk)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    type(material_t), intent(in) :: now           !! with its present moduli
    type(hourglass_t), intent(in) :: hourglass
    type(sums_t), intent(inout) :: sums
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(in) :: chunk

    if (chunk%is_round) then
      call form_row_sums(elements%reference((i_chunk - 1)*chunk_size + 1, reference_mass), &
        size(elements%reference, 1), sums%places, sums%step)
      call axisymmetric_full_step(now, hourglass, chunk, sums%step, elements%time_limit(i_chunk), &
        elements%volume_limit(i_chunk))
    else
      call full_step(now, hourglass, nodes, chunk, sums%step, elements%time_limit(i_chunk), &
        elements%volume_limit(i_chunk))
    end if
  end subroutine limit_chunk

  !> The pressure that all points of an element share: bulk viscosity of the mean rate, and the
  !> volumetric stress with mean dilatation.
  pure subroutine form_mean_pressure(i_chunk, material, hourglass, dt, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk !! pressure and trace out
    type(stress_chunk_t) :: unused
    real(wp) :: work
    logical :: is_viscous, is_damped

    is_viscous = hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp
    is_damped = allocated(elements%retardation) .and. has_mean_dilatation(material) &
      .and. .not. allocated(material%eos)
    chunk%trace = 0.0_wp
    chunk%pressure = 0.0_wp
    if (is_viscous .or. is_damped) call form_increments(dt, chunk, unused)
    if (allocated(material%eos)) then
      call start_point_values(material, chunk)
      return
    end if
    if (has_mean_dilatation(material)) &
      call volumetric_stress(material%bulk, chunk%stretch, chunk%pressure)
    associate (first => (i_chunk - 1)*chunk_size + 1)
      if (is_viscous) then
        call add_bulk_viscosity(hourglass%quadratic, hourglass%linear, material%density, &
          material%sound_speed, dt, chunk, elements%viscous_pressure(first), work)
        elements%viscous_work(i_chunk) = elements%viscous_work(i_chunk) + work
      end if
      if (is_damped) call add_viscous_pressure(material%bulk, elements%retardation(first), &
        chunk%trace, chunk%mid_area, dt, chunk%pressure, elements%damping_stress(viscous_start( &
        i_chunk, 1) + 3*chunk_size), elements%damping_work(i_chunk))
    end associate
  end subroutine form_mean_pressure

  !> Advance point `k` of a chunk and add its forces.
  pure subroutine advance_point(i_chunk, k, material, dt, elements, chunk, point, sums)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk, point
    type(sums_t), intent(inout) :: sums
    type(stress_chunk_t) :: stress
    integer :: first

    call move_point(i_chunk, k, dt, elements, chunk, point, stress, sums)
    elements%volume_change(i_chunk) = max(elements%volume_change(i_chunk), &
      dt*largest_size(point%trace))
    first = elements%point_start(i_chunk) + 3*chunk_size*(k - 1)
    call load_deviator(elements%point_deviator(first), chunk_size, stress)
    if (allocated(material%eos)) call load_point_state(i_chunk, material, point%mid_area &
      *(1.0_wp + point%stretch)/point%volume, chunk, point, elements, stress)
    if (elements%history_start(i_chunk) > 0) then
      call update_stress(material, stress, elements%history(elements%history_start(i_chunk) &
        + (k - 1)*chunk_size*history_size(material)))
    else
      call update_stress(material, stress)
    end if
    call store_deviator(stress, chunk_size, elements%point_deviator(first))
    if (allocated(material%eos)) then
      call add_point_values(material, point, stress, chunk)
    else
      elements%deviatoric_work(i_chunk) = elements%deviatoric_work(i_chunk) &
        + work_of_deviator(stress%work, point%mid_area)
    end if
    sums%deviator(:, 1) = sums%deviator(:, 1) + point%volume*stress%sxx
    sums%deviator(:, 2) = sums%deviator(:, 2) + point%volume*stress%syy
    sums%deviator(:, 3) = sums%deviator(:, 3) + point%volume*stress%sxy
    if (has_mean_dilatation(material)) then
      point%pressure = chunk%pressure
    else
      call volumetric_stress(material%bulk, point%stretch, point%pressure)
      point%pressure = point%pressure + chunk%pressure
    end if
    if (allocated(elements%retardation)) call add_damping(i_chunk, k, material, elements, point, &
      stress)
    call form_forces(stress, point)
    if (chunk%is_round) call add_hoop_force(k, sums%places(k), stress, point, chunk)
    call add_point_force(k, point, chunk)
  end subroutine advance_point

  !> Shape, increments of the step and share in the volume of point `k`.
  pure subroutine move_point(i_chunk, k, dt, elements, chunk, point, stress, sums)
    integer, intent(in) :: i_chunk, k
    real(wp), intent(in) :: dt
    type(block_state_t), intent(in) :: elements
    type(element_chunk_t), intent(in) :: chunk
    type(element_chunk_t), intent(inout) :: point
    type(stress_chunk_t), intent(inout) :: stress
    type(sums_t), intent(inout) :: sums
    real(wp) :: reference(chunk_size, 6)
    integer :: first, stride

    first = (i_chunk - 1)*chunk_size + 1
    stride = size(elements%reference, 1)
    call form_point(k, stride, elements%reference(first, 1), chunk, reference, point)
    call form_shape(reference, chunk_size, point)
    call form_increments(dt, point, stress)
    point%mid_area = 0.25_wp*point%mid_area
    if (chunk%is_round) then
      call form_radii(k, elements%reference(first, 1), stride, chunk, point, sums%places(k))
      call add_hoop_strain(dt, sums%places(k), point, stress)
      point%trace = trace_of(stress)
    else
      point%volume = 0.25_wp*point%area
      call add_point_sums(k, point, sums%step)
    end if
  end subroutine move_point

  !> Stress of damping by stiffness at point `k`.
  pure subroutine add_damping(i_chunk, k, material, elements, point, stress)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: point
    type(stress_chunk_t), intent(inout) :: stress

    associate (n => viscous_start(i_chunk, k), first => (i_chunk - 1)*chunk_size + 1)
      call add_viscous_deviator(material%shear, elements%retardation(first), point%mid_area, &
        stress, elements%damping_stress(n), elements%damping_work(i_chunk))
      if (.not. has_mean_dilatation(material)) call add_viscous_pressure(material%bulk, &
        elements%retardation(first), point%trace, point%mid_area, stress%dt, point%pressure, &
        elements%damping_stress(n + 3*chunk_size), elements%damping_work(i_chunk))
    end associate
  end subroutine add_damping

end module quad_full_m
