! SPDX-License-Identifier: MIT
!> Type 5, NTS-mAR: type 2 with a modified competence length, and in addition the master nodes
!> between the feet of the two ends of a slave segment, projected on that segment
!> (doc/theory/contact.md, section 5.5).
module place_nts_mar_m
  use contact_state_m, only : contact_state_t, contact_points_t
  use contacts_m, only : contact_t
  use foot_block_m, only : n_block
  use foot_m, only : see_segment, facing_share
  use geometry_m, only : sight_t, sight_of_segment, sight_gap, sight_normal
  use kinds_m, only : wp
  use lengths_m, only : competence_area
  use piece_table_m, only : piece_table_t, is_last_piece
  use pieces_m, only : clear_pieces, list_due, cut_pieces
  use radii_m, only : end_radius, radius_between
  use point_list_m, only : place_block_t, append_points, append_touching, add_length
  use overlap_status_m, only : none_due, keep_segment, judge_segment, note_next_wake
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: place_nts_mar, is_tip

contains

  !> Place the points: slave nodes first; then, segment by segment, their areas and the master
  !> nodes.
  pure subroutine place_nts_mar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(piece_table_t), allocatable :: table
    integer :: s, n, k

    if (none_due(memory)) return
    call append_touching(memory%slave_tracking, contact%master, [0, memory%n_slave], 0.0_wp, &
      memory%slave_penalty, memory%points)
    n = memory%points%n
    do k = 1, n
      memory%scratch%point_at(memory%slave_tracking%touching(k)) = k
    end do
    call move_alloc(memory%scratch%pieces, table)
    s = 1
    do while (s <= contact%slave%n_segment)
      call clear_pieces(table)
      call list_due(contact, memory, contact%strict, s, table)
      call cut_pieces(contact, memory, table)
      call share_pieces(contact, table, memory)
    end do
    call move_alloc(table, memory%scratch%pieces)
    call note_next_wake(memory)
    call finish_nodes(contact, memory, n)
    memory%scratch%point_at = 0
  end subroutine place_nts_mar

  !> Divide the segments of a table among their ends and the master nodes that cut them: half of
  !> each piece to either of its ends, as far as it counts; in axisymmetry weighted with the radius.
  !> With the strict rule all of it counts.
  pure subroutine share_pieces(contact, table, memory)
    type(contact_t), intent(in) :: contact
    type(piece_table_t), intent(inout) :: table
    type(contact_state_t), intent(inout) :: memory

    call halve_pieces(table%n, table%low, table%high, table%length, table%half)
    if (.not. contact%strict) table%half(:table%n) = table%half(:table%n)*table%share(:table%n)
    if (contact%is_round) then
      call share_weighted(contact, table, memory)
    else
      call share_halves(contact, table, table%half, table%half, memory)
    end if
  end subroutine share_pieces

  !> The same in axisymmetry: what either end of a piece gets differs.
  pure subroutine share_weighted(contact, table, memory)
    type(contact_t), intent(in) :: contact
    type(piece_table_t), intent(inout) :: table
    type(contact_state_t), intent(inout) :: memory
    real(wp), dimension(table%n) :: to_first, to_last
    real(wp) :: low, high
    integer :: k

    do k = 1, table%n
      associate (a => memory%places(:, table%ends(1, k)), b => memory%places(:, table%ends(2, k)))
        low = radius_between(a, b, table%low(k))
        high = radius_between(a, b, table%high(k))
      end associate
      to_first(k) = table%half(k)*end_radius(low, high)
      to_last(k) = table%half(k)*end_radius(high, low)
    end do
    call share_halves(contact, table, to_first, to_last, memory)
  end subroutine share_weighted

  !> Give the areas of all pieces to what stands at their ends.
  pure subroutine share_halves(contact, table, to_first, to_last, memory)
    type(contact_t), intent(in) :: contact
    type(piece_table_t), intent(inout) :: table
    real(wp), intent(in) :: to_first(*), to_last(*) !! where a piece starts, and where it ends
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t) :: cuts
    real(wp) :: deepest
    integer :: i, n_before, n_points, n
    logical :: counts

    n = 0
    cuts%n = 0
    do i = 1, table%n_segment
      associate (first => table%last(i - 1) + 1, last => table%last(i), s => table%slave(i))
        if (table%touches(i) .and. is_plain(table%kind, to_first, first, last)) then
          n_before = n
          call add_ends(first, last, table%ends, to_first, to_last, memory%scratch%point_at, &
            memory%points%area)
          call list_cuts(first, last, table%node_gap, memory%closed_gap, n, table%rows)
          call keep_segment(n > n_before, memory%travel, memory%segment_status(s), &
            memory%segment_wake(s))
          cycle
        end if
        if (cuts%n + last - first >= n_block) &
          call append_points(cuts, memory%slave_penalty, memory%points)
        n_before = cuts%n
        n_points = memory%points%n
        call share_segment(table, first, last, to_first, to_last, memory, cuts, deepest)
        if (table%touches(i)) then
          call keep_segment(deepest < memory%closed_gap, memory%travel, memory%segment_status(s), &
            memory%segment_wake(s))
        else
          call judge_segment(contact, memory, s, contact%slave%segments(:, s), deepest, counts)
          if (.not. counts) call drop_last(n_points, n_before, memory%points, cuts)
        end if
      end associate
    end do
    call append_points(cuts, memory%slave_penalty, memory%points)
    do i = 1, n, n_block
      cuts%n = min(n_block, n - i + 1)
      call put_cuts(cuts%n, table%rows(i), to_first, to_last, table%ends, table%nodes, table%cut, &
        table%node_gap, table%normal, cuts)
      call append_points(cuts, memory%slave_penalty, memory%points)
    end do
  end subroutine share_halves

  !> Half the length of each piece, m.
  pure subroutine halve_pieces(n, low, high, length, half)
    integer, intent(in) :: n
    real(wp), intent(in) :: low(n), high(n), length(n)
    real(wp), intent(inout) :: half(n)

    half = 0.5_wp*(high - low)*length
  end subroutine halve_pieces

  !> Whether the pieces of a segment are listed from one end to the other, none of them empty.
  pure function is_plain(kind, areas, first, last)
    integer, intent(in) :: kind(*), first, last
    real(wp), intent(in) :: areas(*)
    logical :: is_plain
    integer :: k

    is_plain = .false.
    if (last < first) return
    if (kind(last) /= is_last_piece) return
    do k = first, last
      if (.not. areas(k) > 0.0_wp) return
    end do
    is_plain = .true.
  end function is_plain

  !> The slave nodes at the ends of such a segment get their parts.
  pure subroutine add_ends(first, last, ends, to_first, to_last, point_at, area)
    integer, intent(in) :: first, last     !! pieces
    integer, intent(in) :: ends(2, *)      !! of all pieces, as those that follow
    real(wp), intent(in) :: to_first(*), to_last(*) !! m
    integer, intent(in) :: point_at(*)     !! at each slave node, 0: none
    real(wp), intent(inout) :: area(*)     !! of the points, m
    integer :: p

    p = point_at(ends(1, first))
    if (p > 0) area(p) = area(p) + to_first(first)
    p = point_at(ends(2, first))
    if (p > 0) area(p) = area(p) + to_last(last)
  end subroutine add_ends

  !> Its master nodes in contact go on a list of pieces that end there.
  pure subroutine list_cuts(first, last, node_gap, closed_gap, n, rows)
    integer, intent(in) :: first, last     !! pieces
    real(wp), intent(in) :: node_gap(*), closed_gap !! m
    integer, intent(inout) :: n, rows(*)
    integer :: k

    do k = first, last - 1
      if (.not. node_gap(k) < closed_gap) cycle
      n = n + 1
      rows(n) = k
    end do
  end subroutine list_cuts

  !> Points at the master nodes where some pieces end: these and the next pieces are halved there.
  pure subroutine put_cuts(n, rows, to_first, to_last, ends, nodes, cut, node_gap, normal, cuts)
    integer, intent(in) :: n, rows(n), ends(2, *), nodes(2, *)
    real(wp), intent(in) :: to_first(*), to_last(*), cut(*), node_gap(*), normal(2, *)
    type(place_block_t), intent(inout) :: cuts
    integer :: k, row

    !GCC$ NOVECTOR
    do k = 1, n
      row = rows(k)
      cuts%ends(:, k) = ends(:, row)
      cuts%nodes(1, k) = nodes(1, row)
      cuts%nodes(2, k) = nodes(1, row)
      cuts%xi(k) = cut(row)
      cuts%feet%xi(k) = 0.0_wp
      cuts%feet%gap(k) = node_gap(row)
      cuts%feet%normal(:, k) = -normal(:, row)
      cuts%area(k) = to_last(row) + to_first(row + 1)
    end do
  end subroutine put_cuts

  !> The pieces of one segment. What stands at the end of a piece has half of it and half of the
  !> next; between two chains of the master two nodes may stand there.
  pure subroutine share_segment(table, first, last, to_first, to_last, memory, cuts, deepest)
    type(piece_table_t), intent(in) :: table
    integer, intent(in) :: first, last   !! pieces
    real(wp), intent(in) :: to_first(*), to_last(*) !! of all pieces, m
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t), intent(inout) :: cuts
    real(wp), intent(out) :: deepest     !! smallest gap of its master nodes, m
    real(wp) :: length
    integer :: k, node, before

    deepest = huge(1.0_wp)
    if (last < first) return
    node = table%first_cut(first)
    before = 0
    length = 0.0_wp
    do k = first, last
      if (.not. table%high(k) > table%low(k)) cycle
      if (table%first_cut(k) /= node) then
        if (node > 0) call add_cut(table, before, k, node, length, memory, cuts, deepest)
        node = table%first_cut(k)
        length = 0.0_wp
        before = 0
      end if
      if (node == 0 .and. before > 0) then
        ! No node stands between two pieces: either belongs to its own end.
        call add_length(memory%points, memory%scratch%point_at(table%ends(1, k)), length)
        node = table%last_cut(k)
        length = to_first(k) + to_last(k)
        before = k
        cycle
      end if
      length = length + to_first(k)
      if (node > 0) then
        call add_cut(table, before, k, node, length, memory, cuts, deepest)
      else
        call add_length(memory%points, memory%scratch%point_at(table%ends(1, k)), length)
      end if
      node = table%last_cut(k)
      length = to_last(k)
      before = k
    end do
    if (node > 0) then
      call add_cut(table, before, last, node, length, memory, cuts, deepest)
    else
      call add_length(memory%points, memory%scratch%point_at(table%ends(2, last)), length)
    end if
  end subroutine share_segment

  !> A point at a master node behind a slave segment, with the normal of that.
  pure subroutine add_cut(table, before, k, node, area, memory, cuts, deepest)
    type(piece_table_t), intent(in) :: table
    integer, intent(in) :: before   !! piece behind which the node stands, 0: it starts the chain
    integer, intent(in) :: k        !! a piece of the same slave segment
    integer, intent(in) :: node     !! of the master surface
    real(wp), intent(in) :: area    !! m
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t), intent(inout) :: cuts
    real(wp), intent(inout) :: deepest !! m
    type(sight_t) :: sight
    real(wp) :: gap, xi
    logical :: is_its_end

    is_its_end = before > 0
    if (is_its_end) is_its_end = table%nodes(1, before) == memory%n_slave + node
    if (is_its_end) then
      gap = table%node_gap(before)
      xi = table%cut(before)
    else
      sight = sight_of_segment(memory%places(:, memory%n_slave + node), &
        memory%places(:, table%ends(1, k)), memory%places(:, table%ends(2, k)))
      gap = sight_gap(sight)
      xi = sight%along/sight%square
    end if
    if (gap >= memory%closed_gap .or. .not. area > 0.0_wp) return
    if (cuts%n == n_block) call append_points(cuts, memory%slave_penalty, memory%points)
    deepest = min(deepest, gap)
    associate (n => cuts%n)
      n = n + 1
      cuts%ends(:, n) = table%ends(:, k)
      cuts%xi(n) = xi
      cuts%nodes(:, n) = memory%n_slave + node
      cuts%feet%xi(n) = 0.0_wp
      cuts%feet%gap(n) = gap
      cuts%feet%normal(:, n) = -table%normal(:, k)
      cuts%area(n) = area
    end associate
  end subroutine add_cut

  !> Drop the points of the last segment.
  pure subroutine drop_last(n_points, n_before, points, cuts)
    integer, intent(in) :: n_points, n_before !! points on the list and in the block before it
    type(contact_points_t), intent(inout) :: points
    type(place_block_t), intent(inout) :: cuts

    cuts%n = merge(0, n_before, points%n > n_points)
    points%n = n_points
  end subroutine drop_last

  !> Nodes at a tip keep their whole competence length.
  pure subroutine finish_nodes(contact, memory, n)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: n !! points at slave nodes
    integer :: p, node

    if (count(memory%points%area(:n) > 0.0_wp) == n) return
    do p = 1, n
      if (memory%points%area(p) > 0.0_wp) cycle
      node = memory%points%slave_nodes(1, p)
      if (is_tip(contact%slave, memory, node)) call add_length(memory%points, p, &
        competence_area(contact%slave, memory%places(:, :memory%n_slave), contact%is_round, node))
    end do
  end subroutine finish_nodes

  !> Whether none of the segments at a touching slave node faces the master at its foot.
  pure function is_tip(slave, memory, node)
    type(surface_t), intent(in) :: slave
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node
    logical :: is_tip
    integer :: k, s
    type(sight_t) :: sight

    is_tip = .true.
    do k = 1, 2
      s = merge(slave%incoming(node), slave%outgoing(node), k == 1)
      if (s == 0) cycle
      sight = see_segment(slave, memory%places(:, :memory%n_slave), memory%places(:, node), s)
      if (facing_share(dot_product(sight_normal(sight), memory%slave_tracking%normal(:, node))) &
        > 0.0_wp) is_tip = .false.
    end do
  end function is_tip

end module place_nts_mar_m
