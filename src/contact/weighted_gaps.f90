! SPDX-License-Identifier: MIT
!> Weighted gaps of slave nodes as rows over the nodes of an interface, and what forces along some
!> rows change in others (doc/theory/contact.md, section 6.6). A row over its area kappa is a mean
!> gap: its shares of the slave side sum to the mean normal, those of the master to minus that.
module weighted_gaps_m
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: rows_t, choose_rows, form_shares, find_rates, press_nodes, fill_band, along_normal, &
    along_tangent

  !> Along what the shares of a row act: its normals, or these turned by a right angle.
  integer, parameter :: along_normal = 1, along_tangent = 2

  !> Rows of an interface in a step, kept from one to the next: arrays may be longer than they have
  !> to be. Shares are kept by node, from its first row to its last: those that meet at a node are
  !> what couples rows.
  type :: rows_t
    integer :: n = 0
    integer :: width = 0                  !! rows farther apart than that do not meet
    integer, allocatable :: slave(:)      !! (n) slave node of each, in the order of the chain
    integer, allocatable :: place(:)      !! (n_slave) its row, 0: none
    real(wp), allocatable :: inverse(:)   !! (n) 1/kappa, 1/m
    integer :: n_node = 0
    integer, allocatable :: node(:)       !! (n_node) that have rows
    integer, allocatable :: first(:)      !! (nodes) first row of each
    integer, allocatable :: last(:)       !! (nodes) and last one, below that: none
    integer, allocatable :: start(:)      !! (nodes) share of row i: at start + i
    real(wp), allocatable :: share(:, :)  !! (2, :) over the area of the row
    integer :: n_group = 0                !! points in a row with the same nodes
    integer, allocatable :: group(:, :)   !! (2 n_side, n_group) these, slaves first
    real(wp), allocatable :: part(:, :, :, :) !! (2, 2 n_side, n_side, n_group) sums of their
                                          !! shares, of the rows of both slaves
  end type rows_t

