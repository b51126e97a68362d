! SPDX-License-Identifier: MIT
!> What the laws of an interface remember: friction, overlaps that a curve lets grow, ties, the
!> energy that springs may return, whether they return it, and how good the contact is. Tractions
!> stand at the sites where pressure is formed: local nodes, slave and master, or virtual nodes, by
!> their number in the search, and master nodes behind them.
module law_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t, whole
  implicit none
  private
  public :: friction_memory_t, allocate_friction, is_open, sticks, slips, is_held, is_broken, &
    is_beside, interference_memory_t, allocate_interference, tie_memory_t, allocate_ties, &
    energy_limit_t, allocate_limit, spring_t, contact_monitor_t, contact_change_t, energy_created, &
    energy_lost, contact_estimate_t

  !> What a site is doing.
  integer, parameter :: is_open = 0, sticks = 1, slips = 2
  !> What a tie makes of it.
  integer, parameter :: is_held = 3, is_broken = 4
  !> Not tied itself, but upon a site that is held.
  integer, parameter :: is_beside = 5

  !> Arrays are allocated for interfaces with friction alone.
  type, extends(visited_t) :: friction_memory_t
    real(wp), allocatable :: traction(:)  !! (n_site) of the last call, before the energy law,
                                          !! N/m^2 (N/m for type 1); 0 where open
    integer, allocatable :: state(:)      !! (n_site) one of the constants above
    real(wp), allocatable :: slip(:)      !! (n_site) sum of all steps in contact, m
    real(wp), allocatable :: force(:, :)  !! (2, n_slave + n_master) the part of the contact forces
                                          !! that friction has, N/m
    real(wp) :: work = 0.0_wp             !! minus the accumulated work of these forces, J/m
    real(wp) :: stored = 0.0_wp           !! the part of it that tangential springs hold now, J/m
  contains
    procedure :: visit => visit_friction
  end type friction_memory_t

  !> The array is allocated for interfaces with such a curve alone.
  type, extends(visited_t) :: interference_memory_t
    real(wp), allocatable :: depth(:)  !! (n_site) overlap at time zero, m; below 0: that of a
                                       !! master node which was no site then
    real(wp) :: remaining = 1.0_wp     !! the part of it that does not act yet, 1 - s
    real(wp) :: moment = 0.0_wp        !! sum of p w depth of the last call, J/m
    real(wp) :: work = 0.0_wp          !! of the curve so far, J/m
  contains
    procedure :: visit => visit_interference
  end type interference_memory_t

  !> Arrays are allocated for tied interfaces alone.
  type, extends(visited_t) :: tie_memory_t
    integer, allocatable :: first(:)     !! (n_spring + 1) first point of each, then the end
    integer, allocatable :: owner(:, :)  !! (2, n_spring) nodes of the segment that n and t turn
                                         !! with
    real(wp), allocatable :: side(:)     !! (n_spring) 1: its outward normal points from master to
                                         !! slave, -1: the other way
    real(wp), allocatable :: lag(:, :)   !! (2, n_spring) from the master site to the slave site
                                         !! in the reference geometry, m
    real(wp), allocatable :: offset(:, :) !! (2, n_spring) parts of it along n and t there, m
    real(wp), allocatable :: area(:)     !! (n_bond) of bonds, which are springs, or slave nodes
                                         !! where pressure is formed there, m
    real(wp), allocatable :: pressure(:) !! (n_bond) below 0: tension, N/m^2
    real(wp), allocatable :: traction(:) !! (n_bond) N/m^2
    real(wp), allocatable :: force(:, :) !! (2, n_slave + n_master) the part of the forces that
                                         !! they have, N/m
    integer :: n_held = 0                !! points that they hold
    real(wp) :: energy = 0.0_wp          !! minus the accumulated work of their forces, J/m
    integer, allocatable :: state(:)     !! (n_site) of each site: open, held, broken or beside
    integer, allocatable :: site(:)      !! (n_bond) of each bond
    real(wp), allocatable :: to_stress(:) !! (n_bond) stress of the bond over pressure: 1 but for
                                         !! types 1 and 3
    real(wp) :: spent = 0.0_wp           !! what springs held that have broken, less what contact
                                         !! there took over, J/m
    real(wp) :: first_break = 0.0_wp     !! its time, s
    real(wp) :: last_break = 0.0_wp      !! likewise
  contains
    procedure :: visit => visit_ties
  end type tie_memory_t

  !> Arrays are allocated in explicit runs alone; without them nothing is limited.
  type, extends(visited_t) :: energy_limit_t
    real(wp) :: coming_step = 0.0_wp  !! step that leads away from this cycle, s; 0: no limit
    real(wp), allocatable :: inverse_mass(:, :) !! (2, n_slave + n_master) 1/m that a force of
                                      !! contact meets, 0 where the motion is held, m/kg
    real(wp), allocatable :: velocity(:, :) !! (2, n_slave + n_master) of the last call with force
    real(wp) :: recoil = 0.0_wp       !! sum of F.F/m of the last call, N^2/kg
    real(wp) :: admissible = 0.0_wp   !! energy of springs that were activated under load, J/m
    real(wp) :: admitted = 0.0_wp     !! its part by entries after the start, J/m
    real(wp) :: entry_allowance = 0.0_wp !! most of it by one interface, J/m
    real(wp) :: largest = 0.0_wp      !! largest energy of springs so far, admissible included, J/m
    integer :: n_loaded = 0           !! cycles with force
    integer :: n_limited = 0          !! cycles whose forces were scaled down
    real(wp) :: least_factor = 1.0_wp !! of all cycles
    real(wp) :: least_time = 0.0_wp   !! of that factor, s
    real(wp) :: withheld = 0.0_wp     !! most stored beyond received and admissible energy, J/m
    logical :: warned = .false.       !! the log has the warning
  contains
    procedure :: visit => visit_limit
  end type energy_limit_t

  !> Signs of the balance, as sites in arrays of two.
  integer, parameter :: energy_created = 1, energy_lost = 2
  character(*), parameter :: no_node = 'a number that no node has'

  !> The largest change of the balance of one sign between two samples, and whether the log has a
  !> warning of that sign.
  type, extends(visited_t) :: contact_change_t
    real(wp) :: amount = 0.0_wp   !! J/m
    integer :: node = 0           !! most loaded then, by index in the mesh; 0: none yet
    real(wp) :: position(2) = 0.0_wp !! where that node was, m
    real(wp) :: time = 0.0_wp     !! of the second sample, s
    logical :: warned = .false.
  contains
    procedure :: visit => visit_change
  end type contact_change_t

  !> A spring of contact or of a tie, as the monitor sees it.
  type :: spring_t
    integer :: site     !! on the lists of what laws remember
    integer :: node     !! slave node next to it
    real(wp) :: energy  !! J/m
    real(wp) :: load    !! N/m
  end type spring_t

  !> Sample of the springs every few cycles.
  type, extends(visited_t) :: contact_monitor_t
    logical :: is_due = .false.       !! the next call samples the springs
    logical :: has_sampled = .false.  !! the last call did, or found that contact has opened
    real(wp) :: stored = 0.0_wp       !! potential of the springs then, J/m
    real(wp) :: load = 0.0_wp         !! largest force of a point then, N/m
    integer :: node = 0               !! slave node next to it, by index in the mesh; 0: none yet
    real(wp) :: balance = 0.0_wp      !! energy of the interface minus what its springs stored then:
                                      !! below 0 made, above lost
    type(contact_change_t) :: changes(2) !! by sign
  contains
    procedure :: visit => visit_monitor
  end type contact_monitor_t

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
    real(wp) :: previous(2) = 0.0_wp   !! at the one before
    real(wp) :: jumps = 0.0_wp         !! sum of squares of second differences of that
                                       !! force, as of equal strides
    real(wp) :: forces = 0.0_wp        !! sum of its squares over the same instants
    real(wp) :: least_margin = huge(1.0_wp) !! smallest of stable step over step
    real(wp) :: softness = 0.0_wp      !! of springs, over that of a row of elements on either side
    real(wp) :: stored = 0.0_wp        !! largest energy of the springs, J/m
    real(wp) :: bodies = 0.0_wp        !! largest internal energy of the bodies on both sides, J/m
    real(wp) :: penetration = 0.0_wp   !! deepest one of curved sites, their flattening
                                       !! included, m
    real(wp) :: facet_error = 0.0_wp   !! by which facets put gaps off there, m
    real(wp) :: arc_height = 0.0_wp    !! of the highest arc over its segment there, m
    real(wp) :: arc_curvature = 0.0_wp !! of that arc, 1/m
    integer :: arc_side = 0            !! it is on: 1 slave, 2 master
  contains
    procedure :: visit => visit_estimate
  end type contact_estimate_t

