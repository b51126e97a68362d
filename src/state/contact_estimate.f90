! SPDX-License-Identifier: MIT
!> What a run knows of how good its contact is, of one interface: sums over the instants at which it
!> was judged, those that write rows of interfaces or plot states.
module contact_estimate_m
  use kinds_m, only : wp
  implicit none
  private
  public :: contact_estimate_t

  !> Sums and extremes; nothing of time zero, where elements have no stress yet.
  type :: contact_estimate_t
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
  end type contact_estimate_t

end module contact_estimate_m
