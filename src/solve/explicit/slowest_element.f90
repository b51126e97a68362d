! SPDX-License-Identifier: MIT
!> Which element rules the time step (glstat).
module slowest_element_m
  use curves_m, only : curve_value
  use kinds_m, only : wp
  use layout_m, only : slot_part
  use model_m, only : model_t
  use element_steps_m, only : find_smallest_steps
  use snapshot_m, only : snapshot_t
  use state_m, only : state_t
  implicit none
  private
  public :: find_slowest

  !> Part of DT2MS by which a step that mass scaling has set may differ from it.
  real(wp), parameter :: round_off = 1.0e-9_wp

contains

  !> Ids of the element with the smallest stable step, and of its part; 0 where the curve rules. And
  !> whether that step is the one of DT2MS.
  subroutine find_slowest(model, state, snapshot)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot
    integer, allocatable :: found(:)
    real(wp), allocatable :: steps(:)

    snapshot%slowest = 0
    snapshot%by_dt2ms = 0
    if (model%controls%dt_curve > 0) then
      if (.not. abs(curve_value(model%curves(model%controls%dt_curve), state%time) - state%dt) &
        > 0.0_wp) return
    end if
    call find_smallest_steps(model, state%elements, state%motion, 1, found, steps)
    if (size(found) == 0) return
    ! An element that is as large without added mass rules by itself.
    if (snapshot%energies%tells_mass) snapshot%by_dt2ms = merge(1, 0, &
      abs(steps(1)/abs(model%controls%mass_step) - 1.0_wp) <= round_off .or. &
      (model%controls%mass_step > 0.0_wp .and. steps(1) > model%controls%mass_step))
    snapshot%slowest = [model%mesh%element_id(found(1)), &
      model%parts(slot_part(model%layout, model%layout%element_slot(found(1))))%id]
  end subroutine find_slowest

end module slowest_element_m
