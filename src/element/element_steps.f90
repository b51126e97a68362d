! SPDX-License-Identifier: MIT
!> Stable steps of the single elements, by the kernels of the step itself, and the elements that rule
!> the time step.
module element_steps_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, gather_motion, reference_mass
  use element_dispatch_m, only : point_count
  use eos_pressure_m, only : finish_limits
  use erosion_state_m, only : stays
  use exposed_step_m, only : limit_exposed, exposed_step
  use hourglass_m, only : form_resistance
  use law_pressure_m, only : take_now
  use layout_m, only : chunk_size, slot_part
  use model_m, only : model_t
  use parts_m, only : hourglass_t, hourglass_viscous, material_t, part_t, gives_pressure
  use quad_kinematics_m, only : form_shape, form_increments
  use quad_points_m, only : n_point, round_point_t, step_sums_t, form_point, form_radii, &
    start_sums, add_point_sums
  use stable_step_m, only : stable_step, round_step, full_step, round_full_step
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: chunk_steps, scaled_step, is_damped, find_smallest_steps, step_of_element

contains

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

  !> Steps of elements of one part that have these nodes and shapes at time zero, with the hourglass
  !> control that has a share in them.
  subroutine shape_steps(model, part, material, nodes, shape, motion, dt, steps)
    type(model_t), intent(in) :: model
    type(part_t), intent(in) :: part
    type(material_t), intent(in) :: material         !! as it is now
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: shape(:, :)              !! (chunk_size, 6 or n_round_reference)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: dt                       !! step that led here; 0: no rates
    real(wp), intent(out) :: steps(chunk_size)       !! s
    type(element_chunk_t) :: chunk
    type(stress_chunk_t) :: unused
    real(wp) :: start(chunk_size, size(shape, 2)), same(chunk_size), limit, volume
    integer :: i

    start = shape
    call gather_motion(model%is_round, nodes, motion, chunk)
    call form_shape(start, chunk_size, chunk)
    call form_increments(dt, chunk, unused)
    if (point_count(model%sections(part%section)) > 1) then
      call full_steps(material, part%hourglass, nodes, start, chunk, steps)
    else if (model%is_round) then
      call form_resistance(model%materials(part%material), part%hourglass, chunk)
      call round_step(material, part%hourglass, start(1, reference_mass), chunk_size, chunk, limit, &
        volume, steps)
    else
      call stable_step(model%controls%length_rule, material%sound_speed, part%hourglass, nodes, &
        chunk, limit, volume, steps)
    end if
    associate (fluid => model%materials(part%material))
      if (.not. fluid%viscosity > 0.0_wp) return
      do i = 1, chunk_size
        same = chunk%stretch(i)
        call finish_limits(fluid, material, same, steps(i), volume)
      end do
    end associate
  end subroutine shape_steps

  !> Steps of fully integrated quads.
  pure subroutine full_steps(material, hourglass, nodes, shape, chunk, steps)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: shape(chunk_size, *) !! at time zero
    type(element_chunk_t), intent(in) :: chunk
    real(wp), intent(out) :: steps(chunk_size)
    type(element_chunk_t) :: point
    type(step_sums_t) :: sums
    type(round_point_t) :: places(n_point)
    real(wp) :: point_shape(chunk_size, 6), limit, volume
    integer :: k

    point%is_round = .false.
    point%hu = 0.0_wp
    point%hv = 0.0_wp
    call start_sums(sums)
    do k = 1, n_point
      call form_point(k, chunk_size, shape, chunk, point_shape, point)
      call form_shape(point_shape, chunk_size, point)
      if (chunk%is_round) then
        call form_radii(k, shape, chunk_size, chunk, point, places(k))
      else
        call add_point_sums(k, point, sums)
      end if
    end do
    if (chunk%is_round) then
      call round_full_step(material, hourglass, shape(1, reference_mass), chunk_size, chunk, places, &
        limit, volume, steps)
    else
      call full_step(material, hourglass, nodes, chunk, sums, limit, volume, steps)
    end if
  end subroutine full_steps

  !> The `n` elements of the smallest stable steps, or all where there are fewer, rising. They lie
  !> in the chunks of the `n` smallest limits, which the last forces have left.
  subroutine find_smallest_steps(model, elements, motion, n, found, steps)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    integer, intent(in) :: n
    integer, allocatable, intent(out) :: found(:)     !! element indices
    real(wp), allocatable, intent(out) :: steps(:)    !! s
    logical, allocatable :: seen(:)
    real(wp) :: of_slots(chunk_size)
    integer :: i, k, i_chunk, i_slot

    allocate (found(0), steps(0))
    allocate (seen(size(elements%time_limit)), source=.false.)
    do i = 1, min(n, size(seen))
      i_chunk = minloc(elements%time_limit, dim=1, mask=.not. seen)
      seen(i_chunk) = .true.
      call find_steps(model, elements, i_chunk, motion, of_slots)
      do k = 1, chunk_size
        i_slot = (i_chunk - 1)*chunk_size + k
        if (model%layout%slot_element(i_slot) == 0) cycle
        if (allocated(elements%erosion)) then
          if (elements%erosion%status(i_slot) /= stays) cycle
        end if
        call insert(n, model%layout%slot_element(i_slot), of_slots(k), found, steps)
      end do
    end do
  end subroutine find_smallest_steps

  !> Stable steps of the elements of a chunk: one by one only where its law gives each a sound speed
  !> of its own.
  subroutine find_steps(model, elements, i_chunk, motion, steps)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)  !! (4, n_node)
    real(wp), intent(out) :: steps(chunk_size)        !! s
    integer :: k, first

    first = (i_chunk - 1)*chunk_size + 1
    associate (material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      if (allocated(material%eos) .or. gives_pressure(material)) then
        do k = 1, model%layout%chunk_elements(i_chunk)
          steps(k) = step_of_element(model, elements, first + k - 1, motion)
        end do
        return
      end if
    end associate
    call chunk_steps(model, elements, i_chunk, motion, 0.0_wp, steps)
    do k = 1, model%layout%chunk_elements(i_chunk)
      steps(k) = scaled_step(model, first + k - 1, steps(k), elements)
    end do
  end subroutine find_steps

  !> Put one element into the rising list, which keeps `n` at most.
  pure subroutine insert(n, element, step, found, steps)
    integer, intent(in) :: n
    integer, intent(in) :: element
    real(wp), intent(in) :: step
    integer, allocatable, intent(inout) :: found(:)
    real(wp), allocatable, intent(inout) :: steps(:)
    integer :: k

    k = count(steps <= step)
    if (k >= n) return
    found = [found(:k), element, found(k + 1:)]
    steps = [steps(:k), step, steps(k + 1:)]
    if (size(found) <= n) return
    found = found(:n)
    steps = steps(:n)
  end subroutine insert

  !> Stable step of the element in one slot, as its memory has it: that of a chunk which holds
  !> nothing else.
  function step_of_element(model, elements, i_slot, motion) result(step)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_slot
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp) :: step
    type(material_t) :: now
    real(wp) :: steps(chunk_size), shape(chunk_size, size(elements%reference, 2))
    integer :: nodes(4, chunk_size), k

    do k = 1, chunk_size
      nodes(:, k) = model%layout%slot_nodes(:, i_slot)
    end do
    do k = 1, size(shape, 2)
      shape(:, k) = elements%reference(i_slot, k)
    end do
    associate (part => model%parts(model%layout%chunk_part((i_slot - 1)/chunk_size + 1)))
      call take_now(model%materials(part%material), elements, i_slot, now)
      call shape_steps(model, part, now, nodes, shape, motion, 0.0_wp, steps)
    end associate
    step = min(steps(1), exposed_step(model, elements, i_slot, motion))
    if (allocated(elements%retardation)) step = damped_step(step, elements%retardation(i_slot))
    step = scaled_step(model, i_slot, step, elements)
  end function step_of_element

  !> Stable step of the element in a slot with its mass.
  pure function scaled_step(model, slot, step, elements) result(scaled)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp), intent(in) :: step                 !! with the mass of its density
    type(block_state_t), intent(in) :: elements
    real(wp) :: scaled

    scaled = step
    if (.not. allocated(elements%mass_ratio)) return
    associate (ratio => elements%mass_ratio(slot))
      scaled = step*sqrt(ratio)
      if (ratio < 1.0_wp) then
        if (is_damped(model, model%parts(slot_part(model%layout, slot)))) scaled = step*ratio
      end if
    end associate
  end function scaled_step

  !> Whether something resists the rates of a part.
  pure function is_damped(model, part) result(damped)
    type(model_t), intent(in) :: model
    type(part_t), intent(in) :: part
    logical :: damped

    associate (hourglass => part%hourglass)
      damped = model%materials(part%material)%viscosity > 0.0_wp &
        .or. hourglass%quadratic > 0.0_wp .or. hourglass%linear > 0.0_wp &
        .or. (hourglass%form == hourglass_viscous .and. hourglass%coefficient > 0.0_wp &
        .and. .not. model%sections(part%section)%is_full) .or. abs(part%stiffness_damping) > 0.0_wp
    end associate
  end function is_damped

end module element_steps_m
