! SPDX-License-Identifier: MIT
!> Weighted gaps of slave nodes as rows over the nodes of an interface, and what forces along some
!> rows change in others (doc/theory/contact.md, section 6.6). A row over its area kappa is a mean
!> gap: its shares of the slave side sum to the mean normal, those of the master to minus that.
module weighted_gaps_m
  use contact_state_m, only : contact_points_t, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: rows_t, choose_rows, form_shares, find_rates, fill_band, along_normal, along_tangent

  !> Along what the shares of a row act: its normals, or these turned by a right angle.
  integer, parameter :: along_normal = 1, along_tangent = 2

  !> Rows of an interface in a step, kept from one to the next: arrays may be longer than they have
  !> to be. Shares are kept by node: those that meet at a node are what couples rows.
  type :: rows_t
    integer :: n = 0
    integer :: width = 0                  !! rows farther apart than that do not meet
    integer :: n_share = 0
    integer, allocatable :: slave(:)      !! (n) slave node of each, in the order of the chain
    integer, allocatable :: place(:)      !! (n_slave) its row, 0: none
    integer, allocatable :: newest(:)     !! (n_node) the last share of each node, 0: none
    integer, allocatable :: next(:)       !! of each share, the one before it at its node, 0: none
    integer, allocatable :: row(:)        !! of each share
    real(wp), allocatable :: share(:, :)  !! (2, :) over the area of the row
  end type rows_t

