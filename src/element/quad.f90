! SPDX-License-Identifier: MIT
!> One chunk of quads, plane or axisymmetric: from nodal motion to nodal forces, with the stress
!> update. A quad has one point and hourglass control, or 2x2 Gauss points, in axisymmetric models
!> weighted by their radius: each has the equations of the one-point plane quad, and the hoop strain
!> v_r/r. The volumetric stress is K ln J of the point, or with mean dilatation K ln(V/V0) of the
!> element at all four (Nagtegaal, Parks & Rice 1974). Plane stress: `plane_stress`.
module quad_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, gather_motion, reference_mass
  use eos_pressure_m, only : finish_limits, load_point_state, start_point_values, &
    add_point_values, add_law_values, form_shared_pressure
  use hourglass_m, only : apply_hourglass_control
  use layout_m, only : chunk_size
  use material_dispatch_m, only : update_stress, history_size, has_mean_dilatation
  use model_m, only : model_t
  use parts_m, only : hourglass_t, material_t, gives_pressure
  use plane_stress_m, only : thinning_start, update_sheet, form_membrane_stress
  use quad_plain_m, only : is_plain, advance_plain
  use quad_kinematics_m, only : form_shape, form_increments, form_forces, form_axisym_forces, &
    form_rubber_forces, add_pressure_forces, inverse_start
  use quad_points_m, only : n_point, axisym_point_t, step_sums_t, form_point, form_radii, &
    add_hoop_strain, add_hoop_force, add_point_force, add_point_sums, form_row_sums
  use stable_step_m, only : moduli_t, moduli_of, stable_step, axisymmetric_step, full_step, &
    axisymmetric_full_step
  use stress_chunk_m, only : stress_chunk_t, load_deviator, store_deviator, work_of_deviator
  use volumetric_m, only : volumetric_stress, largest_size, add_bulk_viscosity, &
    add_viscous_deviator, add_viscous_pressure
  implicit none
  private
  public :: advance_chunk, limit_chunk, start_points, move_point, sums_t

  !> Sums over the points: data of the stable step, axisymmetric points, and deviator times volume.
  type :: sums_t
    type(step_sums_t) :: step
    type(axisym_point_t) :: places(n_point)
    real(wp) :: deviator(chunk_size, 3)
  end type sums_t

