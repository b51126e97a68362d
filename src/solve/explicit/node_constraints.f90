! SPDX-License-Identifier: MIT
!> Constraints of special nodes that no inverse mass of x or y expresses: skew supports, coupled
!> nodes, and rigid walls with perfectly plastic impact. A node that would cross a wall in the
!> coming step gets the normal velocity that takes it to the wall (that of the wall if it is
!> behind), and the wall the corresponding force at t(n). The tangential force stops the node, at
!> most friction coefficient times normal force. A moving wall has the velocity v(n-1/2) for its
!> nodes, and v(n+1/2) from the sum of their forces.
module node_constraints_m
  use coupled_nodes_m, only : coupled_acceleration
  use errors_m, only : error_t, raise, status_run
  use kinds_m, only : wp
  use log_m, only : to_text
  use model_m, only : model_t
  use node_motion_m, only : leap_t, predict_velocity
  use state_m, only : state_t
  use walls_m, only : wall_t, wall_distance, wall_tangent, friction_sticks
  implicit none
  private
  public :: apply_skew_supports, move_coupled_nodes, apply_walls, add_wall_work, move_walls, &
    wall_work_ahead

  !> Largest number of iterations over the walls at one node (two walls at right angles need one).
  integer, parameter :: most_rounds = 40

contains

  !> Add the forces of skew supports to the special nodes first .. last, whose other forces are
  !> known, before they move: v(n+1/2) has no component along the normal.
  subroutine apply_skew_supports(model, leap, first, last, state)
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
        call predict_velocity(leap, state, node, mobility, velocity)
        gain = dot_product(normal**2, mobility)
        if (gain > 0.0_wp) state%force_special(:, node) = state%force_special(:, node) &
          - dot_product(normal, velocity)/gain*normal
      end associate
    end do
  end subroutine apply_skew_supports

  !> Move coupled nodes by the sum of their forces; they have moved as nodes without force.
  subroutine move_coupled_nodes(model, leap, damping, before, state)
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
          call coupled_acceleration(model, i, k, state, damping, push, rate)
          next = ((1.0_wp - 0.5_wp*rate*leap%mean)*before(k, i) + leap%mean*push) &
            /(1.0_wp + 0.5_wp*rate*leap%mean)
          state%motion(k, nodes) = state%motion(k, nodes) + leap%dt*(next &
            - state%motion(2 + k, nodes))
          state%motion(2 + k, nodes) = next
        end do
      end associate
    end do
  end subroutine move_coupled_nodes

  !> Add the forces of all rigid walls to the special nodes first .. last, whose other forces are
  !> known, before they move.
  subroutine apply_walls(model, leap, first, last, state)
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
      call predict_velocity(leap, state, node, mobility, velocity)
      do round = 1, most_rounds
        most = 0.0_wp
        do i = 1, size(model%walls)
          k = model%walls(i)%node_index(node)
          if (k == 0) cycle
          associate (wall => model%walls(i), force => state%walls(i)%force(k))
            more = 0.0_wp
            if (state%time >= wall%birth .and. state%time < wall%death) more = &
              wall_force_increment(wall, state%walls(i)%velocity - max(0.0_wp, wall_distance( &
              wall, model%mesh%coordinates(:, node), state%motion(1:2, node)) &
              - state%walls(i)%displacement)/leap%dt, velocity, mobility, force)
            force = force + more
            call push(more, wall%normal, force)
            if (.not. wall%friction > 0.0_wp) cycle
            more = wall_friction_increment(wall, velocity, mobility, force, &
              state%walls(i)%friction(k))
            state%walls(i)%friction(k) = state%walls(i)%friction(k) + more
            call push(more, wall_tangent(wall), force)
          end associate
        end do
        if ((n_seen == 1 .and. settles) .or. .not. most > 0.0_wp) exit
      end do
    end do

  contains

    !> Add a force increment to the node.
    subroutine push(more, along, force)
      real(wp), intent(in) :: more, along(2), force !! increment, direction, and normal force of the
                                                    !! wall

      velocity = velocity + mobility*(more*along)
      state%force_special(:, node) = state%force_special(:, node) + more*along
      most = max(most, abs(more) - 1.0e-14_wp*force)
    end subroutine push

  end subroutine apply_walls

  !> Increment of the normal force of a wall that keeps the node from crossing it; the total force
  !> stays compressive.
  pure function wall_force_increment(wall, least, velocity, mobility, force) result(more)
    type(wall_t), intent(in) :: wall
    real(wp), intent(in) :: least        !! normal velocity that takes the node to the wall
    real(wp), intent(in) :: velocity(2)  !! with the forces so far
    real(wp), intent(in) :: mobility(2)  !! velocity from a force of 1
    real(wp), intent(in) :: force        !! of the wall so far
    real(wp) :: more
    real(wp) :: gain

    more = 0.0_wp
    gain = dot_product(wall%normal**2, mobility)
    if (gain > 0.0_wp) more = max((least - dot_product(wall%normal, velocity))/gain, -force)
  end function wall_force_increment

  !> Increment of the friction of a wall that stops the node, limited by the normal force.
  pure function wall_friction_increment(wall, velocity, mobility, force, friction) result(more)
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
  end function wall_friction_increment

  !> Add impulse and work of the walls over the half steps before and after t(n). Together they are
  !> F h (v(n-1/2) + v(n+1/2))/2, the change of kinetic energy by F for any two steps. It counts as
  !> external work, except for friction, which has its own entry in the energy balance.
  subroutine add_wall_work(model, due, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: due(2) !! the half steps before and after t(n)
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

    !> Work of forces along a direction on the nodes of a wall.
    pure function work_along(direction, nodes, force, speed) result(work)
      real(wp), intent(in) :: direction(2)
      integer, intent(in) :: nodes(:)
      real(wp), intent(in) :: force(:), speed(:) !! forces, and velocities before them
      real(wp) :: work
      integer :: k

      work = 0.0_wp
      do k = 1, size(nodes)
        if (.not. abs(force(k)) > 0.0_wp) cycle
        if (due(1)) work = work + force(k)*0.5_wp*state%dt_before*speed(k)
        if (due(2)) work = work + force(k)*path_ahead(state, speed(k), &
          dot_product(direction, state%motion(3:4, nodes(k))))
      end do
    end function work_along

  end subroutine add_wall_work

  !> Move the walls by the sum of the forces on their nodes: M (v(n+1/2) - v(n-1/2)) = -h sum F. The
  !> nodes have met v(n-1/2): v(n+1/2) swings where they are heavier than the wall, an error.
  subroutine move_walls(model, state, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(error_t), allocatable, intent(inout) :: error
    real(wp) :: touching
    integer :: i

    do i = 1, size(state%walls)
      associate (wall => model%walls(i), memory => state%walls(i))
        if (.not. wall%mass > 0.0_wp) cycle
        touching = sum(state%mass(wall%nodes), mask=memory%force > 0.0_wp)
        if (touching >= wall%mass .and. .not. allocated(error)) call raise(error, &
          wall%source//': wall '//to_text(wall%id)//' of mass '//to_text(wall%mass) &
          //' touches nodes of mass '//to_text(touching)//' at time '//to_text(state%time) &
          //'; a moving wall must be heavier than the nodes that it touches: refine the mesh ' &
          //'there, or let it be a rigid body in contact (*MAT_RIGID)', status_run)
        memory%velocity = memory%velocity - 0.5_wp*(state%dt_before + state%dt) &
          *sum(memory%force)/wall%mass
        memory%displacement = memory%displacement + state%dt*memory%velocity
      end associate
    end do
  end subroutine move_walls

  !> Part of the wall work on one node that belongs to the half step after t(n), friction included.
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
        if (memory%force(k) > 0.0_wp) work = work + memory%force(k)*path_ahead(state, &
          memory%speed(k), dot_product(wall%normal, state%motion(3:4, node)))
        if (size(memory%friction) > 0) work = work + memory%friction(k)*path_ahead(state, &
          memory%slip_speed(k), dot_product(wall_tangent(wall), state%motion(3:4, node)))
      end associate
    end do
  end function wall_work_ahead

  !> Displacement of a node that counts for the half step after t(n).
  pure function path_ahead(state, speed, next) result(way)
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: speed, next !! v(n-1/2), v(n+1/2)
    real(wp) :: way

    way = 0.25_wp*(state%dt_before + state%dt)*(speed + next) - 0.5_wp*state%dt_before*speed
  end function path_ahead

end module node_constraints_m
