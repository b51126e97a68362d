! SPDX-License-Identifier: MIT
!> Columns of the histories of boundaries, groups of nodes and cross sections (see
!> `history_rows_m`).
module history_force_rows_m
  use kinds_m, only : wp
  use snapshot_m, only : snapshot_t, section_result_t
  use table_row_m, only : row_t, put, value_of, vector_of
  implicit none
  private
  public :: put_bndout, put_nodfor, put_secforc

contains

  !> Force and work of what acts on a node or a rigid body.
  pure subroutine put_bndout(row, shot, condition, id, i)
    type(row_t), intent(inout) :: row
    type(snapshot_t), intent(in) :: shot
    integer, intent(in) :: condition, id  !! one of `boundary_`; of the node, or of the part
    integer, intent(in) :: i              !! index of the row
    real(wp) :: force(3)

    force = 0.0_wp
    if (allocated(shot%boundary_force)) force = shot%boundary_force(:, i)
    call put(row, 'time', shot%time)
    call put(row, 'condition', condition)
    call put(row, 'id', id)
    call put(row, 'fx,fy,moment', force)
    call put(row, 'work', value_of(shot%boundary_work, i))
  end subroutine put_bndout

  !> Force of a node of a force group, and its work.
  pure subroutine put_nodfor(row, shot, group, id, i)
    type(row_t), intent(inout) :: row
    type(snapshot_t), intent(in) :: shot
    integer, intent(in) :: group, id      !! user numbers of the node set and the node
    integer, intent(in) :: i              !! index of the row

    call put(row, 'time', shot%time)
    call put(row, 'group', group)
    call put(row, 'node', id)
    call put(row, 'fx,fy', vector_of(shot%group_force, i))
    call put(row, 'work', value_of(shot%group_work, i))
  end subroutine put_nodfor

  !> Force and moment of a cross section.
  pure subroutine put_secforc(row, time, id, section)
    type(row_t), intent(inout) :: row
    real(wp), intent(in) :: time
    integer, intent(in) :: id
    type(section_result_t), intent(in) :: section

    call put(row, 'time', time)
    call put(row, 'section', id)
    call put(row, 'fx,fy', section%force)
    call put(row, 'moment', section%moment)
    call put(row, 'x,y', section%centroid)
    call put(row, 'area', section%area)
  end subroutine put_secforc

end module history_force_rows_m
