! SPDX-License-Identifier: MIT
!> Forces of single elements on their corners, which the step adds up before anyone can ask for
!> them: where a history wants them their chunks are stepped a second time, and then are what they
!> were.
module cut_forces_m
  use block_state_m, only : block_state_t, stays
  use element_chunk_m, only : element_chunk_t, scatter_forces
  use element_dispatch_m, only : take_values, put_values
  use eroding_tiles_m, only : add_eroding_tile_forces, take_nodes
  use packed_buffer_m, only : packed_buffer_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size, local_kind, tile_t
  use model_m, only : model_t
  use quad_m, only : advance_chunk
  implicit none
  private
  public :: find_cut_forces, keep_cut_chunks

contains

  !> What the elements of all cross sections put on their corners: internal force with that of
  !> hourglass control, bulk viscosity and stiffness damping, as the step from `elements` gives it,
  !> or where that is over the step from `before`.
  subroutine find_cut_forces(model, chunks, motion, times, elements, force, before)
    type(model_t), intent(in) :: model
    integer, intent(in) :: chunks(2)                   !! first and last one that are known
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node)
    real(wp), intent(in) :: times(2)                   !! of the motion, and the step that led there
    type(block_state_t), intent(inout) :: elements     !! on return as they were
    real(wp), intent(inout) :: force(:, :)             !! (8, n) x, y of four corners of each; it
                                                       !! stays of elements in other chunks
    type(packed_buffer_t), intent(inout), optional :: before(:) !! of `keep_cut_chunks`
    type(packed_buffer_t) :: present_values
    real(wp), allocatable :: of_slots(:, :, :) !! (8, chunk_size, n_chunk) where elements are cut
    real(wp), allocatable :: of_tile(:, :)
    integer, allocatable :: list(:)
    integer :: i, k, n, slot

    list = cut_chunks(model)
    if (model%erodes) allocate (of_tile(2, model%layout%n_local))
    allocate (of_slots(8, chunk_size, model%layout%n_chunk))
    do i = 1, size(list)
      if (list(i) < chunks(1) .or. list(i) > chunks(2)) cycle
      call take_values(tile_of(list(i)), elements, present_values)
      if (present(before)) call put_values(before(i), elements)
      call step_chunk(model, list(i), motion, times(2), elements, &
        of_slots(:, :, list(i)))
      call put_values(present_values, elements)
      if (model%erodes) then
        ! Elements that have left the mesh, or leave it in this step, do not push.
        call add_eroding_tile_forces(model, tile_of(list(i)), motion, times, elements, of_tile)
        do k = 1, chunk_size
          if (elements%erosion%status((list(i) - 1)*chunk_size + k) /= stays) &
            of_slots(:, k, list(i)) = 0.0_wp
        end do
        call put_values(present_values, elements)
      end if
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

  !> Copy the chunks that have elements of cross sections, before a step.
  subroutine keep_cut_chunks(model, elements, kept)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(inout) :: elements     !! stay as they are
    type(packed_buffer_t), allocatable, intent(inout) :: kept(:)
    integer, allocatable :: list(:)
    integer :: i

    list = cut_chunks(model)
    if (.not. allocated(kept)) allocate (kept(size(list)))
    do i = 1, size(list)
      call take_values(tile_of(list(i)), elements, kept(i))
    end do
  end subroutine keep_cut_chunks

  !> What each element of a chunk puts on its four corners, x and y of each: minus its internal
  !> force. The third of a triangle is its fourth as well.
  subroutine step_chunk(model, i_chunk, motion, dt, elements, of_slots)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    real(wp), intent(inout) :: of_slots(8, chunk_size)
    integer :: i
    type(element_chunk_t) :: chunk
    integer(local_kind), parameter :: own(4*chunk_size) = [(int(i, local_kind), i=1, 4*chunk_size)]
    integer :: first, nodes(4, chunk_size)

    first = (i_chunk - 1)*chunk_size + 1
    nodes = model%layout%slot_nodes(:, first:first + chunk_size - 1)
    if (model%erodes) call take_nodes(model%layout%slot_nodes(:, first:first + chunk_size - 1), &
      elements%erosion%status(first:first + chunk_size - 1), nodes)
    call advance_chunk(model, i_chunk, nodes, motion, dt, elements, chunk)
    of_slots = 0.0_wp
    call scatter_forces(model%layout%chunk_elements(i_chunk), own, chunk, of_slots)
    of_slots = -of_slots
  end subroutine step_chunk

  !> A chunk alone.
  pure function tile_of(i_chunk) result(tile)
    integer, intent(in) :: i_chunk
    type(tile_t) :: tile

    tile%first_chunk = i_chunk
    tile%last_chunk = i_chunk
  end function tile_of

  !> Chunks with elements of cross sections, each once, rising.
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
