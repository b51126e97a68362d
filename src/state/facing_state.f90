! SPDX-License-Identifier: MIT
!> What an interface with a whole outline remembers of which segments face the other side. Contact
!> goes on between runs of such segments (doc/theory/contact.md, section 3.7).
module facing_state_m
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: facing_t, facing_side_t, allocate_side

  !> One surface: its runs, and what is known of all its segments since the start.
  type :: facing_side_t
    integer :: n = 0                    !! segments in runs
    integer, allocatable :: segments(:) !! (n_segment of the deck) the first n: their numbers there,
                                        !! rising; else 0
    logical, allocatable :: is_cut(:)   !! (n_segment) the first n: not linked to the one before
    real(wp), allocatable :: depth(:)   !! (n_segment) deepest place that it is faced by, m
    real(wp), allocatable :: caught(:)  !! (n_segment) deepest first contact with it, m
    real(wp), allocatable :: reached(:) !! (n_segment) deepest first contact of its own spots, m
  end type facing_side_t

  !> Both surfaces. The present interface is made of the lists and of the deck's interface.
  type :: facing_t
    logical :: is_used = .false.        !! some chain of the interface is closed
    real(wp) :: next_look = -huge(1.0_wp) !! travel from which on runs may be others
    integer :: n_look = 0               !! looks at who faces whom so far
    integer :: n_change = 0             !! those which found other runs
    type(facing_side_t) :: slave, master
    type(contact_t), allocatable :: present !! with runs for surfaces; nodes are numbered as before
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

end module facing_state_m
