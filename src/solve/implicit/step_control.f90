! SPDX-License-Identifier: MIT
!> Lengths of implicit steps: constant, or growing and shrinking with the iterations that they take.
!> Where the equations change (birth or death of a prescribed motion) a step is divided.
module step_control_m
  use kinds_m, only : wp
  use controls_m, only : controls_t
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: step_control_t, start_step_control, plan_step, grow_step, cut_step, round_off

  !> What a step that took few iterations grows by, and what one that failed shrinks to.
  real(wp), parameter :: growth = 1.5_wp, cut = 0.5_wp
  !> Part of a step that is not left over before a time at which a step must end.
  real(wp), parameter :: least_rest = 0.25_wp
  !> Part of a step by which a time may be missed.
  real(wp), parameter :: round_off = 1.0e-9_wp

  !> Step lengths of a run.
  type, extends(visited_t) :: step_control_t
    real(wp) :: dt = 0.0_wp        !! of a whole step, s
    real(wp) :: target = 0.0_wp    !! where the present whole step ends
    real(wp) :: next = 0.0_wp      !! where the next step ends: there, or where the equations change
    real(wp) :: end_time = 0.0_wp
    logical :: is_last = .false.   !! the next step ends the run
    logical :: is_automatic = .false.
    real(wp) :: least = 0.0_wp     !! shortest step
    real(wp) :: most = 0.0_wp      !! longest step
    integer :: few = 0             !! iterations below which the step grows
    integer :: many = 0            !! iterations above which it shrinks
    real(wp), allocatable :: changes(:) !! when the equations change
  contains
    procedure :: visit => visit_control
  end type step_control_t

contains

  !> As the deck asks; the first step is brought between the shortest and the longest.
  pure function start_step_control(controls, changes) result(control)
    type(controls_t), intent(in) :: controls
    real(wp), intent(in) :: changes(:) !! times at which the equations change, in any order
    type(step_control_t) :: control

    control%changes = changes
    associate (implicit => controls%implicit)
      control%dt = implicit%dt
      control%end_time = controls%end_time
      control%is_automatic = implicit%is_automatic
      control%least = implicit%dt_least
      if (.not. control%least > 0.0_wp) control%least = 1.0e-3_wp*implicit%dt
      control%most = implicit%dt_most
      if (.not. control%most > 0.0_wp) control%most = 10.0_wp*implicit%dt
      control%most = max(control%most, control%least)
      if (control%is_automatic) control%dt = min(max(control%dt, control%least), control%most)
      control%few = implicit%best_iterations - implicit%iteration_window
      ! A step that took all iterations it may take was a hard one too.
      control%many = max(control%few, min(implicit%best_iterations + implicit%iteration_window, &
        implicit%max_iteration - 1))
    end associate
  end function start_step_control

  !> End of the next step. The last step is stretched or shortened to end the run in time. Of
  !> constant steps what a change leaves over follows as a step of its own, of automatic ones a
  !> whole step; a step that would leave a small rest before a change goes half of the way.
  pure subroutine plan_step(control, time)
    type(step_control_t), intent(inout) :: control
    real(wp), intent(in) :: time !! start of the step
    real(wp) :: change

    associate (missed => round_off*control%dt)
      if (time >= control%target - missed) then
        control%target = time + control%dt
        if (control%target >= control%end_time - missed) control%target = control%end_time
      end if
      control%next = control%target
      change = minval(control%changes, mask=control%changes > time + missed)
      if (change < control%target - missed) then
        control%next = change
      else if (control%is_automatic .and. change > control%target + missed .and. &
        change < control%target + least_rest*control%dt) then
        control%next = time + 0.5_wp*(change - time)
      end if
      if (control%is_automatic) control%target = control%next
      control%is_last = control%next >= control%end_time
    end associate
  end subroutine plan_step

  !> After a step of length `dt` that converged. Few iterations of a shortened step
  !> say nothing of a whole one.
  pure subroutine grow_step(control, dt, iterations)
    type(step_control_t), intent(inout) :: control
    real(wp), intent(in) :: dt
    integer, intent(in) :: iterations

    if (.not. control%is_automatic) return
    if (iterations <= control%few .and. dt >= (1.0_wp - round_off)*control%dt) &
      control%dt = min(control%most, growth*control%dt)
    if (iterations > control%many) control%dt = max(control%least, cut*control%dt)
  end subroutine grow_step

  !> After a step from `time` that did not converge: whether a shorter one
  !> than was tried may follow.
  pure subroutine cut_step(control, time, may_retry)
    type(step_control_t), intent(inout) :: control
    real(wp), intent(in) :: time
    logical, intent(out) :: may_retry
    real(wp) :: tried

    tried = control%next - time
    may_retry = control%is_automatic .and. tried > (1.0_wp + round_off)*control%least
    if (.not. may_retry) return
    control%dt = max(control%least, cut*tried)
    control%target = time
  end subroutine cut_step

  !> What the deck and the plan of the next step do not give.
  subroutine visit_control(self, visitor)
    class(step_control_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('dt', self%dt)
    call visitor%expect('dt', self%dt > 0.0_wp, 'a step that is not positive')
    call visitor%visit('target', self%target)
  end subroutine visit_control

end module step_control_m
