! SPDX-License-Identifier: MIT
!> Tangents of points that are loaded by their own gaps (doc/theory/contact.md, sections 9.2 and
!> 9.8).
module point_tangent_m
  use assembly_m, only : add_linearised_point
  use tie_handover_m, only : is_held_by_tie
  use contact_law_m, only : linearise_pressure
  use contact_state_m, only : contact_state_t
  use contacts_m, only : friction_rule_t
  use dual_m, only : dual_t, constant, operator(+), operator(*)
  use entry_offset_m, only : has_offsets, add_offsets
  use interference_m, only : ramp_gaps
  use kinds_m, only : wp
  use law_friction_m, only : linearise_traction, goes_on
  use law_state_m, only : is_open, slips
  use linearisation_m, only : linearised_list_t, linearised_point_t, slip_of, between
  use sparse_m, only : sparse_t
  implicit none
  private
  public :: add_point_tangents, load_point, linearise_friction, parts_left

contains

  !> All points, with friction by their own slips.
  pure subroutine add_point_tangents(rule, memory, list, equations, matrix)
    type(friction_rule_t), intent(in) :: rule
    type(contact_state_t), intent(in) :: memory
    type(linearised_list_t), intent(in) :: list
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(dual_t) :: pressure, traction
    logical :: acts
    integer :: p

    do p = 1, list%n
      associate (point => list%points(p))
        call load_point(rule, memory, point, acts, pressure, traction)
        if (acts) call add_linearised_point(point, pressure*point%area, traction*point%area, &
          equations, matrix)
      end associate
    end do
  end subroutine add_point_tangents

  !> Pressure and traction of a point, if it acts.
  pure subroutine load_point(rule, memory, point, acts, pressure, traction)
    type(friction_rule_t), intent(in) :: rule
    type(contact_state_t), intent(in) :: memory
    type(linearised_point_t), intent(in) :: point
    logical, intent(out) :: acts !! in contact, and not left to a tie
    type(dual_t), intent(out) :: pressure, traction
    type(dual_t) :: gap, previous
    integer :: before

    gap = point%gap + point%remaining
    acts = gap%value < memory%closed_gap
    if (acts) acts = .not. is_held_by_tie(memory, point%site)
    if (.not. acts) return
    pressure = linearise_pressure(memory%contact_law, point%stiffness, gap)
    traction = constant(0.0_wp)
    if (.not. memory%has%friction) return
    associate (tractions => memory%scratch%previous_traction, &
      states => memory%scratch%previous_state, nodes => point%nodes)
      previous = constant(tractions(point%site))
      before = states(point%site)
      if (nodes(4) == 0 .and. before == is_open) then
        ! A master node that was none of the points goes on from the ends of its slave segment.
        previous = between(tractions(nodes(:2)), point%slave_xi)
        if (any(states(nodes(:2)) == slips)) before = slips
      end if
    end associate
    traction = linearise_friction(rule, memory, previous, slip_of(memory, point), pressure, &
      point%stiffness, before, point%length)
  end subroutine load_point

  !> Traction from what was before and a slip; in the first tangent of a step, in which nothing has
  !> moved yet, what slipped before goes on.
  pure function linearise_friction(rule, memory, previous, slip, pressure, stiffness, before, &
    length) &
      result(traction)
    type(friction_rule_t), intent(in) :: rule
    type(contact_state_t), intent(in) :: memory
    type(dual_t), intent(in) :: previous, slip, pressure !! N/m^2, m, N/m^2
    real(wp), intent(in) :: stiffness                  !! normal, N/m^3
    integer, intent(in) :: before                      !! state at the end of the step before
    type(dual_t), intent(in) :: length                 !! what a largest traction counts times
    type(dual_t) :: traction, most

    most = constant(huge(1.0_wp))
    if (rule%most > 0.0_wp) most = rule%most*length
    traction = linearise_traction(rule, previous, slip, pressure, rule%stiffness*stiffness, most, &
      [memory%scratch%dt, memory%scratch%lag], &
      merge(goes_on, before, memory%closed_gap > 0.0_wp .and. before == slips))
  end function linearise_friction

  !> The parts of the depths of the points on the list that do not act: entry offsets, and initial
  !> overlaps that grow, m. Those of averages at slave nodes are added there.
  pure function parts_left(memory) result(remaining)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: remaining(memory%points%n)

    remaining = 0.0_wp
    if (has_offsets(memory)) call add_offsets(memory, remaining)
    if (memory%has%interference .and. .not. memory%has%nodal_pressure) &
      call ramp_gaps(memory, remaining)
  end function parts_left

end module point_tangent_m
