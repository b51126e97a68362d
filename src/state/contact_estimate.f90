! SPDX-License-Identifier: MIT
!> What a run knows of how good its contact is, of one interface: sums over the instants at which it
!> was judged, those that write rows of interfaces or plot states.
module contact_estimate_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: contact_estimate_t

  !> Sums and extremes; nothing of time zero, where elements have no stress yet.
  type, extends(visited_t) :: contact_estimate_t
    integer :: cycle = 0               !! of the last instant
    integer :: stride = 0              !! cycles between that one and the one before
    integer :: n = 0                   !! instants
    real(wp) :: misfit = 0.0_wp        !! sum of (p - row stress)^2 a
    real(wp) :: load = 0.0_wp          !! sum of p^2 a
    real(wp) :: still = 0.0_wp         !! as `misfit`, less the inertia of the rows
    real(wp) :: heaviest = 0.0_wp      !! largest p^2 a of an instant
    real(wp) :: at_heaviest = 0.0_wp   !! estimate then
    real(wp) :: springs = 0.0_wp       !! sum of what springs store, J/m
    real(wp) :: rows = 0.0_wp          !! sum of the elastic energy of the rows behind, J/m
    real(wp) :: force(2) = 0.0_wp      !! on the slave at the last instant, N/m
    real(wp) :: former(2) = 0.0_wp     !! at the one before
    real(wp) :: jumps = 0.0_wp         !! sum of squares of second differences of that
                                       !! force, as of equal strides
    real(wp) :: forces = 0.0_wp        !! sum of its squares over the same instants
    real(wp) :: least_margin = huge(1.0_wp) !! smallest of stable step over step
    real(wp) :: softness = 0.0_wp      !! of springs, over that of a row of elements on either side
    real(wp) :: stored = 0.0_wp        !! largest energy of the springs, J/m
    real(wp) :: bodies = 0.0_wp        !! largest internal energy of the bodies on both sides, J/m
    real(wp) :: penetration = 0.0_wp   !! deepest one of curved places, their flattening
                                       !! included, m
    real(wp) :: facet_error = 0.0_wp   !! by which facets put gaps off there, m
    real(wp) :: arc_height = 0.0_wp    !! of the highest arc over its segment there, m
    real(wp) :: arc_curvature = 0.0_wp !! of that arc, 1/m
    integer :: arc_side = 0            !! it is on: 1 slave, 2 master
  contains
    procedure :: visit => visit_estimate
  end type contact_estimate_t

contains

  !> Its components.
  subroutine visit_estimate(self, visitor)
    class(contact_estimate_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('cycle', self%cycle)
    call visitor%visit('stride', self%stride)
    call visitor%visit('n', self%n)
    call visitor%visit('misfit', self%misfit)
    call visitor%visit('load', self%load)
    call visitor%visit('still', self%still)
    call visitor%visit('heaviest', self%heaviest)
    call visitor%visit('at_heaviest', self%at_heaviest)
    call visitor%visit('springs', self%springs)
    call visitor%visit('rows', self%rows)
    call visitor%fixed('force', self%force)
    call visitor%fixed('former', self%former)
    call visitor%visit('jumps', self%jumps)
    call visitor%visit('forces', self%forces)
    call visitor%visit('least_margin', self%least_margin)
    call visitor%visit('softness', self%softness)
    call visitor%visit('stored', self%stored)
    call visitor%visit('bodies', self%bodies)
    call visitor%visit('penetration', self%penetration, 0.0_wp, 'a number below zero')
    call visitor%visit('facet_error', self%facet_error)
    call visitor%visit('arc_height', self%arc_height)
    call visitor%visit('arc_curvature', self%arc_curvature)
    call visitor%visit('arc_side', self%arc_side)
  end subroutine visit_estimate

end module contact_estimate_m
