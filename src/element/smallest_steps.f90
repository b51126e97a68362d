! SPDX-License-Identifier: MIT
!> The elements that rule the time step: stable steps of single elements, by the
!> kernels of the step itself.
module smallest_steps_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use erosion_state_m, only : stays
  use element_steps_m, only : shape_steps, damped_step
  use law_pressure_m, only : take_now
  use layout_m, only : chunk_size
  use mass_scaling_m, only : scaled_step
  use model_m, only : model_t
  use parts_m, only : material_t
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
        call insert(n, model%layout%slot_element(i_slot), &
          step_of_element(model, elements, i_slot, motion), found, steps)
      end do
    end do
  end subroutine find_smallest_steps

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
    integer :: nodes(4, chunk_size)

    nodes = spread(model%layout%slot_nodes(:, i_slot), 2, chunk_size)
    shape = spread(elements%reference(i_slot, :), 1, chunk_size)
    associate (part => model%parts(model%layout%chunk_part((i_slot - 1)/chunk_size + 1)))
      call take_now(model%materials(part%material), elements, i_slot, now)
      call shape_steps(model, part, now, nodes, shape, motion, 0.0_wp, steps)
    end associate
    step = steps(1)
    if (allocated(elements%retardation)) step = damped_step(step, elements%retardation(i_slot))
    step = scaled_step(model, i_slot, step, elements)
  end function step_of_element

end module smallest_steps_m
