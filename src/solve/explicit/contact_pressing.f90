! SPDX-License-Identifier: MIT
!> Interfaces whose springs push by the gaps of the end of the step (PUNIT 4), in the explicit
!> driver: after all other forces, from the velocities that these would give; how nodes of rigid
!> bodies would move then, and how a force at one moves all others (doc/theory/contact.md, section
!> 6.6).
module contact_pressing_m
  use clock_m, only : clock_t, lap, share_contact, phase_contact_force, phase_nodes
  use constraints_m, only : is_active
  use contact_account_m, only : follow_contact
  use contacts_m, only : penalty_implicit
  use implicit_penalty_m, only : find_rows, press_ahead
  use kinds_m, only : wp
  use log_m, only : log_t
  use model_m, only : model_t
  use node_motion_m, only : leap_t, look_ahead
  use external_force_m, only : part_damping_rate
  use pressing_m, only : pressing_t, start_pressing
  use rigid_motion_m, only : solve_rigids, damping_of
  use rigid_state_m, only : turn_of, shift_by_turn, velocity_of
  use state_m, only : state_t
  use weighted_gaps_m, only : node_of
  implicit none
  private
  public :: pressing_t, press_contacts

contains

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
    type(pressing_t), intent(inout) :: steps(:) !! (interfaces) of the call before
    real(wp) :: free(2)
    logical :: are_solved !! rigid bodies: no two interfaces press one that moves
    integer :: i, k

    are_solved = .false.
    call lap(clock, phase_nodes)
    do i = 1, size(model%contacts)
      if (model%contacts(i)%penalty_unit /= penalty_implicit) cycle
      if (.not. state%contacts(i)%scratch%waits) cycle
      if (.not. allocated(steps(i)%velocity)) then
        call start_pressing(model%contacts(i), state%contacts(i), steps(i))
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
      call press_ahead(model%contacts(i)%friction, state%motion, steps(i), state%contacts(i), &
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
    type(pressing_t), intent(inout) :: step
    integer :: local(model%mesh%n_node) !! number in the interface, 0: not of it
    integer :: led(size(model%conditions%motions)), riders(3, size(nodes)), i, k, n

    local = 0
    local(nodes) = [(i, i=1, size(nodes))]
    led = local(model%conditions%motions%node)
    n = count(led > 0)
    step%led = transpose(reshape([pack([(i, i=1, size(led))], led > 0), pack(led, led > 0)], [n, 2]))
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
    type(pressing_t), intent(inout) :: step
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

end module contact_pressing_m
