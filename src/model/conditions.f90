! SPDX-License-Identifier: MIT
!> Constraints, loads and initial values; sets are resolved to nodes.
module conditions_m
  use, intrinsic :: iso_c_binding, only : c_loc
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, absent, length, of_nodes
  implicit none
  private
  public :: conditions_t, prescribed_motion_t, nodal_load_t, pressure_load_t, &
    damping_t, part_damping_t, lumped_mass_t, common_motion_t, skew_support_t, motion_velocity, &
    motion_acceleration, motion_displacement

  !> Kind of a prescribed motion (VAD of *BOUNDARY_PRESCRIBED_MOTION).
  integer, parameter :: motion_velocity = 0, motion_acceleration = 1, motion_displacement = 2

  !> Motion of one degree of freedom of one node.
  type :: prescribed_motion_t
    integer :: node = 0               !! node index
    integer :: direction = 1          !! 1 x, 2 y
    integer :: kind = motion_velocity !! one of the `motion_` constants
    integer :: curve = 0              !! index into model%curves
    real(wp) :: scale = 1.0_wp        !! factor on the ordinate
    real(wp) :: birth = 0.0_wp        !! active from this time
    real(wp) :: death = 1.0e28_wp     !! active until this time
  end type prescribed_motion_t

  !> Force on one degree of freedom of one node.
  type :: nodal_load_t
    integer :: node = 0
    integer :: direction = 1
    integer :: curve = 0
    real(wp) :: scale = 1.0_wp
  end type nodal_load_t

  !> Pressure on one edge, positive against the outward normal. The edge runs counter-clockwise
  !> about its body.
  type :: pressure_load_t
    integer :: nodes(2) = 0
    integer :: curve = 0
    real(wp) :: scale = 1.0_wp
    real(wp) :: arrival = 0.0_wp !! AT: start time of the load and of its curve
  end type pressure_load_t

  !> *DAMPING_GLOBAL: f = -D m v, factor per direction.
  type :: damping_t
    integer :: curve = 0                !! index of the curve of D(t), 0 = constant
    real(wp) :: coefficient = 0.0_wp    !! D where there is no curve
    real(wp) :: factor(2) = 1.0_wp      !! STX, STY
  end type damping_t

  !> *DAMPING_PART_MASS: f = -D m v on the masses of one part.
  type :: part_damping_t
    integer :: part = 0                 !! index
    integer :: curve = 0                !! index of the curve of D(t)
    real(wp) :: scale = 1.0_wp          !! SF
    real(wp) :: factor(2) = 1.0_wp      !! STX, STY
  end type part_damping_t

  !> *ELEMENT_MASS: mass on one node, no element.
  type :: lumped_mass_t
    integer :: node = 0
    real(wp) :: mass = 0.0_wp           !! kg per metre of depth or per radian
  end type lumped_mass_t

  !> *CONSTRAINED_NODE_SET: nodes with equal translations in x, y or both.
  type, extends(visited_t) :: common_motion_t
    integer, allocatable :: nodes(:)
    logical :: along(2) = .false.
  contains
    procedure :: visit => visit_common_motion
  end type common_motion_t

  !> A node that is fixed in a direction other than x and y.
  type :: skew_support_t
    integer :: node = 0
    real(wp) :: normal(2) = 0.0_wp      !! unit vector of the fixed direction
  end type skew_support_t

  !> All conditions of a model; optional ones are allocated only where the deck has them.
  type, extends(visited_t) :: conditions_t
    integer, allocatable :: fixed_nodes(:)      !! nodes with a fixed degree of freedom ...
    integer, allocatable :: fixed_directions(:) !! ... and its direction, each pair once
    integer :: n_support = 0                    !! constrained nodes with mass, after renumbering
    type(prescribed_motion_t), allocatable :: motions(:)
    type(prescribed_motion_t), allocatable :: rigid_motions(:) !! of rigid bodies: `node` is the
                                                               !! body, direction 3 its rotation
    type(nodal_load_t), allocatable :: nodal_loads(:)
    type(pressure_load_t), allocatable :: pressures(:)
    type(nodal_load_t), allocatable :: body_loads(:)  !! base acceleration (*LOAD_BODY_X, _Y): the
                                                      !! load is minus the curve; `node` unused
    type(damping_t), allocatable :: damping
    type(part_damping_t), allocatable :: part_damping(:)
    type(lumped_mass_t), allocatable :: lumped_masses(:)
    type(common_motion_t), allocatable :: common_motions(:)
    type(skew_support_t), allocatable :: skew_supports(:)
    type(nodal_load_t), allocatable :: rigid_loads(:) !! on rigid bodies: `node` is the body,
                                                      !! direction 3 the moment
    real(wp), allocatable :: initial_velocity(:, :)   !! (2, n_node)
  contains
    procedure :: visit => visit_conditions
  end type conditions_t

contains

  !> Visit the components of a common motion.
  subroutine visit_common_motion(self, visitor)
    class(common_motion_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('nodes', self%nodes)
    call visitor%plain(c_loc(self%along), storage_size(self%along), size(self%along))
  end subroutine visit_common_motion

  !> Visit the components of the conditions.
  subroutine visit_conditions(self, visitor)
    class(conditions_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n_support', self%n_support)
    call visitor%visit('fixed_nodes', self%fixed_nodes)
    call visitor%visit('fixed_directions', self%fixed_directions)
    if (visitor%makes(length(self%motions))) allocate (self%motions(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%motions(1)), storage_size(self%motions), visitor%n_item)
    if (visitor%makes(length(self%rigid_motions))) allocate (self%rigid_motions(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%rigid_motions(1)), storage_size(self%rigid_motions), &
        visitor%n_item)
    if (visitor%makes(length(self%nodal_loads))) allocate (self%nodal_loads(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%nodal_loads(1)), storage_size(self%nodal_loads), visitor%n_item)
    if (visitor%makes(length(self%pressures))) allocate (self%pressures(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%pressures(1)), storage_size(self%pressures), visitor%n_item)
    if (visitor%makes(length(self%body_loads))) allocate (self%body_loads(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%body_loads(1)), storage_size(self%body_loads), visitor%n_item)
    if (visitor%makes(merge(1, absent, allocated(self%damping)))) allocate (self%damping)
    if (allocated(self%damping)) &
      call visitor%plain(c_loc(self%damping), storage_size(self%damping), 1)
    if (visitor%makes(length(self%part_damping))) allocate (self%part_damping(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%part_damping(1)), storage_size(self%part_damping), &
        visitor%n_item)
    if (visitor%makes(length(self%lumped_masses))) allocate (self%lumped_masses(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%lumped_masses(1)), storage_size(self%lumped_masses), &
        visitor%n_item)
    if (visitor%makes(length(self%common_motions))) allocate (self%common_motions(visitor%n_item))
    call visitor%each('common_motions', self%common_motions)
    if (visitor%makes(length(self%skew_supports))) allocate (self%skew_supports(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%skew_supports(1)), storage_size(self%skew_supports), &
        visitor%n_item)
    if (visitor%makes(length(self%rigid_loads))) allocate (self%rigid_loads(visitor%n_item))
    if (visitor%n_item > 0) &
      call visitor%plain(c_loc(self%rigid_loads(1)), storage_size(self%rigid_loads), visitor%n_item)
    call visitor%visit('initial_velocity', self%initial_velocity, of_nodes)
  end subroutine visit_conditions

end module conditions_m
