! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each piece of slave segment that faces one master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module place_segmented_mortar_m
  use contact_state_m, only : contact_points_t, contact_state_t, is_touching
  use contacts_m, only : contact_t
  use foot_block_m, only : project_block, settle_odd
  use foot_m, only : foot_t, near_foot, facing_share
  use kinds_m, only : wp
  use piece_table_m, only : piece_table_t, n_piece_block
  use pieces_m, only : clear_pieces, list_due, list_segment, cut_pieces
  use point_list_m, only : place_block_t, append_points, drop_places, weigh_points
  use overlap_status_m, only : none_due, keep_segment, judge_segment, note_next_wake
  use tips_m, only : has_folds, sharpen_tips
  implicit none
  private
  public :: place_segmented_mortar, n_gauss, gauss_xi, least_cut

  !> Gauss points of a piece.
  integer, parameter :: n_gauss = 2
  !> Where they are on 0 .. 1; both have weight one half. They integrate the product of shape
  !> functions and a linear gap exactly up to the curvature of the chain.
  real(wp), parameter :: gauss_xi(n_gauss) = [0.5_wp - sqrt(1.0_wp/12.0_wp), &
    0.5_wp + sqrt(1.0_wp/12.0_wp)]
  !> Part of a slave segment next to its ends where master nodes do not cut it: the points of a
  !> piece integrate a kink this close to its end to the square of this part, round-off.
  real(wp), parameter :: least_cut = 1.0e-6_wp

