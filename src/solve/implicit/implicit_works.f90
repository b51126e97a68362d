! SPDX-License-Identifier: MIT
!> Work of prescribed motions in an implicit step, of nodes and rigid bodies; forces and work of
!> boundaries and of groups of nodes (bndout, nodfor).
module implicit_works_m
  use controls_m, only : boundary_load, boundary_body_load, boundary_pressure, boundary_motion, &
    boundary_body_motion, group_nodes
  use element_mass_m, only : mass_times
  use equations_m, only : equations_t
  use history_filling_m, only : form_loads
  use implicit_forces_m, only : trial_t, net_force, step_t, rates_t
  use kinds_m, only : wp
  use loads_m, only : is_active
  use model_m, only : model_t
  use rigid_state_m, only : rigid_state_t
  use state_m, only : state_t
  implicit none
  private
  public :: reactions_work, body_reactions_work, add_boundary_work, find_forces

contains

  !> Work of the reactions of prescribed degrees of freedom: of inertia the change of momentum times
  !> mean velocity, which equals the gain of kinetic energy also in impacts; of other forces by the
  !> trapezoidal rule.
  function reactions_work(model, equations, before, after, state, velocity) result(work)
    type(model_t), intent(in) :: model
    type(equations_t), intent(in) :: equations
    type(trial_t), intent(in) :: before, after
    type(state_t), intent(in) :: state                  !! at the start of the step
    real(wp), allocatable, intent(in) :: velocity(:, :) !! (2, n_node) v(n+1); not allocated in
                                                        !! statics
    real(wp) :: work

    work = 0.0_wp
    if (equations%n == equations%n_free) return
    work = 0.5_wp*sum((net_force(before) + net_force(after))*after%motion(3:4, :), &
      equations%number > equations%n_free)
    if (allocated(velocity)) work = work + 0.5_wp*sum(mass_times(model, state%mass, velocity &
      - state%motion(3:4, :))*(state%motion(3:4, :) + velocity), &
      equations%number > equations%n_free)
  end function reactions_work

  !> Work of the prescribed motions of rigid bodies likewise, by body and direction.
  pure function body_reactions_work(step, force, way, rates, rigids) result(work)
    type(step_t), intent(in) :: step
    real(wp), intent(in) :: force(:, :)             !! (3, n_body) `net_body_force` at the end
    real(wp), intent(in) :: way(:, :)               !! (3, n_body) displacement over the step
    type(rates_t), intent(in) :: rates              !! at the end; not set in statics
    type(rigid_state_t), intent(in) :: rigids(:)    !! at the start of the step
    real(wp) :: work(3, size(rigids))
    integer :: i

    work = 0.5_wp*(step%old_bodies + force)*way
    do i = 1, size(rigids)
      if (step%is_dynamic) work(:, i) = work(:, i) + 0.5_wp*rigids(i)%inertia &
        *(rates%body_velocity(:, i) - rigids(i)%velocity)*(rates%body_velocity(:, i) &
        + rigids(i)%velocity)
    end do
    where (step%equations%bodies <= step%equations%n_free) work = 0.0_wp
  end function body_reactions_work

  !> Add the work of a step in bndout and nodfor: loads and reactions by the trapezoidal rule,
  !> inertia by the change of momentum times mean velocity.
  subroutine add_boundary_work(model, before, after, time, velocity, bodies, state)
    type(model_t), intent(in) :: model
    type(trial_t), intent(in) :: before, after
    real(wp), intent(in) :: time                        !! end of the step, s
    real(wp), allocatable, intent(in) :: velocity(:, :) !! (2, n_node) v(n+1); not allocated in
                                                        !! statics
    real(wp), intent(in) :: bodies(:, :)                !! (3, n_body) `body_reactions_work`
    type(state_t), intent(inout) :: state               !! at the start of the step
    real(wp), allocatable :: power(:, :), previous(:, :)
    integer :: i

    if (allocated(state%boundary_work)) then
      previous = state%boundary_force
      call form_loads(model, state%motion, state%time, previous)
      call form_loads(model, after%motion, time, state%boundary_force)
      power = 0.5_wp*(net_force(before) + net_force(after))*after%motion(3:4, :)
      if (allocated(velocity)) power = power + 0.5_wp*mass_times(model, state%mass, velocity &
        - state%motion(3:4, :))*(velocity + state%motion(3:4, :))
      associate (rows => model%controls%output%boundaries, motions => model%conditions%motions, &
        turned => model%conditions%rigid_motions, work => state%boundary_work)
        do i = 1, size(rows%where)
          associate (where => rows%where(i))
            select case (rows%condition(i))
            case (boundary_load, boundary_pressure)
              work(i) = work(i) + 0.5_wp*sum((previous(1:2, i) + state%boundary_force(1:2, i)) &
                *after%motion(3:4, where))
            case (boundary_body_load)
              work(i) = work(i) + 0.5_wp*sum((before%body_load(:, where) + after%body_load(:, &
                where))*(after%bodies(:, where) - before%bodies(:, where)))
            end select
          end associate
        end do
        do i = 1, size(turned)
          if (is_active(turned(i), 0.5_wp*(state%time + time))) work(rows%body_motion_rows(i)) &
            = work(rows%body_motion_rows(i)) + bodies(turned(i)%direction, turned(i)%node)
        end do
        do i = 1, size(motions)
          if (is_active(motions(i), 0.5_wp*(state%time + time))) work(rows%motion_rows(i)) &
            = work(rows%motion_rows(i)) + power(motions(i)%direction, motions(i)%node)
        end do
      end associate
    end if
    if (.not. allocated(state%group_work)) return
    associate (nodes => group_nodes(model%controls%output%force_groups))
      state%group_work = state%group_work + 0.5_wp*sum((before%internal(:, nodes) &
        + after%internal(:, nodes))*after%motion(3:4, nodes), 1)
    end associate
  end subroutine add_boundary_work

  !> Forces of bndout and nodfor at the present instant, also where a restarted run is the first to
  !> ask for them.
  subroutine find_forces(model, reaction, bodies, trial, state)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: reaction(:, :)   !! (2, n_node) of all degrees of freedom
    real(wp), intent(in) :: bodies(:, :)     !! (3, n_body) `net_body_force`
    type(trial_t), intent(in) :: trial       !! of the state
    type(state_t), intent(inout) :: state
    real(wp) :: of_bodies(3, size(state%rigids))
    integer :: i

    if (allocated(state%boundary_work)) then
      call form_loads(model, state%motion, state%time, state%boundary_force)
      do i = 1, size(state%rigids)
        of_bodies(:, i) = bodies(:, i) + state%rigids(i)%inertia*state%rigids(i)%acceleration
      end do
      associate (rows => model%controls%output%boundaries, motions => model%conditions%motions, &
        turned => model%conditions%rigid_motions)
        do i = 1, size(rows%where)
          if (rows%condition(i) == boundary_body_load) state%boundary_force(:, i) &
            = trial%body_load(:, rows%where(i))
          if (any(rows%condition(i) == [boundary_motion, boundary_body_motion])) &
            state%boundary_force(:, i) = 0.0_wp
        end do
        do i = 1, size(motions)
          if (is_active(motions(i), state%time)) state%boundary_force(motions(i)%direction, &
            rows%motion_rows(i)) = reaction(motions(i)%direction, motions(i)%node)
        end do
        do i = 1, size(turned)
          if (is_active(turned(i), state%time)) state%boundary_force(turned(i)%direction, &
            rows%body_motion_rows(i)) = of_bodies(turned(i)%direction, turned(i)%node)
        end do
      end associate
    end if
    if (allocated(state%group_work)) state%group_force = trial%internal(:, &
      group_nodes(model%controls%output%force_groups))
  end subroutine find_forces

end module implicit_works_m
