! SPDX-License-Identifier: MIT
!> What one interface remembers from step to step, and the common list of contact points.
!>
!> A contact point is the only thing that a formulation makes. Whoever generates points promises:
!> P1: the weights sum to one on each side;
!> P2: x_slave - x_master = gap * normal, with positions taken by those weights, normal pointing
!>     from master to slave and gap < 0 in penetration.
!> Balance of momentum follows from P1, balance of angular momentum from P2.
!>
!> Node numbers here are local to the interface: 1 .. n_slave for slave nodes, then
!> n_slave + 1 .. n_slave + n_master for master nodes. A position is (X, Y, u_x, u_y), X and Y
!> relative to the first slave node, so that positions between nodes lose no digit far from the
!> origin; in axisymmetry X is the radius itself.
!>
!> Contact is looked for among candidate pairs alone: master segments near each slave segment. A
!> separated point at distance d from all of its candidates is skipped until `travel` has grown by
!> d: the sum over all steps of a bound on how far any two nodes of the interface have moved
!> relative to each other.
module contact_state_m
  use law_state_m, only : contact_monitor_t, energy_limit_t, friction_memory_t, &
    interference_memory_t, tie_memory_t
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, any_length, length, whole
  implicit none
  private
  public :: contact_state_t, contact_points_t, contact_status_t, candidates_t, pass_t, &
    contact_scratch_t, arcs_t, allocate_points, allocate_damping, allocate_tractions, make_room, &
    allocate_status, allocate_scratch, n_side, n_sites, sites_of_segment, &
    site_at, segment_point_at, touching_gap, features_t, separated, active

  !> Nodes of a side of a contact point (2-node segments).
  integer, parameter :: n_side = 2
  !> Status of a contact point: separated or active.
  integer, parameter :: separated = 0, active = 1

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

  !> Candidate pairs: for each segment of one surface the segments of the other that it may touch
  !> before the lists are made anew. No result depends on them; a restart makes them again.
  type :: candidates_t
    integer, allocatable :: first(:) !! (n_segment + 1) where each row starts ...
    integer, allocatable :: items(:) !! ... on this list of segments of the other surface
  end type candidates_t

  !> What one call asks of the points of one surface over the segments of the other.
  type :: pass_t
    integer :: own_at = 0              !! local number before the first node of the points' surface
    integer :: other_at = 0            !! and before the first node of the other surface
    integer :: n_on_segment = 0        !! points of a segment; 0: points at nodes
    real(wp), allocatable :: xi(:)     !! (n_on_segment) where they are on it
    integer, allocatable :: segment_at(:) !! (n_node) segment that starts at a node of their surface
    logical :: is_self = .false.       !! both surfaces are one
    logical :: is_closed = .false.     !! the points' surface has a closed boundary
    logical :: has_history = .false.   !! increments are those of a step
    logical :: is_trial = .false.      !! of an implicit step, which may lead to any depth
    real(wp) :: travel = 0.0_wp        !! accumulated relative displacement, m
    real(wp) :: closed_gap = 0.0_wp    !! gaps below it are contact, m
  end type pass_t

  !> Status of the points of one surface over the segments of the other.
  type, extends(visited_t) :: contact_status_t
    integer :: n = 0                         !! points
    integer :: n_active = 0
    real(wp) :: earliest_search = -huge(1.0_wp) !! travel before which no separated point can touch
    real(wp) :: reach = 0.0_wp               !! search radius: points farther away are unpaired, m
    integer, allocatable :: active_points(:) !! (n) the first n_active: active points, in order
    integer, allocatable :: due(:)           !! (n) scratch: points to be looked at one by one
    integer, allocatable :: segment(:)       !! (n) active: its segment; else the closest, 0 = none
    integer, allocatable :: state(:)         !! (n) separated or active
    real(wp), allocatable :: xi(:)           !! (n) 0 to 1 along the segment (a little more at ends)
    real(wp), allocatable :: gap(:)          !! (n) m; up to date while active
    real(wp), allocatable :: normal(:, :)    !! (2, n) from the segment to the point's side
    real(wp), allocatable :: offset(:)       !! (n) entry offset, m: pressure acts from gap + offset
    real(wp), allocatable :: next_search(:)  !! (n) next search time: travel before which the point
                                             !! can not touch; huge while active
    real(wp), allocatable :: faded(:)        !! (n) scratch: by which offsets have faded in this
                                             !! call, m
    logical :: has_offset = .false.          !! some offset is above 0
    integer :: n_released = 0                !! first contacts deeper than the limit so far
    real(wp), allocatable :: point_depth(:)  !! (n) deepest first contact of a point, m
    real(wp), allocatable :: segment_depth(:) !! (n_segment) deepest first contact of a segment, m
    real(wp) :: shallowest = huge(1.0_wp)    !! smallest of both, m
    type(pass_t) :: pass                     !! of the present call
  contains
    procedure :: visit => visit_status
  end type contact_status_t

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
    logical, allocatable :: has_points(:)   !! (slave segments) have their points
    type(contact_points_t), allocatable :: parts(:) !! points of ranges of slave segments, which
                                            !! threads share
    logical :: waits = .false.              !! points are generated, forces follow once all others
                                            !! are known
    logical :: had_force = .false.          !! the call before had some, not of ties
    logical :: is_born = .false.            !! contact begins in this call, after time zero
    integer :: n_freed = 0                  !! sites that no tie holds any more since this call
    logical, allocatable :: is_freed(:)     !! (n_site) which; only where ties break
  end type contact_scratch_t

  !> Arcs that segments stand for, by the initial mesh; a restart finds them again.
  type :: arcs_t
    real(wp), allocatable :: share(:, :)  !! (2, n_slave + n_master) parts of the turns at both ends
                                          !! of the segment that starts at a node, which its arc
                                          !! has; 0: flat
    real(wp), allocatable :: turn(:)      !! (n_slave + n_master) tangent of half the turn at a node
                                          !! at time zero, above 0 where the body is convex
    integer, allocatable :: beside(:, :)  !! (2, n_slave + n_master) nodes before and behind, or 0
    real(wp) :: allowance = 0.0_wp        !! how far arcs of both sides stand off their segments at
                                          !! most, together, m
  end type arcs_t

  !> What an interface has beside springs along the normal at its points: by its formulation and by
  !> the deck.
  type :: features_t
    logical :: segment_points = .false. !! points between nodes are followed
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
    real(wp), allocatable :: segment_points(:, :) !! (4, n_contact_point) positions of points that
                                                  !! are not nodes
    real(wp), allocatable :: segment_xi(:)  !! (points of a segment) where on the segment they are
    real(wp), allocatable :: segment_share(:) !! (points of a segment) part of its length they stand
                                            !! for
    real(wp) :: segment_spread = 0.0_wp     !! above 0: a point stands at the centre, by radius, of
                                            !! this part of its segment about its segment_xi
    type(contact_status_t) :: slave_status  !! slave nodes, or `segment_points`, over the master
                                            !! surface
    type(contact_status_t) :: master_status !! master nodes over the slave surface; empty for one
                                            !! pass
    type(candidates_t) :: candidates        !! of slave segments
    real(wp) :: listed_until = -huge(1.0_wp) !! travel for which these hold, m
    type(candidates_t) :: reversed          !! of master segments: the same pairs; for two passes
    integer, allocatable :: segment_state(:)  !! (slave segments) active: overlaps of it are in
                                            !! contact; only where these make points
    real(wp), allocatable :: segment_gap(:) !! (slave segments) smallest gap of its points at the
                                            !! last look, m
    real(wp), allocatable :: segment_search(:) !! (slave segments) travel before which its overlaps
                                            !! can not touch, m
    real(wp) :: earliest_segment_search = -huge(1.0_wp) !! smallest of these, m
    type(arcs_t) :: arcs                    !! of curved segments; only where these are smoothed
    type(contact_points_t), allocatable :: points !! of contact
    type(contact_points_t) :: tie_points    !! of ties: placed in the reference geometry, and frozen
    real(wp) :: closed_gap = 0.0_wp         !! gaps of segments below it make contact points, m;
                                            !! more than 0 only where a tangent of touching bodies
                                            !! is wanted, or segments stand for arcs
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
    logical :: rules_step = .false.         !! the step obeys the springs, which nobody has chosen
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

  !> Allocate for `n` points over `n_segment` segments.
  pure subroutine allocate_status(status, n, n_segment)
    type(contact_status_t), intent(inout) :: status
    integer, intent(in) :: n, n_segment

    status%n = n
    allocate (status%active_points(n), status%due(n), status%segment(n), status%state(n), &
      source=0)
    allocate (status%xi(n), status%gap(n), status%normal(2, n), status%point_depth(n), &
      status%segment_depth(n_segment), source=0.0_wp)
    allocate (status%offset(n), status%faded(n), source=0.0_wp)
    allocate (status%next_search(n), source=-huge(1.0_wp))
  end subroutine allocate_status

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
      if (.not. memory%has%overlaps) return
      allocate (scratch%has_points(size(memory%segment_state)), source=.false.)
    end associate
  end subroutine allocate_scratch

  !> Sites that laws remember: slave nodes, or points of slave segments, and master nodes.
  pure function n_sites(memory) result(n)
    type(contact_state_t), intent(in) :: memory
    integer :: n

    n = sites_of_segment(memory)*memory%n_slave + memory%n_master
  end function n_sites

  !> Sites of a slave segment that have a memory of their own.
  pure function sites_of_segment(memory) result(n)
    type(contact_state_t), intent(in) :: memory
    integer :: n

    n = 1
    if (memory%has%segment_points) n = size(memory%segment_xi)
  end function sites_of_segment

  !> The site of a point of one of the lists: a node, slave or master, or between nodes.
  pure function site_at(memory, points, p) result(site)
    type(contact_state_t), intent(in) :: memory
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: p
    integer :: site

    site = points%slave_nodes(1, p)
    if (memory%has%segment_points) then
      site = size(memory%segment_xi)*(site - 1) &
        + segment_point_at(points%slave_weights(2, p), memory%segment_xi)
    else if (site /= points%slave_nodes(2, p)) then
      site = points%master_nodes(1, p)
    end if
  end function site_at

  !> Gap of contact points below which they count as closed, m; more than 0 only where a tangent of
  !> touching bodies is wanted.
  pure function touching_gap(memory) result(gap)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: gap

    gap = memory%closed_gap - memory%arcs%allowance
  end function touching_gap

  !> Which of the points of a segment stands at xi.
  pure function segment_point_at(xi, segment_xi) result(q)
    real(wp), intent(in) :: xi, segment_xi(:)
    integer :: q, i

    q = 1
    do i = 2, size(segment_xi)
      if (abs(segment_xi(i) - xi) < abs(segment_xi(q) - xi)) q = i
    end do
  end function segment_point_at

  !> Its components.
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

  !> Its components; extremes are found again.
  subroutine visit_status(self, visitor)
    class(contact_status_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('n', self%n)
    call visitor%visit('n_active', self%n_active)
    call visitor%visit('earliest_search', self%earliest_search)
    call visitor%visit('active_points', self%active_points, whole, 0, length(self%active_points), &
      'numbers that no contact point has')
    call visitor%visit('segment', self%segment)
    call visitor%visit('state', self%state, whole, separated, active, &
      'numbers that mean nothing')
    call visitor%visit('xi', self%xi)
    call visitor%visit('gap', self%gap)
    call visitor%visit('normal', self%normal)
    call visitor%visit('offset', self%offset)
    call visitor%visit('has_offset', self%has_offset)
    call visitor%visit('n_released', self%n_released, 0, 10**9, 'a number that no run reaches')
    call visitor%visit('next_search', self%next_search)
    call visitor%visit('point_depth', self%point_depth)
    call visitor%visit('segment_depth', self%segment_depth)
    call visitor%visit('shallowest', self%shallowest)
  end subroutine visit_status

  !> Its components.
  subroutine visit_contact(self, visitor)
    class(contact_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%same('n_slave', self%n_slave)
    call visitor%same('n_master', self%n_master)
    call visitor%same('nodes', self%nodes)
    call visitor%visit('positions', self%positions)
    call visitor%visit('travel', self%travel, 0.0_wp, 'a way below zero')
    call visitor%visit('advance', self%advance, 0.0_wp, 'a way below zero')
    call visitor%visit('is_stale', self%is_stale)
    call visitor%visit('next_listing', self%next_listing)
    call visitor%visit('segment_points', self%segment_points)
    call visitor%visit('segment_xi', self%segment_xi)
    call visitor%visit('segment_share', self%segment_share)
    call visitor%visit('segment_spread', self%segment_spread)
    call visitor%part('slave_status', self%slave_status)
    call visitor%part('master_status', self%master_status)
    call visitor%visit('segment_state', self%segment_state, whole, separated, active, &
      'numbers that mean nothing')
    call visitor%visit('segment_gap', self%segment_gap)
    call visitor%visit('segment_search', self%segment_search)
    call visitor%visit('listed_until', self%listed_until)
    call visitor%visit('earliest_segment_search', self%earliest_segment_search)
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
