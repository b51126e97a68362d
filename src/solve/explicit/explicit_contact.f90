! SPDX-License-Identifier: MIT
!> Contact in the explicit cycle: energy balance of the springs of each interface by the trapezoidal
!> rule, which is the work of the explicit scheme itself, with warnings where springs create or lose
!> energy or where their forces are limited (doc/theory/contact.md, section 6); implicit penalties
!> (PUNIT 4, section 6.6), which follow all other forces and use the velocities that these give to
!> the nodes of the interface, rigid bodies included.
module explicit_contact_m
  use clock_m, only : clock_t, lap, lap_interface, phase_contact_force, phase_nodes
  use loads_m, only : is_active, part_damping_rate
  use contacts_m, only : penalty_implicit
  use implicit_penalty_m, only : pressure_step_t, start_pressure_step, find_rows, pressures_ahead
  use kinds_m, only : wp
  use law_state_m, only : energy_created, energy_lost, energy_limit_t
  use log_m, only : log_t, warn, write_log, to_text, percent
  use model_m, only : model_t, is_sheet
  use node_motion_m, only : leap_t, predict_velocity, solve_rigids
  use rigid_state_m, only : rotation_terms, rotation_shift, velocity_of, damping_of
  use state_m, only : state_t
  use units_m, only : per_depth
  implicit none
  private
  public :: plan_sampling, check_springs, report_contact_energies, add_implicit_penalties

  !> Cycles between two samples of the springs; shorter intervals would cost time in every step.
  integer, parameter :: sampling_interval = 20
  !> Share of the largest energy above which created, lost or withheld energy is reported.
  real(wp), parameter :: noticed_share = 0.01_wp
  !> Share of the largest energy that is admissible for springs that are loaded at activation, of
  !> all interfaces together.
  real(wp), parameter :: entry_share = 0.005_wp
  character(*), parameter :: hint &
    = '; check corners there, the penalty and the time step', not_lost &
    = ' (damping and friction not included)'

