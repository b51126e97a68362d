! SPDX-License-Identifier: MIT
!> Special nodes that something holds which no inverse mass of x or y can express: skew supports,
!> sets of nodes that move alike, and rigid walls, whose impact is perfectly plastic. A node that
!> would pass a wall in the step ahead gets the normal velocity that takes it to the wall (one
!> behind it: none), and the wall the force that this takes at t(n). Tangentially the wall holds it
!> back with what stops it, at most the coefficient of friction times that force.
module held_nodes_m
  use common_motion_m, only : common_drive
  use kinds_m, only : wp
  use model_m, only : model_t
  use node_motion_m, only : leap_t, look_ahead
  use state_m, only : state_t
  use walls_m, only : wall_t, wall_distance, wall_tangent, friction_sticks
  implicit none
  private
  public :: hold_skew_nodes, move_common, hold_nodes, count_walls, wall_work_ahead

  !> Rounds over the walls that one node meets (two in a corner settle at once where
  !> they are at right angles).
  integer, parameter :: most_rounds = 40

contains

  !> Add the forces of skew supports to the special nodes first .. last, whose other forces are
  !> known, before they move: v(n+1/2) has no part along the normal.
  subroutine hold_skew_nodes(model, leap, first, last, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state
    real(wp) :: mobility(2), velocity(2), gain
    integer :: i

    do i = 1, size(model%conditions%skew_supports)
      associate (node => model%conditions%skew_supports(i)%node, &
        normal => model%conditions%skew_supports(i)%normal)
        if (node < first .or. node > last) cycle
        call look_ahead(leap, state, node, mobility, velocity)
        gain = dot_product(normal**2, mobility)
        if (gain > 0.0_wp) state%force_special(:, node) = state%force_special(:, node) &
          - dot_product(normal, velocity)/gain*normal
      end associate
    end do
  end subroutine hold_skew_nodes

  !> Put sets of nodes that move alike where the sum of their forces takes them; they have moved as
  !> nodes without force.
  subroutine move_common(model, leap, damping, before, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: damping(2)     !! D per direction
    real(wp), intent(in) :: before(:, :)   !! (2, n_set) v(n-1/2)
    type(state_t), intent(inout) :: state
    real(wp) :: push, rate, next
    integer :: i, k

    do i = 1, size(model%conditions%common_motions)
      associate (nodes => model%conditions%common_motions(i)%nodes)
        do k = 1, 2
          if (.not. model%conditions%common_motions(i)%along(k)) cycle
          call common_drive(model, i, k, state, damping, push, rate)
          next = ((1.0_wp - 0.5_wp*rate*leap%mean)*before(k, i) + leap%mean*push) &
            /(1.0_wp + 0.5_wp*rate*leap%mean)
          state%motion(k, nodes) = state%motion(k, nodes) + leap%dt*(next &
            - state%motion(2 + k, nodes))
          state%motion(2 + k, nodes) = next
        end do
      end associate
    end do
  end subroutine move_common

  !> Add the forces of all walls to the special nodes first .. last, whose other forces are known,
  !> before they move.
  subroutine hold_nodes(model, leap, first, last, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: first, last
    type(state_t), intent(inout) :: state
    real(wp) :: velocity(2), mobility(2), more, most
    integer :: node, i, k, round, n_seen
    logical :: settles

    do node = first, last
      n_seen = 0
      settles = .true.
      do i = 1, size(model%walls)
        k = model%walls(i)%node_index(node)
        if (k == 0) cycle
        n_seen = n_seen + 1
        state%walls(i)%force(k) = 0.0_wp
        state%walls(i)%speed(k) = dot_product(model%walls(i)%normal, state%motion(3:4, node))
        if (.not. model%walls(i)%friction > 0.0_wp) cycle
        state%walls(i)%friction(k) = 0.0_wp
        state%walls(i)%slip_speed(k) = dot_product(wall_tangent(model%walls(i)), &
          state%motion(3:4, node))
        settles = .false.
      end do
      if (n_seen == 0) cycle
      call look_ahead(leap, state, node, mobility, velocity)
      do round = 1, most_rounds
        most = 0.0_wp
        do i = 1, size(model%walls)
          k = model%walls(i)%node_index(node)
          if (k == 0) cycle
          associate (wall => model%walls(i), force => state%walls(i)%force(k))
            more = missing_force(wall, state%time, leap%dt, model%mesh%coordinates(:, node), &
              state%motion(1:2, node), velocity, mobility, force)
            force = force + more
            call push(more, wall%normal, force)
            if (.not. wall%friction > 0.0_wp) cycle
            more = missing_friction(wall, velocity, mobility, force, state%walls(i)%friction(k))
            state%walls(i)%friction(k) = state%walls(i)%friction(k) + more
            call push(more, wall_tangent(wall), force)
          end associate
        end do
        if ((n_seen == 1 .and. settles) .or. .not. most > 0.0_wp) exit
      end do
    end do

  contains

    !> Push the node by what a force lacked.
    subroutine push(more, along, force)
      real(wp), intent(in) :: more, along(2), force !! the last one along the normal of the wall

      velocity = velocity + mobility*(more*along)
      state%force_special(:, node) = state%force_special(:, node) + more*along
      most = max(most, abs(more) - 1.0e-14_wp*force)
    end subroutine push

  end subroutine hold_nodes

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

  !> What the friction of one wall lacks so that the node stops, as far as its force allows.
  pure function missing_friction(wall, velocity, mobility, force, friction) result(more)
    type(wall_t), intent(in) :: wall
    real(wp), intent(in) :: velocity(2)  !! with the forces so far
    real(wp), intent(in) :: mobility(2)  !! velocity from a force of 1
    real(wp), intent(in) :: force        !! of the wall along its normal
    real(wp), intent(in) :: friction     !! of the wall along its tangent so far
    real(wp) :: more
    real(wp) :: tangent(2), gain

    tangent = wall_tangent(wall)
    gain = dot_product(tangent**2, mobility)
    more = -friction
    if (.not. (gain > 0.0_wp .and. force > 0.0_wp)) return
    more = -dot_product(tangent, velocity)/gain
    if (wall%friction < friction_sticks) more = max(-wall%friction*force - friction, &
      min(more, wall%friction*force - friction))
  end function missing_friction

  !> Impulse and work of the walls over the half steps before and after the instant. Together they
  !> do the work F h (v(n-1/2) + v(n+1/2))/2, which is the change of kinetic energy that F makes,
  !> whatever the two steps are; it counts as external, but for that of friction, which is part of
  !> the energy account by itself.
  subroutine count_walls(model, due, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: due(2) !! the half steps before and after the instant
    type(state_t), intent(inout) :: state
    real(wp) :: work, length
    integer :: i

    length = 0.0_wp
    if (due(1)) length = 0.5_wp*state%dt_before
    if (due(2)) length = length + 0.5_wp*state%dt
    do i = 1, size(state%walls)
      associate (wall => model%walls(i), memory => state%walls(i))
        work = work_along(wall%normal, wall%nodes, memory%force, memory%speed)
        memory%impulse = memory%impulse + length*sum(memory%force)
        memory%work = memory%work + work
        state%external_work = state%external_work + work
        if (size(memory%friction) == 0) cycle
        work = work_along(wall_tangent(wall), wall%nodes, memory%friction, memory%slip_speed)
        memory%dissipated = memory%dissipated - work
        memory%work = memory%work + work
      end associate
    end do

  contains

    !> Of forces on the nodes of a wall, from their velocities before.
    pure function work_along(direction, nodes, force, speed) result(work)
      real(wp), intent(in) :: direction(2)
      integer, intent(in) :: nodes(:)
      real(wp), intent(in) :: force(:), speed(:)
      real(wp) :: work
      integer :: k

      work = 0.0_wp
      do k = 1, size(nodes)
        if (.not. abs(force(k)) > 0.0_wp) cycle
        if (due(1)) work = work + force(k)*0.5_wp*state%dt_before*speed(k)
        if (due(2)) work = work + force(k)*way_ahead(state, speed(k), &
          dot_product(direction, state%motion(3:4, nodes(k))))
      end do
    end function work_along

  end subroutine count_walls

  !> What of that work on one node belongs to the half step after the instant, friction included.
  pure function wall_work_ahead(model, node, state) result(work)
    type(model_t), intent(in) :: model
    integer, intent(in) :: node
    type(state_t), intent(in) :: state
    real(wp) :: work
    integer :: i, k

    work = 0.0_wp
    do i = 1, size(state%walls)
      k = model%walls(i)%node_index(node)
      if (k == 0) cycle
      associate (wall => model%walls(i), memory => state%walls(i))
        if (memory%force(k) > 0.0_wp) work = work + memory%force(k)*way_ahead(state, &
          memory%speed(k), dot_product(wall%normal, state%motion(3:4, node)))
        if (size(memory%friction) > 0) work = work + memory%friction(k)*way_ahead(state, &
          memory%slip_speed(k), dot_product(wall_tangent(wall), state%motion(3:4, node)))
      end associate
    end do
  end function wall_work_ahead

  !> Way of a node that counts for the half step ahead.
  pure function way_ahead(state, speed, next) result(way)
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: speed, next !! v(n-1/2), v(n+1/2)
    real(wp) :: way

    way = 0.25_wp*(state%dt_before + state%dt)*(speed + next) - 0.5_wp*state%dt_before*speed
  end function way_ahead

end module held_nodes_m
