! SPDX-License-Identifier: MIT
!> One implicit step: equilibrium at its end by Newton's method with line search, and detection of a
!> cycle between the same states of stick and slip, which ends the attempt (doc/theory/implicit.md,
!> section 3; doc/theory/contact.md, section 9.8).
module newton_m
  use clock_m, only : clock_t, lap, phase_nodes, phase_solver
  use nodal_forces_m, only : add_gap_round_off
  use contact_state_m, only : contact_state_t
  use controls_m, only : implicit_t
  use element_state_m, only : stress_of_slot
  use equations_m, only : equations_t, free_entries, move_prescribed
  use friction_m, only : let_hold, has_slipped
  use implicit_forces_m, only : trial_t, assemble_forces, trial_fault, step_t, assemble_tangent, &
    assemble_residual
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use law_state_m, only : slips
  use linear_solver_m, only : report_t, solve_linear
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use rigid_equations_m, only : resultants
  use rigid_state_m, only : body_scales
  use sparse_m, only : sparse_t, compress_matrix
  use state_m, only : state_t
  implicit none
  private
  public :: outcome_t, find_equilibrium, freedom_words, slip_cycle_t, detect_slip_cycle

  !> Multiple of the estimated round-off of the residual that counts as reached.
  real(wp), parameter :: floor_margin = 4.0_wp

  !> Share of the previous residual above which it counts as stagnant.
  real(wp), parameter :: stagnation = 0.3_wp

  !> Share of the contact forces below which a residual that does not fall any more is round-off:
  !> where a vertex turns by 1e-7, the last digit of a position decides on which segment a node is.
  !> Its square is the share of the first energy.
  real(wp), parameter :: idle_share = 1.0e-7_wp

  !> Result of a step.
  type :: outcome_t
    logical :: converged = .false.
    integer :: iterations = 0
    logical :: began_negative = .false.    !! odd number of negative pivots of the first matrix
    integer :: singular_equation = 0       !! equation of a free motion, 0 = none
    character(:), allocatable :: reason    !! why it did not converge
  end type outcome_t

  !> Measures of one iteration.
  type :: measure_t
    real(wp) :: energy = 0.0_wp   !! |dU.R|
    real(wp) :: start = 0.0_wp    !! norm of the right-hand side
    real(wp) :: residual = huge(1.0_wp) !! norm of R
    integer :: worst = 0          !! equation of the largest entry of R
    real(wp) :: before = huge(1.0_wp) !! norm of R one iteration before
    real(wp) :: contact = 0.0_wp  !! norm of the contact forces
    real(wp) :: floor = 0.0_wp    !! round-off of R from forces and displacements
    real(wp) :: gap_floor = 0.0_wp !! upper estimate of the round-off, with positions in gaps
    real(wp) :: step = 0.0_wp     !! norm of dU
    real(wp) :: factor = 1.0_wp   !! of the line search
  end type measure_t

  !> Halvings of an iteration that makes an element invalid, and steps of a line search.
  integer, parameter :: most_halvings = 8, most_searches = 6
  !> Smallest share of the remaining step that a step of the line search may take.
  real(wp), parameter :: least_part = 0.1_wp

  !> Search direction of one iteration.
  type :: direction_t
    real(wp), allocatable :: x(:)     !! dU of the free degrees of freedom
    real(wp), allocatable :: b(:)     !! right-hand side, minus the residual at its start
    real(wp), allocatable :: prescribed(:) !! displacement of the prescribed degrees of freedom
    real(wp) :: factor = 1.0_wp       !! accepted share of x
    character(:), allocatable :: fault   !! why it cannot be followed; empty
  end type direction_t

  !> Share of the residual two iterations before above which it has not decreased.
  real(wp), parameter :: fallen = 0.999_wp
  !> Consecutive iterations that must repeat the state of two iterations before.
  integer, parameter :: most_repeats = 3

  !> States of all friction points and residuals of the last two iterations.
  type :: slip_cycle_t
    integer, allocatable :: last(:), before(:)
    real(wp) :: residual_last = huge(1.0_wp), residual_before = huge(1.0_wp)
    integer :: n_repeat = 0      !! consecutive repetitions
    logical :: is_found = .false.
  end type slip_cycle_t

