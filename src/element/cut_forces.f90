! SPDX-License-Identifier: MIT
!> Forces of single elements on their corners, which the step adds up before anyone can ask for
!> them: where a history wants them their chunks are stepped a second time, on a copy.
module cut_forces_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t
  use element_dispatch_m, only : advance_chunk
  use eroding_tiles_m, only : add_eroding_tile_forces, take_nodes
  use erosion_state_m, only : stays
  use kinds_m, only : wp
  use layout_m, only : chunk_size, tile_t
  use model_m, only : model_t
  use round_chunk_m, only : round_chunk_t
  implicit none
  private
  public :: find_cut_forces

contains

  !> What the elements of all cross sections put on their corners: internal force with that of
  !> hourglass control, bulk viscosity and stiffness damping, as the step from `elements` gives it.
  subroutine find_cut_forces(model, chunks, motion, times, elements, force)
    type(model_t), intent(in) :: model
    integer, intent(in) :: chunks(2)                   !! first and last one that are known
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node)
    real(wp), intent(in) :: times(2)                   !! of the motion, and the step that led there
    type(block_state_t), intent(in) :: elements        !! before that step
    real(wp), intent(inout) :: force(:, :)             !! (8, n) x, y of four corners of each; it
                                                       !! stays of elements in other chunks
    type(block_state_t) :: copy
    type(element_chunk_t) :: chunk
    type(round_chunk_t) :: round
    real(wp), allocatable :: of_slots(:, :)
    logical, allocatable :: is_cut(:)
    integer :: i_chunk, i, first, nodes(4, chunk_size)

    call mark_chunks(model, is_cut)
    copy = elements
    allocate (of_slots(8, model%layout%n_slot))
    do i_chunk = chunks(1), chunks(2)
      if (.not. is_cut(i_chunk)) cycle
      first = (i_chunk - 1)*chunk_size + 1
      nodes = model%layout%slot_nodes(:, first:first + chunk_size - 1)
      if (model%erodes) call take_nodes(model%layout%slot_nodes(:, first:first + chunk_size - 1), &
        elements%erosion%status(first:first + chunk_size - 1), nodes)
      call advance_chunk(model, i_chunk, nodes, motion, times(2), copy, chunk, round)
      do i = 1, model%layout%chunk_elements(i_chunk)
        of_slots(:, first + i - 1) = corner_forces(model%is_round, i, chunk, round)
      end do
    end do
    if (model%erodes) call clear_gone(model, is_cut, chunks, motion, times, elements, of_slots)
    call take_slots(model, chunks, of_slots, force)
  end subroutine find_cut_forces

  !> Elements that have left the mesh, or leave it in this step, do not push.
  subroutine clear_gone(model, is_cut, chunks, motion, times, elements, of_slots)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_cut(:)
    integer, intent(in) :: chunks(2)
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: times(2)
    type(block_state_t), intent(in) :: elements
    real(wp), intent(inout) :: of_slots(:, :)
    type(block_state_t) :: copy
    real(wp), allocatable :: force(:, :)
    integer :: i_chunk, slot

    copy = elements
    allocate (force(2, model%layout%n_local))
    do i_chunk = chunks(1), chunks(2)
      if (.not. is_cut(i_chunk)) cycle
      call add_eroding_tile_forces(model, tile_t(first_chunk=i_chunk, last_chunk=i_chunk), motion, &
        times, copy, force)
      do slot = (i_chunk - 1)*chunk_size + 1, i_chunk*chunk_size
        if (copy%erosion%status(slot) /= stays) of_slots(:, slot) = 0.0_wp
      end do
    end do
  end subroutine clear_gone

  !> Chunks with elements of cross sections.
  pure subroutine mark_chunks(model, is_cut)
    type(model_t), intent(in) :: model
    logical, allocatable, intent(out) :: is_cut(:)
    integer :: i

    allocate (is_cut(model%layout%n_chunk), source=.false.)
    associate (sections => model%controls%output%cross_sections)
      do i = 1, size(sections)
        is_cut((model%layout%element_slot(sections(i)%elements) - 1)/chunk_size + 1) = .true.
      end do
    end associate
  end subroutine mark_chunks

  !> Forces of the elements of all sections, one section behind the other.
  pure subroutine take_slots(model, chunks, of_slots, force)
    type(model_t), intent(in) :: model
    integer, intent(in) :: chunks(2)
    real(wp), intent(in) :: of_slots(:, :)
    real(wp), intent(inout) :: force(:, :)
    integer :: i, k, n

    n = 0
    do i = 1, size(model%controls%output%cross_sections)
      associate (elements => model%controls%output%cross_sections(i)%elements)
        do k = 1, size(elements)
          n = n + 1
          associate (slot => model%layout%element_slot(elements(k)))
            if (slot > (chunks(1) - 1)*chunk_size .and. slot <= chunks(2)*chunk_size) &
              force(:, n) = of_slots(:, slot)
          end associate
        end do
      end associate
    end do
  end subroutine take_slots

  !> What one element puts on its four corners, x and y of each: minus its internal force. The third
  !> of a triangle is its fourth as well.
  pure function corner_forces(is_round, i, chunk, round) result(force)
    logical, intent(in) :: is_round
    integer, intent(in) :: i                   !! its place in the chunk
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(in) :: round
    real(wp) :: force(8)
    real(wp) :: f(4), swing(2), hoop(2)

    if (is_round) then
      f = round%force(:, i)
      swing = round%swing(:, i)
      hoop = [round%hoop(i), 0.0_wp]
    else
      f = [chunk%force3(:, i), chunk%force4(:, i)]
      swing = chunk%swing(:, i)
      hoop = 0.0_wp
    end if
    force = [f(1:2) - swing - hoop, f(3:4) + swing - hoop, -f(1:2) - swing - hoop, &
      -f(3:4) + swing - hoop]
  end function corner_forces

end module cut_forces_m
