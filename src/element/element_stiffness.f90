! SPDX-License-Identifier: MIT
!> Derivative of the internal force of all elements, for implicit solutions.
module element_stiffness_m
  use kinds_m, only : wp
  use block_state_m, only : block_state_t
  use layout_m, only : chunk_size
  use material_dispatch_m, only : history_size
  use model_m, only : model_t
  use one_point_tangent_m, only : one_point_tangent
  use quad_points_m, only : n_point
  use quad_tangent_m, only : quad_tangent
  use round_tangent_m, only : round_tangent
  use rubber_tangent_m, only : rubber_tangent
  use sparse_m, only : sparse_t, add_block
  use stress_point_m, only : stress_point_t
  implicit none
  private
  public :: add_stiffness

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
    type(stress_point_t) :: points(n_point)
    real(wp) :: block(8, 8), reference(6), x(2, 4), u(2, 4), du(2, 4), &
      pattern_stress(2), moved(2, 4, 2)
    integer :: equations(8), i_chunk, slot

    do i_chunk = 1, model%layout%n_chunk
      associate (part => model%parts(model%layout%chunk_part(i_chunk)), &
        material => model%materials(model%parts(model%layout%chunk_part(i_chunk))%material))
        do slot = (i_chunk - 1)*chunk_size + 1, i_chunk*chunk_size
          if (model%layout%slot_element(slot) == 0) cycle
          associate (nodes => model%layout%slot_nodes(:, slot))
            equations = reshape(equation(:, nodes), [8])
            if (all(equations == 0)) cycle
            call load_points(i_chunk, mod(slot - 1, chunk_size), history_size(material), &
              committed, points)
            u = motion(1:2, nodes)
            du = dt*motion(3:4, nodes)
            if (allocated(material%rubber)) then
              x = model%mesh%coordinates(:, nodes)
              call rubber_tangent(material%rubber, model%is_round, x, u, block)
            else if (committed%point_start(i_chunk) == 0) then
              x = model%mesh%coordinates(:, nodes)
              pattern_stress = pattern_stress_of(i_chunk, mod(slot - 1, chunk_size), committed)
              moved(:, :, 1) = u
              moved(:, :, 2) = du
              call one_point_tangent(material, part%hourglass, model%is_round, x, moved, &
                points(1), pattern_stress, block)
            else if (model%is_round) then
              x = model%mesh%coordinates(:, nodes)
              call round_tangent(material, x, u, du, points, block)
            else
              reference = committed%reference(slot, :6)
              call quad_tangent(material, reference, u, du, points, block)
            end if
            call add_block(matrix, equations, equations, block)
          end associate
        end do
      end associate
    end do
  end subroutine add_stiffness

  !> Hourglass stress of one element.
  pure function pattern_stress_of(i_chunk, place, elements) result(stress)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: place     !! in the chunk, from 0
    type(block_state_t), intent(in) :: elements
    real(wp) :: stress(2)
    integer :: first

    first = elements%hourglass_start(i_chunk) + place
    stress = [elements%hourglass_strain(first), elements%hourglass_strain(first + chunk_size)]
  end function pattern_stress_of

  !> State of the points of one element out of the streams.
  pure subroutine load_points(i_chunk, place, n_history, elements, points)
    integer, intent(in) :: i_chunk
    integer, intent(in) :: place     !! in the chunk, from 0
    integer, intent(in) :: n_history !! values at each point
    type(block_state_t), intent(in) :: elements
    type(stress_point_t), intent(inout) :: points(n_point)
    integer :: first, k, n

    n = merge(n_point, 1, elements%point_start(i_chunk) > 0)
    do k = 1, n
      if (n > 1) then
        first = elements%point_start(i_chunk) + 3*(k - 1)*chunk_size + place
        points(k)%old = plane_parts(elements%point_deviator, first)
      else
        associate (s => elements%deviator((i_chunk - 1)*chunk_size + place + 1, :))
          points(k)%old = [0.5_wp*(s(1) + s(2)), 0.5_wp*(s(1) - s(2)), s(3)]
        end associate
      end if
      if (n_history == 0) cycle
      first = elements%history_start(i_chunk) + n_history*(k - 1)*chunk_size + place
      points(k)%plastic_strain = elements%history(first)
      points(k)%back = 0.0_wp
      if (n_history > 1) points(k)%back = plane_parts(elements%history, first + chunk_size)
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

end module element_stiffness_m
