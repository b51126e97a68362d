! SPDX-License-Identifier: MIT
!> Stable steps of the single elements of a chunk, by the kernels of the step itself.
module element_steps_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, gather_chunk
  use element_dispatch_m, only : point_count
  use element_time_step_m, only : single_steps
  use exposed_step_m, only : limit_exposed
  use full_time_step_m, only : step_sums_t, start_sums, add_point_sums, full_step
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use parts_m, only : hourglass_t, material_t, part_t, gives_pressure, hourglass_assumed
  use quad_kinematics_m, only : form_present_shape, form_increments
  use quad_points_m, only : n_point, form_point
  use round_chunk_m, only : round_chunk_t, gather_round, reference_mass
  use round_full_step_m, only : single_round_full_steps
  use round_hourglass_m, only : form_resistance, form_assumed_resistance
  use round_kinematics_m, only : form_round_shape, form_round_increments
  use round_points_m, only : round_point_t, form_radii
  use round_time_step_m, only : single_round_steps
  use stress_chunk_m, only : stress_chunk_t
  use eos_pressure_m, only : finish_limits
  use law_pressure_m, only : take_now
  implicit none
  private
  public :: shape_steps, chunk_steps, damped_step

contains

  !> Steps of elements of one part that have these nodes and shapes at time zero.
  subroutine shape_steps(model, part, material, nodes, shape, motion, dt, steps)
    type(model_t), intent(in) :: model
    type(part_t), intent(in) :: part
    type(material_t), intent(in) :: material         !! as it is now
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: shape(:, :)              !! (chunk_size, 6 or n_round_reference)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: dt                       !! step that led here; 0: no rates
    real(wp), intent(out) :: steps(chunk_size)       !! s

    if (model%is_round) then
      call round_steps(model, part, material, nodes, shape, motion, dt, steps)
    else
      call plane_steps(model, part, material, nodes, shape, motion, dt, steps)
    end if
  end subroutine shape_steps

  !> Steps of the elements of a chunk, of padding too. With an equation of state the stiffest of
  !> them stands for all.
  subroutine chunk_steps(model, elements, i_chunk, motion, dt, steps)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: dt
    real(wp), intent(out) :: steps(chunk_size)
    type(material_t) :: now, other
    integer :: first, last, i

    first = (i_chunk - 1)*chunk_size + 1
    last = first + chunk_size - 1
    associate (part => model%parts(model%layout%chunk_part(i_chunk)))
      call take_now(model%materials(part%material), elements, first, now)
      if (allocated(model%materials(part%material)%eos) .or. &
        gives_pressure(model%materials(part%material))) then
        do i = first + 1, first + model%layout%chunk_elements(i_chunk) - 1
          call take_now(model%materials(part%material), elements, i, other)
          now%bulk = max(now%bulk, other%bulk)
          now%shear = max(now%shear, other%shear)
          now%sound_speed = max(now%sound_speed, other%sound_speed)
        end do
      end if
      call shape_steps(model, part, now, model%layout%slot_nodes(:, first:last), &
        elements%reference(first:last, :), motion, dt, steps)
    end associate
    call limit_exposed(model, elements, i_chunk, motion, steps)
    if (allocated(elements%retardation)) steps = damped_step(steps, &
      elements%retardation(first:last))
  end subroutine chunk_steps

  !> Step under damping by stiffness, whose forces are those of v(n-1/2): with zeta = beta omega/2
  !> and omega = 2/step it is 2 (sqrt(1 + zeta^2) - zeta)/omega.
  pure elemental function damped_step(step, retardation) result(limit)
    real(wp), intent(in) :: step         !! without damping, s
    real(wp), intent(in) :: retardation  !! beta, s
    real(wp) :: limit

    limit = step
    if (retardation > 0.0_wp) &
      limit = step/(retardation/step + sqrt(1.0_wp + (retardation/step)**2))
  end function damped_step

  !> Steps of plane quads.
  subroutine plane_steps(model, part, material, nodes, shape, motion, dt, steps)
    type(model_t), intent(in) :: model
    type(part_t), intent(in) :: part
    type(material_t), intent(in) :: material
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: shape(:, :)
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    real(wp), intent(out) :: steps(chunk_size)
    type(element_chunk_t) :: chunk
    type(stress_chunk_t) :: unused
    real(wp) :: start(chunk_size, 6)

    start = shape(:, :6)
    call gather_chunk(nodes, motion, chunk)
    call form_present_shape(start, chunk_size, chunk)
    call form_increments(dt, chunk, unused)
    if (point_count(model%sections(part%section)) == 1) then
      call single_steps(model%controls%length_rule, material%sound_speed, part%hourglass, nodes, &
        chunk, steps)
    else
      call full_steps(material, part%hourglass, nodes, start, chunk, steps)
    end if
    call slow_fluid(model%materials(part%material), material, chunk%stretch, steps)
  end subroutine plane_steps

  !> Steps of a viscous fluid from those without viscosity.
  pure subroutine slow_fluid(fluid, now, stretch, steps)
    type(material_t), intent(in) :: fluid, now
    real(wp), intent(in) :: stretch(chunk_size)      !! V/V0 - 1
    real(wp), intent(inout) :: steps(chunk_size)
    real(wp) :: same(chunk_size), unused
    integer :: i

    if (.not. fluid%viscosity > 0.0_wp) return
    unused = 1.0_wp
    do i = 1, chunk_size
      same = stretch(i)
      call finish_limits(fluid, now, same, steps(i), unused)
    end do
  end subroutine slow_fluid

  !> Steps of fully integrated plane quads.
  subroutine full_steps(material, hourglass, nodes, shape, chunk, steps)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: shape(chunk_size, 6) !! at time zero
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: steps(chunk_size)
    type(element_chunk_t) :: point
    type(step_sums_t) :: sums
    real(wp) :: point_shape(chunk_size, 6), limit, volume
    integer :: k

    point%hu = 0.0_wp
    point%hv = 0.0_wp
    call start_sums(sums)
    do k = 1, n_point
      call form_point(k, chunk_size, shape, chunk, point_shape, point)
      call form_present_shape(point_shape, chunk_size, point)
      call add_point_sums(k, point, sums)
    end do
    call full_step(material, hourglass, nodes, chunk, sums, limit, volume, steps)
  end subroutine full_steps

  !> Steps of round quads, with the hourglass control that has a share in them.
  subroutine round_steps(model, part, material, nodes, shape, motion, dt, steps)
    type(model_t), intent(in) :: model
    type(part_t), intent(in) :: part
    type(material_t), intent(in) :: material
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: shape(:, :)
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    real(wp), intent(out) :: steps(chunk_size)
    type(element_chunk_t) :: chunk, point
    type(round_chunk_t) :: round
    type(round_point_t) :: places(n_point)
    type(stress_chunk_t) :: unused
    real(wp) :: start(chunk_size, size(shape, 2)), point_shape(chunk_size, 6)
    integer :: k

    start = shape
    call gather_round(nodes, motion, chunk, round)
    call form_round_shape(start, chunk_size, chunk, round)
    call form_round_increments(dt, chunk, round, unused)
    if (point_count(model%sections(part%section)) == 1) then
      if (part%hourglass%form == hourglass_assumed) then
        call form_assumed_resistance(model%materials(part%material), part%hourglass, chunk, round)
      else
        call form_resistance(model%materials(part%material), part%hourglass, chunk, round)
      end if
      call single_round_steps(material, part%hourglass, start(1, reference_mass), chunk_size, &
        chunk, round, steps)
      call slow_fluid(model%materials(part%material), material, chunk%stretch, steps)
      return
    end if
    do k = 1, n_point
      point%hu = 0.0_wp
      point%hv = 0.0_wp
      call form_point(k, chunk_size, start, chunk, point_shape, point)
      call form_present_shape(point_shape, chunk_size, point)
      call form_radii(k, start, chunk_size, chunk, round, point, places(k))
    end do
    call single_round_full_steps(material, part%hourglass, start(1, reference_mass), chunk_size, &
      chunk, places, steps)
    call slow_fluid(model%materials(part%material), material, chunk%stretch, steps)
  end subroutine round_steps

end module element_steps_m
