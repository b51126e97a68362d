! SPDX-License-Identifier: MIT
!> What velocities do to weighted gaps, and what forces along some rows change in others
!> (doc/theory/contact.md, section 6.6).
module gap_rates_m
  use complementarity_m, only : n_spare
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  use weighted_gaps_m, only : rows_t, node_of, first_row, last_row, share_at
  implicit none
  private
  public :: find_rates, add_turns, load_nodes, turns_alike, fill_band, along_normal, along_tangent

  !> Along what the shares of a row act: its normals, or these turned by a right angle.
  integer, parameter :: along_normal = 1, along_tangent = 2
  !> Rows of a node that are looked at together. The last of them may be beyond its last row: there
  !> are as many zeros behind its shares, and as much room behind what is formed from them.
  integer, parameter :: n_lane = n_spare + 1

contains

  !> Rates of the rows by velocities of the nodes.
  pure subroutine find_rates(rows, direction, velocity, rate)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: direction                   !! along_normal or along_tangent
    real(wp), intent(in), contiguous :: velocity(:, :) !! (2, nodes) m/s
    real(wp), intent(inout) :: rate(rows%n + n_spare)  !! m/s
    real(wp) :: x, y
    integer :: i, k, at

    rate = 0.0_wp
    do i = 1, rows%n_node
      x = velocity(direction, rows%node(node_of, i))
      y = merge(-1.0_wp, 1.0_wp, direction == along_tangent) &
        *velocity(3 - direction, rows%node(node_of, i))
      at = rows%node(share_at, i)
      !GCC$ UNROLL 1
      do k = rows%node(first_row, i), rows%node(last_row, i), n_lane
        call add_shares(x, y, rows%share_x(at + k), rows%share_y(at + k), rate(k))
      end do
    end do
  end subroutine find_rates

  !> Some shares times what they act on.
  pure subroutine add_shares(x, y, share_x, share_y, total)
    real(wp), intent(in) :: x, y, share_x(n_lane), share_y(n_lane)
    real(wp), intent(inout) :: total(n_lane)

    total = total + (x*share_x + y*share_y)
  end subroutine add_shares

  !> What the turn of the master segments adds to the rates along tangents, of points that stand at
  !> a distance (section 6.2).
  pure subroutine add_turns(rows, points, positions, velocity, rate)
    type(rows_t), intent(in) :: rows
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in) :: positions(4, *), velocity(2, *) !! of the nodes; velocity in m/s
    real(wp), intent(inout) :: rate(*)                   !! (rows%n) m/s
    real(wp) :: moment
    integer :: p, k

    do p = 1, points%n
      if (all(rows%row_of(points%slave_nodes(:, p)) == 0)) cycle
      moment = points%area(p)*points%gap(p)*turn_of(points%master_nodes(1, p), &
        points%master_nodes(2, p), positions, velocity)
      do k = 1, n_side
        associate (row => rows%row_of(points%slave_nodes(k, p)))
          if (row > 0) rate(row) = rate(row) + rows%inverse(row)*points%slave_weights(k, p)*moment
        end associate
      end do
    end do
  end subroutine add_turns

  !> How fast a segment turns, clockwise.
  pure function turn_of(a, b, positions, velocity) result(turn)
    integer, intent(in) :: a, b !! its nodes
    real(wp), intent(in) :: positions(4, *), velocity(2, *)
    real(wp) :: turn
    real(wp) :: along(4), t(2), change(2)

    along = positions(:, b) - positions(:, a)
    t = along(1:2) + along(3:4)
    change = velocity(:, b) - velocity(:, a)
    turn = (t(2)*change(1) - t(1)*change(2))/max(t(1)*t(1) + t(2)*t(2), tiny(1.0_wp))
  end function turn_of

  !> Velocities of the nodes that have rows with forces along the normals of these.
  pure subroutine load_nodes(rows, mobility, x, velocity, loaded)
    type(rows_t), intent(in) :: rows
    real(wp), intent(in), contiguous :: mobility(:, :), velocity(:, :) !! (2, nodes)
    real(wp), intent(in) :: x(rows%n)                                  !! N/m
    real(wp), intent(inout), contiguous :: loaded(:, :)                !! (2, nodes) m/s
    real(wp) :: force(2)
    integer :: i, k, at

    do i = 1, rows%n_node
      at = rows%node(share_at, i)
      force = 0.0_wp
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do k = rows%node(first_row, i), rows%node(last_row, i)
        force = force + x(k)*[rows%share_x(at + k), rows%share_y(at + k)]
      end do
      associate (j => rows%node(node_of, i))
        loaded(:, j) = velocity(:, j) + mobility(:, j)*force
      end associate
    end do
  end subroutine load_nodes

  !> Whether forces along tangents change rates along these as forces along normals do those along
  !> normals: no node that has rows is moved more easily in one direction.
  pure logical function turns_alike(n, node, mobility)
    integer, intent(in) :: n, node(4, n)
    real(wp), intent(in) :: mobility(2, *) !! (2, nodes) velocity from a force of 1
    integer :: i

    turns_alike = .false.
    do i = 1, n
      if (abs(mobility(1, node(node_of, i)) - mobility(2, node(node_of, i))) > 0.0_wp) return
    end do
    turns_alike = .true.
  end function turns_alike

  !> What the forces along rows change in the rates of rows. What runs over the end of a column adds
  !> zeros to the next one.
  pure subroutine fill_band(rows, direction, mobility, band)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: direction                   !! along_normal or along_tangent
    real(wp), intent(in), contiguous :: mobility(:, :) !! (2, nodes) velocity from a force of 1
    real(wp), intent(inout) :: band(0:(rows%width + 1)*rows%n + n_spare - 1) !! (0:width, n)
                                                       !! W(j + i, j) in row i of column j
    real(wp) :: x, y
    integer :: i, k, m, at, last

    band = 0.0_wp
    do i = 1, rows%n_node
      associate (first => rows%node(share_at, i) + rows%node(first_row, i), &
        node => rows%node(node_of, i))
        last = rows%node(share_at, i) + rows%node(last_row, i)
        at = (rows%width + 1)*(rows%node(first_row, i) - 1)
        do k = first, last
          x = mobility(direction, node)*rows%share_x(k)
          y = mobility(3 - direction, node)*rows%share_y(k)
          !GCC$ UNROLL 1
          do m = k, last, n_lane
            call add_shares(x, y, rows%share_x(m), rows%share_y(m), band(at + m - k))
          end do
          at = at + rows%width + 1
        end do
      end associate
    end do
  end subroutine fill_band

end module gap_rates_m
