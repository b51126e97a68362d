! SPDX-License-Identifier: MIT
!> What the run says about its interfaces at its start and at its end.
module contact_check_m
  use contact_log_m, only : report_initial_contact, report_released
  use contact_step_limit_m, only : find_step_limit
  use kinds_m, only : wp
  use log_m, only : log_t, warn, to_text
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: report_contact_start, report_contact_end

contains

  !> Initial penetrations, and a warning where the penalty demands a smaller step than `state%dt`.
  subroutine report_contact_start(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    real(wp) :: spring_limit, limit, element_limit, share
    integer :: i, node

    element_limit = minval(state%elements%time_limit)
    do i = 1, size(model%contacts)
      call report_initial_contact(model%contacts(i), model, state%contacts(i), log)
      if (.not. model%controls%contact_limits_step) cycle
      call find_step_limit(model%contacts(i), state%contact_mass, state%contacts(i), &
        spring_limit, node)
      ! Damping of a fraction z of critical takes sqrt(1 + z^2) - z of the limit.
      associate (z => model%contacts(i)%damping)
        spring_limit = spring_limit*(sqrt(1.0_wp + z**2) - z)
      end associate
      ! Squares of frequencies add up at most.
      limit = 1.0_wp/sqrt((1.0_wp/element_limit)**2 + 1.0_wp/spring_limit**2)
      if (state%dt <= limit) cycle
      share = (1.0_wp/state%dt**2 - (1.0_wp/element_limit)**2)*spring_limit**2
      if (share > 0.0_wp) then
        call warn(log, 'interface '//to_text(model%contacts(i)%id)//': its penalty demands a time ' &
          //'step of at most '//to_text(limit)//' (elements alone '//to_text(element_limit) &
          //', contact springs alone '//to_text(spring_limit)//' at node ' &
          //to_text(model%mesh%node_id(node))//'), the step is '//to_text(state%dt) &
          //'; a penalty of '//to_text(share)//' times the present one would fit')
      else
        call warn(log, 'interface '//to_text(model%contacts(i)%id)//': the time step ' &
          //to_text(state%dt)//' lies above the limit of the elements '//to_text(element_limit) &
          //' and leaves no room for contact springs')
      end if
    end do
  end subroutine report_contact_start

  !> First contacts that were released.
  subroutine report_contact_end(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    integer :: i

    do i = 1, size(model%contacts)
      call report_released(model%contacts(i), state%contacts(i), log)
    end do
  end subroutine report_contact_end

end module contact_check_m
