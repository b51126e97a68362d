! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each overlap of a slave segment with a master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module place_segmented_mortar_m
  use contact_state_m, only : contact_points_t, contact_state_t, is_touching
  use contacts_m, only : contact_t
  use foot_block_m, only : n_block, project_block, settle_odd
  use foot_m, only : foot_t, near_foot, facing_share
  use geometry_m, only : separation
  use kinds_m, only : wp
  use overlap_m, only : overlap_t
  use overlaps_m, only : find_overlaps, room_for_overlaps
  use point_list_m, only : place_block_t, append_points, drop_places, weigh_points
  use overlap_status_m, only : none_due, look_at_segment, keep_segment, judge_segment, &
    note_next_wake
  use tips_m, only : has_folds, sharpen_tips
  implicit none
  private
  public :: place_segmented_mortar, n_gauss, gauss_xi, least_cut

  !> Gauss points of an overlap.
  integer, parameter :: n_gauss = 2
  !> Where they are on 0 .. 1; both have weight one half. They integrate the product of shape
  !> functions and a linear gap exactly up to the curvature of the chain.
  real(wp), parameter :: gauss_xi(n_gauss) = [0.5_wp - sqrt(1.0_wp/12.0_wp), &
    0.5_wp + sqrt(1.0_wp/12.0_wp)]
  !> Part of a slave segment next to its ends where master nodes do not cut it: the points of an
  !> overlap integrate a kink this close to its end to the square of this part, round-off.
  real(wp), parameter :: least_cut = 1.0e-6_wp