contains

  !> Place the points: of all segments that may touch, then of their neighbours that can not, since
  !> these have a part in the averaged gaps of common nodes.
  pure subroutine place_segmented_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(piece_table_t), allocatable :: table
    integer :: s

    if (none_due(memory)) return
    call move_alloc(memory%scratch%pieces, table)
    memory%scratch%is_placed = .false.
    s = 1
    do while (s <= contact%slave%n_segment)
      call clear_pieces(table, least_cut)
      call list_due(contact, memory, .false., s, table)
      call place_pieces(contact, table, .true., memory)
    end do
    call note_next_wake(memory)
    if (any(memory%points%gap(:memory%points%n) < memory%closed_gap) &
      .or. (has_folds(contact) .and. memory%slave_tracking%n_touching > 0)) then
      call place_neighbours(contact, table, memory)
    else
      memory%points%n = 0
    end if
    call move_alloc(table, memory%scratch%pieces)
    if (contact%is_round) call weigh_points(memory%places, memory%points)
    if (has_folds(contact)) call sharpen_tips(contact, memory)
  end subroutine place_segmented_mortar

  !> Neighbours of segments in contact that have not been placed.
  pure subroutine place_neighbours(contact, table, memory)
    type(contact_t), intent(in) :: contact
    type(piece_table_t), intent(inout) :: table
    type(contact_state_t), intent(inout) :: memory
    integer :: neighbours(2), s, k

    call clear_pieces(table, least_cut)
    do s = 1, contact%slave%n_segment
      if (memory%segment_status(s) /= is_touching) cycle
      neighbours = [contact%slave%previous(s), contact%slave%next(s)]
      do k = 1, 2
        if (neighbours(k) == 0) cycle
        if (memory%scratch%is_placed(neighbours(k))) cycle
        memory%scratch%is_placed(neighbours(k)) = .true.
        call list_segment(contact, memory, neighbours(k), .false., table)
        if (.not. table%is_full) cycle
        call place_pieces(contact, table, .false., memory)
        call clear_pieces(table, least_cut)
      end do
    end do
    call place_pieces(contact, table, .false., memory)
  end subroutine place_neighbours

  !> Cut the segments of a table and place their points, some segments at a time. Those of segments
  !> that may touch are judged by them.
  pure subroutine place_pieces(contact, table, may_touch, memory)
    type(contact_t), intent(in) :: contact
    type(piece_table_t), intent(inout) :: table
    logical, intent(in) :: may_touch
    type(contact_state_t), intent(inout) :: memory
    integer :: first, last

    call cut_pieces(contact, memory, table)
    first = 1
    do while (first <= table%n_segment)
      last = first
      do while (last < table%n_segment)
        if (table%last(last + 1) - table%last(first - 1) > n_piece_block) exit
        last = last + 1
      end do
      call place_segments(contact, table, first, last, may_touch, memory)
      first = last + 1
    end do
  end subroutine place_pieces

  !> The points of the segments from one to another of a table: of one with more pieces than a block
  !> has room for, or of several.
  pure subroutine place_segments(contact, table, first, last, may_touch, memory)
    type(contact_t), intent(in) :: contact
    type(piece_table_t), intent(in) :: table
    integer, intent(in) :: first, last
    logical, intent(in) :: may_touch
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t) :: block
    real(wp) :: deepest
    integer :: from, to, n_before, i, k, place, last_place
    logical :: counts, is_odd

    n_before = memory%points%n
    from = table%last(first - 1) + 1
    deepest = huge(1.0_wp)
    do while (table%last(last) - from >= n_piece_block)
      to = from + n_piece_block - 1
      call find_points(contact, memory, table, from, to, block, is_odd)
      call drop_places(block)
      if (block%n > 0) deepest = min(deepest, minval(block%feet%gap(:block%n)))
      call append_points(block, memory%slave_penalty, memory%points)
      from = to + 1
    end do
    call find_points(contact, memory, table, from, table%last(last), block, is_odd)
    do i = first, last
      place = n_gauss*(max(from, table%last(i - 1) + 1) - from) + 1
      last_place = n_gauss*(table%last(i) - from + 1)
      do k = place, last_place
        if (block%area(k) > 0.0_wp) deepest = min(deepest, block%feet%gap(k))
      end do
      counts = .true.
      if (may_touch) call judge_points(contact, memory, table%slave(i), table%touches(i), deepest, &
        counts)
      deepest = huge(1.0_wp)
      if (counts) cycle
      is_odd = .true.
      block%area(place:last_place) = 0.0_wp
      if (first == last) memory%points%n = n_before
    end do
    if (is_odd) call drop_places(block)
    call append_points(block, memory%slave_penalty, memory%points)
  end subroutine place_segments

  !> Whether the points of a segment count. Where neither they nor an end of it is in contact they
  !> are left to the neighbours, like those of a segment that sleeps: so sums over the points of a
  !> node do not depend on who sleeps.
  pure subroutine judge_points(contact, memory, s, touches, deepest, counts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: touches  !! both ends are in contact
    real(wp), intent(in) :: deepest !! smallest gap of its points, m
    logical, intent(out) :: counts

    counts = .true.
    memory%scratch%is_placed(s) = .true.
    if (touches) then
      call keep_segment(deepest < memory%closed_gap, memory%travel, memory%segment_status(s), &
        memory%segment_wake(s))
      return
    end if
    associate (ends => contact%slave%segments(:, s))
      call judge_segment(contact, memory, s, ends, deepest, counts)
      if (.not. counts .or. deepest < memory%closed_gap) return
      counts = any(memory%slave_tracking%status(ends) == is_touching)
      memory%scratch%is_placed(s) = counts
    end associate
  end subroutine judge_points

  !> Gauss points of some pieces, each over its master segment or whatever is closest there. Places
  !> that do not count have no area.
  pure subroutine find_points(contact, memory, table, first, last, block, is_odd)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(piece_table_t), intent(in) :: table
    integer, intent(in) :: first, last !! pieces
    type(place_block_t), intent(inout) :: block
    logical, intent(out) :: is_odd     !! some place does not count

    block%n = n_gauss*(last - first + 1)
    block%feet%n = block%n
    associate (n => last - first + 1)
      call put_nodes(n, table%ends(1, first), table%nodes(1, first), table%master(first), block)
      call put_places(n, table%own(1, first), table%other(1, first), table%way(1, first), &
        table%low(first), table%high(first), table%length(first), table%share(first), block)
    end associate
    call project_block(block%feet)
    is_odd = count(block%area(:block%n) > 0.0_wp) < block%n
    if (block%feet%n_odd == 0) return
    call settle_odd(contact%master, memory%places(:, memory%n_slave + 1:), block%feet)
    call place_odd(contact, memory, table, first, block, is_odd)
  end subroutine find_points

  !> Nodes of the places on some pieces.
  pure subroutine put_nodes(n, ends, nodes, master, block)
    integer, intent(in) :: n, ends(2, n), nodes(2, n), master(n)
    type(place_block_t), intent(inout) :: block
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      block%ends(:, 2*k - 1) = ends(:, k)
      block%ends(:, 2*k) = ends(:, k)
      block%nodes(:, 2*k - 1) = nodes(:, k)
      block%nodes(:, 2*k) = nodes(:, k)
      block%feet%segment(2*k - 1) = master(k)
      block%feet%segment(2*k) = master(k)
    end do
  end subroutine put_nodes

  !> Where they are, and how they lie to the master segments of these.
  pure subroutine put_places(n, own, other, way, low, high, length, share, block)
    integer, intent(in) :: n
    real(wp), intent(in), dimension(2, n) :: own, other, way
    real(wp), intent(in), dimension(n) :: low, high, length, share
    type(place_block_t), intent(inout) :: block
    real(wp) :: area, xi
    integer :: k, p, q

    do k = 1, n
      area = 0.5_wp*(high(k) - low(k))*length(k)*share(k)
      do q = 1, n_gauss
        p = n_gauss*(k - 1) + q
        xi = low(k) + gauss_xi(q)*(high(k) - low(k))
        block%area(p) = area
        block%xi(p) = xi
        block%feet%t(1, p) = other(1, k)
        block%feet%t(2, p) = other(2, k)
        block%feet%d(1, p) = way(1, k) + xi*own(1, k)
        block%feet%d(2, p) = way(2, k) + xi*own(2, k)
      end do
    end do
  end subroutine put_places

  !> Places whose feet need a decision, or whose normal is not that of their piece's master segment.
  pure subroutine place_odd(contact, memory, table, first, block, is_odd)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(piece_table_t), intent(in) :: table
    integer, intent(in) :: first
    type(place_block_t), intent(inout) :: block
    logical, intent(inout) :: is_odd
    type(foot_t) :: foot
    real(wp) :: share
    integer :: p, k

    do p = 1, block%n
      if (.not. abs(block%feet%odd(p)) > 0.0_wp) cycle
      k = first + (p - 1)/n_gauss
      associate (feet => block%feet, one => memory%places(:, block%ends(1, p)), &
        two => memory%places(:, block%ends(2, p)))
        if (feet%odd(p) > 0.0_wp .and. block%area(p) > 0.0_wp) then
          foot = near_foot(contact%master, memory%places(:, memory%n_slave + 1:), &
            (1.0_wp - block%xi(p))*one + block%xi(p)*two, table%master(k))
          block%nodes(:, p) = memory%n_slave + contact%master%segments(:, foot%segment)
          feet%xi(p) = foot%xi
          feet%gap(p) = foot%gap
          feet%normal(:, p) = foot%normal
          if (.not. foot%is_on) block%area(p) = 0.0_wp
        else if (feet%segment(p) /= table%master(k)) then
          block%nodes(:, p) = memory%n_slave + contact%master%segments(:, feet%segment(p))
        end if
        if (block%area(p) > 0.0_wp) then
          share = facing_share(dot_product(table%normal(:, k), feet%normal(:, p)))
          block%area(p) = share*0.5_wp*(table%high(k) - table%low(k))*table%length(k)
        end if
        is_odd = is_odd .or. .not. block%area(p) > 0.0_wp
      end associate
    end do
  end subroutine place_odd

end module place_segmented_mortar_m
