! SPDX-License-Identifier: MIT
!> Prescribed motion in the explicit cycle, and the work of its reactions.
module explicit_prescribed_m
  use kinds_m, only : wp
  use conditions_m, only : motion_displacement, motion_velocity, prescribed_motion_t
  use constraints_m, only : is_active, next_velocity
  use model_m, only : model_t
  use snapshot_filling_m, only : damping_at
  use state_m, only : state_t
  implicit none
  private
  public :: find_prescribed_velocities, start_prescribed, impose_prescribed, prescribed_work, &
    prescribed_reaction

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

end module explicit_prescribed_m
