! SPDX-License-Identifier: MIT
!> Penalties given as a share of the largest stable one (PUNIT 3), by the bounds of springs that
!> stay closed and of springs that open and close. The step is that of elements and ties alone
!> (TSSFAC times the smallest L/c, or the curve LCTM). Interfaces that share nodes are reduced by a
!> common factor until their sum is stable. A default penalty (PUNIT 2) is limited in the same way
!> where a surface has soft and stiff materials: their mean stiffness would be unstable at nodes of
!> the soft one.
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

  integer, parameter :: n_halving = 60           !! bisections of the common factor
  real(wp), parameter :: round_off = 1.0e-12_wp  !! round-off of a bound against the step it was
                                                 !! made for
  real(wp), parameter :: much_stiffer = 10.0_wp  !! ratio of bulk moduli within one surface

contains

  !> Set the penalties of interfaces with PUNIT 3, and limit those of surfaces with soft and stiff
  !> materials.
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
    ! One pass over the undeformed elements gives their stable steps.
    allocate (force(2, model%layout%n_local))
    do i = 1, size(model%layout%tiles)
      associate (tile => model%layout%tiles(i))
        call add_tile_forces(model, tile, state%motion, 0.0_wp, state%elements, force)
        if (needs_refinement(state%elements)) &
          call refine_limits(model, tile, state%motion, 0.0_wp, state%elements)
      end associate
    end do
    limit = minval(state%elements%time_limit)
    ! Ties may reduce it.
    tied = limit
    if (model%controls%contact_step /= contact_step_free .and. any(is_tied(model%contacts))) then
      call bound_springs(model%contacts, state%contact_mass, state%contacts, &
        merge(1.0_wp, 0.0_wp, is_tied(model%contacts)), bounds)
      tied = minval(closed_step(limit, bounds))
    end if
    dt = scaled_step(model, tied, state%time)
    if (.not. dt < limit) then
      if (any(model%contacts%penalty_unit == penalty_share)) call raise(error, &
        'no automatic penalty (PUNIT 3) is stable: the time step ' &
        //to_text(dt)//' is not below the stable step of the elements '//to_text(limit) &
        //'; choose a smaller TSSFAC or LCTM', status_input)
      return
    end if
    call find_factors(model, state, [dt, limit], share, factor)
    do i = 1, size(factor)
      if (model%contacts(i)%penalty_unit /= penalty_share) cycle
      if (.not. factor(i) > 0.0_wp) then
        call raise(error, 'interface '//to_text(model%contacts(i)%id)//': no automatic penalty ' &
          //'(PUNIT 3) is stable beside the penalties of other interfaces at its nodes at the ' &
          //'time step '//to_text(dt), status_input)
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

  !> Report that the penalty of an interface was reduced: a warning where the user chose the
  !> penalty.
  subroutine report_lowered_penalty(model, i, dt, memory, log)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    real(wp), intent(in) :: dt !! s
    type(contact_state_t), intent(in) :: memory !! with the reduced penalty
    type(log_t), intent(inout) :: log
    character(:), allocatable :: text

    text = 'interface '//to_text(model%contacts(i)%id)//': one of its surfaces has soft ' &
      //'and stiff materials, and the default penalty is unstable at nodes of the soft one at ' &
      //'the time step '//to_text(dt)//'; it is reduced to ' &
      //penalty_text(model%contacts(i), model, memory)//'. Separate interfaces, or the ' &
      //'step of the springs (ECDT 2 of *CONTROL_CONTACT), reduce the penetration of stiff parts'
    if (has_default_penalty(model%contacts(i), model%controls)) then
      call write_log(log, text)
    else
      call warn(log, text)
    end if
  end subroutine report_lowered_penalty

  !> Share of the largest stable penalty sought for each interface: PEN with PUNIT 3; 1 as upper
  !> bound for surfaces with soft and stiff materials in an explicit run whose step does not follow
  !> the springs; 0 for fixed penalties.
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

  !> Factors on the present penalties: 0 where none is stable, 1 for fixed penalties.
  pure subroutine find_factors(model, state, steps, share, factor)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: steps(2) !! time step, and stable step of the elements, s
    real(wp), intent(in) :: share(:)
    real(wp), intent(out) :: factor(:)
    type(spring_bound_t) :: bounds(size(factor))
    real(wp) :: whole(size(factor)), low, high
    integer :: i

    whole = 0.0_wp
    where (share > 0.0_wp) whole = 1.0_wp/share
    ! Each interface alone.
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

    !> Whether the step is stable with the full penalties (share 1) of automatic interfaces and the
    !> fixed ones.
    pure logical function fits(factor)
      real(wp), intent(in) :: factor(:)
      type(spring_bound_t) :: bounds(size(factor))

      call bound_whole(model, state, share, factor, bounds)
      fits = all(stable_step(steps(2), bounds) >= steps(1)*(1.0_wp - round_off) &
        .or. .not. share > 0.0_wp)
    end function fits

  end subroutine find_factors

  !> Step bounds with the full penalties (share 1) of automatic interfaces and the fixed ones.
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
