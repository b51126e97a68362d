! SPDX-License-Identifier: MIT
!> Weighted gaps of slave nodes as rows over the nodes of an interface (doc/theory/contact.md,
!> section 6.6), the rates of rows by velocities, and the velocities by forces along rows. A row
!> over its area kappa is a mean gap: its shares of the slave side sum to the mean normal, those of
!> the master to minus that.
module weighted_gaps_m
  use complementarity_m, only : n_spare
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: rows_t, start_rows, choose_rows, form_shares, find_rates, add_segment_rotation, &
    velocities_under, is_isotropic, fill_band, node_of, along_normal, along_tangent

  !> What is kept of a node that has rows: its number in the interface, its first and last row, and
  !> where its shares are: that of row i at share_at + i.
  integer, parameter :: node_of = 1, first_row = 2, last_row = 3, share_at = 4
  !> Along what the shares of a row act: its normals, or these turned by a right angle.
  integer, parameter :: along_normal = 1, along_tangent = 2
  !> Rows of a node that are summed together. The last of them may be beyond its last row: there
  !> are as many zeros behind its shares, and as much room behind what is formed from them.
  integer, parameter :: n_lane = n_spare + 1

  !> Rows of an interface in a step, kept from one to the next: arrays may be longer than they have
  !> to be. Shares are kept by node, from its first row to its last: those that meet at a node are
  !> what couples rows.
  type :: rows_t
    integer :: n = 0
    integer :: width = 0                  !! rows farther apart than that do not meet
    integer, allocatable :: slave(:)      !! (n) slave node of each, in the order of the surface
    integer, allocatable :: row_of(:)     !! (n_slave) its row, 0: none
    real(wp), allocatable :: inverse(:)   !! (n) 1/kappa, 1/m
    integer :: n_node = 0
    integer, allocatable :: node(:, :)    !! (4, n_node) that have rows
    integer, allocatable :: listed(:)     !! (nodes) where each is on that list, 0: nowhere
    real(wp), allocatable :: share_x(:)   !! over the area of the row, along x
    real(wp), allocatable :: share_y(:)
  end type rows_t

