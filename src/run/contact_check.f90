! SPDX-License-Identifier: MIT
!> What the run says about its interfaces at its start and at its end.
module contact_check_m
  use contact_log_m, only : report_initial_contact, report_released, report_tie_step, &
    report_broken
  use contacts_m, only : contact_t, is_tied, penalty_factor, penalty_implicit
  use contact_judging_m, only : report_estimates
  use contact_overhang_m, only : report_overhang
  use contact_softness_m, only : report_softness
  use contact_step_limit_m, only : spring_bound_t, bound_springs, stable_step, closed_step, &
    opening_step, binding_bound, fitting_scale, sharpness
  use controls_m, only : controls_t, contact_step_free
  use kinds_m, only : wp
  use log_m, only : log_t, warn, write_log, to_text
  use model_m, only : model_t
  use state_m, only : state_t
  use units_m, only : per_depth
  implicit none
  private
  public :: report_contact_start, report_contact_end

  !> By which a step may miss the bound that its penalty was made for (PUNIT 3).
  real(wp), parameter :: round_off = 1.0e-12_wp

contains

  !> Initial penetrations, places just beyond ends of the master, and in explicit runs where the
  !> penalty demands a smaller step than `state%dt`: a warning, unless it is the built-in penalty
  !> and the step need not be too large.
  subroutine report_contact_start(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    type(spring_bound_t) :: bounds(size(model%contacts))
    real(wp) :: element_limit
    logical :: limits_step
    integer :: i

    limits_step = model%controls%contact_step /= contact_step_free &
      .and. .not. model%controls%implicit%is_on
    element_limit = minval(state%elements%time_limit)
    ! Contact behind ties has no place yet that these do not hold.
    if (.not. model%controls%implicit%is_on .and. (limits_step .or. any(is_tied(model%contacts)))) &
      call bound_springs(model%contacts, state%contact_mass, state%contacts, &
      merge(0.0_wp, 1.0_wp, model%contacts%behind > 0 &
      .or. model%contacts%penalty_unit == penalty_implicit), bounds)
    do i = 1, size(model%contacts)
      if (is_tied(model%contacts(i))) then
        if (limits_step) then
          call report_tie_step(model%contacts(i)%id, element_limit, &
            stable_step(element_limit, bounds(i)), log)
        else if (.not. model%controls%implicit%is_on) then
          call warn_of_free_ties(model%contacts(i)%id, state%dt, &
            closed_step(element_limit, bounds(i)), log)
        end if
        cycle
      end if
      call report_initial_contact(model%contacts(i), model, state%contacts(i), log)
      if (model%contacts(i)%behind > 0) cycle
      call report_overhang(model%contacts(i), model, state%contacts(i), log)
      if (.not. limits_step .or. model%contacts(i)%penalty_unit == penalty_implicit) cycle
      if (state%contacts(i)%rules_step) call tell_obeyed_step(model%contacts(i)%id, &
        model%controls%dt_scale*element_limit, element_limit, bounds(i), log)
      if (state%dt <= stable_step(element_limit, bounds(i))*(1.0_wp + round_off)) cycle
      if (has_usual_penalty(model%contacts(i), model%controls) .and. state%dt < element_limit &
        .and. state%dt*sharpness <= stable_step(element_limit, bounds(i))) then
        call tell_usual_step(model%contacts(i)%id, state%dt, element_limit, bounds(i), log)
      else
        call warn_of_step(model, i, state%dt, element_limit, bounds(i), log)
      end if
    end do
  end subroutine report_contact_start

  !> Whether nobody has made the penalty larger than the built-in one.
  pure function has_usual_penalty(contact, controls) result(has)
    type(contact_t), intent(in) :: contact
    type(controls_t), intent(in) :: controls
    logical :: has
    type(controls_t) :: default

    has = contact%penalty_unit == penalty_factor &
      .and. max(contact%penalty, contact%master_penalty) <= 1.0_wp &
      .and. controls%penalty_scale <= default%penalty_scale
  end function has_usual_penalty

  !> The line for an interface whose springs the step obeys, since nobody has chosen either.
  subroutine tell_obeyed_step(id, dt, element_limit, bound, log)
    integer, intent(in) :: id
    real(wp), intent(in) :: dt            !! step without this contact, s
    real(wp), intent(in) :: element_limit !! s
    type(spring_bound_t), intent(in) :: bound
    type(log_t), intent(inout) :: log

    call write_log(log, 'interface '//to_text(id)//': the step obeys its springs, since the deck ' &
      //'leaves penalty and step to the program: stable step ' &
      //to_text(stable_step(element_limit, bound))//', of the elements alone ' &
      //to_text(element_limit)//'; a penalty of ' &
      //to_text(fitting_scale(dt, element_limit, bound)) &
      //' times this one would fit the step of the elements')
  end subroutine tell_obeyed_step

  !> The line for such an interface.
  subroutine tell_usual_step(id, dt, element_limit, bound, log)
    integer, intent(in) :: id
    real(wp), intent(in) :: dt, element_limit !! s
    type(spring_bound_t), intent(in) :: bound
    type(log_t), intent(inout) :: log

    call write_log(log, 'interface '//to_text(id)//': the step '//to_text(dt)//' is above ' &
      //to_text(stable_step(element_limit, bound))//', the bound of ' &
      //binding_bound(element_limit, bound)//', by less than that may be too low for the ' &
      //'built-in penalty; ECDT 2 of *CONTROL_CONTACT, or ' &
      //to_text(fitting_scale(dt, element_limit, bound))//' times the penalty, keeps to it')
  end subroutine tell_usual_step

  !> A step that leaves ties out of account, where it lies above what they bear.
  subroutine warn_of_free_ties(id, dt, limit, log)
    integer, intent(in) :: id
    real(wp), intent(in) :: dt, limit !! s
    type(log_t), intent(inout) :: log

    if (dt > limit*(1.0_wp + round_off)) call warn(log, 'interface '//to_text(id)//': with its ' &
      //'ties the stable step is '//to_text(limit)//', the step is '//to_text(dt) &
      //' (ECDT 1 of *CONTROL_CONTACT leaves springs out of it): the run may gain energy ' &
      //'without bound')
  end subroutine warn_of_free_ties

  !> The warning for one interface: which bound asks for what, the node and the penalty that would
  !> fit.
  subroutine warn_of_step(model, i, dt, element_limit, bound, log)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    real(wp), intent(in) :: dt, element_limit !! s
    type(spring_bound_t), intent(in) :: bound
    type(log_t), intent(inout) :: log

    if (dt < element_limit) then
      call warn(log, 'interface '//to_text(model%contacts(i)%id)//': its penalty demands a time ' &
        //'step of at most '//to_text(stable_step(element_limit, bound))//', the bound of ' &
        //binding_bound(element_limit, bound)//' (while they stay closed ' &
        //to_text(closed_step(element_limit, bound))//', where they open and close ' &
        //to_text(opening_step(bound))//', elements alone '//to_text(element_limit) &
        //', springs of all contacts at its nodes alone ' &
        //to_text(closed_step(huge(1.0_wp), bound))//' at node ' &
        //to_text(model%mesh%node_id(bound%node))//'), the step is '//to_text(dt) &
        //'; a penalty of '//to_text(fitting_scale(dt, element_limit, bound)) &
        //' times the present one would fit')
    else
      call warn(log, 'interface '//to_text(model%contacts(i)%id)//': the time step ' &
        //to_text(dt)//' lies above the limit of the elements '//to_text(element_limit) &
        //' and leaves no room for contact springs')
    end if
  end subroutine warn_of_step

  !> First contacts that were released, and how good the answer is.
  subroutine report_contact_end(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    integer :: i

    call report_estimates(model, state, log)
    call report_softness(model, state, log)
    do i = 1, size(model%contacts)
      call report_released(model%contacts(i), state%contacts(i), log)
      call report_broken(model%contacts(i), model%controls%units, state%contacts(i), log)
      associate (friction => state%contacts(i)%friction)
        if (abs(friction%work) > 0.0_wp) call write_log(log, 'interface ' &
          //to_text(model%contacts(i)%id)//': friction has dissipated ' &
          //to_text(friction%work - friction%stored) &
          //per_depth(model%controls%units, 'F L', model%is_round))
      end associate
    end do
  end subroutine report_contact_end

end module contact_check_m
