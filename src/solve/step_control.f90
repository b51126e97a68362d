! SPDX-License-Identifier: MIT
!> Lengths of implicit steps: constant, or growing and shrinking with the iterations that they take.
module step_control_m
  use kinds_m, only : wp
  use controls_m, only : controls_t
  implicit none
  private
  public :: step_control_t, start_step_control, find_next_time, grow_step, cut_step

  !> What a step that took few iterations grows by, and what one that failed shrinks to.
  real(wp), parameter :: growth = 1.5_wp, cut = 0.5_wp
  !> Part of a step by which the end time may be missed.
  real(wp), parameter :: round_off = 1.0e-9_wp

  !> Step lengths of a run.
  type :: step_control_t
    real(wp) :: dt = 0.0_wp        !! of the next step, s
    real(wp) :: end_time = 0.0_wp
    logical :: is_last = .false.   !! the step asked for last ends the run
    logical :: is_automatic = .false.
    real(wp) :: least = 0.0_wp     !! shortest step
    real(wp) :: most = 0.0_wp      !! longest step
    integer :: few = 0             !! iterations below which the step grows
    integer :: many = 0            !! iterations above which it shrinks
  end type step_control_t

contains

  !> As the deck asks.
  pure function start_step_control(controls) result(control)
    type(controls_t), intent(in) :: controls
    type(step_control_t) :: control

    associate (implicit => controls%implicit)
      control%dt = implicit%dt
      control%end_time = controls%end_time
      control%is_automatic = implicit%is_automatic
      control%least = implicit%dt_least
      if (.not. control%least > 0.0_wp) control%least = 1.0e-3_wp*implicit%dt
      control%most = implicit%dt_most
      if (.not. control%most > 0.0_wp) control%most = 10.0_wp*implicit%dt
      control%few = implicit%best_iterations - implicit%iteration_window
      control%many = implicit%best_iterations + implicit%iteration_window
    end associate
  end function start_step_control

  !> End of the next step. The last step is stretched or shortened to end the run in time.
  pure subroutine find_next_time(control, time, next)
    type(step_control_t), intent(inout) :: control
    real(wp), intent(in) :: time
    real(wp), intent(out) :: next

    next = time + control%dt
    control%is_last = next >= control%end_time - round_off*control%dt
    if (control%is_last) next = control%end_time
  end subroutine find_next_time

  !> After a step that converged.
  pure subroutine grow_step(control, iterations)
    type(step_control_t), intent(inout) :: control
    integer, intent(in) :: iterations

    if (.not. control%is_automatic) return
    if (iterations <= control%few) control%dt = min(control%most, growth*control%dt)
    if (iterations > control%many) control%dt = max(control%least, cut*control%dt)
  end subroutine grow_step

  !> After a step that did not converge: whether a shorter one may be tried.
  pure subroutine cut_step(control, may_retry)
    type(step_control_t), intent(inout) :: control
    logical, intent(out) :: may_retry

    may_retry = control%is_automatic .and. control%dt > control%least
    if (may_retry) control%dt = max(control%least, cut*control%dt)
  end subroutine cut_step

end module step_control_m
