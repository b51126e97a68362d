! SPDX-License-Identifier: MIT
!> Erosion in the explicit cycle: eroded energies, nodes without elements, and surfaces of
!> interfaces after erosion. Failed integration points: the log reports the first, then each tenfold
!> number, and the total at the end. One thread counts the chunks once a cycle in models whose
!> points may fail.
module element_erosion_m
  use block_state_m, only : intact
  use contact_memory_m, only : prepare_contact, renew_contact, close_contact
  use contacts_m, only : contact_t
  use element_state_m, only : update_erosion, count_points, first_failed
  use exposed_quads_m, only : find_exposed
  use node_constraints_m, only : wall_work_ahead
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use node_motion_m, only : leap_t, motion_factors
  use start_m, only : set_contact_masses
  use state_m, only : state_t
  use surface_building_m, only : remaining_surface
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: finish_erosion, release_free_nodes, report_erosion, failure_log_t, update_failures, &
    report_failures, update_interfaces, restore_interfaces

  !> Failures that have been reported.
  type :: failure_log_t
    logical :: is_restart = .false.     !! in a restart: failures of the run before have been
                                        !! reported
    integer :: n_reported = 0           !! failed points
    character(:), allocatable :: first  !! place and time of the first failure
  end type failure_log_t

contains

  !> Finish the erosion of this cycle, once all its forces are known.
  subroutine finish_erosion(model, state, log, freed)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    type(log_t), intent(inout) :: log
    integer, allocatable, intent(out) :: freed(:) !! nodes without an element; not allocated without
                                                  !! erosion in this cycle
    logical :: is_first

    is_first = sum(state%elements%erosion%n_eroded) == 0
    call update_erosion(model, state%time, state%elements%erosion, freed)
    if (is_first .and. allocated(freed)) call write_log(log, 'first erosion at cycle ' &
      //to_text(state%cycle)//', time '//to_text(state%time)//', elements: ' &
      //to_text(sum(state%elements%erosion%n_eroded)))
  end subroutine finish_erosion

  !> Stop nodes without an element after the motion of the cycle. Their kinetic energy v(n-1/2).m
  !> v(n+1/2)/2 becomes eroded energy, and their mass no longer counts. Work of walls and prescribed
  !> motion over the half step after t(n) is included.
  subroutine release_free_nodes(model, leap, freed, state)
    type(model_t), intent(in) :: model
    type(leap_t), intent(in) :: leap     !! of this cycle
    integer, intent(in) :: freed(:)
    type(state_t), intent(inout) :: state
    real(wp) :: before(2), after(2), half(2), keep(2), push(2)
    logical :: is_led(2)
    integer :: i, k

    associate (removed_energy => state%elements%erosion%removed_energy)
      do i = 1, size(freed)
        associate (node => freed(i), mass => state%mass(freed(i)))
          after = state%motion(3:4, node)
          call motion_factors(leap, state, node, half, keep)
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
          ! Prescribed motion has done its work over the half step ahead.
          state%external_work = state%external_work + 0.5_wp*state%dt*mass*sum(merge(leap%body &
            *after, 0.0_wp, is_led))
          removed_energy(1) = removed_energy(1) + 0.5_wp*mass*sum(before*after)
          if (allocated(state%walls)) removed_energy(1) = removed_energy(1) + &
            wall_work_ahead(model, node, state)
          state%mass(node) = 0.0_wp
          state%inverse_mass(:, node) = 0.0_wp
          state%motion(3:4, node) = merge(after, 0.0_wp, is_led)
        end associate
      end do
    end associate
    if (.not. allocated(model%conditions%common_motions)) return
    ! A set of coupled nodes without mass stops; the work of its loads over the half step ahead is
    ! taken back.
    do i = 1, size(model%conditions%common_motions)
      associate (set => model%conditions%common_motions(i), &
        removed_energy => state%elements%erosion%removed_energy(1))
        if (any(state%mass(set%nodes) > 0.0_wp)) cycle
        do k = 1, 2
          if (.not. set%along(k)) cycle
          removed_energy = removed_energy - 0.5_wp*state%dt*state%motion(2 + k, set%nodes(1)) &
            *sum(state%force_special(k, set%nodes))
          state%motion(2 + k, set%nodes) = 0.0_wp
        end do
      end associate
    end do
  end subroutine release_free_nodes

  !> Report at the end of a run the number of eroded elements by part, the time of the first erosion
  !> and the eroded energies.
  subroutine report_erosion(model, state, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(log_t), intent(inout) :: log
    integer :: i

    associate (erosion => state%elements%erosion)
      if (sum(erosion%n_eroded) == 0) then
        call write_log(log, 'no element has eroded')
        return
      end if
      associate (energy => erosion%removed_energy)
        call write_log(log, 'eroded elements: '//to_text(sum(erosion%n_eroded))//', the first at ' &
          //'time '//to_text(erosion%first_time)//'; eroded energy: kinetic ' &
          //to_text(energy(1))//', internal '//to_text(energy(2))//', hourglass ' &
          //to_text(energy(3))//', contact springs '//to_text(energy(4)))
      end associate
      do i = 1, size(erosion%n_eroded)
        if (erosion%n_eroded(i) > 0) call write_log(log, '  part '//to_text(model%parts(i)%id) &
          //': '//to_text(erosion%n_eroded(i)))
      end do
    end associate
  end subroutine report_erosion

  !> Update the count of failed points and report the first and each tenfold number.
  subroutine update_failures(model, state, failures, log)
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
      call write_log(log, 'first failed point '//failures%first)
    else if (failures%n_reported > 0 .and. n/10 >= failures%n_reported) then
      call write_log(log, 'failed points: '//to_text(n)//' of ' &
        //to_text(count_points(model, state%elements))//' by cycle '//to_text(state%cycle) &
        //', time '//to_text(state%time))
      failures%n_reported = n
    end if
  end subroutine update_failures

  !> Report the number of failed points at the end of a run.
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

  !> Update interfaces whose surfaces lost elements or were newly exposed, in the order of the deck.
  !> Energy of the springs that were removed becomes eroded energy.
  subroutine update_interfaces(model, has_eroded, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: has_eroded(:) !! (n_part) the part lost elements in this cycle
    type(state_t), intent(inout) :: state
    type(contact_t), allocatable :: previous
    logical, allocatable :: is_left(:)
    real(wp) :: lost
    integer :: i

    is_left = state%elements%erosion%status(model%layout%element_slot) == intact
    call update_exposed_quads(model, is_left, state)
    do i = 1, size(state%interfaces)
      if (.not. (loses(state%interfaces(i)%slave) .or. loses(state%interfaces(i)%master))) cycle
      previous = state%interfaces(i)
      ! Nodes that leave the interface have no contact force.
      state%force_special(:, state%contacts(i)%nodes) = 0.0_wp
      call set_remaining_surfaces(model, i, is_left, state%interfaces(i))
      if (state%interfaces(i)%birth >= huge(1.0_wp)) then
        call close_contact(state%interfaces(i), model, state%motion, state%dt, state%contacts(i), &
          lost)
      else
        call renew_contact(previous, state%interfaces(i), model, state%motion, state%contacts(i), &
          lost)
      end if
      state%elements%erosion%removed_energy(4) = state%elements%erosion%removed_energy(4) + lost
    end do
    call set_contact_masses(model, state)

  contains

    !> Whether a surface has changed.
    function loses(surface)
      type(surface_t), intent(in) :: surface
      logical :: loses

      if (allocated(surface%parts)) then
        loses = any(has_eroded(surface%parts))
      else
        loses = .not. all(is_left(surface%segment_element))
      end if
    end function loses

  end subroutine update_interfaces

  !> Update the mass shares of quads whose neighbours have eroded.
  subroutine update_exposed_quads(model, is_left, state)
    type(model_t), intent(in) :: model
    logical, intent(in) :: is_left(:)  !! (n_element) not eroded
    type(state_t), intent(inout) :: state
    real(wp), allocatable :: shares(:, :)

    shares = find_exposed(model, is_left)
    if (.not. allocated(state%elements%mass_shares)) then
      if (.not. any(shares > 0.0_wp)) return
      allocate (state%elements%mass_shares(4, model%layout%n_slot))
    end if
    state%elements%mass_shares = 0.0_wp
    state%elements%mass_shares(:, model%layout%element_slot) = shares
  end subroutine update_exposed_quads

  !> Set the surfaces of an interface without eroded elements. Where a side has no segment left, the
  !> surfaces of the deck and an infinite birth time.
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

  !> Restore the surfaces of interfaces before a state with eroded elements is read.
  subroutine restore_interfaces(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: state
    logical, allocatable :: is_left(:)
    integer :: i

    is_left = state%elements%erosion%status(model%layout%element_slot) == intact
    if (all(is_left)) return
    call update_exposed_quads(model, is_left, state)
    do i = 1, size(state%interfaces)
      call set_remaining_surfaces(model, i, is_left, state%interfaces(i))
      call prepare_contact(state%interfaces(i), model, state%contacts(i))
    end do
  end subroutine restore_interfaces

end module element_erosion_m
