! SPDX-License-Identifier: MIT
!> Forces on boundaries and of groups of nodes in explicit cycles, and their work (trapezoidal
!> rule), where histories ask for them (bndout, nodfor). The works of all boundaries add up to the
!> external work, but for those of body loads, rigid walls and interference.
module boundary_account_m
  use boundary_rows_m, only : boundary_load, boundary_body_load, boundary_pressure
  use constraints_m, only : is_active
  use explicit_prescribed_m, only : prescribed_reaction
  use history_filling_m, only : form_loads
  use kinds_m, only : wp
  use model_m, only : model_t
  use rigid_motion_m, only : rigid_reaction
  use state_m, only : state_t
  implicit none
  private
  public :: count_boundary_loads, count_boundary_motions, count_boundary_bodies, count_groups

contains

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

end module boundary_account_m
