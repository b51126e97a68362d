! SPDX-License-Identifier: MIT
!> Forces and works of boundaries (bndout) and of groups of nodes (nodfor): what of it both drivers
!> do.
module boundary_filling_m
  use controls_m, only : boundary_load, boundary_pressure
  use external_force_m, only : add_nodal_loads, add_pressures
  use kinds_m, only : wp
  use model_m, only : model_t
  use snapshot_m, only : snapshot_t
  use state_m, only : state_t
  implicit none
  private
  public :: form_loads, fill_boundaries

contains

  !> Forces of nodal loads and pressures at `time`, into their rows.
  subroutine form_loads(model, motion, time, force)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)    !! (4, n_node)
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: force(:, :)  !! (3, n_boundary)
    real(wp), allocatable :: nodal(:, :), pressed(:, :)
    integer :: i

    allocate (nodal(2, model%layout%n_special), pressed(2, model%layout%n_special), source=0.0_wp)
    call add_nodal_loads(model, time, nodal)
    call add_pressures(model, motion, time, pressed)
    associate (rows => model%controls%output%boundaries)
      do i = 1, size(rows%where)
        if (rows%condition(i) == boundary_load) force(1:2, i) = nodal(:, rows%where(i))
        if (rows%condition(i) == boundary_pressure) force(1:2, i) = pressed(:, rows%where(i))
      end do
    end associate
  end subroutine form_loads

  !> What the state keeps of them, for the files.
  subroutine fill_boundaries(state, snapshot)
    type(state_t), intent(in) :: state
    type(snapshot_t), intent(inout) :: snapshot

    if (allocated(state%boundary_work)) then
      snapshot%boundary_force = state%boundary_force
      snapshot%boundary_work = state%boundary_work
    end if
    if (allocated(state%group_work)) then
      snapshot%group_force = state%group_force
      snapshot%group_work = state%group_work
    end if
  end subroutine fill_boundaries

end module boundary_filling_m
