! SPDX-License-Identifier: MIT
!> Weighted gaps of slave nodes as rows over the nodes of an interface, and what forces along some
!> rows change in others (doc/theory/contact.md, section 6.6). A row over its area kappa is a mean
!> gap: its shares of the slave side sum to the mean normal, those of the master to minus that.
module weighted_gaps_m
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: rows_t, choose_rows, form_shares, gap_rates, fill_band

  !> Rows of an interface in a step. Shares are kept by node: those that meet at a node are what
  !> couples rows.
  type :: rows_t
    integer :: n = 0
    integer :: width = 0                  !! rows farther apart than that do not meet
    integer, allocatable :: slave(:)      !! (n) slave node of each, in the order of the chain
    integer, allocatable :: place(:)      !! (n_slave) its row, 0: none
    integer, allocatable :: first(:)      !! (n_node + 1) where the shares of each node begin
    integer, allocatable :: last(:)       !! (n_node) where they end
    integer, allocatable :: row(:)        !! of each share
    real(wp), allocatable :: share(:, :)  !! (2, :) over the area of the row
  end type rows_t

contains

  !> A row for each slave node that is asked for, in the order of the chain. A closed chain begins
  !> behind its longest stretch without rows, so that neighbours stay neighbours.
  pure subroutine choose_rows(n_slave, n_node, wanted, rows)
    integer, intent(in) :: n_slave, n_node
    logical, intent(in) :: wanted(n_slave)
    type(rows_t), intent(out) :: rows
    integer :: found(n_slave), i, start, longest

    rows%n = 0
    do i = 1, n_slave
      if (.not. wanted(i)) cycle
      rows%n = rows%n + 1
      found(rows%n) = i
    end do
    allocate (rows%slave(rows%n), rows%place(n_slave), rows%first(n_node + 1), rows%last(n_node), &
      source=0)
    if (rows%n == 0) return
    start = 1
    longest = found(1) + n_slave - found(rows%n)
    do i = 2, rows%n
      if (found(i) - found(i - 1) <= longest) cycle
      longest = found(i) - found(i - 1)
      start = i
    end do
    do i = 1, rows%n
      rows%slave(i) = found(1 + mod(start - 2 + i, rows%n))
      rows%place(rows%slave(i)) = i
    end do
  end subroutine choose_rows

  !> Shares of all rows from the points on the list: N_A area n by the weights of the slave nodes,
  !> and the opposite by those of the master nodes, over kappa.
  pure subroutine form_shares(points, kappa, rows)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in) :: kappa(:)     !! (n_slave) m
    type(rows_t), intent(inout) :: rows
    real(wp) :: share(2, 2*n_side, n_side)
    integer :: nodes(2*n_side), first, last, i, k, m, low, high

    call count_shares(points%n, points%slave_nodes, points%master_nodes, rows)
    m = rows%first(size(rows%first)) - 1
    allocate (rows%row(m), rows%share(2, m))
    last = 0
    do while (last < points%n)
      first = last + 1
      last = last_alike(points%n, points%slave_nodes, points%master_nodes, first)
      nodes = [points%slave_nodes(:, first), points%master_nodes(:, first)]
      if (all(rows%place(nodes(:n_side)) == 0)) cycle
      call sum_shares(last - first + 1, points%slave_weights(1, first), &
        points%master_weights(1, first), points%area(first), points%normal(1, first), share)
      do k = 1, n_side
        if (rows%place(nodes(k)) == 0) cycle
        do m = 1, 2*n_side
          call add_share(rows%place(nodes(k)), share(:, m, k)/kappa(nodes(k)), &
            rows%first(nodes(m)), rows%last(nodes(m)), rows%row, rows%share)
        end do
      end do
    end do
    do i = 1, size(rows%last)
      low = rows%n
      high = 1
      do k = rows%first(i), rows%last(i)
        low = min(low, rows%row(k))
        high = max(high, rows%row(k))
      end do
      rows%width = max(rows%width, high - low)
    end do
  end subroutine form_shares

  !> Room for the shares at each node: those of points in a row with the same nodes are one.
  pure subroutine count_shares(n, slave_nodes, master_nodes, rows)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    type(rows_t), intent(inout) :: rows
    integer :: p, i, k, n_row

    p = 0
    do while (p < n)
      p = last_alike(n, slave_nodes, master_nodes, p + 1)
      n_row = count(rows%place(slave_nodes(:, p)) > 0)
      do k = 1, n_side
        rows%first(slave_nodes(k, p) + 1) = rows%first(slave_nodes(k, p) + 1) + n_row
        rows%first(master_nodes(k, p) + 1) = rows%first(master_nodes(k, p) + 1) + n_row
      end do
    end do
    rows%first(1) = 1
    do i = 1, size(rows%last)
      rows%last(i) = rows%first(i) - 1
      rows%first(i + 1) = rows%first(i) + rows%first(i + 1)
    end do
  end subroutine count_shares

  !> The last of the points in a row that have the nodes of one of them.
  pure function last_alike(n, slave_nodes, master_nodes, first) result(last)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *), first
    integer :: last

    last = first
    do while (last < n)
      if (any(slave_nodes(:, last + 1) /= slave_nodes(:, first)) &
        .or. any(master_nodes(:, last + 1) /= master_nodes(:, first))) return
      last = last + 1
    end do
  end function last_alike

  !> Shares of points with the same nodes, before they are divided by kappa: (:, node, row), slave
  !> nodes first.
  pure subroutine sum_shares(n, slave_weights, master_weights, area, normal, share)
    integer, intent(in) :: n
    real(wp), intent(in) :: slave_weights(n_side, n), master_weights(n_side, n), area(n), &
      normal(2, n)
    real(wp), intent(out) :: share(2, 2*n_side, n_side)
    real(wp) :: part(2)
    integer :: p, k, m

    share = 0.0_wp
    do p = 1, n
      do k = 1, n_side
        part = (slave_weights(k, p)*area(p))*normal(:, p)
        do m = 1, n_side
          share(:, m, k) = share(:, m, k) + slave_weights(m, p)*part
          share(:, n_side + m, k) = share(:, n_side + m, k) - master_weights(m, p)*part
        end do
      end do
    end do
  end subroutine sum_shares

  !> Add a share to what its row has at a node. Points of a row follow each other.
  pure subroutine add_share(row, part, first, last, rows, share)
    integer, intent(in) :: row, first
    real(wp), intent(in) :: part(2)
    integer, intent(inout) :: last          !! share of the node
    integer, intent(inout) :: rows(*)       !! of all shares
    real(wp), intent(inout) :: share(2, *)
    integer :: k

    do k = last, first, -1
      if (rows(k) /= row) cycle
      share(:, k) = share(:, k) + part
      return
    end do
    last = last + 1
    rows(last) = row
    share(:, last) = part
  end subroutine add_share

  !> Rates of the mean gaps by velocities of the nodes.
  pure subroutine gap_rates(rows, velocity, rate)
    type(rows_t), intent(in) :: rows
    real(wp), intent(in) :: velocity(:, :)  !! (2, n_node) m/s
    real(wp), intent(inout) :: rate(rows%n) !! what is added to, m/s
    integer :: i, k

    do i = 1, size(rows%last)
      do k = rows%first(i), rows%last(i)
        rate(rows%row(k)) = rate(rows%row(k)) + dot_product(rows%share(:, k), velocity(:, i))
      end do
    end do
  end subroutine gap_rates

  !> What the forces along rows change in the rates of rows.
  pure subroutine fill_band(rows, mobility, band)
    type(rows_t), intent(in) :: rows
    real(wp), intent(in) :: mobility(:, :)          !! (2, n_node) velocity from a force of 1
    real(wp), intent(out) :: band(0:rows%width, rows%n) !! W(j + i, j) in row i of column j
    integer :: i

    band = 0.0_wp
    do i = 1, size(rows%last)
      if (rows%last(i) >= rows%first(i)) call fill_node(rows%last(i) - rows%first(i) + 1, &
        rows%row(rows%first(i)), rows%share(1, rows%first(i)), mobility(:, i), rows%width, band)
    end do
  end subroutine fill_band

  !> The part of one node.
  pure subroutine fill_node(n, row, share, mobility, width, band)
    integer, intent(in) :: n, row(n), width
    real(wp), intent(in) :: share(2, n), mobility(2)
    real(wp), intent(inout) :: band(0:width, *)
    real(wp) :: pushed(2)
    integer :: k, m, low

    do k = 1, n
      pushed = mobility*share(:, k)
      do m = k, n
        low = min(row(k), row(m))
        band(abs(row(m) - row(k)), low) = band(abs(row(m) - row(k)), low) &
          + (pushed(1)*share(1, m) + pushed(2)*share(2, m))
      end do
    end do
  end subroutine fill_node

end module weighted_gaps_m
