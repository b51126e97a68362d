! SPDX-License-Identifier: MIT
!> State of an interface from step to step, and the common list of contact points.
!>
!> A contact point is the only thing that a formulation makes. All points satisfy:
!> P1: the weights sum to one on each side;
!> P2: x_slave - x_master = gap * normal, with positions taken by those weights, normal pointing
!>     from master to slave and gap < 0 in penetration.
!> Balance of momentum follows from P1, balance of angular momentum from P2.
!>
!> Node numbers here are local to the interface: 1 .. n_slave for slave nodes, then
!> n_slave + 1 .. n_slave + n_master for master nodes. A position is (X, Y, u_x, u_y), X and Y
!> relative to the first slave node, so that positions between nodes lose no digit far from the
!> origin; in axisymmetry X is the radius itself.
module contact_state_m
  use law_state_m, only : contact_monitor_t, energy_limit_t, friction_memory_t, &
    interference_memory_t, tie_memory_t
  use kinds_m, only : wp
  use search_state_m, only : candidates_t, contact_status_t, segment_points_t, segment_status_t, &
    segment_point_at
  use visitor_m, only : visited_t, visitor_t, any_length
  implicit none
  private
  public :: contact_state_t, contact_points_t, contact_scratch_t, arcs_t, arc_shape_t, flat_arc, &
    features_t, &
    allocate_points, allocate_damping, allocate_tractions, make_room, move_point, &
    allocate_scratch, exchange, n_side, n_sites, n_springs, site_at, has_offsets

  !> Nodes of a side of a contact point (2-node segments).
  integer, parameter :: n_side = 2
  !> The list, one column per point.
  type, extends(visited_t) :: contact_points_t
    integer :: n = 0                           !! points in use
    integer, allocatable :: slave_nodes(:, :)  !! (n_side, capacity) local numbers
    real(wp), allocatable :: slave_weights(:, :)
    integer, allocatable :: master_nodes(:, :) !! (n_side, capacity) local numbers
    real(wp), allocatable :: master_weights(:, :)
    real(wp), allocatable :: normal(:, :)      !! (2, capacity) unit, from master to slave
    real(wp), allocatable :: gap(:)            !! m, negative = penetration
    real(wp), allocatable :: area(:)           !! m (1 for type 1)
    real(wp), allocatable :: stiffness(:)      !! N/m^2 (N/m for type 1)
    real(wp), allocatable :: pressure(:)       !! N/m (N for type 1): what acts; >= 0 but in ties
    real(wp), allocatable :: damping(:)        !! the part of the pressure that damping has; only
                                               !! where there is damping
    real(wp), allocatable :: traction(:)       !! as pressure, along -(-n_y, n_x) on the slave side;
                                               !! only where there is friction or a tie
  contains
    procedure :: visit => visit_points
  end type contact_points_t

  !> Room that procedures use within a step; nothing in it lasts to the next one.
  type :: contact_scratch_t
    real(wp), allocatable :: previous_force(:, :) !! (2, n_slave + n_master) forces of the call
                                            !! before, 0 between calls
    real(wp), allocatable :: nodal(:, :)    !! (2, n_slave + n_master) averaged gaps, springs at
                                            !! nodes
    real(wp), allocatable :: velocity(:, :) !! (2, n_slave + n_master) of this call; only where
                                            !! forces are limited
    real(wp), allocatable :: spring(:, :)   !! (2, n_slave + n_master) forces of the normal springs
                                            !! alone; only where there are others
    real(wp), allocatable :: previous_spring(:, :) !! the same of the call before
    real(wp), allocatable :: increment(:, :) !! (2, n_slave + n_master) displacements of the
                                            !! step, m
    real(wp) :: dt = 0.0_wp                 !! step that made them, s; only in implicit runs
    real(wp) :: lag = 0.0_wp                !! damping of tangential springs that stick over their
                                            !! stiffness, s
    real(wp), allocatable :: previous_traction(:) !! (n_site) of the call before; this and the next
                                            !! only where there is friction
    integer, allocatable :: previous_state(:) !! (n_site) the same
    real(wp), allocatable :: at_sites(:)    !! (n_site) areas of points so far, m, or tractions at
                                            !! slave nodes, N/m^2; only where there is friction
    real(wp) :: ramp_step = 0.0_wp          !! of an initial overlap in this step, as a part of it
    logical :: is_start = .false.           !! this call is that of time zero; both only where such
                                            !! overlaps grow
    type(contact_points_t), allocatable :: parts(:) !! points of ranges of slave segments, which
                                            !! threads share
    logical :: waits = .false.              !! points are generated, forces follow once all others
                                            !! are known
    logical :: had_force = .false.          !! the call before had some, not of ties
    logical :: is_born = .false.            !! contact begins in this call, after time zero
    integer :: n_freed = 0                  !! sites that no tie holds any more since this call
    logical, allocatable :: is_freed(:)     !! (n_site) which; only where ties break
  end type contact_scratch_t

  !> Shape of an arc over its secant: the sine of its angle to the secant is
  !> bend (1/2 - xi) + skew (1 - 6 xi (1 - xi)): normals of neighbours meet at their node.
  type :: arc_shape_t
    real(wp) :: bend !! kappa L
    real(wp) :: skew
  end type arc_shape_t

  !> Shape of a flat segment.
  type(arc_shape_t), parameter :: flat_arc = arc_shape_t(0.0_wp, 0.0_wp)

  !> Arcs that segments stand for, by the initial mesh; a restart finds them again.
  type :: arcs_t
    real(wp), allocatable :: share(:, :)  !! (2, n_slave + n_master) parts of the turns at both ends
                                          !! of the segment that starts at a node, which its arc
                                          !! has; 0: flat
    real(wp), allocatable :: turn(:)      !! (n_slave + n_master) tangent of half the turn at a node
                                          !! at time zero, above 0 where the body is convex
    integer, allocatable :: beside(:, :)  !! (2, n_slave + n_master) nodes before and behind, or 0
    real(wp), allocatable :: height(:)    !! (n_slave + n_master) how far an arc may stand off its
                                          !! segment, m: gaps below that make contact points
    real(wp) :: highest = 0.0_wp          !! of both sides together, m
    integer, allocatable :: around(:, :)  !! (4, n_slave + n_master) nodes of a curved segment by
                                          !! its first node, amid those beside; its own twice at the
                                          !! end of an open surface
    type(arc_shape_t), allocatable :: shape(:) !! (n_slave + n_master) of the segment that starts at
                                          !! a node, in this call, where points are on it
    integer, allocatable :: formed_in(:)  !! (n_slave + n_master) call that has formed it last; huge
                                          !! where it is flat
    integer :: call = 0                   !! number of calls that have formed shapes
  end type arcs_t

  !> What an interface has beside springs along the normal at its points: by its formulation and by
  !> the deck.
  type :: features_t
    logical :: segment_points = .false. !! points between nodes are followed
    logical :: virtual_nodes = .false.  !! these carry springs, with several points on the list
    logical :: overlaps = .false.       !! points are made of overlaps of segments
    logical :: nodal_pressure = .false. !! pressure is formed at slave nodes
    logical :: unit_area = .false.      !! the penalty is N/m per node, pressures are forces
    logical :: damping = .false.
    logical :: friction = .false.
    logical :: interference = .false.   !! initial overlaps grow
    logical :: contact = .false.        !! sites that no tie holds are in contact
    logical :: ties = .false.           !! it is tied
    logical :: breaks = .false.         !! ties break
    logical :: limit = .false.          !! its energy is limited
    logical :: entry_offsets = .false.  !! pressure acts from gap + entry offset
    logical :: arcs = .false.           !! segments stand for arcs
  end type features_t

  !> Memory of one interface.
  type, extends(visited_t) :: contact_state_t
    type(features_t) :: has
    integer :: n_slave = 0, n_master = 0
    integer, allocatable :: nodes(:)        !! (n_slave + n_master) node indices in the mesh
    real(wp), allocatable :: positions(:, :) !! (4, n_slave + n_master) X, Y, u_x, u_y of the last
                                            !! call
    real(wp) :: travel = 0.0_wp             !! bound on relative motion since the start, m
    real(wp) :: advance = 0.0_wp            !! bound on relative motion in the last step, m
    logical :: is_stale = .false.           !! contact status has been left alone outside birth ..
                                            !! death
    integer :: next_listing = 0             !! cycle at which FREQ asks for a global search
    type(segment_points_t) :: segment_points !! of the slave
    type(contact_status_t) :: slave_status  !! slave nodes, or `segment_points`, over the master
                                            !! surface
    type(contact_status_t) :: master_status !! master nodes over the slave surface; empty for one
                                            !! pass
    type(candidates_t) :: candidates        !! of slave segments
    real(wp) :: listed_until = -huge(1.0_wp) !! travel for which these hold, m
    type(candidates_t) :: reversed          !! of master segments: the same pairs; for two passes
    type(segment_status_t) :: segments      !! of the slave
    type(arcs_t) :: arcs                    !! of curved segments; only where these are smoothed
    type(contact_points_t), allocatable :: points !! of contact
    type(contact_points_t) :: tie_points    !! of ties: placed in the reference geometry, and frozen
    real(wp) :: closed_gap = 0.0_wp         !! gaps below it are contact, m; more than 0 only where
                                            !! a tangent of touching bodies is wanted
    real(wp), allocatable :: node_pressure(:) !! (n_slave) where pressure is formed at slave nodes,
                                            !! N/m
    real(wp), allocatable :: force(:, :)    !! (2, n_slave + n_master) contact forces of the last
                                            !! call
    integer :: contact_law = 0              !! from gap to pressure, a number of contact_law_m
    real(wp) :: slave_penalty = 0.0_wp      !! distributed penalty eps_hat of the slave pass, N/m^2
    real(wp) :: master_penalty = 0.0_wp     !! of the master pass
    real(wp) :: node_penalty = 0.0_wp       !! eps of type 1, N/m
    real(wp), allocatable :: damping_force(:, :) !! (2, n_slave + n_master) the part of `force` that
                                                 !! damping has; only where there is damping
    real(wp) :: energy = 0.0_wp             !! minus the accumulated work of the springs, those of
                                            !! ties included, J/m
    real(wp) :: damping_work = 0.0_wp       !! minus that of the damping forces
    type(friction_memory_t) :: friction     !! of sites, and its forces
    type(interference_memory_t) :: interference !! initial overlaps that grow
    type(tie_memory_t) :: ties              !! springs of a tied interface
    type(contact_monitor_t) :: monitor      !! whether the springs give back what they take
    type(energy_limit_t) :: limit           !! that they give back no more
    integer :: n_active = 0                 !! points of contact that carry pressure
    logical :: rules_step = .false.         !! default penalty and step: the step obeys the springs
    type(contact_scratch_t) :: scratch
  contains
    procedure :: visit => visit_contact
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

  !> The column of damping, for a list that is allocated.
  pure subroutine allocate_damping(points)
    type(contact_points_t), intent(inout) :: points

    allocate (points%damping(size(points%gap)), source=0.0_wp)
  end subroutine allocate_damping

  !> The column of tractions, for a list that is allocated.
  pure subroutine allocate_tractions(points)
    type(contact_points_t), intent(inout) :: points

    allocate (points%traction(size(points%gap)), source=0.0_wp)
  end subroutine allocate_tractions

  !> Make room for `n_more` points. The capacity of the start serves surfaces that are opposed
  !> once; only where slave segments lie upon each other is more needed, and the list then doubles.
  pure subroutine make_room(points, n_more)
    type(contact_points_t), intent(inout) :: points
    integer, intent(in) :: n_more
    type(contact_points_t) :: larger
    integer :: n

    if (points%n + n_more <= size(points%gap)) return
    n = points%n
    call allocate_points(larger, 2*(n + n_more))
    larger%n = n
    larger%slave_nodes(:, :n) = points%slave_nodes(:, :n)
    larger%slave_weights(:, :n) = points%slave_weights(:, :n)
    larger%master_nodes(:, :n) = points%master_nodes(:, :n)
    larger%master_weights(:, :n) = points%master_weights(:, :n)
    larger%normal(:, :n) = points%normal(:, :n)
    larger%gap(:n) = points%gap(:n)
    larger%area(:n) = points%area(:n)
    larger%stiffness(:n) = points%stiffness(:n)
    larger%pressure(:n) = points%pressure(:n)
    if (allocated(points%damping)) then
      call allocate_damping(larger)
      larger%damping(:n) = points%damping(:n)
    end if
    if (allocated(points%traction)) then
      call allocate_tractions(larger)
      larger%traction(:n) = points%traction(:n)
    end if
    points = larger
  end subroutine make_room

  !> Move a point on the list.
  pure subroutine move_point(from, to, points)
    integer, intent(in) :: from, to
    type(contact_points_t), intent(inout) :: points

    points%slave_nodes(:, to) = points%slave_nodes(:, from)
    points%slave_weights(:, to) = points%slave_weights(:, from)
    points%master_nodes(:, to) = points%master_nodes(:, from)
    points%master_weights(:, to) = points%master_weights(:, from)
    points%gap(to) = points%gap(from)
    points%normal(:, to) = points%normal(:, from)
    points%area(to) = points%area(from)
    points%stiffness(to) = points%stiffness(from)
  end subroutine move_point

  !> Allocate the room of an interface; after a restart too.
  pure subroutine allocate_scratch(memory)
    type(contact_state_t), intent(inout) :: memory

    associate (scratch => memory%scratch, n => memory%n_slave + memory%n_master)
      allocate (scratch%previous_force(2, n), scratch%nodal(2, n), scratch%increment(2, n), &
        source=0.0_wp)
      if (memory%has%limit) allocate (scratch%velocity(2, n), source=0.0_wp)
      if (memory%has%limit .and. (memory%has%damping .or. memory%has%friction &
        .or. memory%has%ties)) &
        allocate (scratch%spring(2, n), scratch%previous_spring(2, n), source=0.0_wp)
      if (memory%has%breaks) allocate (scratch%is_freed(n_sites(memory)), source=.false.)
      if (memory%has%friction) then
        allocate (scratch%previous_traction(size(memory%friction%state)), &
          scratch%at_sites(size(memory%friction%state)), source=0.0_wp)
        allocate (scratch%previous_state(size(memory%friction%state)), source=0)
      end if
    end associate
  end subroutine allocate_scratch

  !> Exchange two lists of nodal values without a copy.
  pure subroutine exchange(one, other)
    real(wp), allocatable, intent(inout) :: one(:, :), other(:, :)
    real(wp), allocatable :: spare(:, :)

    call move_alloc(one, spare)
    call move_alloc(other, one)
    call move_alloc(spare, other)
  end subroutine exchange

  !> Springs of contact: slave nodes where pressure is formed there, else points.
  pure function n_springs(memory) result(n)
    type(contact_state_t), intent(in) :: memory
    integer :: n

    n = merge(memory%n_slave, memory%points%n, memory%has%nodal_pressure)
  end function n_springs

  !> Sites that laws remember: slave nodes, or virtual nodes, and master nodes.
  pure function n_sites(memory) result(n)
    type(contact_state_t), intent(in) :: memory
    integer :: n

    n = memory%n_master + merge(memory%slave_status%n, memory%n_slave, memory%has%virtual_nodes)
  end function n_sites

  !> The site of a point of one of the lists: the virtual node or Gauss point that the search
  !> follows, or a node, slave or master.
  pure function site_at(memory, points, p) result(site)
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: p
    integer :: site

    site = points%slave_nodes(1, p)
    if (memory%has%segment_points) then
      site = size(memory%segment_points%xi)*(memory%slave_status%pass%segment_at(site) - 1) &
        + segment_point_at(points%slave_weights(2, p), memory%segment_points%xi)
    else if (site /= points%slave_nodes(2, p)) then
      site = points%master_nodes(1, p)
    end if
  end function site_at

  !> Whether some point has an entry offset.
  pure function has_offsets(memory) result(has)
    type(contact_state_t), intent(in) :: memory
    logical :: has

    has = memory%has%entry_offsets .and. (memory%slave_status%has_offset &
      .or. memory%master_status%has_offset)
  end function has_offsets

  !> Visit the components of a list of contact points.
  subroutine visit_points(self, visitor)
    class(contact_points_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor
    logical :: has_traction

    call visitor%visit('n', self%n)
    call visitor%visit('slave_nodes', self%slave_nodes, any_length)
    call visitor%visit('slave_weights', self%slave_weights, any_length)
    call visitor%visit('master_nodes', self%master_nodes, any_length)
    call visitor%visit('master_weights', self%master_weights, any_length)
    call visitor%visit('normal', self%normal, any_length)
    call visitor%visit('gap', self%gap, any_length)
    call visitor%visit('area', self%area, any_length)
    call visitor%visit('stiffness', self%stiffness, any_length)
    call visitor%visit('pressure', self%pressure, any_length)
    call visitor%visit('damping', self%damping, any_length)
    has_traction = allocated(self%traction) ! from the start, where the deck has friction or ties
    call visitor%visit('traction', self%traction, any_length)
    call visitor%expect('traction', allocated(self%traction) .eqv. has_traction, &
      'values where the deck has no friction and no tie, or none where it has')
  end subroutine visit_points

  !> Visit the components of the state of an interface.
  subroutine visit_contact(self, visitor)
    class(contact_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%same('n_slave', self%n_slave)
    call visitor%same('n_master', self%n_master)
    call visitor%same('nodes', self%nodes)
    call visitor%visit('positions', self%positions)
    call visitor%visit('travel', self%travel, 0.0_wp, 'a negative displacement')
    call visitor%visit('advance', self%advance, 0.0_wp, 'a negative displacement')
    call visitor%visit('is_stale', self%is_stale)
    call visitor%visit('next_listing', self%next_listing)
    call visitor%part('segment_points', self%segment_points)
    call visitor%part('slave_status', self%slave_status)
    call visitor%part('master_status', self%master_status)
    call visitor%part('segments', self%segments)
    call visitor%visit('listed_until', self%listed_until)
    call visitor%part('points', self%points)
    call visitor%part('tie_points', self%tie_points)
    call visitor%visit('closed_gap', self%closed_gap)
    call visitor%visit('node_pressure', self%node_pressure)
    call visitor%visit('force', self%force)
    call visitor%same('contact_law', self%contact_law)
    call visitor%visit('slave_penalty', self%slave_penalty)
    call visitor%visit('master_penalty', self%master_penalty)
    call visitor%visit('node_penalty', self%node_penalty)
    call visitor%visit('damping_force', self%damping_force)
    call visitor%part('friction', self%friction)
    call visitor%part('interference', self%interference)
    call visitor%part('ties', self%ties)
    call visitor%visit('energy', self%energy)
    call visitor%visit('damping_work', self%damping_work)
    call visitor%part('monitor', self%monitor)
    call visitor%part('limit', self%limit)
    call visitor%visit('n_active', self%n_active, 0, huge(1)/2, 'a number of points out of range')
    call visitor%visit('rules_step', self%rules_step)
  end subroutine visit_contact

end module contact_state_m
