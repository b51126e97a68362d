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

  !> Points in a row with the same nodes and normal.
  type :: group_t
    integer :: nodes(2*n_side) = 0 !! where these are on the list of nodes that have rows, slaves
                                   !! first
    integer :: rows(n_side) = 0    !! of the slaves, 0: none
    integer :: first = 0           !! point
    integer :: last = 0
    real(wp) :: normal(2) = 0.0_wp
    real(wp) :: part(2*n_side, n_side) = 0.0_wp !! sums of area times weights, of the rows of both
                                                !! slaves, m; of masters below zero
  end type group_t

  !> What is kept of a node that has rows: its number in the interface, its first and last row, and
  !> where its shares are: that of row i at share_at + i.
  integer, parameter :: node_of = 1, first_row = 2, last_row = 3, share_at = 4

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
    integer, allocatable :: node(:, :)    !! (4, n_node) that have rows
    integer, allocatable :: listed(:)     !! (nodes) where each is on that list, 0: nowhere
    real(wp), allocatable :: share_x(:)   !! over the area of the row, along x
    real(wp), allocatable :: share_y(:)
    integer :: n_group = 0
    type(group_t), allocatable :: groups(:) !! (n_group) of points of whose slaves one has a row
  end type rows_t

contains

  !> Room for an interface.
  pure subroutine start_rows(n_slave, n_node, rows)
    integer, intent(in) :: n_slave, n_node
    type(rows_t), intent(inout) :: rows

    allocate (rows%slave(n_slave), rows%place(n_slave), rows%inverse(n_slave))
    allocate (rows%node(4, n_node), rows%listed(n_node), source=0)
  end subroutine start_rows

  !> A row for each slave node whose mean gap may close in the step, or that has pressed in the one
  !> before, in the order of the chain. A closed chain begins behind its longest stretch without
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
      rows%place(i) = 0
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
    call find_groups(points%n, points%slave_nodes, points%master_nodes, points%normal, rows%place, &
      rows%n_group, rows%groups)
    call sum_groups(rows%n_group, points%slave_weights, points%master_weights, points%area, &
      rows%groups)
    call list_nodes(rows%n_group, rows%groups, rows%listed, rows%n_node, rows%node)
    call place_shares(rows%n_node, rows%node, n_share, rows%width)
    call provide_shares(n_share, rows)
    call share_groups(rows%n_group, rows%groups, rows%inverse, rows%node, n_share, rows%share_x, &
      rows%share_y)
  end subroutine form_shares

  !> Room for the groups of so many points.
  pure subroutine provide_groups(n, rows)
    integer, intent(in) :: n
    type(rows_t), intent(inout) :: rows

    if (allocated(rows%groups)) then
      if (size(rows%groups) >= n) return
      deallocate (rows%groups)
    end if
    allocate (rows%groups(n + n/2))
  end subroutine provide_groups

  !> Room for so many shares.
  pure subroutine provide_shares(n, rows)
    integer, intent(in) :: n
    type(rows_t), intent(inout) :: rows

    if (allocated(rows%share_x)) then
      if (size(rows%share_x) >= n) return
      deallocate (rows%share_x, rows%share_y)
    end if
    allocate (rows%share_x(n + n/2), rows%share_y(n + n/2))
  end subroutine provide_shares

  !> Points in a row that rows have shares of.
  pure subroutine find_groups(n, slave_nodes, master_nodes, normal, place, n_group, groups)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *), place(*)
    real(wp), intent(in) :: normal(2, *)
    integer, intent(out) :: n_group
    type(group_t), intent(inout) :: groups(*)
    integer :: begin, one, two, p

    n_group = 0
    begin = 1
    do p = 1, n
      if (p < n) then
        if (slave_nodes(1, p + 1) == slave_nodes(1, p) .and. &
          slave_nodes(2, p + 1) == slave_nodes(2, p) .and. &
          master_nodes(1, p + 1) == master_nodes(1, p) .and. &
          master_nodes(2, p + 1) == master_nodes(2, p) .and. &
          .not. abs(normal(1, p + 1) - normal(1, p)) > 0.0_wp .and. &
          .not. abs(normal(2, p + 1) - normal(2, p)) > 0.0_wp) cycle
      end if
      one = place(slave_nodes(1, p))
      two = place(slave_nodes(2, p))
      if (one + two > 0) then
        n_group = n_group + 1
        groups(n_group)%nodes(:n_side) = slave_nodes(:, p)
        groups(n_group)%nodes(n_side + 1:) = master_nodes(:, p)
        groups(n_group)%rows(1) = one
        groups(n_group)%rows(2) = two
        groups(n_group)%first = begin
        groups(n_group)%last = p
        groups(n_group)%normal = normal(:, p)
      end if
      begin = p + 1
    end do
  end subroutine find_groups

  !> The nodes of all groups, each with its first and last row.
  pure subroutine list_nodes(n, groups, listed, n_node, node)
    integer, intent(in) :: n
    type(group_t), intent(inout) :: groups(n) !! in: numbers of their nodes, out: places on the list
    integer, intent(inout) :: listed(*), node(4, *)
    integer, intent(inout) :: n_node
    integer :: g, i, m, low, high

    do g = 1, n
      high = max(groups(g)%rows(1), groups(g)%rows(2))
      low = min(groups(g)%rows(1), groups(g)%rows(2))
      if (low == 0) low = high
      do m = 1, 2*n_side
        i = listed(groups(g)%nodes(m))
        if (i == 0) then
          n_node = n_node + 1
          i = n_node
          listed(groups(g)%nodes(m)) = i
          node(node_of, i) = groups(g)%nodes(m)
          node(first_row, i) = low
          node(last_row, i) = high
        else
          if (low < node(first_row, i)) node(first_row, i) = low
          if (high > node(last_row, i)) node(last_row, i) = high
        end if
        groups(g)%nodes(m) = i
      end do
    end do
  end subroutine list_nodes

  !> Where the shares of each node are.
  pure subroutine place_shares(n, node, n_share, width)
    integer, intent(in) :: n
    integer, intent(inout) :: node(4, n)
    integer, intent(out) :: n_share, width
    integer :: i

    n_share = 0
    width = 0
    !GCC$ UNROLL 1
    do i = 1, n
      node(share_at, i) = n_share + 1 - node(first_row, i)
      n_share = node(share_at, i) + node(last_row, i) + n_spare
      width = max(width, node(last_row, i) - node(first_row, i))
    end do
  end subroutine place_shares

  !> The sums of all groups.
  pure subroutine sum_groups(n, slave_weights, master_weights, area, groups)
    integer, intent(in) :: n
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *), area(*)
    type(group_t), intent(inout) :: groups(n)
    integer :: g

    do g = 1, n
      associate (group => groups(g))
        call sum_points(group%last - group%first + 1, slave_weights(1, group%first), &
          master_weights(1, group%first), area(group%first), group%part)
      end associate
    end do
  end subroutine sum_groups

  !> The sums of some points.
  pure subroutine sum_points(n, slave_weights, master_weights, area, part)
    integer, intent(in) :: n
    real(wp), intent(in) :: slave_weights(n_side, n), master_weights(n_side, n), area(n)
    real(wp), intent(inout) :: part(n_side, 2, n_side) !! of both sides, of the rows of both slaves
    real(wp) :: one, two
    integer :: p

    part = 0.0_wp
    !GCC$ NOVECTOR
    !GCC$ UNROLL 1
    do p = 1, n
      one = area(p)*slave_weights(1, p)
      two = area(p)*slave_weights(2, p)
      part(:, 1, 1) = part(:, 1, 1) + one*slave_weights(:, p)
      part(:, 2, 1) = part(:, 2, 1) + one*master_weights(:, p)
      part(:, 1, 2) = part(:, 1, 2) + two*slave_weights(:, p)
      part(:, 2, 2) = part(:, 2, 2) + two*master_weights(:, p)
    end do
    part(:, 2, :) = -part(:, 2, :)
  end subroutine sum_points

  !> Give the sums to the rows.
  pure subroutine share_groups(n, groups, inverse, node, n_share, share_x, share_y)
    integer, intent(in) :: n, node(4, *), n_share
    type(group_t), intent(in) :: groups(n)
    real(wp), intent(in) :: inverse(*)
    real(wp), intent(inout) :: share_x(n_share), share_y(n_share)
    real(wp) :: along(2)
    integer :: g, i, k, m, row

    share_x = 0.0_wp
    share_y = 0.0_wp
    do g = 1, n
      do k = 1, n_side
        row = groups(g)%rows(k)
        if (row == 0) cycle
        along = inverse(row)*groups(g)%normal
        !GCC$ NOVECTOR
        do m = 1, 2*n_side
          i = node(share_at, groups(g)%nodes(m)) + row
          share_x(i) = share_x(i) + groups(g)%part(m, k)*along(1)
          share_y(i) = share_y(i) + groups(g)%part(m, k)*along(2)
        end do
      end do
    end do
  end subroutine share_groups

end module weighted_gaps_m
