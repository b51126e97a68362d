! SPDX-License-Identifier: MIT
!> Prescribed motion of nodes in the explicit cycle, the work of its reactions and of those of rigid
!> bodies; forces on boundaries and of groups of nodes, and their work (trapezoidal rule), where
!> histories ask for them (bndout, nodfor). The works of all boundaries add up to the external work,
!> but for those of body loads, rigid walls and interference.
module prescribed_motion_m
  use boundary_filling_m, only : form_loads
  use conditions_m, only : motion_displacement, motion_velocity, prescribed_motion_t
  use constraints_m, only : is_active, next_velocity
  use controls_m, only : boundary_load, boundary_body_load, boundary_pressure
  use kinds_m, only : wp
  use model_m, only : model_t
  use rigid_motion_m, only : rigid_reaction
  use snapshot_filling_m, only : damping_at
  use state_m, only : state_t
  implicit none
  private
  public :: find_prescribed_velocities, start_prescribed, impose_prescribed, prescribed_work, &
    prescribed_reaction, count_boundary_loads, count_boundary_motions, count_boundary_bodies, &
    count_groups

contains

  !> v(n+1/2) of all prescribed degrees of freedom, from u(n) and v(n-1/2). Nodes of one set follow
  !> one curve, looked up once: for each node it took 11 % of the sliding scene.
  subroutine find_prescribed_velocities(model, state, velocity)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(inout) :: velocity(:) !! (n_motion)
    integer :: i, before

    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        before = max(1, i - 1)
        if (i > before .and. has_same_velocity(prescribed, model%conditions%motions(before))) then
          velocity(i) = velocity(before)
        else
          velocity(i) = next_velocity(model, prescribed, state%time, state%dt, state%dt_before, &
            state%motion(prescribed%direction, prescribed%node), state%prescribed_velocity(i))
        end if
      end associate
    end do
  end subroutine find_prescribed_velocities

  !> Whether two motions have one velocity at all times.
  pure function has_same_velocity(one, other) result(same)
    type(prescribed_motion_t), intent(in) :: one, other
    logical :: same

    same = one%kind == motion_velocity .and. other%kind == motion_velocity .and. &
      one%curve == other%curve .and. abs(one%scale - other%scale) <= 0.0_wp
  end function has_same_velocity

  !> A node on a displacement curve starts with the velocity of its first step: from rest the start
  !> would be a blow of half its kinetic energy that no curve asks for.
  subroutine start_prescribed(model, velocity, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:) !! (n_motion) v(1/2)
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        if (prescribed%kind /= motion_displacement .or. .not. is_active(prescribed, state%time)) &
          cycle
        state%motion(2 + prescribed%direction, prescribed%node) = velocity(i)
        state%prescribed_velocity(i) = velocity(i)
        if (allocated(state%former_velocity)) &
          state%former_velocity(prescribed%direction, prescribed%node) = velocity(i)
      end associate
    end do
  end subroutine start_prescribed

  !> Work R.v dt/2 of the reactions over half a step, with
  !> R = m a + f_int - f_special - m g + D m v(n).
  pure function prescribed_work(model, state, velocity, damping, factor_old, &
      factor_new) result(work)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: velocity(:)            !! (n_motion) v(n+1/2)
    real(wp), intent(in) :: damping(2)             !! D per direction
    real(wp), intent(in) :: factor_old, factor_new !! times v(n-1/2) and v(n+1/2)
    real(wp) :: work
    integer :: i

    work = 0.0_wp
    do i = 1, size(model%conditions%motions)
      if (.not. is_active(model%conditions%motions(i), state%time)) cycle
      work = work + prescribed_reaction(model%conditions%motions(i), state, damping, &
        state%prescribed_velocity(i), velocity(i))*(factor_old*state%prescribed_velocity(i) &
        + factor_new*velocity(i))
    end do
  end function prescribed_work

  !> Reaction of one prescribed motion, from its velocities before and behind the instant.
  pure function prescribed_reaction(prescribed, state, damping, old, next) result(reaction)
    type(prescribed_motion_t), intent(in) :: prescribed
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: damping(2)  !! D per direction
    real(wp), intent(in) :: old, next   !! v(n-1/2) and v(n+1/2)
    real(wp) :: reaction
    real(wp) :: d(2)

    associate (node => prescribed%node, k => prescribed%direction)
      d = damping_at(state, damping, node)
      reaction = state%mass(node)*((next - old)/(0.5_wp*(state%dt + state%dt_before)) &
        - state%body_acceleration(k) + 0.5_wp*d(k)*(next + old)) &
        + state%internal_force(k, node) - state%force_special(k, node)
    end associate
  end function prescribed_reaction

  !> Put prescribed nodes where they belong; `displacement` is u(n), from before the nodes moved.
  subroutine impose_prescribed(model, velocity, displacement, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:)     !! (n_motion) v(n+1/2)
    real(wp), intent(in) :: displacement(:) !! (n_motion) u(n)
    type(state_t), intent(inout) :: state
    integer :: i

    do i = 1, size(model%conditions%motions)
      associate (prescribed => model%conditions%motions(i))
        associate (node => prescribed%node, k => prescribed%direction)
          if (is_active(prescribed, state%time)) then
            state%motion(2 + k, node) = velocity(i)
            state%motion(k, node) = displacement(i) + state%dt*velocity(i)
          end if
          state%prescribed_velocity(i) = state%motion(2 + k, node)
        end associate
      end associate
    end do
  end subroutine impose_prescribed

  !> Loads at the beginning of a cycle, once the loads of the cycle are known.
  subroutine count_boundary_loads(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp) :: former(3, size(state%boundary_work)), velocity(3)
    integer :: i

    former = state%boundary_force
    call form_loads(model, state%motion, state%time, state%boundary_force)
    associate (rows => model%controls%output%boundaries)
      do i = 1, size(rows%where)
        select case (rows%condition(i))
        case (boundary_load, boundary_pressure)
          velocity = [state%motion(3:4, rows%where(i)), 0.0_wp]
        case (boundary_body_load)
          state%boundary_force(:, i) = state%rigids(rows%where(i))%load
          velocity = state%rigids(rows%where(i))%velocity
        case default
          cycle
        end select
        state%boundary_work(i) = state%boundary_work(i) &
          + half_behind(state)*sum((former(:, i) + state%boundary_force(:, i))*velocity)
      end do
    end associate
  end subroutine count_boundary_loads

  !> Half of the step behind this instant: 0 where works begin in it.
  pure function half_behind(state) result(length)
    type(state_t), intent(in) :: state
    real(wp) :: length

    length = merge(0.0_wp, 0.5_wp*state%dt_before, state%cycle == state%boundary_since)
  end function half_behind

  !> Reactions of prescribed motion of nodes, and their work over half a step before the instant and
  !> half a step from it on.
  subroutine count_boundary_motions(model, velocity, damping, before, after, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:)    !! (n_motion) v(n+1/2)
    real(wp), intent(in) :: damping(2)     !! D per direction
    logical, intent(in) :: before, after
    type(state_t), intent(inout) :: state
    real(wp) :: reaction, factor_old, factor_new
    integer :: i

    factor_old = merge(half_behind(state), 0.0_wp, before)
    factor_new = merge(0.5_wp*state%dt, 0.0_wp, after)
    associate (rows => model%controls%output%boundaries%motion_rows, &
      motions => model%conditions%motions)
      do i = 1, size(motions)
        state%boundary_force(motions(i)%direction, rows(i)) = 0.0_wp
      end do
      do i = 1, size(motions)
        if (.not. is_active(motions(i), state%time)) cycle
        reaction = prescribed_reaction(motions(i), state, damping, state%prescribed_velocity(i), &
          velocity(i))
        state%boundary_force(motions(i)%direction, rows(i)) = reaction
        state%boundary_work(rows(i)) = state%boundary_work(rows(i)) + reaction &
          *(factor_old*state%prescribed_velocity(i) + factor_new*velocity(i))
      end do
    end associate
  end subroutine count_boundary_motions

  !> The same of rigid bodies.
  subroutine count_boundary_bodies(model, damping, before, after, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: damping(2)     !! D per direction
    logical, intent(in) :: before, after
    type(state_t), intent(inout) :: state
    real(wp) :: reaction, factor_old, factor_new
    integer :: i

    factor_old = merge(half_behind(state), 0.0_wp, before)
    factor_new = merge(0.5_wp*state%dt, 0.0_wp, after)
    associate (rows => model%controls%output%boundaries%body_motion_rows, &
      motions => model%conditions%rigid_motions)
      do i = 1, size(motions)
        state%boundary_force(motions(i)%direction, rows(i)) = 0.0_wp
      end do
      do i = 1, size(motions)
        if (.not. is_active(motions(i), state%time)) cycle
        reaction = rigid_reaction(model, motions(i), state, damping)
        state%boundary_force(motions(i)%direction, rows(i)) = reaction
        associate (rigid => state%rigids(motions(i)%node), k => motions(i)%direction)
          state%boundary_work(rows(i)) = state%boundary_work(rows(i)) + reaction &
            *(factor_old*rigid%velocity(k) + factor_new*rigid%next_velocity(k))
        end associate
      end do
    end associate
  end subroutine count_boundary_bodies

  !> Internal forces of groups of nodes, and their work up to the instant, and from it on once the
  !> nodes have moved.
  subroutine count_groups(model, before, after, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: before, after
    type(state_t), intent(inout) :: state
    integer :: i, k, n

    n = 0
    do i = 1, size(model%controls%output%force_groups)
      associate (nodes => model%controls%output%force_groups(i)%nodes)
        do k = 1, size(nodes)
          n = n + 1
          state%group_force(:, n) = state%internal_force(:, nodes(k))
          if (before) state%group_work(n) = state%group_work(n) + 0.5_wp*state%dt_before &
            *dot_product(state%group_force(:, n), state%group_velocity(:, n))
          if (.not. after) cycle
          state%group_velocity(:, n) = state%motion(3:4, nodes(k))
          state%group_work(n) = state%group_work(n) + 0.5_wp*state%dt &
            *dot_product(state%group_force(:, n), state%group_velocity(:, n))
        end do
      end associate
    end do
  end subroutine count_groups

end module prescribed_motion_m
