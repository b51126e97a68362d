! SPDX-License-Identifier: MIT
!> Penalties that the deck gives as a share of the largest one for which the step is stable (PUNIT
!> 3), by the bound of springs that stay closed and by that of springs that open and close. The step
!> is the one that the elements, and ties, alone would have (TSSFAC times the smallest L/c, or the
!> curve LCTM). Each such interface may take what that step leaves beside the elements; where
!> interfaces share nodes, all automatic ones are lowered by the same factor until their sum fits.
!> A penalty from the built-in estimate (PUNIT 2) may take no more than that either where its
!> surface is of soft and stiff materials: the mean of these, in springs on nodes of the soft one,
!> would turn them round within a step.
module automatic_penalty_m
  use contact_log_m, only : penalty_text
  use contact_penalty_m, only : spread_of_stiffness, has_default_penalty
  use contact_step_limit_m, only : spring_bound_t, bound_springs, stable_step, closed_step, &
    binding_bound, fitting_scale
  use contact_state_m, only : contact_state_t
  use contacts_m, only : is_tied, penalty_factor, penalty_share
  use controls_m, only : contact_step_free, contact_step_warns
  use element_dispatch_m, only : add_tile_forces
  use errors_m, only : error_t, raise, status_input
  use kinds_m, only : wp
  use log_m, only : log_t, warn, write_log, to_text
  use mass_scaling_m, only : refine_limits, needs_refinement
  use model_m, only : model_t
  use loads_m, only : scaled_step
  use state_m, only : state_t
  implicit none
  private
  public :: set_automatic_penalties

  integer, parameter :: n_halving = 60           !! of the common factor
  real(wp), parameter :: round_off = 1.0e-12_wp  !! by which a bound may miss the step that it was
                                                 !! made for
  real(wp), parameter :: much_stiffer = 10.0_wp  !! ratio of bulk moduli of one surface

