! SPDX-License-Identifier: MIT
!> Tangents of types 6 and 7: their points; the rest is in nodal_tangent
!> (doc/theory/contact.md, section 9.5).
module tangent_mortar_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*)
  use entry_offset_m, only : has_offsets, add_offsets
  use foot_m, only : foot_t, near_foot
  use kinds_m, only : wp
  use nodal_grip_m, only : add_nodal_grip
  use nodal_tangent_m, only : varied_list_t, start_list, append_point, add_nodal_tangent, &
    nodal_share
  use overlap_m, only : overlap_t
  use overlaps_m, only : find_overlaps, n_most_overlaps
  use place_segmented_mortar_m, only : gauss_xi, least_cut
  use sparse_m, only : sparse_t
  use tips_m, only : has_folds
  use variation_m, only : varied_point_t, between, spot_foot, put_foot, length_between, take_overlap, &
    overlap_ends, vary_share, vary_radius
  implicit none
  private
  public :: add_mortar_tangent, add_segmented_mortar_tangent

contains

  !> Type 6: the points stand at fixed places of their segments.
  pure subroutine add_mortar_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(varied_list_t) :: list
    type(varied_point_t) :: point
    real(wp) :: offsets(memory%points%n)
    integer :: p

    offsets = 0.0_wp
    if (has_offsets(memory)) call add_offsets(memory, offsets)
    call start_list(list, contact%slave%n_segment, memory%points%n)
    do p = 1, memory%points%n
      associate (points => memory%points)
        point%nodes(:4) = [points%slave_nodes(:, p), points%master_nodes(:, p)]
        point%slave_xi = constant(points%slave_weights(2, p))
        call put_foot(point, spot_foot(memory%places, point, 3, points%master_weights(2, p), &
          points%gap(p), memory%closed_gap))
        point%left = constant(offsets(p))
        point%area = length_between(memory%places, point%nodes, 1, 2) &
          *vary_share(memory%places, point%nodes, 1, point%normal)
        if (contact%is_round) point%area = point%area &
          *vary_radius(memory%places, point%nodes, 1, 2, point%slave_xi)
        point%area = (points%area(p)/point%area%value)*point%area
        call append_point(list, contact%slave%outgoing(point%nodes(1)), point)
      end associate
    end do
    call add_nodal_tangent(contact, memory, list, equations, matrix)
    if (memory%has%friction) &
      call add_nodal_grip(contact, memory, list, equations, matrix)
  end subroutine add_mortar_tangent

  !> Type 7: the points move with the cuts.
  pure subroutine add_segmented_mortar_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(varied_list_t) :: list
    logical :: is_placed(contact%slave%n_segment)
    integer :: s

    is_placed = .false.
    is_placed(contact%slave%outgoing(memory%points%slave_nodes(1, :memory%points%n))) = .true.
    call start_list(list, contact%slave%n_segment, memory%points%n)
    do s = 1, contact%slave%n_segment
      if (.not. is_placed(s)) cycle
      call vary_segment(contact, memory, s, list)
      if (has_folds(contact)) call vary_ends(memory, contact%slave%segments(:, s), s, list)
    end do
    call add_nodal_tangent(contact, memory, list, equations, matrix)
    if (memory%has%friction) &
      call add_nodal_grip(contact, memory, list, equations, matrix)
  end subroutine add_segmented_mortar_tangent

  !> Append the points of the overlaps of a slave segment that count (share above 0).
  pure subroutine vary_segment(contact, memory, s, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s !! slave segment
    type(varied_list_t), intent(inout) :: list
    type(overlap_t) :: overlaps(n_most_overlaps(memory, s))
    integer :: n, k

    call find_overlaps(contact, memory, s, .false., least_cut, overlaps, n)
    do k = 1, n
      if (overlaps(k)%share > 0.0_wp) call vary_overlap(contact, memory, overlaps(:n), s, k, list)
    end do
  end subroutine vary_segment

  !> Append the points of one overlap.
  pure subroutine vary_overlap(contact, memory, overlaps, s, k, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(overlap_t), intent(in) :: overlaps(:)
    integer, intent(in) :: s, k !! slave segment, overlap
    type(varied_list_t), intent(inout) :: list
    type(varied_point_t) :: point
    type(dual_t) :: xi(2), share, length
    type(foot_t) :: foot
    integer :: ends(2), q

    ends = contact%slave%segments(:, s)
    call take_overlap(memory, ends, overlaps, k, .true., point)
    xi = overlap_ends(memory%places, point%nodes, [overlaps(k)%low, overlaps(k)%high])
    length = (xi(2) - xi(1))*length_between(memory%places, point%nodes, 1, 2)
    do q = 1, size(gauss_xi)
      associate (at => overlaps(k)%low + gauss_xi(q)*(overlaps(k)%high - overlaps(k)%low))
        foot = near_foot(contact%master, memory%places(:, memory%n_slave + 1:), &
          (1.0_wp - at)*memory%places(:, ends(1)) &
          + at*memory%places(:, ends(2)), overlaps(k)%master)
      end associate
      if (.not. foot%is_on) cycle
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, foot%segment)
      point%slave_xi = xi(1) + gauss_xi(q)*(xi(2) - xi(1))
      call put_foot(point, spot_foot(memory%places, point, 3, foot%xi, foot%gap, &
        memory%closed_gap))
      if (has_offsets(memory)) point%left = between(memory%slave_tracking%offset(ends), &
        point%slave_xi)
      share = vary_share(memory%places, point%nodes, 1, point%normal)
      if (.not. share%value > 0.0_wp) cycle
      point%area = (0.5_wp*overlaps(k)%part)*(share*length)
      if (contact%is_round) point%area = point%area &
        *vary_radius(memory%places, point%nodes, 1, 2, point%slave_xi)
      call append_point(list, s, point)
    end do
  end subroutine vary_overlap

  !> The points at the nodes of a segment at the tip of a fold, one for each point that gives way
  !> to them. How much does is held, and so is what the area of such a point owes to its own foot.
  pure subroutine vary_ends(memory, ends, s, list)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2), s !! nodes of the segment, its number
    type(varied_list_t), intent(inout) :: list
    type(varied_point_t) :: point
    real(wp) :: part(2), content
    integer :: at_end(2), first, last, p, k

    at_end = points_at_ends(memory, ends)
    if (maxval(at_end) == 0) return
    first = list%first(s)
    last = list%last(s)
    part = 0.0_wp
    do k = 1, 2
      content = 0.0_wp
      do p = first, last
        point = list%points(p)
        associate (share => nodal_share(point, k))
          content = content + share%value
        end associate
      end do
      if (at_end(k) > 0) part(k) = memory%points%area(at_end(k))/content
    end do
    do p = first, last
      do k = 1, 2
        if (at_end(k) == 0) cycle
        point = list%points(p)
        point%area = part(k)*nodal_share(point, k)
        if (any(point%nodes(3:4) /= memory%points%master_nodes(:, at_end(k)))) &
          point%area%slope(5:8) = 0.0_wp
        point%nodes(3:4) = memory%points%master_nodes(:, at_end(k))
        point%slave_xi = constant(real(k - 1, wp))
        call put_foot(point, spot_foot(memory%places, point, 3, &
          memory%points%master_weights(2, at_end(k)), memory%points%gap(at_end(k)), &
          memory%closed_gap))
        if (has_offsets(memory)) &
          point%left = constant(memory%slave_tracking%offset(ends(k)))
        call append_point(list, s, point)
      end do
      point = list%points(p)
      list%points(p)%area = point%area - (part(1)*nodal_share(point, 1) &
        + part(2)*nodal_share(point, 2))
    end do
  end subroutine vary_ends

  !> Points of the list at the nodes of a segment, 0: none.
  pure function points_at_ends(memory, ends) result(at_end)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer :: at_end(2)
    integer :: p, k

    at_end = 0
    do p = 1, memory%points%n
      if (any(memory%points%slave_nodes(:, p) /= ends)) cycle
      do k = 1, 2
        if (memory%points%slave_weights(k, p) >= 1.0_wp) at_end(k) = p
      end do
    end do
  end function points_at_ends

end module tangent_mortar_m
