! SPDX-License-Identifier: MIT
!> One chunk of fully integrated quads (2x2 Gauss points): at each point the equations of the
!> one-point quad without hourglass control. The volumetric stress is K ln J of the point, or with
!> mean dilatation K ln(A/A0) of the element at all four (Nagtegaal, Parks & Rice 1974).
module quad_full_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use bulk_viscosity_m, only : add_bulk_viscosity
  use element_chunk_m, only : element_chunk_t, gather_chunk
  use eos_pressure_m, only : finish_limits
  use full_time_step_m, only : step_sums_t, start_sums, add_point_sums, full_step
  use law_pressure_m, only : load_point_state, start_point_values, add_point_values, &
    form_shared_pressure
  use layout_m, only : chunk_size
  use material_dispatch_m, only : update_stress, history_size
  use parts_m, only : hourglass_t, material_t
  use quad_kinematics_m, only : form_present_shape, form_increments, form_forces
  use quad_points_m, only : n_point, form_point, add_point_force
  use stress_chunk_m, only : stress_chunk_t, load_deviator, store_deviator, work_of_deviator
  use viscous_stress_m, only : viscous_start, add_viscous_deviator, add_viscous_pressure
  use volumetric_m, only : volumetric_stress, largest_size
  implicit none
  private
  public :: advance_full, has_mean_dilatation

