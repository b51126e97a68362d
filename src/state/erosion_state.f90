! SPDX-License-Identifier: MIT
!> Which elements have left the mesh, and what is known only of elements that may.
module erosion_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, of_chunks, of_slots
  implicit none
  private
  public :: erosion_state_t, stays, has_left, has_gone

  !> An element is there; it has left in this cycle and nobody has heard of it; it has gone.
  integer, parameter :: stays = 0, has_left = 1, has_gone = 2

  !> Only in runs some elements of which may leave.
  type, extends(visited_t) :: erosion_state_t
    integer, allocatable :: status(:)      !! (n_slot) one of the constants above
    integer, allocatable :: n_gone(:)      !! (n_chunk) elements of a chunk that are not there
    real(wp), allocatable :: hourglass(:)  !! (n_slot) work of its hourglass forces, J/m
    real(wp), allocatable :: internal(:)   !! (n_slot) of those that have left: what they took along
    real(wp), allocatable :: impulse(:)    !! (n_slot) integral of (sigma_1 - SIGTH)^2
    integer, allocatable :: n_element(:)   !! (n_node) elements that each node still has
    integer, allocatable :: n_eroded(:)    !! (n_part) elements that have gone
    real(wp) :: first_time = 0.0_wp        !! when the first one went, s
    real(wp) :: least_step = 0.0_wp        !! step below which ERODE takes elements, s
    real(wp) :: took(4) = 0.0_wp           !! energies that went with them: kinetic, internal,
                                           !! hourglass, contact springs, J/m
  contains
    procedure :: visit => visit_erosion
  end type erosion_state_t

contains

  !> Its components.
  subroutine visit_erosion(self, visitor)
    class(erosion_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('status', self%status, of_slots)
    call visitor%visit('n_gone', self%n_gone, of_chunks)
    call visitor%visit('hourglass', self%hourglass, of_slots)
    call visitor%visit('internal', self%internal, of_slots)
    call visitor%visit('impulse', self%impulse, of_slots)
    call visitor%visit('n_element', self%n_element)
    call visitor%visit('n_eroded', self%n_eroded)
    call visitor%visit('first_time', self%first_time)
    call visitor%visit('least_step', self%least_step)
    call visitor%fixed('took', self%took)
  end subroutine visit_erosion

end module erosion_state_m
