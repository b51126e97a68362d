! SPDX-License-Identifier: MIT
!> Element forces tile by tile, and the one place that asks for the element form.
module element_dispatch_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use element_chunk_m, only : element_chunk_t, scatter_forces
  use layout_m, only : chunk_size, local_kind, tile_t
  use model_m, only : model_t
  use parts_m, only : section_t, form_full, form_round_full
  use quad_full_m, only : advance_full
  use quad_one_point_m, only : advance_one_point
  use quad_points_m, only : n_point
  implicit none
  private
  public :: add_tile_forces, advance_chunk, point_count

contains

  !> Integration points of an element of this section.
  pure function point_count(section) result(n)
    type(section_t), intent(in) :: section
    integer :: n

    n = merge(n_point, 1, any(section%element_form == [form_full, form_round_full]))
  end function point_count

  !> Advance all elements of one tile by the step `dt` that led here and sum their internal forces
  !> on the tile's local nodes.
  subroutine add_tile_forces(model, tile, motion, dt, elements, force)
    type(model_t), intent(in) :: model
    type(tile_t), intent(in) :: tile
    real(wp), intent(in), contiguous :: motion(:, :)   !! (4, n_node)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements     !! only this tile's slots are touched
    real(wp), intent(inout) :: force(2, model%layout%n_local) !! set here
    type(element_chunk_t) :: chunk
    real(wp) :: near(4, model%layout%n_local)
    integer :: i_chunk, first, numbers(4, chunk_size)

    call take_motion(tile, model%layout%special_node, motion, near)
    force = 0.0_wp
    do i_chunk = tile%first_chunk, tile%last_chunk
      first = (i_chunk - 1)*chunk_size + 1
      call widen(model%layout%slot_local(1, first), numbers)
      call advance_chunk(model, i_chunk, numbers, near, dt, elements, chunk)
      call scatter_forces(model%layout%chunk_elements(i_chunk), model%layout%slot_local(1, first), &
        chunk, force)
    end do
  end subroutine add_tile_forces

  !> Motion of a tile's nodes by their local numbers. It is read in order here, and local numbers
  !> take half of the memory of global ones.
  pure subroutine take_motion(tile, special_node, motion, near)
    type(tile_t), intent(in) :: tile
    integer, intent(in) :: special_node(*)
    real(wp), intent(in) :: motion(4, *)       !! of all nodes
    real(wp), intent(inout) :: near(4, *)
    integer :: i, n_interior

    n_interior = tile%last_node - tile%first_node + 1
    do i = 1, n_interior
      call take_node(motion(1, tile%first_node + i - 1), near(1, i))
    end do
    do i = tile%first_special, tile%last_special
      call take_node(motion(1, special_node(i)), near(1, n_interior + i - tile%first_special + 1))
    end do
  end subroutine take_motion

  !> Motion of one node: for a loop over the four the compiler would call a routine.
  pure subroutine take_node(motion, near)
    real(wp), intent(in) :: motion(4)
    real(wp), intent(inout) :: near(4)

    near(1) = motion(1)
    near(2) = motion(2)
    near(3) = motion(3)
    near(4) = motion(4)
  end subroutine take_node

  !> Local numbers of a chunk as ordinary integers.
  pure subroutine widen(local, numbers)
    integer(local_kind), intent(in) :: local(4*chunk_size)
    integer, intent(out) :: numbers(4*chunk_size)
    integer :: i

    !$omp simd
    do i = 1, 4*chunk_size
      numbers(i) = local(i)
    end do
  end subroutine widen

  !> Advance one chunk by its form; its forces stand in `chunk`.
  subroutine advance_chunk(model, i_chunk, nodes, motion, dt, elements, chunk)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i_chunk
    integer, intent(in) :: nodes(4, chunk_size)        !! by their numbers in `motion`
    real(wp), intent(in), contiguous :: motion(:, :)   !! of all nodes, or of those of a tile
    real(wp), intent(in) :: dt
    type(block_state_t), intent(inout) :: elements
    type(element_chunk_t), intent(inout) :: chunk

    if (point_count(model%sections(model%parts(model%layout%chunk_part(i_chunk))%section)) > 1) then
      call advance_full(model, i_chunk, nodes, motion, dt, elements, chunk)
    else
      call advance_one_point(model, i_chunk, nodes, motion, dt, elements, chunk)
    end if
  end subroutine advance_chunk

end module element_dispatch_m
