! SPDX-License-Identifier: MIT
!> Results of one instant for the output layer: arrays in deck order, rows of the histories and
!> energies. The drivers fill what is due.
module snapshot_m
  use kinds_m, only : wp
  implicit none
  private
  public :: energies_t, total_energy, energy_ratio, snapshot_t, interface_result_t, part_result_t, &
    slave_result_t, wall_result_t, friction_result_t, element_result_t, body_result_t, &
    section_result_t

  !> Round-off in a sum that vanishes, as a share of its largest term: the terms are sums over
  !> nodes, elements and thousands of cycles.
  real(wp), parameter :: round_off = 1.0e-12_wp

  !> Energies at one instant, J per metre of thickness.
  type :: energies_t
    real(wp) :: kinetic = 0.0_wp
    real(wp) :: internal = 0.0_wp
    real(wp) :: hourglass = 0.0_wp
    real(wp) :: viscous = 0.0_wp       !! dissipated by the bulk viscosity
    real(wp) :: damping = 0.0_wp       !! dissipated by global damping
    real(wp) :: contact = 0.0_wp       !! minus the work of contact forces, without friction
    real(wp) :: friction = 0.0_wp      !! dissipated by friction, of interfaces and rigid walls
    real(wp) :: created = 0.0_wp       !! energy created by contact springs, summed over the
                                       !! interfaces that created any; not part of the total
    real(wp) :: external_work = 0.0_wp !! work of loads and prescribed motion
    real(wp) :: eroded(4) = 0.0_wp     !! energy of eroded elements: kinetic, internal, hourglass,
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
    real(wp) :: energy = 0.0_wp  !! minus the work of the contact springs; of tangential springs
                                 !! their stored energy
    real(wp) :: friction = 0.0_wp !! dissipated by friction
    real(wp) :: damping = 0.0_wp !! minus the work of contact damping
    real(wp) :: stored = 0.0_wp  !! potential of the springs
    real(wp) :: estimate = 0.0_wp !! root of sum (p - row stress)^2 a over sum p^2 a
    real(wp) :: row_energy = 0.0_wp !! elastic energy of the elements at loaded segments
    real(wp) :: step_limit = 0.0_wp !! stable step of elements and springs of the interface; 0: not
                                    !! known
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
    real(wp) :: displacement = 0.0_wp  !! along the normal
  end type wall_result_t

  !> One element of the histories.
  type :: element_result_t
    integer :: part = 0                !! user id
    real(wp) :: stress(4) = 0.0_wp     !! xx yy zz xy; of axisymmetric bodies rr zz hoop rz
    real(wp) :: plastic_strain = 0.0_wp
    logical :: is_eroded = .false.     !! the element has eroded
  end type element_result_t

  !> Motion of one rigid body: x and y of its centre of mass, and the rotation about z.
  type :: body_result_t
    real(wp) :: position(2) = 0.0_wp
    real(wp) :: displacement(3) = 0.0_wp
    real(wp) :: velocity(3) = 0.0_wp
    real(wp) :: acceleration(3) = 0.0_wp
  end type body_result_t

  !> Resultants of one cross section: forces of its elements on its nodes.
  type :: section_result_t
    real(wp) :: force(2) = 0.0_wp
    real(wp) :: moment = 0.0_wp    !! about z through the centroid
    real(wp) :: centroid(2) = 0.0_wp
    real(wp) :: area = 0.0_wp      !! length times unit depth; of axisymmetric bodies per radian
  end type section_result_t

  !> Friction at a node of an interface.
  type :: friction_result_t
    real(wp) :: traction = 0.0_wp !! on the node, along the walking direction of its surface
    real(wp) :: slip = 0.0_wp     !! of the node relative to the other side, along the same
                                  !! direction, accumulated over the run
    integer :: state = 0          !! 0 open, 1 stick, 2 slip, 3 tied, 4 broken
  end type friction_result_t

  !> Slave nodes of one interface in walking order; all arrays (n_slave) except the last two.
  type :: slave_result_t
    integer, allocatable :: node(:)        !! node indices
    real(wp), allocatable :: arc_length(:) !! along the slave surface
    real(wp), allocatable :: gap(:)        !! of segments; 0 when unpaired
    real(wp), allocatable :: offset(:)     !! added to the gap where pressure is formed: arcs, entry
    real(wp), allocatable :: pressure(:)   !! normal force over tributary length, 0 where inactive
    real(wp), allocatable :: force(:, :)   !! (2, n_slave) contact force
    real(wp), allocatable :: length(:)     !! tributary length, current
    real(wp), allocatable :: row_stress(:) !! pressure in the elements at the surface, extrapolated
                                           !! to the segment
    real(wp), allocatable :: master_pressure(:) !! (n_master) as `pressure`, of the master nodes
    type(friction_result_t), allocatable :: friction_result(:) !! (n_slave + n_master) nodes of both
                                                               !! sides; allocated with friction
  end type slave_result_t

  !> Results of one instant. Node arrays are in model order (the writer maps through
  !> mesh%deck_node), element arrays in deck order. Arrays are allocated where the deck asks for
  !> them.
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
    real(wp), allocatable :: contact_traction(:) !! (n_node) contact_traction, contact_slip and
                                                 !! contact_state are allocated where an interface
                                                 !! has friction
    real(wp), allocatable :: contact_slip(:)     !! (n_node)
    real(wp), allocatable :: contact_state(:) !! (n_node)
    real(wp) :: mean_velocity(2) = 0.0_wp        !! momentum over mass, of all nodes
    integer :: by_dt2ms = 0                      !! 1: no element has a smaller stable step than
                                                 !! DT2MS
    integer :: slowest(2) = 0                    !! ids of the element that determines the step and
                                                 !! of its part, 0 = none
    integer, allocatable :: supports(:)          !! nodes with a fixed degree of freedom, by rising
                                                 !! id
    real(wp), allocatable :: reaction(:, :)      !! (2, n_support) force of the constraint on the
                                                 !! node
    real(wp), allocatable :: stress(:, :)        !! (6, n_element) xx yy zz xy yz xz
    real(wp), allocatable :: plastic_strain(:)   !! (n_element)
    real(wp), allocatable :: hoop_strain(:)      !! (n_element) of axisymmetric bodies
    real(wp), allocatable :: thickness_strain(:) !! (n_element) of plane stress
    real(wp), allocatable :: error(:)            !! (n_element) energy of the stress error, J/m
    real(wp), allocatable :: temperature(:)      !! (n_element) temperature and damage are allocated
                                                 !! where a material has them
    real(wp), allocatable :: damage(:)           !! (n_element)
    real(wp), allocatable :: eroded(:)           !! (n_element) 1: eroded; allocated where elements
                                                 !! may erode
    type(interface_result_t), allocatable :: interfaces(:)
    type(interface_result_t), allocatable :: transducers(:) !! forces alone
    type(part_result_t), allocatable :: parts(:)
    type(wall_result_t), allocatable :: walls(:) !! allocated where the deck has rigid walls
    type(element_result_t), allocatable :: history_elements(:) !! only where elout is asked for
    type(body_result_t), allocatable :: bodies(:) !! only where rbdout is asked for
    real(wp), allocatable :: boundary_force(:, :) !! (3, n_boundary) x, y and moment about z
    real(wp), allocatable :: boundary_work(:)     !! (n_boundary)
    real(wp), allocatable :: group_force(:, :)    !! (2, nodes of all force groups)
    real(wp), allocatable :: group_work(:)
    type(section_result_t), allocatable :: sections(:) !! only where secforc is asked for
    type(slave_result_t), allocatable :: slaves(:) !! one per interface
  end type snapshot_t

contains

  !> Sum of stored, dissipated and eroded energies; in explicit runs with the leap-frog term, so
  !> that the sum is conserved.
  pure function total_energy(energies) result(total)
    type(energies_t), intent(in) :: energies
    real(wp) :: total

    total = energies%kinetic + energies%internal + energies%hourglass + energies%viscous &
      + energies%damping + energies%contact + energies%leapfrog + energies%friction &
      + sum(energies%eroded)
  end function total_energy

  !> Energy ratio total/(initial + external work); 1 where both vanish to round-off.
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
