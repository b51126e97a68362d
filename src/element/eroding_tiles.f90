! SPDX-License-Identifier: MIT
!> Element forces of tiles some elements of which may leave the mesh. An element that has left stays
!> in its slot as padding does: much larger, all of its nodes one, without stress and without force.
module eroding_tiles_m
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, reference_inverse, scatter_forces
  use element_dispatch_m, only : advance_chunk
  use element_state_m, only : smallest_ratio, initial_volume
  use erosion_criteria_m, only : find_leaving
  use erosion_state_m, only : stays, has_left
  use kinds_m, only : wp
  use layout_m, only : chunk_size, tile_t
  use material_dispatch_m, only : history_size
  use model_m, only : model_t
  use parts_m, only : material_t, has_memory_of_heat
  use quad_points_m, only : n_point
  use element_steps_m, only : step_of_element
  implicit none
  private
  public :: add_eroding_tile_forces, take_nodes

  !> How much larger the shape of an element is that has left.
  real(wp), parameter :: much = 1.0e6_wp

  !> Elements of a chunk that leave in this step, and what all of them held before it.
  type :: leaving_t
    logical :: flags(chunk_size) = .false.
    real(wp) :: energy(chunk_size)    !! internal, per initial volume
    real(wp) :: hourglass(chunk_size) !! J/m
    real(wp) :: work                  !! of the hourglass forces of the chunk, J/m
  end type leaving_t

