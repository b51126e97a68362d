! SPDX-License-Identifier: MIT
!> Weighted gaps of slave nodes as rows over the nodes of an interface (doc/theory/contact.md,
!> section 6.6). A row over its area kappa is a mean gap: its shares of the slave side sum to the
!> mean normal, those of the master to minus that.
module weighted_gaps_m
  use complementarity_m, only : n_spare
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: rows_t, start_rows, choose_rows, form_shares, node_of, first_row, last_row, share_at

  !> What is kept of a node that has rows: its number in the interface, its first and last row, and
  !> where its shares are: that of row i at share_at + i.
  integer, parameter :: node_of = 1, first_row = 2, last_row = 3, share_at = 4

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

end module weighted_gaps_m
