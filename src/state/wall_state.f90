! SPDX-License-Identifier: MIT
!> What changes about a rigid wall.
module wall_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: wall_state_t

  !> One wall.
  type, extends(visited_t) :: wall_state_t
    real(wp), allocatable :: force(:) !! (nodes of the wall) what it pushes with along its normal
                                      !! now, N/m
    real(wp), allocatable :: speed(:) !! (nodes of the wall) velocity along its normal before that,
                                      !! m/s
    real(wp), allocatable :: friction(:)   !! (nodes of the wall, none without friction) what it
                                           !! holds back with along its tangent now, N/m
    real(wp), allocatable :: slip_speed(:) !! (as `friction`) velocity along the tangent before
                                           !! that, m/s
    real(wp) :: impulse = 0.0_wp      !! of all its nodes so far, N s/m
    real(wp) :: work = 0.0_wp         !! on all its nodes so far, J/m; negative: lost in impacts
                                      !! and in friction
    real(wp) :: dissipated = 0.0_wp   !! by friction so far, J/m
  contains
    procedure :: visit => visit_wall
  end type wall_state_t

contains

  !> Its components.
  subroutine visit_wall(self, visitor)
    class(wall_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('force', self%force)
    call visitor%visit('speed', self%speed)
    call visitor%visit('impulse', self%impulse)
    call visitor%visit('work', self%work)
    call visitor%visit('friction', self%friction)
    call visitor%visit('slip_speed', self%slip_speed)
    call visitor%visit('dissipated', self%dissipated)
  end subroutine visit_wall

end module wall_state_m
