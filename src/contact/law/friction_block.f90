! SPDX-License-Identifier: MIT
!> Friction of some places at a time (doc/theory/contact.md, section 6.2): where they start from,
!> and what a step makes of them.
module friction_block_m
  use contact_state_m, only : n_side
  use contacts_m, only : friction_rule_t
  use friction_sides_m, only : n_block
  use law_state_m, only : is_open, sticks, slips
  use kinds_m, only : wp
  use law_friction_m, only : coefficient_of, has_decay, find_limits, sliding_speed, &
    return_tractions
  implicit none
  private
  public :: rubs_t, find_former, find_before, rub_block

  !> Places in a step. Without default values, which would be written before each use.
  type :: rubs_t
    integer :: place(n_block)
    real(wp) :: slip(n_block)      !! of the step, m
    real(wp) :: former(n_block)    !! traction before, N/m^2
    real(wp) :: stiffness(n_block) !! tangential, N/m^3
    real(wp) :: pressure(n_block)  !! N/m^2
    real(wp) :: most(n_block)      !! largest traction whatever the pressure, N/m^2; only where the
                                   !! rule has one
    real(wp) :: traction(n_block)  !! after the step, N/m^2
    integer :: state(n_block)      !! the same
    integer :: before(n_block)     !! state in the step before; this and the next only where the
                                   !! rule has a decay
    real(wp) :: drag(n_block)      !! traction of the damping of what sticks, N/m^2
  end type rubs_t

contains

  !> The places of some points and their tractions in the step before. A master node that was none
  !> of the points then starts from what the two ends of its slave segment had: of nothing it would
  !> lose that part of the shear.
  pure subroutine find_former(n, slave_nodes, slave_weights, master_nodes, former_traction, &
      former_state, place, former)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *)
    real(wp), intent(in) :: former_traction(*)  !! of all places
    integer, intent(in) :: former_state(*)
    integer, intent(inout) :: place(*)          !! of the points
    real(wp), intent(inout) :: former(*)
    integer :: p

    !GCC$ NOVECTOR
    do p = 1, n
      place(p) = slave_nodes(1, p)
      former(p) = former_traction(slave_nodes(1, p))
      if (slave_nodes(1, p) == slave_nodes(2, p)) cycle
      place(p) = master_nodes(1, p)
      if (former_state(master_nodes(1, p)) == is_open) then
        former(p) = sum(slave_weights(:, p)*former_traction(slave_nodes(:, p)))
      else
        former(p) = former_traction(master_nodes(1, p))
      end if
    end do
  end subroutine find_former

  !> States of some points in the step before. A master node that was none of the points goes on
  !> sliding where an end of its slave segment slid.
  pure subroutine find_before(n, slave_nodes, place, former_state, before)
    integer, intent(in) :: n, slave_nodes(n_side, *), place(*)
    integer, intent(in) :: former_state(*)  !! of all places
    integer, intent(inout) :: before(*)
    integer :: p

    do p = 1, n
      before(p) = former_state(place(p))
      if (before(p) /= is_open) cycle
      if (any(former_state(slave_nodes(:, p)) == slips)) before(p) = slips
    end do
  end subroutine find_before

  !> Tractions and states of some places after a step.
  pure subroutine rub_block(rule, n, dt, lag, rubs)
    type(friction_rule_t), intent(in) :: rule
    integer, intent(in) :: n
    real(wp), intent(in) :: dt
    real(wp), intent(in) :: lag !! of what is damped, s
    type(rubs_t), intent(inout) :: rubs
    real(wp) :: limits(n_block)

    call find_limits(rule, n, rubs%pressure, limits)
    if (rule%most > 0.0_wp) limits(:n) = min(limits(:n), rubs%most(:n))
    call return_tractions(n, rubs%former, rubs%stiffness, rubs%slip, limits, rubs%traction, &
      rubs%state)
    if (.not. has_decay(rule)) return
    rubs%drag(:n) = 0.0_wp
    if (dt > 0.0_wp) call slow_down(rule, n, [dt, lag], limits, rubs)
  end subroutine rub_block

  !> Tractions of the places that slide, each at the speed of its sliding, and damping of those that
  !> stick and did so before, up to their limits. A damped place slides where its spring and both
  !> together are beyond the limit, so that tractions do not jump between the two.
  pure subroutine slow_down(rule, n, times, limits, rubs)
    type(friction_rule_t), intent(in) :: rule
    integer, intent(in) :: n
    real(wp), intent(in) :: times(2)  !! the step and the lag of what is damped, s
    real(wp), intent(in) :: limits(n) !! of what sticks, N/m^2
    type(rubs_t), intent(inout) :: rubs
    real(wp) :: trial, damped, most, speed
    integer :: k

    most = huge(most)
    do k = 1, n
      if (.not. min(rubs%pressure(k), rubs%stiffness(k)) > 0.0_wp) cycle
      trial = rubs%former(k) + rubs%stiffness(k)*rubs%slip(k)
      damped = trial
      if (rubs%before(k) == sticks) &
        damped = trial + times(2)/times(1)*rubs%stiffness(k)*rubs%slip(k)
      if (rule%most > 0.0_wp) most = rubs%most(k)
      speed = sliding_speed(rule, min(abs(trial), damped*sign(1.0_wp, trial)), rubs%pressure(k), &
        most, rubs%stiffness(k)*times(1), rubs%before(k) == slips &
        .and. trial*rubs%former(k) > 0.0_wp)
      if (speed > 0.0_wp) then
        rubs%traction(k) = sign(min(coefficient_of(rule, speed)*rubs%pressure(k), most), trial)
        rubs%state(k) = slips
      else if (rubs%before(k) == sticks) then
        rubs%traction(k) = trial
        rubs%state(k) = sticks
        rubs%drag(k) = sign(min(abs(damped), limits(k)), damped) - trial
      end if
    end do
  end subroutine slow_down

end module friction_block_m
