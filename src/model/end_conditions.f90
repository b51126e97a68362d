! SPDX-License-Identifier: MIT
!> What ends a run before its end time: where a node or a rigid body has come to, and interfaces
!> that let go.
module end_conditions_m
  use kinds_m, only : wp
  implicit none
  private
  public :: end_condition_t, end_node_place, end_node_touch, end_body_place, end_body_way, &
    end_contact

  !> The kinds: a coordinate of a node, a node in contact, a displacement of a body along an axis,
  !> the length of that displacement, an interface without force.
  integer, parameter :: end_node_place = 1, end_node_touch = 2, end_body_place = 3, &
    end_body_way = 4, end_contact = 5

  !> One of them.
  type :: end_condition_t
    integer :: kind = 0
    integer :: id = 0                  !! user number of the node, part or interface
    integer :: where = 0               !! index of the node, body or interface
    integer :: direction = 0           !! 1 x, 2 y; of an interface 0 both
    real(wp) :: least = -huge(1.0_wp)  !! MINC
    real(wp) :: most = huge(1.0_wp)    !! MAXC
    real(wp) :: start = 0.0_wp         !! ACTIM
    real(wp) :: duration = 0.0_wp      !! DUR
    real(wp) :: threshold = 0.0_wp     !! THRES
  end type end_condition_t

end module end_conditions_m
