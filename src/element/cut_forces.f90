! SPDX-License-Identifier: MIT
!> Forces of single elements on their corners, for cross sections. The step sums element forces at
!> the nodes, so chunks with elements of cross sections are stepped a second time where a history
!> needs them, and then restored.
module cut_forces_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, scatter_forces
  use element_dispatch_m, only : gather_values, restore_values
  use eroding_tiles_m, only : advance_eroding_chunk
  use packed_buffer_m, only : packed_buffer_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size, local_kind, tile_t
  use model_m, only : model_t
  use quad_m, only : advance_chunk
  implicit none
  private
  public :: find_cut_forces, store_cut_chunks

contains

  !> Forces of the elements of all cross sections on their corners: internal force with hourglass
  !> control, bulk viscosity and stiffness damping, of the step from `elements`, or from `before`
  !> where that step is over.
  subroutine find_cut_forces(model, chunks, motion, times, elements, force, before)
    type(model_t), intent(in) :: model
    integer, intent(in) :: chunks(2)                   !! first and last chunk of this process
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node)
    real(wp), intent(in) :: times(2)                   !! time of the motion, and the step before it
    type(block_state_t), intent(inout) :: elements     !! unchanged on return
    real(wp), intent(inout) :: force(:, :)             !! (8, n) x, y of four corners of each;
                                                       !! unchanged for elements of other processes
    type(packed_buffer_t), intent(inout), optional :: before(:) !! of `store_cut_chunks`
    type(packed_buffer_t) :: present_values
    real(wp), allocatable :: of_slots(:, :, :) !! (8, chunk_size, n_chunk) in chunks of cross
                                               !! sections
    type(element_chunk_t) :: chunk
    integer, allocatable :: list(:)
    integer :: i, k, n, slot
    integer(local_kind), parameter :: own(4*chunk_size) = [(int(i, local_kind), i=1, 4*chunk_size)]

    list = cut_chunks(model)
    allocate (of_slots(8, chunk_size, model%layout%n_chunk))
    do i = 1, size(list)
      if (list(i) < chunks(1) .or. list(i) > chunks(2)) cycle
      call gather_values(tile_t(list(i), list(i)), elements, present_values)
      if (present(before)) call restore_values(before(i), elements)
      if (model%erodes) then
        call advance_eroding_chunk(model, list(i), motion, times, elements, chunk)
      else
        call advance_chunk(model, list(i), model%layout%slot_nodes(1, (list(i) - 1)*chunk_size &
          + 1), motion, times(2), elements, chunk)
      end if
      call restore_values(present_values, elements)
      ! Minus the internal force; the third corner of a triangle is also its fourth.
      of_slots(:, :, list(i)) = 0.0_wp
      call scatter_forces(model%layout%chunk_elements(list(i)), own, chunk, &
        of_slots(1, 1, list(i)))
      of_slots(:, :, list(i)) = -of_slots(:, :, list(i))
    end do
    n = 0
    do i = 1, size(model%controls%output%cross_sections)
      do k = 1, size(model%controls%output%cross_sections(i)%elements)
        n = n + 1
        slot = model%layout%element_slot(model%controls%output%cross_sections(i)%elements(k)) - 1
        if (slot/chunk_size + 1 < chunks(1) .or. slot/chunk_size + 1 > chunks(2)) cycle
        force(:, n) = of_slots(:, mod(slot, chunk_size) + 1, slot/chunk_size + 1)
      end do
    end do
  end subroutine find_cut_forces

  !> Copy the chunks with elements of cross sections, before a step.
  subroutine store_cut_chunks(model, elements, stored)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(inout) :: elements     !! unchanged
    type(packed_buffer_t), allocatable, intent(inout) :: stored(:)
    integer, allocatable :: list(:)
    integer :: i

    list = cut_chunks(model)
    if (.not. allocated(stored)) allocate (stored(size(list)))
    do i = 1, size(list)
      call gather_values(tile_t(list(i), list(i)), elements, stored(i))
    end do
  end subroutine store_cut_chunks

  !> Chunks with elements of cross sections, each once, in rising order.
  pure function cut_chunks(model) result(list)
    type(model_t), intent(in) :: model
    integer, allocatable :: list(:)
    logical :: is_cut(model%layout%n_chunk)
    integer :: i

    is_cut = .false.
    do i = 1, size(model%controls%output%cross_sections)
      associate (elements => model%controls%output%cross_sections(i)%elements)
        is_cut((model%layout%element_slot(elements) - 1)/chunk_size + 1) = .true.
      end associate
    end do
    list = pack([(i, i=1, size(is_cut))], is_cut)
  end function cut_chunks

end module cut_forces_m
