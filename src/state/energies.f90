! SPDX-License-Identifier: MIT
!> The energy account of one instant and its balance.
module energies_m
  use kinds_m, only : wp
  implicit none
  private
  public :: energies_t, total_energy, energy_ratio

  !> What rounding leaves of a sum that vanishes, as a share of its largest term: terms are sums
  !> over nodes, elements and thousands of cycles.
  real(wp), parameter :: round_off = 1.0e-12_wp

  !> Energies at one instant, J per metre of thickness.
  type :: energies_t
    real(wp) :: kinetic = 0.0_wp
    real(wp) :: internal = 0.0_wp
    real(wp) :: hourglass = 0.0_wp
    real(wp) :: viscous = 0.0_wp       !! dissipated by the bulk viscosity
    real(wp) :: damping = 0.0_wp       !! dissipated by global damping
    real(wp) :: contact = 0.0_wp       !! minus the work of the contact forces, but for the next
    real(wp) :: friction = 0.0_wp      !! dissipated by friction, of interfaces and rigid walls
    real(wp) :: made = 0.0_wp          !! what contact springs gave beyond what they took, over the
                                       !! interfaces where they did; no part of the sum
    real(wp) :: external_work = 0.0_wp !! work of loads and prescribed motion
    real(wp) :: eroded(4) = 0.0_wp     !! what went with elements: kinetic, internal, hourglass,
                                       !! contact springs
    real(wp) :: leapfrog = 0.0_wp      !! v(n-1/2).M v(n+1/2)/2 minus the kinetic energy, in
                                       !! explicit runs
    real(wp) :: initial = 0.0_wp       !! total at time zero
    logical :: tells_mass = .false.    !! masses are scaled
    real(wp) :: added_mass = 0.0_wp    !! by mass scaling, kg per metre of depth or per radian
    real(wp) :: mass_increase = 0.0_wp !! added mass over that of the densities, %
  end type energies_t

contains

  !> Sum of all that the body holds and has dissipated; in explicit runs what leap-frog keeps.
  pure function total_energy(energies) result(total)
    type(energies_t), intent(in) :: energies
    real(wp) :: total

    total = energies%kinetic + energies%internal + energies%hourglass + energies%viscous &
      + energies%damping + energies%contact + energies%leapfrog + energies%friction &
      + sum(energies%eroded)
  end function total_energy

  !> total / (initial + external work); 1 when both vanish against the terms that they are sums of.
  pure function energy_ratio(energies) result(ratio)
    type(energies_t), intent(in) :: energies
    real(wp) :: ratio
    real(wp) :: expected, total, noise

    expected = energies%initial + energies%external_work
    total = total_energy(energies)
    noise = round_off*largest_term(energies)
    if (abs(expected) <= noise .and. abs(total) <= noise) then
      ratio = 1.0_wp
    else if (abs(expected) > 0.0_wp) then
      ratio = total/expected
    else
      ratio = huge(1.0_wp)
    end if
  end function energy_ratio

  !> The largest of all terms by size.
  pure function largest_term(energies) result(largest)
    type(energies_t), intent(in) :: energies
    real(wp) :: largest

    largest = maxval(abs([energies%kinetic, energies%internal, energies%hourglass, &
      energies%viscous, energies%damping, energies%contact, energies%friction, energies%leapfrog, &
      energies%external_work, energies%initial, energies%eroded]))
  end function largest_term

end module energies_m
