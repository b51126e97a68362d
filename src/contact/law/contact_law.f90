! SPDX-License-Identifier: MIT
!> The only file that knows the contact laws: from the gap of a site to the pressure there, and what
!> the springs store. Where these sites are, at the points or at the slave nodes, the row of the
!> formulation says; the pressure of every point is kept on the list. Adding a law is a procedure
!> like apply_penalty, a row of `laws` and a `case` (doc/add_a_law.md).
module contact_law_m
  use contact_state_m, only : contact_state_t, n_springs, site_at, has_offsets
  use dual_m, only : dual_t
  use spring_gaps_m, only : add_offsets, store_overlaps, ramp_gaps, gather_moment
  use kinds_m, only : wp
  use law_state_m, only : contact_monitor_t, spring_t
  use nodal_forces_m, only : average_values, share_out
  use ties_m, only : tie_springs, is_tied_site
  implicit none
  private
  public :: law_t, laws, law_penalty, form_pressures, linearise_pressure, density_of, &
    begin_sampling, measure_springs, end_sampling, add_tie_energy

  !> A law.
  type :: law_t
    integer :: number
    character(20) :: name
  end type law_t

  integer, parameter :: law_penalty = 1
  !> All laws.
  type(law_t), parameter :: laws(*) = [law_t(law_penalty, 'penalty')]

