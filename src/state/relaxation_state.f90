! SPDX-License-Identifier: MIT
!> What dynamic relaxation remembers from cycle to cycle besides the state.
module relaxation_state_m
  use kinds_m, only : wp
  implicit none
  private
  public :: relaxation_state_t

  !> A phase of relaxation that goes on.
  type :: relaxation_state_t
    integer :: n = 0                      !! cycles so far, 0 where it has not begun or is over
    real(wp) :: time = 0.0_wp             !! of its own clock: that of the run stands at zero
    real(wp) :: most = 0.0_wp             !! largest kinetic energy
    real(wp), allocatable :: velocity(:, :) !! (2, n_node) with which the run will begin
  end type relaxation_state_t

end module relaxation_state_m
