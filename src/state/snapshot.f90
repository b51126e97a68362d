! SPDX-License-Identifier: MIT
!> One instant as the output layer sees it: plain arrays in deck order and rows of the histories,
!> and its energies. The drivers fill it, only for what is due.
module snapshot_m
  use kinds_m, only : wp
  implicit none
  private
  public :: energies_t, total_energy, energy_ratio, snapshot_t, interface_result_t, part_result_t, &
    slave_result_t, wall_result_t, friction_result_t, element_result_t, body_result_t, &
    section_result_t

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
    logical :: has_mass_scaling = .false. !! masses are scaled
    real(wp) :: added_mass = 0.0_wp    !! by mass scaling, kg per metre of depth or per radian
    real(wp) :: mass_increase = 0.0_wp !! added mass over that of the densities, %
  end type energies_t

  !> Resultants of one interface.
  type :: interface_result_t
    real(wp) :: slave_force(2) = 0.0_wp
    real(wp) :: master_force(2) = 0.0_wp
    integer :: n_active = 0
    real(wp) :: energy = 0.0_wp  !! minus the work of the contact springs; of tangential ones what
                                 !! they store
    real(wp) :: friction = 0.0_wp !! dissipated by friction
    real(wp) :: damping = 0.0_wp !! minus that of the damping of contact
    real(wp) :: stored = 0.0_wp  !! potential of the springs
    real(wp) :: estimate = 0.0_wp !! root of sum (p - row stress)^2 a over sum p^2 a
    real(wp) :: row_energy = 0.0_wp !! elastic energy of the elements behind what is pressed
    real(wp) :: step_limit = 0.0_wp !! stable step of elements and its springs; 0: none is known
  end type interface_result_t

  !> Sums over one part.
  type :: part_result_t
    real(wp) :: kinetic = 0.0_wp
    real(wp) :: internal = 0.0_wp
    real(wp) :: hourglass = 0.0_wp
    real(wp) :: momentum(2) = 0.0_wp
    real(wp) :: mass = 0.0_wp       !! mass scaling included
    real(wp) :: added_mass = 0.0_wp !! by mass scaling
  end type part_result_t

  !> Resultants of one rigid wall, of the force that acts on the nodes.
  type :: wall_result_t
    real(wp) :: force(2) = 0.0_wp
    real(wp) :: normal_force = 0.0_wp
    real(wp) :: impulse = 0.0_wp
    real(wp) :: work = 0.0_wp
    integer :: n_active = 0
    real(wp) :: tangential_force = 0.0_wp
    real(wp) :: dissipated = 0.0_wp
  end type wall_result_t

  !> One element of the histories.
  type :: element_result_t
    integer :: part = 0                !! user id
    real(wp) :: stress(4) = 0.0_wp     !! xx yy zz xy; of axisymmetric bodies rr zz hoop rz
    real(wp) :: plastic_strain = 0.0_wp
    logical :: is_gone = .false.       !! it has left the mesh
  end type element_result_t

  !> Motion of one rigid body: x and y of its centre of mass, and the turn about z.
  type :: body_result_t
    real(wp) :: place(2) = 0.0_wp
    real(wp) :: displacement(3) = 0.0_wp
    real(wp) :: velocity(3) = 0.0_wp
    real(wp) :: acceleration(3) = 0.0_wp
  end type body_result_t

  !> A cross section: what its elements do to its nodes.
  type :: section_result_t
    real(wp) :: force(2) = 0.0_wp
    real(wp) :: moment = 0.0_wp    !! about z through the centroid
    real(wp) :: centroid(2) = 0.0_wp
    real(wp) :: area = 0.0_wp      !! length times unit depth; of axisymmetric bodies per radian
  end type section_result_t

  !> Friction at a node of an interface.
  type :: friction_result_t
    real(wp) :: traction = 0.0_wp !! on the node, along the walking direction of its chain
    real(wp) :: slip = 0.0_wp     !! of the node over the other side, along that, of the whole run
    integer :: state = 0          !! 0 open, 1 stick, 2 slip, 3 tied, 4 broken
  end type friction_result_t

  !> Slave nodes of one interface in walking order; all arrays (n_slave) but the last two.
  type :: slave_result_t
    integer, allocatable :: node(:)        !! node indices
    real(wp), allocatable :: arc_length(:) !! along the slave chain
    real(wp), allocatable :: gap(:)        !! of segments; 0 when unpaired
    real(wp), allocatable :: offset(:)     !! added to it where pressure is formed: arcs and entry
    real(wp), allocatable :: pressure(:)   !! normal force / competence length, 0 where inactive
    real(wp), allocatable :: force(:, :)   !! (2, n_slave) contact force from all points
    real(wp), allocatable :: length(:)     !! competence length, current
    real(wp), allocatable :: row_stress(:) !! pressure of the elements behind, carried to the face
    real(wp), allocatable :: master_pressure(:) !! (n_master) as `pressure`, on the other side
    type(friction_result_t), allocatable :: friction_result(:) !! (n_slave + n_master) nodes of both
                                                               !! sides; only where there is
                                                               !! friction
  end type slave_result_t

  !> The instant. Node arrays are in model order (the writer maps through mesh%deck_node); element
  !> arrays in deck order. Arrays that nothing in the deck asks for are not there.
  type :: snapshot_t
    real(wp) :: time = 0.0_wp
    real(wp) :: dt = 0.0_wp
    integer :: cycle = 0
    type(energies_t) :: energies
    real(wp), allocatable :: displacement(:, :)  !! (2, n_node)
    real(wp), allocatable :: velocity(:, :)      !! (2, n_node) at the same instant as displacement
    real(wp), allocatable :: acceleration(:, :)  !! (2, n_node)
    real(wp), allocatable :: contact_force(:, :) !! (2, n_node)
    real(wp), allocatable :: contact_pressure(:) !! (n_node)
    real(wp), allocatable :: gap(:)              !! (n_node)
    real(wp), allocatable :: contact_traction(:) !! (n_node), this and the next two only where some
    real(wp), allocatable :: contact_slip(:)     !! interface has friction
    real(wp), allocatable :: contact_state(:)
    real(wp) :: mean_velocity(2) = 0.0_wp        !! momentum over mass, of all nodes
    integer :: by_dt2ms = 0                      !! 1: no element has a smaller step than DT2MS
    integer :: slowest(2) = 0                    !! ids of the element that rules the step and of
                                                 !! its part, 0 = none
    integer, allocatable :: supports(:)          !! nodes with a fixed degree of freedom, by rising
                                                 !! id
    real(wp), allocatable :: reaction(:, :)      !! (2, n_support) force of the constraint on the
                                                 !! node
    real(wp), allocatable :: stress(:, :)        !! (6, n_element) xx yy zz xy yz xz
    real(wp), allocatable :: plastic_strain(:)   !! (n_element)
    real(wp), allocatable :: hoop_strain(:)      !! (n_element) of axisymmetric bodies
    real(wp), allocatable :: temperature(:)      !! (n_element) this and the next only where some
    real(wp), allocatable :: damage(:)           !! material keeps them
    real(wp), allocatable :: eroded(:)           !! (n_element) 1: has left the mesh; only where
                                                 !! elements may
    type(interface_result_t), allocatable :: interfaces(:)
    type(interface_result_t), allocatable :: transducers(:) !! forces alone; only where the deck has
                                                 !! any
    type(part_result_t), allocatable :: parts(:)
    type(wall_result_t), allocatable :: walls(:) !! only where the deck has any
    type(element_result_t), allocatable :: history_elements(:) !! only where elout is asked for
    type(body_result_t), allocatable :: bodies(:) !! only where rbdout is asked for
    real(wp), allocatable :: boundary_force(:, :) !! (3, n_boundary) x, y and moment about z
    real(wp), allocatable :: boundary_work(:)     !! (n_boundary)
    real(wp), allocatable :: group_force(:, :)    !! (2, nodes of all force groups)
    real(wp), allocatable :: group_work(:)
    type(section_result_t), allocatable :: sections(:) !! only where secforc is asked for
    type(slave_result_t), allocatable :: slaves(:) !! one per interface, then per contact behind a
                                                 !! tie
  end type snapshot_t

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
    noise = round_off*maxval(abs([energies%kinetic, energies%internal, energies%hourglass, &
      energies%viscous, energies%damping, energies%contact, energies%friction, energies%leapfrog, &
      energies%external_work, energies%initial, energies%eroded]))
    if (abs(expected) <= noise .and. abs(total) <= noise) then
      ratio = 1.0_wp
    else if (abs(expected) > 0.0_wp) then
      ratio = total/expected
    else
      ratio = huge(1.0_wp)
    end if
  end function energy_ratio

end module snapshot_m
