! SPDX-License-Identifier: MIT
!> Change of the volume of the elements in the first step of a run, before it is made: a step away
!> from a jump of pressure or velocity would turn elements inside out which nothing has moved yet.
module first_change_m
  use constraints_m, only : is_active
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use model_m, only : model_t
  use node_motion_m, only : leap_t
  use rank_shares_m, only : shares_t
  use ranks_m, only : ranks_t, find_least
  use state_m, only : state_t
  implicit none
  private
  public :: first_change

contains

  !> Largest change of ln V of an element, without its sign, in a step from time zero, with the
  !> forces that stand in the state. Rigid walls and forces of implicit penalties do not count.
  subroutine first_change(model, shares, leap, velocity, state, ranks, change)
    type(model_t), intent(in) :: model
    type(shares_t), intent(in) :: shares
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: velocity(:) !! (n_motion) v(1/2) of prescribed motions, m/s
    type(state_t), intent(in) :: state
    type(ranks_t), intent(inout) :: ranks
    real(wp), intent(out) :: change
    real(wp), allocatable :: next(:, :)
    real(wp) :: least(1)
    integer :: i_tile, i_chunk, slot

    next = next_velocities(model, leap, velocity, state)
    change = 0.0_wp
    do i_tile = shares%first_tile, shares%last_tile
      do i_chunk = model%layout%tiles(i_tile)%first_chunk, model%layout%tiles(i_tile)%last_chunk
        do slot = (i_chunk - 1)*chunk_size + 1, (i_chunk - 1)*chunk_size &
          + model%layout%chunk_elements(i_chunk)
          change = max(change, leap%dt*abs(volume_rate(model, slot, next, state)))
        end do
      end do
    end do
    least = -change
    if (ranks%n > 1) call find_least(ranks, least)
    change = -least(1)
  end subroutine first_change

  !> v(1/2) of the nodes whose forces this process knows.
  pure function next_velocities(model, leap, velocity, state) result(next)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: velocity(:)
    type(state_t), intent(in) :: state
    real(wp), allocatable :: next(:, :)  !! (2, n_node)
    real(wp) :: push(2)
    integer :: i

    allocate (next(2, size(state%motion, 2)))
    do i = 1, size(next, 2)
      push = -state%internal_force(:, i)
      if (i <= model%layout%n_special) push = push + state%force_special(:, i)
      next(:, i) = state%motion(3:4, i) + leap%half*(push*state%inverse_mass(:, i) &
        + merge(leap%body, 0.0_wp, state%inverse_mass(:, i) > 0.0_wp))
    end do
    do i = 1, size(velocity)
      associate (motion => model%conditions%motions(i))
        if (is_active(motion, state%time)) next(motion%direction, motion%node) = velocity(i)
      end associate
    end do
  end function next_velocities

  !> Rate of ln V of the element in a slot, 1/s: of its area, and in bodies of revolution of the
  !> radius of its middle.
  pure function volume_rate(model, slot, velocity, state) result(rate)
    type(model_t), intent(in) :: model
    integer, intent(in) :: slot
    real(wp), intent(in) :: velocity(:, :)  !! (2, n_node)
    type(state_t), intent(in) :: state
    real(wp) :: rate
    real(wp) :: x31(2), x42(2), v31(2), v42(2)

    associate (nodes => model%layout%slot_nodes(:, slot), r => state%elements%reference(slot, :4))
      x31 = r(1:2) + (state%motion(1:2, nodes(3)) - state%motion(1:2, nodes(1)))
      x42 = r(3:4) + (state%motion(1:2, nodes(4)) - state%motion(1:2, nodes(2)))
      v31 = velocity(:, nodes(3)) - velocity(:, nodes(1))
      v42 = velocity(:, nodes(4)) - velocity(:, nodes(2))
      rate = (v31(1)*x42(2) - v42(1)*x31(2) + x31(1)*v42(2) - x42(1)*v31(2)) &
        /(x31(1)*x42(2) - x42(1)*x31(2))
      if (model%is_round) rate = rate + sum(velocity(1, nodes)) &
        /sum(model%mesh%coordinates(1, nodes) + state%motion(1, nodes))
    end associate
  end function volume_rate

end module first_change_m