contains

  !> Allocate for so many sites and nodes; all sites are open.
  pure subroutine allocate_friction(friction, n_site, n_node)
    type(friction_memory_t), intent(inout) :: friction
    integer, intent(in) :: n_site, n_node

    allocate (friction%traction(n_site), friction%slip(n_site), friction%force(2, n_node), &
      source=0.0_wp)
    allocate (friction%state(n_site), source=is_open)
  end subroutine allocate_friction

  !> Visit the components of the friction state.
  subroutine visit_friction(self, visitor)
    class(friction_memory_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('traction', self%traction)
    call visitor%visit('state', self%state, whole, is_open, slips, 'states that do not exist')
    call visitor%visit('slip', self%slip)
    call visitor%visit('force', self%force)
    call visitor%visit('work', self%work)
    call visitor%visit('stored', self%stored)
  end subroutine visit_friction

  !> Allocate for so many sites, the last of which are master nodes.
  pure subroutine allocate_interference(interference, n_site, n_master)
    type(interference_memory_t), intent(inout) :: interference
    integer, intent(in) :: n_site, n_master

    allocate (interference%depth(n_site), source=0.0_wp)
    interference%depth(n_site - n_master + 1:) = -1.0_wp
  end subroutine allocate_interference

  !> Visit the components of the interference state.
  subroutine visit_interference(self, visitor)
    class(interference_memory_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('depth', self%depth)
    call visitor%visit('remaining', self%remaining)
    call visitor%visit('moment', self%moment)
    call visitor%visit('work', self%work)
  end subroutine visit_interference

  !> Allocate for springs that have these first points, between so many nodes.
  pure subroutine allocate_ties(ties, first, n_node)
    type(tie_memory_t), intent(inout) :: ties
    integer, intent(in) :: first(:) !! (n_spring + 1) then the end
    integer, intent(in) :: n_node
    integer :: n_spring

    n_spring = size(first) - 1
    ties%first = first
    allocate (ties%owner(2, n_spring), source=1)
    allocate (ties%side(n_spring), ties%lag(2, n_spring), ties%offset(2, n_spring), &
      ties%force(2, n_node), source=0.0_wp)
  end subroutine allocate_ties

  !> Visit the components of the state of ties.
  subroutine visit_ties(self, visitor)
    class(tie_memory_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('first', self%first)
    call visitor%visit('owner', self%owner)
    call visitor%visit('side', self%side)
    call visitor%visit('lag', self%lag)
    call visitor%visit('offset', self%offset)
    call visitor%visit('area', self%area)
    call visitor%visit('pressure', self%pressure)
    call visitor%visit('traction', self%traction)
    call visitor%visit('force', self%force)
    call visitor%visit('n_held', self%n_held, 0, huge(1)/2, 'a number of points out of range')
    call visitor%visit('energy', self%energy)
    call visitor%visit('state', self%state)
    call visitor%visit('site', self%site)
    call visitor%visit('to_stress', self%to_stress)
    call visitor%visit('spent', self%spent)
    call visitor%visit('first_break', self%first_break)
    call visitor%visit('last_break', self%last_break)
  end subroutine visit_ties

  !> Allocate for `n` nodes; held until their masses are known.
  pure subroutine allocate_limit(limit, n)
    type(energy_limit_t), intent(inout) :: limit
    integer, intent(in) :: n

    allocate (limit%inverse_mass(2, n), limit%velocity(2, n), source=0.0_wp)
  end subroutine allocate_limit

  !> Visit the components of the energy limit.
  subroutine visit_limit(self, visitor)
    class(energy_limit_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('coming_step', self%coming_step)
    call visitor%visit('inverse_mass', self%inverse_mass)
    call visitor%visit('velocity', self%velocity)
    call visitor%visit('recoil', self%recoil)
    call visitor%visit('admissible', self%admissible)
    call visitor%visit('admitted', self%admitted)
    call visitor%visit('entry_allowance', self%entry_allowance)
    call visitor%visit('largest', self%largest)
    call visitor%visit('n_loaded', self%n_loaded)
    call visitor%visit('n_limited', self%n_limited)
    call visitor%visit('least_factor', self%least_factor)
    call visitor%visit('least_time', self%least_time)
    call visitor%visit('withheld', self%withheld)
    call visitor%visit('warned', self%warned)
  end subroutine visit_limit

  !> Visit the components of a change of the balance.
  subroutine visit_change(self, visitor)
    class(contact_change_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('amount', self%amount)
    call visitor%visit('node', self%node, 0, visitor%n_node, no_node)
    call visitor%fixed('position', self%position)
    call visitor%visit('time', self%time)
    call visitor%visit('warned', self%warned)
  end subroutine visit_change

  !> Visit the components of the sample of springs.
  subroutine visit_monitor(self, visitor)
    class(contact_monitor_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('is_due', self%is_due)
    call visitor%visit('has_sampled', self%has_sampled)
    call visitor%visit('stored', self%stored)
    call visitor%visit('load', self%load)
    call visitor%visit('node', self%node, 0, visitor%n_node, no_node)
    call visitor%visit('balance', self%balance)
    call visitor%each('changes', self%changes)
  end subroutine visit_monitor

  !> Visit the components of the error estimate.
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
    call visitor%fixed('previous', self%previous)
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

end module law_state_m