contains

  !> Iterate from the committed state to equilibrium at `step%time`; `trial` holds that state when
  !> converged.
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
    type(direction_t) :: direction
    type(report_t) :: report
    type(slip_cycle_t) :: slip_cycle
    integer :: iteration

    trial%motion(1:2, :) = state%motion(1:2, :)
    call assemble_forces(model, state, step%time, .true., clock, trial)
    outcome%reason = trial_fault(trial)
    if (len(outcome%reason) > 0) return
    if (.not. step%starts_slipping) call let_hold(trial%contacts)
    allocate (direction%prescribed(size(step%prescribed%increment)))
    do iteration = 1, model%controls%implicit%max_iteration
      outcome%iterations = iteration
      direction%prescribed = step%prescribed%increment
      if (iteration > 1) direction%prescribed = 0.0_wp
      call solve_direction(model, state, step, clock, trial, matrix, direction, report)
      if (report%is_singular .and. iteration > 1 .and. has_slipped(trial%contacts)) then
        call let_hold(trial%contacts)
        call solve_direction(model, state, step, clock, trial, matrix, direction, report)
      end if
      if (iteration == 1) outcome%began_negative = report%is_negative
      if (report%is_singular) outcome%singular_equation = report%equation
      outcome%reason = report%message
      if (.not. report%is_solved) return
      now%energy = abs(dot_product(direction%x, direction%b))
      now%step = norm2(direction%x)
      now%start = norm2(direction%b)
      call move_nodes(model, state, step, clock, trial, direction)
      outcome%reason = direction%fault
      if (len(outcome%reason) > 0) return
      now%factor = direction%factor
      call measure_residual(model, state, step, trial, matrix, now)
      ! A body that nothing acts on before its contact closes has no energy in the first iteration.
      if (iteration == 1 .or. .not. first%energy > 0.0_wp) first = now
      call write_log(log, 'step to '//to_text(step%time)//' iteration '//to_text(iteration) &
        //': energy ratio '//to_text(now%energy/max(first%energy, tiny(1.0_wp)))//', |R| ' &
        //to_text(now%residual)//' (round-off '//to_text(now%floor)//'), |dU| ' &
        //to_text(now%step)//', factor '//to_text(now%factor)//', '//report%method &
        //', residual of the solution '//to_text(report%residual))
      outcome%converged = is_converged(model%controls%implicit, first, now, &
        norm2(trial%motion(3:4, :)))
      if (outcome%converged) return
      call detect_slip_cycle(trial%contacts, now%residual, slip_cycle)
      if (slip_cycle%is_found) exit
    end do
    outcome%reason = 'no equilibrium after '//to_text(outcome%iterations)//' iterations'
    if (slip_cycle%is_found) outcome%reason = outcome%reason &
      //', which cycle between the same states of stick and slip'
    outcome%reason = outcome%reason//', largest residual at ' &
      //freedom_words(model, step%equations, now%worst, ' in x', ' in y', ' about z')
    associate (freedom => findloc(step%equations%number, now%worst))
      if (freedom(2) > 0) outcome%reason = outcome%reason//contacts_of(model, freedom(2))
    end associate
  end subroutine find_equilibrium

  !> Node or rigid part of an equation, and one of the words for its direction.
  function freedom_words(model, equations, equation, x, y, turn) result(words)
    type(model_t), intent(in) :: model
    type(equations_t), intent(in) :: equations
    integer, intent(in) :: equation
    character(*), intent(in) :: x, y, turn
    character(:), allocatable :: words
    integer :: freedom(2)

    freedom = findloc(equations%number, equation)
    if (freedom(2) > 0) then
      words = 'node '//to_text(model%mesh%node_id(freedom(2)))
    else
      freedom = max(1, findloc(equations%bodies, equation))
      words = 'rigid part '//to_text(model%parts(model%rigids(freedom(2))%part)%id)
    end if
    select case (freedom(1))
    case (1)
      words = words//x
    case (2)
      words = words//y
    case default
      words = words//turn
    end select
  end function freedom_words

  !> Interfaces of a node in words; empty where there are none.
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

  !> Search direction: solution of the linear system in which prescribed degrees of freedom move by
  !> `direction%prescribed`, to their positions in the first iteration of a step.
  subroutine solve_direction(model, state, step, clock, trial, matrix, direction, report)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(clock_t), intent(inout) :: clock
    type(trial_t), intent(in) :: trial
    type(sparse_t), intent(inout) :: matrix !! of the free degrees of freedom, compressed
    type(direction_t), intent(inout) :: direction
    type(report_t), intent(out) :: report

    direction%b = -assemble_residual(model, state, step, trial)
    call lap(clock, phase_nodes)
    call assemble_tangent(model, state, step, trial, clock, matrix)
    call move_prescribed(step%equations%n_free, direction%prescribed, matrix, direction%b)
    call compress_matrix(matrix)
    if (.not. allocated(direction%x)) allocate (direction%x(step%equations%n_free))
    call solve_linear(matrix, direction%b, direction%x, report)
    call lap(clock, phase_solver)
  end subroutine solve_direction

  !> Norm of the residual and its round-off: of forces, of displacements times stiffness, and of
  !> positions in gaps times contact springs.
  subroutine measure_residual(model, state, step, trial, matrix, now)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(trial_t), intent(in) :: trial
    type(sparse_t), intent(in) :: matrix
    type(measure_t), intent(inout) :: now
    real(wp) :: u(step%equations%n_free), total(step%equations%n_free), &
      scales(3, size(state%rigids))
    real(wp), allocatable :: forces(:, :)
    integer :: i, k

    now%before = now%residual
    u = assemble_residual(model, state, step, trial)
    scales = body_scales(state%rigids)
    now%residual = norm2(u)
    now%worst = maxloc(abs(u), 1)
    now%contact = norm2(magnitudes(abs(trial%contact), 0.0_wp*scales))
    u = abs(free_entries(step%equations, trial%motion(1:2, :), scales*trial%bodies))
    if (allocated(trial%elements%start_dilatation)) u = u + free_entries(step%equations, &
      stage_displacements(model, trial), 0.0_wp*scales)
    total = magnitudes(abs(trial%internal) + abs(trial%contact) + abs(trial%external), &
      abs(trial%body_load))
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
    now%gap_floor = now%floor + epsilon(1.0_wp)*norm2(magnitudes(forces, 0.0_wp*scales))

  contains

    !> Magnitudes of nodal forces and loads of bodies, by free equation.
    function magnitudes(nodal, loads) result(found)
      real(wp), intent(in) :: nodal(:, :), loads(:, :)
      real(wp) :: found(step%equations%n_free)

      found = free_entries(step%equations, nodal, (resultants(model, state%rigids, trial%bodies, &
        nodal, .true.) + loads)/scales)
    end function magnitudes

  end subroutine measure_residual

  !> Displacements that would strain the elements as their stresses do, which a second stage begins
  !> with: its forces cancel at free nodes, but their round-off does not.
  function stage_displacements(model, trial) result(u)
    type(model_t), intent(in) :: model
    type(trial_t), intent(in) :: trial
    real(wp) :: u(2, model%mesh%n_node)
    real(wp) :: stress(4)
    integer :: slot, k

    u = 0.0_wp
    do slot = 1, model%layout%n_slot
      if (model%layout%slot_element(slot) == 0) cycle
      associate (nodes => model%layout%slot_nodes(:, slot), x => model%mesh%coordinates, &
        material => model%materials(model%parts(slot_part(model%layout, slot))%material))
        if (material%is_rigid) cycle
        stress = stress_of_slot(model, trial%motion, trial%elements, slot)
        do k = 1, size(nodes)
          u(:, nodes(k)) = max(u(:, nodes(k)), &
            norm2(stress)/material%bulk*norm2(x(:, nodes(3)) - x(:, nodes(1))))
        end do
      end associate
    end do
  end function stage_displacements

  !> The energy criterion of Kang, Lee & Shin (2023), or the round-off of the residual; other
  !> criteria where the deck sets them.
  pure function is_converged(implicit, first, now, step) result(converged)
    type(implicit_t), intent(in) :: implicit
    type(measure_t), intent(in) :: first, now
    real(wp), intent(in) :: step !! norm of the displacement of the whole step
    logical :: converged

    converged = implicit%is_linear .or. now%residual <= floor_margin*now%floor &
      .or. (now%residual <= floor_margin*now%gap_floor .and. now%residual > stagnation*now%before)
    if (converged) return
    converged = first%energy > 0.0_wp .and. (now%energy <= implicit%energy_tolerance*first%energy &
      .or. (now%energy <= idle_share**2*first%energy .and. now%residual <= idle_share*now%contact &
      .and. now%residual > stagnation*now%before))
    if (implicit%step_tolerance > 0.0_wp) converged = converged .and. now%step &
      <= implicit%step_tolerance*step
    if (implicit%residual_tolerance > 0.0_wp) converged = converged .and. now%residual &
      <= implicit%residual_tolerance*first%start
  end function is_converged

  !> Move the trial along `direction%x`, shortened where elements would become invalid or the
  !> residual along x would not decrease. The first iteration of a step, which moves prescribed
  !> degrees of freedom, is taken in full.
  subroutine move_nodes(model, state, step, clock, trial, direction)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(step_t), intent(in) :: step
    type(clock_t), intent(inout) :: clock
    type(trial_t), intent(inout) :: trial
    type(direction_t), intent(inout) :: direction
    real(wp), allocatable :: start(:, :)  !! (2, n_node) displacement at the start ...
    real(wp), allocatable :: bodies(:, :) !! (3, n_body) ... and that of rigid bodies
    logical :: is_straight
    integer :: i

    start = trial%motion(1:2, :)
    bodies = trial%bodies
    direction%factor = 1.0_wp
    is_straight = .not. any(abs(direction%prescribed) > 0.0_wp)
    do i = 0, most_halvings
      call evaluate_trial()
      if (len(direction%fault) == 0 .or. .not. is_straight) exit
      if (i < most_halvings) direction%factor = 0.5_wp*direction%factor
    end do
    if (is_straight .and. step%searches .and. len(direction%fault) == 0) call search_line()

  contains

    !> The trial at `direction%factor`, and whether it is valid.
    subroutine evaluate_trial()
      real(wp), allocatable :: steps(:) !! by the numbers of the equations from 0 on
      real(wp) :: scales(3, size(bodies, 2))
      integer :: j

      steps = [0.0_wp, direction%factor*direction%x, direction%prescribed]
      do j = 1, size(start, 2)
        trial%motion(1:2, j) = start(:, j) + steps(step%equations%number(:, j) + 1)
      end do
      scales = body_scales(state%rigids)
      do j = 1, size(bodies, 2)
        trial%bodies(:, j) = bodies(:, j) + steps(step%equations%bodies(:, j) + 1)/scales(:, j)
      end do
      call assemble_forces(model, state, step%time, .false., clock, trial)
      direction%fault = trial_fault(trial)
    end subroutine evaluate_trial

    !> Shorten the step by secants until the slope dU.R at its end is no longer positive. A
    !> direction without descent at its start is taken in full.
    subroutine search_line()
      real(wp) :: slope_start, slope, sound_factor
      integer :: k

      slope_start = -dot_product(direction%x, direction%b)
      if (.not. slope_start < 0.0_wp) return
      do k = 1, most_searches
        slope = dot_product(direction%x, assemble_residual(model, state, step, trial))
        if (slope <= model%controls%implicit%search_tolerance*abs(slope_start)) return
        sound_factor = direction%factor
        direction%factor = direction%factor*max(least_part, slope_start/(slope_start - slope))
        call evaluate_trial()
        if (len(direction%fault) == 0) cycle
        direction%factor = sound_factor
        call evaluate_trial()
        return
      end do
    end subroutine search_line

  end subroutine move_nodes

  !> Update the record of stick and slip states after an iteration, and detect a cycle. Unchanged
  !> states are none.
  pure subroutine detect_slip_cycle(contacts, residual, cycle)
    type(contact_state_t), intent(in) :: contacts(:)
    real(wp), intent(in) :: residual !! norm of the residual
    type(slip_cycle_t), intent(inout) :: cycle
    integer, allocatable :: states(:) !! of the friction points of all interfaces
    logical :: repeats
    integer :: i

    allocate (states(0))
    do i = 1, size(contacts)
      if (.not. contacts(i)%has%friction) cycle
      ! Backward slip is a state of its own.
      associate (friction => contacts(i)%friction)
        states = [states, merge(-friction%state, friction%state, &
          friction%state == slips .and. friction%traction < 0.0_wp)]
      end associate
    end do
    if (size(states) == 0) return
    repeats = .false.
    if (allocated(cycle%before)) then
      ! Surfaces that change have other points.
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
  end subroutine detect_slip_cycle

end module newton_m
