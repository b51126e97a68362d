! SPDX-License-Identifier: MIT
!> One step of the implicit method: equilibrium at its end by Newton's method with line search, and
!> whether that goes to and fro between the same states of stick and slip: an attempt that does
!> finds no equilibrium, however many iterations it may take (doc/theory/implicit.md, section 3;
!> doc/theory/contact.md, section 9.8).
module newton_m
  use clock_m, only : clock_t, lap, phase_nodes, phase_solver
  use nodal_forces_m, only : add_gap_round_off
  use contact_state_m, only : contact_state_t
  use controls_m, only : implicit_t
  use equations_m, only : free_entries, move_prescribed
  use friction_m, only : let_hold, has_slipped
  use implicit_forces_m, only : trial_t, assemble_forces, trouble_of, step_t, assemble_tangent, &
    assemble_residual
  use kinds_m, only : wp
  use law_state_m, only : slips
  use linear_solver_m, only : report_t, solve_linear
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use sparse_m, only : sparse_t, compress_matrix
  use state_m, only : state_t
  implicit none
  private
  public :: outcome_t, find_equilibrium, slip_cycle_t, watch_slips

  !> How far above the estimate of the round-off in the residual it counts as reached.
  real(wp), parameter :: floor_margin = 4.0_wp

  !> Part of the residual before above which it counts as falling no more.
  real(wp), parameter :: stagnation = 0.3_wp

  !> How a step ended.
  type :: outcome_t
    logical :: converged = .false.
    integer :: iterations = 0
    logical :: began_negative = .false.    !! an odd number of pivots of the first matrix
    integer :: singular_equation = 0       !! free motion found, 0 = none
    character(:), allocatable :: reason    !! why it did not converge
  end type outcome_t

  !> Measures of one iteration.
  type :: measure_t
    real(wp) :: energy = 0.0_wp   !! |dU.R|
    real(wp) :: start = 0.0_wp    !! norm of what the iteration set out to remove
    real(wp) :: residual = huge(1.0_wp) !! norm of R
    integer :: worst = 0          !! equation of the largest entry of R
    real(wp) :: before = huge(1.0_wp) !! norm of R one iteration ago
    real(wp) :: floor = 0.0_wp    !! round-off in it that comes from forces and displacements
    real(wp) :: gap_floor = 0.0_wp !! and with that of places in gaps, an upper estimate
    real(wp) :: step = 0.0_wp     !! norm of dU
    real(wp) :: factor = 1.0_wp   !! of the line search
  end type measure_t

  !> Halvings of an iteration that leaves the range of sound elements, and steps of a line search.
  integer, parameter :: most_halvings = 8, most_searches = 6
  !> Least part of what is left that a step of the search may take.
  real(wp), parameter :: least_part = 0.1_wp

  !> The way of one iteration.
  type :: way_t
    real(wp), allocatable :: x(:)     !! dU of the free degrees of freedom
    real(wp), allocatable :: b(:)     !! right-hand side, minus the residual at its start
    real(wp), allocatable :: moved(:) !! displacement of the prescribed degrees of freedom
    real(wp) :: factor = 1.0_wp       !! part of x that was gone
    character(:), allocatable :: trouble !! why it can not be gone; empty
  end type way_t

  !> Part of the residual two iterations ago above which it has not fallen.
  real(wp), parameter :: fallen = 0.999_wp
  !> Iterations in a row that have to repeat what was two before.
  integer, parameter :: most_repeats = 3

  !> States of all places of friction and residuals, of the last two iterations.
  type :: slip_cycle_t
    integer, allocatable :: last(:), before(:)
    real(wp) :: residual_last = huge(1.0_wp), residual_before = huge(1.0_wp)
    integer :: n_repeat = 0      !! iterations in a row that repeated
    logical :: is_found = .false.
  end type slip_cycle_t

