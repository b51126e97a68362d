! SPDX-License-Identifier: MIT
!> Groups of nodes whose forces the histories add up.
module force_groups_m
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: force_group_t

  !> One *DATABASE_NODAL_FORCE_GROUP.
  type, extends(visited_t) :: force_group_t
    integer :: id = 0                !! user number of its node set
    integer, allocatable :: nodes(:) !! node indices, each once, in the order of the set
  contains
    procedure :: visit => visit_group
  end type force_group_t

contains

  !> Its components.
  subroutine visit_group(self, visitor)
    class(force_group_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%visit('nodes', self%nodes)
  end subroutine visit_group

end module force_groups_m
