! SPDX-License-Identifier: MIT
!> One chunk of fully integrated round quads (2x2 Gauss points, weighted by their radius): at each
!> point the equations of the plane quad's point (`quad_full`) with the hoop strain v_r/r. The
!> volumetric stress is K ln J of the point, or with mean dilatation K ln(V/V0) of the element.
module round_full_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use bulk_viscosity_m, only : add_bulk_viscosity
  use element_chunk_m, only : element_chunk_t
  use eos_pressure_m, only : finish_limits
  use law_pressure_m, only : load_point_state, start_point_values, add_point_values, &
    form_shared_pressure
  use layout_m, only : chunk_size
  use material_dispatch_m, only : update_stress, history_size
  use parts_m, only : hourglass_t, material_t
  use quad_full_m, only : has_mean_dilatation
  use quad_kinematics_m, only : form_present_shape, form_increments, form_forces
  use quad_points_m, only : n_point, form_point, add_point_force
  use round_chunk_m, only : round_chunk_t, gather_round, reference_mass
  use round_full_step_m, only : round_full_step
  use round_kinematics_m, only : form_round_shape, form_round_increments
  use round_points_m, only : round_point_t, form_radii, add_hoop_strain, add_hoop_force
  use stress_chunk_m, only : stress_chunk_t, load_deviator, store_deviator, work_of_deviator
  use viscous_stress_m, only : viscous_start, add_viscous_deviator, add_viscous_pressure, &
    trace_of
  use volumetric_m, only : volumetric_stress, largest_size
  implicit none
  private
  public :: advance_round_full

