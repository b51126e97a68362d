! SPDX-License-Identifier: MIT
!> Tangent of type 5: half of each overlap is the area of a point of its own at either of its
!> ends, so that each depends on few nodes (doc/theory/contact.md, section
!> 9.4).
module tangent_nts_mar_m
  use assembly_m, only : add_pressed_point
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*), operator(/), sqrt
  use foot_m, only : round_off
  use kinds_m, only : wp
  use overlap_m, only : overlap_t
  use overlaps_m, only : find_overlaps, n_most_overlaps
  use place_nts_mar_m, only : is_tip
  use sparse_m, only : sparse_t
  use tangent_nts_m, only : vary_node, vary_competence
  use variation_m, only : varied_point_t, varied_foot_t, apart, length_between, project, &
    spot_foot, put_foot, take_overlap, overlap_ends, vary_share, vary_end_radius
  implicit none
  private
  public :: add_nts_mar_tangent

contains

  !> All overlaps; then the nodes at a tip, which have none.
  pure subroutine add_nts_mar_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :) !! (2, n_node) by local number, 0 = none
    type(sparse_t), intent(inout) :: matrix
    type(varied_point_t) :: point
    logical :: has_area(memory%n_slave)
    integer :: s, p

    has_area = .false.
    do s = 1, contact%slave%n_segment
      if (memory%segment_status(s) == is_touching .or. any(memory%slave_tracking%status( &
        contact%slave%segments(:, s)) == is_touching)) &
        call add_segment(contact, memory, s, equations, matrix, has_area)
    end do
    do p = 1, memory%slave_tracking%n_touching
      if (has_area(memory%slave_tracking%touching(p))) cycle
      if (.not. is_tip(contact%slave, memory, memory%slave_tracking%touching(p))) cycle
      if (.not. memory%points%gap(p) < memory%closed_gap) cycle
      point = vary_node(memory, p)
      call vary_competence(contact%slave, 0, contact%is_round, memory, point)
      call add_pressed_point(contact%friction, memory, point%nodes(1), point, &
        memory%slave_penalty, equations, matrix)
    end do
  end subroutine add_nts_mar_tangent

  !> The overlaps of one slave segment, as the placement divides it.
  pure subroutine add_segment(contact, memory, s, equations, matrix, has_area)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    logical, intent(inout) :: has_area(:)
    type(overlap_t) :: overlaps(n_most_overlaps(memory, s))
    type(varied_point_t) :: point
    type(dual_t) :: halves(2)
    integer :: n, k

    call find_overlaps(contact, memory, s, contact%strict, round_off, overlaps, n)
    do k = 1, n
      if (.not. overlaps(k)%high > overlaps(k)%low) cycle
      if (.not. contact%strict .and. .not. overlaps(k)%share > 0.0_wp) cycle
      call vary_halves(contact, memory, s, overlaps(:n), k, point, halves)
      call add_both_ends(contact, memory, s, overlaps(k), point, halves, equations, matrix, &
        has_area)
    end do
  end subroutine add_segment

  !> Halves of an overlap as areas: slave segment in slots 1, 2, cuts in slots 5, 6, and the master
  !> segment in slots 7, 8 where the share that faces it is not all of the overlap.
  pure subroutine vary_halves(contact, memory, s, overlaps, k, point, halves)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s   !! slave segment
    type(overlap_t), intent(in) :: overlaps(:)
    integer, intent(in) :: k   !! overlap
    type(varied_point_t), intent(out) :: point
    type(dual_t), intent(out) :: halves(2) !! what its start gets, and its end
    type(dual_t) :: xi(2), t(2), length, half
    logical :: is_whole

    is_whole = contact%strict .or. overlaps(k)%share >= 1.0_wp
    call take_overlap(memory, contact%slave%segments(:, s), overlaps, k, is_whole, point)
    xi = overlap_ends(memory%places, point%nodes, [overlaps(k)%low, overlaps(k)%high])
    half = (0.5_wp*overlaps(k)%part)*((xi(2) - xi(1))*length_between(memory%places, point%nodes, &
      1, 2))
    if (.not. is_whole) then
      point%nodes(7:8) = memory%n_slave + contact%master%segments(:, overlaps(k)%master)
      t = apart(memory%places, point%nodes, 8, 7)
      length = sqrt(t(1)*t(1) + t(2)*t(2))
      half = half*vary_share(memory%places, point%nodes, 1, [t(2)/length, -(t(1)/length)])
    end if
    halves = half
    if (.not. contact%is_round) return
    halves(1) = half*vary_end_radius(memory%places, point%nodes, 1, 2, xi(1), xi(2))
    halves(2) = half*vary_end_radius(memory%places, point%nodes, 1, 2, xi(2), xi(1))
  end subroutine vary_halves

  !> Give its half to whatever stands at either end of an overlap.
  pure subroutine add_both_ends(contact, memory, s, overlap, origin, halves, equations, matrix, &
      has_area)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s   !! slave segment
    type(overlap_t), intent(in) :: overlap
    type(varied_point_t), intent(in) :: origin
    type(dual_t), intent(in) :: halves(2)
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    logical, intent(inout) :: has_area(:)
    type(varied_point_t) :: point
    integer :: i, cuts(2), ends(2), place

    cuts = [overlap%first, overlap%last]
    ends = contact%slave%segments(:, s)
    point = origin
    do i = 1, 2
      point%area = halves(i)
      if (cuts(i) > 0) then
        if (memory%segment_status(s) /= is_touching) cycle
        place = memory%n_slave + cuts(i)
        call stand_at_master_node(memory, place, point)
      else
        if (memory%slave_tracking%status(ends(i)) /= is_touching) cycle
        place = ends(i)
        has_area(place) = .true.
        call stand_at_end(contact, memory, place, i, point)
      end if
      if (point%gap%value < memory%closed_gap) &
        call add_pressed_point(contact%friction, memory, place, point, memory%slave_penalty, &
        equations, matrix)
    end do
  end subroutine add_both_ends

  !> Let the point stand at a master node behind the slave segment, with the normal of that.
  pure subroutine stand_at_master_node(memory, node, point)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node !! local number
    type(varied_point_t), intent(inout) :: point
    type(varied_foot_t) :: foot

    point%nodes(3:4) = [node, 0]
    foot = project(apart(memory%places, point%nodes, 3, 1), &
      apart(memory%places, point%nodes, 2, 1))
    point%slave_xi = foot%xi
    point%master_xi = constant(0.0_wp)
    point%gap = foot%gap
    point%normal = -foot%normal
  end subroutine stand_at_master_node

  !> Let the point stand at a node that is in contact, the k-th end of the slave segment.
  pure subroutine stand_at_end(contact, memory, node, k, point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node
    integer, intent(in) :: k
    type(varied_point_t), intent(inout) :: point

    point%slave_xi = constant(k - 1.0_wp)
    associate (tracking => memory%slave_tracking)
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, tracking%segment(node))
      call put_foot(point, spot_foot(memory%places, point, 3, tracking%xi(node), &
        tracking%gap(node), memory%closed_gap))
    end associate
  end subroutine stand_at_end

end module tangent_nts_mar_m