contains

  !> Place the points: of all segments that may touch, then of their neighbours that can not, since
  !> these have a part in the averaged gaps of common nodes.
  pure subroutine place_segmented_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(overlap_t), allocatable :: overlaps(:)
    integer :: s
    logical :: is_due

    if (none_due(memory)) return
    allocate (overlaps(room_for_overlaps(memory)))
    memory%scratch%is_placed = .false.
    do s = 1, contact%slave%n_segment
      call look_at_segment(contact, memory, s, is_due)
      if (is_due) call place_segment(contact, s, .true., memory, overlaps)
    end do
    call note_next_wake(memory)
    if (any(memory%points%gap(:memory%points%n) < memory%closed_gap) &
      .or. (has_folds(contact) .and. memory%slave_tracking%n_touching > 0)) then
      call place_neighbours(contact, memory, overlaps)
    else
      memory%points%n = 0
    end if
    if (contact%is_round) call weigh_points(memory%places, memory%points)
    if (has_folds(contact)) call sharpen_tips(contact, memory)
  end subroutine place_segmented_mortar

  !> Neighbours of segments in contact that have not been placed.
  pure subroutine place_neighbours(contact, memory, overlaps)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    integer :: neighbours(2), s, k

    do s = 1, contact%slave%n_segment
      if (memory%segment_status(s) /= is_touching) cycle
      neighbours = [contact%slave%previous(s), contact%slave%next(s)]
      do k = 1, 2
        if (neighbours(k) == 0) cycle
        if (memory%scratch%is_placed(neighbours(k))) cycle
        memory%scratch%is_placed(neighbours(k)) = .true.
        call place_segment(contact, neighbours(k), .false., memory, overlaps)
      end do
    end do
  end subroutine place_neighbours

  !> The points of one slave segment; one that may touch is judged by them.
  pure subroutine place_segment(contact, s, may_touch, memory, overlaps)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s
    logical, intent(in) :: may_touch
    type(contact_state_t), intent(inout) :: memory
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    type(place_block_t) :: block
    real(wp) :: deepest
    integer :: ends(2), n_before, n, first
    logical :: counts

    ends = contact%slave%segments(:, s)
    call find_overlaps(contact, memory, s, .false., least_cut, overlaps, n)
    n_before = memory%points%n
    deepest = huge(1.0_wp)
    do first = 1, n, n_block/n_gauss
      call find_points(contact, memory, ends, &
        overlaps(first:min(n, first + n_block/n_gauss - 1)), block)
      if (block%n > 0) deepest = min(deepest, minval(block%feet%gap(:block%n)))
      call append_points(block, memory%slave_penalty, memory%points)
    end do
    if (.not. may_touch) return
    call judge_points(memory, s, ends, deepest, counts)
    if (.not. counts) memory%points%n = n_before
  end subroutine place_segment

  !> Whether the points of a segment count. Where neither they nor an end of it is in contact they
  !> are left to the neighbours, like those of a segment that sleeps: so sums over the points of a
  !> node do not depend on who sleeps.
  pure subroutine judge_points(memory, s, ends, deepest, counts)
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s, ends(2) !! segment, its nodes
    real(wp), intent(in) :: deepest   !! smallest gap of its points, m
    logical, intent(out) :: counts

    counts = .true.
    memory%scratch%is_placed(s) = .true.
    if (all(memory%slave_tracking%status(ends) == is_touching)) then
      call keep_segment(deepest < memory%closed_gap, memory%travel, memory%segment_status(s), &
        memory%segment_wake(s))
      return
    end if
    call judge_segment(memory, s, ends, deepest, counts)
    if (.not. counts .or. deepest < memory%closed_gap) return
    counts = any(memory%slave_tracking%status(ends) == is_touching)
    memory%scratch%is_placed(s) = counts
  end subroutine judge_points

  !> Gauss points of some overlaps of a slave segment, each over its master segment or whatever is
  !> closest there; those that do not count are left out.
  pure subroutine find_points(contact, memory, ends, overlaps, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)             !! nodes of the slave segment
    type(overlap_t), intent(in) :: overlaps(:) !! at most as many as a block has room for
    type(place_block_t), intent(inout) :: block

    block%n = n_gauss*size(overlaps)
    block%feet%n = block%n
    call put_points(contact, memory, ends, overlaps, block)
    call project_block(block%feet)
    if (block%feet%n_odd > 0) then
      call settle_odd(contact%master, memory%places(:, memory%n_slave + 1:), block%feet)
      call place_odd(contact, memory, ends, overlaps, block)
    end if
    if (count(block%area(:block%n) > 0.0_wp) < block%n) call drop_places(block)
  end subroutine find_points

  !> Where the points are, and how they lie to their master segments.
  pure subroutine put_points(contact, memory, ends, overlaps, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(overlap_t), intent(in) :: overlaps(:)
    type(place_block_t), intent(inout) :: block
    real(wp) :: own(2), other(2), way(2), length
    integer :: nodes(2), k, p, q

    own = separation(memory%places(:, ends(2)), memory%places(:, ends(1)))
    length = sqrt(own(1)*own(1) + own(2)*own(2))
    do k = 1, size(overlaps)
      nodes = memory%n_slave + contact%master%segments(:, overlaps(k)%master)
      other = separation(memory%places(:, nodes(2)), memory%places(:, nodes(1)))
      way = separation(memory%places(:, ends(1)), memory%places(:, nodes(1)))
      do q = 1, n_gauss
        p = n_gauss*(k - 1) + q
        associate (xi => block%xi(p), overlap => overlaps(k))
          xi = overlap%low + gauss_xi(q)*(overlap%high - overlap%low)
          block%area(p) = 0.5_wp*(overlap%high - overlap%low)*length*overlap%share
          block%ends(:, p) = ends
          block%nodes(:, p) = nodes
          block%feet%segment(p) = overlap%master
          block%feet%t(:, p) = other
          block%feet%d(:, p) = way + xi*own
        end associate
      end do
    end do
  end subroutine put_points

  !> Points whose projection needs a decision, or whose normal is not that of the master segment of
  !> their overlap.
  pure subroutine place_odd(contact, memory, ends, overlaps, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(overlap_t), intent(in) :: overlaps(:)
    type(place_block_t), intent(inout) :: block
    type(foot_t) :: foot
    real(wp) :: own(2), length
    integer :: p

    own = separation(memory%places(:, ends(2)), memory%places(:, ends(1)))
    length = sqrt(own(1)*own(1) + own(2)*own(2))
    do p = 1, block%n
      if (.not. abs(block%feet%odd(p)) > 0.0_wp) cycle
      associate (feet => block%feet, overlap => overlaps(1 + (p - 1)/n_gauss))
        if (feet%odd(p) > 0.0_wp .and. block%area(p) > 0.0_wp) then
          foot = near_foot(contact%master, memory%places(:, memory%n_slave + 1:), &
            (1.0_wp - block%xi(p))*memory%places(:, ends(1)) &
            + block%xi(p)*memory%places(:, ends(2)), overlap%master)
          block%nodes(:, p) = memory%n_slave + contact%master%segments(:, foot%segment)
          feet%xi(p) = foot%xi
          feet%gap(p) = foot%gap
          feet%normal(:, p) = foot%normal
          if (.not. foot%is_on) block%area(p) = 0.0_wp
        else if (feet%segment(p) /= overlap%master) then
          block%nodes(:, p) = memory%n_slave + contact%master%segments(:, feet%segment(p))
        end if
        if (block%area(p) > 0.0_wp) block%area(p) = 0.5_wp*(overlap%high - overlap%low)*length &
          *overlap%part*facing_share((own(2)*feet%normal(1, p) - own(1)*feet%normal(2, p))/length)
      end associate
    end do
  end subroutine place_odd

end module place_segmented_mortar_m
