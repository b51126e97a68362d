! SPDX-License-Identifier: MIT
!> From points to nodal forces.
module contact_scatter_m
  use contact_state_m, only : contact_points_t, contact_state_t, n_side, n_load
  use kinds_m, only : wp
  implicit none
  private
  public :: scatter_forces, scatter_points, scatter_damped, join_passes, add_gap_round_off

  !> Points whose loads are formed together.
  integer, parameter :: n_block = 128

contains

  !> Add the forces of all points on the list to those of the interface's nodes, those of damping
  !> and of friction to their own too, and count the points that carry any.
  pure subroutine scatter_forces(memory)
    type(contact_state_t), intent(inout) :: memory

    if (allocated(memory%damping_force)) then
      call scatter_damped(memory%points, memory%force, memory%damping_force, memory%n_active)
      if (allocated(memory%friction%force)) call scatter_rubbed(0.0_wp, memory)
    else if (allocated(memory%friction%force)) then
      call scatter_rubbed(1.0_wp, memory)
    else
      call scatter_points(memory%points, memory%force, memory%n_active)
    end if
  end subroutine scatter_forces

  !> Add the force of each point to its nodes: pressure*area*normal by the weights, slave side with
  !> plus and master side with minus. Counts the points that carry pressure.
  pure subroutine scatter_points(points, force, n_active)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(inout) :: force(2, *) !! by local node, N/m
    integer, intent(out) :: n_active

    n_active = count(points%pressure(:points%n) > 0.0_wp)
    call scatter_each(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
      points%master_weights, points%normal, points%pressure, points%area, force)
  end subroutine scatter_points

  !> The same, and in the same pass that of damping to nodal forces of its own.
  pure subroutine scatter_damped(points, force, damping_force, n_active)
    type(contact_points_t), intent(inout) :: points !! with loads, those of damping known
    real(wp), intent(inout) :: force(2, *), damping_force(2, *) !! by local node, N/m
    integer, intent(out) :: n_active
    integer :: p

    n_active = count(points%pressure(:points%n) > 0.0_wp)
    do p = 1, points%n
      points%load(1:2, p) = points%pressure(p)*points%area(p)*points%normal(:, p)
    end do
    call scatter_loads(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
      points%master_weights, points%load, force, damping_force)
  end subroutine scatter_damped

  !> Add pressures, unless they have been added, and tractions of all points to the forces of the
  !> interface's nodes, and tractions to those of friction, which are zero before. They act along
  !> -t = -(-n_y, n_x). Damping may leave a point with a traction alone: it counts too.
  pure subroutine scatter_rubbed(part, memory)
    real(wp), intent(in) :: part !! of the pressures: 1 or 0
    type(contact_state_t), intent(inout) :: memory
    real(wp) :: load(n_load, n_block)
    integer :: first, n

    associate (points => memory%points)
      do first = 1, points%n, n_block
        n = min(n_block, points%n - first + 1)
        call form_loads(n, part, points%pressure(first), points%traction(first), &
          points%area(first), points%normal(1, first), load)
        call scatter_loads(n, points%slave_nodes(1, first), points%slave_weights(1, first), &
          points%master_nodes(1, first), points%master_weights(1, first), load, memory%force, &
          memory%friction%force)
      end do
      memory%n_active = count(points%pressure(:points%n) > 0.0_wp &
        .or. abs(points%traction(:points%n)) > 0.0_wp)
    end associate
  end subroutine scatter_rubbed

  !> Loads of points: of pressure and friction together, and of friction alone.
  pure subroutine form_loads(n, part, pressure, traction, area, normal, load)
    integer, intent(in) :: n
    real(wp), intent(in) :: part !! of the pressures
    real(wp), intent(in) :: pressure(n), traction(n), area(n), normal(2, n)
    real(wp), intent(inout) :: load(n_load, n)
    real(wp) :: press, rub
    integer :: p

    !$omp simd private(press, rub)
    do p = 1, n
      press = part*pressure(p)*area(p)
      rub = traction(p)*area(p)
      load(3, p) = rub*normal(2, p)
      load(4, p) = -rub*normal(1, p)
      load(1, p) = press*normal(1, p) + load(3, p)
      load(2, p) = press*normal(2, p) + load(4, p)
    end do
  end subroutine form_loads

  !> On arrays of known shape: through the list each access costs a multiplication by its stride. A
  !> point at a node has it at both ends of that side, and all of the force goes there. The forces
  !> of points in a row with the same nodes on a side are summed before these get them: a sum in
  !> memory has to be stored before it can be read again. Both components of a node are read before
  !> one is written, so that pairs stay pairs in the registers.
  pure subroutine scatter_each(n, slave_nodes, slave_weights, master_nodes, master_weights, &
      normal, pressure, area, force)
    integer, intent(in) :: n
    integer, intent(in) :: slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: normal(2, *), pressure(*), area(*)
    real(wp), intent(inout) :: force(2, *)
    real(wp), dimension(2) :: point, to_a, to_b, to_c, to_d
    integer :: p, a, b, c, d

    if (n == 0) return
    a = slave_nodes(1, 1); b = slave_nodes(2, 1)
    c = master_nodes(1, 1); d = master_nodes(2, 1)
    to_a = 0.0_wp; to_b = 0.0_wp; to_c = 0.0_wp; to_d = 0.0_wp
    !GCC$ NOVECTOR
    do p = 1, n
      point = pressure(p)*area(p)*normal(:, p)
      if (master_nodes(1, p) /= c .or. master_nodes(2, p) /= d) then
        call give(to_c, force(1, c))
        call give(to_d, force(1, d))
        c = master_nodes(1, p); d = master_nodes(2, p)
      end if
      to_c = to_c - master_weights(1, p)*point
      to_d = to_d - master_weights(2, p)*point
      if (slave_nodes(1, p) == slave_nodes(2, p)) then
        call give(point, force(1, slave_nodes(1, p)))
      else
        if (slave_nodes(1, p) /= a .or. slave_nodes(2, p) /= b) then
          call give(to_a, force(1, a))
          call give(to_b, force(1, b))
          a = slave_nodes(1, p); b = slave_nodes(2, p)
        end if
        to_a = to_a + slave_weights(1, p)*point
        to_b = to_b + slave_weights(2, p)*point
      end if
    end do
    call give(to_a, force(1, a))
    call give(to_b, force(1, b))
    call give(to_c, force(1, c))
    call give(to_d, force(1, d))
  end subroutine scatter_each

  !> The same of loads that are known: forces, and a part of them that nodes have apart as well.
  pure subroutine scatter_loads(n, slave_nodes, slave_weights, master_nodes, master_weights, load, &
      force, part_force)
    integer, intent(in) :: n
    integer, intent(in) :: slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: load(n_load, *)
    real(wp), intent(inout) :: force(2, *), part_force(2, *)
    real(wp), dimension(n_load) :: point, to_a, to_b, to_c, to_d
    integer :: p, a, b, c, d

    if (n == 0) return
    a = slave_nodes(1, 1); b = slave_nodes(2, 1)
    c = master_nodes(1, 1); d = master_nodes(2, 1)
    to_a = 0.0_wp; to_b = 0.0_wp; to_c = 0.0_wp; to_d = 0.0_wp
    do p = 1, n
      point = load(:, p)
      if (master_nodes(1, p) /= c .or. master_nodes(2, p) /= d) then
        call give_parts(to_c, force(1, c), part_force(1, c))
        call give_parts(to_d, force(1, d), part_force(1, d))
        c = master_nodes(1, p); d = master_nodes(2, p)
      end if
      to_c = to_c - master_weights(1, p)*point
      to_d = to_d - master_weights(2, p)*point
      if (slave_nodes(1, p) == slave_nodes(2, p)) then
        call give_parts(point, force(1, slave_nodes(1, p)), part_force(1, slave_nodes(1, p)))
      else
        if (slave_nodes(1, p) /= a .or. slave_nodes(2, p) /= b) then
          call give_parts(to_a, force(1, a), part_force(1, a))
          call give_parts(to_b, force(1, b), part_force(1, b))
          a = slave_nodes(1, p); b = slave_nodes(2, p)
        end if
        to_a = to_a + slave_weights(1, p)*point
        to_b = to_b + slave_weights(2, p)*point
      end if
    end do
    call give_parts(to_a, force(1, a), part_force(1, a))
    call give_parts(to_b, force(1, b), part_force(1, b))
    call give_parts(to_c, force(1, c), part_force(1, c))
    call give_parts(to_d, force(1, d), part_force(1, d))
  end subroutine scatter_loads

  !> Give both parts of a sum to a node; they are zero then.
  pure subroutine give_parts(parts, force, part_force)
    real(wp), intent(inout) :: parts(n_load), force(2), part_force(2)

    call give(parts(1:2), force)
    call give(parts(3:4), part_force)
  end subroutine give_parts

  !> Give a sum to a node; it is zero then.
  pure subroutine give(part, force)
    real(wp), intent(inout) :: part(2), force(2)
    real(wp) :: total(2)

    total = force + part
    force = total
    part = 0.0_wp
  end subroutine give

  !> A surface with itself has each node as slave and as master: all of its force to the slave.
  pure subroutine join_passes(memory)
    type(contact_state_t), intent(inout) :: memory

    call join(memory%force)
    if (allocated(memory%damping_force)) call join(memory%damping_force)
    if (allocated(memory%friction%force)) call join(memory%friction%force)

  contains

    !> One list of forces.
    pure subroutine join(force)
      real(wp), intent(inout), contiguous :: force(:, :) !! (2, n_slave + n_master)

      associate (n => memory%n_slave)
        force(:, :n) = force(:, :n) + force(:, n + 1:)
        force(:, n + 1:) = 0.0_wp
      end associate
    end subroutine join

  end subroutine join_passes

  !> What the rounding of places, one part in 1/epsilon of them, makes of the nodal forces of all
  !> pressed points: a gap along n is known to n_x X and n_y Y. Times epsilon it is a force.
  pure subroutine add_gap_round_off(memory, total)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(inout), contiguous :: total(:, :) !! (2, n_node of the mesh) N/m
    real(wp) :: force, normal(2)
    integer :: p, k, node

    associate (points => memory%points)
      do p = 1, points%n
        if (.not. abs(points%pressure(p)) > 0.0_wp) cycle
        normal = abs(points%normal(:, p))
        node = points%master_nodes(1, p)
        force = points%stiffness(p)*points%area(p) &
          *dot_product(normal, abs(memory%places(1:2, node)))
        do k = 1, n_side
          node = memory%nodes(points%slave_nodes(k, p))
          total(:, node) = total(:, node) + abs(points%slave_weights(k, p))*force*normal
          node = memory%nodes(points%master_nodes(k, p))
          total(:, node) = total(:, node) + abs(points%master_weights(k, p))*force*normal
        end do
      end do
    end associate
  end subroutine add_gap_round_off

end module contact_scatter_m
