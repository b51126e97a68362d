! SPDX-License-Identifier: MIT
!> A tied interface: placed once, in the reference geometry; then one step is gather, hold, work.
module tied_interface_m
  use clock_m, only : clock_t, lap, phase_contact_search, phase_contact_force
  use contact_dispatch_m, only : place_points, formulation_t, formulation_of
  use contact_penalty_m, only : mean_length
  use contact_springs_m, only : begin_look, measure_springs, end_look
  use contact_state_m, only : contact_state_t, allocate_tractions
  use contact_work_m, only : apart_t, hand_over
  use contacts_m, only : contact_t, breaks
  use law_state_m, only : is_held
  use gather_m, only : gather_places, keep_former
  use kinds_m, only : wp
  use model_m, only : model_t
  use tiebreak_m, only : start_breaking
  use ties_m, only : freeze_ties, hold_ties, break_ties
  implicit none
  private
  public :: start_ties, apply_ties, evaluate_ties, break_at_end, tie_reach

contains

  !> After the first search, which takes gaps within reach as closed: generate the contact points
  !> and freeze them.
  subroutine start_ties(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(formulation_t) :: formulation
    real(wp) :: reach

    call allocate_tractions(memory%points)
    formulation = formulation_of(contact)
    reach = tie_reach(contact, model)
    call place_points(contact, memory)
    memory%closed_gap = 0.0_wp
    call freeze_ties(contact, reach, memory)
    if (breaks(contact)) call start_breaking(contact, formulation%has_unit_area, &
      formulation%has_two_passes, memory)
  end subroutine start_ties

  !> How far apart places may lie that are tied, m.
  pure function tie_reach(contact, model) result(reach)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp) :: reach

    reach = contact%tie_reach
    if (.not. abs(reach) > 0.0_wp) reach = -1.0_wp
    if (reach < 0.0_wp) reach = -0.01_wp*reach*mean_length(contact%master, model)
  end function tie_reach

  !> Forces of the ties at the present u, added to `force`, and their work since the previous call.
  subroutine apply_ties(contact, motion, times, cycle, clock, memory, force)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in), contiguous :: motion(:, :)      !! (4, n_node) u(n), v(n-1/2)
    real(wp), intent(in) :: times(2)                      !! of u, and the step that led to it, 0 at
                                                          !! the start, s
    integer, intent(in) :: cycle
    type(clock_t), intent(inout) :: clock
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)    !! (2, at least the interface's nodes)
    logical :: had_force

    if (memory%points%n == 0) return
    had_force = memory%n_active > 0
    call gather_places(motion, memory)
    if (has_broken(memory) .and. .not. had_force) then
      memory%watch%has_looked = .false.
      return
    end if
    call lap(clock, phase_contact_search)
    call begin_look(had_force, memory%watch)
    if (had_force) call keep_former(memory)
    call hold_ties(memory, contact%strength, times(1))
    ! When the last of them breaks there is no later look.
    if (memory%watch%is_due .or. cycle == 0 .or. memory%n_active == 0) call measure_springs(memory)
    if (cycle == 0) memory%energy = memory%watch%stored
    call hand_over(times(2), motion, apart_t(), memory, force)
    call end_look(had_force, .true., memory%watch)
    call lap(clock, phase_contact_force)
  end subroutine apply_ties

  !> Whether all of a tie has broken.
  pure function has_broken(memory)
    type(contact_state_t), intent(in) :: memory
    logical :: has_broken

    has_broken = .false.
    if (memory%has%breaks) has_broken = .not. any(memory%ties%state == is_held)
  end function has_broken

  !> The same in a trial of an implicit step, where forces are a function of u alone: what breaks
  !> does so at the end of a step (break_at_end).
  pure subroutine evaluate_ties(motion, memory, force)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)
    integer :: i

    memory%force = 0.0_wp
    memory%n_active = 0
    if (memory%points%n == 0) return
    call gather_places(motion, memory)
    call hold_ties(memory, [0.0_wp, 0.0_wp], 0.0_wp)
    do i = 1, size(memory%nodes)
      associate (node => memory%nodes(i))
        force(:, node) = force(:, node) + memory%force(:, i)
      end associate
    end do
  end subroutine evaluate_ties

  !> Break what reaches its strength in equilibrium.
  pure subroutine break_at_end(contact, time, memory, n_new)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: time
    type(contact_state_t), intent(inout) :: memory
    integer, intent(out) :: n_new !! places that have broken

    n_new = 0
    if (breaks(contact) .and. memory%points%n > 0) &
      call break_ties(contact%strength, time, memory, n_new)
  end subroutine break_at_end

end module tied_interface_m
