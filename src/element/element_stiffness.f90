! SPDX-License-Identifier: MIT
!> Derivative of the internal force of all elements, for implicit solutions.
module element_stiffness_m
  use block_state_m, only : block_state_t
  use dual_m, only : dual_t
  use element_tangent_m, only : element_t, n_pattern, new_element, form_shapes, &
    form_full_force
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use material_dispatch_m, only : history_size
  use model_m, only : model_t
  use one_point_tangent_m, only : form_one_point_force
  use parts_m, only : hourglass_t, material_t
  use quad_points_m, only : n_point
  use sparse_m, only : sparse_t, add_block
  implicit none
  private
  public :: add_stiffness

  !> Of the nodes a = d31, b = d42 and h (`element_tangent`).
  integer, parameter :: of_nodes(4, 3) = reshape([-1, 0, 1, 0, 0, -1, 0, 1, 1, -1, 1, -1], [4, 3])

contains

  !> Add the exact derivative of the internal force with respect to the displacement. The step `dt`
  !> goes from the committed state to `motion`, with velocity (u - u_committed)/dt. Parts of
  !> one-point elements must have hourglass control by assumed strain.
  pure subroutine add_stiffness(model, motion, dt, committed, equation, matrix)
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: dt
    type(block_state_t), intent(in) :: committed
    integer, intent(in) :: equation(:, :)            !! (2, n_node) equation numbers, 0 = none
    type(sparse_t), intent(inout) :: matrix          !! started, not compressed
    type(element_t) :: element
    real(wp) :: block(8, 8), u(2, 4), du(2, 4)
    integer :: equations(8), i_chunk, slot

    element = new_element(model%is_round)
    do i_chunk = 1, model%layout%n_chunk
      associate (part => model%parts(model%layout%chunk_part(i_chunk)), &
        material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
        do slot = (i_chunk - 1)*chunk_size + 1, i_chunk*chunk_size
          if (model%layout%slot_element(slot) == 0) cycle
          associate (nodes => model%layout%slot_nodes(:, slot))
            equations = reshape(equation(:, nodes), [8])
            if (all(equations == 0)) cycle
            element%x = model%mesh%coordinates(:, nodes)
            u = motion(1:2, nodes)
            du = dt*motion(3:4, nodes)
            call form_shapes(u, du, element)
            call load_points(i_chunk, mod(slot - 1, chunk_size), history_size(material), &
              committed, element)
            call form_block(material, part%hourglass, committed%point_start(i_chunk) > 0, element, &
              block)
            call add_block(matrix, equations, equations, block)
          end associate
        end do
      end associate
    end do
  end subroutine add_stiffness

  !> State of the points of one element out of the streams, and its hourglass stress.
  pure subroutine load_points(i_chunk, place, n_history, elements, element)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: place     !! in the chunk, from 0
    integer, intent(in) :: n_history !! values at each point
    type(block_state_t), intent(in) :: elements
    type(element_t), intent(inout) :: element
    integer :: first, k, n

    n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
    first = elements%hourglass_start(i_chunk) + place
    if (n == 1) element%pattern_stress = elements%hourglass_strain([first, first + chunk_size])
    do k = 1, n
      if (n > 1) then
        first = elements%point_start(i_chunk) + 3*(k - 1)*chunk_size + place
        element%points(k)%old = plane_parts(elements%point_deviator, first)
      else
        associate (s => elements%deviator((i_chunk - 1)*chunk_size + place + 1, :))
          element%points(k)%old = [0.5_wp*(s(1) + s(2)), 0.5_wp*(s(1) - s(2)), s(3)]
        end associate
      end if
      if (n_history == 0) cycle
      first = elements%history_start(i_chunk) + n_history*(k - 1)*chunk_size + place
      element%points(k)%plastic_strain = elements%history(first)
      element%points(k)%back = 0.0_wp
      if (n_history > 1) element%points(k)%back = plane_parts(elements%history, first + chunk_size)
    end do
  end subroutine load_points

  !> (mean, half difference, shear) of a tensor whose xx stands at `first` and whose yy and xy
  !> follow a chunk further each.
  pure function plane_parts(stream, first) result(parts)
    real(wp), intent(in) :: stream(:)
    integer, intent(in) :: first
    real(wp) :: parts(3)

    associate (xx => stream(first), yy => stream(first + chunk_size), &
      xy => stream(first + 2*chunk_size))
      parts = [0.5_wp*(xx + yy), 0.5_wp*(xx - yy), xy]
    end associate
  end function plane_parts

  !> Matrix of one element, unknowns x1 y1 x2 y2 ... (per metre of thickness, or per radian).
  pure subroutine form_block(material, hourglass, is_full, element, block)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    logical, intent(in) :: is_full
    type(element_t), intent(inout) :: element
    real(wp), intent(out) :: block(8, 8)
    type(dual_t) :: force(n_pattern)
    real(wp) :: small(n_pattern, n_pattern), across(n_pattern, 8)
    integer :: a, k

    if (is_full) then
      call form_full_force(material, element, force)
    else
      call form_one_point_force(material, hourglass, element, force)
    end if
    do k = 1, n_pattern
      small(k, :) = force(k)%slope(:n_pattern)
    end do
    ! From the patterns to the nodes, first the columns.
    do a = 1, 4
      across(:, 2*a - 1) = of_nodes(a, 1)*small(:, 1) + of_nodes(a, 2)*small(:, 3) &
        + of_nodes(a, 3)*small(:, 5) + small(:, 7)
      across(:, 2*a) = of_nodes(a, 1)*small(:, 2) + of_nodes(a, 2)*small(:, 4) &
        + of_nodes(a, 3)*small(:, 6)
    end do
    do a = 1, 4
      block(2*a - 1, :) = of_nodes(a, 1)*across(1, :) + of_nodes(a, 2)*across(3, :) &
        + of_nodes(a, 3)*across(5, :) + across(7, :)
      block(2*a, :) = of_nodes(a, 1)*across(2, :) + of_nodes(a, 2)*across(4, :) &
        + of_nodes(a, 3)*across(6, :)
    end do
  end subroutine form_block

end module element_stiffness_m
