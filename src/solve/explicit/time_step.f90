! SPDX-License-Identifier: MIT
!> Time step: TSSFAC times the smallest L/c of the elements (or the limit of contact springs),
!> capped by a curve; constant where the curve is constant and below the stable step. Where elements
!> or springs limit the step it falls at once and rises by a twentieth at least; where the curve
!> limits it, it follows the curve. The limit of a cycle applies to the next step, so that a cycle
!> need not wait for its own elements.
module time_step_m
  use block_state_m, only : block_state_t
  use loads_m, only : is_active, scaled_step
  use contact_penalty_m, only : has_default_penalty
  use contact_state_m, only : contact_state_t
  use contact_step_limit_m, only : spring_bound_t, bound_springs, stable_step, sharpness
  use contacts_m, only : contact_t, is_tied, penalty_implicit
  use controls_m, only : contact_step_rules, contact_step_free, contact_step_warns
  use curves_m, only : curve_value, curve_is_constant
  use errors_m, only : error_t, raise, status_input
  use hanging_nodes_m, only : move_hanging_nodes
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use log_m, only : log_t, warn, write_log, to_text
  use model_m, only : model_t
  use node_motion_m, only : leap_t
  use rank_partition_m, only : partition_t
  use ranks_m, only : ranks_t, reduce_min
  use state_m, only : state_t
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: step_plan_t, first_step, largest_change, volume_step, next_step, &
    is_last, cycles_in, limit_approach, limit_default_penalties, update_spring_bounds, &
    has_springs, first_volume_change

  !> Relative rise of the limit below which the step stays.
  real(wp), parameter :: least_rise = 0.05_wp

  !> Change of ln V of an element in a step above which the next step is shorter.
  real(wp), parameter :: largest_change = 0.1_wp

  !> Share of the search radius of a first contact by which bodies may approach in a step.
  real(wp), parameter :: approach_share = 0.8_wp

  !> Cycles between two updates of the spring bounds.
  integer, parameter :: refresh_interval = 20

  !> Control of the time step.
  type, extends(visited_t) :: step_plan_t
    real(wp) :: first_dt = 0.0_wp    !! first step, reference of the floor
    real(wp) :: constant = 0.0_wp    !! constant step while it holds, else 0
    real(wp) :: start_time = 0.0_wp  !! time at `start_cycle`, origin of the constant steps
    integer :: start_cycle = 0
    integer :: n_cycle = 0           !! cycles to the end at the constant step
    integer :: end_cycle = 0         !! ENDCYC, 0 = none
    real(wp) :: end_time = 0.0_wp
    logical :: warned = .false.      !! the curve has exceeded the stable step
    logical :: warned_approach = .false. !! bodies have approached too fast for the step
    type(spring_bound_t), allocatable :: springs(:) !! bounds of the springs that limit the step;
                                                    !! allocated for ECDT = 2, ties, or default
                                                    !! penalties that need it
  contains
    procedure :: visit => visit_steps
  end type step_plan_t

