! SPDX-License-Identifier: MIT
!> Ties (doc/theory/contact.md, sections 6.3 and 6.4): springs of both signs along the current
!> normal and tangent of a segment, between sites that were frozen in the reference geometry. With
!> d from the master site to the slave site, d0 and n0, t0 in the reference geometry, a = d.n -
!> d0.n0, b = d.t - d0.t0, each spring stores k w (a^2 + b^2)/2, and its forces are the exact
!> gradient: -k w (a n + b t) on the slave side, the opposite on the master side, and the couple
!> k w (b d.n - a d.t) on the segment that n and t turn with, so that the net moment vanishes.
!> Loads stand at bonds, which are springs, or slave nodes where pressure is formed there. Where
!> (s_n/NFLS)^2 + (s_t/SFLS)^2 >= 1, s_n the tension and s_t the shear of a bond, it breaks: its
!> site is free for good, and in contact from then on.
module ties_m
  use contact_penalty_m, only : mean_length
  use contact_state_m, only : contact_state_t, contact_points_t, allocate_tractions, &
    move_point, n_side, n_sites, site_at
  use nodal_forces_m, only : scatter, scatter_tractions, average_values, share_out
  use contacts_m, only : contact_t
  use geometry_m, only : separation
  use kinds_m, only : wp
  use law_state_m, only : tie_memory_t, allocate_ties, spring_t, is_open, is_held, is_broken, &
    is_beside
  use model_m, only : model_t
  use tributary_lengths_m, only : nodal_area
  implicit none
  private
  public :: tie_spring_t, tie_distance, freeze_ties, hold_ties, break_ties, tie_springs, &
    tie_energy, tie_spring, has_state, is_tied_site, tied_nodes

  !> A spring as it stands.
  type :: tie_spring_t
    real(wp) :: n(2)    !! unit, from master to slave
    real(wp) :: t(2)    !! (-n_y, n_x)
    real(wp) :: d(2)    !! from the master site to the slave site, m
    real(wp) :: length  !! of the segment, m
  end type tie_spring_t

