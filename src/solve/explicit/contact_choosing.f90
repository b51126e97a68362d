! SPDX-License-Identifier: MIT
!> CTYPE 0 while the run goes on: interfaces are judged in every so many cycles, and one whose
!> estimate without waves has risen above its target takes, once it is open, the type that the
!> studies say keeps it. What is looked at and when depends on the deck alone, not on what is
!> written, so that the deck as run makes the same choices.
module contact_choosing_m
  use automatic_penalty_m, only : scale_penalties
  use clock_m, only : clock_t
  use contact_dispatch_m, only : formulation_t, formulation_of
  use contact_estimate_m, only : judged_each
  use contact_inertia_m, only : weigh_contacts
  use contact_state_m, only : contact_state_t
  use contact_step_limit_m, only : spring_bound_t, bound_springs, fitting_scale
  use contacts_m, only : contact_t, kind_text, penalty_share
  use interface_m, only : start_contact, apply_contact
  use kinds_m, only : wp
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use ranks_m, only : ranks_t, spread_values
  use share_text_m, only : percent
  use state_m, only : state_t
  use type_charts_m, only : may_change, better_type, published_share
  implicit none
  private
  public :: judges_at_all, is_judged, follow_choices

contains

  !> Whether a run judges interfaces for the choice of their type.
  pure function judges_at_all(model) result(judges)
    type(model_t), intent(in) :: model
    logical :: judges

    judges = any(may_change(model%contacts)) .and. .not. model%erodes
  end function judges_at_all

  !> Whether a cycle of such a run does.
  elemental function is_judged(cycle) result(judged)
    integer, intent(in) :: cycle
    logical :: judged

    judged = cycle > 0 .and. mod(cycle, judged_each) == 0
  end function is_judged

  !> Judge all interfaces by what the first process knows, and change types.
  subroutine follow_choices(model, ranks, element_limit, state, log)
    type(model_t), intent(inout) :: model
    type(ranks_t), intent(inout) :: ranks
    real(wp), intent(in) :: element_limit !! s
    type(state_t), intent(inout) :: state
    type(log_t), intent(inout) :: log
    real(wp) :: chosen(size(state%estimates))
    integer :: i, wanted

    chosen = 0.0_wp
    if (ranks%mine == 0) then
      do i = 1, size(chosen)
        wanted = wanted_type(model, state, i)
        call try_type(model, i, state, wanted)
        chosen(i) = wanted
      end do
    end if
    if (ranks%n > 1) call spread_values(ranks, chosen)
    do i = 1, size(chosen)
      if (chosen(i) > 0.0_wp) call change_type(model, i, nint(chosen(i)), element_limit, state, log)
    end do
  end subroutine follow_choices

  !> The type that an interface should have from here on; 0 where it keeps its own.
  pure function wanted_type(model, state, i) result(wanted)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: i
    integer :: wanted
    real(wp) :: estimate, expected

    wanted = 0
    associate (watched => state%estimates(i)%watched, contact => model%contacts(i))
      if (.not. may_change(contact) .or. state%contacts(i)%n_active > 0) return
      if (.not. watched(2) > 0.0_wp) return
      estimate = sqrt(watched(1)/watched(2))
      if (estimate <= contact%target) return
      call better_type(contact%scene, contact%contact_type, estimate, contact%target, wanted, &
        expected)
      ! Round-off may set the share of a type of itself below 1.
      if (wanted == contact%contact_type .or. .not. expected < estimate) wanted = 0
    end associate
  end function wanted_type

  !> Whether an interface may go on with the type that it wants. Each look costs a start of contact:
  !> where it was refused the next ones follow after twice the cycles each, until contact closes.
  subroutine try_type(model, i, state, wanted)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    type(state_t), intent(inout) :: state
    integer, intent(inout) :: wanted   !! 0: none; so it becomes where it is refused

    associate (n => state%estimates(i)%n_open)
      n = merge(n + 1, 0, wanted > 0)
      if (wanted == 0) return
      if (popcnt(n) > 1) then
        wanted = 0
      else if (.not. is_open_for(model, i, wanted, state)) then
        wanted = 0
      else
        n = 0
      end if
    end associate
  end subroutine try_type

  !> Whether an interface that is open is so for another type too: where that would find places
  !> behind a face at once, which the present type does not follow or has let go, their springs
  !> would make what they hold.
  function is_open_for(model, i, new_type, state) result(is_open)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i, new_type
    type(state_t), intent(in) :: state
    logical :: is_open
    type(contact_t) :: contact
    type(contact_state_t) :: memory
    type(log_t) :: silence
    type(clock_t) :: clock
    real(wp), allocatable :: force(:, :)

    contact = model%contacts(i)
    contact%contact_type = new_type
    silence%is_mute = .true.
    clock%is_on = .false.
    call start_contact(contact, model, silence, memory)
    memory%is_stale = .true.
    allocate (force(2, size(state%force_special, 2)), source=0.0_wp)
    call apply_contact(contact, state%motion, state%contact_mass, state%time, state%dt_before, &
      state%cycle, clock, memory, force)
    is_open = memory%n_active == 0
  end function is_open_for

  !> An open interface goes on with another type, if the present step bears its springs.
  subroutine change_type(model, i, new_type, element_limit, state, log)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: i, new_type
    real(wp), intent(in) :: element_limit !! s
    type(state_t), intent(inout) :: state
    type(log_t), intent(inout) :: log
    type(contact_t) :: contact
    type(contact_state_t) :: memory
    type(log_t) :: silence
    character(:), allocatable :: text
    real(wp) :: scale
    integer :: former

    former = model%contacts(i)%contact_type
    contact = model%contacts(i)
    contact%contact_type = new_type
    silence%is_mute = .true.
    call start_contact(contact, model, silence, memory)
    call take_account(contact%penalty_unit == penalty_share, state%contacts(i), memory)
    scale = bearable_scale(model%contacts, i, contact, memory, element_limit, state)
    associate (watched => state%estimates(i)%watched)
      text = 'interface '//to_text(contact%id)//', cycle '//to_text(state%cycle)//', time ' &
        //to_text(state%time)//': the estimate without waves, '//percent(sqrt(watched(1)), &
        sqrt(watched(2)))//' since '//name_of(model%contacts(i))//' was taken, is above ' &
        //percent(contact%target, 1.0_wp)
      watched = 0.0_wp
    end associate
    if (scale < merge(tiny(scale), 1.0_wp, contact%penalty_unit == penalty_share)) then
      associate (n => state%estimates(i)%n_stayed)
        if (n == 0) call write_log(log, text//'; it stays, the step does not bear the springs of ' &
          //name_of(contact)//' (told once)')
        n = n + 1
      end associate
      return
    end if
    if (scale < 1.0_wp) call scale_penalties(scale, memory)
    state%contacts(i) = memory
    state%estimates(i)%contact_type = new_type
    model%contacts(i)%contact_type = new_type
    call weigh_contacts(model, state)
    call write_log(log, text//'; contact is open and goes on with ' &
      //name_of(contact)//', whose published estimate is ' &
      //percent(published_share(contact%scene, former, new_type), 1.0_wp)//' of that')
  end subroutine change_type

  !> The type of an interface, for the log.
  pure function name_of(contact) result(name)
    type(contact_t), intent(in) :: contact
    character(:), allocatable :: name
    type(formulation_t) :: formulation

    formulation = formulation_of(contact)
    name = kind_text(formulation%kind)
  end function name_of

  !> The part of its penalty that the present step bears if interface `i` becomes `contact`, beside
  !> the springs of others on its nodes: 1 for all of it, 0 where they leave no room.
  function bearable_scale(contacts, i, contact, memory, element_limit, state) result(scale)
    type(contact_t), intent(in) :: contacts(:)
    integer, intent(in) :: i
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: element_limit !! s
    type(state_t), intent(in) :: state
    real(wp), parameter :: round_off = 1.0e-9_wp
    real(wp) :: scale, scales(size(contacts))
    type(contact_t) :: all(size(contacts))
    type(contact_state_t) :: memories(size(contacts))
    type(spring_bound_t) :: bounds(size(contacts))

    all = contacts
    all(i) = contact
    memories = state%contacts
    memories(i) = memory
    scales = 1.0_wp
    call bound_springs(all, state%contact_mass, memories, scales, bounds)
    scale = min(fitting_scale(state%dt, element_limit, bounds(i)), 1.0_wp)
    if (.not. scale < 1.0_wp) return
    scales(i) = scale
    call bound_springs(all, state%contact_mass, memories, scales, bounds)
    if (fitting_scale(state%dt, element_limit, bounds(i)) < 1.0_wp - round_off) scale = 0.0_wp
  end function bearable_scale

  !> What an interface has done so far stays in its account, and the penalty that the program gave.
  pure subroutine take_account(is_automatic, before, memory)
    logical, intent(in) :: is_automatic
    type(contact_state_t), intent(in) :: before
    type(contact_state_t), intent(inout) :: memory

    memory%is_stale = .true.
    memory%energy = before%energy
    memory%damping_work = before%damping_work
    memory%watch = before%watch
    memory%limit = before%limit
    memory%n_released = before%n_released
    memory%rules_step = before%rules_step
    if (.not. is_automatic) return
    memory%slave_penalty = before%slave_penalty
    memory%master_penalty = before%master_penalty
    memory%node_penalty = before%node_penalty
  end subroutine take_account

end module contact_choosing_m