contains

  !> Advance one chunk by the step `dt` before the present motion (dt = 0: forces only); forces in
  !> `chunk`, of axisymmetric quads per radian.
  pure subroutine advance_chunk(model, i_chunk, nodes, motion, dt, elements, chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)       !! by their numbers in `motion`
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n) of all nodes, or of those of a tile
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk     !! forces out
    type(sums_t) :: sums
    type(moduli_t) :: now
    real(wp) :: limits(2)

    associate (part => model%parts(model%layout%chunk_part(i_chunk)), material => &
      model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      if (elements%point_start(i_chunk) == 0) then
        if (is_plain(model, part, material, elements)) then
          chunk%is_axisymmetric = .false.
          call advance_plain(i_chunk, nodes, motion, material, part%hourglass%coefficient, dt, &
            elements, chunk)
          return
        end if
      end if
      call gather_motion(model%is_axisymmetric, nodes, motion, chunk)
      call form_shape(elements%reference((i_chunk - 1)*chunk_size + 1, 1), &
        size(elements%reference, 1), chunk)
      elements%volume_change(i_chunk) = 0.0_wp
      now = moduli_of(material)
      if (elements%point_start(i_chunk) > 0) then
        call advance_points(i_chunk, material, part%hourglass, dt, elements, chunk, sums, now)
      else
        call advance_one_point(i_chunk, material, part%hourglass, dt, elements, chunk, now)
      end if
      call limit_chunk(model, i_chunk, now, elements, chunk, sums, limits)
      if (allocated(material%eos)) call finish_limits(material, now, chunk%stretch, limits(1), &
        limits(2))
      elements%time_limit(i_chunk) = limits(1)
      elements%volume_limit(i_chunk) = limits(2)
      if (.not. material%is_plane_stress) return
      associate (first => thinning_start(elements, i_chunk, 1), n => chunk_size*merge(4, 1, &
        elements%point_start(i_chunk) > 0))
        elements%volume_limit(i_chunk) = min(elements%volume_limit(i_chunk), 1.0_wp &
          + minval(elements%eos_state(first:first + n - 1)))
      end associate
      associate (thickness => model%sections(part%section)%thickness)
        chunk%force3 = thickness*chunk%force3
        chunk%force4 = thickness*chunk%force4
        chunk%swing = thickness*chunk%swing
      end associate
    end associate
  end subroutine advance_chunk

  !> Stress and forces of one-point quads, whose shape is set.
  pure subroutine advance_one_point(i_chunk, material, hourglass, dt, elements, chunk, now)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(moduli_t), intent(inout) :: now          !! present moduli with an equation of state
    type(stress_chunk_t) :: stress

    call form_increments(dt, chunk, stress)
    call advance_stress(i_chunk, 1, material, chunk, chunk, elements, stress)
    if (allocated(material%eos)) then
      ! All other work heats the element.
      call start_point_values(material, chunk)
      chunk%heat = stress%work*chunk%mid_area
      if (gives_pressure(material)) call add_law_values(material, 1.0_wp/inverse_start(chunk), &
        stress, chunk)
      if (material%is_plane_stress) call form_membrane_stress(material%follows_strain, stress)
      call form_shared_pressure(i_chunk, material, hourglass, inverse_start(chunk), elements, &
        chunk, now)
    else
      call volumetric_stress(material%bulk, chunk%stretch, chunk%pressure)
      call add_start_pressure(i_chunk, 1, material, elements, chunk)
      call add_viscosity(i_chunk, material, hourglass, dt, elements, chunk)
      if (allocated(elements%retardation)) call add_damping(i_chunk, 1, material, .true., &
        elements, chunk, stress)
    end if
    call apply_hourglass_control(i_chunk, material, hourglass, stress, elements, chunk)
    if (.not. chunk%is_axisymmetric) then
      call form_forces(stress, chunk)
    else if (allocated(material%rubber)) then
      call form_rubber_forces(stress, chunk)
    else
      call form_axisym_forces(stress, chunk)
    end if
  end subroutine advance_one_point

  !> Stress and forces of fully integrated quads, whose shape is set. Of `hourglass` only the bulk
  !> viscosity counts.
  pure subroutine advance_points(i_chunk, material, hourglass, dt, elements, chunk, sums, now)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(sums_t), intent(inout) :: sums
    type(moduli_t), intent(inout) :: now          !! present moduli with an equation of state
    type(element_chunk_t) :: point
    real(wp) :: inverse(chunk_size)
    integer :: first, j, k

    call form_mean_pressure(i_chunk, material, hourglass, dt, elements, chunk)
    chunk%force3 = 0.0_wp
    chunk%force4 = 0.0_wp
    chunk%swing = 0.0_wp
    if (chunk%is_axisymmetric) chunk%hoop = 0.0_wp
    sums%deviator = 0.0_wp
    call start_points(chunk%is_axisymmetric, point, sums)
    do k = 1, n_point
      call advance_point(i_chunk, k, material, dt, elements, chunk, point, sums)
    end do
    ! The mean deviator, for output.
    first = (i_chunk - 1)*chunk_size + 1
    inverse = chunk%inverse_area
    if (chunk%is_axisymmetric) inverse = chunk%inverse_volume
    do j = 1, 3
      elements%deviator(first:first + chunk_size - 1, j) = sums%deviator(:, j)*inverse
    end do
    if (.not. allocated(material%eos)) return
    ! The work of the points heats the element, which has one pressure.
    call form_shared_pressure(i_chunk, material, hourglass, inverse_start(chunk), elements, chunk, &
      now)
    call add_pressure_forces(chunk)
  end subroutine advance_points

  !> Stable step and smallest volume ratio of a chunk in its present shape.
  pure subroutine limit_chunk(model, i_chunk, now, elements, chunk, sums, limits, single)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    type(moduli_t), intent(in) :: now
    type(block_state_t), intent(in) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    type(sums_t), intent(inout) :: sums             !! of points
    real(wp), intent(out) :: limits(2)              !! s, and V/V0
    real(wp), intent(out), optional :: single(chunk_size) !! steps of the elements
    integer :: first, n_slot

    first = (i_chunk - 1)*chunk_size + 1
    n_slot = size(elements%reference, 1)
    associate (hourglass => model%parts(model%layout%chunk_part(i_chunk))%hourglass)
      if (elements%point_start(i_chunk) > 0 .and. chunk%is_axisymmetric) then
        call form_row_sums(elements%reference(first, reference_mass), n_slot, sums%places, &
          sums%step)
        call axisymmetric_full_step(now, hourglass, chunk, sums%step, limits(1), limits(2), single)
      else if (elements%point_start(i_chunk) > 0) then
        call full_step(now, hourglass, model%layout%slot_nodes(1, first), chunk, sums%step, &
          limits(1), limits(2), single)
      else if (chunk%is_axisymmetric) then
        call axisymmetric_step(now, hourglass, elements%reference(first, reference_mass), n_slot, &
          chunk, limits(1), limits(2), single)
      else
        call stable_step(model%controls%length_rule, now%sound_speed, hourglass, &
          model%layout%slot_nodes(1, first), chunk, limits(1), limits(2), single)
      end if
    end associate
  end subroutine limit_chunk

  !> Pressure shared by the points of an element: bulk viscosity of the mean rate, and the
  !> volumetric stress with mean dilatation.
  pure subroutine form_mean_pressure(i_chunk, material, hourglass, dt, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk !! pressure and trace out
    type(stress_chunk_t) :: unused
    logical :: is_damped

    is_damped = allocated(elements%retardation) .and. has_mean_dilatation(material) &
      .and. .not. allocated(material%eos)
    chunk%trace = 0.0_wp
    chunk%pressure = 0.0_wp
    if (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp .or. is_damped) &
      call form_increments(dt, chunk, unused)
    if (allocated(material%eos)) then
      call start_point_values(material, chunk)
      return
    end if
    if (has_mean_dilatation(material)) then
      call volumetric_stress(material%bulk, chunk%stretch, chunk%pressure)
      call add_start_pressure(i_chunk, 1, material, elements, chunk)
    end if
    call add_viscosity(i_chunk, material, hourglass, dt, elements, chunk)
    if (is_damped) call add_viscous_pressure(material%bulk, elements%retardation((i_chunk &
      - 1)*chunk_size + 1), chunk%trace, chunk%mid_area, dt, chunk%pressure, &
      elements%damping_stress(chunk_size*(16*(i_chunk - 1) + 3) + 1), &
      elements%damping_work(i_chunk))
  end subroutine form_mean_pressure

  !> Initialise the sums, and the hourglass patterns, which points do not have.
  pure subroutine start_points(is_axisymmetric, point, sums)
    logical, intent(in) :: is_axisymmetric
    type(element_chunk_t), intent(inout) :: point
    type(sums_t), intent(inout) :: sums

    point%is_axisymmetric = .false.
    point%hu = 0.0_wp
    point%hv = 0.0_wp
    point%qx = 0.0_wp
    point%qy = 0.0_wp
    if (is_axisymmetric) return
    sums%step%h = 0.0_wp
    sums%step%volume = huge(1.0_wp)
  end subroutine start_points

  !> Advance point `k` of a chunk and add its forces.
  pure subroutine advance_point(i_chunk, k, material, dt, elements, chunk, point, sums)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk, point
    type(sums_t), intent(inout) :: sums
    type(stress_chunk_t) :: stress

    call move_point(i_chunk, k, dt, elements, chunk, point, stress, sums)
    call advance_stress(i_chunk, k, material, chunk, point, elements, stress)
    if (allocated(material%eos)) call add_point_values(material, point, stress, chunk)
    sums%deviator(:, 1) = sums%deviator(:, 1) + point%volume*stress%sxx
    sums%deviator(:, 2) = sums%deviator(:, 2) + point%volume*stress%syy
    sums%deviator(:, 3) = sums%deviator(:, 3) + point%volume*stress%sxy
    if (material%is_plane_stress) call form_membrane_stress(material%follows_strain, stress)
    if (has_mean_dilatation(material)) then
      point%pressure = chunk%pressure
    else
      call volumetric_stress(material%bulk, point%stretch, point%pressure)
      call add_start_pressure(i_chunk, k, material, elements, point)
      point%pressure = point%pressure + chunk%pressure
    end if
    if (allocated(elements%retardation)) call add_damping(i_chunk, k, material, &
      .not. has_mean_dilatation(material), elements, point, stress)
    call form_forces(stress, point)
    if (chunk%is_axisymmetric) call add_hoop_force(k, sums%places(k), stress, point, chunk)
    call add_point_force(k, point, chunk)
  end subroutine advance_point

  !> Shape, increments of the step and volume of point `k`.
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
    if (chunk%is_axisymmetric) then
      call form_radii(k, elements%reference(first, 1), stride, chunk, point, sums%places(k))
      call add_hoop_strain(dt, sums%places(k), point, stress)
      point%trace = 0.0_wp
      if (dt > 0.0_wp) point%trace = (stress%dxx + stress%dyy)/dt + 3.0_wp*stress%hoop/dt
    else
      point%volume = 0.25_wp*point%area
      call add_point_sums(k, point, sums%step)
    end if
  end subroutine move_point

  !> Update the deviator of point `k`, or of the one point, by its law.
  pure subroutine advance_stress(i_chunk, k, material, chunk, point, elements, stress)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    type(element_chunk_t), intent(in) :: chunk    !! of the element
    type(element_chunk_t), intent(in) :: point    !! the element itself where it has one point
    type(block_state_t), intent(inout) :: elements
    type(stress_chunk_t), intent(inout) :: stress !! increments in, deviator out
    real(wp) :: ratio(chunk_size)
    integer :: first, slot
    logical :: has_points

    has_points = elements%point_start(i_chunk) > 0
    slot = (i_chunk - 1)*chunk_size + 1
    first = elements%point_start(i_chunk) + 3*chunk_size*(k - 1)
    elements%volume_change(i_chunk) = max(elements%volume_change(i_chunk), &
      stress%dt*largest_size(point%trace))
    if (has_points) then
      call load_deviator(elements%point_deviator(first), chunk_size, stress)
    else
      call load_deviator(elements%deviator(slot, 1), size(elements%reference, 1), stress)
    end if
    if (allocated(material%eos)) then
      if (has_points) then
        ratio = point%mid_area*(1.0_wp + point%stretch)/point%volume
      else
        ratio = point%mid_area*inverse_start(point)
      end if
      call load_point_state(i_chunk, material, ratio, chunk, point, elements, stress)
    end if
    if (material%is_plane_stress) then
      call update_sheet(i_chunk, k, material, point, elements, stress)
    else if (elements%history_start(i_chunk) > 0) then
      call update_stress(material, stress, elements%history(elements%history_start(i_chunk) &
        + (k - 1)*chunk_size*history_size(material)))
    else
      call update_stress(material, stress)
    end if
    if (has_points) then
      call store_deviator(stress, chunk_size, elements%point_deviator(first))
    else
      call store_deviator(stress, size(elements%reference, 1), elements%deviator(slot, 1))
    end if
    if (.not. allocated(material%eos)) elements%deviatoric_work(i_chunk) = &
      elements%deviatoric_work(i_chunk) + work_of_deviator(stress%work, point%mid_area)
  end subroutine advance_stress

  !> Add K times ln(J) of the stage before to the pressure of point `k`, or of the element.
  pure subroutine add_start_pressure(i_chunk, k, material, elements, point)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    type(block_state_t), intent(in) :: elements
    type(element_chunk_t), intent(inout) :: point

    if (.not. allocated(elements%start_dilatation)) return
    associate (first => (i_chunk - 1)*chunk_size + 1)
      point%pressure = point%pressure + material%bulk*elements%start_dilatation(first:first &
        + chunk_size - 1, k)
    end associate
  end subroutine add_start_pressure

  !> Add bulk viscosity to elements without an equation of state.
  pure subroutine add_viscosity(i_chunk, material, hourglass, dt, elements, chunk)
    integer, intent(in) :: i_chunk
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: work

    if (.not. (hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp)) return
    call add_bulk_viscosity(hourglass%quadratic, hourglass%linear, material%density, &
      material%sound_speed, dt, chunk, elements%viscous_pressure((i_chunk - 1)*chunk_size + 1), &
      work)
    elements%viscous_work(i_chunk) = elements%viscous_work(i_chunk) + work
  end subroutine add_viscosity

  !> Add the stress of stiffness damping of point `k`, or of the one point.
  pure subroutine add_damping(i_chunk, k, material, has_pressure, elements, point, stress)
    integer, intent(in) :: i_chunk, k
    type(material_t), intent(in) :: material
    logical, intent(in) :: has_pressure           !! the point has its own pressure
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: point
    type(stress_chunk_t), intent(inout) :: stress

    associate (n => 4*chunk_size*(4*(i_chunk - 1) + (k - 1)) + 1, &
      first => (i_chunk - 1)*chunk_size + 1)
      call add_viscous_deviator(material%shear, elements%retardation(first), point%mid_area, &
        stress, elements%damping_stress(n), elements%damping_work(i_chunk))
      if (has_pressure) call add_viscous_pressure(material%bulk, elements%retardation(first), &
        point%trace, point%mid_area, stress%dt, point%pressure, &
        elements%damping_stress(n + 3*chunk_size), elements%damping_work(i_chunk))
    end associate
  end subroutine add_damping

end module quad_m
