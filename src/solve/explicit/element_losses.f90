! SPDX-License-Identifier: MIT
!> Elements that leave the mesh: what they take along, and their nodes that nothing holds any more.
!> Points that fail: the log tells the first, then each tenfold of what was told, and all at the
!> end. One thread counts the chunks once a cycle, in models whose points may fail.
module element_losses_m
  use element_state_m, only : settle_erosion
  use failed_points_m, only : count_points, first_failed
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use node_motion_m, only : leap_t, find_factors
  use state_m, only : state_t
  use held_nodes_m, only : wall_work_ahead
  implicit none
  private
  public :: settle_elements, release_nodes, report_erosion, failure_watch_t, &
    follow_failures, report_failures

  !> What has been told.
  type :: failure_watch_t
    logical :: takes_up = .false.       !! the run goes on: what had failed before was told then
    integer :: told = 0                 !! points
    character(:), allocatable :: first  !! where and when the first one failed
  end type failure_watch_t

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
          if (allocated(state%former_velocity)) then
            before = state%former_velocity(:, node)
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
  subroutine follow_failures(model, state, watch, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(failure_watch_t), intent(inout) :: watch
    type(log_t), intent(inout) :: log
    integer :: n, slot

    n = sum(state%elements%n_failed)
    if (watch%takes_up) then
      watch%takes_up = .false.
      watch%told = n
      if (n > 0) watch%first = 'before the restart'
    else if (watch%told == 0 .and. n > 0) then
      watch%told = n
      if (log%is_mute) return ! the first process alone knows the elements of all
      slot = first_failed(model, state%elements)
      watch%first = 'in element '//to_text(model%mesh%element_id(model%layout%slot_element(slot))) &
        //' of part '//to_text(model%parts(slot_part(model%layout, slot))%id)//' at ' &
        //present_text(state)
      call write_log(log, 'points fail: the first '//watch%first)
    else if (watch%told > 0 .and. n/10 >= watch%told) then
      call write_log(log, 'points fail: '//to_text(n)//' of ' &
        //to_text(count_points(model, state%elements))//' by '//present_text(state))
      watch%told = n
    end if
  end subroutine follow_failures

  !> The summary.
  subroutine report_failures(model, state, watch, log)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(failure_watch_t), intent(in) :: watch
    type(log_t), intent(inout) :: log

    if (.not. allocated(state%elements%n_failed)) return
    if (allocated(watch%first)) then
      call write_log(log, 'failed points: '//to_text(sum(state%elements%n_failed))//' of ' &
        //to_text(count_points(model, state%elements))//', the first '//watch%first)
    else
      call write_log(log, 'failed points: none')
    end if
  end subroutine report_failures

  !> Cycle and time.
  pure function present_text(state) result(text)
    type(state_t), intent(in) :: state
    character(:), allocatable :: text

    text = 'cycle '//to_text(state%cycle)//', time '//to_text(state%time)
  end function present_text

end module element_losses_m
