! SPDX-License-Identifier: MIT
!> What an interface with a whole outline remembers of which segments face the other side. Contact
!> goes on between runs of such segments (doc/theory/contact.md, section 3.7).
module facing_state_m
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: facing_t, facing_side_t, allocate_side

  integer, parameter :: most_looks = 10**9

  !> One surface: its runs, and what is known of all its segments since the start.
  type, extends(visited_t) :: facing_side_t
    integer :: n = 0                    !! segments in runs
    integer, allocatable :: segments(:) !! (n_segment of the deck) the first n: their numbers there,
                                        !! rising; else 0
    logical, allocatable :: is_cut(:)   !! (n_segment) the first n: not linked to the one before
    real(wp), allocatable :: depth(:)   !! (n_segment) deepest place that it is faced by, m
    real(wp), allocatable :: caught(:)  !! (n_segment) deepest first contact with it, m
    real(wp), allocatable :: reached(:) !! (n_segment) deepest first contact of its own spots, m
  contains
    procedure :: visit => visit_side
  end type facing_side_t

  !> Both surfaces. The present interface is made of the lists and of the deck's interface.
  type, extends(visited_t) :: facing_t
    logical :: is_used = .false.        !! some chain of the interface is closed
    real(wp) :: next_look = -huge(1.0_wp) !! travel from which on runs may be others
    integer :: n_look = 0               !! looks at who faces whom so far
    integer :: n_change = 0             !! those which found other runs
    type(facing_side_t) :: slave, master
    type(contact_t), allocatable :: present !! with runs for surfaces; nodes are numbered as before
  contains
    procedure :: visit => visit_facing
  end type facing_t

contains

  !> Allocate for a surface, no segment of which is in a run.
  pure subroutine allocate_side(side, n_segment)
    type(facing_side_t), intent(inout) :: side
    integer, intent(in) :: n_segment

    side%n = 0
    allocate (side%segments(n_segment), source=0)
    allocate (side%is_cut(n_segment), source=.false.)
    allocate (side%depth(n_segment), side%caught(n_segment), side%reached(n_segment), &
      source=0.0_wp)
  end subroutine allocate_side

  !> Its components, but for depths, which the initial mesh has.
  subroutine visit_side(self, visitor)
    class(facing_side_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n', self%n)
    call visitor%visit('segments', self%segments)
    call visitor%visit('is_cut', self%is_cut)
  end subroutine visit_side

  !> Its components. The present interface is made of them again.
  subroutine visit_facing(self, visitor)
    class(facing_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%same('is_used', merge(1, 0, self%is_used))
    call visitor%visit('next_look', self%next_look)
    call visitor%visit('n_look', self%n_look, 0, most_looks, 'a number that no run reaches')
    call visitor%visit('n_change', self%n_change, 0, most_looks, 'a number that no run reaches')
    call visitor%part('slave', self%slave)
    call visitor%part('master', self%master)
  end subroutine visit_facing

end module facing_state_m