contains

  !> Mean dilatation, against volumetric locking, where the material is or
  !> becomes nearly incompressible.
  pure function has_mean_dilatation(material) result(yes)
    type(material_t), intent(in) :: material
    logical :: yes

    yes = material%poisson > 0.4_wp .or. history_size(material) > 0 .or. allocated(material%eos)
  end function has_mean_dilatation

  !> Advance one chunk by the step `dt` that led to the present motion (dt = 0: forces only) and
  !> leave its forces in `chunk`. Of `hourglass` only the bulk viscosity counts.
  pure subroutine advance_full(i_chunk, nodes, motion, material, hourglass, dt, elements, chunk)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk     !! forces out
    type(element_chunk_t) :: point
    type(step_sums_t) :: sums
    real(wp) :: reference(chunk_size, 6), deviator(chunk_size, 3)
    integer :: first, k, n_slot

    first = (i_chunk - 1)*chunk_size + 1
    n_slot = size(elements%reference, 1)
    call gather_chunk(nodes, motion, chunk)
    call form_present_shape(elements%reference(first, 1), n_slot, chunk)
    call form_mean_pressure(i_chunk, material, hourglass, dt, elements, chunk)
    chunk%force3 = 0.0_wp
    chunk%force4 = 0.0_wp
    chunk%swing = 0.0_wp
    deviator = 0.0_wp
    point%hu = 0.0_wp
    point%hv = 0.0_wp
    point%qx = 0.0_wp
    point%qy = 0.0_wp
    call start_sums(sums)
    elements%volume_change(i_chunk) = 0.0_wp
    do k = 1, n_point
      call form_point(k, n_slot, elements%reference(first, 1), chunk, reference, point)
      call form_present_shape(reference, chunk_size, point)
      call advance_point(i_chunk, k, material, dt, chunk, elements, point, deviator)
      call add_point_force(k, point, chunk)
      call add_point_sums(k, point, sums)
    end do
    call store_mean(n_slot, chunk, deviator, elements%deviator(first, 1))
    if (allocated(material%eos)) then
      call finish_with_eos(i_chunk, nodes, material, hourglass, sums, elements, chunk)
      return
    end if
    call full_step(material, hourglass, nodes, chunk, sums, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
  end subroutine advance_full

  !> The rest of the step where the pressure has a memory: what the points have done heats it. All
  !> of them share it, so that its force is that of a one-point quad.
  pure subroutine finish_with_eos(i_chunk, nodes, material, hourglass, sums, elements, chunk)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(step_sums_t), intent(in) :: sums
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(material_t) :: now
    real(wp) :: half
    integer :: i

    call form_shared_pressure(i_chunk, material, hourglass, (1.0_wp + chunk%stretch) &
      *chunk%inverse_area, elements, chunk, now)
    !$omp simd private(half)
    do i = 1, chunk_size
      half = 0.5_wp*chunk%pressure(i)
      chunk%force3(1, i) = chunk%force3(1, i) + half*chunk%y42(i)
      chunk%force3(2, i) = chunk%force3(2, i) - half*chunk%x42(i)
      chunk%force4(1, i) = chunk%force4(1, i) - half*chunk%y31(i)
      chunk%force4(2, i) = chunk%force4(2, i) + half*chunk%x31(i)
    end do
    call full_step(now, hourglass, nodes, chunk, sums, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
    call finish_limits(material, now, chunk%stretch, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
  end subroutine finish_with_eos

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

    chunk%trace = 0.0_wp
    chunk%pressure = 0.0_wp
    if (allocated(material%eos)) then
      call start_point_values(material, chunk)
      if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) call form_increments(dt, &
        chunk, unused)
      return
    end if
    if (has_mean_dilatation(material)) &
      call volumetric_stress(material%bulk, chunk%stretch, chunk%pressure)
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) then
      call form_increments(dt, chunk, unused)
      call add_bulk_viscosity(hourglass%quadratic, hourglass%linear, material%density, &
        material%sound_speed, dt, chunk, elements%viscous_pressure((i_chunk - 1)*chunk_size + 1), &
        work)
      elements%viscous_work(i_chunk) = elements%viscous_work(i_chunk) + work
    end if
    if (allocated(elements%retardation) .and. has_mean_dilatation(material)) then
      call form_increments(dt, chunk, unused)
      call add_viscous_pressure(material%bulk, elements%retardation((i_chunk - 1)*chunk_size + 1), &
        chunk%trace, chunk%mid_area, dt, chunk%pressure, elements%damping_stress(viscous_start( &
        i_chunk, 1) + 3*chunk_size), elements%damping_work(i_chunk))
    end if
  end subroutine form_mean_pressure

  !> Advance point `k` of a chunk and leave its forces in `point`.
  pure subroutine advance_point(i_chunk, k, material, dt, chunk, elements, point, deviator)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: dt
    type(element_chunk_t), intent(inout) :: chunk      !! its heat
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: point
    real(wp), intent(inout) :: deviator(chunk_size, 3) !! sum of deviator times area
    type(stress_chunk_t) :: stress
    integer :: first

    first = elements%point_start(i_chunk) + 3*chunk_size*(k - 1)
    call form_increments(dt, point, stress)
    elements%volume_change(i_chunk) = max(elements%volume_change(i_chunk), &
      dt*largest_size(point%trace))
    call load_deviator(elements%point_deviator(first), chunk_size, stress)
    if (allocated(material%eos)) call load_point_state(i_chunk, material, point%mid_area &
      *(1.0_wp + point%stretch)*point%inverse_area, point%stretch, chunk, point, elements, stress)
    if (elements%history_start(i_chunk) > 0) then
      call update_stress(material, stress, elements%history(elements%history_start(i_chunk) &
        + (k - 1)*chunk_size*history_size(material)))
    else
      call update_stress(material, stress)
    end if
    call store_deviator(stress, chunk_size, elements%point_deviator(first))
    if (allocated(material%eos)) then
      call add_point_values(material, 0.25_wp, point%area, point%stretch, point%mid_area, stress, &
        chunk)
    else
      elements%deviatoric_work(i_chunk) = elements%deviatoric_work(i_chunk) &
        + 0.25_wp*work_of_deviator(stress%work, point%mid_area)
    end if
    deviator(:, 1) = deviator(:, 1) + 0.25_wp*point%area*stress%sxx
    deviator(:, 2) = deviator(:, 2) + 0.25_wp*point%area*stress%syy
    deviator(:, 3) = deviator(:, 3) + 0.25_wp*point%area*stress%sxy
    if (has_mean_dilatation(material)) then
      point%pressure = chunk%pressure
    else
      call volumetric_stress(material%bulk, point%stretch, point%pressure)
      point%pressure = point%pressure + chunk%pressure
    end if
    if (allocated(elements%retardation)) then
      first = (i_chunk - 1)*chunk_size + 1
      associate (n => viscous_start(i_chunk, k))
        call add_viscous_deviator(material%shear, elements%retardation(first), &
          0.25_wp*point%mid_area, stress, elements%damping_stress(n), &
          elements%damping_work(i_chunk))
        if (.not. has_mean_dilatation(material)) call add_viscous_pressure(material%bulk, &
          elements%retardation(first), point%trace, 0.25_wp*point%mid_area, dt, point%pressure, &
          elements%damping_stress(n + 3*chunk_size), elements%damping_work(i_chunk))
      end associate
    end if
    call form_forces(stress, point)
  end subroutine advance_point

  !> Mean deviator of the elements, for output.
  pure subroutine store_mean(stride, chunk, deviator, stream)
    integer, intent(in) :: stride
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(in) :: deviator(chunk_size, 3) !! sum of deviator times area
    real(wp), intent(inout) :: stream(stride, *)
    integer :: i

    !$omp simd
    do i = 1, chunk_size
      stream(i, 1) = deviator(i, 1)*chunk%inverse_area(i)
      stream(i, 2) = deviator(i, 2)*chunk%inverse_area(i)
      stream(i, 3) = deviator(i, 3)*chunk%inverse_area(i)
    end do
  end subroutine store_mean

end module quad_full_m
