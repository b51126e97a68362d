! SPDX-License-Identifier: MIT
!> Forces on boundaries and of groups of nodes in implicit steps, and their work, where histories
!> ask for them (bndout, nodfor).
module implicit_boundary_m
  use boundary_rows_m, only : boundary_motion
  use constraints_m, only : is_active
  use element_mass_m, only : mass_times
  use history_filling_m, only : form_loads
  use implicit_forces_m, only : trial_t, net_force
  use kinds_m, only : wp
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: count_step_boundaries, find_forces

contains

  !> Work of a step, of which the state has not heard yet: loads and reactions by the trapezoidal
  !> rule, and of inertia the change of momentum times mean velocity.
  subroutine count_step_boundaries(model, before, after, time, velocity, state)
    type(model_t), intent(in) :: model
    type(trial_t), intent(in) :: before, after
    real(wp), intent(in) :: time                        !! at the end of the step
    real(wp), allocatable, intent(in) :: velocity(:, :) !! (2, n_node) there; not there in statics
    type(state_t), intent(inout) :: state               !! as the step has found it
    integer :: i, k, n

    if (allocated(state%boundary_work)) &
      call count_boundaries(model, before, after, time, velocity, state)
    if (.not. allocated(state%group_work)) return
    n = 0
    do i = 1, size(model%controls%output%force_groups)
      associate (nodes => model%controls%output%force_groups(i)%nodes)
        do k = 1, size(nodes)
          n = n + 1
          state%group_work(n) = state%group_work(n) + 0.5_wp*sum((before%internal(:, nodes(k)) &
            + after%internal(:, nodes(k)))*after%motion(3:4, nodes(k)))
        end do
      end associate
    end do
  end subroutine count_step_boundaries

  !> Boundaries alone.
  subroutine count_boundaries(model, before, after, time, velocity, state)
    type(model_t), intent(in) :: model
    type(trial_t), intent(in) :: before, after
    real(wp), intent(in) :: time
    real(wp), allocatable, intent(in) :: velocity(:, :)
    type(state_t), intent(inout) :: state
    real(wp), allocatable :: power(:, :)
    real(wp) :: former(3, size(state%boundary_work))
    integer :: i

    former = state%boundary_force
    call form_loads(model, state%motion, state%time, former)
    call form_loads(model, after%motion, time, state%boundary_force)
    power = 0.5_wp*(net_force(before) + net_force(after))*after%motion(3:4, :)
    if (allocated(velocity)) power = power + 0.5_wp*mass_times(model, velocity &
      - state%motion(3:4, :))*(velocity + state%motion(3:4, :))
    associate (rows => model%controls%output%boundaries, motions => model%conditions%motions, &
      work => state%boundary_work)
      do i = 1, size(rows%where)
        if (rows%condition(i) == boundary_motion) cycle
        work(i) = work(i) + 0.5_wp*sum((former(1:2, i) + state%boundary_force(1:2, i)) &
          *after%motion(3:4, rows%where(i)))
      end do
      do i = 1, size(motions)
        if (.not. is_active(motions(i), 0.5_wp*(state%time + time))) cycle
        work(rows%motion_rows(i)) = work(rows%motion_rows(i)) &
          + power(motions(i)%direction, motions(i)%node)
      end do
    end associate
  end subroutine count_boundaries

  !> Forces of the present instant, also where a run that goes on is the first to ask for them.
  subroutine find_forces(model, reaction, internal, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: reaction(:, :)   !! (2, n_node) of all degrees of freedom
    real(wp), intent(in) :: internal(:, :)   !! (2, n_node) divergence of stress
    type(state_t), intent(inout) :: state

    if (allocated(state%boundary_work)) then
      call form_loads(model, state%motion, state%time, state%boundary_force)
      call find_reactions(model, reaction, state)
    end if
    if (allocated(state%group_work)) call find_group_forces(model, internal, state)
  end subroutine find_forces

  !> Internal forces of groups of nodes.
  subroutine find_group_forces(model, internal, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: internal(:, :)
    type(state_t), intent(inout) :: state
    integer :: i, k, n

    n = 0
    do i = 1, size(model%controls%output%force_groups)
      associate (nodes => model%controls%output%force_groups(i)%nodes)
        do k = 1, size(nodes)
          n = n + 1
          state%group_force(:, n) = internal(:, nodes(k))
        end do
      end associate
    end do
  end subroutine find_group_forces

  !> Reactions of prescribed motion, into their rows.
  subroutine find_reactions(model, reaction, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: reaction(:, :)   !! (2, n_node) of all degrees of freedom
    type(state_t), intent(inout) :: state
    integer :: i

    associate (rows => model%controls%output%boundaries%motion_rows, &
      motions => model%conditions%motions)
      do i = 1, size(motions)
        state%boundary_force(motions(i)%direction, rows(i)) = 0.0_wp
      end do
      do i = 1, size(motions)
        if (is_active(motions(i), state%time)) state%boundary_force(motions(i)%direction, &
          rows(i)) = reaction(motions(i)%direction, motions(i)%node)
      end do
    end associate
  end subroutine find_reactions

end module implicit_boundary_m
