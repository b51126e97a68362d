! SPDX-License-Identifier: MIT
!> Tells the log of points that fail: the first, then each tenfold of what was told, and all at the
!> end. One thread counts the chunks once a cycle, in models whose points may fail.
module failure_watch_m
  use failed_points_m, only : count_points, first_failed
  use layout_m, only : slot_part
  use log_m, only : log_t, write_log, to_text
  use model_m, only : model_t
  use state_m, only : state_t
  implicit none
  private
  public :: failure_watch_t, start_watch, follow_failures, report_failures

  !> What has been told.
  type :: failure_watch_t
    logical :: takes_up = .false.       !! the run goes on: what had failed before was told then
    integer :: told = 0                 !! points
    character(:), allocatable :: first  !! where and when the first one failed
  end type failure_watch_t

contains

  !> Nothing has been told yet.
  pure subroutine start_watch(goes_on, watch)
    logical, intent(in) :: goes_on !! from a restart file
    type(failure_watch_t), intent(out) :: watch

    watch%takes_up = goes_on
  end subroutine start_watch

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

end module failure_watch_m
