! SPDX-License-Identifier: MIT
!> Prescribed motion of nodes in the explicit cycle, the work of its reactions and of those of rigid
!> bodies; forces on boundaries and of groups of nodes, and their work (trapezoidal rule), where
!> histories ask for them (bndout, nodfor). The works of all boundaries add up to the external work,
!> but for those of body loads, rigid walls and interference.
module prescribed_motion_m
  use conditions_m, only : motion_displacement, motion_velocity, prescribed_motion_t
  use loads_m, only : is_active, next_velocity, part_damping_rate
  use controls_m, only : boundary_load, boundary_body_load, boundary_pressure, group_nodes
  use history_filling_m, only : form_loads
  use kinds_m, only : wp
  use model_m, only : model_t
  use node_motion_m, only : damping_of
  use snapshot_filling_m, only : damping_at
  use state_m, only : state_t
  implicit none
  private
  public :: find_prescribed_velocities, impose_prescribed, count_motions, count_body_motions, &
    count_boundary_loads, count_groups

contains

  !> v(n+1/2) of all prescribed degrees of freedom, from u(n) and v(n-1/2). Nodes of one set follow
  !> one curve, looked up once: for each node it took 11 % of the sliding scene. A node on a
  !> displacement curve starts with the velocity of its first step: from rest the start would be a
  !> blow of half its kinetic energy that no curve asks for.
  subroutine find_prescribed_velocities(model, state, velocity)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), intent(inout) :: velocity(:) !! (n_motion)
    integer :: i, before

    do i = 1, size(model%conditions%motions)
      before = max(1, i - 1)
      associate (prescribed => model%conditions%motions(i), &
        other => model%conditions%motions(before))
        if (i > before .and. prescribed%kind == motion_velocity .and. other%kind &
          == motion_velocity .and. prescribed%curve == other%curve &
          .and. abs(prescribed%scale - other%scale) <= 0.0_wp) then
          velocity(i) = velocity(before)
        else
          velocity(i) = next_velocity(model, prescribed, state%time, state%dt, state%dt_before, &
            state%motion(prescribed%direction, prescribed%node), state%prescribed_velocity(i))
        end if
      end associate
    end do
    if (state%dt_before > 0.0_wp) return
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
  end subroutine find_prescribed_velocities

  !> Reactions of the prescribed motions of nodes, R = m a + f_int - f_special - m g + D m v(n), and
  !> their work.
  subroutine count_motions(model, velocity, damping, due, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:)    !! (n_motion) v(n+1/2)
    real(wp), intent(in) :: damping(2)     !! D per direction
    logical, intent(in) :: due(2)          !! the half steps before and after the instant
    type(state_t), intent(inout) :: state
    real(wp) :: reactions(size(velocity)), d(2)
    integer :: i

    do i = 1, size(velocity)
      associate (node => model%conditions%motions(i)%node, &
        k => model%conditions%motions(i)%direction, next => velocity(i), &
        old => state%prescribed_velocity(i))
        d = damping_at(state, damping, node)
        reactions(i) = state%mass(node)*((next - old)/(0.5_wp*(state%dt + state%dt_before)) &
          - state%body_acceleration(k) + 0.5_wp*d(k)*(next + old)) &
          + state%internal_force(k, node) - state%force_special(k, node)
      end associate
    end do
    call count_reactions(model%conditions%motions, reactions, state%prescribed_velocity, velocity, &
      due, model%controls%output%boundaries%motion_rows, state)
  end subroutine count_motions

  !> The same of rigid bodies.
  subroutine count_body_motions(model, damping, due, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: damping(2)     !! D per direction
    logical, intent(in) :: due(2)          !! the half steps before and after the instant
    type(state_t), intent(inout) :: state
    real(wp), dimension(size(model%conditions%rigid_motions)) :: reactions, old, next
    real(wp) :: rate(3), body(3)
    integer :: i

    body = [state%body_acceleration, 0.0_wp]
    do i = 1, size(reactions)
      associate (rigid => state%rigids(model%conditions%rigid_motions(i)%node), &
        part => model%rigids(model%conditions%rigid_motions(i)%node)%part, &
        k => model%conditions%rigid_motions(i)%direction)
        old(i) = rigid%velocity(k)
        next(i) = rigid%next_velocity(k)
        rate = damping_of(rigid, damping + part_damping_rate(model, part, state%time))
        reactions(i) = rigid%inertia(k)*((next(i) - old(i))/(0.5_wp*(state%dt + state%dt_before)) &
          - body(k) + 0.5_wp*rate(k)*(next(i) + old(i))) - rigid%force(k)
      end associate
    end do
    call count_reactions(model%conditions%rigid_motions, reactions, old, next, due, &
      model%controls%output%boundaries%body_motion_rows, state)
  end subroutine count_body_motions

  !> Work R.v dt/2 of reactions over half steps, in that of the run and in their rows.
  subroutine count_reactions(motions, reactions, old, next, due, rows, state)
    type(prescribed_motion_t), intent(in) :: motions(:)
    real(wp), intent(in) :: reactions(:), old(:), next(:) !! R, v(n-1/2), v(n+1/2)
    logical, intent(in) :: due(2)
    integer, allocatable, intent(in) :: rows(:)           !! of each motion; not there if not asked
    type(state_t), intent(inout) :: state
    real(wp) :: halves(2), work
    integer :: i

    halves = merge(0.5_wp*[state%dt_before, state%dt], 0.0_wp, due)
    work = 0.0_wp
    do i = 1, size(motions)
      if (is_active(motions(i), state%time)) &
        work = work + reactions(i)*(halves(1)*old(i) + halves(2)*next(i))
    end do
    state%external_work = state%external_work + work
    if (.not. allocated(state%boundary_work)) return
    if (due(1)) halves(1) = half_behind(state)
    do i = 1, size(motions)
      state%boundary_force(motions(i)%direction, rows(i)) = 0.0_wp
    end do
    do i = 1, size(motions)
      if (.not. is_active(motions(i), state%time)) cycle
      state%boundary_force(motions(i)%direction, rows(i)) = reactions(i)
      state%boundary_work(rows(i)) = state%boundary_work(rows(i)) + reactions(i) &
        *(halves(1)*old(i) + halves(2)*next(i))
    end do
  end subroutine count_reactions

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

  !> Internal forces of groups of nodes, and their work up to the instant, and from it on once the
  !> nodes have moved.
  subroutine count_groups(model, due, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: due(2)          !! the half steps before and after the instant
    type(state_t), intent(inout) :: state

    associate (nodes => group_nodes(model%controls%output%force_groups))
      state%group_force = state%internal_force(:, nodes)
      if (due(1)) state%group_work = state%group_work + 0.5_wp*state%dt_before &
        *sum(state%group_force*state%group_velocity, 1)
      if (.not. due(2)) return
      state%group_velocity = state%motion(3:4, nodes)
      state%group_work = state%group_work + 0.5_wp*state%dt &
        *sum(state%group_force*state%group_velocity, 1)
    end associate
  end subroutine count_groups

end module prescribed_motion_m