contains

  !> Iterate from the committed state to equilibrium at `step%time`; `trial` is
  !> that state when converged.
  subroutine find_equilibrium(model, state, step, log, clock, trial, outcome)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(log_t), intent(inout) :: log
    type(clock_t), intent(inout) :: clock
    type(trial_t), intent(inout) :: trial
    type(outcome_t), intent(out) :: outcome
    type(sparse_t) :: matrix
    type(measure_t) :: first, now
    type(way_t) :: way
    type(report_t) :: report
    type(slip_cycle_t) :: slip_cycle
    integer :: iteration, place(2) !! direction and node

    trial%motion(1:2, :) = state%motion(1:2, :)
    call assemble_forces(model, state, step%time, .true., clock, trial)
    outcome%reason = trouble_of(trial)
    if (len(outcome%reason) > 0) return
    if (.not. step%slips_on) call let_hold(trial%contacts)
    allocate (way%moved(size(step%prescribed%increment)))
    do iteration = 1, model%controls%implicit%max_iteration
      outcome%iterations = iteration
      way%moved = step%prescribed%increment
      if (iteration > 1) way%moved = 0.0_wp
      call find_way(model, state, step, clock, trial, matrix, way, report)
      if (report%is_singular .and. iteration > 1 .and. has_slipped(trial%contacts)) then
        call let_hold(trial%contacts)
        call find_way(model, state, step, clock, trial, matrix, way, report)
      end if
      if (iteration == 1) outcome%began_negative = report%is_negative
      if (report%is_singular) outcome%singular_equation = report%equation
      outcome%reason = report%message
      if (.not. report%is_solved) return
      now%energy = abs(dot_product(way%x, way%b))
      now%step = norm2(way%x)
      now%start = norm2(way%b)
      call move_nodes(model, state, step, clock, trial, way)
      outcome%reason = way%trouble
      if (len(outcome%reason) > 0) return
      now%factor = way%factor
      call measure_residual(model, state, step, trial, matrix, now)
      if (iteration == 1) first = now
      call write_log(log, 'step to '//to_text(step%time)//' iteration '//to_text(iteration) &
        //': energy ratio '//to_text(now%energy/max(first%energy, tiny(1.0_wp)))//', |R| ' &
        //to_text(now%residual)//' (round-off '//to_text(now%floor)//'), |dU| ' &
        //to_text(now%step)//', factor '//to_text(now%factor)//', '//report%method &
        //', residual of the solution '//to_text(report%residual))
      outcome%converged = is_converged(model%controls%implicit, first, now, &
        norm2(trial%motion(3:4, :)))
      if (outcome%converged) return
      call watch_slips(trial%contacts, now%residual, slip_cycle)
      if (slip_cycle%is_found) exit
    end do
    place = max(1, findloc(step%equations%number, now%worst))
    outcome%reason = 'no equilibrium after '//to_text(outcome%iterations)//' iterations'
    if (slip_cycle%is_found) outcome%reason = outcome%reason &
      //', the last of which cycle between the same states of stick and slip'
    outcome%reason = outcome%reason//', most force out of balance at node ' &
      //to_text(model%mesh%node_id(place(2)))//' in '//merge('x', 'y', place(1) == 1) &
      //contacts_of(model, place(2))
  end subroutine find_equilibrium

  !> The interfaces that a node belongs to, in words; empty where there are none.
  function contacts_of(model, node) result(words)
    type(model_t), intent(in) :: model
    integer, intent(in) :: node
    character(:), allocatable :: words
    integer :: i

    words = ''
    do i = 1, size(model%contacts)
      associate (contact => model%contacts(i))
        if (any(contact%slave%nodes == node)) words = words//', a slave node of interface ' &
          //to_text(contact%id)
        if (any(contact%master%nodes == node)) words = words//', a master node of interface ' &
          //to_text(contact%id)
      end associate
    end do
  end function contacts_of

  !> Where an iteration leads: the solution of the linear system in which prescribed degrees of
  !> freedom move by `way%moved`, to their places in the first iteration of a step.
  subroutine find_way(model, state, step, clock, trial, matrix, way, report)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(clock_t), intent(inout) :: clock
    type(trial_t), intent(in) :: trial
    type(sparse_t), intent(inout) :: matrix !! of the free degrees of freedom, collected
    type(way_t), intent(inout) :: way
    type(report_t), intent(out) :: report

    way%b = -free_entries(step%equations, assemble_residual(model, state, step, trial))
    call lap(clock, phase_nodes)
    call assemble_tangent(model, state, step, trial, clock, matrix)
    call move_prescribed(step%equations%n_free, way%moved, matrix, way%b)
    call compress_matrix(matrix)
    if (.not. allocated(way%x)) allocate (way%x(step%equations%n_free))
    call solve_linear(matrix, way%b, way%x, report)
    call lap(clock, phase_solver)
  end subroutine find_way

  !> Norm of the residual and of the round-off that it must hold: that of forces, of displacements
  !> times stiffness, and of places in gaps times the springs of contact.
  subroutine measure_residual(model, state, step, trial, matrix, now)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(trial_t), intent(in) :: trial
    type(sparse_t), intent(in) :: matrix
    type(measure_t), intent(inout) :: now
    real(wp) :: u(step%equations%n_free), total(step%equations%n_free)
    real(wp), allocatable :: forces(:, :)
    integer :: i, k

    now%before = now%residual
    u = free_entries(step%equations, assemble_residual(model, state, step, trial))
    now%residual = norm2(u)
    now%worst = maxloc(abs(u), 1)
    u = abs(free_entries(step%equations, trial%motion(1:2, :)))
    total = free_entries(step%equations, abs(trial%internal) + abs(trial%contact) &
      + abs(trial%external))
    do i = 1, matrix%n
      do k = matrix%first(i), matrix%first(i + 1) - 1
        total(i) = total(i) + abs(matrix%value(k))*u(matrix%column(k))
      end do
    end do
    now%floor = epsilon(1.0_wp)*norm2(total)
    forces = 0.0_wp*trial%contact
    do i = 1, size(trial%contacts)
      associate (contact => trial%contacts(i))
        call add_gap_round_off(contact%points, contact%positions, contact%nodes, forces)
      end associate
    end do
    now%gap_floor = now%floor + epsilon(1.0_wp)*norm2(free_entries(step%equations, forces))
  end subroutine measure_residual

  !> The energy criterion of Kang, Lee & Shin (2023) or the round-off floor of the residual; the
  !> other criteria where the deck sets them.
  pure function is_converged(implicit, first, now, step) result(converged)
    type(implicit_t), intent(in) :: implicit
    type(measure_t), intent(in) :: first, now
    real(wp), intent(in) :: step !! norm of the displacement of the whole step
    logical :: converged

    converged = implicit%is_linear .or. now%residual <= floor_margin*now%floor &
      .or. (now%residual <= floor_margin*now%gap_floor .and. now%residual > stagnation*now%before)
    if (converged) return
    converged = now%energy <= implicit%energy_tolerance*first%energy
    if (implicit%step_tolerance > 0.0_wp) converged = converged .and. now%step &
      <= implicit%step_tolerance*step
    if (implicit%residual_tolerance > 0.0_wp) converged = converged .and. now%residual &
      <= implicit%residual_tolerance*first%start
  end function is_converged

  !> Move the trial by `way%x`, shortened where elements would turn inside out or where the residual
  !> along x would not fall. The first iteration of a step, which moves prescribed degrees of
  !> freedom, is gone to its end.
  subroutine move_nodes(model, state, step, clock, trial, way)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(clock_t), intent(inout) :: clock
    type(trial_t), intent(inout) :: trial
    type(way_t), intent(inout) :: way
    real(wp), allocatable :: start(:, :) !! (2, n_node) displacement where the way begins
    logical :: is_straight
    integer :: i

    start = trial%motion(1:2, :)
    way%factor = 1.0_wp
    is_straight = .not. any(abs(way%moved) > 0.0_wp)
    do i = 0, most_halvings
      call go_part()
      if (len(way%trouble) == 0 .or. .not. is_straight) exit
      if (i < most_halvings) way%factor = 0.5_wp*way%factor
    end do
    if (is_straight .and. step%searches .and. len(way%trouble) == 0) call search_line()

  contains

    !> The trial at `way%factor`, and whether it is sound.
    subroutine go_part()
      real(wp), allocatable :: steps(:) !! by the numbers of the equations from 0 on
      integer :: j

      steps = [0.0_wp, way%factor*way%x, way%moved]
      do j = 1, size(start, 2)
        trial%motion(1:2, j) = start(:, j) + steps(step%equations%number(:, j) + 1)
      end do
      call assemble_forces(model, state, step%time, .false., clock, trial)
      way%trouble = trouble_of(trial)
    end subroutine go_part

    !> Shorten the way by secants until the slope dU.R at its end is no longer uphill. A way that
    !> does not lead downhill at its start says nothing and is gone to the end.
    subroutine search_line()
      real(wp) :: slope_start, slope, sound_factor
      integer :: k

      slope_start = -dot_product(way%x, way%b)
      if (.not. slope_start < 0.0_wp) return
      do k = 1, most_searches
        slope = dot_product(way%x, free_entries(step%equations, &
          assemble_residual(model, state, step, trial)))
        if (slope <= model%controls%implicit%search_tolerance*abs(slope_start)) return
        sound_factor = way%factor
        way%factor = way%factor*max(least_part, slope_start/(slope_start - slope))
        call go_part()
        if (len(way%trouble) == 0) cycle
        way%factor = sound_factor
        call go_part()
        return
      end do
    end subroutine search_line

  end subroutine move_nodes

  !> After an iteration. States that stay as they are make no cycle.
  pure subroutine watch_slips(contacts, residual, cycle)
    type(contact_state_t), intent(in) :: contacts(:)
    real(wp), intent(in) :: residual !! norm of the forces out of balance
    type(slip_cycle_t), intent(inout) :: cycle
    integer, allocatable :: states(:) !! of the places of all interfaces with friction
    logical :: repeats
    integer :: i

    allocate (states(0))
    do i = 1, size(contacts)
      if (.not. contacts(i)%has%friction) cycle
      ! Those that slip backwards are another state.
      associate (friction => contacts(i)%friction)
        states = [states, merge(-friction%state, friction%state, &
          friction%state == slips .and. friction%traction < 0.0_wp)]
      end associate
    end do
    if (size(states) == 0) return
    repeats = .false.
    if (allocated(cycle%before)) then
      ! Runs of outlines that change have other places.
      if (size(states) == size(cycle%before) .and. size(states) == size(cycle%last)) &
        repeats = all(states == cycle%before) .and. any(states /= cycle%last) &
        .and. residual > fallen*cycle%residual_before
    end if
    cycle%n_repeat = merge(cycle%n_repeat + 1, 0, repeats)
    cycle%is_found = cycle%n_repeat >= most_repeats
    call move_alloc(cycle%last, cycle%before)
    call move_alloc(states, cycle%last)
    cycle%residual_before = cycle%residual_last
    cycle%residual_last = residual
  end subroutine watch_slips

end module newton_m
