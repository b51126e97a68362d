! SPDX-License-Identifier: MIT
!> From points to nodal forces; points with a pressure of their own are pressed on the way.
module contact_scatter_m
  use contact_penalty_m, only : press_each, share_pressure
  use contact_state_m, only : contact_points_t, contact_state_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: end_t, scatter_points, scatter_runs, scatter_averaged, scatter_range, close_run, &
    add_gap_round_off

  !> Points pressed and scattered together.
  integer, parameter :: block_size = 128

  !> What the last points in a row with the same nodes on a side give to one of these, and it has
  !> not got yet. Node and force in turn: with all forces in a row the compiler makes vectors of
  !> them and forms each sum twice.
  type :: end_t
    integer :: node = 0  !! 0: no points yet
    real(wp) :: force(2) !! N/m
  end type end_t

contains

  !> Add the force of each point to its nodes: pressure*area*normal by the weights, slave side with
  !> plus and master side with minus. Counts the points that carry pressure. Block by block, and
  !> where the pressure of each is not there yet (`is_unpressed`) it is formed on the way: a block
  !> stays in the cache, a long list does not (4 to 7 % of the contact at 100,000 nodes). It is not
  !> kept either (another 3 to 6 %): whoever wants it later asks `pressures_of`.
  pure subroutine scatter_points(points, is_unpressed, force, n_active)
    type(contact_points_t), intent(in) :: points
    logical, intent(in) :: is_unpressed
    real(wp), intent(inout) :: force(2, *) !! by local node, N/m
    integer, intent(out) :: n_active
    real(wp) :: pressure(block_size)
    integer :: p, n

    if (.not. is_unpressed) then
      call scatter_each(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
        points%master_weights, points%normal, points%pressure, points%area, force)
      n_active = count_active(points%n, points%pressure)
      return
    end if
    n_active = 0
    do p = 1, points%n, block_size
      n = min(block_size, points%n - p + 1)
      call press_each(n, points%stiffness(p), points%gap(p), pressure)
      call scatter_each(n, points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%master_weights(1, p), points%normal(1, p), pressure, &
        points%area(p), force)
      n_active = n_active + count_active(n, pressure)
    end do
  end subroutine scatter_points

  !> The same where several points in a row have the same nodes on a side, as on a slave segment.
  pure subroutine scatter_runs(points, force, n_active)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(inout) :: force(2, *) !! by local node, N/m
    integer, intent(out) :: n_active
    type(end_t) :: run(4)

    n_active = count_active(points%n, points%pressure)
    call scatter_in_runs(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
      points%master_weights, points%normal, points%pressure, points%area, run, force)
    call close_run(run, force)
  end subroutine scatter_runs

  !> The same where the pressure is shared out from the slave nodes and is not there yet: it is
  !> formed, kept and counted block by block.
  pure subroutine scatter_averaged(points, stiffness, nodal, force, n_active)
    type(contact_points_t), intent(inout) :: points
    real(wp), intent(in) :: stiffness      !! of all points, N/m^2
    real(wp), intent(in) :: nodal(2, *)    !! (1, :) minus the averaged gaps of slave nodes, m
    real(wp), intent(inout) :: force(2, *) !! by local node, N/m
    integer, intent(out) :: n_active
    type(end_t) :: run(4)
    integer :: p, n

    n_active = 0
    do p = 1, points%n, block_size
      n = min(block_size, points%n - p + 1)
      call share_pressure(n, points%slave_nodes(1, p), points%slave_weights(1, p), stiffness, &
        nodal, points%pressure(p))
      call scatter_in_runs(n, points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%master_weights(1, p), points%normal(1, p), &
        points%pressure(p), points%area(p), run, force)
      n_active = n_active + count_active(n, points%pressure(p))
    end do
    call close_run(run, force)
  end subroutine scatter_averaged

  !> The same for the next points of many that are not on the list together; the last run stays
  !> open, so that sums do not depend on where the list ends.
  pure subroutine scatter_range(points, run, force, n_active)
    type(contact_points_t), intent(in) :: points
    type(end_t), intent(inout) :: run(4) !! two of the slave side, two of the master side
    real(wp), intent(inout) :: force(2, *) !! by local node, N/m
    integer, intent(inout) :: n_active

    n_active = n_active + count_active(points%n, points%pressure)
    call scatter_in_runs(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
      points%master_weights, points%normal, points%pressure, points%area, run, force)
  end subroutine scatter_range

  !> Give the last run to its nodes.
  pure subroutine close_run(run, force)
    type(end_t), intent(inout) :: run(4) !! two of the slave side, two of the master side
    real(wp), intent(inout) :: force(2, *)
    real(wp) :: total(2)

    if (run(1)%node == 0) return
    associate (a => run(1), b => run(2), c => run(3), d => run(4))
      total = force(:, a%node) + a%force
      force(:, a%node) = total
      total = force(:, b%node) + b%force
      force(:, b%node) = total
      total = force(:, c%node) - c%force
      force(:, c%node) = total
      total = force(:, d%node) - d%force
      force(:, d%node) = total
    end associate
    run%node = 0
  end subroutine close_run

  !> Points that carry pressure.
  pure function count_active(n, pressure) result(n_active)
    integer, intent(in) :: n
    real(wp), intent(in) :: pressure(n)
    integer :: n_active

    n_active = count(pressure > 0.0_wp)
  end function count_active

  !> On arrays of known shape: through the list each access costs a multiplication by its stride. A
  !> point at a node has it at both ends of that side, and all of the force goes there.
  pure subroutine scatter_each(n, slave_nodes, slave_weights, master_nodes, master_weights, &
      normal, pressure, area, force)
    integer, intent(in) :: n
    integer, intent(in) :: slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: normal(2, *), pressure(*), area(*)
    real(wp), intent(inout) :: force(2, *)
    real(wp) :: point(2), total(2)
    integer :: p, a, b, c, d

    !GCC$ NOVECTOR
    do p = 1, n
      a = slave_nodes(1, p); b = slave_nodes(2, p)
      c = master_nodes(1, p); d = master_nodes(2, p)
      point = pressure(p)*area(p)*normal(:, p)
      if (a == b .or. c /= d) then
        total = force(:, c) - master_weights(1, p)*point
        force(:, c) = total
        total = force(:, d) - master_weights(2, p)*point
        force(:, d) = total
      else
        total = force(:, c) - point
        force(:, c) = total
      end if
      if (a == b) then
        total = force(:, a) + point
        force(:, a) = total
      else
        total = force(:, a) + slave_weights(1, p)*point
        force(:, a) = total
        total = force(:, b) + slave_weights(2, p)*point
        force(:, b) = total
      end if
    end do
  end subroutine scatter_each

  !> The forces of a run of points are summed before they are given to its nodes: a sum in memory
  !> has to be stored before it can be read again. A run is closed by the first point beyond it: to
  !> look ahead from each point takes twice as many instructions. Both components of a node are read
  !> before one is written, so that pairs stay pairs in the registers; else the compiler takes them
  !> apart, which costs half as much again.
  pure subroutine scatter_in_runs(n, slave_nodes, slave_weights, master_nodes, master_weights, &
      normal, pressure, area, run, force)
    integer, intent(in) :: n
    integer, intent(in) :: slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: normal(2, *), pressure(*), area(*)
    type(end_t), intent(inout) :: run(4) !! two of the slave side, two of the master side
    real(wp), intent(inout) :: force(2, *)
    real(wp), dimension(2) :: point, to_a, to_b, to_c, to_d, total
    integer :: p, a, b, c, d

    if (n == 0) return
    a = slave_nodes(1, 1); b = slave_nodes(2, 1)
    c = master_nodes(1, 1); d = master_nodes(2, 1)
    to_a = 0.0_wp; to_b = 0.0_wp; to_c = 0.0_wp; to_d = 0.0_wp
    if (run(1)%node > 0) then
      a = run(1)%node; b = run(2)%node; c = run(3)%node; d = run(4)%node
      to_a = run(1)%force; to_b = run(2)%force; to_c = run(3)%force; to_d = run(4)%force
    end if
    do p = 1, n
      if (slave_nodes(1, p) /= a .or. slave_nodes(2, p) /= b) then
        total = force(:, a) + to_a
        force(:, a) = total
        total = force(:, b) + to_b
        force(:, b) = total
        a = slave_nodes(1, p); b = slave_nodes(2, p)
        to_a = 0.0_wp; to_b = 0.0_wp
      end if
      if (master_nodes(1, p) /= c .or. master_nodes(2, p) /= d) then
        total = force(:, c) - to_c
        force(:, c) = total
        total = force(:, d) - to_d
        force(:, d) = total
        c = master_nodes(1, p); d = master_nodes(2, p)
        to_c = 0.0_wp; to_d = 0.0_wp
      end if
      point = pressure(p)*area(p)*normal(:, p)
      to_a = to_a + slave_weights(1, p)*point
      to_b = to_b + slave_weights(2, p)*point
      to_c = to_c + master_weights(1, p)*point
      to_d = to_d + master_weights(2, p)*point
    end do
    run%node = [a, b, c, d]
    run(1)%force = to_a; run(2)%force = to_b; run(3)%force = to_c; run(4)%force = to_d
  end subroutine scatter_in_runs

  !> What the rounding of places, one part in 1/epsilon of them, makes of the nodal forces of all
  !> pressed points: a gap along n is known to n_x X and n_y Y. Times epsilon it is a force.
  pure subroutine add_gap_round_off(memory, total)
    type(contact_state_t), intent(in) :: memory
    real(wp), intent(inout), contiguous :: total(:, :) !! (2, n_node of the mesh) N/m
    real(wp) :: force, normal(2)
    integer :: p, k, node

    associate (points => memory%points)
      do p = 1, points%n
        if (.not. points%pressure(p) > 0.0_wp) cycle
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
