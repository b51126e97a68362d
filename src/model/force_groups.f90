! SPDX-License-Identifier: MIT
!> Groups of nodes whose forces the histories add up.
module force_groups_m
  implicit none
  private
  public :: force_group_t

  !> One *DATABASE_NODAL_FORCE_GROUP.
  type :: force_group_t
    integer :: id = 0                !! user number of its node set
    integer, allocatable :: nodes(:) !! node indices, each once, in the order of the set
  end type force_group_t

end module force_groups_m
