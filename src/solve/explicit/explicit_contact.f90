! SPDX-License-Identifier: MIT
!> Contact in the explicit cycle. Interfaces whose springs push by the gaps of the end of the step
!> (PUNIT 4): after all other forces, from the velocities that these would give; how nodes of rigid
!> bodies would move then, and how a force at one moves all others (doc/theory/contact.md, section
!> 6.6). The log tells of interfaces whose springs make or lose energy, and of those whose forces
!> are limited (section 6); the trapezoidal rule is the work that the explicit scheme itself does.
module explicit_contact_m
  use clock_m, only : clock_t, lap, share_contact, phase_contact_force, phase_nodes
  use loads_m, only : is_active, part_damping_rate
  use contacts_m, only : penalty_implicit
  use implicit_penalty_m, only : find_rows, pressures_ahead
  use kinds_m, only : wp
  use law_state_m, only : has_made, has_lost, energy_limit_t
  use log_m, only : log_t, warn, write_log, to_text, percent
  use model_m, only : model_t
  use node_motion_m, only : leap_t, look_ahead, solve_rigids, damping_of
  use pressure_step_m, only : pressure_step_t, start_pressure_step
  use rigid_state_m, only : turn_of, shift_by_turn, velocity_of
  use state_m, only : state_t
  use units_m, only : per_depth
  use weighted_gaps_m, only : node_of
  implicit none
  private
  public :: plan_looks, follow_contact, report_contact_energies, pressure_step_t, press_contacts

  !> Cycles between two looks at springs; at more of them the sum over all points would show in the
  !> time of a step.
  integer, parameter :: look_interval = 20
  !> Share of the largest energy so far from which on energy made or lost is told.
  real(wp), parameter :: noticed_share = 0.01_wp
  !> Share of the largest energy so far that all interfaces together may lend to springs that were
  !> caught loaded.
  real(wp), parameter :: lent_share = 0.005_wp
  !> What to look at.
  character(*), parameter :: hint &
    = '; look at corners there, at the penalty and at the time step', not_lost &
    = ' (damping and friction are no part of it)'
  !> Limited cycles raise `recent` by 20, others with force lower it by 1: told from here on, that
  !> is after 50 limited cycles in a row, or more where others lie between; never where no more than
  !> one cycle of 21 is limited.
  integer, parameter :: again_and_again = 1000

