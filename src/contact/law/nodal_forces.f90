! SPDX-License-Identifier: MIT
!> Between points and nodes, and from these to the mesh: gaps averaged at slave nodes and what is
!> formed there shared out, nodal forces from what acts at points, and the work of these by the
!> trapezoidal rule: half a step by the previous forces, half by the present ones, with the velocity
!> between them. That of ties, of damping and of friction is kept apart from that of the springs.
module nodal_forces_m
  use contact_state_m, only : contact_points_t, contact_state_t, n_side
  use law_state_m, only : friction_memory_t
  use kinds_m, only : wp
  implicit none
  private
  public :: scatter_forces, scatter_tractions, scatter, join_passes, add_gap_round_off, &
    average_values, share_out, previous_work_t, store_previous_work, apply_forces, count_step, &
    clear_force, power_of, add_force

  !> Of the previous forces, what is kept apart from the springs.
  type :: previous_work_t
    real(wp) :: ties = 0.0_wp       !! power, W/m
    real(wp) :: damping = 0.0_wp    !! power, W/m
    real(wp) :: friction = 0.0_wp   !! power, W/m
    real(wp) :: dissipated = 0.0_wp !! by friction so far, J/m
  end type previous_work_t

contains

  !> Add the forces of all points on the list to those of the interface's nodes, those of damping
  !> and of friction, which are zero before, to their own too, and count the points that carry any.
  !> Damping may leave a point with a traction alone: it counts too.
  pure subroutine scatter_forces(memory)
    type(contact_state_t), intent(inout) :: memory

    associate (points => memory%points, n => memory%points%n)
      call scatter(points, points%pressure, memory%force)
      memory%n_active = count(points%pressure(:n) > 0.0_wp)
      if (memory%has%damping) &
        call scatter(points, points%damping, memory%damping_force)
      if (.not. memory%has%friction) return
      call scatter_tractions(points, memory%friction%force, memory%force)
      memory%n_active = count(points%pressure(:n) > 0.0_wp .or. abs(points%traction(:n)) > 0.0_wp)
    end associate
  end subroutine scatter_forces

  !> The part of tractions, which is zero before, and this added to the forces. They act along
  !> -t = (n_y, -n_x): nodes are given them along n, and turned by a right angle.
  pure subroutine scatter_tractions(points, part, force)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(inout), contiguous :: part(:, :), force(:, :) !! (2, nodes) N/m
    real(wp) :: along_n
    integer :: i

    call scatter(points, points%traction, part)
    do i = 1, size(part, 2)
      along_n = part(1, i)
      part(1, i) = part(2, i)
      part(2, i) = -along_n
      force(1, i) = force(1, i) + part(1, i)
      force(2, i) = force(2, i) + part(2, i)
    end do
  end subroutine scatter_tractions

  !> Add load*area*normal of each point to its nodes by the weights, slave side with plus and master
  !> side with minus, in the order of the list.
  pure subroutine scatter(points, load, force)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: load(:)        !! (points%n or more) N/m^2
    real(wp), intent(inout), contiguous :: force(:, :) !! (2, nodes) N/m

    call scatter_each(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
      points%master_weights, points%normal, load, points%area, force)
  end subroutine scatter

  !> Scatter on arrays of known shape: through the list each access costs a multiplication by its
  !> stride.
  pure subroutine scatter_each(n, slave_nodes, slave_weights, master_nodes, master_weights, &
      normal, load, area, force)
    integer, intent(in) :: n
    integer, intent(in) :: slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: normal(2, *), load(*), area(*)
    real(wp), intent(inout) :: force(2, *)
    real(wp) :: point(2)
    integer :: p, k

    do p = 1, n
      point = load(p)*area(p)*normal(:, p)
      do k = 1, n_side
        associate (a => slave_nodes(k, p), b => master_nodes(k, p))
          force(:, a) = force(:, a) + slave_weights(k, p)*point
          force(:, b) = force(:, b) - master_weights(k, p)*point
        end associate
      end do
    end do
  end subroutine scatter_each

  !> A surface with itself has each node as slave and as master: all of its force to the slave.
  pure subroutine join_passes(memory)
    type(contact_state_t), intent(inout) :: memory

    call join(memory%force)
    if (memory%has%damping) call join(memory%damping_force)
    if (memory%has%friction) call join(memory%friction%force)

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

  !> What the rounding of sites, one part in 1/epsilon of them, makes of the nodal forces of all
  !> loaded points: a gap along n is known to n_x X and n_y Y. Times epsilon it is a force.
  pure subroutine add_gap_round_off(points, positions, nodes, total)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: positions(:, :) !! (4, n_node) of the interface
    integer, intent(in), contiguous :: nodes(:)         !! mesh index of each local node
    real(wp), intent(inout), contiguous :: total(:, :)  !! (2, n_node of the mesh) N/m
    real(wp) :: force, normal(2)
    integer :: p, k, node

    do p = 1, points%n
      if (.not. abs(points%pressure(p)) > 0.0_wp) cycle
      normal = abs(points%normal(:, p))
      force = points%stiffness(p)*points%area(p) &
        *dot_product(normal, abs(positions(1:2, points%master_nodes(1, p))))
      do k = 1, n_side
        node = nodes(points%slave_nodes(k, p))
        total(:, node) = total(:, node) + abs(points%slave_weights(k, p))*force*normal
        node = nodes(points%master_nodes(k, p))
        total(:, node) = total(:, node) + abs(points%master_weights(k, p))*force*normal
      end do
    end do
  end subroutine add_gap_round_off

  !> Averages of values of points at the slave nodes, g_A = sum(N_A a g)/sum(N_A a) (Fischer &
  !> Wriggers 2005); 0 where there is no point.
  pure subroutine average_values(points, values, n_slave, nodal)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: values(:) !! (points%n or more)
    integer, intent(in) :: n_slave
    real(wp), intent(inout) :: nodal(2, *) !! (2, n_slave or more) out: averages, areas
    integer :: node

    do node = 1, n_slave
      nodal(1, node) = 0.0_wp
      nodal(2, node) = 0.0_wp
    end do
    call sum_values(points%n, points%slave_nodes, points%slave_weights, points%area, values, nodal)
    do node = 1, n_slave
      nodal(1, node) = nodal(1, node)/max(nodal(2, node), tiny(1.0_wp))
    end do
  end subroutine average_values

  !> Values of points from those of the slave nodes, by the slave shape functions.
  pure subroutine share_out(n, slave_nodes, slave_weights, at_node, at_point)
    integer, intent(in) :: n, slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), at_node(*)
    real(wp), intent(inout) :: at_point(*)
    integer :: p

    !GCC$ NOVECTOR
    do p = 1, n
      at_point(p) = slave_weights(1, p)*at_node(slave_nodes(1, p)) &
        + slave_weights(2, p)*at_node(slave_nodes(2, p))
    end do
  end subroutine share_out

  !> Sums of weight times area times value, and of weight times area, by slave node.
  pure subroutine sum_values(n, slave_nodes, slave_weights, area, values, nodal)
    integer, intent(in) :: n, slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), area(*), values(*)
    real(wp), intent(inout) :: nodal(2, *)
    real(wp) :: content(2)
    integer :: p, k

    do p = 1, n
      content = [area(p)*values(p), area(p)]
      do k = 1, n_side
        associate (a => slave_nodes(k, p))
          nodal(:, a) = nodal(:, a) + slave_weights(k, p)*content
        end associate
      end do
    end do
  end subroutine sum_values

  !> Power of the previous forces of damping and of friction, which are zero then; tangential
  !> springs hold nothing until their tractions are formed.
  pure subroutine store_previous_work(motion, had_force, memory, previous_work)
    real(wp), intent(in), contiguous :: motion(:, :)
    logical, intent(in) :: had_force !! the previous call
    type(contact_state_t), intent(inout) :: memory
    type(previous_work_t), intent(out) :: previous_work

    if (memory%has%ties) &
      previous_work%ties = power_of(memory%nodes, motion, memory%ties%force)
    if (memory%has%damping) &
      call clear_force(memory%nodes, motion, memory%damping_force, previous_work%damping)
    if (.not. memory%has%friction) return
    associate (friction => memory%friction)
      call clear_force(memory%nodes, motion, friction%force, previous_work%friction)
      previous_work%dissipated = friction%work - friction%stored
      friction%stored = 0.0_wp
      if (.not. had_force) call store_dissipated(previous_work%dissipated, friction)
    end associate
  end subroutine store_previous_work

  !> Add the forces to those of the mesh and count the work of a step, that of damping and of
  !> friction apart: half of it was done by the previous forces.
  pure subroutine apply_forces(dt, motion, previous, memory, force)
    real(wp), intent(in) :: dt
    real(wp), intent(in), contiguous :: motion(:, :)
    type(previous_work_t), intent(in) :: previous
    type(contact_state_t), intent(inout) :: memory
    real(wp), intent(inout), contiguous :: force(:, :)
    real(wp) :: power, damping, friction !! of previous and present forces, W/m

    call add_force(memory%nodes, memory%scratch%previous_force, memory%force, motion, force, power)
    damping = previous%damping
    if (memory%has%damping) damping = damping &
      + power_of(memory%nodes, motion, memory%damping_force)
    friction = previous%friction
    if (memory%has%friction) friction = friction &
      + power_of(memory%nodes, motion, memory%friction%force)
    memory%energy = memory%energy - 0.5_wp*dt*(power - damping - friction)
    if (memory%has%ties) memory%ties%energy = memory%ties%energy - 0.5_wp*dt*(previous%ties &
      + power_of(memory%nodes, motion, memory%ties%force))
    memory%damping_work = memory%damping_work - 0.5_wp*dt*damping
    if (memory%has%friction) then
      memory%friction%work = memory%friction%work - 0.5_wp*dt*friction
      call store_dissipated(previous%dissipated, memory%friction)
    end if
    associate (limit => memory%limit)
      limit%largest = max(limit%largest, memory%energy - memory%ties%energy + limit%admissible)
    end associate
  end subroutine apply_forces

  !> What is dissipated does not come back: tangential springs hold no more than the work that has
  !> been done on them. Where forces are limited or areas change while positions stick, the
  !> tractions alone would say more.
  pure subroutine store_dissipated(dissipated, friction)
    real(wp), intent(in) :: dissipated !! before, J/m
    type(friction_memory_t), intent(inout) :: friction

    friction%stored = min(friction%stored, friction%work - dissipated)
  end subroutine store_dissipated

  !> Work of an implicit step.
  pure subroutine count_step(motion, before, after)
    real(wp), intent(in), contiguous :: motion(:, :) !! (4, n_node) rows 3, 4: displacement
    type(contact_state_t), intent(in) :: before      !! where the step starts
    type(contact_state_t), intent(inout) :: after    !! where it ends
    real(wp) :: work, friction_work

    work = sum((before%force + after%force)*motion(3:4, after%nodes))
    friction_work = 0.0_wp
    if (after%has%friction) friction_work = sum((before%friction%force &
      + after%friction%force)*motion(3:4, after%nodes))
    after%energy = before%energy + (after%interference%work - before%interference%work) &
      - 0.5_wp*(work - friction_work)
    if (.not. after%has%friction) return
    after%friction%work = before%friction%work - 0.5_wp*friction_work
    call store_dissipated(before%friction%work - before%friction%stored, after%friction)
  end subroutine count_step

  !> Power of nodal forces with the velocities of the nodes; the forces are zero afterwards.
  pure subroutine clear_force(nodes, motion, force, power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(inout) :: force(2, *)
    real(wp), intent(out) :: power
    integer :: i

    power = power_of(nodes, motion, force)
    do i = 1, size(nodes)
      force(1, i) = 0.0_wp
      force(2, i) = 0.0_wp
    end do
  end subroutine clear_force

  !> Power of nodal forces with the velocities of the nodes, W/m.
  pure function power_of(nodes, motion, force) result(power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: motion(4, *)
    real(wp), intent(in) :: force(2, *)
    real(wp) :: power
    integer :: i

    power = 0.0_wp
    do i = 1, size(nodes)
      power = power + (motion(3, nodes(i))*force(1, i) + motion(4, nodes(i))*force(2, i))
    end do
  end function power_of

  !> Add the forces of the interface to those of the mesh. Their power and that of the previous
  !> ones, with the same velocity, are formed on the way: v is read once. The previous ones are zero
  !> afterwards: to clear them here costs less than to go through them once more. By one thread: a
  !> node may be on both surfaces, and an eroded surface may pass through a node twice.
  pure subroutine add_force(nodes, previous, present, motion, force, power)
    integer, intent(in), contiguous :: nodes(:)
    real(wp), intent(in) :: present(2, *), motion(4, *)
    real(wp), intent(inout) :: previous(2, *), force(2, *)
    real(wp), intent(out) :: power !! of both, W/m
    integer :: i

    power = 0.0_wp
    do i = 1, size(nodes)
      associate (v => motion(3:4, nodes(i)), total => force(:, nodes(i)))
        total(1) = total(1) + present(1, i)
        total(2) = total(2) + present(2, i)
        power = power + (v(1)*(previous(1, i) + present(1, i)) &
          + v(2)*(previous(2, i) + present(2, i)))
      end associate
      previous(1, i) = 0.0_wp
      previous(2, i) = 0.0_wp
    end do
  end subroutine add_force

end module nodal_forces_m
