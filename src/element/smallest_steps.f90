! SPDX-License-Identifier: MIT
!> The elements that rule the time step: stable steps of single elements, by the
!> kernels of the step itself.
module smallest_steps_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use erosion_state_m, only : stays
  use exposed_step_m, only : exposed_step
  use element_steps_m, only : shape_steps, chunk_steps, damped_step
  use law_pressure_m, only : take_now
  use layout_m, only : chunk_size
  use mass_scaling_m, only : scaled_step
  use model_m, only : model_t
  use parts_m, only : material_t, gives_pressure
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

end module smallest_steps_m
