! SPDX-License-Identifier: MIT
!> Nodal forces of one instant for the implicit driver, by the explicit kernels from a committed
!> state to a trial displacement; residual and tangent of one step (doc/theory/implicit.md, sections
!> 1 and 2).
module implicit_forces_m
  use block_state_m, only : block_state_t
  use clock_m, only : clock_t, lap, lap_interface, phase_elements, phase_contact_force, phase_nodes
  use conditions_m, only : pressure_load_t
  use contact_state_m, only : contact_state_t
  use contact_dispatch_m, only : add_contact_stiffness
  use curves_m, only : curve_value
  use cut_forces_m, only : find_cut_forces
  use element_dispatch_m, only : add_tile_forces, scatter_tile_forces, store_tile_forces, &
    sum_special_forces
  use element_mass_m, only : mass_times
  use element_stiffness_m, only : add_stiffness
  use equations_m, only : equations_t, prescribed_step_t, free_entries, put_prescribed, &
    add_free_mass
  use hanging_nodes_m, only : move_hanging_nodes, share_hanging_forces
  use loads_m, only : form_external_force, body_acceleration, damping_rates
  use interface_m, only : evaluate_contact
  use kinds_m, only : wp
  use model_m, only : model_t
  use packed_buffer_m, only : packed_buffer_t
  use rigid_equations_m, only : place_rigids, spread_rates, resultants, form_rigid_loads, &
    condense_nodes, add_rigid_diagonal
  use rigid_state_m, only : body_scales, damping_of
  use sparse_m, only : sparse_t, start_matrix, add_block
  use state_m, only : state_t
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: trial_t, start_trial, assemble_forces, net_force, net_body_force, trial_fault, &
    cut_sections, step_t, assemble_residual, assemble_tangent, rates_t, find_rates

  !> Step of the kernels: motion contains increments in place of velocities.
  real(wp), parameter :: unit_step = 1.0_wp

  !> Forces and element state of a trial displacement from a committed state.
  type, extends(visited_t) :: trial_t
    real(wp), allocatable :: motion(:, :)   !! (4, n_node) u, and u minus the committed u
    real(wp), allocatable :: bodies(:, :)   !! (3, n_body) displacement and turn of rigid bodies
    real(wp), allocatable :: body_load(:, :) !! (3, n_body) forces and moments on them
    type(block_state_t) :: elements
    type(contact_state_t), allocatable :: contacts(:)
    real(wp), allocatable :: internal(:, :) !! (2, n_node) divergence of stress
    real(wp), allocatable :: contact(:, :)  !! (2, n_node)
    real(wp), allocatable :: external(:, :) !! (2, n_node) loads and gravity
    real(wp), allocatable :: damping(:, :)  !! (2, n_node) D M v of an equilibrium; allocated with
                                            !! mass damping
    real(wp), allocatable :: slots(:, :)    !! forces of tiles on their special nodes
    type(packed_buffer_t), allocatable :: before(:) !! element values before the step in chunks of
                                                    !! cross sections, until their forces are formed
  contains
    procedure :: visit => visit_trial
  end type trial_t

  !> One step. In statics all weights of the old instant are zero and there is no inertia.
  type, extends(visited_t) :: step_t
    real(wp) :: time = 0.0_wp          !! at its end, s
    real(wp) :: dt = 0.0_wp
    logical :: is_dynamic = .false.
    real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, gamma = 0.5_wp, beta = 0.25_wp
    real(wp), allocatable :: old_force(:, :) !! (2, n_node) `net_force` at its start
    real(wp), allocatable :: old_bodies(:, :) !! (3, n_body) `net_body_force` at its start
    type(equations_t) :: equations
    logical :: searches = .false.      !! line search
    logical :: began_negative = .false. !! odd number of negative pivots at its start
    logical :: starts_slipping = .true. !! points that slipped before slip in the first iteration
    type(prescribed_step_t) :: prescribed    !! prescribed motion
  contains
    procedure :: visit => visit_step
  end type step_t

  !> v(n+1) and a(n+1).
  type :: rates_t
    real(wp), allocatable :: velocity(:, :), acceleration(:, :) !! (2, n_node)
    real(wp), allocatable :: body_velocity(:, :), body_acceleration(:, :) !! (3, n_body)
  end type rates_t

