! SPDX-License-Identifier: MIT
!> Penalties that the deck gives as a share of the largest one for which the step is stable (PUNIT
!> 3), by the bound of springs that stay closed and by that of springs that open and close. The step
!> is the one that the elements, and ties, alone would have (TSSFAC times the smallest L/c, or the
!> curve LCTM). Each such interface may take what that step leaves beside the elements; where
!> interfaces share nodes, all automatic ones are lowered by the same factor until their sum fits.
module automatic_penalty_m
  use contact_log_m, only : penalty_text
  use contact_step_limit_m, only : spring_bound_t, bound_springs, stable_step, closed_step, &
    binding_bound, fitting_scale
  use contacts_m, only : is_tied, penalty_share
  use controls_m, only : contact_step_free
  use element_dispatch_m, only : add_tile_forces
  use errors_m, only : error_t, raise, status_input
  use kinds_m, only : wp
  use log_m, only : log_t, write_log, to_text
  use mass_scaling_m, only : refine_limits
  use model_m, only : model_t
  use scaled_step_m, only : scaled_step
  use state_m, only : state_t
  implicit none
  private
  public :: set_automatic_penalties

  integer, parameter :: n_halving = 60           !! of the common factor
  real(wp), parameter :: round_off = 1.0e-12_wp  !! by which a bound may miss the step that it was
                                                 !! made for

contains

  !> Give every interface with PUNIT 3 its penalty and tell the log.
  subroutine set_automatic_penalties(model, state, log, error)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(log_t), intent(inout) :: log
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: factor(size(model%contacts)), limit, dt
    type(spring_bound_t) :: bounds(size(model%contacts))
    integer :: i

    if (all(model%contacts%penalty_unit /= penalty_share)) return
    call find_element_limits(model, state)
    limit = minval(state%elements%time_limit)
    dt = scaled_step(model, limit_with_ties(model, state, limit), state%time)
    if (.not. dt < limit) then
      call raise(error, 'an automatic penalty (PUNIT 3) finds no room: the time step ' &
        //to_text(dt)//' is not below the stable step of the elements '//to_text(limit) &
        //'; choose a smaller TSSFAC or LCTM', status_input)
      return
    end if
    call find_factors(model, state, dt, limit, factor)
    do i = 1, size(factor)
      if (model%contacts(i)%penalty_unit /= penalty_share) cycle
      if (.not. factor(i) > 0.0_wp) then
        call raise(error, 'interface '//to_text(model%contacts(i)%id)//': the penalties of other ' &
          //'interfaces at its nodes leave no room for an automatic one (PUNIT 3) at the time ' &
          //'step '//to_text(dt), status_input)
        return
      end if
    end do
    call bound_whole(model, state, factor, bounds)
    do i = 1, size(factor)
      if (model%contacts(i)%penalty_unit /= penalty_share) cycle
      associate (memory => state%contacts(i))
        memory%slave_penalty = factor(i)*memory%slave_penalty
        memory%master_penalty = factor(i)*memory%master_penalty
        memory%node_penalty = factor(i)*memory%node_penalty
        call write_log(log, 'interface '//to_text(model%contacts(i)%id)//': penalty ' &
          //penalty_text(model%contacts(i), model, memory)//', ' &
          //to_text(model%contacts(i)%penalty)//' of the largest for a time step of ' &
          //to_text(dt)//' by the bound of '//binding_bound(limit, bounds(i)))
      end associate
    end do
  end subroutine set_automatic_penalties

  !> The stable step of the elements, or what ties that lower it leave of it.
  pure function limit_with_ties(model, state, element_limit) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: element_limit !! s
    real(wp) :: limit
    type(spring_bound_t) :: bounds(size(model%contacts))

    limit = element_limit
    if (model%controls%contact_step == contact_step_free) return
    if (.not. any(is_tied(model%contacts))) return
    call bound_springs(model%contacts, state%contact_mass, state%contacts, &
      merge(1.0_wp, 0.0_wp, is_tied(model%contacts)), bounds)
    limit = minval(closed_step(element_limit, bounds))
  end function limit_with_ties

  !> One pass over the elements at rest, which leaves their stable steps behind.
  subroutine find_element_limits(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    real(wp), allocatable :: force(:, :)
    integer :: i

    allocate (force(2, model%layout%n_local))
    do i = 1, size(model%layout%tiles)
      call add_tile_forces(model, model%layout%tiles(i), state%motion, 0.0_wp, state%elements, &
        force)
      if (allocated(state%elements%mass_ratio) .or. allocated(state%elements%retardation)) &
        call refine_limits(model, model%layout%tiles(i), state%motion, 0.0_wp, state%elements)
    end do
  end subroutine find_element_limits

  !> Factors on the penalties in the memories, which hold shares: 0 where there is no
  !> room, 1 for given penalties.
  pure subroutine find_factors(model, state, dt, limit, factor)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: dt, limit   !! step, and stable step of the elements, s
    real(wp), intent(out) :: factor(:)
    type(spring_bound_t) :: bounds(size(factor))
    real(wp) :: alone(size(factor)), low, high
    integer :: i

    factor = 1.0_wp
    do i = 1, size(factor)
      if (model%contacts(i)%penalty_unit /= penalty_share) cycle
      alone = 0.0_wp
      alone(i) = 1.0_wp/model%contacts(i)%penalty
      call bound_springs(model%contacts, state%contact_mass, state%contacts, alone, bounds)
      factor(i) = fitting_scale(dt, limit, bounds(i))
    end do
    if (fits(model, state, dt, limit, factor)) return
    low = 0.0_wp
    high = 1.0_wp
    do i = 1, n_halving
      if (fits(model, state, dt, limit, 0.5_wp*(low + high)*factor)) then
        low = 0.5_wp*(low + high)
      else
        high = 0.5_wp*(low + high)
      end if
    end do
    where (model%contacts%penalty_unit == penalty_share) factor = low*factor
  end subroutine find_factors

  !> Bounds with the whole of these penalties (share 1) for automatic interfaces, others as given.
  pure subroutine bound_whole(model, state, factor, bounds)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: factor(:)
    type(spring_bound_t), intent(out) :: bounds(:)

    call bound_springs(model%contacts, state%contact_mass, state%contacts, &
      merge(factor/model%contacts%penalty, 1.0_wp, &
      model%contacts%penalty_unit == penalty_share), bounds)
  end subroutine bound_whole

  !> Whether the step is stable for all automatic interfaces with the whole of these penalties
  !> (share 1), others as given.
  pure function fits(model, state, dt, limit, factor)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: dt, limit, factor(:)
    logical :: fits
    type(spring_bound_t) :: bounds(size(factor))

    call bound_whole(model, state, factor, bounds)
    fits = all(stable_step(limit, bounds) >= dt*(1.0_wp - round_off) &
      .or. model%contacts%penalty_unit /= penalty_share)
  end function fits

end module automatic_penalty_m
