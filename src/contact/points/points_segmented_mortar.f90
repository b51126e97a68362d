! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each overlap of a slave segment with a master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module points_segmented_mortar_m
  use contact_state_m, only : contact_state_t, active
  use contacts_m, only : contact_t
  use projection_block_m, only : n_block, project_block, resolve_ambiguous
  use projection_m, only : projection_t, nearby_projection, stays_over
  use geometry_m, only : separation
  use kinds_m, only : wp
  use overlap_m, only : overlap_t
  use overlaps_m, only : find_overlaps, room_for_overlaps
  use point_list_m, only : point_block_t, append_points, finish_segment_points
  use overlap_status_m, only : none_due, search_segment, note_earliest_search
  use segment_states_m, only : update_segment_states
  use sharp_vertices_m, only : has_folds, find_sharp_vertices, weight_sharp_vertices
  implicit none
  private
  public :: points_segmented_mortar, n_gauss, gauss_xi, least_part

  !> Gauss points of an overlap.
  integer, parameter :: n_gauss = 2
  !> Where they are on 0 .. 1; both have weight one half. They integrate the product of shape
  !> functions and a linear gap exactly up to the curvature of the surface.
  real(wp), parameter :: gauss_xi(n_gauss) = [0.5_wp - sqrt(1.0_wp/12.0_wp), &
    0.5_wp + sqrt(1.0_wp/12.0_wp)]
  !> Part of a slave segment next to its ends where master nodes do not cut it: the points of an
  !> overlap integrate a kink this close to its end to the square of this part, round-off.
  real(wp), parameter :: least_part = 1.0e-6_wp

contains

  !> Generate the points: of all segments that may touch, then of their neighbours that can not,
  !> since these have a part in the averaged gaps of common nodes.
  pure subroutine points_segmented_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(overlap_t), allocatable :: overlaps(:)
    type(point_block_t) :: block
    integer :: s, n
    logical :: is_due

    if (none_due(memory)) return
    allocate (overlaps(room_for_overlaps(memory)))
    if (has_folds(contact)) call find_sharp_vertices(contact%slave, memory)
    memory%scratch%has_points = .false.
    block%n = 0
    do s = 1, contact%slave%n_segment
      call search_segment(contact, memory, s, is_due)
      if (is_due) call points_on_segment(contact, s, memory, overlaps, block)
    end do
    call finish_block(contact, memory, block)
    call update_segment_states(contact, 0, memory)
    call note_earliest_search(memory)
    n = memory%points%n
    if (any(memory%points%gap(:n) < memory%closed_gap .and. memory%points%area(:n) > 0.0_wp) &
      .or. (has_folds(contact) .and. memory%slave_status%n_active > 0)) then
      call points_at_neighbours(contact, memory, overlaps, block)
    else
      memory%points%n = 0
    end if
    call finish_segment_points(memory%positions, contact%is_round, 1, memory%points)
    if (has_folds(contact)) call weight_sharp_vertices(contact, memory)
  end subroutine points_segmented_mortar

  !> Neighbours of segments in contact that have not been placed.
  pure subroutine points_at_neighbours(contact, memory, overlaps, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    type(point_block_t), intent(inout) :: block !! empty
    integer :: neighbours(2), s, k

    do s = 1, contact%slave%n_segment
      if (memory%segment_state(s) /= active) cycle
      neighbours = [contact%slave%previous(s), contact%slave%next(s)]
      do k = 1, 2
        if (neighbours(k) == 0) cycle
        if (.not. memory%scratch%has_points(neighbours(k))) &
          call points_on_segment(contact, neighbours(k), memory, overlaps, block)
      end do
    end do
    call finish_block(contact, memory, block)
  end subroutine points_at_neighbours

  !> The points of one slave segment, with areas as if they were opposed to the master entirely.
  pure subroutine points_on_segment(contact, s, memory, overlaps, block)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: s
    type(contact_state_t), intent(inout) :: memory
    type(overlap_t), intent(inout), contiguous :: overlaps(:) !! room
    type(point_block_t), intent(inout) :: block
    real(wp) :: own(2), other(2), way(2), length
    integer :: ends(2), nodes(2), n, k, q, p

    memory%scratch%has_points(s) = .true.
    ends = contact%slave%segments(:, s)
    call find_overlaps(contact, memory, s, .false., least_part, overlaps, n)
    own = separation(memory%positions(:, ends(2)), memory%positions(:, ends(1)))
    length = sqrt(own(1)*own(1) + own(2)*own(2))
    do k = 1, n
      if (.not. overlaps(k)%share > 0.0_wp) cycle
      if (block%n + n_gauss > n_block) call finish_block(contact, memory, block)
      nodes = memory%n_slave + contact%master%segments(:, overlaps(k)%master)
      other = separation(memory%positions(:, nodes(2)), memory%positions(:, nodes(1)))
      way = separation(memory%positions(:, ends(1)), memory%positions(:, nodes(1)))
      do q = 1, n_gauss
        p = block%n + q
        associate (xi => block%xi(p), part => overlaps(k)%high - overlaps(k)%low)
          xi = overlaps(k)%low + gauss_xi(q)*part
          block%area(p) = 0.5_wp*part*length*overlaps(k)%part
          block%ends(:, p) = ends
          block%nodes(:, p) = nodes
          block%projections%segment(p) = overlaps(k)%master
          block%projections%t(:, p) = other
          block%projections%d(:, p) = way + xi*own
        end associate
      end do
      block%n = block%n + n_gauss
    end do
  end subroutine points_on_segment

  !> Project the points of a block on the master segments of their overlaps, or on whatever is
  !> closest there, and append them; those without a projection have no area.
  pure subroutine finish_block(contact, memory, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(point_block_t), intent(inout) :: block

    block%projections%n = block%n
    call project_block(block%projections)
    if (block%projections%n_ambiguous > 0) call points_at_ambiguous(contact, memory, block)
    call append_points(block, memory%slave_penalty, memory%points)
  end subroutine finish_block

  !> Points that may be nearer to a neighbour of the master segment.
  pure subroutine points_at_ambiguous(contact, memory, block)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(point_block_t), intent(inout) :: block
    type(projection_t) :: projection
    integer :: p

    associate (projections => block%projections, polyline => memory%positions(:, memory%n_slave &
      + 1:))
      call resolve_ambiguous(contact%master, polyline, projections)
      do p = 1, block%n
        if (.not. projections%ambiguous(p) > 0.0_wp) cycle
        if (projections%gap(p) >= 0.0_wp) then
          if (stays_over(contact%master, polyline, projections%t(:, p), projections%d(:, p), &
            projections%segment(p))) cycle
        end if
        associate (ends => block%ends(:, p), xi => block%xi(p))
          projection = nearby_projection(contact%master, polyline, &
            (1.0_wp - xi)*memory%positions(:, ends(1)) &
            + xi*memory%positions(:, ends(2)), projections%segment(p))
        end associate
        block%nodes(:, p) = memory%n_slave + contact%master%segments(:, projection%segment)
        projections%xi(p) = projection%xi
        projections%gap(p) = projection%gap
        projections%normal(:, p) = projection%normal
        if (.not. projection%is_on) block%area(p) = 0.0_wp
      end do
    end associate
  end subroutine points_at_ambiguous

end module points_segmented_mortar_m
