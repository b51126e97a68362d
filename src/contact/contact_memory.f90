! SPDX-License-Identifier: MIT
!> The memory of an interface: set up from its formulation and the deck, and carried over where its
!> surfaces have lost elements or come to light anew: set up for the surfaces that are left, with
!> the values of sites that remain, by nodes and segments (doc/theory/contact.md, section 3.9).
module contact_memory_m
  use arcs_m, only : prepare_arcs
  use contact_dispatch_m, only : formulation_t, formulation_of
  use contact_penalty_m, only : set_penalties
  use contact_law_m, only : measure_springs
  use contact_state_m, only : contact_state_t, contact_points_t, features_t, allocate_points, &
    allocate_damping, allocate_tractions, allocate_scratch, n_sites, n_side
  use search_state_m, only : contact_status_t, allocate_segments, active
  use contact_status_m, only : list_active
  use contacts_m, only : contact_t, has_friction, is_tied, breaks, penalty_implicit
  use energy_limit_m, only : form_springs
  use nodal_forces_m, only : power_of
  use initial_status_m, only : allocate_slave_status, allocate_master_status
  use kinds_m, only : wp
  use law_state_m, only : friction_memory_t, allocate_limit, allocate_friction, &
    allocate_interference
  use model_m, only : model_t
  use points_mortar_m, only : resolves_vertices
  use positions_m, only : start_segment_points, points_at_nodes
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: prepare_contact, renew_contact, close_contact

  !> Present numbers of the previous nodes and segments of a surface, 0: gone.
  type :: passage_t
    integer, allocatable :: node(:)    !! (n_node)
    integer, allocatable :: segment(:) !! (n_segment)
  end type passage_t