contains

  !> Room for an interface.
  pure subroutine start_rows(n_slave, n_node, rows)
    integer, intent(in) :: n_slave, n_node
    type(rows_t), intent(inout) :: rows

    allocate (rows%slave(n_slave), rows%row_of(n_slave), rows%inverse(n_slave))
    allocate (rows%node(4, n_node), rows%listed(n_node), source=0)
  end subroutine start_rows

  !> A row for each slave node whose mean gap may close in the step, or that has loaded in the one
  !> before, in the order of the surface. A closed surface begins behind its longest stretch without
  !> rows, so that neighbours stay neighbours.
  pure subroutine choose_rows(n_slave, nodal, pressure, reach, rows)
    integer, intent(in) :: n_slave
    real(wp), intent(in) :: nodal(2, *) !! (2, n_slave or more) mean gap and kappa, m
    real(wp), intent(in) :: pressure(n_slave)
    real(wp), intent(in) :: reach       !! gap from which on none closes, m
    type(rows_t), intent(inout) :: rows
    integer :: i, begin, longest

    rows%n = 0
    do i = 1, n_slave
      rows%row_of(i) = 0
      if (.not. nodal(2, i) > 0.0_wp) cycle
      if (nodal(1, i) >= reach .and. .not. pressure(i) > 0.0_wp) cycle
      rows%n = rows%n + 1
      rows%slave(rows%n) = i
    end do
    do i = 1, rows%n_node
      rows%listed(rows%node(node_of, i)) = 0
    end do
    rows%n_node = 0
    if (rows%n == 0) return
    begin = 1
    longest = rows%slave(1) + n_slave - rows%slave(rows%n)
    do i = 2, rows%n
      if (rows%slave(i) - rows%slave(i - 1) <= longest) cycle
      longest = rows%slave(i) - rows%slave(i - 1)
      begin = i
    end do
    if (begin > 1) rows%slave(:rows%n) = cshift(rows%slave(:rows%n), begin - 1)
    do i = 1, rows%n
      rows%row_of(rows%slave(i)) = i
      rows%inverse(i) = 1.0_wp/nodal(2, rows%slave(i))
    end do
  end subroutine choose_rows

  !> Shares of all rows from the points on the list: N_A area n by the weights of the slave nodes,
  !> and the opposite by those of the master nodes, over kappa.
  pure subroutine form_shares(points, rows)
    type(contact_points_t), intent(in) :: points
    type(rows_t), intent(inout) :: rows
    real(wp) :: along(2)
    integer :: p, k, m, row

    call list_nodes(points%n, points%slave_nodes, points%master_nodes, rows)
    call layout_shares(rows)
    do p = 1, points%n
      do k = 1, n_side
        row = rows%row_of(points%slave_nodes(k, p))
        if (row == 0) cycle
        along = (points%area(p)*points%slave_weights(k, p)*rows%inverse(row))*points%normal(:, p)
        do m = 1, n_side
          call add_share(points%slave_nodes(m, p), row, points%slave_weights(m, p)*along, rows)
          call add_share(points%master_nodes(m, p), row, -points%master_weights(m, p)*along, rows)
        end do
      end do
    end do
  end subroutine form_shares

  !> Add to the share of a node in a row.
  pure subroutine add_share(node, row, share, rows)
    integer, intent(in) :: node, row
    real(wp), intent(in) :: share(2)
    type(rows_t), intent(inout) :: rows

    associate (i => rows%node(share_at, rows%listed(node)) + row)
      rows%share_x(i) = rows%share_x(i) + share(1)
      rows%share_y(i) = rows%share_y(i) + share(2)
    end associate
  end subroutine add_share

  !> The nodes of all points that rows have shares of, each with its first and last row.
  pure subroutine list_nodes(n, slave_nodes, master_nodes, rows)
    integer, intent(in) :: n, slave_nodes(n_side, n), master_nodes(n_side, n)
    type(rows_t), intent(inout) :: rows
    integer :: p, m, low, high

    do p = 1, n
      high = maxval(rows%row_of(slave_nodes(:, p)))
      if (high == 0) cycle
      low = minval(rows%row_of(slave_nodes(:, p)))
      if (low == 0) low = high
      do m = 1, n_side
        call list_node(slave_nodes(m, p), low, high, rows)
        call list_node(master_nodes(m, p), low, high, rows)
      end do
    end do
  end subroutine list_nodes

  !> One node that has shares in two rows.
  pure subroutine list_node(node, low, high, rows)
    integer, intent(in) :: node, low, high
    type(rows_t), intent(inout) :: rows

    if (rows%listed(node) == 0) then
      rows%n_node = rows%n_node + 1
      rows%listed(node) = rows%n_node
      rows%node(:last_row, rows%n_node) = [node, low, high]
    else
      associate (item => rows%node(:, rows%listed(node)))
        item(first_row) = min(low, item(first_row))
        item(last_row) = max(high, item(last_row))
      end associate
    end if
  end subroutine list_node

  !> Where the shares of each node are, with room for them; all are zero.
  pure subroutine layout_shares(rows)
    type(rows_t), intent(inout) :: rows
    integer :: i, n

    n = 0
    rows%width = 0
    do i = 1, rows%n_node
      associate (item => rows%node(:, i))
        item(share_at) = n + 1 - item(first_row)
        n = item(share_at) + item(last_row) + n_spare
        rows%width = max(rows%width, item(last_row) - item(first_row))
      end associate
    end do
    if (allocated(rows%share_x)) then
      if (size(rows%share_x) < n) deallocate (rows%share_x, rows%share_y)
    end if
    if (.not. allocated(rows%share_x)) allocate (rows%share_x(n + n/2), rows%share_y(n + n/2))
    rows%share_x(:n) = 0.0_wp
    rows%share_y(:n) = 0.0_wp
  end subroutine layout_shares

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
  pure subroutine add_segment_rotation(rows, points, positions, velocity, rate)
    type(rows_t), intent(in) :: rows
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in) :: positions(4, *), velocity(2, *) !! of the nodes; velocity in m/s
    real(wp), intent(inout) :: rate(*)                   !! (rows%n) m/s
    real(wp) :: moment
    integer :: p, k

    do p = 1, points%n
      if (all(rows%row_of(points%slave_nodes(:, p)) == 0)) cycle
      moment = points%area(p)*points%gap(p)*rotation_rate(points%master_nodes(1, p), &
        points%master_nodes(2, p), positions, velocity)
      do k = 1, n_side
        associate (row => rows%row_of(points%slave_nodes(k, p)))
          if (row > 0) rate(row) = rate(row) + rows%inverse(row)*points%slave_weights(k, p)*moment
        end associate
      end do
    end do
  end subroutine add_segment_rotation

  !> How fast a segment turns, clockwise.
  pure function rotation_rate(a, b, positions, velocity) result(turn)
    integer, intent(in) :: a, b !! its nodes
    real(wp), intent(in) :: positions(4, *), velocity(2, *)
    real(wp) :: turn
    real(wp) :: along(4), t(2), change(2)

    along = positions(:, b) - positions(:, a)
    t = along(1:2) + along(3:4)
    change = velocity(:, b) - velocity(:, a)
    turn = (t(2)*change(1) - t(1)*change(2))/max(t(1)*t(1) + t(2)*t(2), tiny(1.0_wp))
  end function rotation_rate

  !> Velocities of the nodes that have rows with forces along the normals of these.
  pure subroutine velocities_under(rows, mobility, x, velocity, loaded)
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
  end subroutine velocities_under

  !> Whether forces along tangents change rates along these as forces along normals do those along
  !> normals: no node that has rows is moved more easily in one direction.
  pure logical function is_isotropic(n, node, mobility)
    integer, intent(in) :: n, node(4, n)
    real(wp), intent(in) :: mobility(2, *) !! (2, nodes) velocity from a force of 1
    integer :: i

    is_isotropic = .false.
    do i = 1, n
      if (abs(mobility(1, node(node_of, i)) - mobility(2, node(node_of, i))) > 0.0_wp) return
    end do
    is_isotropic = .true.
  end function is_isotropic

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

end module weighted_gaps_m