contains

  !> Prepare the contacts of a cycle: sampling of the springs, largest energy, admissible energy at
  !> activation, and the coming step.
  pure subroutine plan_sampling(model, writes, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: writes !! this cycle writes
    type(state_t), intent(inout) :: state

    if (size(state%contacts) == 0) return
    if (state%cycle > 0) state%largest_energy = max(state%largest_energy, &
      abs(state%initial_energy + (state%external_work + sum(state%contacts%interference%work))))
    if (writes .or. mod(state%cycle, sampling_interval) == 0) state%contacts%monitor%is_due = .true.
    state%contacts%limit%entry_allowance = entry_share*state%largest_energy/size(state%contacts)
    ! Prescribed motion supplies what entries need; not so in self contact.
    if (size(model%conditions%motions) + size(model%conditions%rigid_motions) > 0) then
      where (.not. model%contacts%is_self) state%contacts%limit%entry_allowance = huge(1.0_wp)
    end if
    ! The step of cycle zero is not known yet.
    state%contacts%limit%coming_step = merge(state%dt, 0.0_wp, state%cycle > 0)
  end subroutine plan_sampling

  !> Update the balance of the springs of an interface if sampled, and warn the first time that they
  !> created or lost much energy, or that limited forces withheld as much.
  subroutine check_springs(model, i, state, log)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    type(state_t), intent(inout) :: state
    type(log_t), intent(inout) :: log
    integer :: sign_of

    associate (contact => state%contacts(i), limit => state%contacts(i)%limit, &
      monitor => state%contacts(i)%monitor)
      if (.not. monitor%has_sampled) return
      call update_balance(model, i, state)
      if (state%cycle == 0) return
      if (.not. limit%warned .and. limit%n_limited > 0 .and. limit%withheld > noticed_share &
        *max(state%largest_energy, contact%energy)) then
        limit%warned = .true.
        call warn(log, instant()//limit_text(limit, state%largest_energy)//hint)
      end if
      sign_of = merge(energy_created, energy_lost, monitor%balance < 0.0_wp)
      ! In the first cycles the work of the stored energy is not in the balance yet.
      if (monitor%changes(sign_of)%warned .or. abs(monitor%balance) <= &
        noticed_share*max(state%largest_energy, contact%energy)) return
      ! While an interference ramps up there is no energy yet to compare with.
      if (contact%has%interference .and. contact%interference%remaining > 0.0_wp) return
      ! Impacts of implicit springs are plastic; the end reports their loss.
      if (sign_of == energy_lost .and. model%contacts(i)%penalty_unit == penalty_implicit) return
      monitor%changes(sign_of)%warned = .true.
      call warn(log, instant()//'the contact springs ' &
        //amount_text(model, i, sign_of, state)//hint//trim(merge(not_lost, repeat(' ', &
        len(not_lost)), sign_of == energy_lost)))
    end associate

  contains

    !> Interface, cycle and time in words.
    function instant() result(text)
      character(:), allocatable :: text

      text = 'interface '//to_text(model%contacts(i)%id)//': at cycle '//to_text(state%cycle) &
        //', time '//to_text(state%time)//', '
    end function instant

  end subroutine check_springs

  !> Update the balance of sampled springs: energy of the interface minus stored energy. The largest
  !> change of either sign is recorded with its node.
  pure subroutine update_balance(model, i, state)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    type(state_t), intent(inout) :: state
    real(wp) :: change, given

    associate (contact => state%contacts(i), monitor => state%contacts(i)%monitor)
      ! Stored energy beyond the received and admissible energy is not returned (energy_limit).
      given = max(0.0_wp, contact%energy + contact%limit%admissible)
      contact%limit%withheld = max(contact%limit%withheld, monitor%stored - given)
      monitor%stored = min(monitor%stored, given)
      change = contact%energy - monitor%stored - monitor%balance
      monitor%balance = contact%energy - monitor%stored
      ! Springs loaded at time zero start with their stored energy.
      if (state%cycle == 0) return
      associate (largest => monitor%changes(merge(energy_created, energy_lost, change < 0.0_wp)))
        if (abs(change) <= largest%amount) return
        largest%amount = abs(change)
        largest%time = state%time
        largest%node = monitor%node
        if (monitor%node > 0) largest%position = model%mesh%coordinates(:, monitor%node) &
          + state%motion(1:2, monitor%node)
      end associate
    end associate
  end subroutine update_balance

  !> Number of limited cycles, smallest factor and largest withheld energy in words.
  function limit_text(limit, largest) result(text)
    type(energy_limit_t), intent(in) :: limit
    real(wp), intent(in) :: largest !! energy so far, J/m
    character(:), allocatable :: text

    text = 'contact forces limited to the admissible energy in ' &
      //to_text(limit%n_limited)//' of '//to_text(limit%n_loaded) &
      //' cycles with force, the smallest factor '//to_text(limit%least_factor)//' at time ' &
      //to_text(limit%least_time)//'; energy withheld at most '//to_text(limit%withheld)//', ' &
      //percent(limit%withheld, largest)//' of the largest energy so far'
    if (limit%withheld <= noticed_share*largest) text = text//' (negligible)'
  end function limit_text

  !> Report at the end of a run the interfaces whose forces were limited and those whose springs
  !> created or lost much energy.
  subroutine report_contact_energies(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    character(:), allocatable :: name
    integer :: i, sign_of

    do i = 1, size(state%contacts)
      associate (memory => state%contacts(i), monitor => state%contacts(i)%monitor)
        name = 'interface '//to_text(model%contacts(i)%id)
        if (memory%limit%n_limited > 0) call write_log(log, name//': ' &
          //limit_text(memory%limit, state%largest_energy))
        sign_of = merge(energy_created, energy_lost, monitor%balance < 0.0_wp)
        if (sign_of == energy_lost .and. model%contacts(i)%penalty_unit == penalty_implicit) then
          ! Impact is plastic within the first row of elements.
          if (monitor%balance > 0.0_wp) call write_log(log, name//': impacts dissipated ' &
            //to_text(monitor%balance)//per_depth(model%controls%units, 'F L', &
            model%is_axisymmetric, is_sheet(model))//', ' &
            //percent(monitor%balance, state%largest_energy) &
            //' of the largest energy so far; finer meshes lose less')
        else if (abs(monitor%balance) > noticed_share*state%largest_energy .and. state%cycle &
          > 0) then
          call warn(log, name//': in the whole run the contact springs ' &
            //amount_text(model, i, sign_of, state))
        else if (any(monitor%changes%warned)) then
          call write_log(log, name//': at the end the contact springs ' &
            //amount_text(model, i, sign_of, state))
        end if
      end associate
    end do
  end subroutine report_contact_energies

  !> Created or lost energy in words, with the place of the largest change.
  function amount_text(model, i, sign_of, state) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i, sign_of
    type(state_t), intent(in) :: state
    character(:), allocatable :: text

    associate (monitor => state%contacts(i)%monitor, &
      largest => state%contacts(i)%monitor%changes(sign_of))
      text = trim(merge('created', 'lost   ', sign_of == energy_created))//' energy: ' &
        //to_text(abs(monitor%balance))//', '//percent(abs(monitor%balance), state%largest_energy) &
        //' of the largest energy so far '//to_text(state%largest_energy) &
        //' (initial energy and external work)'
      if (largest%node == 0) return
      text = text//'; the largest change, '//to_text(largest%amount)//', near node ' &
        //to_text(model%mesh%node_id(largest%node))//' at ('//to_text(largest%position(1))//', ' &
        //to_text(largest%position(2))//') up to time '//to_text(largest%time)
    end associate
  end function amount_text

  !> Solve for the forces of all interfaces with implicit penalties, one after the other: each adds
  !> to the forces of the next.
  subroutine add_implicit_penalties(model, leap, damping, velocity, clock, log, state, steps)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: damping(2)         !! D per direction
    real(wp), intent(in) :: velocity(:)        !! (n_motion) v(n+1/2) of prescribed motions
    type(clock_t), intent(inout) :: clock
    type(log_t), intent(inout) :: log
    type(state_t), intent(inout) :: state
    type(pressure_step_t), intent(inout) :: steps(:) !! (interfaces) of the previous call
    logical :: are_solved !! rigid bodies are solved: no two interfaces load one that moves
    integer :: i

    are_solved = .false.
    call lap(clock, phase_nodes)
    do i = 1, size(model%contacts)
      if (model%contacts(i)%penalty_unit /= penalty_implicit) cycle
      if (.not. state%contacts(i)%scratch%waits) cycle
      associate (step => steps(i), memory => state%contacts(i))
        if (.not. allocated(step%velocity)) then
          call start_pressure_step(model%contacts(i), memory, step)
          call list_constrained_nodes(model, memory%nodes, step)
        end if
        step%dt = leap%dt
        step%dt_before = state%dt_before
        step%cycle = state%cycle
        step%time = state%time
        if (memory%points%n > 0) then
          call find_rows(step, memory)
          call set_free_velocities(model, leap, velocity, state, memory%nodes, step)
          if (size(step%rigid_nodes, 2) > 0) then
            if (.not. are_solved) call solve_rigids(model, damping, state)
            are_solved = .true.
            call move_rigid_nodes(model, leap, damping, state, step)
          end if
        end if
        call pressures_ahead(model%contacts(i)%friction, state%motion, step, memory, &
          state%force_special)
      end associate
      call lap(clock, phase_contact_force)
      call lap_interface(clock, i)
      call check_springs(model, i, state, log)
    end do
  end subroutine add_implicit_penalties

  !> Set the mobilities of the nodes with rows and their velocities v(n+1/2) without the interface,
  !> 0 where fixed; prescribed velocities.
  subroutine set_free_velocities(model, leap, velocity, state, nodes, step)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: velocity(:)
    type(state_t), intent(in) :: state
    integer, intent(in) :: nodes(:)
    type(pressure_step_t), intent(inout) :: step
    real(wp) :: free(2)
    integer :: k

    do k = 1, size(nodes)
      if (step%rows%last(k) == 0) cycle
      call predict_velocity(leap, state, nodes(k), step%mobility(:, k), free)
      step%velocity(:, k) = merge(free, 0.0_wp, step%mobility(:, k) > 0.0_wp)
    end do
    do k = 1, size(step%prescribed, 2)
      associate (prescribed => model%conditions%motions(step%prescribed(1, k)))
        if (is_active(prescribed, state%time)) step%velocity(prescribed%direction, &
          step%prescribed(2, k)) = velocity(step%prescribed(1, k))
      end associate
    end do
  end subroutine set_free_velocities

  !> List the prescribed nodes of an interface and its nodes of rigid bodies.
  subroutine list_constrained_nodes(model, nodes, step)
    type(model_t), intent(in) :: model
    integer, intent(in) :: nodes(:)
    type(pressure_step_t), intent(inout) :: step
    integer :: local(model%mesh%n_node) !! number in the interface, 0: none
    integer :: prescribed(size(model%conditions%motions)), rigid_nodes(3, size(nodes)), i, k, n

    local = 0
    local(nodes) = [(i, i=1, size(nodes))]
    prescribed = local(model%conditions%motions%node)
    n = count(prescribed > 0)
    step%prescribed = transpose(reshape([pack([(i, i=1, size(prescribed))], prescribed > 0), &
      pack(prescribed, prescribed > 0)], [n, 2]))
    n = 0
    do i = 1, size(model%rigids)
      do k = 1, size(model%rigids(i)%nodes)
        if (local(model%rigids(i)%nodes(k)) == 0) cycle
        n = n + 1
        rigid_nodes(:, n) = [i, k, local(model%rigids(i)%nodes(k))]
      end do
    end do
    step%rigid_nodes = rigid_nodes(:, :n)
    k = count([(any(rigid_nodes(1, :n) == i), i=1, size(model%rigids))])
    allocate (step%modes(2, size(nodes), 3*k))
  end subroutine list_constrained_nodes

  !> Velocities v(n+1/2) of the interface's rigid-body nodes without the interface, and the free
  !> modes of the bodies, scaled by the root of the response to a unit force.
  subroutine move_rigid_nodes(model, leap, damping, state, step)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: damping(2)       !! D per direction
    type(state_t), intent(in) :: state
    type(pressure_step_t), intent(inout) :: step
    real(wp) :: speed(3), arm(2), unit(3), root, rate(3)
    logical :: is_free(3) !! x, y and rotation of the body: neither fixed nor prescribed
    integer :: i, k, body

    step%n_mode = 0
    body = 0
    do i = 1, size(step%rigid_nodes, 2)
      if (step%rigid_nodes(1, i) /= body) then
        if (body > 0) step%n_mode = step%n_mode + count(is_free)
        body = step%rigid_nodes(1, i)
        is_free = .not. model%rigids(body)%is_fixed
        do k = 1, size(model%conditions%rigid_motions)
          associate (motion => model%conditions%rigid_motions(k))
            if (motion%node == body .and. is_active(motion, state%time)) &
              is_free(motion%direction) = .false.
          end associate
        end do
        rate = damping_of(state%rigids(body), state%rigids(body)%displacement(3), damping &
          + part_damping_rate(model, &
          model%rigids(body)%part, state%time))
        step%modes(:, :, step%n_mode + 1:step%n_mode + count(is_free)) = 0.0_wp
      end if
      associate (rigid => state%rigids(body), node => step%rigid_nodes(3, i))
        speed = rigid%next_velocity
        arm = rigid%arms(:, step%rigid_nodes(2, i))
        arm = arm + rotation_shift(rotation_terms(rigid%displacement(3) + &
          0.5_wp*step%dt*speed(3)), arm)
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
  end subroutine move_rigid_nodes

end module explicit_contact_m
