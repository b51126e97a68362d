! SPDX-License-Identifier: MIT
!> Between points and nodes: gaps averaged at slave nodes and what is formed there shared out, nodal
!> forces from what acts at points.
module contact_scatter_m
  use contact_state_m, only : contact_points_t, contact_state_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: scatter_forces, scatter_tractions, scatter, join_passes, add_gap_round_off, &
    average_values, share_out

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

  !> The same on arrays of known shape: through the list each access costs a multiplication by its
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
          *dot_product(normal, abs(memory%positions(1:2, node)))
        do k = 1, n_side
          node = memory%nodes(points%slave_nodes(k, p))
          total(:, node) = total(:, node) + abs(points%slave_weights(k, p))*force*normal
          node = memory%nodes(points%master_nodes(k, p))
          total(:, node) = total(:, node) + abs(points%master_weights(k, p))*force*normal
        end do
      end do
    end associate
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

end module contact_scatter_m
