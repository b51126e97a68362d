! SPDX-License-Identifier: MIT
!> The only file that knows the contact laws: from the gap of a site to the pressure there, and what
!> the springs store. Where these sites are, at the points or at the slave nodes, the row of the
!> formulation says; the pressure of every point is kept on the list. Adding a law is a procedure
!> like apply_penalty, a row of `laws` and a `case` (doc/add_a_law.md).
module contact_law_m
  use contact_state_m, only : contact_state_t, site_at
  use dual_m, only : dual_t
  use spring_gaps_m, only : has_offsets, add_offsets, store_overlaps, ramp_gaps, gather_moment
  use kinds_m, only : wp
  use law_state_m, only : contact_monitor_t
  use contact_scatter_m, only : average_values, share_out
  use tiebreak_m, only : exclude_tied_sites, is_tied_site
  use ties_m, only : tie_energy
  implicit none
  private
  public :: law_t, laws, law_penalty, form_pressures, find_gaps, spring_t, n_springs, spring_at, &
    linearise_pressure, density_of, begin_sampling, measure_springs, end_sampling, add_tie_energy

  !> A law.
  type :: law_t
    integer :: number
    character(20) :: name
  end type law_t

  !> A spring, where pressure is formed.
  type :: spring_t
    integer :: site     !! on the lists of what laws remember
    integer :: node     !! slave node next to it
    real(wp) :: energy  !! J/m
    real(wp) :: load    !! N/m
  end type spring_t

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

  !> Springs: points or slave nodes.
  pure function n_springs(memory) result(n)
    type(contact_state_t), intent(in) :: memory
    integer :: n

    n = merge(memory%n_slave, memory%points%n, memory%has%nodal_pressure)
  end function n_springs

  !> A spring with the gap that find_gaps has found, without what damping adds to its pressure.
  pure function spring_at(memory, gap, i) result(spring)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in) :: gap !! m
    integer, intent(in) :: i    !! point or slave node
    type(spring_t) :: spring

    associate (points => memory%points, law => memory%contact_law, nodal => memory%scratch%nodal)
      if (memory%has%nodal_pressure) then
        spring = spring_t(i, i, nodal(2, i)*density_of(law, memory%slave_penalty, gap), &
          nodal(2, i)*memory%node_pressure(i))
      else
        spring = spring_t(site_at(memory, memory%points, i), points%slave_nodes( &
          maxloc(points%slave_weights(:, i), 1), i), &
          points%area(i)*density_of(law, points%stiffness(i), gap), &
          points%area(i)*points%pressure(i))
      end if
    end associate
  end function spring_at

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

  !> What all springs store, those of contact without what damping adds to their pressure, and where
  !> the largest force is. What broken ties held counts as theirs.
  pure subroutine measure_springs(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: gaps(max(memory%points%n, memory%n_slave))
    type(spring_t) :: spring
    integer :: i

    memory%monitor%stored = 0.0_wp
    memory%monitor%load = 0.0_wp
    if (memory%has%ties) then
      call tie_energy(memory, memory%monitor%stored, memory%monitor%load, memory%monitor%node)
      memory%monitor%stored = memory%monitor%stored + memory%ties%spent
    end if
    if (memory%points%n == 0) return
    call find_gaps(memory, gaps)
    associate (monitor => memory%monitor)
      do i = 1, n_springs(memory)
        spring = spring_at(memory, gaps(i), i)
        if (memory%has%breaks) then
          if (is_tied_site(memory%ties%state(spring%site))) cycle
        end if
        monitor%stored = monitor%stored + spring%energy
        if (.not. spring%load > monitor%load) cycle
        monitor%load = spring%load
        monitor%node = memory%nodes(spring%node)
      end do
    end associate
  end subroutine measure_springs

  !> Energy of contact springs at sites whose ties have just failed under pressure: it comes from
  !> the energy of the ties. Energy beyond that, of initial penetrations, is admissible.
  pure subroutine add_tie_energy(memory)
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: gaps(max(memory%points%n, memory%n_slave)), held, given
    type(spring_t) :: spring
    integer :: i

    held = 0.0_wp
    call find_gaps(memory, gaps)
    do i = 1, n_springs(memory)
      spring = spring_at(memory, gaps(i), i)
      if (memory%scratch%is_freed(spring%site)) held = held + spring%energy
    end do
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
