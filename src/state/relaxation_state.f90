! SPDX-License-Identifier: MIT
!> What dynamic relaxation remembers from cycle to cycle besides the state.
module relaxation_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, any_length
  implicit none
  private
  public :: relaxation_state_t

  !> A phase of relaxation that goes on.
  type, extends(visited_t) :: relaxation_state_t
    integer :: n = 0                      !! cycles so far, 0 where it has not begun or is over
    real(wp) :: time = 0.0_wp             !! of its own clock: that of the run stands at zero
    real(wp) :: most = 0.0_wp             !! largest kinetic energy
    real(wp), allocatable :: velocity(:, :) !! (2, n_node) with which the run will begin
  contains
    procedure :: visit => visit_relaxation
  end type relaxation_state_t

contains

  !> Its components.
  subroutine visit_relaxation(self, visitor)
    class(relaxation_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n', self%n)
    call visitor%visit('time', self%time, 0.0_wp, 'a time below zero')
    call visitor%visit('most', self%most)
    call visitor%visit('velocity', self%velocity, any_length)
  end subroutine visit_relaxation

end module relaxation_state_m