contains

  !> How far apart sites may lie that are tied, m.
  pure function tie_distance(contact, model) result(reach)
    type(contact_t), intent(in) :: contact
    type(model_t), intent(in) :: model
    real(wp) :: reach

    reach = contact%tie_distance
    if (.not. abs(reach) > 0.0_wp) reach = -1.0_wp
    if (reach < 0.0_wp) reach = -0.01_wp*reach*mean_length(contact%master, model)
  end function tie_distance

  !> Make springs of points that have been placed in the reference geometry. Points farther apart
  !> than `reach` and those without area go.
  pure subroutine freeze_ties(contact, reach, placed, memory)
    type(contact_t), intent(in) :: contact         !! between which they were placed
    real(wp), intent(in) :: reach                  !! m
    type(contact_state_t), intent(in) :: placed    !! has the points and their status
    type(contact_state_t), intent(inout) :: memory
    type(tie_spring_t) :: spring
    integer :: s

    memory%tie_points = placed%points
    associate (ties => memory%ties, points => memory%tie_points, positions => memory%positions)
      call select_points(reach, points)
      call allocate_tractions(points)
      call allocate_ties(ties, spring_starts(memory%has%virtual_nodes, points), size(memory%nodes))
      do s = 1, size(ties%side)
        call find_owner(contact, placed, points, s, ties)
        ties%lag(:, s) = mean_separation(ties, points, positions(1:2, :), s)
        spring = tie_spring(ties, points, positions, s)
        ties%offset(:, s) = [dot_product(spring%d, spring%n), dot_product(spring%d, spring%t)]
      end do
    end associate
    call start_bonds(contact, memory)
  end subroutine freeze_ties

  !> Keep the points within reach that have an area.
  pure subroutine select_points(reach, points)
    real(wp), intent(in) :: reach
    type(contact_points_t), intent(inout) :: points
    integer :: p, n

    n = 0
    do p = 1, points%n
      if (abs(points%gap(p)) > reach .or. .not. points%area(p) > 0.0_wp) cycle
      n = n + 1
      call move_point(p, n, points)
    end do
    points%n = n
  end subroutine select_points

  !> The first point of each spring, then the end: sub-segments of one virtual node are one spring.
  pure function spring_starts(has_virtual_nodes, points) result(first)
    logical, intent(in) :: has_virtual_nodes
    type(contact_points_t), intent(in) :: points
    integer, allocatable :: first(:)
    logical :: is_first(points%n + 1)
    integer :: p

    is_first = .true.
    do p = 2, merge(points%n, 0, has_virtual_nodes)
      is_first(p) = any(points%slave_nodes(:, p) /= points%slave_nodes(:, p - 1)) &
        .or. abs(points%slave_weights(1, p) - points%slave_weights(1, p - 1)) > 0.0_wp
    end do
    first = pack([(p, p=1, points%n + 1)], is_first)
  end function spring_starts

  !> The segment that the normal of a spring belongs to: the master's, for a virtual node the one
  !> below it, or the slave's where the master side is one node.
  pure subroutine find_owner(contact, placed, points, s, ties)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: placed
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: s
    type(tie_memory_t), intent(inout) :: ties

    associate (p => ties%first(s), owner => ties%owner(:, s))
      ties%side(s) = 1.0_wp
      owner = points%master_nodes(:, p)
      if (owner(1) == owner(2)) then
        owner = points%slave_nodes(:, p)
        ties%side(s) = -1.0_wp
      else if (placed%has%virtual_nodes) then
        owner = placed%n_slave &
          + contact%master%segments(:, placed%slave_status%segment(site_at(placed, points, p)))
      end if
    end associate
  end subroutine find_owner

  !> Bonds, all of which hold, and what makes their pressures stresses: those of type 1 are forces,
  !> and two passes share a bond by their penalties. Sites are in the reference geometry.
  pure subroutine start_bonds(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer :: b

    associate (ties => memory%ties, points => memory%tie_points, n => memory%n_slave)
      if (memory%has%nodal_pressure) then
        call average_values(points, points%gap, n, memory%scratch%nodal)
        ties%area = memory%scratch%nodal(2, :n)
        ties%site = [(b, b=1, n)]
      else
        ties%area = [(sum(points%area(ties%first(b):ties%first(b + 1) - 1)), b=1, size(ties%side))]
        ties%site = [(site_at(memory, points, ties%first(b)), b=1, size(ties%side))]
      end if
      allocate (ties%pressure(size(ties%area)), ties%traction(size(ties%area)), source=0.0_wp)
      allocate (ties%to_stress(size(ties%area)), source=1.0_wp)
      allocate (ties%state(n_sites(memory)), source=is_open)
      do b = 1, size(ties%area)
        if (ties%area(b) > 0.0_wp) ties%state(ties%site(b)) = is_held
        if (memory%master_status%n > 0) ties%to_stress(b) = (memory%slave_penalty &
          + memory%master_penalty)/points%stiffness(ties%first(b))
        if (memory%has%unit_area) ties%to_stress(b) = ties%area(b)/nodal_area(contact%slave, &
          memory%positions(:, :n), contact%is_axisymmetric, ties%site(b))
      end do
      if (.not. (memory%has%virtual_nodes .or. memory%has%nodal_pressure)) &
        call mark_beside(points, ties)
    end associate
  end subroutine start_bonds

  !> Where slave and master nodes lie upon each other type 5 has one site of the two: the other,
  !> never tied itself, goes with it.
  pure subroutine mark_beside(points, ties)
    type(contact_points_t), intent(in) :: points
    type(tie_memory_t), intent(inout) :: ties
    integer :: s, k

    where (ties%state == is_beside) ties%state = is_open
    do s = 1, size(ties%side)
      if (ties%state(ties%site(s)) /= is_held) cycle
      associate (p => ties%first(s))
        do k = 1, n_side
          associate (a => ties%state(points%slave_nodes(k, p)), &
            b => ties%state(points%master_nodes(k, p)))
            if (points%slave_weights(k, p) > 0.5_wp .and. a == is_open) a = is_beside
            if (points%master_weights(k, p) > 0.5_wp .and. b == is_open) b = is_beside
          end associate
        end do
      end associate
    end do
  end subroutine mark_beside

  !> Mean by area, over the points of a spring, of slave site minus master site, m.
  pure function mean_separation(ties, points, x, s) result(d)
    type(tie_memory_t), intent(in) :: ties
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in) :: x(:, :) !! (2, n_node) coordinates or displacements of the interface, m
    integer, intent(in) :: s
    real(wp) :: d(2)
    real(wp) :: total
    integer :: p, i

    d = 0.0_wp
    total = 0.0_wp
    do p = ties%first(s), ties%first(s + 1) - 1
      do i = 1, n_side
        d = d + points%area(p)*(points%slave_weights(i, p)*x(:, points%slave_nodes(i, p)) &
          - points%master_weights(i, p)*x(:, points%master_nodes(i, p)))
      end do
      total = total + points%area(p)
    end do
    d = d/total
  end function mean_separation

  !> A spring at the present positions.
  pure function tie_spring(ties, points, positions, s) result(spring)
    type(tie_memory_t), intent(in) :: ties
    type(contact_points_t), intent(in) :: points        !! of ties
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    integer, intent(in) :: s
    type(tie_spring_t) :: spring
    real(wp) :: way(2)

    way = separation(positions(:, ties%owner(2, s)), positions(:, ties%owner(1, s)))
    spring%length = max(sqrt(way(1)**2 + way(2)**2), tiny(1.0_wp))
    spring%t = ties%side(s)/spring%length*way
    spring%n = [spring%t(2), -spring%t(1)]
    spring%d = ties%lag(:, s) + mean_separation(ties, points, positions(3:4, :), s)
  end function tie_spring

  !> Pressures, tractions and nodal forces of all springs at the positions in the memory. Pressures
  !> below zero are tension. Bonds that reach their strengths break, where any are given.
  subroutine hold_ties(memory, strength, time)
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(in) :: strength(2) !! NFLS, SFLS, N/m^2; 0 = nothing breaks now
    real(wp), intent(in) :: time        !! s
    type(tie_spring_t) :: springs(size(memory%ties%side))
    real(wp) :: along_n(size(springs)), along_t(size(springs)) !! stretches, m
    integer :: s, p, n_new

    memory%scratch%n_freed = 0
    memory%ties%n_held = 0
    memory%ties%force = 0.0_wp
    if (memory%tie_points%n == 0) return
    associate (points => memory%tie_points, ties => memory%ties)
      do s = 1, size(springs)
        springs(s) = tie_spring(ties, points, memory%positions, s)
        do p = ties%first(s), ties%first(s + 1) - 1
          points%normal(:, p) = springs(s)%n
          points%gap(p) = dot_product(springs(s)%d, springs(s)%n)
        end do
        along_n(s) = dot_product(springs(s)%d, springs(s)%n) - ties%offset(1, s)
        along_t(s) = dot_product(springs(s)%d, springs(s)%t) - ties%offset(2, s)
      end do
      ties%pressure = -bond_loads(memory, along_n)
      ties%traction = bond_loads(memory, along_t)
      call unload_broken(ties)
    end associate
    if (memory%has%breaks .and. strength(1) > 0.0_wp) &
      call break_ties(strength, time, memory, n_new)
    call share_loads(memory%has%nodal_pressure, memory%ties, memory%tie_points)
    call scatter_ties(springs, memory)
  end subroutine hold_ties

  !> Break bonds that reach their strengths under the loads in the memory; what their springs hold
  !> is spent. Pressure does not help to break one.
  pure subroutine break_ties(strength, time, memory, n_new)
    real(wp), intent(in) :: strength(2) !! NFLS, SFLS, N/m^2
    real(wp), intent(in) :: time        !! s
    type(contact_state_t), intent(inout) :: memory
    integer, intent(out) :: n_new       !! sites that have broken
    logical :: fails(size(memory%ties%site))
    real(wp) :: before

    associate (ties => memory%ties, scratch => memory%scratch)
      fails = ties%state(ties%site) == is_held .and. .not. &
        (max(0.0_wp, -ties%to_stress*ties%pressure)/strength(1))**2 &
        + (ties%to_stress*ties%traction/strength(2))**2 < 1.0_wp
      scratch%n_freed = 0
      n_new = -count(ties%state == is_broken)
      scratch%is_freed = is_tied_site(ties%state)
      ties%state(pack(ties%site, fails)) = is_broken
      n_new = n_new + count(ties%state == is_broken)
      if (n_new == 0) return
      if (.not. (memory%has%virtual_nodes .or. memory%has%nodal_pressure)) &
        call mark_beside(memory%tie_points, ties)
      scratch%is_freed = scratch%is_freed .and. .not. is_tied_site(ties%state)
      scratch%n_freed = count(scratch%is_freed)
      if (.not. ties%first_break > 0.0_wp) ties%first_break = time
      ties%last_break = time
      before = tie_energy(memory)
      call unload_broken(ties)
      call share_loads(memory%has%nodal_pressure, ties, memory%tie_points)
      ties%spent = ties%spent + (before - tie_energy(memory))
    end associate
  end subroutine break_ties

  !> Broken bonds carry nothing.
  pure subroutine unload_broken(ties)
    type(tie_memory_t), intent(inout) :: ties

    where (ties%state(ties%site) /= is_held)
      ties%pressure = 0.0_wp
      ties%traction = 0.0_wp
    end where
  end subroutine unload_broken

  !> Stiffness of bonds, N/m^2.
  pure function bond_stiffness(memory) result(stiffness)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: stiffness(size(memory%ties%area))

    stiffness = memory%slave_penalty
    if (.not. memory%has%nodal_pressure) &
      stiffness = memory%tie_points%stiffness(memory%ties%first(:size(stiffness)))
  end function bond_stiffness

  !> Loads of bonds from the stretches of springs in one direction, N/m^2.
  pure function bond_loads(memory, stretches) result(loads)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in), contiguous :: stretches(:) !! m
    real(wp) :: loads(size(memory%ties%area))
    real(wp) :: nodal(2, memory%n_slave)

    if (memory%has%nodal_pressure) then
      call average_values(memory%tie_points, stretches, memory%n_slave, nodal)
      loads = bond_stiffness(memory)*nodal(1, :)
    else
      loads = bond_stiffness(memory)*stretches
    end if
  end function bond_loads

  !> Pressures and tractions of the points from those of bonds.
  pure subroutine share_loads(has_nodal_pressure, ties, points)
    logical, intent(in) :: has_nodal_pressure
    type(tie_memory_t), intent(in) :: ties
    type(contact_points_t), intent(inout) :: points
    integer :: s

    if (has_nodal_pressure) then
      call share_out(points%n, points%slave_nodes, points%slave_weights, ties%pressure, &
        points%pressure)
      call share_out(points%n, points%slave_nodes, points%slave_weights, ties%traction, &
        points%traction)
    else
      do s = 1, size(ties%side)
        points%pressure(ties%first(s):ties%first(s + 1) - 1) = ties%pressure(s)
        points%traction(ties%first(s):ties%first(s + 1) - 1) = ties%traction(s)
      end do
    end if
  end subroutine share_loads

  !> Forces of all springs: those of their points, and the couples. They are the first ones of the
  !> interface.
  subroutine scatter_ties(springs, memory)
    type(tie_spring_t), intent(in) :: springs(:)
    type(contact_state_t), intent(inout) :: memory
    integer :: s

    associate (ties => memory%ties, points => memory%tie_points)
      call scatter_tractions(points, ties%force, memory%force)
      call scatter(points, points%pressure, memory%force)
      do s = 1, size(springs)
        if (.not. has_state(memory, s, [is_held])) cycle
        ties%n_held = ties%n_held + ties%first(s + 1) - ties%first(s)
        call add_couple(springs(s), ties, points, s, memory%force)
      end do
      ties%force = memory%force
    end associate
  end subroutine scatter_ties

  !> The moment d x load of the pair of forces of a spring is taken up by its segment.
  pure subroutine add_couple(spring, ties, points, s, force)
    type(tie_spring_t), intent(in) :: spring
    type(tie_memory_t), intent(in) :: ties
    type(contact_points_t), intent(in) :: points
    integer, intent(in) :: s
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, n_node) of the interface, N/m
    real(wp) :: total(2), couple(2)
    integer :: p

    total = 0.0_wp
    do p = ties%first(s), ties%first(s + 1) - 1
      total = total + points%area(p)*(points%pressure(p)*spring%n - points%traction(p)*spring%t)
    end do
    couple = ties%side(s)*(spring%d(1)*total(2) - spring%d(2)*total(1))/spring%length*spring%n
    force(:, ties%owner(1, s)) = force(:, ties%owner(1, s)) - couple
    force(:, ties%owner(2, s)) = force(:, ties%owner(2, s)) + couple
  end subroutine add_couple

  !> Bonds as springs; none outside birth .. death.
  pure function tie_springs(memory) result(springs)
    type(contact_state_t), intent(in) :: memory
    type(spring_t), allocatable :: springs(:)
    real(wp) :: stiffness(size(memory%ties%area)), square
    integer :: b, p

    associate (points => memory%tie_points, ties => memory%ties)
      allocate (springs(merge(size(ties%area), 0, points%n > 0)))
      if (points%n > 0) stiffness = bond_stiffness(memory)
      do b = 1, size(springs)
        springs(b)%site = ties%site(b)
        springs(b)%node = b
        if (.not. memory%has%nodal_pressure) then
          p = ties%first(b)
          springs(b)%node = points%slave_nodes(maxloc(points%slave_weights(:, p), 1), p)
        end if
        square = ties%pressure(b)**2 + ties%traction(b)**2
        springs(b)%energy = ties%area(b)*square/(2.0_wp*stiffness(b))
        springs(b)%load = ties%area(b)*sqrt(square)
      end do
    end associate
  end function tie_springs

  !> What all springs store, J/m.
  pure function tie_energy(memory) result(energy)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: energy
    type(spring_t), allocatable :: springs(:)

    springs = tie_springs(memory)
    energy = sum(springs%energy)
  end function tie_energy

  !> Whether a spring, or a part of it, is in one of some states.
  pure function has_state(memory, s, states) result(has)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, states(:) !! is_held or is_broken
    logical :: has
    integer :: bonds(n_side), k

    bonds = s
    if (memory%has%nodal_pressure) &
      bonds = memory%tie_points%slave_nodes(:, memory%ties%first(s))
    has = .false.
    do k = 1, n_side
      has = has .or. any(memory%ties%state(memory%ties%site(bonds(k))) == states)
    end do
  end function has_state

  !> Whether a tie keeps a site of this state out of contact.
  elemental function is_tied_site(state) result(is_tied)
    integer, intent(in) :: state
    logical :: is_tied

    is_tied = state == is_held .or. state == is_beside
  end function is_tied_site

  !> Which nodes of the interface have springs in one of some states.
  pure function tied_nodes(memory, states) result(is_tied)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: states(:) !! is_held or is_broken
    logical :: is_tied(memory%n_slave + memory%n_master)
    integer :: s, p, k

    is_tied = .false.
    if (memory%tie_points%n == 0) return
    associate (ties => memory%ties, points => memory%tie_points)
      do s = 1, size(ties%side)
        if (.not. has_state(memory, s, states)) cycle
        do p = ties%first(s), ties%first(s + 1) - 1
          do k = 1, n_side
            associate (a => is_tied(points%slave_nodes(k, p)), &
              b => is_tied(points%master_nodes(k, p)))
              a = a .or. points%slave_weights(k, p) > 0.0_wp
              b = b .or. points%master_weights(k, p) > 0.0_wp
            end associate
          end do
        end do
      end do
    end associate
  end function tied_nodes

end module ties_m
