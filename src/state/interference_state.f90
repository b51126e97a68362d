! SPDX-License-Identifier: MIT
!> What an interface remembers whose initial overlap a curve lets grow (contact/law/interference).
!> Places are numbered as those of friction (friction_state).
module interference_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: interference_memory_t, allocate_interference

  !> The array is allocated for interfaces with such a curve alone.
  type, extends(visited_t) :: interference_memory_t
    real(wp), allocatable :: depth(:)  !! (n_place) overlap at time zero, m; below 0: that of a
                                       !! master node which was no place then
    real(wp) :: left = 1.0_wp          !! the part of it that does not act yet, 1 - s
    real(wp) :: moment = 0.0_wp        !! sum of p w depth of the last call, J/m
    real(wp) :: work = 0.0_wp          !! of the curve so far, J/m
  contains
    procedure :: visit => visit_interference
  end type interference_memory_t

contains

  !> Allocate for so many places of slave nodes or spots, and of master nodes behind them.
  pure subroutine allocate_interference(interference, n_slave, n_master)
    type(interference_memory_t), intent(inout) :: interference
    integer, intent(in) :: n_slave, n_master

    allocate (interference%depth(n_slave + n_master), source=0.0_wp)
    interference%depth(n_slave + 1:) = -1.0_wp
  end subroutine allocate_interference

  !> Its components.
  subroutine visit_interference(self, visitor)
    class(interference_memory_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('depth', self%depth)
    call visitor%visit('left', self%left)
    call visitor%visit('moment', self%moment)
    call visitor%visit('work', self%work)
  end subroutine visit_interference

end module interference_state_m
