! SPDX-License-Identifier: MIT
!> What the friction of an interface remembers (contact/law/friction): tractions at the places where
!> pressure is formed. A place is a local node; with n virtual nodes to a segment n (k - 1) + q is
!> the q-th of the slave segment that starts at node k. Nodes keep their numbers when runs of
!> segments change.
module friction_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, whole
  implicit none
  private
  public :: friction_memory_t, allocate_friction, is_open, sticks, slips, &
    is_held, is_broken

  !> What a place is doing.
  integer, parameter :: is_open = 0, sticks = 1, slips = 2
  !> What a tie makes of it.
  integer, parameter :: is_held = 3, is_broken = 4

  !> Arrays are allocated for interfaces with friction alone.
  type, extends(visited_t) :: friction_memory_t
    real(wp), allocatable :: traction(:)  !! (n_place) of the last call, before the energy law,
                                          !! N/m^2 (N/m for type 1); 0 where open
    integer, allocatable :: state(:)      !! (n_place) one of the constants above
    real(wp), allocatable :: slip(:)      !! (n_place) sum of all steps in contact, m
    real(wp), allocatable :: force(:, :)  !! (2, n_slave + n_master) the part of the contact forces
                                          !! that friction has, N/m
    real(wp) :: work = 0.0_wp             !! minus the accumulated work of these forces, J/m
    real(wp) :: stored = 0.0_wp           !! the part of it that tangential springs hold now, J/m
  contains
    procedure :: visit => visit_friction
  end type friction_memory_t

contains

  !> Allocate for so many places and nodes; all places are open.
  pure subroutine allocate_friction(friction, n_place, n_node)
    type(friction_memory_t), intent(inout) :: friction
    integer, intent(in) :: n_place, n_node

    allocate (friction%traction(n_place), friction%slip(n_place), friction%force(2, n_node), &
      source=0.0_wp)
    allocate (friction%state(n_place), source=is_open)
  end subroutine allocate_friction

  !> Its components.
  subroutine visit_friction(self, visitor)
    class(friction_memory_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('traction', self%traction)
    call visitor%visit('state', self%state, whole, is_open, slips, 'numbers that mean nothing')
    call visitor%visit('slip', self%slip)
    call visitor%visit('force', self%force)
    call visitor%visit('work', self%work)
    call visitor%visit('stored', self%stored)
  end subroutine visit_friction

end module friction_state_m
