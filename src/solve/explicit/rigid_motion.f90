! SPDX-License-Identifier: MIT
!> Rigid bodies in the explicit cycle: resultants, leap-frog of centre and angle, and the nodes
!> after them (doc/theory/rigid_bodies.md). Done by one thread, in the order of the nodes.
module rigid_motion_m
  use kinds_m, only : wp
  use conditions_m, only : motion_displacement
  use loads_m, only : is_active, next_velocity, part_damping_rate
  use model_m, only : model_t
  use rigid_state_m, only : rigid_state_t, turn_of, shift_by_turn, velocity_of
  use snapshot_m, only : snapshot_t
  use state_m, only : state_t
  implicit none
  private
  public :: solve_rigids, damping_of, move_rigids, fill_rigids, fill_bodies

contains

  !> Accelerations and v(n+1/2) of all bodies from the forces on their nodes.
  subroutine solve_rigids(model, damping, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: damping(2)     !! D per direction
    type(state_t), intent(inout) :: state
    real(wp) :: mean, rate(3), free(3), total(3), force(2), turn(2), arm(2)
    integer :: i, k

    mean = 0.5_wp*(state%dt_before + state%dt)
    do i = 1, size(state%rigids)
      associate (body => model%rigids(i), rigid => state%rigids(i))
        ! Resultants; nodes that no force reaches come after the special ones.
        total = 0.0_wp
        turn = turn_of(rigid%place(3))
        do k = 1, size(body%nodes)
          if (body%nodes(k) > model%layout%n_special) exit
          force = state%force_special(:, body%nodes(k)) - state%internal_force(:, body%nodes(k))
          arm = rigid%arms(:, k) + shift_by_turn(turn, rigid%arms(:, k))
          total = total + [force, arm(1)*force(2) - arm(2)*force(1)]
        end do
        rigid%force = total + rigid%load
        rate = damping_of(rigid, damping + part_damping_rate(model, body%part, state%time))
        free = rigid%force/rigid%inertia + [state%body_acceleration, 0.0_wp]
        rigid%acceleration = (free - rate*rigid%velocity)/(1.0_wp + 0.5_wp*rate*state%dt_before)
        rigid%next_velocity = ((1.0_wp - 0.5_wp*rate*mean)*rigid%velocity + mean*free) &
          /(1.0_wp + 0.5_wp*rate*mean)
        where (body%is_fixed)
          rigid%acceleration = 0.0_wp
          rigid%next_velocity = 0.0_wp
        end where
      end associate
    end do
    do i = 1, size(model%conditions%rigid_motions)
      associate (motion => model%conditions%rigid_motions(i))
        associate (rigid => state%rigids(motion%node), along => motion%direction)
          if (.not. is_active(motion, state%time)) cycle
          rigid%next_velocity(along) = next_velocity(model, motion, state%time, state%dt, &
            state%dt_before, rigid%place(along), rigid%velocity(along))
          ! On a displacement curve it starts with the velocity of its first step, as a node does.
          if (motion%kind == motion_displacement .and. .not. state%dt_before > 0.0_wp) &
            rigid%velocity(along) = rigid%next_velocity(along)
          rigid%acceleration(along) = (rigid%next_velocity(along) - rigid%velocity(along))/mean
        end associate
      end associate
    end do
  end subroutine solve_rigids

  !> D of each degree of freedom: the turn is damped by the forces -D m v on
  !> the nodes as they now lie.
  pure function damping_of(rigid, damping) result(rate)
    type(rigid_state_t), intent(in) :: rigid
    real(wp), intent(in) :: damping(2)
    real(wp) :: rate(3)
    real(wp) :: along_x

    rate(1:2) = damping
    rate(3) = damping(1)
    if (.not. abs(damping(1) - damping(2)) > 0.0_wp) return
    along_x = cos(rigid%place(3))**2*rigid%second(1) + sin(rigid%place(3))**2*rigid%second(2) &
      - sin(2.0_wp*rigid%place(3))*rigid%second(3)
    rate(3) = (damping(2)*along_x + damping(1)*(rigid%inertia(3) - along_x))/rigid%inertia(3)
  end function damping_of

  !> All bodies to u(n+1), and those of their nodes that anything asks for in the next cycle.
  !> The velocity of a node is its displacement over the step, as for all nodes: work is
  !> force times displacement.
  subroutine move_rigids(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp) :: turn(2), half_turn(2), speed(3)
    logical :: sums_all
    integer :: i, k

    ! Gravity and damping count the momentum of all nodes.
    sums_all = size(model%conditions%body_loads) > 0 .or. allocated(model%conditions%damping) &
      .or. allocated(model%conditions%part_damping)
    do i = 1, size(state%rigids)
      associate (nodes => model%rigids(i)%nodes, rigid => state%rigids(i), dt => state%dt)
        speed = rigid%next_velocity
        half_turn = turn_of(rigid%place(3) + 0.5_wp*dt*speed(3))
        rigid%velocity = speed
        rigid%place = rigid%place + dt*speed
        turn = turn_of(rigid%place(3))
        ! The chord is a little shorter than the arc.
        speed(3) = 2.0_wp*sin(0.5_wp*dt*speed(3))/dt
        do k = 1, size(nodes)
          if (nodes(k) > model%layout%n_special .and. .not. sums_all) exit
          associate (arm => rigid%arms(:, k))
            state%motion(1:2, nodes(k)) = rigid%place(1:2) + shift_by_turn(turn, arm)
            state%motion(3:4, nodes(k)) = velocity_of(speed, arm + shift_by_turn(half_turn, arm))
          end associate
        end do
      end associate
    end do
  end subroutine move_rigids

  !> Motion of all nodes of rigid bodies at the present instant.
  subroutine fill_rigids(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    real(wp) :: turn(2), velocity(3), arm(2)
    integer :: i, k, node

    do i = 1, size(state%rigids)
      associate (rigid => state%rigids(i))
        turn = turn_of(rigid%place(3))
        velocity = rigid%velocity + 0.5_wp*state%dt_before*rigid%acceleration
        do k = 1, size(model%rigids(i)%nodes)
          node = model%rigids(i)%nodes(k)
          snapshot%displacement(:, node) = rigid%place(1:2) + shift_by_turn(turn, rigid%arms(:, k))
          arm = rigid%arms(:, k) + shift_by_turn(turn, rigid%arms(:, k))
          snapshot%velocity(:, node) = velocity_of(velocity, arm)
          snapshot%acceleration(:, node) = velocity_of(rigid%acceleration, arm) - velocity(3)**2*arm
        end do
      end associate
    end do
  end subroutine fill_rigids

  !> Bodies of the histories (rbdout) at the present instant.
  subroutine fill_bodies(state, snapshot)
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer :: i

    if (.not. allocated(snapshot%bodies)) return
    do i = 1, size(snapshot%bodies)
      associate (rigid => state%rigids(i), body => snapshot%bodies(i))
        body%displacement = rigid%place
        body%place = rigid%centre + rigid%place(1:2)
        body%velocity = rigid%velocity + 0.5_wp*state%dt_before*rigid%acceleration
        body%acceleration = rigid%acceleration
      end associate
    end do
  end subroutine fill_bodies

end module rigid_motion_m
