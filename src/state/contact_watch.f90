! SPDX-License-Identifier: MIT
!> What is known of the energy of one interface: whether its springs give back what they take.
module contact_watch_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: contact_watch_t, contact_change_t, has_made, has_lost

  !> Signs of the balance, as places in arrays of two.
  integer, parameter :: has_made = 1, has_lost = 2
  character(*), parameter :: no_node = 'a number that no node has'

  !> The largest change of the balance of one sign between two looks, and whether the log has told
  !> of that sign.
  type, extends(visited_t) :: contact_change_t
    real(wp) :: amount = 0.0_wp   !! J/m
    integer :: node = 0           !! most loaded then, by place in the mesh; 0: none yet
    real(wp) :: place(2) = 0.0_wp !! where that node was, m
    real(wp) :: time = 0.0_wp     !! of the second of the two looks, s
    logical :: warned = .false.
  contains
    procedure :: visit => visit_change
  end type contact_change_t

  !> Filled when the springs are looked at, now and then.
  type, extends(visited_t) :: contact_watch_t
    logical :: is_due = .false.       !! the next call looks at the springs
    logical :: has_looked = .false.   !! the last call did, or found that contact has opened
    real(wp) :: stored = 0.0_wp       !! potential of the springs then, J/m
    real(wp) :: load = 0.0_wp         !! largest force of a point then, N/m
    integer :: node = 0               !! slave node next to it, by place in the mesh; 0: none yet
    real(wp) :: balance = 0.0_wp      !! energy of the interface minus what its springs stored then:
                                      !! below 0 made, above lost
    type(contact_change_t) :: changes(2) !! by sign
  contains
    procedure :: visit => visit_watch
  end type contact_watch_t

contains

  !> Its components.
  subroutine visit_change(self, visitor)
    class(contact_change_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('amount', self%amount)
    call visitor%visit('node', self%node, 0, visitor%n_node, no_node)
    call visitor%fixed('place', self%place)
    call visitor%visit('time', self%time)
    call visitor%visit('warned', self%warned)
  end subroutine visit_change

  !> Its components.
  subroutine visit_watch(self, visitor)
    class(contact_watch_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('is_due', self%is_due)
    call visitor%visit('has_looked', self%has_looked)
    call visitor%visit('stored', self%stored)
    call visitor%visit('load', self%load)
    call visitor%visit('node', self%node, 0, visitor%n_node, no_node)
    call visitor%visit('balance', self%balance)
    call visitor%each('changes', self%changes)
  end subroutine visit_watch

end module contact_watch_m
