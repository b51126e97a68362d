! SPDX-License-Identifier: MIT
!> Interfaces whose springs push by the gaps of the end of the step (PUNIT 4), in the explicit
!> driver: after all other forces, from the velocities that these would give.
module contact_pressing_m
  use clock_m, only : clock_t, lap, share_contact, phase_contact_force, phase_nodes
  use constraints_m, only : is_active
  use contact_account_m, only : follow_contact
  use contacts_m, only : penalty_implicit
  use implicit_penalty_m, only : coming_step_t, press_ahead
  use kinds_m, only : wp
  use log_m, only : log_t
  use model_m, only : model_t
  use node_motion_m, only : leap_t, find_factors
  use state_m, only : state_t
  implicit none
  private
  public :: press_contacts

contains

  !> Pressures and forces of all such interfaces. One thread: what an interface is given by another
  !> has to be known.
  subroutine press_contacts(model, leap, velocity, clock, log, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: velocity(:)        !! (n_motion) v(n+1/2) of prescribed motions
    type(clock_t), intent(inout) :: clock
    type(log_t), intent(inout) :: log
    type(state_t), intent(inout) :: state
    type(coming_step_t) :: step
    integer :: i

    call lap(clock, phase_nodes)
    do i = 1, size(model%contacts)
      if (model%contacts(i)%penalty_unit /= penalty_implicit) cycle
      if (.not. state%contacts(i)%scratch%waits) cycle
      call foresee(model, leap, velocity, i, state, step)
      call press_ahead(step, state%motion, state%contacts(i), state%force_special)
      call lap(clock, phase_contact_force)
      call share_contact(clock, i)
      call follow_contact(model, i, state, log)
    end do
  end subroutine press_contacts

  !> The step ahead as the nodes of an interface would make it without that: by the forces that are
  !> known, or as they are led.
  subroutine foresee(model, leap, velocity, i_contact, state, step)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap
    real(wp), intent(in) :: velocity(:)
    integer, intent(in) :: i_contact
    type(state_t), intent(in) :: state
    type(coming_step_t), intent(out) :: step
    real(wp) :: half(2), keep(2), led(2, model%layout%n_special)
    integer :: i, k

    step%dt = leap%dt
    step%dt_before = state%dt_before
    step%cycle = state%cycle
    step%time = state%time
    led = 0.0_wp
    do i = 1, size(velocity)
      associate (prescribed => model%conditions%motions(i))
        if (is_active(prescribed, state%time)) led(prescribed%direction, prescribed%node) &
          = velocity(i)
      end associate
    end do
    associate (nodes => state%contacts(i_contact)%nodes)
      allocate (step%velocity(2, size(nodes)), step%mobility(2, size(nodes)))
      do i = 1, size(nodes)
        k = nodes(i)
        call find_factors(leap, state, k, half, keep)
        step%mobility(:, i) = half*state%inverse_mass(:, k)
        step%velocity(:, i) = merge(keep*state%motion(3:4, k) + half*leap%body &
          + step%mobility(:, i)*(state%force_special(:, k) - state%internal_force(:, k)), &
          led(:, k), state%inverse_mass(:, k) > 0.0_wp)
      end do
    end associate
  end subroutine foresee

end module contact_pressing_m
