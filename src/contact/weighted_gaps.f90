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
    integer :: p, k, m, i
    real(wp) :: part(2)

    do p = 1, points%n
      do k = 1, n_side
        if (rows%place(points%slave_nodes(k, p)) == 0) cycle
        do m = 1, n_side
          call raise_by_one(rows%first(points%slave_nodes(m, p) + 1))
          call raise_by_one(rows%first(points%master_nodes(m, p) + 1))
        end do
      end do
    end do
    rows%first(1) = 1
    do i = 1, size(rows%last)
      rows%last(i) = rows%first(i) - 1
      rows%first(i + 1) = rows%first(i) + rows%first(i + 1)
    end do
    m = rows%first(size(rows%first)) - 1
    allocate (rows%row(m), source=0)
    allocate (rows%share(2, m), source=0.0_wp)
    do p = 1, points%n
      do k = 1, n_side
        i = points%slave_nodes(k, p)
        if (rows%place(i) == 0) cycle
        part = (points%slave_weights(k, p)*points%area(p)/kappa(i))*points%normal(:, p)
        do m = 1, n_side
          call add_share(rows%place(i), points%slave_nodes(m, p), &
            points%slave_weights(m, p)*part, rows)
          call add_share(rows%place(i), points%master_nodes(m, p), &
            -points%master_weights(m, p)*part, rows)
        end do
      end do
    end do
    do i = 1, size(rows%last)
      if (rows%last(i) < rows%first(i)) cycle
      associate (meeting => rows%row(rows%first(i):rows%last(i)))
        rows%width = max(rows%width, maxval(meeting) - minval(meeting))
      end associate
    end do
  end subroutine form_shares

  !> Count.
  pure subroutine raise_by_one(n)
    integer, intent(inout) :: n

    n = n + 1
  end subroutine raise_by_one

  !> Add a share to what its row has at a node. Points of a row follow each other.
  pure subroutine add_share(row, node, part, rows)
    integer, intent(in) :: row, node
    real(wp), intent(in) :: part(2)
    type(rows_t), intent(inout) :: rows
    integer :: k

    do k = rows%last(node), rows%first(node), -1
      if (rows%row(k) /= row) cycle
      rows%share(:, k) = rows%share(:, k) + part
      return
    end do
    k = rows%last(node) + 1
    rows%last(node) = k
    rows%row(k) = row
    rows%share(:, k) = part
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
    integer :: i, k, m, low, high

    band = 0.0_wp
    do i = 1, size(rows%last)
      do k = rows%first(i), rows%last(i)
        do m = k, rows%last(i)
          low = min(rows%row(k), rows%row(m))
          high = max(rows%row(k), rows%row(m))
          band(high - low, low) = band(high - low, low) &
            + sum(mobility(:, i)*rows%share(:, k)*rows%share(:, m))
        end do
      end do
    end do
  end subroutine fill_band

end module weighted_gaps_m
