! SPDX-License-Identifier: MIT
!> What one interface remembers from step to step, and the common list of contact points.
!>
!> A contact point is the only thing that a formulation makes. Whoever places points promises:
!> P1: the weights sum to one on each side;
!> P2: x_slave - x_master = gap * normal, with positions taken by those weights, normal pointing from
!>     master to slave and gap < 0 in penetration (type 4 keeps P2 up to a parallel shift only).
!> Balance of momentum follows from P1, balance of angular momentum from P2.
module contact_state_m
  use kinds_m, only : wp
  implicit none
  private
  public :: contact_state_t, contact_points_t, allocate_points, n_side, &
    pressure_at_point, pressure_at_nodes

  !> Nodes of a side of a contact point (2-node segments).
  integer, parameter :: n_side = 2
  !> Where the pressure is formed: from the gap of each point, or averaged at the slave nodes.
  integer, parameter :: pressure_at_point = 1, pressure_at_nodes = 2

  !> The list, one column per point; node numbers are local to the interface:
  !> 1 .. n_slave for slave nodes, n_slave + 1 .. n_slave + n_master for master nodes.
  type :: contact_points_t
    integer :: n = 0                           !! points in use
    integer :: pressure_rule = pressure_at_point
    integer, allocatable :: slave_nodes(:, :)  !! (n_side, capacity)
    real(wp), allocatable :: slave_weights(:, :)
    integer, allocatable :: master_nodes(:, :)
    real(wp), allocatable :: master_weights(:, :)
    real(wp), allocatable :: normal(:, :)      !! (2, capacity) unit, from master to slave
    real(wp), allocatable :: gap(:)            !! m, negative = penetration
    real(wp), allocatable :: area(:)           !! m (1 for type 1)
    real(wp), allocatable :: stiffness(:)      !! N/m^2 (N/m for type 1)
    real(wp), allocatable :: pressure(:)       !! N/m (N for type 1), >= 0
  end type contact_points_t

  !> Memory of one interface. Positions of nodes, forces and results are by local number.
  type :: contact_state_t
    integer :: n_slave = 0, n_master = 0
    integer, allocatable :: nodes(:)       !! (n_slave + n_master) node indices in the mesh
    integer, allocatable :: pair(:)        !! (n_slave) master segment a slave node is on, 0 = none
    integer, allocatable :: master_pair(:) !! (n_master) the same for the master pass of two-pass types
    integer :: next_search = 0             !! cycle at which the next global search is due
    type(contact_points_t) :: points
    real(wp), allocatable :: force(:, :)   !! (2, n_slave + n_master) contact forces of the last call
    real(wp) :: slave_penalty = 0.0_wp     !! distributed penalty eps_hat of the slave pass, N/m^2
    real(wp) :: master_penalty = 0.0_wp    !! of the master pass
    real(wp) :: node_penalty = 0.0_wp      !! eps of type 1, N/m
    real(wp) :: energy = 0.0_wp            !! minus the accumulated work of the contact forces
    integer :: n_active = 0                !! points that carry pressure
    integer :: n_released = 0              !! first contacts deeper than the limit that were let go
  end type contact_state_t

contains

  !> Allocate the list for at most `capacity` points, so that nothing is allocated in the step.
  pure subroutine allocate_points(points, capacity)
    type(contact_points_t), intent(inout) :: points
    integer, intent(in) :: capacity

    allocate (points%slave_nodes(n_side, capacity), points%master_nodes(n_side, capacity), source=1)
    allocate (points%slave_weights(n_side, capacity), points%master_weights(n_side, capacity), &
      points%normal(2, capacity), source=0.0_wp)
    allocate (points%gap(capacity), points%area(capacity), points%stiffness(capacity), &
      points%pressure(capacity), source=0.0_wp)
  end subroutine allocate_points

end module contact_state_m