contains

  !> Give every interface with PUNIT 3 its penalty and tell the log; lower those of surfaces of soft
  !> and stiff materials to what the step bears.
  subroutine set_automatic_penalties(model, state, log, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(log_t), intent(inout) :: log
    type(error_t), allocatable, intent(out) :: error
    real(wp), dimension(size(model%contacts)) :: share, factor
    real(wp), allocatable :: force(:, :)
    real(wp) :: limit, tied, dt
    type(spring_bound_t) :: bounds(size(model%contacts))
    integer :: i

    share = sought_shares(model)
    if (.not. any(share > 0.0_wp)) return
    ! One pass over the elements at rest leaves their stable steps behind.
    allocate (force(2, model%layout%n_local))
    do i = 1, size(model%layout%tiles)
      associate (tile => model%layout%tiles(i))
        call add_tile_forces(model, tile, state%motion, 0.0_wp, state%elements, force)
        if (needs_refinement(state%elements)) &
          call refine_limits(model, tile, state%motion, 0.0_wp, state%elements)
      end associate
    end do
    limit = minval(state%elements%time_limit)
    ! Ties may lower it.
    tied = limit
    if (model%controls%contact_step /= contact_step_free .and. any(is_tied(model%contacts))) then
      call bound_springs(model%contacts, state%contact_mass, state%contacts, &
        merge(1.0_wp, 0.0_wp, is_tied(model%contacts)), bounds)
      tied = minval(closed_step(limit, bounds))
    end if
    dt = scaled_step(model, tied, state%time)
    if (.not. dt < limit) then
      if (any(model%contacts%penalty_unit == penalty_share)) call raise(error, &
        'an automatic penalty (PUNIT 3) finds no room: the time step ' &
        //to_text(dt)//' is not below the stable step of the elements '//to_text(limit) &
        //'; choose a smaller TSSFAC or LCTM', status_input)
      return
    end if
    call find_factors(model, state, [dt, limit], share, factor)
    do i = 1, size(factor)
      if (model%contacts(i)%penalty_unit /= penalty_share) cycle
      if (.not. factor(i) > 0.0_wp) then
        call raise(error, 'interface '//to_text(model%contacts(i)%id)//': the penalties of other ' &
          //'interfaces at its nodes leave no room for an automatic one (PUNIT 3) at the time ' &
          //'step '//to_text(dt), status_input)
        return
      end if
    end do
    call bound_whole(model, state, share, factor, bounds)
    do i = 1, size(factor)
      if (.not. (share(i) > 0.0_wp .and. factor(i) > 0.0_wp)) cycle
      if (model%contacts(i)%penalty_unit == penalty_factor .and. factor(i) >= 1.0_wp) cycle
      associate (memory => state%contacts(i))
        memory%slave_penalty = factor(i)*memory%slave_penalty
        memory%master_penalty = factor(i)*memory%master_penalty
        memory%node_penalty = factor(i)*memory%node_penalty
      end associate
      if (model%contacts(i)%penalty_unit == penalty_share) then
        call write_log(log, 'interface '//to_text(model%contacts(i)%id)//': penalty ' &
          //penalty_text(model%contacts(i), model, state%contacts(i))//', ' &
          //to_text(model%contacts(i)%penalty)//' of the largest for a time step of ' &
          //to_text(dt)//' by the bound of '//binding_bound(limit, bounds(i)))
      else
        call report_lowered_penalty(model, i, dt, state%contacts(i), log)
      end if
    end do
  end subroutine set_automatic_penalties

  !> Interface `i` has less than the built-in penalty, and what does without: a warning where
  !> somebody has chosen the penalty.
  subroutine report_lowered_penalty(model, i, dt, memory, log)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    real(wp), intent(in) :: dt !! s
    type(contact_state_t), intent(in) :: memory !! with the penalty that it has now
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text

    text = 'interface '//to_text(model%contacts(i)%id)//': one of its surfaces is of soft ' &
      //'and stiff materials, and nodes of the soft ones do not bear the mean penalty of both at ' &
      //'the time step '//to_text(dt)//'; it is lowered to ' &
      //penalty_text(model%contacts(i), model, memory)//'. Stiff parts sink in less with ' &
      //'interfaces of their own, or with the step of the springs (ECDT 2 of *CONTROL_CONTACT)'
    if (has_default_penalty(model%contacts(i), model%controls)) then
      call write_log(log, text)
    else
      call warn(log, text)
    end if
  end subroutine report_lowered_penalty

  !> By interface the share of the largest stable penalty that the memory holds a penalty of: PEN
  !> with PUNIT 3; 1 for the mean of soft and stiff materials, which may have no more than that, in
  !> an explicit run whose step does not follow it; 0 for penalties that stand as given.
  pure function sought_shares(model) result(share)
    type(model_t), intent(in) :: model
    real(wp) :: share(size(model%contacts))
    integer :: i

    share = 0.0_wp
    do i = 1, size(share)
      associate (contact => model%contacts(i))
        if (contact%penalty_unit == penalty_share) share(i) = contact%penalty
        if (contact%penalty_unit /= penalty_factor &
          .or. model%controls%contact_step /= contact_step_warns .or. is_tied(contact) &
          .or. model%controls%implicit%is_on) cycle
        if (max(spread_of_stiffness(contact%slave, model), spread_of_stiffness(contact%master, &
          model)) >= much_stiffer) share(i) = 1.0_wp
      end associate
    end do
  end function sought_shares

  !> Factors on the penalties in the memories: 0 where there is no room, 1 for given penalties.
  pure subroutine find_factors(model, state, steps, share, factor)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: steps(2) !! the step, and the stable one of the elements, s
    real(wp), intent(in) :: share(:)
    real(wp), intent(out) :: factor(:)
    type(spring_bound_t) :: bounds(size(factor))
    real(wp) :: whole(size(factor)), low, high
    integer :: i

    whole = 0.0_wp
    where (share > 0.0_wp) whole = 1.0_wp/share
    ! Each as if there were no other one.
    do i = 1, size(factor)
      call bound_springs(model%contacts(i:i), state%contact_mass, state%contacts(i:i), &
        whole(i:i), bounds(i:i))
    end do
    factor = 1.0_wp
    where (share > 0.0_wp) factor = fitting_scale(steps(1), steps(2), bounds)
    where (model%contacts%penalty_unit == penalty_factor) factor = min(factor, 1.0_wp)
    if (fits(factor)) return
    low = 0.0_wp
    high = 1.0_wp
    do i = 1, n_halving
      if (fits(0.5_wp*(low + high)*factor)) then
        low = 0.5_wp*(low + high)
      else
        high = 0.5_wp*(low + high)
      end if
    end do
    where (share > 0.0_wp) factor = low*factor

  contains

    !> Whether the step is stable for all automatic interfaces with the whole of these penalties
    !> (share 1), others as given.
    pure logical function fits(factor)
      real(wp), intent(in) :: factor(:)
      type(spring_bound_t) :: bounds(size(factor))

      call bound_whole(model, state, share, factor, bounds)
      fits = all(stable_step(steps(2), bounds) >= steps(1)*(1.0_wp - round_off) &
        .or. .not. share > 0.0_wp)
    end function fits

  end subroutine find_factors

  !> Bounds with the whole of these penalties (share 1) for automatic interfaces, others as given.
  pure subroutine bound_whole(model, state, share, factor, bounds)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: share(:), factor(:)
    type(spring_bound_t), intent(out) :: bounds(:)
    real(wp) :: scale(size(share))

    scale = 1.0_wp
    where (share > 0.0_wp) scale = factor/share
    call bound_springs(model%contacts, state%contact_mass, state%contacts, scale, bounds)
  end subroutine bound_whole

end module automatic_penalty_m
