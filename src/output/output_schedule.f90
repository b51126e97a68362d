! SPDX-License-Identifier: MIT
!> When an output is due: at time zero and at the cycle nearest to each multiple of its interval.
!> Multiples are formed as k times the interval, never by adding, so that nothing drifts. An
!> interval that varies (a curve of time) leads from each output time to the next.
module output_schedule_m
  use kinds_m, only : wp, long
  use controls_m, only : interval_t, controls_t
  use curves_m, only : curve_t, curve_value
  use visitor_m, only : visited_t, visitor_t, any_length
  implicit none
  private
  public :: schedule_t, start_schedule, is_due, mark_written, output_reach, &
    go_on_with

  !> A tie of two cycles round an output time goes to the first, although sums of steps carry
  !> rounding: this fraction of a step is forgiven.
  real(wp), parameter :: forgiven = 1.0e-6_wp
  !> Part of a step that a state may be early for an output time where steps can be cut.
  real(wp), parameter :: soon = 1.0e-6_wp
  !> Shortest interval as a fraction of the run, so that every count stays finite; a bound of these.
  real(wp), parameter :: shortest = 1.0e-9_wp
  integer(long), parameter :: most_outputs = 2_long**53

  !> The plan of one output.
  type, extends(visited_t) :: schedule_t
    logical :: active = .false.         !! false: never due
    real(wp) :: interval = 0.0_wp       !! constant interval, s; unused with a curve
    logical :: varies = .false.         !! the interval comes from the curve
    type(curve_t) :: curve              !! interval against time, s
    integer(long) :: count = 0          !! multiples that are done
    real(wp) :: next = 0.0_wp           !! next output time, s
    real(wp) :: end_time = 0.0_wp       !! no output time lies after it
  contains
    procedure :: visit => visit_schedule
  end type schedule_t

contains

  !> Plan the outputs of `interval` from time zero to `end_time`.
  pure subroutine start_schedule(schedule, interval, curves, end_time)
    type(schedule_t), intent(out) :: schedule
    type(interval_t), intent(in) :: interval
    type(curve_t), intent(in) :: curves(:)   !! the model's curves
    real(wp), intent(in) :: end_time         !! s

    schedule%end_time = end_time
    schedule%varies = interval%curve > 0
    if (schedule%varies) schedule%curve = curves(interval%curve)
    schedule%active = schedule%varies .or. interval%dt > 0.0_wp
    schedule%interval = max(interval%dt, shortest*end_time)
  end subroutine start_schedule

  !> The step by which the state nearest to an output time is found. A planned implicit step may be
  !> cut: then the state at or after an output time counts, not the nearest.
  pure function output_reach(controls, dt) result(reach)
    type(controls_t), intent(in) :: controls
    real(wp), intent(in) :: dt     !! step that leads away from the state, s
    real(wp) :: reach

    reach = dt
    if (controls%implicit%is_on .and. controls%implicit%is_automatic) reach = soon*dt
  end function output_reach

  !> Whether the state at `time` is the nearest to an output time that has not been written;
  !> `dt` is the step between states.
  pure function is_due(schedule, time, dt) result(due)
    type(schedule_t), intent(in) :: schedule
    real(wp), intent(in) :: time, dt   !! s
    logical :: due
    real(wp) :: step

    due = schedule%active
    step = min(dt, schedule%end_time)
    if (due) due = schedule%next <= schedule%end_time + forgiven*step .and. &
      schedule%next <= time + (0.5_wp + forgiven)*step
  end function is_due

  !> Move on to the first output time that a later state is nearest to. Several intervals that fell
  !> into one step are done together.
  pure subroutine mark_written(schedule, time, dt)
    type(schedule_t), intent(inout) :: schedule
    real(wp), intent(in) :: time, dt   !! s, as given to `is_due`

    ! A first state may lie far beyond the end.
    if (.not. schedule%varies .and. schedule%active) schedule%count = max(schedule%count, &
      int((min(time, schedule%end_time) + (0.5_wp + forgiven)*min(dt, schedule%end_time)) &
      /schedule%interval, long) - 1)
    do while (is_due(schedule, time, dt))
      call advance(schedule)
    end do
  end subroutine mark_written

  !> The output time after the present one. A curve that falls to zero ends the output.
  pure subroutine advance(schedule)
    type(schedule_t), intent(inout) :: schedule
    real(wp) :: interval

    schedule%count = schedule%count + 1
    if (.not. schedule%varies) then
      schedule%next = real(schedule%count, wp)*schedule%interval
      return
    end if
    interval = curve_value(schedule%curve, schedule%next)
    schedule%next = schedule%next + max(interval, shortest*schedule%end_time)
    if (interval <= 0.0_wp) schedule%active = .false.
  end subroutine advance

  !> Take up how far an output is. Where the run goes on with another interval, the first output
  !> comes at the next multiple of the new one. That of a curve may have come to its end.
  pure subroutine go_on_with(kept, time, dt, schedule)
    type(schedule_t), intent(in) :: kept            !! of the run before
    real(wp), intent(in) :: time, dt      !! of the state before, as given to `is_due` then
    type(schedule_t), intent(inout) :: schedule     !! planned from the deck
    logical :: same, follows

    same = kept%varies .eqv. schedule%varies
    follows = same .and. schedule%varies
    if (same .and. .not. follows) same = (kept%active .eqv. schedule%active) &
      .and. .not. abs(kept%interval - schedule%interval) > 0.0_wp
    if (follows) same = allocated(kept%curve%ordinate) .and. allocated(kept%curve%abscissa)
    if (follows .and. same) same = size(kept%curve%ordinate) == size(schedule%curve%ordinate) &
      .and. size(kept%curve%abscissa) == size(schedule%curve%abscissa)
    if (follows .and. same) same = &
      all(.not. abs(kept%curve%ordinate - schedule%curve%ordinate) > 0.0_wp) &
      .and. all(.not. abs(kept%curve%abscissa - schedule%curve%abscissa) > 0.0_wp)
    if (same) then
      schedule%active = kept%active
      schedule%count = kept%count
      schedule%next = kept%next
    else
      call mark_written(schedule, time, dt)
    end if
  end subroutine go_on_with

  !> Its components; the deck, which may change it, has the end.
  subroutine visit_schedule(self, visitor)
    class(schedule_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('active', self%active)
    call visitor%visit('interval', self%interval)
    call visitor%visit('varies', self%varies)
    call visitor%visit('curve_abscissa', self%curve%abscissa, any_length)
    call visitor%visit('curve_ordinate', self%curve%ordinate, any_length)
    call visitor%visit('count', self%count, most_outputs, 'a count that no run can reach')
    call visitor%visit('next', self%next, 0.0_wp, 'a time below zero')
  end subroutine visit_schedule

end module output_schedule_m