contains

  !> Memory of one interface before its first search: shapes and penalties.
  subroutine prepare_contact(contact, model, memory)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    type(contact_state_t), intent(out) :: memory
    type(formulation_t) :: formulation
    real(wp) :: origin(2)
    integer :: n_slave, n_master, i

    n_slave = contact%slave%n_node
    n_master = contact%master%n_node
    memory%n_slave = n_slave
    memory%n_master = n_master
    memory%nodes = [contact%slave%nodes, contact%master%nodes]
    allocate (memory%force(2, n_slave + n_master), memory%positions(4, n_slave + n_master), &
      source=0.0_wp)
    origin = model%mesh%coordinates(:, memory%nodes(1))
    if (contact%is_axisymmetric) origin(1) = 0.0_wp
    do i = 1, size(memory%nodes)
      memory%positions(1:2, i) = model%mesh%coordinates(:, memory%nodes(i)) - origin
    end do
    formulation = formulation_of(contact)
    memory%contact_law = formulation%contact_law
    memory%has = features_of(contact, formulation, model%controls%implicit%is_on)
    call set_penalties(contact, model, formulation%self_share, memory)
    if (memory%has%contact .and. contact%largest_turn > 0.0_wp) call prepare_arcs(contact, memory)
    call start_segment_points(formulation%segment_points, contact%n_gauss, &
      contact%is_axisymmetric, resolves_vertices(contact), contact%slave, memory%positions, &
      memory%segment_points)
    call allocate_slave_status(contact, model, memory)
    if (formulation%has_two_passes) call allocate_master_status(contact, model, memory)
    if (memory%has%overlaps) call allocate_segments(memory%segments, contact%slave%n_segment)
    allocate (memory%points)
    call allocate_points(memory%points, formulation%points_per_slave*memory%slave_status%n &
      + formulation%points_per_master*n_master)
    if (memory%has%nodal_pressure) allocate (memory%node_pressure(n_slave), source=0.0_wp)
    if (memory%has%damping) then
      call allocate_damping(memory%points)
      allocate (memory%damping_force(2, n_slave + n_master), source=0.0_wp)
    end if
    if (memory%has%limit) call allocate_limit(memory%limit, n_slave + n_master)
    if (memory%has%friction) then
      call allocate_tractions(memory%points)
      call allocate_friction(memory%friction, n_sites(memory), n_slave + n_master)
    end if
    if (memory%has%interference) call allocate_interference(memory%interference, n_sites(memory), &
      n_master)
    call allocate_scratch(memory)
  end subroutine prepare_contact

  !> Features of an interface by its formulation and by the deck. Implicit penalties have an energy
  !> limit of their own, which needs normal forces apart from those of friction.
  pure function features_of(contact, formulation, is_implicit) result(has)
    type(contact_t), intent(in) :: contact
    type(formulation_t), intent(in) :: formulation
    logical, intent(in) :: is_implicit !! the whole run
    type(features_t) :: has

    has%segment_points = formulation%segment_points /= points_at_nodes
    has%virtual_nodes = has%segment_points .and. .not. formulation%has_nodal_pressure
    has%overlaps = formulation%covers_segments
    has%nodal_pressure = formulation%has_nodal_pressure
    has%unit_area = formulation%has_unit_area
    has%ties = is_tied(contact)
    has%breaks = breaks(contact)
    has%contact = has%breaks .or. .not. has%ties
    has%damping = has%contact .and. contact%damping > 0.0_wp
    has%friction = has%contact .and. has_friction(contact)
    has%interference = allocated(contact%interference)
    has%limit = has%contact .and. .not. (is_implicit &
      .or. contact%penalty_unit == penalty_implicit .and. .not. has%friction)
    has%entry_offsets = contact%penalty_unit /= penalty_implicit
  end function features_of

  !> The memory of `contact` out of that of `previous`; `lost` is the energy of springs that have
  !> gone. Points are generated anew in the next call.
  subroutine renew_contact(previous, contact, model, motion, memory, lost)
    type(contact_t), intent(in) :: previous, contact
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(out) :: lost                    !! J/m
    type(contact_state_t) :: old
    type(passage_t) :: sides(2)
    integer, allocatable :: now(:)              !! present numbers of the nodes ...
    integer, allocatable :: points(:), sites(:) !! ... of the points of the slave, and of sites

    old = memory
    call prepare_contact(contact, model, memory)
    call match_surface(previous%slave, contact%slave, size(motion, 2), sides(1))
    call match_surface(previous%master, contact%master, size(motion, 2), sides(2))
    now = [sides(1)%node, shifted(sides(2)%node, memory%n_slave)]
    memory%positions(3:4, :) = motion(1:2, memory%nodes)
    call carry_scalars(old, memory)
    call carry_nodes(now, old, memory)
    points = sides(1)%node
    if (old%has%segment_points) points = points_on(sides(1)%segment, size(old%segment_points%xi))
    sites = sides(1)%node
    if (old%has%virtual_nodes) sites = points
    sites = [sites, shifted(sides(2)%node, n_sites(memory) - memory%n_master)]
    if (old%has%friction) call carry_sites(sites, old%friction, memory%friction)
    call carry_statuses(points, sides, old, memory)
    call form_springs(memory)
    call measure_springs(old)
    lost = old%monitor%stored
    call clear_lost_points(now, contact, memory%n_slave, old%points)
    call measure_springs(old)
    memory%monitor%stored = old%monitor%stored
    memory%monitor%is_due = .true.
    lost = max(0.0_wp, lost - memory%monitor%stored)
    lost = min(lost, max(0.0_wp, memory%energy + memory%limit%admissible))
    memory%energy = memory%energy - lost
  end subroutine renew_contact

  !> An interface that is over keeps its account alone. The forces of the last call have done half
  !> of the work of a step yet; `lost` is what the interface holds then.
  subroutine close_contact(contact, model, motion, dt, memory, lost)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node)
    real(wp), intent(in) :: dt                       !! of the step behind the forces, s
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(out) :: lost                    !! J/m
    real(wp) :: damping, friction

    lost = memory%energy
    if (memory%n_active > 0) lost = lost - 0.5_wp*dt*power_of(memory%nodes, motion, &
      memory%force)
    damping = memory%damping_work
    friction = memory%friction%work
    call prepare_contact(contact, model, memory)
    memory%is_stale = .true.
    memory%damping_work = damping
    memory%friction%work = friction
  end subroutine close_contact

  !> Numbers moved by an offset; 0 stays.
  pure function shifted(numbers, offset)
    integer, intent(in) :: numbers(:), offset
    integer :: shifted(size(numbers))

    shifted = merge(numbers + offset, 0, numbers > 0)
  end function shifted

  !> Nodes and segments of a surface on the one that it has become. A node that stands there several
  !> times is the one of its own segments.
  pure subroutine match_surface(previous, surface, n_node, passage)
    type(surface_t), intent(in) :: previous, surface
    integer, intent(in) :: n_node !! of the mesh
    type(passage_t), intent(out) :: passage
    integer, allocatable :: head(:), any_node(:), next(:)
    integer :: s, k

    allocate (head(n_node), any_node(n_node), next(surface%n_segment), source=0)
    do k = surface%n_node, 1, -1
      any_node(surface%nodes(k)) = k
    end do
    do s = surface%n_segment, 1, -1
      associate (node => surface%nodes(surface%segments(1, s)))
        next(s) = head(node)
        head(node) = s
      end associate
    end do
    allocate (passage%node(previous%n_node), passage%segment(previous%n_segment), source=0)
    do s = 1, previous%n_segment
      k = head(previous%nodes(previous%segments(1, s)))
      do while (k > 0)
        if (surface%segment_element(k) == previous%segment_element(s) .and. surface%nodes( &
          surface%segments(2, k)) == previous%nodes(previous%segments(2, s))) exit
        k = next(k)
      end do
      passage%segment(s) = k
    end do
    do k = 1, previous%n_node
      s = previous%outgoing(k)
      if (s > 0) s = passage%segment(s)
      if (s > 0) then
        passage%node(k) = surface%segments(1, s)
        cycle
      end if
      s = previous%incoming(k)
      if (s > 0) s = passage%segment(s)
      if (s > 0) then
        passage%node(k) = surface%segments(2, s)
      else
        passage%node(k) = any_node(previous%nodes(k))
      end if
    end do
  end subroutine match_surface

  !> Values of an interface as a whole.
  pure subroutine carry_scalars(old, memory)
    type(contact_state_t), intent(in) :: old
    type(contact_state_t), intent(inout) :: memory
    real(wp), allocatable :: inverse_mass(:, :), velocity(:, :)

    memory%travel = old%travel
    memory%advance = old%advance
    memory%is_stale = old%is_stale
    memory%next_listing = old%next_listing
    memory%slave_penalty = old%slave_penalty
    memory%master_penalty = old%master_penalty
    memory%node_penalty = old%node_penalty
    memory%energy = old%energy
    memory%damping_work = old%damping_work
    memory%n_active = old%n_active
    memory%slave_status%n_released = old%slave_status%n_released
    memory%master_status%n_released = old%master_status%n_released
    memory%rules_step = old%rules_step
    memory%monitor = old%monitor
    memory%friction%work = old%friction%work
    memory%friction%stored = old%friction%stored
    call move_alloc(memory%limit%inverse_mass, inverse_mass)
    call move_alloc(memory%limit%velocity, velocity)
    memory%limit = old%limit
    call move_alloc(inverse_mass, memory%limit%inverse_mass)
    call move_alloc(velocity, memory%limit%velocity)
    memory%limit%recoil = huge(1.0_wp)
  end subroutine carry_scalars

  !> Values of nodes.
  pure subroutine carry_nodes(now, old, memory)
    integer, intent(in) :: now(:) !! (n_slave + n_master) of the previous memory
    type(contact_state_t), intent(in) :: old
    type(contact_state_t), intent(inout) :: memory
    integer, allocatable :: from(:), to(:)
    integer :: k

    from = pack([(k, k=1, size(now))], now > 0)
    to = now(from)
    memory%positions(3:4, to) = old%positions(3:4, from)
    memory%force(:, to) = old%force(:, from)
    if (old%has%damping) memory%damping_force(:, to) = old%damping_force(:, from)
    if (old%has%friction) memory%friction%force(:, to) = old%friction%force(:, from)
    if (old%has%limit) memory%limit%velocity(:, to) = old%limit%velocity(:, from)
    if (.not. old%has%nodal_pressure) return
    from = pack(from, from <= old%n_slave)
    memory%node_pressure(now(from)) = old%node_pressure(from)
  end subroutine carry_nodes

  !> Present numbers of the points of all slave segments.
  pure function points_on(segments, n) result(points)
    integer, intent(in) :: segments(:) !! present numbers
    integer, intent(in) :: n           !! points of each
    integer :: points(n*size(segments))
    integer :: k, q

    points = [((merge((segments(k) - 1)*n + q, 0, segments(k) > 0), q=1, n), k=1, size(segments))]
  end function points_on

  !> What friction remembers.
  pure subroutine carry_sites(now, old, memory)
    integer, intent(in) :: now(:) !! present numbers of the sites
    type(friction_memory_t), intent(in) :: old
    type(friction_memory_t), intent(inout) :: memory
    integer, allocatable :: from(:), to(:)
    integer :: i

    from = pack([(i, i=1, size(now))], now > 0)
    to = now(from)
    memory%traction(to) = old%traction(from)
    memory%state(to) = old%state(from)
    memory%slip(to) = old%slip(from)
  end subroutine carry_sites

  !> Points of the last call whose nodes or segments have gone stand for no area.
  pure subroutine clear_lost_points(now, contact, n_slave, points)
    integer, intent(in) :: now(:)          !! present numbers of the nodes
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: n_slave         !! at present
    type(contact_points_t), intent(inout) :: points
    integer :: p

    do p = 1, points%n
      if (.not. (is_there(now(points%slave_nodes(:, p))) &
        .and. is_there(now(points%master_nodes(:, p))))) points%area(p) = 0.0_wp
    end do

  contains

    !> Whether both nodes are there, and the segment from one to the other.
    pure function is_there(nodes) result(there)
      integer, intent(in) :: nodes(n_side)
      logical :: there

      there = all(nodes > 0)
      if (.not. there .or. nodes(1) == nodes(2)) return
      if (nodes(1) <= n_slave) then
        there = follows(contact%slave, nodes)
      else
        there = follows(contact%master, nodes - n_slave)
      end if
    end function is_there

  end subroutine clear_lost_points

  !> Whether a segment leads from one node to the other.
  pure function follows(surface, nodes)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: nodes(n_side)
    logical :: follows
    integer :: s

    s = surface%outgoing(nodes(1))
    follows = s > 0
    if (follows) follows = surface%segments(2, s) == nodes(2)
  end function follows

  !> Status of both passes, and the memory of slave segments.
  pure subroutine carry_statuses(points, sides, old, memory)
    integer, intent(in) :: points(:) !! present numbers of the points of the slave
    type(passage_t), intent(in) :: sides(2)
    type(contact_state_t), intent(in) :: old
    type(contact_state_t), intent(inout) :: memory
    integer, allocatable :: from(:)
    integer :: k

    call carry_status(old%slave_status, points, sides(2)%segment, memory%slave_status)
    if (memory%master_status%n > 0) call carry_status(old%master_status, sides(2)%node, &
      sides(1)%segment, memory%master_status)
    if (.not. old%has%overlaps) return
    associate (slave => sides(1)%segment)
      from = pack([(k, k=1, size(slave))], slave > 0)
      memory%segments%state(slave(from)) = old%segments%state(from)
      memory%segments%gap(slave(from)) = old%segments%gap(from)
    end associate
  end subroutine carry_statuses

  !> Points that remain keep their segments where these remain; all are searched anew.
  pure subroutine carry_status(old, points, segments, status)
    type(contact_status_t), intent(in) :: old
    integer, intent(in) :: points(:), segments(:) !! present numbers
    type(contact_status_t), intent(inout) :: status
    integer, allocatable :: from(:), to(:)
    integer :: i

    from = pack([(i, i=1, old%n)], points > 0 .and. old%segment > 0)
    from = pack(from, segments(old%segment(from)) > 0)
    to = points(from)
    status%segment(to) = segments(old%segment(from))
    status%state(to) = old%state(from)
    status%xi(to) = old%xi(from)
    status%gap(to) = old%gap(from)
    status%normal(:, to) = old%normal(:, from)
    status%offset(to) = old%offset(from)
    status%next_search(to) = merge(huge(1.0_wp), -huge(1.0_wp), old%state(from) == active)
    status%has_offset = old%has_offset
    call list_active(status)
  end subroutine carry_status

end module contact_memory_m
