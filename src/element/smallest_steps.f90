! SPDX-License-Identifier: MIT
!> The elements that rule the time step: stable steps of single elements, by the
!> kernels of the step itself.
module smallest_steps_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, gather_chunk
  use element_dispatch_m, only : point_count
  use element_time_step_m, only : stable_step
  use eos_pressure_m, only : take_present
  use erosion_state_m, only : stays
  use full_time_step_m, only : step_sums_t, start_sums, add_point_sums, full_step
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use parts_m, only : hourglass_t, material_t
  use quad_kinematics_m, only : form_present_shape, form_increments
  use quad_points_m, only : n_point, form_point
  use round_chunk_m, only : round_chunk_t, gather_round, n_round_reference, &
    reference_mass
  use round_full_step_m, only : round_full_step
  use round_hourglass_m, only : form_resistance
  use round_kinematics_m, only : form_round_shape, form_round_increments
  use round_points_m, only : round_point_t, form_radii
  use round_time_step_m, only : round_step
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: find_smallest_steps, step_of_element

contains

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
    real(wp) :: step
    integer :: i, i_chunk, i_slot

    allocate (found(0), steps(0))
    allocate (seen(size(elements%time_limit)), source=.false.)
    do i = 1, min(n, size(seen))
      i_chunk = minloc(elements%time_limit, dim=1, mask=.not. seen)
      seen(i_chunk) = .true.
      do i_slot = (i_chunk - 1)*chunk_size + 1, i_chunk*chunk_size
        if (model%layout%slot_element(i_slot) == 0) cycle
        if (allocated(elements%erosion)) then
          if (elements%erosion%status(i_slot) /= stays) cycle
        end if
        step = step_of_element(model, elements, i_slot, motion)
        call insert(n, model%layout%slot_element(i_slot), step, found, steps)
      end do
    end do
  end subroutine find_smallest_steps

  !> Stable step of the element in one slot.
  function step_of_element(model, elements, i_slot, motion) result(step)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    integer, intent(in) :: i_slot
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp) :: step, reference(6), round_reference(n_round_reference)

    if (model%is_round) then
      round_reference = elements%reference(i_slot, :)
      step = round_step_of_slot(model, elements, round_reference, i_slot, motion)
    else
      reference = elements%reference(i_slot, :6)
      step = step_of_slot(model, elements, reference, i_slot, motion)
    end if
  end function step_of_element

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

  !> Stable step of the element in one slot: that of a chunk which holds nothing else.
  function step_of_slot(model, elements, reference, i_slot, motion) result(step)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    real(wp), intent(in) :: reference(6)             !! its shape at time zero
    integer, intent(in) :: i_slot
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp) :: step
    type(element_chunk_t) :: chunk
    type(stress_chunk_t) :: unused
    type(material_t) :: now
    real(wp) :: shape(chunk_size, 6), volume
    integer :: nodes(4, chunk_size)

    nodes = spread(model%layout%slot_nodes(:, i_slot), 2, chunk_size)
    shape = spread(reference, 1, chunk_size)
    call gather_chunk(nodes, motion, chunk)
    call form_present_shape(shape, chunk_size, chunk)
    call form_increments(0.0_wp, chunk, unused)
    associate (part => model%parts(model%layout%chunk_part((i_slot - 1)/chunk_size + 1)))
      call take_present(model%materials(part%material), elements, i_slot, now)
      associate (material => now)
        if (point_count(model%sections(part%section)) == 1) then
          call stable_step(model%controls%length_rule, material%sound_speed, part%hourglass, &
            nodes, chunk, step, volume)
        else
          step = full_step_of(material, part%hourglass, nodes, shape, chunk)
        end if
      end associate
    end associate
  end function step_of_slot

  !> The same for round quads, with the hourglass control that has a share in their step.
  function round_step_of_slot(model, elements, reference, i_slot, motion) result(step)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    real(wp), intent(in) :: reference(n_round_reference) !! its shape at time zero
    integer, intent(in) :: i_slot
    real(wp), intent(in), contiguous :: motion(:, :)     !! (4, n_node)
    real(wp) :: step
    type(element_chunk_t) :: chunk
    type(element_chunk_t) :: point
    type(round_chunk_t) :: round
    type(round_point_t) :: places(n_point)
    type(stress_chunk_t) :: unused
    type(material_t) :: now
    real(wp) :: shape(chunk_size, n_round_reference), point_shape(chunk_size, 6), volume
    integer :: nodes(4, chunk_size), k

    nodes = spread(model%layout%slot_nodes(:, i_slot), 2, chunk_size)
    shape = spread(reference, 1, chunk_size)
    call gather_round(nodes, motion, chunk, round)
    call form_round_shape(shape, chunk_size, chunk, round)
    call form_round_increments(0.0_wp, chunk, round, unused)
    associate (part => model%parts(model%layout%chunk_part((i_slot - 1)/chunk_size + 1)))
      call take_present(model%materials(part%material), elements, i_slot, now)
      associate (material => now)
        chunk%area = round%area
        if (point_count(model%sections(part%section)) == 1) then
          call form_resistance(model%materials(part%material), part%hourglass, round)
          call round_step(material, part%hourglass, shape(1, reference_mass), chunk_size, chunk, &
            round, step, volume)
        else
          do k = 1, n_point
            point%hu = 0.0_wp
            point%hv = 0.0_wp
            call form_point(k, chunk_size, shape, chunk, point_shape, point)
            call form_present_shape(point_shape, chunk_size, point)
            call form_radii(k, shape, chunk_size, chunk, round, point, places(k))
          end do
          call round_full_step(material, part%hourglass, shape(1, reference_mass), chunk_size, &
            chunk, places, step, volume)
        end if
      end associate
    end associate
  end function round_step_of_slot

  !> The same for full integration.
  function full_step_of(material, hourglass, nodes, shape, chunk) result(step)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    integer, intent(in) :: nodes(4, chunk_size)
    real(wp), intent(in) :: shape(chunk_size, 6) !! at time zero
    type(element_chunk_t), intent(in) :: chunk
    real(wp) :: step
    type(element_chunk_t) :: point
    type(step_sums_t) :: sums
    real(wp) :: point_shape(chunk_size, 6), volume
    integer :: k

    point%hu = 0.0_wp
    point%hv = 0.0_wp
    call start_sums(sums)
    do k = 1, n_point
      call form_point(k, chunk_size, shape, chunk, point_shape, point)
      call form_present_shape(point_shape, chunk_size, point)
      call add_point_sums(k, point, sums)
    end do
    call full_step(material, hourglass, nodes, chunk, sums, step, volume)
  end function full_step_of

end module smallest_steps_m
