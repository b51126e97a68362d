! SPDX-License-Identifier: MIT
!> Ties (doc/theory/contact.md, section 6.3): springs of both signs along the current
!> normal and tangent of a segment, between sites that were frozen in the reference geometry. With
!> d from the master site to the slave site, d0 and n0, t0 in the reference geometry, a = d.n -
!> d0.n0, b = d.t - d0.t0, each spring stores k w (a^2 + b^2)/2, and its forces are the exact
!> gradient: -k w (a n + b t) on the slave side, the opposite on the master side, and the couple
!> k w (b d.n - a d.t) on the segment that n and t turn with, so that the net moment vanishes.
module ties_m
  use contact_penalty_m, only : mean_length
  use contact_state_m, only : contact_state_t, contact_points_t, n_side
  use contact_scatter_m, only : scatter, scatter_tractions, average_values, share_out
  use contacts_m, only : contact_t
  use geometry_m, only : separation
  use kinds_m, only : wp
  use model_m, only : model_t
  use law_state_m, only : allocate_ties, is_held, is_broken
  use tiebreak_m, only : mark_breaks, let_go, has_state
  implicit none
  private
  public :: tie_spring_t, tie_distance, freeze_ties, hold_ties, tie_energy, tie_spring, &
    tie_stiffness, stiffness_of_nodes, tied_nodes, break_ties

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
    call select_points(reach, memory%tie_points)
    call allocate_ties(memory%ties, spring_starts(memory), size(memory%nodes))
    associate (ties => memory%ties, points => memory%tie_points)
      do s = 1, size(ties%side)
        call find_owner(contact, placed, s, memory)
        ties%lag(:, s) = mean_separation(memory, s, 1)
        spring = tie_spring(memory, s)
        ties%offset(:, s) = [dot_product(spring%d, spring%n), dot_product(spring%d, spring%t)]
      end do
      if (memory%has%nodal_pressure) then
        call average_values(points, points%gap, memory%n_slave, memory%scratch%nodal)
        ties%area = memory%scratch%nodal(2, :memory%n_slave)
      else
        ties%area = [(sum(points%area(ties%first(s):ties%first(s + 1) - 1)), s=1, size(ties%side))]
      end if
      allocate (ties%pressure(size(ties%area)), ties%traction(size(ties%area)), source=0.0_wp)
      allocate (points%traction(size(points%gap)), source=0.0_wp)
    end associate
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
      points%slave_nodes(:, n) = points%slave_nodes(:, p)
      points%slave_weights(:, n) = points%slave_weights(:, p)
      points%master_nodes(:, n) = points%master_nodes(:, p)
      points%master_weights(:, n) = points%master_weights(:, p)
      points%normal(:, n) = points%normal(:, p)
      points%gap(n) = points%gap(p)
      points%area(n) = points%area(p)
      points%stiffness(n) = points%stiffness(p)
    end do
    points%n = n
  end subroutine select_points

  !> The first point of each spring, then the end.
  pure function spring_starts(memory) result(first)
    type(contact_state_t), intent(in) :: memory
    integer, allocatable :: first(:)
    integer :: p

    first = [integer ::]
    do p = 1, memory%tie_points%n
      if (p > 1) then
        if (is_same_spring(memory, p - 1)) cycle
      end if
      first = [first, p]
    end do
    first = [first, memory%tie_points%n + 1]
  end function spring_starts

  !> Whether a point and the next one belong to one spring: sub-segments of one virtual node.
  pure function is_same_spring(memory, p) result(same)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: p
    logical :: same

    same = .false.
    if (.not. has_virtual_nodes(memory)) return
    associate (points => memory%tie_points)
      same = all(points%slave_nodes(:, p) == points%slave_nodes(:, p + 1)) .and. &
        .not. abs(points%slave_weights(1, p) - points%slave_weights(1, p + 1)) > 0.0_wp
    end associate
  end function is_same_spring

  !> Whether springs are those of virtual nodes, with several points each.
  pure function has_virtual_nodes(memory) result(has)
    type(contact_state_t), intent(in) :: memory
    logical :: has

    has = memory%has%segment_points .and. .not. memory%has%nodal_pressure
  end function has_virtual_nodes

  !> The segment that the normal of a spring belongs to: the master's, for a virtual node the one
  !> below it, or the slave's where the master side is one node.
  pure subroutine find_owner(contact, placed, s, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: placed
    integer, intent(in) :: s
    type(contact_state_t), intent(inout) :: memory
    integer :: p, n, q

    p = memory%ties%first(s)
    associate (owner => memory%ties%owner(:, s), points => memory%tie_points)
      memory%ties%side(s) = 1.0_wp
      owner = points%master_nodes(:, p)
      if (owner(1) == owner(2)) then
        owner = points%slave_nodes(:, p)
        memory%ties%side(s) = -1.0_wp
      else if (has_virtual_nodes(memory)) then
        n = size(memory%segment_xi)
        q = minloc(abs(memory%segment_xi - points%slave_weights(2, p)), 1)
        owner = memory%n_slave + contact%master%segments(:, placed%slave_status%segment( &
          n*(contact%slave%outgoing(points%slave_nodes(1, p)) - 1) + q))
      end if
    end associate
  end subroutine find_owner

  !> Mean by area, over the points of a spring, of slave site minus master site: rows k and k + 1
  !> of the sites (1: in the reference geometry, 3: displacements), m.
  pure function mean_separation(memory, s, k) result(d)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s, k
    real(wp) :: d(2)
    real(wp) :: total
    integer :: p, i

    d = 0.0_wp
    total = 0.0_wp
    associate (points => memory%tie_points, positions => memory%positions)
      do p = memory%ties%first(s), memory%ties%first(s + 1) - 1
        do i = 1, n_side
          d = d + points%area(p)*( &
            points%slave_weights(i, p)*positions(k:k + 1, points%slave_nodes(i, p)) &
            - points%master_weights(i, p)*positions(k:k + 1, points%master_nodes(i, p)))
        end do
        total = total + points%area(p)
      end do
    end associate
    d = d/total
  end function mean_separation

  !> A spring at the sites in the memory.
  pure function tie_spring(memory, s) result(spring)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    type(tie_spring_t) :: spring
    real(wp) :: way(2)

    associate (ties => memory%ties, positions => memory%positions)
      way = separation(positions(:, ties%owner(2, s)), positions(:, ties%owner(1, s)))
      spring%length = max(sqrt(way(1)**2 + way(2)**2), tiny(1.0_wp))
      spring%t = ties%side(s)/spring%length*way
      spring%n = [spring%t(2), -spring%t(1)]
      spring%d = ties%lag(:, s) + mean_separation(memory, s, 3)
    end associate
  end function tie_spring

  !> Pressures, tractions and nodal forces of all springs at the sites in the memory. Pressures
  !> below zero are tension. Springs that reach their strengths break, where any are given.
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
        springs(s) = tie_spring(memory, s)
        do p = ties%first(s), ties%first(s + 1) - 1
          points%normal(:, p) = springs(s)%n
          points%gap(p) = dot_product(springs(s)%d, springs(s)%n)
        end do
        along_n(s) = dot_product(springs(s)%d, springs(s)%n) - ties%offset(1, s)
        along_t(s) = dot_product(springs(s)%d, springs(s)%t) - ties%offset(2, s)
      end do
      ties%pressure = -bond_loads(memory, along_n)
      ties%traction = bond_loads(memory, along_t)
    end associate
    if (memory%has%breaks) then
      if (strength(1) > 0.0_wp) call break_ties(strength, time, memory, n_new)
      call let_go(memory%ties)
    end if
    call share_loads(memory)
    call scatter_ties(springs, memory)
  end subroutine hold_ties

  !> Break what reaches its strength under the loads in the memory; what its springs hold is spent.
  pure subroutine break_ties(strength, time, memory, n_new)
    real(wp), intent(in) :: strength(2) !! NFLS, SFLS, N/m^2
    real(wp), intent(in) :: time        !! s
    type(contact_state_t), intent(inout) :: memory
    integer, intent(out) :: n_new       !! sites that have broken
    real(wp) :: before, after, load
    integer :: node

    call let_go(memory%ties)
    call tie_energy(memory, before, load, node)
    call mark_breaks(strength, time, memory, n_new)
    if (n_new == 0) return
    call let_go(memory%ties)
    call share_loads(memory)
    call tie_energy(memory, after, load, node)
    memory%ties%spent = memory%ties%spent + (before - after)
  end subroutine break_ties

  !> Loads of bonds, which are springs or slave nodes where pressure is formed, from the stretches
  !> of springs in one direction, N/m^2.
  pure function bond_loads(memory, stretches) result(loads)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(in), contiguous :: stretches(:) !! m
    real(wp) :: loads(size(memory%ties%area))
    real(wp) :: nodal(2, memory%n_slave)

    associate (first => memory%ties%first(:size(stretches)))
      if (memory%has%nodal_pressure) then
        call average_values(memory%tie_points, stretches, memory%n_slave, nodal)
        loads = memory%slave_penalty*nodal(1, :)
      else
        loads = memory%tie_points%stiffness(first)*stretches
      end if
    end associate
  end function bond_loads

  !> Pressures and tractions of the points from those of bonds.
  pure subroutine share_loads(memory)
    type(contact_state_t), intent(inout) :: memory
    integer :: s

    associate (points => memory%tie_points, ties => memory%ties)
      if (memory%has%nodal_pressure) then
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
    end associate
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
        if (.not. has_state(memory, s, is_held)) cycle
        ties%n_held = ties%n_held + ties%first(s + 1) - ties%first(s)
        call add_couple(springs(s), s, memory)
      end do
      ties%force = memory%force
    end associate
  end subroutine scatter_ties

  !> The moment d x load of the pair of forces of a spring is taken up by its segment.
  pure subroutine add_couple(spring, s, memory)
    type(tie_spring_t), intent(in) :: spring
    integer, intent(in) :: s
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: total(2), couple(2)
    integer :: p

    total = 0.0_wp
    associate (points => memory%tie_points, ties => memory%ties, force => memory%force)
      do p = ties%first(s), ties%first(s + 1) - 1
        total = total &
          + points%area(p)*(points%pressure(p)*spring%n - points%traction(p)*spring%t)
      end do
      couple = ties%side(s)*(spring%d(1)*total(2) - spring%d(2)*total(1))/spring%length*spring%n
      force(:, ties%owner(1, s)) = force(:, ties%owner(1, s)) - couple
      force(:, ties%owner(2, s)) = force(:, ties%owner(2, s)) + couple
    end associate
  end subroutine add_couple

  !> What all springs store, J/m, and where the largest force is.
  pure subroutine tie_energy(memory, energy, load, node)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(out) :: energy
    real(wp), intent(out) :: load !! N/m
    integer, intent(out) :: node  !! slave node next to it, by index in the mesh; 0: no load
    real(wp) :: square, stiffness
    integer :: b, i

    energy = 0.0_wp
    load = 0.0_wp
    node = 0
    if (memory%tie_points%n == 0) return
    associate (points => memory%tie_points, ties => memory%ties)
      do b = 1, size(ties%area)
        i = b
        stiffness = memory%slave_penalty
        if (.not. memory%has%nodal_pressure) then
          i = points%slave_nodes(maxloc(points%slave_weights(:, ties%first(b)), 1), ties%first(b))
          stiffness = points%stiffness(ties%first(b))
        end if
        square = ties%pressure(b)**2 + ties%traction(b)**2
        energy = energy + ties%area(b)*square/(2.0_wp*stiffness)
        if (.not. ties%area(b)*sqrt(square) > load) cycle
        load = ties%area(b)*sqrt(square)
        node = memory%nodes(i)
      end do
    end associate
  end subroutine tie_energy

  !> Stiffness times area of a spring, N/m.
  pure function tie_stiffness(memory, s) result(stiffness)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    real(wp) :: stiffness

    associate (last => memory%ties%first(s + 1) - 1, first => memory%ties%first(s))
      stiffness = sum(memory%tie_points%stiffness(first:last)*memory%tie_points%area(first:last))
    end associate
  end function tie_stiffness

  !> Most that the springs hold each node with, so that the sum over nodes of K u^2 bounds twice
  !> their energy, slave and master side each for itself (contact_step_limit_m): (sum of |a| |u|)^2
  !> <= sum of |a| times sum of |a| u^2, with a the weights and, on the nodes of the segment, what
  !> its turn moves at the distance |d|. Averages over slave nodes only lower it.
  pure function stiffness_of_nodes(memory) result(stiffness)
    type(contact_state_t), intent(in) :: memory
    real(wp) :: stiffness(memory%n_slave + memory%n_master) !! N/m
    type(tie_spring_t) :: spring
    real(wp) :: turn, sums(n_side), k, turning
    integer :: s, p, i

    stiffness = 0.0_wp
    if (memory%tie_points%n == 0) return
    associate (points => memory%tie_points, ties => memory%ties)
      do s = 1, size(ties%side)
        if (.not. has_state(memory, s, is_held)) cycle
        spring = tie_spring(memory, s)
        turn = norm2(spring%d)/spring%length
        do p = ties%first(s), ties%first(s + 1) - 1
          k = points%stiffness(p)*points%area(p)
          sums = [sum(abs(points%slave_weights(:, p))), sum(abs(points%master_weights(:, p)))]
          i = merge(2, 1, ties%side(s) > 0.0_wp)
          sums(i) = sums(i) + 2.0_wp*turn
          turning = k*sums(i)*turn
          do i = 1, n_side
            associate (a => stiffness(points%slave_nodes(i, p)))
              a = a + k*sums(1)*abs(points%slave_weights(i, p))
            end associate
            associate (b => stiffness(points%master_nodes(i, p)))
              b = b + k*sums(2)*abs(points%master_weights(i, p))
            end associate
            associate (c => stiffness(ties%owner(i, s)))
              c = c + turning
            end associate
          end do
        end do
      end do
    end associate
  end function stiffness_of_nodes

  !> Which nodes of the interface springs hold, or held.
  pure function tied_nodes(memory, held, broken) result(is_tied)
    type(contact_state_t), intent(in) :: memory
    logical, intent(in) :: held, broken !! by which springs: those that hold, or have broken in part
    logical :: is_tied(memory%n_slave + memory%n_master)
    integer :: s, p, k

    is_tied = .false.
    if (memory%tie_points%n == 0) return
    do s = 1, size(memory%ties%side)
      if (.not. ((held .and. has_state(memory, s, is_held)) &
        .or. (broken .and. has_state(memory, s, is_broken)))) cycle
      do p = memory%ties%first(s), memory%ties%first(s + 1) - 1
        do k = 1, n_side
          if (memory%tie_points%slave_weights(k, p) > 0.0_wp) &
            is_tied(memory%tie_points%slave_nodes(k, p)) = .true.
          if (memory%tie_points%master_weights(k, p) > 0.0_wp) &
            is_tied(memory%tie_points%master_nodes(k, p)) = .true.
        end do
      end do
    end do
  end function tied_nodes

end module ties_m