contains

  !> Pressures of some sites, their slopes by the gap in contact, and what the sites store.
  pure subroutine apply_law(contact_law, n, stiffness, gap, pressure, slope, energy)
    integer, intent(in) :: contact_law !! a number of `laws`
    integer, intent(in) :: n
    real(wp), intent(in) :: stiffness(n), gap(n) !! N/m^2, m
    real(wp), intent(inout) :: pressure(n)       !! N/m
    real(wp), intent(inout) :: slope(n)          !! N/m^2
    real(wp), intent(inout) :: energy(n)         !! J/m^2

    select case (contact_law)
    case (law_penalty); call apply_penalty(n, stiffness, gap, pressure, slope, energy)
    end select
  end subroutine apply_law

  !> The penalty law: a spring at each site, which pushes and never pulls. It stores the integral of
  !> the pressure over the way from closing.
  pure subroutine apply_penalty(n, stiffness, gap, pressure, slope, energy)
    integer, intent(in) :: n
    real(wp), intent(in) :: stiffness(n), gap(n) !! N/m^2, m
    real(wp), intent(inout) :: pressure(n)       !! N/m
    real(wp), intent(inout) :: slope(n)          !! N/m^2, < 0, also where the gap is zero or open
    real(wp), intent(inout) :: energy(n)         !! J/m^2

    pressure = stiffness*max(0.0_wp, -gap)
    slope = -stiffness
    energy = 0.5_wp*stiffness*max(0.0_wp, -gap)**2
  end subroutine apply_penalty

  !> Pressures of all points on the list, before damping.
  pure subroutine form_pressures(memory)
    type(contact_state_t), intent(inout) :: memory
    ! In one array: allocating each costs as much as the law of ten points.
    real(wp) :: sites(max(memory%points%n, memory%n_slave), 4)

    if (memory%has%interference .and. memory%scratch%is_start) call store_overlaps(memory)
    associate (points => memory%points, law => memory%contact_law, gaps => sites(:, 1), &
      stiffness => sites(:, 2), slope => sites(:, 3), energy => sites(:, 4))
      call find_gaps(memory, gaps)
      if (memory%has%nodal_pressure) then
        stiffness(:memory%n_slave) = memory%slave_penalty
        call apply_law(law, memory%n_slave, stiffness, gaps, memory%node_pressure, slope, energy)
      else
        call apply_law(law, points%n, points%stiffness, gaps, points%pressure, slope, energy)
      end if
      if (memory%has%breaks) call exclude_tied_sites(memory)
      if (memory%has%nodal_pressure) call share_out(points%n, points%slave_nodes, &
        points%slave_weights, memory%node_pressure, points%pressure)
    end associate
    if (memory%has%interference) call gather_moment(memory)
  end subroutine form_pressures

  !> Sites that ties hold have no pressure of contact.
  pure subroutine exclude_tied_sites(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: p

    associate (states => memory%ties%state, points => memory%points)
      if (memory%has%nodal_pressure) then
        where (is_tied_site(states(:memory%n_slave))) memory%node_pressure = 0.0_wp
      else
        do p = 1, points%n
          if (is_tied_site(states(site_at(memory, points, p)))) points%pressure(p) = 0.0_wp
        end do
      end if
    end associate
  end subroutine exclude_tied_sites

  !> Gaps that springs feel, of points or averaged at slave nodes: with entry offsets, and with the
  !> part of initial overlaps that does not act yet.
  pure subroutine find_gaps(memory, gaps)
    type(contact_state_t), intent(inout) :: memory !! out: (2, :) of scratch%nodal areas of nodes, m
    real(wp), intent(inout), contiguous :: gaps(:) !! (points or slave nodes, or more) m

    associate (n => memory%points%n, n_slave => memory%n_slave)
      gaps(:n) = memory%points%gap(:n)
      if (has_offsets(memory)) call add_offsets(memory, gaps)
      if (memory%has%nodal_pressure) then
        call average_values(memory%points, gaps, n_slave, memory%scratch%nodal)
        gaps(:n_slave) = memory%scratch%nodal(1, :n_slave)
      end if
      if (memory%has%interference) call ramp_gaps(memory, gaps)
    end associate
  end subroutine find_gaps

  !> Springs of contact, without what damping adds to their pressures; those that ties hold are
  !> not loaded.
  pure subroutine list_springs(memory, springs)
    type(contact_state_t), intent(inout) :: memory
    type(spring_t), allocatable, intent(out) :: springs(:)
    real(wp) :: gaps(max(memory%points%n, memory%n_slave))
    integer :: i

    call find_gaps(memory, gaps)
    allocate (springs(n_springs(memory)))
    associate (points => memory%points, law => memory%contact_law, nodal => memory%scratch%nodal)
      do i = 1, size(springs)
        if (memory%has%nodal_pressure) then
          springs(i) = spring_t(i, i, nodal(2, i)*density_of(law, memory%slave_penalty, gaps(i)), &
            nodal(2, i)*memory%node_pressure(i))
        else
          springs(i) = spring_t(site_at(memory, points, i), points%slave_nodes( &
            maxloc(points%slave_weights(:, i), 1), i), &
            points%area(i)*density_of(law, points%stiffness(i), gaps(i)), &
            points%area(i)*points%pressure(i))
        end if
        if (.not. memory%has%breaks) cycle
        if (is_tied_site(memory%ties%state(springs(i)%site))) &
          springs(i) = spring_t(springs(i)%site, springs(i)%node, 0.0_wp, 0.0_wp)
      end do
    end associate
  end subroutine list_springs

  !> Pressure of a site in contact with its derivatives.
  pure function linearise_pressure(contact_law, stiffness, gap) result(pressure)
    integer, intent(in) :: contact_law
    real(wp), intent(in) :: stiffness
    type(dual_t), intent(in) :: gap
    type(dual_t) :: pressure
    real(wp), dimension(1) :: value, slope, energy

    call apply_law(contact_law, 1, [stiffness], [gap%value], value, slope, energy)
    pressure%value = value(1)
    pressure%slope = slope(1)*gap%slope
  end function linearise_pressure

  !> Energy that a site stores per unit of its area.
  pure function density_of(contact_law, stiffness, gap) result(density)
    integer, intent(in) :: contact_law
    real(wp), intent(in) :: stiffness, gap
    real(wp) :: density !! J/m^2
    real(wp), dimension(1) :: pressure, slope, energy

    call apply_law(contact_law, 1, [stiffness], [gap], pressure, slope, energy)
    density = energy(1)
  end function density_of

  !> Before the points are generated: springs are sampled when that is due, and in the first call
  !> with contact.
  pure subroutine begin_sampling(had_force, monitor)
    logical, intent(in) :: had_force !! the call before had
    type(contact_monitor_t), intent(inout) :: monitor

    monitor%is_due = monitor%is_due .or. .not. had_force
  end subroutine begin_sampling

  !> What all springs store, and where the largest force is. What broken ties held counts as theirs.
  pure subroutine measure_springs(memory)
    type(contact_state_t), intent(inout) :: memory
    type(spring_t), allocatable :: springs(:)

    memory%monitor%stored = 0.0_wp
    memory%monitor%load = 0.0_wp
    if (memory%has%ties) then
      call measure(tie_springs(memory), memory%nodes, memory%monitor)
      memory%monitor%stored = memory%monitor%stored + memory%ties%spent
    end if
    if (memory%points%n == 0) return
    call list_springs(memory, springs)
    call measure(springs, memory%nodes, memory%monitor)
  end subroutine measure_springs

  !> Add what some springs store, and note the one with the largest force.
  pure subroutine measure(springs, nodes, monitor)
    type(spring_t), intent(in) :: springs(:)
    integer, intent(in) :: nodes(:) !! mesh index of each local node
    type(contact_monitor_t), intent(inout) :: monitor
    integer :: i

    do i = 1, size(springs)
      monitor%stored = monitor%stored + springs(i)%energy
      if (.not. springs(i)%load > monitor%load) cycle
      monitor%load = springs(i)%load
      monitor%node = nodes(springs(i)%node)
    end do
  end subroutine measure

  !> Energy of contact springs at sites whose ties have just failed under pressure: it comes from
  !> the energy of the ties. Energy beyond that, of initial penetrations, is admissible.
  pure subroutine add_tie_energy(memory)
    type(contact_state_t), intent(inout) :: memory
    type(spring_t), allocatable :: springs(:)
    real(wp) :: held, given

    call list_springs(memory, springs)
    held = sum(springs%energy, mask=memory%scratch%is_freed(springs%site))
    associate (ties => memory%ties, limit => memory%limit)
      given = min(held, max(0.0_wp, ties%spent))
      ties%spent = ties%spent - given
      ties%energy = ties%energy - given
      limit%admissible = limit%admissible + (held - given)
    end associate
  end subroutine add_tie_energy

  !> After the forces are known: whether there has been a look. Contact that has opened stores
  !> nothing.
  pure subroutine end_sampling(had_force, has_force, monitor)
    logical, intent(in) :: had_force, has_force !! the call before, and this one
    type(contact_monitor_t), intent(inout) :: monitor

    monitor%has_sampled = (has_force .and. monitor%is_due) .or. (had_force .and. .not. has_force)
    if (.not. has_force) monitor%stored = 0.0_wp
    monitor%is_due = .false.
  end subroutine end_sampling

end module contact_law_m
