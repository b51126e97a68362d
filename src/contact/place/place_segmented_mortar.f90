! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each overlap of a slave segment with a master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module place_segmented_mortar_m
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use foot_block_m, only : n_block, project_block, settle_odd
  use foot_m, only : foot_t, near_foot, stays_over
  use geometry_m, only : separation
  use kinds_m, only : wp
  use overlap_m, only : overlap_t
  use overlaps_m, only : find_overlaps, room_for_overlaps
  use point_list_m, only : place_block_t, append_points, finish_segment_points
  use overlap_status_m, only : none_due, look_at_segment, note_next_wake
  use segment_points_m, only : judge_segments
  use tips_m, only : has_folds, find_tips, sharpen_tips
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
    type(place_block_t) :: block
    integer :: s, n
    logical :: is_due

    if (none_due(memory)) return
    allocate (overlaps(room_for_overlaps(memory)))
    if (has_folds(contact)) call find_tips(contact%slave, memory)
    memory%scratch%is_placed = .false.
    block%n = 0
    do s = 1, contact%slave%n_segment
      call look_at_segment(contact, memory, s, is_due)
      if (is_due) call place_segment(contact, s, memory, overlaps, block)
    end do
    call finish_block(contact, memory, block)
    call judge_segments(contact, 0, memory)
    call note_next_wake(memory)
    n = memory%points%n
    if (any(memory%points%gap(:n) < memory%closed_gap .and. memory%points%area(:n) > 0.0_wp) &
      .or. (has_folds(contact) .and. memory%slave_tracking%n_touching > 0)) then
      call place_neighbours(contact, memory, overlaps, block)
    else
      memory%points%n = 0
    end if
    call finish_segment_points(memory%places, contact%is_round, 1, memory%points)
    if (has_folds(contact)) call sharpen_tips(contact, memory)
  end subroutine place_segmented_mortar

  !> Neighbours of segments in contact that have not been placed.
  pure subroutine place_neighbours(contact, memory, overlaps, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    type(place_block_t), intent(inout) :: block !! empty
    integer :: neighbours(2), s, k

    do s = 1, contact%slave%n_segment
      if (memory%segment_status(s) /= is_touching) cycle
      neighbours = [contact%slave%previous(s), contact%slave%next(s)]
      do k = 1, 2
        if (neighbours(k) == 0) cycle
        if (.not. memory%scratch%is_placed(neighbours(k))) &
          call place_segment(contact, neighbours(k), memory, overlaps, block)
      end do
    end do
    call finish_block(contact, memory, block)
  end subroutine place_neighbours

  !> The points of one slave segment, with areas as if they were opposed to the master entirely.
  pure subroutine place_segment(contact, s, memory, overlaps, block)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s
    type(contact_state_t), intent(inout) :: memory
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    type(place_block_t), intent(inout) :: block
    real(wp) :: own(2), other(2), way(2), length
    integer :: ends(2), nodes(2), n, k, q, p

    memory%scratch%is_placed(s) = .true.
    ends = contact%slave%segments(:, s)
    call find_overlaps(contact, memory, s, .false., least_cut, overlaps, n)
    own = separation(memory%places(:, ends(2)), memory%places(:, ends(1)))
    length = sqrt(own(1)*own(1) + own(2)*own(2))
    do k = 1, n
      if (.not. overlaps(k)%share > 0.0_wp) cycle
      if (block%n + n_gauss > n_block) call finish_block(contact, memory, block)
      nodes = memory%n_slave + contact%master%segments(:, overlaps(k)%master)
      other = separation(memory%places(:, nodes(2)), memory%places(:, nodes(1)))
      way = separation(memory%places(:, ends(1)), memory%places(:, nodes(1)))
      do q = 1, n_gauss
        p = block%n + q
        associate (xi => block%xi(p), part => overlaps(k)%high - overlaps(k)%low)
          xi = overlaps(k)%low + gauss_xi(q)*part
          block%area(p) = 0.5_wp*part*length*overlaps(k)%part
          block%ends(:, p) = ends
          block%nodes(:, p) = nodes
          block%feet%segment(p) = overlaps(k)%master
          block%feet%t(:, p) = other
          block%feet%d(:, p) = way + xi*own
        end associate
      end do
      block%n = block%n + n_gauss
    end do
  end subroutine place_segment

  !> Project the points of a block on the master segments of their overlaps, or on whatever is
  !> closest there, and append them; those without a projection have no area.
  pure subroutine finish_block(contact, memory, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(place_block_t), intent(inout) :: block

    block%feet%n = block%n
    call project_block(block%feet)
    if (block%feet%n_odd > 0) call place_odd(contact, memory, block)
    call append_points(block, memory%slave_penalty, memory%points)
  end subroutine finish_block

  !> Points that may be nearer to a neighbour of the master segment.
  pure subroutine place_odd(contact, memory, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(place_block_t), intent(inout) :: block
    type(foot_t) :: foot
    integer :: p

    associate (feet => block%feet, chain => memory%places(:, memory%n_slave + 1:))
      call settle_odd(contact%master, chain, feet)
      do p = 1, block%n
        if (.not. feet%odd(p) > 0.0_wp) cycle
        if (feet%gap(p) >= 0.0_wp) then
          if (stays_over(contact%master, chain, feet%t(:, p), feet%d(:, p), feet%segment(p))) cycle
        end if
        associate (ends => block%ends(:, p), xi => block%xi(p))
          foot = near_foot(contact%master, chain, (1.0_wp - xi)*memory%places(:, ends(1)) &
            + xi*memory%places(:, ends(2)), feet%segment(p))
        end associate
        block%nodes(:, p) = memory%n_slave + contact%master%segments(:, foot%segment)
        feet%xi(p) = foot%xi
        feet%gap(p) = foot%gap
        feet%normal(:, p) = foot%normal
        if (.not. foot%is_on) block%area(p) = 0.0_wp
      end do
    end associate
  end subroutine place_odd

end module place_segmented_mortar_m
