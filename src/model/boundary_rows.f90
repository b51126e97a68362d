! SPDX-License-Identifier: MIT
!> What the history of boundaries has a row of: nodes and rigid bodies that loads act on or that are
!> moved.
module boundary_rows_m
  use conditions_m, only : conditions_t
  use kinds_m, only : long
  use sorting_m, only : sorted_order
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: boundary_rows_t, list_boundaries, boundary_load, boundary_body_load, &
    boundary_pressure, boundary_motion, boundary_body_motion

  !> What acts: a force on a node, on a body, pressure on edges of a node, prescribed motion of a
  !> node, of a body. Rows come in this order.
  integer, parameter :: boundary_load = 1, boundary_body_load = 2, boundary_pressure = 3, &
    boundary_motion = 4, boundary_body_motion = 5

  !> The rows, and which belong to the prescribed motions.
  type, extends(visited_t) :: boundary_rows_t
    integer, allocatable :: condition(:)       !! one of `boundary_`
    integer, allocatable :: where(:)           !! index of the node, or of the body
    integer, allocatable :: motion_rows(:)     !! of each prescribed motion of a node
    integer, allocatable :: body_motion_rows(:) !! of each of a body
  contains
    procedure :: visit => visit_rows
  end type boundary_rows_t

contains

  !> All rows, by what acts and then by rising user number.
  subroutine list_boundaries(conditions, node_ids, body_ids, rows)
    type(conditions_t), intent(in) :: conditions
    integer, intent(in) :: node_ids(:), body_ids(:) !! user numbers
    type(boundary_rows_t), intent(out) :: rows
    integer :: row_at(max(size(node_ids), size(body_ids))), i

    allocate (rows%condition(0), rows%where(0))
    call add_rows(boundary_load, [conditions%nodal_loads%node], node_ids, rows, row_at)
    if (allocated(conditions%rigid_loads)) call add_rows(boundary_body_load, &
      [conditions%rigid_loads%node], body_ids, rows, row_at)
    call add_rows(boundary_pressure, [(conditions%pressures(i)%nodes, i=1, &
      size(conditions%pressures))], node_ids, rows, row_at)
    call add_rows(boundary_motion, [conditions%motions%node], node_ids, rows, row_at)
    rows%motion_rows = row_at(conditions%motions%node)
    call add_rows(boundary_body_motion, [conditions%rigid_motions%node], body_ids, rows, row_at)
    rows%body_motion_rows = row_at(conditions%rigid_motions%node)
  end subroutine list_boundaries

  !> Rows of what acts on some nodes or bodies, each once.
  subroutine add_rows(condition, places, ids, rows, row_at)
    integer, intent(in) :: condition
    integer, intent(in) :: places(:)   !! indices, any of them several times
    integer, intent(in) :: ids(:)      !! their user numbers
    type(boundary_rows_t), intent(inout) :: rows
    integer, intent(out) :: row_at(:)  !! row of each index, 0 = none
    logical :: is_there(size(ids))
    integer, allocatable :: found(:)
    integer :: i

    is_there = .false.
    is_there(places) = .true.
    found = pack([(i, i=1, size(ids))], is_there)
    found = found(sorted_order(int(ids(found), long)))
    row_at = 0
    row_at(found) = size(rows%where) + [(i, i=1, size(found))]
    rows%condition = [rows%condition, spread(condition, 1, size(found))]
    rows%where = [rows%where, found]
  end subroutine add_rows

  !> Its components.
  subroutine visit_rows(self, visitor)
    class(boundary_rows_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('condition', self%condition)
    call visitor%visit('where', self%where)
    call visitor%visit('motion_rows', self%motion_rows)
    call visitor%visit('body_motion_rows', self%body_motion_rows)
  end subroutine visit_rows

end module boundary_rows_m
