! SPDX-License-Identifier: MIT
!> Slips and tractions of varied points (doc/theory/contact.md, section 9.8): what law/friction does
!> with places, gone through once more in dual numbers.
module friction_tangent_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : friction_rule_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*), operator(/)
  use law_state_m, only : is_open, slips
  use kinds_m, only : wp
  use law_friction_m, only : vary_traction, goes_on
  use variation_m, only : varied_point_t, apart
  implicit none
  private
  public :: vary_slip, vary_grip, largest_grip, state_before

contains

  !> Slip of a point in the step over the segment in slots i, i + 1, on which its foot is master_xi,
  !> m. Where there is no slot i + 1, the segment that has the normal is the slave's.
  pure function vary_slip(memory, point, i, master_xi) result(slip)
    type(contact_state_t), intent(in) :: memory
    type(varied_point_t), intent(in) :: point
    integer, intent(in) :: i
    type(dual_t), intent(in) :: master_xi
    type(dual_t) :: slip
    type(dual_t) :: relative(2), t(2), turn(2)
    integer :: owner

    relative = moved(memory, point, 1) - moved(memory, point, i)
    if (point%nodes(2) > 0) relative = relative + point%slave_xi &
      *(moved(memory, point, 2) - moved(memory, point, 1))
    owner = 1
    if (point%nodes(i + 1) > 0) then
      owner = i
      relative = relative - master_xi*(moved(memory, point, i + 1) - moved(memory, point, i))
    end if
    t = apart(memory%places, point%nodes, owner + 1, owner)
    turn = moved(memory, point, owner + 1) - moved(memory, point, owner)
    slip = point%normal(1)*relative(2) - point%normal(2)*relative(1) &
      + point%gap*(t(2)*turn(1) - t(1)*turn(2))/(t(1)*t(1) + t(2)*t(2))
  end function vary_slip

  !> Displacement of the node in slot i in the step.
  pure function moved(memory, point, i) result(du)
    type(contact_state_t), intent(in) :: memory
    type(varied_point_t), intent(in) :: point
    integer, intent(in) :: i
    type(dual_t) :: du(2)

    du = constant(memory%scratch%increment(:, point%nodes(i)))
    du(1)%slope(2*i - 1) = 1.0_wp
    du(2)%slope(2*i) = 1.0_wp
  end function moved

  !> Traction of a point that slips by itself (types 1, 2, 3 and 5). A master node that was none of
  !> the points goes on from the line between the ends of its slave segment.
  pure function vary_grip(rule, memory, place, point, pressure, stiffness, length) result(traction)
    type(friction_rule_t), intent(in) :: rule
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: place                 !! a local node
    type(varied_point_t), intent(in) :: point
    type(dual_t), intent(in) :: pressure
    real(wp), intent(in) :: stiffness            !! normal, N/m^3
    type(dual_t), intent(in), optional :: length !! what the largest traction counts times, m
    type(dual_t) :: traction
    type(dual_t) :: former, most
    integer :: before

    before = state_before(memory, place)
    associate (tractions => memory%scratch%former_traction)
      former = constant(tractions(place))
      if (point%nodes(4) == 0 .and. before == is_open) then
        former = (tractions(point%nodes(2)) - tractions(point%nodes(1)))*point%slave_xi
        former = former + tractions(point%nodes(1))
        if (any(memory%scratch%former_state(point%nodes(:2)) == slips)) before = slips
      end if
    end associate
    most = largest_grip(rule)
    if (present(length) .and. rule%most > 0.0_wp) most = rule%most*length
    traction = vary_traction(rule, former, vary_slip(memory, point, 3, point%master_xi), pressure, &
      rule%stiffness*stiffness, most, [memory%scratch%dt, memory%scratch%lag], before)
  end function vary_grip

  !> The state of a place at the end of the step before; `goes_on` where it slipped, in the first
  !> tangent of a step, in which nothing has moved yet.
  pure function state_before(memory, place) result(before)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: place
    integer :: before

    before = memory%scratch%former_state(place)
    if (memory%closed_gap > 0.0_wp .and. before == slips) before = goes_on
  end function state_before

  !> Largest traction whatever the pressure.
  pure function largest_grip(rule) result(most)
    type(friction_rule_t), intent(in) :: rule
    type(dual_t) :: most

    most = constant(huge(1.0_wp))
    if (rule%most > 0.0_wp) most = constant(rule%most)
  end function largest_grip

end module friction_tangent_m