contains

  !> First step from the elements at time zero.
  subroutine first_step(model, elements, log, steps, dt, error)
    type(model_t), intent(in) :: model
    type(block_state_t), intent(in) :: elements
    type(log_t), intent(inout) :: log
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(out) :: dt
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: limit

    limit = minval(elements%time_limit)
    if (allocated(steps%springs)) limit = minval([limit, stable_step(limit, steps%springs)])
    dt = choose_step(model, limit, steps%start_time, log, steps)
    if (model%controls%dt_initial > 0.0_wp .and. model%controls%dt_curve == 0) &
      dt = min(dt, model%controls%dt_initial)
    if (.not. dt > 0.0_wp) then
      call raise(error, 'the first time step is not positive: stable step '//to_text(limit) &
        //', step '//to_text(dt), status_input)
      return
    end if
    steps%first_dt = dt
    if (model%controls%dt_curve > 0 .and. .not. steps%warned) then
      if (curve_is_constant(model%curves(model%controls%dt_curve))) then
        steps%constant = dt
        steps%n_cycle = cycles_in(steps%end_time - steps%start_time, dt)
      end if
    end if
    call write_log(log, 'first time step '//to_text(dt)//', smallest L/c of the elements ' &
      //to_text(minval(elements%time_limit)))
    if (allocated(steps%springs)) call write_log(log, 'stable step of elements and contact ' &
      //'springs '//to_text(limit))
  end subroutine first_step

  !> Step in which ln V of an element changes by at most the admissible amount, from its change in
  !> an earlier step `dt`, since which a time `since` has passed. At a constant rate that is
  !> `largest_change`. A rate that grows from rest, a t, is a dt/2 in the earlier step and a (dt +
  !> since + step/2) in this one: that changes V by at most five times as much.
  pure function volume_step(dt, since, change) result(step)
    real(wp), intent(in) :: dt      !! s
    real(wp), intent(in) :: since   !! one step or none, s
    real(wp), intent(in) :: change  !! of ln V, without its sign
    real(wp) :: step
    real(wp) :: passed

    step = huge(step)
    if (.not. change > tiny(change)) return
    passed = dt + since
    step = sqrt(passed**2 + dt*(dt + 2.0_wp*passed)*(largest_change/change)) - passed
  end function volume_step

  !> Limit a step in which bodies would approach by more than the search radius of a first contact.
  !> A step set by the deck (curve or mass scaling) stays, and the log warns once.
  subroutine limit_approach(model, dt, state, log, steps, limit)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: dt              !! step in which the interfaces last moved, s
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: limit        !! s
    real(wp) :: steps_of(size(state%contacts)), allowed
    logical :: is_set
    integer :: i

    do i = 1, size(steps_of)
      steps_of(i) = approach_step(model%contacts(i), state%contacts(i), dt)
    end do
    allowed = minval(steps_of)
    ! Scaled masses leave a little more than DT2MS.
    is_set = limit <= 1.02_wp*abs(model%controls%mass_step)
    if (model%controls%dt_curve > 0) is_set = is_set &
      .or. curve_value(model%curves(model%controls%dt_curve), state%time) <= limit
    if (.not. is_set) then
      limit = min(limit, allowed)
    else if (allowed < state%dt .and. .not. steps%warned_approach) then
      call warn(log, 'interface '//to_text(model%contacts(minloc(steps_of, 1))%id)//': at time ' &
        //to_text(state%time)//' bodies approach in a step by more than the search radius of a ' &
        //'first contact, and may pass through each other; use a step of at most ' &
        //to_text(allowed))
      steps%warned_approach = .true.
    end if
  end subroutine limit_approach

  !> Number of constant steps `dt` in a time, at least one.
  pure function cycles_in(time, dt) result(n)
    real(wp), intent(in) :: time, dt !! s
    integer :: n

    n = huge(n)
    if (time < 0.5_wp*huge(n)*dt) n = max(1, nint(time/dt))
  end function cycles_in

  !> Step at `time` from the limit of the elements; warns once when the curve exceeds the stable
  !> step.
  function choose_step(model, limit, time, log, steps) result(dt)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: limit, time
    type(log_t), intent(inout) :: log
    type(step_plan_t), intent(inout) :: steps
    real(wp) :: dt, cap

    dt = scaled_step(model, limit, time)
    if (model%controls%dt_curve == 0) return
    cap = curve_value(model%curves(model%controls%dt_curve), time)
    if (cap > limit .and. .not. steps%warned &
      .and. curve_is_constant(model%curves(model%controls%dt_curve))) then
      call warn(log, 'the constant time step '//to_text(cap)//' at time '//to_text(time) &
        //' exceeds the stable step '//to_text(limit)//' of the elements' &
        //trim(merge(' and contact springs', '                    ', allocated(steps%springs))) &
        //'; using TSSFAC times the stable step while it does')
      steps%warned = .true.
    end if
  end function choose_step

  !> Time of cycle `cycle` and the next step. Constant steps give the time as n dt.
  subroutine next_step(model, element_limit, log, cycle, steps, time, dt)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: element_limit     !! smallest L/c
    type(log_t), intent(inout) :: log
    integer, intent(in) :: cycle              !! number of the new cycle
    type(step_plan_t), intent(inout) :: steps
    real(wp), intent(inout) :: time           !! old in, new out
    real(wp), intent(inout) :: dt             !! previous step in, next one out
    real(wp) :: limit, wanted, before
    logical :: changes

    before = time
    if (steps%constant > 0.0_wp) then
      time = steps%start_time + (cycle - steps%start_cycle)*steps%constant
    else
      time = time + dt
    end if
    limit = element_limit
    if (allocated(steps%springs)) limit = minval([limit, stable_step(limit, steps%springs)])
    wanted = choose_step(model, limit, time, log, steps)
    ! Leap-frog conserves energy without drift only at a constant step: limits of elements and
    ! springs oscillate with the vibrations of a body, and a step that follows them feeds energy
    ! into these (doc/theory/time_integration.md). So a step set by a limit is held, one set by a
    ! curve follows it.
    changes = wanted < dt .or. wanted > (1.0_wp + least_rise)*dt
    if (.not. changes .and. model%controls%dt_curve > 0) &
      changes = dt >= curve_value(model%curves(model%controls%dt_curve), before)
    if (changes) dt = wanted
    if (steps%warned) steps%constant = 0.0_wp
  end subroutine next_step

  !> Whether the cycle at `time` is the last: after nint(ENDTIM/dt) constant steps, else the first
  !> cycle at or after the end time.
  pure function is_last(steps, cycle, time) result(last)
    type(step_plan_t), intent(in) :: steps
    integer, intent(in) :: cycle
    real(wp), intent(in) :: time
    logical :: last

    if (steps%constant > 0.0_wp) then
      last = cycle - steps%start_cycle >= steps%n_cycle
    else
      last = time >= steps%end_time*(1.0_wp - 1.0e-12_wp)
    end if
    if (steps%end_cycle > 0) last = last .or. cycle >= steps%end_cycle
  end function is_last

  !> At time zero let the step follow the springs of interfaces whose penalty and step have their
  !> defaults (SFACT or PEN, SLSFAC, LCTM, ECDT), if the springs need less than TSSFAC times the
  !> step of the elements by more than the uncertainty of their bound.
  pure subroutine limit_default_penalties(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, dimension(size(model%contacts)) :: is_default, counts
    type(spring_bound_t) :: bounds(size(model%contacts))
    real(wp) :: limit, dt
    integer :: i

    if (model%controls%contact_step /= contact_step_warns .or. model%controls%dt_curve > 0) return
    is_default = [(has_default_penalty(model%contacts(i), model%controls), &
      i=1, size(model%contacts))]
    if (.not. any(is_default)) return
    limit = minval(state%elements%time_limit)
    dt = scaled_step(model, limit, state%time)
    if (.not. dt < limit) return
    counts = is_default .or. is_tied(model%contacts)
    call bound_springs(model%contacts, state%contact_mass, state%contacts, &
      merge(1.0_wp, 0.0_wp, counts), bounds)
    state%contacts%rules_step = is_default .and. sharpness*dt > stable_step(limit, bounds)
  end subroutine limit_default_penalties

  !> Step in which bodies approach by at most the search radius of a first contact, from the
  !> relative motion in a step `dt`; huge where that is slow, and for ties and a search radius of
  !> the deck.
  pure function approach_step(contact, memory, dt) result(limit)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: dt             !! s
    real(wp) :: limit
    real(wp) :: depth

    limit = huge(limit)
    if (.not. memory%has%contact .or. contact%search_depth > 0.0_wp) return
    depth = min(memory%slave_status%shallowest, memory%master_status%shallowest)
    depth = approach_share*depth
    if (memory%advance > 0.01_wp*depth) limit = dt*(depth/memory%advance)
  end function approach_step

  !> Update the step bounds of the springs every `refresh_interval` cycles: for ECDT = 2, for ties
  !> unless ECDT = 1, and for default penalties that need a smaller step.
  pure subroutine update_spring_bounds(model, state, bounds)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(spring_bound_t), allocatable, intent(inout) :: bounds(:)
    logical :: counts(size(model%contacts))

    if (.not. has_springs(model, state%contacts)) return
    if (mod(state%cycle, refresh_interval) /= 0) return
    counts = (model%controls%contact_step == contact_step_rules &
      .and. model%contacts%penalty_unit /= penalty_implicit) .or. is_tied(model%contacts) &
      .or. state%contacts%rules_step
    if (.not. allocated(bounds)) allocate (bounds(size(model%contacts)))
    call bound_springs(state%interfaces, state%contact_mass, state%contacts, &
      merge(1.0_wp, 0.0_wp, counts), bounds)
    where (.not. counts) bounds%rate = 0.0_wp
  end subroutine update_spring_bounds

  !> Whether springs of interfaces limit the step.
  pure function has_springs(model, memories) result(has)
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(in) :: memories(:) !! of its interfaces
    logical :: has

    has = model%controls%contact_step == contact_step_rules .or. (any(is_tied(model%contacts)) &
      .and. model%controls%contact_step /= contact_step_free) .or. any(memories%rules_step)
  end function has_springs

  !> Visit the components of the step control.
  subroutine visit_steps(self, visitor)
    class(step_plan_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('first_dt', self%first_dt)
    call visitor%expect('first_dt', self%first_dt > 0.0_wp, 'a step that is not positive')
    call visitor%visit('constant', self%constant, 0.0_wp, 'a step below zero')
    call visitor%visit('start_time', self%start_time)
    call visitor%visit('start_cycle', self%start_cycle, 0, huge(1), 'a cycle below zero')
    call visitor%visit('n_cycle', self%n_cycle)
    call visitor%visit('end_cycle', self%end_cycle)
    call visitor%visit('end_time', self%end_time)
    call visitor%expect('constant', .not. self%constant > 0.0_wp &
      .or. self%constant*huge(1) > self%end_time - self%start_time, &
      'a step too small for the end time')
    call visitor%visit('warned', self%warned)
    call visitor%visit('warned_approach', self%warned_approach)
    call visitor%each('springs', self%springs)
  end subroutine visit_steps

  !> Largest |change of ln V| of an element in a step from time zero by the forces in the state.
  !> Rigid walls and implicit penalties are left out.
  subroutine first_volume_change(model, partition, leap, velocity, state, ranks, change)
    type(model_t), intent(in) :: model
    type(partition_t), intent(in) :: partition
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: velocity(:) !! (n_motion) v(1/2) of prescribed motions, m/s
    type(state_t), intent(in) :: state
    type(ranks_t), intent(inout) :: ranks
    real(wp), intent(out) :: change
    real(wp), allocatable :: next(:, :)
    real(wp) :: least(1), push(2), x31(2), x42(2), v31(2), v42(2), rate
    integer :: i, i_tile, i_chunk, slot

    ! v(1/2) of the nodes of this process.
    allocate (next(2, size(state%motion, 2)))
    do i = 1, size(next, 2)
      push = -state%internal_force(:, i)
      if (i <= model%layout%n_special) push = push + state%force_special(:, i)
      next(:, i) = state%motion(3:4, i) + leap%half*(push*state%inverse_mass(:, i) &
        + merge(leap%body, 0.0_wp, state%inverse_mass(:, i) > 0.0_wp))
    end do
    do i = 1, size(velocity)
      associate (motion => model%conditions%motions(i))
        if (is_active(motion, state%time)) next(motion%direction, motion%node) = velocity(i)
      end associate
    end do
    call move_hanging_nodes(model%mesh, next)
    change = 0.0_wp
    do i_tile = partition%first_tile, partition%last_tile
      do i_chunk = model%layout%tiles(i_tile)%first_chunk, model%layout%tiles(i_tile)%last_chunk
        do slot = (i_chunk - 1)*chunk_size + 1, (i_chunk - 1)*chunk_size &
          + model%layout%chunk_elements(i_chunk)
          associate (nodes => model%layout%slot_nodes(:, slot), &
            r => state%elements%reference(slot, :4))
            ! Rate of ln V: of its area, and in bodies of revolution of the radius of its middle.
            x31 = r(1:2) + (state%motion(1:2, nodes(3)) - state%motion(1:2, nodes(1)))
            x42 = r(3:4) + (state%motion(1:2, nodes(4)) - state%motion(1:2, nodes(2)))
            v31 = next(:, nodes(3)) - next(:, nodes(1))
            v42 = next(:, nodes(4)) - next(:, nodes(2))
            rate = (v31(1)*x42(2) - v42(1)*x31(2) + x31(1)*v42(2) - x42(1)*v31(2)) &
              /(x31(1)*x42(2) - x42(1)*x31(2))
            if (model%is_axisymmetric) rate = rate + sum(next(1, nodes)) &
              /sum(model%mesh%coordinates(1, nodes) + state%motion(1, nodes))
          end associate
          change = max(change, leap%dt*abs(rate))
        end do
      end do
    end do
    least = -change
    if (ranks%n > 1) call reduce_min(ranks, least)
    change = -least(1)
  end subroutine first_volume_change

end module time_step_m