contains

  !> A row for each slave node whose mean gap may close in the step, or that has pressed in the one
  !> before, in the order of the chain. A closed chain begins behind its longest stretch without
  !> rows, so that neighbours stay neighbours.
  pure subroutine choose_rows(n_slave, nodal, pressure, reach, rows)
    integer, intent(in) :: n_slave
    real(wp), intent(in) :: nodal(2, *) !! (2, n_slave or more) mean gap and kappa, m
    real(wp), intent(in) :: pressure(n_slave)
    real(wp), intent(in) :: reach       !! gap from which on none closes, m
    type(rows_t), intent(inout) :: rows
    integer :: i, start, longest

    rows%n = 0
    do i = 1, n_slave
      rows%place(i) = 0
      if (.not. nodal(2, i) > 0.0_wp) cycle
      if (nodal(1, i) >= reach .and. .not. pressure(i) > 0.0_wp) cycle
      rows%n = rows%n + 1
      rows%slave(rows%n) = i
    end do
    rows%n_node = 0
    if (rows%n == 0) return
    start = 1
    longest = rows%slave(1) + n_slave - rows%slave(rows%n)
    do i = 2, rows%n
      if (rows%slave(i) - rows%slave(i - 1) <= longest) cycle
      longest = rows%slave(i) - rows%slave(i - 1)
      start = i
    end do
    if (start > 1) rows%slave(:rows%n) = cshift(rows%slave(:rows%n), start - 1)
    do i = 1, rows%n
      rows%place(rows%slave(i)) = i
      rows%inverse(i) = 1.0_wp/nodal(2, rows%slave(i))
    end do
  end subroutine choose_rows

  !> Shares of all rows from the points on the list: N_A area n by the weights of the slave nodes,
  !> and the opposite by those of the master nodes, over kappa.
  pure subroutine form_shares(points, rows)
    type(contact_points_t), intent(in) :: points
    type(rows_t), intent(inout) :: rows
    integer :: n_share

    call provide_groups(points%n, rows)
    rows%first = huge(1)
    rows%last = 0
    call sum_groups(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
      points%master_weights, points%area, points%normal, rows)
    call list_nodes(size(rows%first), rows%first, rows%last, rows%n_node, rows%node, rows%start, &
      n_share, rows%width)
    call provide_shares(n_share, rows)
    call share_groups(rows%n_group, rows%group, rows%part, rows%place, rows%inverse, rows%start, &
      n_share, rows%share)
  end subroutine form_shares

  !> The nodes that have rows, and where their shares are.
  pure subroutine list_nodes(n, first, last, n_node, node, start, n_share, width)
    integer, intent(in) :: n, first(n), last(n)
    integer, intent(inout) :: node(n), start(n)
    integer, intent(out) :: n_node, n_share, width
    integer :: i

    n_node = 0
    n_share = 0
    width = 0
    !GCC$ UNROLL 1
    do i = 1, n
      if (last(i) < first(i)) cycle
      n_node = n_node + 1
      node(n_node) = i
      start(i) = n_share + 1 - first(i)
      n_share = start(i) + last(i)
      width = max(width, last(i) - first(i))
    end do
  end subroutine list_nodes

  !> Room for the groups of so many points.
  pure subroutine provide_groups(n, rows)
    integer, intent(in) :: n
    type(rows_t), intent(inout) :: rows

    if (allocated(rows%group)) then
      if (size(rows%group, 2) >= n) return
      deallocate (rows%group, rows%part)
    end if
    allocate (rows%group(2*n_side, n + n/2), rows%part(2, 2*n_side, n_side, n + n/2))
  end subroutine provide_groups

  !> Room for so many shares.
  pure subroutine provide_shares(n, rows)
    integer, intent(in) :: n
    type(rows_t), intent(inout) :: rows

    if (allocated(rows%share)) then
      if (size(rows%share, 2) >= n) return
      deallocate (rows%share)
    end if
    allocate (rows%share(2, n + n/2))
  end subroutine provide_shares

  !> Sums over points in a row with the same nodes, and which rows each node has.
  pure subroutine sum_groups(n, slave_nodes, slave_weights, master_nodes, master_weights, area, &
      normal, rows)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *), area(*), &
      normal(2, *)
    type(rows_t), intent(inout) :: rows
    integer :: nodes(2*n_side), p, g

    g = 0
    nodes = 0
    do p = 1, n
      if (nodes(1) /= slave_nodes(1, p) .or. nodes(2) /= slave_nodes(2, p) .or. &
        nodes(3) /= master_nodes(1, p) .or. nodes(4) /= master_nodes(2, p)) then
        nodes(:n_side) = slave_nodes(:, p)
        nodes(n_side + 1:) = master_nodes(:, p)
        g = g + 1
        rows%group(:, g) = nodes
        call clear_part(rows%part(1, 1, 1, g))
        call extend_nodes([rows%place(nodes(1)), rows%place(nodes(2))], nodes, rows%first, &
          rows%last)
      end if
      call add_point(slave_weights(1, p), master_weights(1, p), area(p), normal(1, p), &
        rows%part(1, 1, 1, g))
    end do
    rows%n_group = g
  end subroutine sum_groups

  !> Nothing is in the sums of a group yet.
  pure subroutine clear_part(part)
    real(wp), intent(inout) :: part(2*2*n_side*n_side)

    part = 0.0_wp
  end subroutine clear_part

  !> Add the shares of one point.
  pure subroutine add_point(slave_weights, master_weights, area, normal, part)
    real(wp), intent(in) :: slave_weights(n_side), master_weights(n_side), area, normal(2)
    real(wp), intent(inout) :: part(2, 2*n_side, n_side)
    real(wp) :: force(2)
    integer :: k, m

    do k = 1, n_side
      force = (slave_weights(k)*area)*normal
      do m = 1, n_side
        part(:, m, k) = part(:, m, k) + slave_weights(m)*force
        part(:, n_side + m, k) = part(:, n_side + m, k) - master_weights(m)*force
      end do
    end do
  end subroutine add_point

  !> Some nodes have these rows too; 0: none.
  pure subroutine extend_nodes(pair, nodes, first, last)
    integer, intent(in) :: pair(n_side), nodes(2*n_side)
    integer, intent(inout) :: first(*), last(*)
    integer :: k, low, high

    high = maxval(pair)
    low = minval(pair)
    if (low == 0) low = high
    if (high == 0) return
    do k = 1, 2*n_side
      first(nodes(k)) = min(first(nodes(k)), low)
      last(nodes(k)) = max(last(nodes(k)), high)
    end do
  end subroutine extend_nodes

  !> Give the sums to the rows.
  pure subroutine share_groups(n, group, part, place, inverse, start, n_share, share)
    integer, intent(in) :: n, group(2*n_side, *), place(*), start(*), n_share
    real(wp), intent(in) :: part(2, 2*n_side, n_side, *), inverse(*)
    real(wp), intent(inout) :: share(2, n_share)
    integer :: g, i, k, m, row

    do i = 1, n_share
      share(:, i) = 0.0_wp
    end do
    do g = 1, n
      do k = 1, n_side
        row = place(group(k, g))
        if (row == 0) cycle
        do m = 1, 2*n_side
          i = start(group(m, g)) + row
          share(:, i) = share(:, i) + inverse(row)*part(:, m, k, g)
        end do
      end do
    end do
  end subroutine share_groups

  !> Rates of the rows by velocities of the nodes.
  pure subroutine find_rates(rows, direction, velocity, rate)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: direction                   !! along_normal or along_tangent
    real(wp), intent(in), contiguous :: velocity(:, :) !! (2, nodes) m/s
    real(wp), intent(out) :: rate(rows%n)              !! m/s
    real(wp) :: along(2)
    integer :: j

    rate = 0.0_wp
    do j = 1, rows%n_node
      associate (i => rows%node(j), first => rows%first(rows%node(j)))
        along = velocity(:, i)
        if (direction == along_tangent) along = [along(2), -along(1)]
        call add_rates(rows%last(i) - first + 1, rows%share(1, rows%start(i) + first), along, &
          rate(first))
      end associate
    end do
  end subroutine find_rates

  !> The part of one node.
  pure subroutine add_rates(n, share, along, rate)
    integer, intent(in) :: n
    real(wp), intent(in) :: share(2, n), along(2)
    real(wp), intent(inout) :: rate(n)
    integer :: k

    !GCC$ NOVECTOR
    !GCC$ UNROLL 1
    do k = 1, n
      rate(k) = rate(k) + (share(1, k)*along(1) + share(2, k)*along(2))
    end do
  end subroutine add_rates

  !> Velocities of the nodes with forces along the normals of the rows.
  pure subroutine press_nodes(rows, mobility, x, velocity, pressed)
    type(rows_t), intent(in) :: rows
    real(wp), intent(in), contiguous :: mobility(:, :), velocity(:, :) !! (2, nodes)
    real(wp), intent(in) :: x(rows%n)                                  !! N/m
    real(wp), intent(inout), contiguous :: pressed(:, :)               !! (2, nodes) m/s
    integer :: i, j, k

    pressed = velocity
    do j = 1, rows%n_node
      i = rows%node(j)
      do k = rows%first(i), rows%last(i)
        pressed(:, i) = pressed(:, i) + mobility(:, i)*(rows%share(:, rows%start(i) + k)*x(k))
      end do
    end do
  end subroutine press_nodes

  !> What the forces along rows change in the rates of rows.
  pure subroutine fill_band(rows, direction, mobility, band)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: direction                   !! along_normal or along_tangent
    real(wp), intent(in), contiguous :: mobility(:, :) !! (2, nodes) velocity from a force of 1
    real(wp), intent(inout) :: band(0:rows%width, rows%n) !! W(j + i, j) in row i of column j
    integer :: j

    band = 0.0_wp
    do j = 1, rows%n_node
      associate (i => rows%node(j), first => rows%first(rows%node(j)))
        call fill_node(rows%last(i) - first + 1, rows%share(1, rows%start(i) + first), &
          mobility(direction, i), mobility(3 - direction, i), rows%width, band(0, first))
      end associate
    end do
  end subroutine fill_band

  !> The part of one node. Few rows meet at one.
  pure subroutine fill_node(n, share, mobility_x, mobility_y, width, band)
    integer, intent(in) :: n, width
    real(wp), intent(in) :: share(2, n), mobility_x, mobility_y !! of the x and y of normals
    real(wp), intent(inout) :: band(0:width, n)
    real(wp) :: x, y
    integer :: k, m

    !GCC$ UNROLL 1
    do k = 1, n
      x = mobility_x*share(1, k)
      y = mobility_y*share(2, k)
      !GCC$ NOVECTOR
      !GCC$ UNROLL 1
      do m = k, n
        band(m - k, k) = band(m - k, k) + (x*share(1, m) + y*share(2, m))
      end do
    end do
  end subroutine fill_node

end module weighted_gaps_m