contains

  !> As `add_tile_forces`; elements that leave in this step have no force any more.
  subroutine add_eroding_tile_forces(model, tile, motion, times, elements, force)
    type(model_t), intent(in) :: model
    type(tile_t), intent(in) :: tile
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node)
    real(wp), intent(in) :: times(2)                   !! of the motion, and the step that led there
    type(block_state_t), intent(inout) :: elements     !! only this tile's slots are touched
    real(wp), intent(inout) :: force(2, model%layout%n_local) !! set here
    type(element_chunk_t) :: chunk
    type(leaving_t) :: leaving
    integer :: nodes(4, chunk_size), i_chunk, first

    force = 0.0_wp
    do i_chunk = tile%first_chunk, tile%last_chunk
      first = (i_chunk - 1)*chunk_size + 1
      call take_nodes(model%layout%slot_nodes(:, first:first + chunk_size - 1), &
        elements%erosion%status(first:first + chunk_size - 1), nodes)
      call keep_energies(i_chunk, elements, leaving)
      call advance_chunk(model, i_chunk, nodes, motion, times(2), elements, chunk)
      if (times(2) > 0.0_wp) then
        call find_leaving(model, i_chunk, nodes, motion, times, elements, leaving%flags)
        if (any(leaving%flags)) call take_out(model, i_chunk, motion, times(2), leaving, elements, &
          chunk)
      end if
      if (elements%erosion%n_gone(i_chunk) > 0) call clear_forces(elements%erosion%status(first: &
        first + chunk_size - 1) /= stays, chunk)
      call scatter_forces(model%layout%chunk_elements(i_chunk), model%layout%slot_local(1, first), &
        chunk, force)
    end do
  end subroutine add_eroding_tile_forces

  !> Nodes of a chunk; those of an element that has left are all its first one.
  pure subroutine take_nodes(slot_nodes, status, nodes)
    integer, intent(in) :: slot_nodes(4, chunk_size), status(chunk_size)
    integer, intent(out) :: nodes(4, chunk_size)
    integer :: i

    nodes = slot_nodes
    do i = 1, chunk_size
      if (status(i) /= stays) nodes(:, i) = nodes(1, i)
    end do
  end subroutine take_nodes

  !> What each element holds before the step, and the hourglass work of the chunk.
  pure subroutine keep_energies(i_chunk, elements, leaving)
    integer, intent(in) :: i_chunk
    type(block_state_t), intent(in) :: elements
    type(leaving_t), intent(inout) :: leaving
    integer :: first

    leaving%energy = 0.0_wp
    first = elements%eos_start(i_chunk)
    if (first > 0) leaving%energy = elements%eos_state(first:first + chunk_size - 1)
    first = (i_chunk - 1)*chunk_size + 1
    leaving%hourglass = elements%erosion%hourglass(first:first + chunk_size - 1)
    leaving%work = elements%hourglass_work(i_chunk)
  end subroutine keep_energies

  !> Elements that leave take their energies along; the limits of the chunk are those of the rest.
  subroutine take_out(model, i_chunk, motion, dt, leaving, elements, chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    real(wp), intent(in), contiguous :: motion(:, :)
    real(wp), intent(in) :: dt
    type(leaving_t), intent(in) :: leaving
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(in) :: chunk
    real(wp) :: limit, volume, share
    integer :: i, slot, i_eos

    limit = huge(1.0_wp)
    volume = huge(1.0_wp)
    elements%hourglass_work(i_chunk) = leaving%work
    i_eos = elements%eos_start(i_chunk)
    do i = 1, model%layout%chunk_elements(i_chunk)
      slot = (i_chunk - 1)*chunk_size + i
      if (elements%erosion%status(slot) /= stays) cycle
      if (.not. leaving%flags(i)) then
        elements%hourglass_work(i_chunk) = elements%hourglass_work(i_chunk) &
          + (elements%erosion%hourglass(slot) - leaving%hourglass(i))
        limit = min(limit, step_of_element(model, elements, slot, motion))
        volume = min(volume, smallest_ratio(model, motion, elements, slot))
        cycle
      end if
      ! Its force at the end of the step does no work any more: half of that of the step is undone.
      share = 0.5_wp*dt*power_of(model, slot, i, motion, chunk)
      if (elements%eos_state(i_eos + 2*chunk_size + i - 1) > -1.0_wp .and. abs(share) &
        <= huge(1.0_wp)) then
        elements%erosion%internal(slot) = elements%eos_state(i_eos + i - 1) &
          *initial_volume(model, elements, slot) - share
      else
        elements%erosion%hourglass(slot) = leaving%hourglass(i)
        elements%erosion%internal(slot) = leaving%energy(i)*initial_volume(model, elements, slot)
      end if
      elements%hourglass_work(i_chunk) = elements%hourglass_work(i_chunk) - leaving%hourglass(i)
      elements%erosion%status(slot) = has_left
      elements%erosion%n_gone(i_chunk) = elements%erosion%n_gone(i_chunk) + 1
      call make_padding(model, i_chunk, i, elements)
    end do
    elements%time_limit(i_chunk) = limit
    elements%volume_limit(i_chunk) = volume
  end subroutine take_out

  !> Power of the forces of an element on the motion of its nodes in the step behind.
  pure function power_of(model, slot, i, motion, chunk) result(power)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot, i
    real(wp), intent(in), contiguous :: motion(:, :)
    type(element_chunk_t), intent(in) :: chunk
    real(wp) :: power
    real(wp) :: v(2, 4)

    v = motion(3:4, model%layout%slot_nodes(:, slot))
    power = dot_product(chunk%force3(:, i), v(:, 3) - v(:, 1)) + dot_product(chunk%force4(:, i), &
      v(:, 4) - v(:, 2)) + dot_product(chunk%swing(:, i), v(:, 1) - v(:, 2) + v(:, 3) - v(:, 4))
    if (chunk%is_round) power = power + chunk%hoop(i)*sum(v(1, :))
  end function power_of

  !> From now on the slot is padding.
  pure subroutine make_padding(model, i_chunk, i, elements)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk, i
    type(block_state_t), intent(inout) :: elements
    integer :: slot, first, k, n

    slot = (i_chunk - 1)*chunk_size + i
    associate (reference => elements%reference, &
      material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
      n = min(size(reference, 2), reference_inverse - 1)
      reference(slot, :n) = much*reference(slot, :n)
      if (size(reference, 2) > n) reference(slot, n + 1:) = reference(slot, n + 1:)/much**3
      elements%deviator(slot, :) = 0.0_wp
      n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
      if (n > 1) then
        do k = 0, 3*n - 1
          elements%point_deviator(elements%point_start(i_chunk) + k*chunk_size + i - 1) = 0.0_wp
        end do
      end if
      if (elements%history_start(i_chunk) > 0) call keep_told(material, n, &
        elements%history(elements%history_start(i_chunk) + i - 1:))
      first = elements%hourglass_start(i_chunk) + i - 1
      if (first >= i) elements%hourglass_strain([first, first + chunk_size]) = 0.0_wp
      first = elements%eos_start(i_chunk) + i - 1
      elements%eos_state([(first + k*chunk_size, k=0, 3)]) = 0.0_wp
      elements%eos_state(first + 4*chunk_size) = material%sound_speed**2
    end associate
  end subroutine make_padding

  !> Plastic strain, temperature and damage are told on as they were; back stress would pull.
  pure subroutine keep_told(material, n, history)
    type(material_t), intent(in) :: material
    integer, intent(in) :: n                 !! points
    real(wp), intent(inout) :: history(:)    !! from the slot on
    integer :: k, column

    do k = 0, n*history_size(material) - 1
      column = mod(k, history_size(material)) + 1
      associate (value => history(k*chunk_size + 1))
        if (column > 1 .and. .not. has_memory_of_heat(material)) value = 0.0_wp
        if (.not. abs(value) <= huge(1.0_wp)) value = 0.0_wp
      end associate
    end do
  end subroutine keep_told

  !> Elements that have left do not push.
  pure subroutine clear_forces(is_gone, chunk)
    logical, intent(in) :: is_gone(chunk_size)
    type(element_chunk_t), intent(inout) :: chunk
    integer :: i

    do i = 1, chunk_size
      if (.not. is_gone(i)) cycle
      chunk%force3(:, i) = 0.0_wp
      chunk%force4(:, i) = 0.0_wp
      chunk%swing(:, i) = 0.0_wp
      if (chunk%is_round) chunk%hoop(i) = 0.0_wp
    end do
  end subroutine clear_forces

end module eroding_tiles_m
