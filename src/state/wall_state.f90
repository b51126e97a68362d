! SPDX-License-Identifier: MIT
!> What changes about a rigid wall.
module wall_state_m
  use kinds_m, only : wp
  implicit none
  private
  public :: wall_state_t

  !> One wall.
  type :: wall_state_t
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
  end type wall_state_t

end module wall_state_m
