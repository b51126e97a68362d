! SPDX-License-Identifier: MIT
!> Weighted gaps of slave nodes as rows over the nodes of an interface (doc/theory/contact.md,
!> section 6.6), the rates of rows by velocities, and the velocities by forces along rows. A row
!> over its area kappa is a mean gap: its shares of the slave side sum to the mean normal, those of
!> the master to minus that.
module weighted_gaps_m
  use contact_state_m, only : contact_points_t, n_side
  use friction_m, only : slip_of
  use kinds_m, only : wp
  implicit none
  private
  public :: rows_t, start_rows, choose_rows, form_shares, find_rates, find_slips, &
    velocities_under, fill_band, along_normal, along_tangent

  !> Along what the shares of a row act: its normals, or these turned by a right angle.
  integer, parameter :: along_normal = 1, along_tangent = 2

  !> Rows of an interface in a step, kept from one to the next: arrays may be longer than they have
  !> to be. Shares are kept by node, from its first row to its last: those that meet at a node are
  !> what couples rows.
  type :: rows_t
    integer :: n = 0
    integer :: width = 0                      !! rows farther apart than that do not meet
    integer, allocatable :: slave(:)          !! (n) slave node of each, in the order of the surface
    integer, allocatable :: row_of(:)         !! (n_slave) its row, 0: none
    real(wp), allocatable :: inverse(:)       !! (n) 1/kappa, 1/m
    integer, allocatable :: first(:), last(:) !! (nodes) rows of each; none: the last is 0
    real(wp), allocatable :: share(:, :, :)   !! (2, 0:width, nodes) over the area of the row, from
                                              !! the first row on
  end type rows_t

contains

  !> Room for an interface.
  pure subroutine start_rows(n_slave, n_node, rows)
    integer, intent(in) :: n_slave, n_node
    type(rows_t), intent(inout) :: rows

    allocate (rows%slave(n_slave), rows%row_of(n_slave), rows%inverse(n_slave))
    allocate (rows%first(n_node), rows%last(n_node), source=0)
    allocate (rows%share(2, 0:0, n_node))
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
    real(wp) :: weights(2*n_side), along(2)
    integer :: nodes(2*n_side), p, k, m, row

    call layout_shares(points, rows)
    do p = 1, points%n
      nodes = [points%slave_nodes(:, p), points%master_nodes(:, p)]
      weights = [points%slave_weights(:, p), -points%master_weights(:, p)]
      do k = 1, n_side
        row = rows%row_of(nodes(k))
        if (row == 0) cycle
        along = (points%area(p)*weights(k)*rows%inverse(row))*points%normal(:, p)
        do m = 1, 2*n_side
          associate (share => rows%share(:, row - rows%first(nodes(m)), nodes(m)))
            share = share + weights(m)*along
          end associate
        end do
      end do
    end do
  end subroutine form_shares

  !> The first and the last row that the points give each node shares of, with room for these; all
  !> are zero.
  pure subroutine layout_shares(points, rows)
    type(contact_points_t), intent(in) :: points
    type(rows_t), intent(inout) :: rows
    integer :: nodes(2*n_side), near(n_side), p, m

    rows%first = rows%n + 1
    rows%last = 0
    do p = 1, points%n
      near = rows%row_of(points%slave_nodes(:, p))
      if (all(near == 0)) cycle
      nodes = [points%slave_nodes(:, p), points%master_nodes(:, p)]
      do m = 1, 2*n_side
        rows%first(nodes(m)) = min(rows%first(nodes(m)), minval(near, near > 0))
        rows%last(nodes(m)) = max(rows%last(nodes(m)), maxval(near))
      end do
    end do
    rows%width = max(0, maxval(rows%last - rows%first))
    if (size(rows%share, 2) <= rows%width) then
      deallocate (rows%share)
      allocate (rows%share(2, 0:rows%width + rows%width/2, size(rows%first)))
    end if
    do m = 1, size(rows%first)
      rows%share(:, :rows%last(m) - rows%first(m), m) = 0.0_wp
    end do
  end subroutine layout_shares

  !> Rates of the rows by velocities of the nodes.
  pure subroutine find_rates(rows, direction, velocity, rate)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: direction                   !! along_normal or along_tangent
    real(wp), intent(in), contiguous :: velocity(:, :) !! (2, nodes) m/s
    real(wp), intent(inout) :: rate(rows%n)            !! m/s
    real(wp) :: x, y
    integer :: i, k

    rate = 0.0_wp
    do i = 1, size(rows%first)
      x = velocity(direction, i)
      y = velocity(3 - direction, i)
      if (direction == along_tangent) y = -y
      do k = rows%first(i), rows%last(i)
        associate (share => rows%share(:, k - rows%first(i), i))
          rate(k) = rate(k) + (x*share(1) + y*share(2))
        end associate
      end do
    end do
  end subroutine find_rates

  !> Mean slips of the rows by motions of the nodes, what the turn of the master segments moves at a
  !> distance taken off.
  pure subroutine find_slips(rows, points, positions, motion, slip)
    type(rows_t), intent(in) :: rows
    type(contact_points_t), intent(in) :: points
    real(wp), intent(in) :: positions(4, *), motion(2, *) !! of the nodes; motion in m or m/s
    real(wp), intent(inout) :: slip(rows%n)               !! in the unit of motion
    real(wp) :: here
    integer :: p, k

    slip = 0.0_wp
    do p = 1, points%n
      here = points%area(p)*slip_of(points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%master_weights(1, p), points%normal(1, p), &
        points%gap(p), motion, positions)
      do k = 1, n_side
        associate (row => rows%row_of(points%slave_nodes(k, p)))
          if (row > 0) slip(row) = slip(row) + rows%inverse(row)*points%slave_weights(k, p)*here
        end associate
      end do
    end do
  end subroutine find_slips

  !> Velocities of the nodes with forces along the normals of rows.
  pure subroutine velocities_under(rows, mobility, x, velocity, loaded)
    type(rows_t), intent(in) :: rows
    real(wp), intent(in), contiguous :: mobility(:, :), velocity(:, :) !! (2, nodes)
    real(wp), intent(in) :: x(rows%n)                                  !! N/m
    real(wp), intent(inout), contiguous :: loaded(:, :)                !! (2, nodes) m/s
    real(wp) :: force(2)
    integer :: i, k

    do i = 1, size(rows%first)
      force = 0.0_wp
      do k = rows%first(i), rows%last(i)
        force = force + x(k)*rows%share(:, k - rows%first(i), i)
      end do
      loaded(:, i) = velocity(:, i) + mobility(:, i)*force
    end do
  end subroutine velocities_under

  !> What the forces along rows change in the rates of rows.
  pure subroutine fill_band(rows, direction, mobility, band)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: direction                   !! along_normal or along_tangent
    real(wp), intent(in), contiguous :: mobility(:, :) !! (2, nodes) velocity from a force of 1
    real(wp), intent(inout) :: band(0:rows%width, rows%n) !! W(j + i, j) in row i of column j
    real(wp) :: moved(2) !! along the turned axes by a force along the row
    integer :: i, k, m

    band = 0.0_wp
    do i = 1, size(rows%first)
      associate (first => rows%first(i))
        do k = 0, rows%last(i) - first
          moved = mobility([direction, 3 - direction], i)*rows%share(:, k, i)
          do m = k, rows%last(i) - first
            band(m - k, first + k) = band(m - k, first + k) + (moved(1)*rows%share(1, m, i) &
              + moved(2)*rows%share(2, m, i))
          end do
        end do
      end associate
    end do
  end subroutine fill_band

end module weighted_gaps_m
