! SPDX-License-Identifier: MIT
!> A tied interface: placed once, in the reference geometry; then one step is gather, hold, work.
module tied_interface_m
  use clock_m, only : clock_t, lap, phase_contact_search, phase_contact_force
  use closing_m, only : close_contacts
  use contact_dispatch_m, only : place_points
  use contact_penalty_m, only : mean_length
  use contact_springs_m, only : begin_look, measure_springs, end_look
  use contact_state_m, only : contact_state_t, allocate_tractions
  use contact_work_m, only : hand_over
  use contacts_m, only : contact_t
  use gather_m, only : gather_places, keep_former
  use kinds_m, only : wp
  use model_m, only : model_t
  use ties_m, only : freeze_ties, hold_ties
  implicit none
  private
  public :: start_ties, apply_ties, evaluate_ties, tie_reach

contains

  !> After the first search: place the points of all that lies within reach and freeze them.
  subroutine start_ties(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(inout) :: memory
    type(contact_t), allocatable :: present

    call allocate_tractions(memory%points)
    if (memory%facing%is_used) then
      call move_alloc(memory%facing%present, present)
      if (min(present%slave%n_segment, present%master%n_segment) > 0) call place(present)
      call move_alloc(present, memory%facing%present)
    else
      call place(contact)
    end if

  contains

    !> Between two surfaces, or runs of them.
    subroutine place(between)
      type(contact_t), intent(in) :: between
      real(wp) :: reach

      reach = tie_reach(contact, model)
      call close_contacts(between, reach, memory)
      call place_points(between, memory)
      memory%closed_gap = 0.0_wp
      call freeze_ties(between, reach, memory)
    end subroutine place

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
  subroutine apply_ties(motion, dt, cycle, clock, memory, force)
    real(wp), intent(in), contiguous :: motion(:, :)      !! (4, n_node) u(n), v(n-1/2)
    real(wp), intent(in) :: dt                            !! step that led to u, 0 at the start
    integer, intent(in) :: cycle
    type(clock_t), intent(inout) :: clock
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)    !! (2, at least the interface's nodes)
    logical :: had_force

    if (memory%points%n == 0) return
    had_force = memory%n_active > 0
    call gather_places(motion, memory)
    call lap(clock, phase_contact_search)
    call begin_look(had_force, memory%watch)
    if (had_force) call keep_former(memory)
    call hold_ties(memory)
    if (memory%watch%is_due .or. cycle == 0) call measure_springs(memory)
    if (cycle == 0) memory%energy = memory%watch%stored
    call hand_over(dt, motion, [0.0_wp, 0.0_wp], memory, force)
    call end_look(had_force, .true., memory%watch)
    call lap(clock, phase_contact_force)
  end subroutine apply_ties

  !> The same in a trial of an implicit step, where forces are a function of u alone.
  pure subroutine evaluate_ties(motion, memory, force)
    real(wp), intent(in), contiguous :: motion(:, :)
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)
    integer :: i

    memory%force = 0.0_wp
    memory%n_active = 0
    if (memory%points%n == 0) return
    call gather_places(motion, memory)
    call hold_ties(memory)
    do i = 1, size(memory%nodes)
      associate (node => memory%nodes(i))
        force(:, node) = force(:, node) + memory%force(:, i)
      end associate
    end do
  end subroutine evaluate_ties

end module tied_interface_m
