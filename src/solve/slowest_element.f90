! SPDX-License-Identifier: MIT
!> Which element rules the time step (glstat).
module slowest_element_m
  use controls_m, only : length_by_diagonal
  use curves_m, only : curve_value
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t
  use state_m, only : state_t
  implicit none
  private
  public :: find_slowest

contains

  !> Ids of the element with the shortest length in the chunk with the smallest limit, and of its part; 0 where the
  !> curve rules.
  subroutine find_slowest(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: length, shortest
    integer :: i, i_chunk, i_element

    snapshot%slowest = 0
    if (model%controls%dt_curve > 0) then
      if (.not. abs(curve_value(model%curves(model%controls%dt_curve), state%time) - state%dt) > 0.0_wp) return
    end if
    i_chunk = minloc(state%elements%time_limit, 1)
    shortest = huge(1.0_wp)
    do i = (i_chunk - 1)*chunk_size + 1, i_chunk*chunk_size
      i_element = model%layout%slot_element(i)
      if (i_element == 0) cycle
      associate (nodes => model%mesh%element_nodes(:, i_element))
        length = element_length(model%controls%length_rule, model%mesh%coordinates(:, nodes) &
          + snapshot%displacement(:, nodes))
      end associate
      if (.not. length < shortest) cycle
      shortest = length
      snapshot%slowest = [model%mesh%element_id(i_element), model%parts(model%mesh%element_part(i_element))%id]
    end do
  end subroutine find_slowest

  !> Area over the longest side or diagonal.
  pure function element_length(rule, x) result(length)
    integer, intent(in) :: rule          !! ISDO
    real(wp), intent(in) :: x(2, 4)      !! corners
    real(wp) :: length
    real(wp) :: a(2), b(2)

    a = x(:, 3) - x(:, 1)
    b = x(:, 4) - x(:, 2)
    length = 0.5_wp*(a(1)*b(2) - a(2)*b(1))
    if (rule == length_by_diagonal) then
      length = length/max(norm2(a), norm2(b))
    else
      length = length/maxval(norm2(x - cshift(x, 1, 2), 1))
    end if
  end function element_length

end module slowest_element_m