contains

  !> Before the contacts of a cycle: whether they look at their springs, the largest energy so far,
  !> what may be lent, and the step to come.
  pure subroutine plan_looks(model, writes, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: writes !! this cycle writes something
    type(state_t), intent(inout) :: state

    if (size(state%contacts) == 0) return
    if (state%cycle > 0) state%largest_energy = max(state%largest_energy, &
      abs(state%initial_energy + (state%external_work + sum(state%contacts%interference%work))))
    if (writes .or. mod(state%cycle, look_interval) == 0) state%contacts%monitor%is_due = .true.
    state%contacts%limit%entry_allowance = lent_share*state%largest_energy/size(state%contacts)
    ! What is led takes from its guide what it needs; not so the folds of a surface with itself.
    if (size(model%conditions%motions) + size(model%conditions%rigid_motions) > 0) then
      where (.not. model%contacts%is_self) state%contacts%limit%entry_allowance = huge(1.0_wp)
    end if
    ! The step of cycle zero is not known yet.
    state%contacts%limit%coming_step = merge(state%dt, 0.0_wp, state%cycle > 0)
  end subroutine plan_looks

  !> After the forces of an interface: what its springs have made or lost, and a warning the first
  !> time that this is much, or where forces are limited again and again.
  subroutine follow_contact(model, i, state, log)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    type(state_t), intent(inout) :: state
    type(log_t), intent(inout) :: log
    real(wp) :: change
    integer :: sign_of

    associate (limit => state%contacts(i)%limit)
      if (limit%recent >= again_and_again .and. .not. limit%warned) then
        limit%warned = .true.
        call warn(log, 'interface '//to_text(model%contacts(i)%id)//': at cycle ' &
          //to_text(state%cycle)//', time '//to_text(state%time)//', again and again' &
          //limit_text(limit)//hint)
      end if
    end associate
    associate (contact => state%contacts(i), monitor => state%contacts(i)%monitor)
      if (.not. monitor%has_sampled) return
      ! What springs hold beyond what they were given is not returned (energy_limit).
      monitor%stored = min(monitor%stored, max(0.0_wp, contact%energy + contact%limit%admissible))
      change = contact%energy - monitor%stored - monitor%balance
      monitor%balance = contact%energy - monitor%stored
      ! What is loaded at time zero is what it stores.
      if (state%cycle == 0) return
      sign_of = merge(has_made, has_lost, change < 0.0_wp)
      if (abs(change) > monitor%changes(sign_of)%amount) then
        monitor%changes(sign_of)%amount = abs(change)
        monitor%changes(sign_of)%time = state%time
        monitor%changes(sign_of)%node = monitor%node
        if (monitor%node > 0) monitor%changes(sign_of)%position = &
          model%mesh%coordinates(:, monitor%node) + state%motion(1:2, monitor%node)
      end if
      sign_of = merge(has_made, has_lost, monitor%balance < 0.0_wp)
      ! In the first cycles the springs hold energy that no work has been booked for yet.
      if (monitor%changes(sign_of)%warned .or. abs(monitor%balance) <= &
        noticed_share*max(state%largest_energy, contact%energy)) return
      ! While an overlap grows there is nothing yet to hold it against.
      if (contact%has%interference .and. contact%interference%remaining > 0.0_wp) return
      ! What impacts take of implicit springs is no fault of theirs; the end tells it.
      if (sign_of == has_lost .and. model%contacts(i)%penalty_unit == penalty_implicit) return
      monitor%changes(sign_of)%warned = .true.
      call warn(log, 'interface '//to_text(model%contacts(i)%id)//': at cycle ' &
        //to_text(state%cycle)//', time '//to_text(state%time)//', the contact springs have ' &
        //amount_text(model, i, sign_of, state)//hint//trim(merge(not_lost, repeat(' ', &
        len(not_lost)), sign_of == has_lost)))
    end associate
  end subroutine follow_contact

  !> How often forces were limited, and by how much.
  function limit_text(limit) result(text)
    type(energy_limit_t), intent(in) :: limit
    character(:), allocatable :: text

    text = ': contact forces limited, so that they return no more energy than they took, in ' &
      //to_text(limit%n_limited)//' of '//to_text(limit%n_loaded) &
      //' cycles with force, the smallest factor '//to_text(limit%least_factor)//' at time ' &
      //to_text(limit%least_time)
  end function limit_text

  !> At the end of a run: each interface whose forces were limited, and each whose springs have made
  !> or lost much, or had.
  subroutine report_contact_energies(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    character(:), allocatable :: name
    integer :: i, sign_of

    do i = 1, size(state%contacts)
      associate (memory => state%contacts(i), monitor => state%contacts(i)%monitor)
        name = 'interface '//to_text(model%contacts(i)%id)
        if (memory%limit%n_limited > 0) call write_log(log, name//limit_text(memory%limit))
        sign_of = merge(has_made, has_lost, monitor%balance < 0.0_wp)
        if (sign_of == has_lost .and. model%contacts(i)%penalty_unit == penalty_implicit) then
          ! Impact is plastic within the first row of elements.
          if (monitor%balance > 0.0_wp) call write_log(log, name//': impacts have taken ' &
            //to_text(monitor%balance)//per_depth(model%controls%units, 'F L', model%is_round) &
            //', '//percent(monitor%balance, state%largest_energy) &
            //' of the largest energy so far; finer meshes lose less')
        else if (abs(monitor%balance) > noticed_share*state%largest_energy .and. state%cycle &
          > 0) then
          call warn(log, name//': in the whole run the contact springs have ' &
            //amount_text(model, i, sign_of, state))
        else if (any(monitor%changes%warned)) then
          call write_log(log, name//': at the end the contact springs have ' &
            //amount_text(model, i, sign_of, state))
        end if
      end associate
    end do
  end subroutine report_contact_energies

  !> How much, of what, and where most of it.
  function amount_text(model, i, sign_of, state) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i, sign_of
    type(state_t), intent(in) :: state
    character(:), allocatable :: text

    associate (monitor => state%contacts(i)%monitor, &
      largest => state%contacts(i)%monitor%changes(sign_of))
      text = trim(merge('made', 'lost', sign_of == has_made))//' energy: ' &
        //to_text(abs(monitor%balance))//', '//percent(abs(monitor%balance), state%largest_energy) &
        //' of the largest energy so far '//to_text(state%largest_energy) &
        //' (initial energy and external work)'
      if (largest%node == 0) return
      text = text//'; the largest step of it, '//to_text(largest%amount)//', near node ' &
        //to_text(model%mesh%node_id(largest%node))//' at ('//to_text(largest%position(1))//', ' &
        //to_text(largest%position(2))//') up to time '//to_text(largest%time)
    end associate
  end function amount_text

  !> Pressures and forces of all such interfaces. One thread: what an interface is given by another
  !> has to be known.
  subroutine press_contacts(model, leap, damping, velocity, clock, log, state, steps)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: damping(2)         !! D per direction
    real(wp), intent(in) :: velocity(:)        !! (n_motion) v(n+1/2) of prescribed motions
    type(clock_t), intent(inout) :: clock
    type(log_t), intent(inout) :: log
    type(state_t), intent(inout) :: state
    type(pressure_step_t), intent(inout) :: steps(:) !! (interfaces) of the call before
    real(wp) :: free(2)
    logical :: are_solved !! rigid bodies: no two interfaces press one that moves
    integer :: i, k

    are_solved = .false.
    call lap(clock, phase_nodes)
    do i = 1, size(model%contacts)
      if (model%contacts(i)%penalty_unit /= penalty_implicit) cycle
      if (.not. state%contacts(i)%scratch%waits) cycle
      if (.not. allocated(steps(i)%velocity)) then
        call start_pressure_step(model%contacts(i), state%contacts(i), steps(i))
        call list_company(model, state%contacts(i)%nodes, steps(i))
      end if
      steps(i)%dt = leap%dt
      if (state%contacts(i)%points%n > 0) then
        call find_rows(steps(i), state%contacts(i))
        ! The step ahead as the nodes that have rows would make it without the interface: what a
        ! force adds to their velocities, and these; 0 where nothing moves them.
        do k = 1, steps(i)%rows%n_node
          associate (l => steps(i)%rows%node(node_of, k))
            call look_ahead(leap, state, state%contacts(i)%nodes(l), steps(i)%mobility(:, l), free)
            steps(i)%velocity(:, l) = merge(free, 0.0_wp, steps(i)%mobility(:, l) > 0.0_wp)
          end associate
        end do
        do k = 1, size(steps(i)%led, 2)
          associate (prescribed => model%conditions%motions(steps(i)%led(1, k)))
            if (is_active(prescribed, state%time)) steps(i)%velocity(prescribed%direction, &
              steps(i)%led(2, k)) = velocity(steps(i)%led(1, k))
          end associate
        end do
        if (size(steps(i)%riders, 2) > 0) then
          if (.not. are_solved) call solve_rigids(model, damping, state)
          are_solved = .true.
          call ride(model, leap, damping, state, steps(i))
        end if
      end if
      steps(i)%dt_before = state%dt_before
      steps(i)%cycle = state%cycle
      steps(i)%time = state%time
      call pressures_ahead(model%contacts(i)%friction, state%motion, steps(i), state%contacts(i), &
        state%force_special)
      call lap(clock, phase_contact_force)
      call share_contact(clock, i)
      call follow_contact(model, i, state, log)
    end do
  end subroutine press_contacts

  !> Which motions lead which nodes of an interface, and which of its nodes belong to which body.
  subroutine list_company(model, nodes, step)
    type(model_t), intent(in) :: model
    integer, intent(in) :: nodes(:)
    type(pressure_step_t), intent(inout) :: step
    integer :: local(model%mesh%n_node) !! number in the interface, 0: not of it
    integer :: led(size(model%conditions%motions)), riders(3, size(nodes)), i, k, n

    local = 0
    local(nodes) = [(i, i=1, size(nodes))]
    led = local(model%conditions%motions%node)
    n = count(led > 0)
    step%led = transpose(reshape([pack([(i, i=1, size(led))], led > 0), pack(led, led > 0)], &
      [n, 2]))
    n = 0
    do i = 1, size(model%rigids)
      do k = 1, size(model%rigids(i)%nodes)
        if (local(model%rigids(i)%nodes(k)) == 0) cycle
        n = n + 1
        riders(:, n) = [i, k, local(model%rigids(i)%nodes(k))]
      end do
    end do
    step%riders = riders(:, :n)
    k = count([(any(riders(1, :n) == i), i=1, size(model%rigids))])
    allocate (step%modes(2, size(nodes), 3*k))
  end subroutine list_company

  !> Velocities of the nodes of bodies whose v(n+1/2) without the interface is known, and the modes
  !> by which these are free to move, times the root of what a unit force along them makes.
  subroutine ride(model, leap, damping, state, step)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: damping(2)       !! D per direction
    type(state_t), intent(in) :: state
    type(pressure_step_t), intent(inout) :: step
    real(wp) :: speed(3), arm(2), unit(3), root, rate(3)
    logical :: is_free(3)
    integer :: i, k, body

    step%n_mode = 0
    body = 0
    do i = 1, size(step%riders, 2)
      if (step%riders(1, i) /= body) then
        if (body > 0) step%n_mode = step%n_mode + count(is_free)
        body = step%riders(1, i)
        ! Which of x, y and the turn of the body are neither held nor led.
        is_free = .not. model%rigids(body)%is_fixed
        do k = 1, size(model%conditions%rigid_motions)
          associate (motion => model%conditions%rigid_motions(k))
            if (motion%node == body .and. is_active(motion, state%time)) &
              is_free(motion%direction) = .false.
          end associate
        end do
        rate = damping_of(state%rigids(body), damping + part_damping_rate(model, &
          model%rigids(body)%part, state%time))
        do k = 1, count(is_free)
          step%modes(:, :, step%n_mode + k) = 0.0_wp
        end do
      end if
      associate (rigid => state%rigids(body), node => step%riders(3, i))
        speed = rigid%next_velocity
        arm = rigid%arms(:, step%riders(2, i))
        arm = arm + shift_by_turn(turn_of(rigid%place(3) + 0.5_wp*step%dt*speed(3)), arm)
        speed(3) = 2.0_wp*sin(0.5_wp*step%dt*speed(3))/step%dt
        step%velocity(:, node) = velocity_of(speed, arm)
        do k = 1, 3
          if (.not. is_free(k)) cycle
          unit = 0.0_wp
          unit(k) = 1.0_wp
          root = sqrt(leap%mean/(1.0_wp + 0.5_wp*rate(k)*leap%mean)/rigid%inertia(k))
          step%modes(:, node, step%n_mode + count(is_free(:k))) = root*velocity_of(unit, arm)
        end do
      end associate
    end do
    if (body > 0) step%n_mode = step%n_mode + count(is_free)
  end subroutine ride

end module explicit_contact_m