contains

  !> Advance one chunk by the step `dt` that led to the present motion (dt = 0: forces only) and
  !> leave its forces, per radian, in `round`. Of `hourglass` only the bulk viscosity
  !> counts.
  pure subroutine advance_round_full(i_chunk, nodes, motion, material, hourglass, dt, elements, &
    round)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(round_chunk_t), intent(inout) :: round       !! forces out
    type(element_chunk_t) :: chunk
    type(round_point_t) :: points(n_point)
    integer :: first, k, n_slot

    first = (i_chunk - 1)*chunk_size + 1
    n_slot = size(elements%reference, 1)
    call gather_round(nodes, motion, chunk, round)
    call form_round_shape(elements%reference(first, 1), n_slot, chunk, round)
    call form_mean_pressure(i_chunk, material, hourglass, dt, elements, chunk, round)
    chunk%force3 = 0.0_wp
    chunk%force4 = 0.0_wp
    chunk%swing = 0.0_wp
    round%hoop = 0.0_wp
    elements%volume_change(i_chunk) = 0.0_wp
    do k = 1, n_point
      call advance_point(i_chunk, k, material, dt, elements, chunk, round, points(k))
    end do
    call store_mean(points, round%inverse_volume, elements%point_deviator(elements%point_start( &
      i_chunk)), n_slot, elements%deviator(first, 1))
    if (allocated(material%eos)) then
      call finish_with_eos(i_chunk, material, hourglass, points, round, elements, chunk)
      return
    end if
    round%force(1:2, :) = chunk%force3
    round%force(3:4, :) = chunk%force4
    round%swing = chunk%swing
    call round_full_step(material, hourglass, elements%reference(first, reference_mass), n_slot, &
      chunk, points, elements%time_limit(i_chunk), elements%volume_limit(i_chunk))
  end subroutine advance_round_full

  !> The rest of the step where the pressure has a memory: what the points have done heats it. All
  !> of them share it, and they sum the gradient of the volume without error.
  pure subroutine finish_with_eos(i_chunk, material, hourglass, points, round, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    type(round_point_t), intent(in) :: points(n_point)
    type(round_chunk_t), intent(inout) :: round
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(material_t) :: now
    integer :: first, i

    first = (i_chunk - 1)*chunk_size + 1
    call form_shared_pressure(i_chunk, material, hourglass, (1.0_wp + chunk%stretch) &
      *round%inverse_volume, elements, chunk, now)
    associate (p => chunk%pressure)
      do i = 1, chunk_size
        round%force(1, i) = chunk%force3(1, i) + p(i)*(round%rad_a(i) + round%mean_a(i))
        round%force(2, i) = chunk%force3(2, i) + p(i)*round%axi_a(i)
        round%force(3, i) = chunk%force4(1, i) + p(i)*(round%rad_b(i) + round%mean_b(i))
        round%force(4, i) = chunk%force4(2, i) + p(i)*round%axi_b(i)
        round%swing(1, i) = chunk%swing(1, i) + p(i)*round%rad_h(i)
        round%swing(2, i) = chunk%swing(2, i) + p(i)*round%axi_h(i)
        round%hoop(i) = round%hoop(i) + p(i)*round%mean_s(i)
      end do
    end associate
    call round_full_step(now, hourglass, elements%reference(first, reference_mass), &
      size(elements%reference, 1), chunk, points, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
    call finish_limits(material, now, chunk%stretch, elements%time_limit(i_chunk), &
      elements%volume_limit(i_chunk))
  end subroutine finish_with_eos

  !> The pressure that all points of an element share: bulk viscosity of the mean rate, and the
  !> volumetric stress with mean dilatation.
  pure subroutine form_mean_pressure(i_chunk, material, hourglass, dt, elements, chunk, round)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk !! pressure and trace out
    type(round_chunk_t), intent(in) :: round
    type(stress_chunk_t) :: unused
    real(wp) :: work

    chunk%trace = 0.0_wp
    chunk%pressure = 0.0_wp
    if (allocated(material%eos)) then
      call start_point_values(material, chunk)
      if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) call &
        form_round_increments(dt, chunk, round, unused)
      return
    end if
    if (has_mean_dilatation(material)) &
      call volumetric_stress(material%bulk, chunk%stretch, chunk%pressure)
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp) then
      call form_round_increments(dt, chunk, round, unused)
      call add_bulk_viscosity(hourglass%quadratic, hourglass%linear, material%density, &
        material%sound_speed, dt, chunk, elements%viscous_pressure((i_chunk - 1)*chunk_size + 1), &
        work)
      elements%viscous_work(i_chunk) = elements%viscous_work(i_chunk) + work
    end if
    if (allocated(elements%retardation) .and. has_mean_dilatation(material)) then
      call form_round_increments(dt, chunk, round, unused)
      call add_viscous_pressure(material%bulk, elements%retardation((i_chunk - 1)*chunk_size + 1), &
        chunk%trace, chunk%mid_area, dt, chunk%pressure, elements%damping_stress(viscous_start( &
        i_chunk, 1) + 3*chunk_size), elements%damping_work(i_chunk))
    end if
  end subroutine form_mean_pressure

  !> Advance point `k` of a chunk and add its forces.
  pure subroutine advance_point(i_chunk, k, material, dt, elements, chunk, round, place)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(round_chunk_t), intent(inout) :: round
    type(round_point_t), intent(inout) :: place
    type(element_chunk_t) :: point
    type(stress_chunk_t) :: stress
    real(wp) :: start(chunk_size, 6)
    integer :: first, stride

    first = (i_chunk - 1)*chunk_size + 1
    stride = size(elements%reference, 1)
    point%hu = 0.0_wp
    point%hv = 0.0_wp
    point%qx = 0.0_wp
    point%qy = 0.0_wp
    call form_point(k, stride, elements%reference(first, 1), chunk, start, point)
    call form_present_shape(start, chunk_size, point)
    call form_radii(k, elements%reference(first, 1), stride, chunk, round, point, place)
    call form_increments(dt, point, stress)
    call add_hoop_strain(dt, place, point, stress)
    elements%volume_change(i_chunk) = max(elements%volume_change(i_chunk), &
      dt*largest_size(trace_of(stress)))
    first = elements%point_start(i_chunk) + 3*chunk_size*(k - 1)
    call load_deviator(elements%point_deviator(first), chunk_size, stress)
    if (allocated(material%eos)) call load_point_state(i_chunk, material, point%mid_area &
      *(1.0_wp + place%stretch)/place%volume, place%stretch, chunk, point, elements, stress)
    if (elements%history_start(i_chunk) > 0) then
      call update_stress(material, stress, elements%history(elements%history_start(i_chunk) &
        + (k - 1)*chunk_size*history_size(material)))
    else
      call update_stress(material, stress)
    end if
    call store_deviator(stress, chunk_size, elements%point_deviator(first))
    if (allocated(material%eos)) then
      call add_point_values(material, 1.0_wp, place%volume, place%stretch, point%mid_area, stress, &
        chunk)
    else
      elements%deviatoric_work(i_chunk) = elements%deviatoric_work(i_chunk) &
        + work_of_deviator(stress%work, point%mid_area)
    end if
    if (has_mean_dilatation(material)) then
      point%pressure = chunk%pressure
    else
      call volumetric_stress(material%bulk, place%stretch, point%pressure)
      point%pressure = point%pressure + chunk%pressure
    end if
    if (allocated(elements%retardation)) then
      first = (i_chunk - 1)*chunk_size + 1
      associate (n => viscous_start(i_chunk, k))
        call add_viscous_deviator(material%shear, elements%retardation(first), point%mid_area, &
          stress, elements%damping_stress(n), elements%damping_work(i_chunk))
        if (.not. has_mean_dilatation(material)) call add_viscous_pressure(material%bulk, &
          elements%retardation(first), trace_of(stress), point%mid_area, dt, point%pressure, &
          elements%damping_stress(n + 3*chunk_size), elements%damping_work(i_chunk))
      end associate
    end if
    call form_forces(stress, point)
    call add_hoop_force(k, place, stress, point, chunk, round)
    call add_point_force(k, point, chunk)
  end subroutine advance_point

  !> Mean deviator of the elements over their volume, for output.
  pure subroutine store_mean(points, inverse_volume, deviators, stride, stream)
    type(round_point_t), intent(in) :: points(n_point)
    real(wp), intent(in) :: inverse_volume(chunk_size)
    real(wp), intent(in) :: deviators(chunk_size, 3, n_point)
    integer, intent(in) :: stride
    real(wp), intent(inout) :: stream(stride, *)
    integer :: i, j

    do j = 1, 3
      do i = 1, chunk_size
        stream(i, j) = inverse_volume(i)*((points(1)%volume(i)*deviators(i, j, 1) &
          + points(2)%volume(i)*deviators(i, j, 2)) + (points(3)%volume(i)*deviators(i, j, 3) &
          + points(4)%volume(i)*deviators(i, j, 4)))
      end do
    end do
  end subroutine store_mean

end module round_full_m
