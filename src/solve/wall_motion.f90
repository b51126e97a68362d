! SPDX-License-Identifier: MIT
!> Rigid walls in the explicit driver: perfectly plastic impact of nodes. A node that would pass a
!> wall in the step ahead gets the normal velocity that takes it to the wall (one behind it: none),
!> and the wall the force that this takes at t(n). Tangentially it is free.
module wall_motion_m
  use kinds_m, only : wp
  use model_m, only : model_t
  use node_motion_m, only : leap_t
  use snapshot_m, only : wall_result_t
  use state_m, only : state_t
  use walls_m, only : wall_t, wall_distance
  implicit none
  private
  public :: start_walls, hold_nodes, count_walls, fill_walls

  !> Rounds over the walls that one node meets (two in a corner settle at once where
  !> they are at right angles).
  integer, parameter :: most_rounds = 40

contains

  !> Memories of the walls, where the deck has any.
  subroutine start_walls(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    integer :: i

    if (.not. allocated(model%walls)) return
    if (size(model%walls) == 0) return
    allocate (state%walls(size(model%walls)))
    do i = 1, size(model%walls)
      allocate (state%walls(i)%force(size(model%walls(i)%nodes)), &
        state%walls(i)%speed(size(model%walls(i)%nodes)), source=0.0_wp)
    end do
  end subroutine start_walls

  !> Add the forces of all walls to one special node, whose other forces are known, before it moves.
  subroutine hold_node(model, leap, node, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: node
    type(state_t), intent(inout) :: state
    real(wp) :: velocity(2), mobility(2), more, most
    integer :: i, k, round, n_seen

    n_seen = 0
    do i = 1, size(model%walls)
      k = model%walls(i)%place(node)
      if (k == 0) cycle
      n_seen = n_seen + 1
      state%walls(i)%force(k) = 0.0_wp
      state%walls(i)%speed(k) = dot_product(model%walls(i)%normal, state%motion(3:4, node))
    end do
    if (n_seen == 0) return
    mobility = leap%half*state%inverse_mass(:, node)
    velocity = leap%keep*state%motion(3:4, node) + leap%half*merge(leap%body, 0.0_wp, &
      state%inverse_mass(:, node) > 0.0_wp) + mobility*(state%force_special(:, node) &
      - state%internal_force(:, node))
    do round = 1, most_rounds
      most = 0.0_wp
      do i = 1, size(model%walls)
        k = model%walls(i)%place(node)
        if (k == 0) cycle
        more = missing_force(model%walls(i), state%time, leap%dt, model%mesh%coordinates(:, node), &
          state%motion(1:2, node), velocity, mobility, state%walls(i)%force(k))
        state%walls(i)%force(k) = state%walls(i)%force(k) + more
        velocity = velocity + mobility*(more*model%walls(i)%normal)
        state%force_special(:, node) = state%force_special(:, node) + more*model%walls(i)%normal
        most = max(most, abs(more) - 1.0e-14_wp*state%walls(i)%force(k))
      end do
      if (n_seen == 1 .or. .not. most > 0.0_wp) exit
    end do
  end subroutine hold_node

  !> What the force of one wall lacks so that the node does not pass; never so
  !> negative that the wall pulls.
  pure function missing_force(wall, time, dt, coordinates, displacement, velocity, mobility, &
      force) result(more)
    type(wall_t), intent(in) :: wall
    real(wp), intent(in) :: time, dt
    real(wp), intent(in) :: coordinates(2), displacement(2)
    real(wp), intent(in) :: velocity(2)  !! with the forces so far
    real(wp), intent(in) :: mobility(2)  !! velocity from a force of 1
    real(wp), intent(in) :: force        !! of the wall so far
    real(wp) :: more
    real(wp) :: gain, least

    more = 0.0_wp
    gain = dot_product(wall%normal**2, mobility)
    if (.not. gain > 0.0_wp .or. time < wall%birth .or. time >= wall%death) return
    least = -max(0.0_wp, wall_distance(wall, coordinates, displacement))/dt
    more = max((least - dot_product(wall%normal, velocity))/gain, -force)
  end function missing_force

  !> The special nodes first .. last.
  subroutine hold_nodes(model, leap, first, last, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state
    integer :: node

    do node = first, last
      call hold_node(model, leap, node, state)
    end do
  end subroutine hold_nodes

  !> Impulse and work of the walls over the half steps before and after the instant. Together they
  !> do the work F h (v(n-1/2) + v(n+1/2))/2, which is the change of kinetic energy that F makes,
  !> whatever the two steps are; it counts as external.
  subroutine count_walls(model, is_before, is_after, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_before, is_after !! which half steps are due
    type(state_t), intent(inout) :: state
    real(wp) :: work, next, length
    integer :: i, k

    length = 0.0_wp
    if (is_before) length = 0.5_wp*state%dt_before
    if (is_after) length = length + 0.5_wp*state%dt
    do i = 1, size(state%walls)
      associate (wall => model%walls(i), memory => state%walls(i))
        work = 0.0_wp
        do k = 1, size(wall%nodes)
          if (.not. memory%force(k) > 0.0_wp) cycle
          if (is_before) work = work + memory%force(k)*0.5_wp*state%dt_before*memory%speed(k)
          if (.not. is_after) cycle
          next = dot_product(wall%normal, state%motion(3:4, wall%nodes(k)))
          work = work + memory%force(k)*(0.25_wp*(state%dt_before + state%dt) &
            *(memory%speed(k) + next) - 0.5_wp*state%dt_before*memory%speed(k))
        end do
        memory%impulse = memory%impulse + length*sum(memory%force)
        memory%work = memory%work + work
        state%external_work = state%external_work + work
      end associate
    end do
  end subroutine count_walls

  !> What the output says of the walls.
  subroutine fill_walls(model, state, results)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(wall_result_t), intent(inout) :: results(:)
    integer :: i

    do i = 1, size(state%walls)
      results(i)%normal_force = sum(state%walls(i)%force)
      results(i)%force = results(i)%normal_force*model%walls(i)%normal
      results(i)%impulse = state%walls(i)%impulse
      results(i)%work = state%walls(i)%work
      results(i)%n_active = count(state%walls(i)%force > 0.0_wp)
    end do
  end subroutine fill_walls

end module wall_motion_m