contains

  !> A row for each slave node that is asked for, in the order of the chain. A closed chain begins
  !> behind its longest stretch without rows, so that neighbours stay neighbours.
  pure subroutine choose_rows(n_slave, wanted, rows)
    integer, intent(in) :: n_slave
    logical, intent(in) :: wanted(n_slave)
    type(rows_t), intent(inout) :: rows
    integer :: i, start, longest

    rows%n = 0
    do i = 1, n_slave
      rows%place(i) = 0
      if (.not. wanted(i)) cycle
      rows%n = rows%n + 1
      rows%slave(rows%n) = i
    end do
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
    end do
  end subroutine choose_rows

  !> Shares of all rows from the points on the list: N_A area n by the weights of the slave nodes,
  !> and the opposite by those of the master nodes, over kappa.
  pure subroutine form_shares(points, nodal, rows)
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in), contiguous :: nodal(:, :) !! (2, :) kappa of slave nodes in (2, :), m
    type(rows_t), intent(inout) :: rows
    integer :: i, k, low, high

    rows%newest = 0
    rows%n_share = 0
    call provide_shares(points%n, rows)
    call add_points(points%n, points%slave_nodes, points%slave_weights, points%master_nodes, &
      points%master_weights, points%area, points%normal, nodal, rows)
    rows%width = 0
    do i = 1, size(rows%newest)
      k = rows%newest(i)
      if (k == 0) cycle
      low = rows%row(k)
      high = low
      do
        k = rows%next(k)
        if (k == 0) exit
        low = min(low, rows%row(k))
        high = max(high, rows%row(k))
      end do
      rows%width = max(rows%width, high - low)
    end do
  end subroutine form_shares

  !> Room for the shares of so many points.
  pure subroutine provide_shares(n_point, rows)
    integer, intent(in) :: n_point
    type(rows_t), intent(inout) :: rows
    integer :: n

    n = 2*n_side*n_side*n_point
    if (allocated(rows%row)) then
      if (size(rows%row) >= n) return
      deallocate (rows%row, rows%next, rows%share)
    end if
    allocate (rows%row(n + n/2), rows%next(n + n/2), rows%share(2, n + n/2))
  end subroutine provide_shares

  !> Add the shares of all points. Those of points in a row with the same nodes are summed first.
  pure subroutine add_points(n, slave_nodes, slave_weights, master_nodes, master_weights, area, &
      normal, nodal, rows)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *), area(*), &
      normal(2, *), nodal(2, *)
    type(rows_t), intent(inout) :: rows
    real(wp) :: share(2, 2*n_side, n_side), part(2)
    integer :: nodes(2*n_side), p, first, k, m
    logical :: is_last

    first = 1
    do p = 1, n
      if (p == first) then
        nodes = [slave_nodes(1, p), slave_nodes(2, p), master_nodes(1, p), master_nodes(2, p)]
        share = 0.0_wp
      end if
      do k = 1, n_side
        part = (slave_weights(k, p)*area(p))*normal(:, p)
        share(:, 1, k) = share(:, 1, k) + slave_weights(1, p)*part
        share(:, 2, k) = share(:, 2, k) + slave_weights(2, p)*part
        share(:, 3, k) = share(:, 3, k) - master_weights(1, p)*part
        share(:, 4, k) = share(:, 4, k) - master_weights(2, p)*part
      end do
      is_last = p == n
      if (.not. is_last) is_last = slave_nodes(1, p + 1) /= nodes(1) .or. &
        slave_nodes(2, p + 1) /= nodes(2) .or. master_nodes(1, p + 1) /= nodes(3) .or. &
        master_nodes(2, p + 1) /= nodes(4)
      if (.not. is_last) cycle
      first = p + 1
      do k = 1, n_side
        if (rows%place(nodes(k)) == 0) cycle
        do m = 1, 2*n_side
          call add_share(rows%place(nodes(k)), 1.0_wp/nodal(2, nodes(k)), share(1, m, k), &
            rows%newest(nodes(m)), rows%n_share, rows%next, rows%row, rows%share)
        end do
      end do
    end do
  end subroutine add_points

  !> Add a share to what its row has at a node. Points of a row follow each other.
  pure subroutine add_share(row, factor, part, newest, n_share, next, rows, share)
    integer, intent(in) :: row
    real(wp), intent(in) :: factor, part(2)
    integer, intent(inout) :: newest        !! share of the node
    integer, intent(inout) :: n_share
    integer, intent(inout) :: next(*), rows(*) !! of all shares
    real(wp), intent(inout) :: share(2, *)
    integer :: k

    k = newest
    do while (k > 0)
      if (rows(k) == row) then
        share(1, k) = share(1, k) + factor*part(1)
        share(2, k) = share(2, k) + factor*part(2)
        return
      end if
      k = next(k)
    end do
    n_share = n_share + 1
    next(n_share) = newest
    rows(n_share) = row
    share(1, n_share) = factor*part(1)
    share(2, n_share) = factor*part(2)
    newest = n_share
  end subroutine add_share

  !> Rates of the gaps of all points by velocities of the nodes.
  pure subroutine find_rates(n, slave_nodes, slave_weights, master_nodes, master_weights, normal, &
      velocity, rate)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *), normal(2, *)
    real(wp), intent(in) :: velocity(2, *) !! m/s
    real(wp), intent(inout) :: rate(*)     !! m/s
    real(wp) :: relative(2)
    integer :: p

    !GCC$ NOVECTOR
    do p = 1, n
      relative = slave_weights(1, p)*velocity(:, slave_nodes(1, p)) &
        + slave_weights(2, p)*velocity(:, slave_nodes(2, p)) &
        - master_weights(1, p)*velocity(:, master_nodes(1, p)) &
        - master_weights(2, p)*velocity(:, master_nodes(2, p))
      rate(p) = normal(1, p)*relative(1) + normal(2, p)*relative(2)
    end do
  end subroutine find_rates

  !> What the forces along rows change in the rates of rows.
  pure subroutine fill_band(rows, direction, mobility, band)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: direction                !! along_normal or along_tangent
    real(wp), intent(in), contiguous :: mobility(:, :) !! (2, n_node) velocity from a force of 1
    real(wp), intent(inout) :: band(0:rows%width, rows%n) !! W(j + i, j) in row i of column j
    integer :: i

    band = 0.0_wp
    do i = 1, size(rows%newest)
      if (rows%newest(i) > 0) call fill_node(rows%newest(i), rows%next, rows%row, rows%share, &
        [mobility(direction, i), mobility(3 - direction, i)], rows%width, band)
    end do
  end subroutine fill_band

  !> The part of one node.
  pure subroutine fill_node(newest, next, row, share, mobility, width, band)
    integer, intent(in) :: newest, next(*), row(*), width
    real(wp), intent(in) :: share(2, *), mobility(2) !! of the normals' x and y
    real(wp), intent(inout) :: band(0:width, *)
    real(wp) :: pushed(2)
    integer :: k, m

    k = newest
    do while (k > 0)
      pushed(1) = mobility(1)*share(1, k)
      pushed(2) = mobility(2)*share(2, k)
      m = k
      do while (m > 0)
        associate (one => band(abs(row(m) - row(k)), min(row(k), row(m))))
          one = one + (pushed(1)*share(1, m) + pushed(2)*share(2, m))
        end associate
        m = next(m)
      end do
      k = next(k)
    end do
  end subroutine fill_node

end module weighted_gaps_m
