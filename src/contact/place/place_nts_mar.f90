! SPDX-License-Identifier: MIT
!> Type 5, NTS-mAR: type 2 with a modified competence length, and in addition the master nodes
!> between the feet of the two ends of a slave segment, projected on that segment
!> (doc/theory/contact.md, section 5.5).
module place_nts_mar_m
  use contact_state_m, only : contact_state_t, contact_points_t, is_touching
  use contacts_m, only : contact_t
  use foot_block_m, only : n_block
  use foot_m, only : see_segment, facing_share, round_off
  use geometry_m, only : sight_t, sight_of_segment, sight_gap, sight_normal, segment_length
  use kinds_m, only : wp
  use lengths_m, only : competence_area
  use overlap_m, only : overlap_t
  use overlaps_m, only : find_overlaps, room_for_overlaps
  use radii_m, only : end_radius, radius_between
  use point_list_m, only : place_block_t, append_points, append_touching, add_length
  use overlap_status_m, only : none_due, look_at_segment, keep_segment, judge_segment, &
    note_next_wake
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
    type(place_block_t) :: cuts
    type(overlap_t), allocatable :: overlaps(:)
    integer :: s, n, k
    logical :: is_due

    if (none_due(memory)) return
    allocate (overlaps(room_for_overlaps(memory)))
    call append_touching(memory%slave_tracking, contact%master, [0, memory%n_slave], 0.0_wp, &
      memory%slave_penalty, memory%points)
    n = memory%points%n
    do k = 1, n
      memory%scratch%point_at(memory%slave_tracking%touching(k)) = k
    end do
    cuts%n = 0
    do s = 1, contact%slave%n_segment
      call look_at_segment(contact, memory, s, is_due)
      if (is_due) call place_segment(contact, s, memory, cuts, overlaps)
    end do
    call append_points(cuts, memory%slave_penalty, memory%points)
    call note_next_wake(memory)
    call finish_nodes(contact, memory, n)
    memory%scratch%point_at = 0
  end subroutine place_nts_mar

  !> Divide a slave segment among its ends and the master nodes at its breakpoints, and judge it.
  pure subroutine place_segment(contact, s, memory, cuts, overlaps)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t), intent(inout) :: cuts
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    real(wp) :: deepest
    integer :: ends(2), n, n_before, n_points
    logical :: counts

    ends = contact%slave%segments(:, s)
    call find_overlaps(contact, memory, s, contact%strict, round_off, overlaps, n)
    if (cuts%n + n > n_block) call append_points(cuts, memory%slave_penalty, memory%points)
    n_before = cuts%n
    n_points = memory%points%n
    call share_halves(contact, ends, overlaps(:n), memory, cuts, deepest)
    if (all(memory%slave_tracking%status(ends) == is_touching)) then
      call keep_segment(deepest < memory%closed_gap, memory%travel, memory%segment_status(s), &
        memory%segment_wake(s))
    else
      call judge_segment(memory, s, ends, deepest, counts)
      if (.not. counts) call drop_last(n_points, n_before, memory%points, cuts)
    end if
  end subroutine place_segment

  !> Half of an overlap, as far as it counts, for either of its ends, m; in axisymmetry weighted
  !> with the radius, so that they differ. With the strict rule all but sides of corners counts.
  pure function halves_of(contact, a, b, length, overlap) result(halves)
    type(contact_t), intent(in) :: contact
    real(wp), intent(in) :: a(4), b(4)     !! ends of the slave segment
    real(wp), intent(in) :: length         !! of that, m
    type(overlap_t), intent(in) :: overlap
    real(wp) :: halves(2)
    real(wp) :: low, high

    halves = 0.5_wp*(overlap%high - overlap%low)*length
    halves = halves*merge(overlap%part, overlap%share, contact%strict)
    if (.not. contact%is_round) return
    low = radius_between(a, b, overlap%low)
    high = radius_between(a, b, overlap%high)
    halves(1) = halves(1)*end_radius(low, high)
    halves(2) = halves(2)*end_radius(high, low)
  end function halves_of

  !> What stands at the end of an overlap has half of it and half of the next; between overlaps with
  !> two bodies two nodes may stand there.
  pure subroutine share_halves(contact, ends, overlaps, memory, cuts, deepest)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: ends(2)       !! nodes of the slave segment
    type(overlap_t), intent(in) :: overlaps(:)
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t), intent(inout) :: cuts
    real(wp), intent(out) :: deepest     !! smallest gap of its master nodes, m
    real(wp) :: length, whole, halves(2)
    integer :: k, node
    logical :: is_first

    deepest = huge(1.0_wp)
    if (size(overlaps) == 0) return
    whole = segment_length(memory%places(:, ends(1)), memory%places(:, ends(2)))
    node = overlaps(1)%first
    is_first = .true.
    length = 0.0_wp
    do k = 1, size(overlaps)
      if (.not. overlaps(k)%high > overlaps(k)%low) cycle
      halves = halves_of(contact, memory%places(:, ends(1)), memory%places(:, ends(2)), whole, &
        overlaps(k))
      if (overlaps(k)%first /= node) then
        if (node > 0) call add_cut(ends, node, length, memory, cuts, deepest)
        node = overlaps(k)%first
        length = 0.0_wp
        is_first = .true.
      end if
      if (node == 0 .and. .not. is_first) then
        ! No node stands between two overlaps: either belongs to its own end.
        call add_length(memory%points, memory%scratch%point_at(ends(1)), length)
        node = overlaps(k)%last
        length = sum(halves)
        cycle
      end if
      length = length + halves(1)
      if (node > 0) then
        call add_cut(ends, node, length, memory, cuts, deepest)
      else
        call add_length(memory%points, memory%scratch%point_at(ends(1)), length)
      end if
      node = overlaps(k)%last
      length = halves(2)
      is_first = .false.
    end do
    if (node > 0) then
      call add_cut(ends, node, length, memory, cuts, deepest)
    else
      call add_length(memory%points, memory%scratch%point_at(ends(2)), length)
    end if
  end subroutine share_halves

  !> Add a point at a master node with a gap that is closed.
  pure subroutine add_cut(ends, node, area, memory, cuts, deepest)
    integer, intent(in) :: ends(2)     !! nodes of the slave segment
    integer, intent(in) :: node        !! of the master
    real(wp), intent(in) :: area       !! m
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t), intent(inout) :: cuts
    real(wp), intent(inout) :: deepest !! m
    type(sight_t) :: sight
    real(wp) :: gap

    sight = sight_of_segment(memory%places(:, memory%n_slave + node), memory%places(:, ends(1)), &
      memory%places(:, ends(2)))
    gap = sight_gap(sight)
    if (gap >= memory%closed_gap .or. .not. area > 0.0_wp) return
    if (cuts%n == n_block) call append_points(cuts, memory%slave_penalty, memory%points)
    deepest = min(deepest, gap)
    associate (n => cuts%n)
      n = n + 1
      cuts%ends(:, n) = ends
      cuts%xi(n) = sight%along/sight%square
      cuts%nodes(:, n) = memory%n_slave + node
      cuts%feet%xi(n) = 0.0_wp
      cuts%feet%gap(n) = gap
      cuts%feet%normal(:, n) = -sight_normal(sight)
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
