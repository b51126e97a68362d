! SPDX-License-Identifier: MIT
!> Elements that leave the mesh: what they take along, their nodes that nothing holds any more, and
!> surfaces of interfaces, which follow them. Points that fail: the log tells the first, then each
!> tenfold of what was told, and all at the end. One thread counts the chunks once a cycle, in
!> models whose points may fail.
module element_losses_m
  use block_state_m, only : stays
  use contact_memory_m, only : prepare_contact, renew_contact, close_contact
  use contacts_m, only : contact_t
  use element_state_m, only : settle_erosion, count_points, first_failed
  use exposed_quads_m, only : find_exposed
  use held_nodes_m, only : wall_work_ahead
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use node_motion_m, only : leap_t, find_factors
  use start_m, only : weigh_contacts
  use state_m, only : state_t
  use surface_building_m, only : remaining_surface
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: settle_elements, release_nodes, report_erosion, failure_log_t, follow_failures, &
    report_failures, follow_outlines, resume_outlines

  !> What has been told.
  type :: failure_log_t
    logical :: is_restart = .false.     !! the run goes on: what had failed before was told then
    integer :: n_reported = 0           !! points
    character(:), allocatable :: first  !! where and when the first one failed
  end type failure_log_t

contains

  !> Elements that have left in this cycle, once all of its forces are known.
  subroutine settle_elements(model, state, log, freed)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(log_t), intent(inout) :: log
    integer, allocatable, intent(out) :: freed(:)
    logical :: is_first

    is_first = sum(state%elements%erosion%n_eroded) == 0
    call settle_erosion(model, state%time, state%elements%erosion, freed)
    if (is_first .and. allocated(freed)) call write_log(log, 'the first elements ('// &
      to_text(sum(state%elements%erosion%n_eroded))//') leave the mesh at cycle ' &
      //to_text(state%cycle)//', time '//to_text(state%time))
  end subroutine settle_elements

  !> Nodes without an element stop where they are, after the motion of the cycle: their kinetic
  !> energy, v(n-1/2).m v(n+1/2)/2, leaves the account, and their mass moves nothing any more. No
  !> element has pushed them in this cycle; contact has, and does no work on them any more. Walls
  !> and prescribed motion have done theirs over the half step ahead, too.
  subroutine release_nodes(model, leap, freed, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap     !! of this cycle
    integer, intent(in) :: freed(:)
    type(state_t), intent(inout) :: state
    real(wp) :: before(2), after(2), half(2), keep(2), push(2)
    logical :: is_led(2)
    integer :: i, k

    associate (took => state%elements%erosion%took)
      do i = 1, size(freed)
        associate (node => freed(i), mass => state%mass(freed(i)))
          after = state%motion(3:4, node)
          call find_factors(leap, state, node, half, keep)
          is_led = .not. state%inverse_mass(:, node) > 0.0_wp
          push = merge(leap%body, 0.0_wp, state%inverse_mass(:, node) > 0.0_wp)
          if (node <= model%layout%n_special) push = push + state%inverse_mass(:, node) &
            *state%force_special(:, node)
          before = after - half*push
          if (allocated(state%previous_velocity)) then
            before = state%previous_velocity(:, node)
            state%damping_work = state%damping_work + 0.5_wp*mass*sum((1.0_wp/half - 1.0_wp &
              /leap%mean)*(before + after)*(state%dt_before*before + merge(state%dt*after, &
              0.0_wp, is_led)))
            before = merge(after, before, is_led)
          end if
          ! What leads a node has paid for the half step ahead.
          state%external_work = state%external_work + 0.5_wp*state%dt*mass*sum(merge(leap%body &
            *after, 0.0_wp, is_led))
          took(1) = took(1) + 0.5_wp*mass*sum(before*after)
          if (allocated(state%walls)) took(1) = took(1) + wall_work_ahead(model, node, state)
          state%mass(node) = 0.0_wp
          state%inverse_mass(:, node) = 0.0_wp
          state%motion(3:4, node) = merge(after, 0.0_wp, is_led)
        end associate
      end do
    end associate
    if (.not. allocated(model%conditions%common_motions)) return
    ! Nodes that move alike and have no mass left stand still from here on: the half step ahead for
    ! which their loads would have paid is not theirs any more.
    do i = 1, size(model%conditions%common_motions)
      associate (set => model%conditions%common_motions(i), took => state%elements%erosion%took(1))
        if (any(state%mass(set%nodes) > 0.0_wp)) cycle
        do k = 1, 2
          if (.not. set%along(k)) cycle
          took = took - 0.5_wp*state%dt*state%motion(2 + k, set%nodes(1)) &
            *sum(state%force_special(k, set%nodes))
          state%motion(2 + k, set%nodes) = 0.0_wp
        end do
      end associate
    end do
  end subroutine release_nodes

  !> At the end of a run: how many elements have left, when first, and what they took along.
  subroutine report_erosion(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    integer :: i

    associate (erosion => state%elements%erosion)
      if (sum(erosion%n_eroded) == 0) then
        call write_log(log, 'no element has left the mesh')
        return
      end if
      call write_log(log, to_text(sum(erosion%n_eroded))//' elements have left the mesh, the ' &
        //'first at time '//to_text(erosion%first_time)//'; energies that went with them: ' &
        //'kinetic '//to_text(erosion%took(1))//', internal '//to_text(erosion%took(2)) &
        //', hourglass '//to_text(erosion%took(3))//', contact springs '//to_text(erosion%took(4)))
      do i = 1, size(erosion%n_eroded)
        if (erosion%n_eroded(i) > 0) call write_log(log, '  part '//to_text(model%parts(i)%id) &
          //': '//to_text(erosion%n_eroded(i)))
      end do
    end associate
  end subroutine report_erosion

  !> Look at the cycle just done.
  subroutine follow_failures(model, state, failures, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(failure_log_t), intent(inout) :: failures
    type(log_t), intent(inout) :: log
    integer :: n, slot

    n = sum(state%elements%n_failed)
    if (failures%is_restart) then
      failures%is_restart = .false.
      failures%n_reported = n
      if (n > 0) failures%first = 'before the restart'
    else if (failures%n_reported == 0 .and. n > 0) then
      failures%n_reported = n
      if (log%is_silent) return ! the first process alone knows the elements of all
      slot = first_failed(model, state%elements)
      associate (element => model%layout%slot_element(slot), &
        part => slot_part(model%layout, slot))
        failures%first = 'in element '//to_text(model%mesh%element_id(element))//' of part ' &
          //to_text(model%parts(part)%id)//' at cycle '//to_text(state%cycle)//', time ' &
          //to_text(state%time)
      end associate
      call write_log(log, 'points fail: the first '//failures%first)
    else if (failures%n_reported > 0 .and. n/10 >= failures%n_reported) then
      call write_log(log, 'points fail: '//to_text(n)//' of ' &
        //to_text(count_points(model, state%elements))//' by cycle '//to_text(state%cycle) &
        //', time '//to_text(state%time))
      failures%n_reported = n
    end if
  end subroutine follow_failures

  !> The summary.
  subroutine report_failures(model, state, failures, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(failure_log_t), intent(in) :: failures
    type(log_t), intent(inout) :: log

    if (.not. allocated(state%elements%n_failed)) return
    if (allocated(failures%first)) then
      call write_log(log, 'failed points: '//to_text(sum(state%elements%n_failed))//' of ' &
        //to_text(count_points(model, state%elements))//', the first '//failures%first)
    else
      call write_log(log, 'failed points: none')
    end if
  end subroutine report_failures

  !> After elements have left: interfaces whose surfaces have lost some, or came to light, go on
  !> with what is left, in the order of the deck. Their springs that are not there any more are
  !> booked as eroded.
  subroutine follow_outlines(model, has_lost, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: has_lost(:) !! (n_part) elements in this cycle
    type(state_t), intent(inout) :: state
    type(contact_t), allocatable :: previous
    logical, allocatable :: is_left(:)
    real(wp) :: lost
    integer :: i

    is_left = state%elements%erosion%status(model%layout%element_slot) == stays
    call expose_elements(model, is_left, state)
    do i = 1, size(state%outlines)
      if (.not. (loses(state%outlines(i)%slave) .or. loses(state%outlines(i)%master))) cycle
      previous = state%outlines(i)
      ! What is no node of the interface any more feels no force of it.
      state%force_special(:, state%contacts(i)%nodes) = 0.0_wp
      call set_remaining_surfaces(model, i, is_left, state%outlines(i))
      if (state%outlines(i)%birth >= huge(1.0_wp)) then
        call close_contact(state%outlines(i), model, state%motion, state%dt, state%contacts(i), &
          lost)
      else
        call renew_contact(previous, state%outlines(i), model, state%motion, state%contacts(i), &
          lost)
      end if
      state%elements%erosion%took(4) = state%elements%erosion%took(4) + lost
    end do
    call weigh_contacts(model, state)

  contains

    !> Whether a surface is another one now.
    function loses(surface)
      type(surface_t), intent(in) :: surface
      logical :: loses

      if (allocated(surface%parts)) then
        loses = any(has_lost(surface%parts))
      else
        loses = .not. all(is_left(surface%segment_element))
      end if
    end function loses

  end subroutine follow_outlines

  !> Quads whose neighbours have left.
  subroutine expose_elements(model, is_left, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_left(:)  !! (n_element)
    type(state_t), intent(inout) :: state
    real(wp), allocatable :: shares(:, :)

    shares = find_exposed(model, is_left)
    if (.not. allocated(state%elements%mass_shares)) then
      if (.not. any(shares > 0.0_wp)) return
      allocate (state%elements%mass_shares(4, model%layout%n_slot))
    end if
    state%elements%mass_shares = 0.0_wp
    state%elements%mass_shares(:, model%layout%element_slot) = shares
  end subroutine expose_elements

  !> The interface that is left of one of the deck; that of the deck, never born, where a side has
  !> nothing left.
  subroutine set_remaining_surfaces(model, i, is_left, contact)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    logical, intent(in) :: is_left(:)
    type(contact_t), intent(inout) :: contact
    type(surface_t) :: slave, master

    call remaining_surface(model%mesh, is_left, model%contacts(i)%slave, slave)
    call remaining_surface(model%mesh, is_left, model%contacts(i)%master, master)
    if (min(slave%n_segment, master%n_segment) > 0) then
      contact%slave = slave
      contact%master = master
    else
      contact%slave = model%contacts(i)%slave
      contact%master = model%contacts(i)%master
      contact%birth = huge(1.0_wp)
    end if
  end subroutine set_remaining_surfaces

  !> Before a state is read in which elements have left: interfaces get the shapes that they had.
  subroutine resume_outlines(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, allocatable :: is_left(:)
    integer :: i

    is_left = state%elements%erosion%status(model%layout%element_slot) == stays
    if (all(is_left)) return
    call expose_elements(model, is_left, state)
    do i = 1, size(state%outlines)
      call set_remaining_surfaces(model, i, is_left, state%outlines(i))
      call prepare_contact(state%outlines(i), model, state%contacts(i))
    end do
  end subroutine resume_outlines

end module element_losses_m
