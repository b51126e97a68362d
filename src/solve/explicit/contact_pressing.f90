! SPDX-License-Identifier: MIT
!> Interfaces whose springs push by the gaps of the end of the step (PUNIT 4), in the explicit
!> driver: after all other forces, from the velocities that these would give.
module contact_pressing_m
  use clock_m, only : clock_t, lap, share_contact, phase_contact_force, phase_nodes
  use constraints_m, only : is_active
  use contact_account_m, only : follow_contact
  use contacts_m, only : penalty_implicit
  use implicit_penalty_m, only : press_ahead
  use kinds_m, only : wp
  use log_m, only : log_t
  use model_m, only : model_t
  use node_motion_m, only : leap_t, find_factors
  use pressing_m, only : pressing_t, start_pressing
  use part_damping_m, only : part_damping_rate
  use rigid_motion_m, only : solve_rigids, damping_of
  use rigid_pressing_m, only : list_riders, ride
  use state_m, only : state_t
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
    integer :: i

    call lap(clock, phase_nodes)
    do i = 1, size(model%contacts)
      if (model%contacts(i)%penalty_unit /= penalty_implicit) cycle
      if (.not. state%contacts(i)%scratch%waits) cycle
      if (.not. allocated(steps(i)%velocity)) then
        call start_pressing(model%contacts(i), state%contacts(i), steps(i))
        call list_led(model, state%contacts(i)%nodes, steps(i))
        call list_riders(model, state%contacts(i)%nodes, steps(i))
      end if
      steps(i)%dt = leap%dt
      if (state%contacts(i)%points%n > 0) then
        call foresee(leap, state%contacts(i)%nodes, state, steps(i))
        call lead(model, velocity, state%time, steps(i))
        if (size(steps(i)%riders, 2) > 0) call carry(model, leap, damping, state, steps(i))
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

  !> The step ahead as the nodes of an interface would make it without that, by the forces that are
  !> known.
  subroutine foresee(leap, nodes, state, step)
    type(leap_t), intent(in) :: leap
    integer, intent(in) :: nodes(:)
    type(state_t), intent(in) :: state
    type(pressing_t), intent(inout) :: step
    real(wp) :: half(2), keep(2)
    integer :: i, j, k

    half = leap%half
    keep = leap%keep
    do i = 1, size(nodes)
      k = nodes(i)
      if (allocated(state%node_damping)) call find_factors(leap, state, k, half, keep)
      do j = 1, 2
        step%mobility(j, i) = half(j)*state%inverse_mass(j, k)
        step%velocity(j, i) = keep(j)*state%motion(2 + j, k) + half(j)*leap%body(j) &
          + step%mobility(j, i)*(state%force_special(j, k) - state%internal_force(j, k))
        if (.not. state%inverse_mass(j, k) > 0.0_wp) step%velocity(j, i) = 0.0_wp
      end do
    end do
  end subroutine foresee

  !> Nodes of rigid bodies, by the forces that are known.
  subroutine carry(model, leap, damping, state, step)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: damping(2) !! D per direction
    type(state_t), intent(inout) :: state
    type(pressing_t), intent(inout) :: step
    real(wp) :: half(3, size(model%rigids)), rate(3)
    integer :: i

    call solve_rigids(model, damping, state)
    do i = 1, size(model%rigids)
      rate = damping_of(state%rigids(i), damping + part_damping_rate(model, &
        model%rigids(i)%part, state%time))
      half(:, i) = leap%mean/(1.0_wp + 0.5_wp*rate*leap%mean)
    end do
    call ride(model, half, state, step)
  end subroutine carry

  !> Which motions lead which nodes of an interface.
  subroutine list_led(model, nodes, step)
    type(model_t), intent(in) :: model
    integer, intent(in) :: nodes(:)
    type(pressing_t), intent(inout) :: step
    integer :: local(model%mesh%n_node), led(2, size(model%conditions%motions)), i, n

    local = 0
    do i = 1, size(nodes)
      local(nodes(i)) = i
    end do
    n = 0
    do i = 1, size(model%conditions%motions)
      if (local(model%conditions%motions(i)%node) == 0) cycle
      n = n + 1
      led(:, n) = [i, local(model%conditions%motions(i)%node)]
    end do
    allocate (step%led(2, n))
    step%led(:, :) = led(:, :n)
  end subroutine list_led

  !> The nodes that are led.
  subroutine lead(model, velocity, time, step)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: velocity(:)     !! (n_motion)
    real(wp), intent(in) :: time            !! s
    type(pressing_t), intent(inout) :: step
    integer :: i

    do i = 1, size(step%led, 2)
      associate (prescribed => model%conditions%motions(step%led(1, i)))
        if (is_active(prescribed, time)) &
          step%velocity(prescribed%direction, step%led(2, i)) = velocity(step%led(1, i))
      end associate
    end do
  end subroutine lead

end module contact_pressing_m