contains

  !> Trial at the committed state.
  subroutine start_trial(model, state, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(trial_t), intent(out) :: trial
    integer :: i

    allocate (trial%bodies(3, size(state%rigids)), trial%body_load(3, size(state%rigids)), &
      source=0.0_wp)
    do i = 1, size(state%rigids)
      trial%bodies(:, i) = state%rigids(i)%displacement
    end do
    allocate (trial%motion(4, model%mesh%n_node), trial%internal(2, model%mesh%n_node), &
      trial%contact(2, model%mesh%n_node), trial%external(2, model%mesh%n_node), source=0.0_wp)
    if (allocated(model%conditions%damping) .or. allocated(model%conditions%part_damping)) &
      allocate (trial%damping, source=trial%external)
    allocate (trial%slots, source=state%force_slots)
    trial%motion(1:2, :) = state%motion(1:2, :)
  end subroutine start_trial

  !> Forces at the displacement in `trial%motion(1:2)` and `trial%bodies`, loads at `time`.
  subroutine assemble_forces(model, state, time, is_first, clock, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state      !! committed
    real(wp), intent(in) :: time
    logical, intent(in) :: is_first         !! points at zero gap count as closed
    type(clock_t), intent(inout) :: clock
    type(trial_t), intent(inout) :: trial
    real(wp), allocatable :: force(:, :)
    real(wp) :: body(2)
    integer :: i

    call place_rigids(model, state%rigids, trial%bodies, trial%motion)
    call move_hanging_nodes(model%mesh, trial%motion)
    trial%motion(3:4, :) = trial%motion(1:2, :) - state%motion(1:2, :)
    ! Element forces from the committed history.
    trial%elements = state%elements
    allocate (force(2, model%layout%n_local))
    do i = 1, size(model%layout%tiles)
      associate (tile => model%layout%tiles(i))
        call add_tile_forces(model, tile, trial%motion, unit_step, trial%elements, force)
        call scatter_tile_forces(tile, force, trial%slots)
        call store_tile_forces(tile, force, trial%internal)
      end associate
    end do
    call sum_special_forces(model%layout, trial%slots, 1, model%layout%n_special, trial%internal)
    call share_hanging_forces(model%mesh, trial%internal)
    call lap(clock, phase_elements)
    trial%contact = 0.0_wp
    trial%contacts = state%contacts
    do i = 1, size(model%contacts)
      call evaluate_contact(model%contacts(i), trial%motion, time, time - state%time, is_first, &
        trial%contacts(i), trial%contact)
      call lap(clock, phase_contact_force)
      call lap_interface(clock, i)
    end do
    call form_external_force(model, trial%motion, time, trial%external)
    call share_hanging_forces(model%mesh, trial%external)
    if (size(model%conditions%body_loads) > 0) then
      body = body_acceleration(model%conditions, model%curves, time)
      trial%external = trial%external + mass_times(model, state%mass, spread(body, 2, &
        model%mesh%n_node))
    end if
    trial%body_load = form_rigid_loads(model, time)
    call lap(clock, phase_nodes)
  end subroutine assemble_forces

  !> Forces of the elements of cross sections, unless the state has them.
  subroutine cut_sections(model, trial, state)
    type(model_t), intent(in) :: model
    type(trial_t), intent(inout) :: trial !! that became the state
    type(state_t), intent(inout) :: state

    if (.not. allocated(trial%before)) return
    call find_cut_forces(model, [1, model%layout%n_chunk], trial%motion, [state%time, unit_step], &
      state%elements, state%cut_force, trial%before)
    deallocate (trial%before)
  end subroutine cut_sections

  !> Internal minus contact and external forces, plus damping.
  pure function net_force(trial) result(force)
    type(trial_t), intent(in) :: trial
    real(wp) :: force(2, size(trial%internal, 2))

    force = trial%internal - trial%contact - trial%external
    if (allocated(trial%damping)) force = force + trial%damping
  end function net_force

  !> Net force and moment of rigid bodies, from the forces on their nodes and their own loads.
  pure function net_body_force(model, state, trial) result(force)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(trial_t), intent(in) :: trial
    real(wp) :: force(3, size(model%rigids))

    force = resultants(model, state%rigids, trial%bodies, net_force(trial)) - trial%body_load
  end function net_body_force

  !> Fault of a trial in words; empty where all volumes are positive and all forces finite.
  pure function trial_fault(trial) result(fault)
    type(trial_t), intent(in) :: trial
    character(:), allocatable :: fault

    fault = ''
    if (.not. minval(trial%elements%volume_limit) > 0.0_wp) then
      fault = 'an element has a negative volume, or no thickness in plane stress'
    else if (.not. sum(abs(trial%external)) + sum(abs(trial%body_load)) <= huge(1.0_wp)) then
      fault = 'the loads are not finite'
    else if (.not. sum(abs(trial%internal)) + sum(abs(trial%contact)) <= huge(1.0_wp)) then
      fault = 'the forces are not finite'
    end if
  end function trial_fault

  !> Visit the forces of the state.
  subroutine visit_trial(self, visitor)
    class(trial_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('internal', self%internal)
    call visitor%visit('contact', self%contact)
    call visitor%visit('external', self%external)
    call visitor%visit('damping', self%damping)
    call visitor%visit('body_load', self%body_load)
  end subroutine visit_trial

  !> R = M A + (1 - alpha_f) f(n+1) + alpha_f f(n) with f = f_int - f_contact - f_ext
  !> + D M v and A = (1 - alpha_m) a(n+1) + alpha_m a(n) (Chung & Hulbert 1993, eq. 12, forces of
  !> both instants weighted); on prescribed degrees of freedom A is the change of velocity over the
  !> step, whatever the weights.
  function assemble_residual(model, state, step, trial) result(residual)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(trial_t), intent(in) :: trial
    real(wp) :: residual(step%equations%n_free)
    real(wp), allocatable :: force(:, :), bodies(:, :)
    type(rates_t) :: rates
    integer :: i

    force = trial%internal - trial%contact - trial%external
    if (step%is_dynamic) then
      call find_rates(model, state, step, trial, rates)
      if (allocated(trial%damping)) force = force + mass_times(model, state%mass, rates%velocity, &
        damping_rates(model, step%time))
    end if
    bodies = resultants(model, state%rigids, trial%bodies, force) - trial%body_load
    if (step%is_dynamic) then
      rates%acceleration = (1.0_wp - step%alpha_m)*rates%acceleration &
        + step%alpha_m*state%acceleration
      call put_prescribed(step%equations%number, step%equations%n_free, step%prescribed%mean, &
        rates%acceleration)
      call move_hanging_nodes(model%mesh, rates%acceleration)
      force = (1.0_wp - step%alpha_f)*force + step%alpha_f*step%old_force &
        + mass_times(model, state%mass, rates%acceleration)
      do i = 1, size(state%rigids)
        associate (rigid => state%rigids(i))
          bodies(:, i) = (1.0_wp - step%alpha_f)*bodies(:, i) + step%alpha_f*step%old_bodies(:, i) &
            + rigid%inertia*((1.0_wp - step%alpha_m)*rates%body_acceleration(:, i) &
            + step%alpha_m*rigid%acceleration)
        end associate
      end do
    end if
    residual = free_entries(step%equations, force, bodies/body_scales(state%rigids))
  end function assemble_residual

  !> v(n+1) and a(n+1): Newmark's formulas from the displacement of the trial, or the curves; nodes
  !> of rigid bodies follow these.
  subroutine find_rates(model, state, step, trial, rates)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(trial_t), intent(in) :: trial
    type(rates_t), intent(out) :: rates
    integer :: i

    rates%acceleration = newmark_acceleration(step, trial%motion(3:4, :), state%motion(3:4, :), &
      state%acceleration)
    rates%velocity = newmark_velocity(step, state%motion(3:4, :), state%acceleration, &
      rates%acceleration)
    allocate (rates%body_velocity(3, size(state%rigids)), &
      rates%body_acceleration(3, size(state%rigids)))
    do i = 1, size(state%rigids)
      associate (rigid => state%rigids(i))
        rates%body_acceleration(:, i) = newmark_acceleration(step, trial%bodies(:, i) &
          - rigid%displacement, rigid%velocity, rigid%acceleration)
        rates%body_velocity(:, i) = newmark_velocity(step, rigid%velocity, rigid%acceleration, &
          rates%body_acceleration(:, i))
      end associate
    end do
    associate (number => step%equations%number, bodies => step%equations%bodies, &
      n_free => step%equations%n_free, given => step%prescribed)
      call put_prescribed(number, n_free, given%velocity, rates%velocity)
      call put_prescribed(number, n_free, given%acceleration, rates%acceleration)
      call put_prescribed(bodies, n_free, given%velocity, rates%body_velocity)
      call put_prescribed(bodies, n_free, given%acceleration, rates%body_acceleration)
    end associate
    call move_hanging_nodes(model%mesh, rates%velocity)
    call move_hanging_nodes(model%mesh, rates%acceleration)
    call spread_rates(model, state%rigids, trial%bodies, rates%body_velocity, &
      rates%body_acceleration, rates%velocity, rates%acceleration)
  end subroutine find_rates

  !> a(n+1) by Newmark's formula.
  elemental function newmark_acceleration(step, increment, velocity, acceleration) result(next)
    type(step_t), intent(in) :: step
    real(wp), intent(in) :: increment              !! u(n+1) - u(n)
    real(wp), intent(in) :: velocity, acceleration !! v(n), a(n)
    real(wp) :: next

    next = (increment - step%dt*velocity)/(step%beta*step%dt**2) - (0.5_wp/step%beta - 1.0_wp) &
      *acceleration
  end function newmark_acceleration

  !> v(n+1) likewise.
  elemental function newmark_velocity(step, velocity, before, after) result(next)
    type(step_t), intent(in) :: step
    real(wp), intent(in) :: velocity, before, after !! v(n), a(n), a(n+1)
    real(wp) :: next

    next = velocity + step%dt*((1.0_wp - step%gamma)*before + step%gamma*after)
  end function newmark_velocity

  !> dR/du(n+1), not compressed. Inertia and damping of prescribed degrees of freedom do not depend
  !> on u, so their columns hold stiffness alone.
  subroutine assemble_tangent(model, state, step, trial, clock, matrix)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(trial_t), intent(in) :: trial
    type(clock_t), intent(inout) :: clock
    type(sparse_t), intent(inout) :: matrix
    integer :: i
    real(wp) :: factors(3, size(model%rigids)), rates(2, size(model%parts) + 1)

    call start_matrix(matrix, step%equations%n)
    call add_stiffness(model, trial%motion, 1.0_wp, state%elements, step%equations%collected, &
      matrix)
    call lap(clock, phase_elements)
    do i = 1, size(model%contacts)
      call add_contact_stiffness(model%contacts(i), trial%contacts(i), step%equations%collected, &
        matrix)
      call lap(clock, phase_contact_force)
      call lap_interface(clock, i)
    end do
    do i = 1, size(model%conditions%pressures)
      call add_pressure_stiffness(model, model%conditions%pressures(i), trial%motion, step%time, &
        step%equations, matrix)
    end do
    call condense_nodes(model, state%rigids, trial%bodies, trial%internal - trial%contact &
      - trial%external, step%equations, matrix)
    if (.not. step%is_dynamic) return
    matrix%values(:matrix%n_entry) = (1.0_wp - step%alpha_f)*matrix%values(:matrix%n_entry)
    call add_free_mass(model, (1.0_wp - step%alpha_m)/(step%beta*step%dt**2), step%equations, &
      matrix)
    factors = (1.0_wp - step%alpha_m)/(step%beta*step%dt**2)
    if (allocated(trial%damping)) then
      rates = damping_rates(model, step%time)
      associate (factor => (1.0_wp - step%alpha_f)*step%gamma/(step%beta*step%dt))
        call add_free_mass(model, factor, step%equations, matrix, rates)
        do i = 1, size(model%rigids)
          factors(:, i) = factors(:, i) + factor*damping_of(state%rigids(i), trial%bodies(3, i), &
            rates(:, model%rigids(i)%part))
        end do
      end associate
    end if
    call add_rigid_diagonal(state%rigids, factors, step%equations, matrix)
  end subroutine assemble_tangent

  !> Minus the derivative of a pressure load with respect to the displacement of its edge; in
  !> axisymmetric models also to its radius.
  subroutine add_pressure_stiffness(model, load, motion, time, equations, matrix)
    type(model_t), intent(in) :: model
    type(pressure_load_t), intent(in) :: load
    real(wp), intent(in) :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: time
    type(equations_t), intent(in) :: equations
    type(sparse_t), intent(inout) :: matrix
    real(wp), parameter :: share(2, 2) = reshape([2.0_wp, 1.0_wp, 1.0_wp, 2.0_wp], [2, 2])/3.0_wp
    real(wp) :: half, block(4, 4), x(2, 2), force(2)
    integer :: rows(4), a, b

    if (time < load%arrival) return
    half = 0.5_wp*load%scale*curve_value(model%curves(load%curve), time - load%arrival)
    ! Force on both nodes: half*(-edge_y, edge_x), edge = x_2 - x_1.
    block = 0.0_wp
    block([1, 3], 2) = -half
    block([1, 3], 4) = half
    block([2, 4], 1) = half
    block([2, 4], 3) = -half
    if (model%is_axisymmetric) then
      ! Node 1 gets (2 r_1 + r_2)/3 of the plane half, node 2 (r_1 + 2 r_2)/3.
      x = model%mesh%coordinates(:, load%nodes) + motion(1:2, load%nodes)
      force = half*[x(2, 1) - x(2, 2), x(1, 2) - x(1, 1)]
      do a = 1, 2
        associate (rows => block(2*a - 1:2*a, :))
          rows = dot_product(share(:, a), x(1, :))*rows
          do b = 1, 2
            rows(:, 2*b - 1) = rows(:, 2*b - 1) - share(b, a)*force
          end do
        end associate
      end do
    end if
    rows = [equations%collected(:, load%nodes(1)), equations%collected(:, load%nodes(2))]
    call add_block(matrix, rows, rows, block)
  end subroutine add_pressure_stiffness

  !> Visit the components that the next step needs.
  subroutine visit_step(self, visitor)
    class(step_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('searches', self%searches)
    call visitor%visit('began_negative', self%began_negative)
  end subroutine visit_step

end module implicit_forces_m
