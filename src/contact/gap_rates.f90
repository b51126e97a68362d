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
  public :: find_rates, add_turns, press_nodes, turns_alike, fill_band, along_normal, along_tangent

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

    rate = 0.0_wp
    call add_rates(rows%n_node, rows%node, rows%share_x, rows%share_y, direction, velocity, rate)
  end subroutine find_rates

  !> The parts of all nodes.
  pure subroutine add_rates(n, node, share_x, share_y, direction, velocity, rate)
    integer, intent(in) :: n, node(4, n), direction
    real(wp), intent(in) :: share_x(*), share_y(*), velocity(2, *)
    real(wp), intent(inout) :: rate(*)
    real(wp) :: x, y, way
    integer :: i, k

    way = merge(-1.0_wp, 1.0_wp, direction == along_tangent)
    do i = 1, n
      x = velocity(direction, node(node_of, i))
      y = way*velocity(3 - direction, node(node_of, i))
      !GCC$ UNROLL 1
      do k = node(first_row, i), node(last_row, i), n_lane
        call add_shares(x, y, share_x(node(share_at, i) + k), share_y(node(share_at, i) + k), &
          rate(k))
      end do
    end do
  end subroutine add_rates

  !> Some shares times what they act on.
  pure subroutine add_shares(x, y, share_x, share_y, total)
    real(wp), intent(in) :: x, y, share_x(n_lane), share_y(n_lane)
    real(wp), intent(inout) :: total(n_lane)

    total = total + (x*share_x + y*share_y)
  end subroutine add_shares

  !> What the turn of the master segments adds to the rates along tangents, of points that stand at
  !> a distance (section 6.2).
  pure subroutine add_turns(rows, points, places, velocity, rate)
    type(rows_t), intent(in) :: rows
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in) :: places(4, *), velocity(2, *) !! of the nodes; velocity in m/s
    real(wp), intent(inout) :: rate(*)                   !! (rows%n) m/s
    real(wp) :: moment(n_side)
    integer :: g, k

    do g = 1, rows%n_group
      associate (group => rows%groups(g))
        call sum_moments(group%first, group%last, points%slave_weights, points%area, points%gap, &
          moment)
        moment = moment*turn_of(rows%node(node_of, group%nodes(3)), &
          rows%node(node_of, group%nodes(4)), places, velocity)
        do k = 1, n_side
          if (group%rows(k) == 0) cycle
          rate(group%rows(k)) = rate(group%rows(k)) + rows%inverse(group%rows(k))*moment(k)
        end do
      end associate
    end do
  end subroutine add_turns

  !> Sums of area times weight times gap of some points.
  pure subroutine sum_moments(first, last, slave_weights, area, gap, moment)
    integer, intent(in) :: first, last
    real(wp), intent(in) :: slave_weights(n_side, *), area(*), gap(*)
    real(wp), intent(out) :: moment(n_side)
    integer :: p

    moment = 0.0_wp
    !GCC$ NOVECTOR
    !GCC$ UNROLL 1
    do p = first, last
      moment = moment + slave_weights(:, p)*(area(p)*gap(p))
    end do
  end subroutine sum_moments

  !> How fast a segment turns, clockwise.
  pure function turn_of(a, b, places, velocity) result(turn)
    integer, intent(in) :: a, b !! its nodes
    real(wp), intent(in) :: places(4, *), velocity(2, *)
    real(wp) :: turn
    real(wp) :: along(4), t(2), change(2)

    along = places(:, b) - places(:, a)
    t = along(1:2) + along(3:4)
    change = velocity(:, b) - velocity(:, a)
    turn = (t(2)*change(1) - t(1)*change(2))/max(t(1)*t(1) + t(2)*t(2), tiny(1.0_wp))
  end function turn_of

  !> Velocities of the nodes that have rows with forces along the normals of these.
  pure subroutine press_nodes(rows, mobility, x, velocity, pressed)
    type(rows_t), intent(in) :: rows
    real(wp), intent(in), contiguous :: mobility(:, :), velocity(:, :) !! (2, nodes)
    real(wp), intent(in) :: x(rows%n)                                  !! N/m
    real(wp), intent(inout), contiguous :: pressed(:, :)               !! (2, nodes) m/s

    call press_listed(rows%n_node, rows%node, rows%share_x, rows%share_y, x, mobility, velocity, &
      pressed)
  end subroutine press_nodes

  !> The same on arrays of known shape.
  pure subroutine press_listed(n, node, share_x, share_y, x, mobility, velocity, pressed)
    integer, intent(in) :: n, node(4, n)
    real(wp), intent(in) :: share_x(*), share_y(*), x(*), mobility(2, *), velocity(2, *)
    real(wp), intent(inout) :: pressed(2, *)
    real(wp) :: force(2)
    integer :: i, k

    do i = 1, n
      force = 0.0_wp
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do k = node(first_row, i), node(last_row, i)
        force(1) = force(1) + share_x(node(share_at, i) + k)*x(k)
        force(2) = force(2) + share_y(node(share_at, i) + k)*x(k)
      end do
      associate (j => node(node_of, i))
        pressed(:, j) = velocity(:, j) + mobility(:, j)*force
      end associate
    end do
  end subroutine press_listed

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

  !> What the forces along rows change in the rates of rows.
  pure subroutine fill_band(rows, direction, mobility, band)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: direction                   !! along_normal or along_tangent
    real(wp), intent(in), contiguous :: mobility(:, :) !! (2, nodes) velocity from a force of 1
    real(wp), intent(inout) :: band((rows%width + 1)*rows%n + n_spare) !! (0:width, n) W(j + i, j)
                                                                       !! in row i of column j

    band = 0.0_wp
    call fill_nodes(rows%n_node, rows%node, rows%share_x, rows%share_y, direction, mobility, &
      rows%width, band)
  end subroutine fill_band

  !> The parts of all nodes. What runs over the end of a column adds zeros to the next one.
  pure subroutine fill_nodes(n, node, share_x, share_y, direction, mobility, width, band)
    integer, intent(in) :: n, node(4, n), direction, width
    real(wp), intent(in) :: share_x(*), share_y(*), mobility(2, *)
    real(wp), intent(inout) :: band(0:*)
    real(wp) :: mobility_x, mobility_y
    integer :: i, k, m, at, last

    do i = 1, n
      mobility_x = mobility(direction, node(node_of, i))
      mobility_y = mobility(3 - direction, node(node_of, i))
      last = node(share_at, i) + node(last_row, i)
      at = (width + 1)*(node(first_row, i) - 1)
      do k = node(share_at, i) + node(first_row, i), last
        !GCC$ UNROLL 1
        do m = k, last, n_lane
          call add_shares(mobility_x*share_x(k), mobility_y*share_y(k), share_x(m), share_y(m), &
            band(at + m - k))
        end do
        at = at + width + 1
      end do
    end do
  end subroutine fill_nodes

end module gap_rates_m
