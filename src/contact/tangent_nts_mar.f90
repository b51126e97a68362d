! SPDX-License-Identifier: MIT
!> Tangent of type 5: half of each piece of slave segment is the area of a point of its own at
!> either of the piece's ends, so that each depends on few nodes (doc/theory/contact.md, section
!> 9.4).
module tangent_nts_mar_m
  use contact_assembly_m, only : add_spring_point
  use contact_overlap_m, only : cover_t, piece_t, find_cover, first_piece, next_piece
  use contact_state_m, only : contact_state_t, is_touching
  use contact_variation_m, only : varied_point_t, varied_foot_t, apart, length_between, project, &
    spot_foot, put_foot, take_piece, piece_ends, vary_share
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*), operator(/), sqrt
  use kinds_m, only : wp
  use points_nts_mar_m, only : is_tip
  use sparse_m, only : sparse_t
  use tangent_nts_m, only : vary_node, vary_competence
  implicit none
  private
  public :: add_nts_mar_tangent

contains

  !> All pieces; then the nodes at a tip, which have none.
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
      if (memory%cover%status(s) == is_touching .or. any(memory%slave_tracking%status( &
        contact%slave%segments(:, s)) == is_touching)) &
        call add_segment(contact, memory, s, equations, matrix, has_area)
    end do
    do p = 1, memory%slave_tracking%n_touching
      if (has_area(memory%slave_tracking%touching(p))) cycle
      if (.not. is_tip(contact%slave, memory, memory%slave_tracking%touching(p))) cycle
      if (.not. memory%points%gap(p) < memory%closed_gap) cycle
      point = vary_node(memory, p)
      call vary_competence(contact%slave, 0, memory, point)
      call add_spring_point(point, memory%slave_penalty, equations, matrix)
    end do
  end subroutine add_nts_mar_tangent

  !> The pieces of one slave segment, as the placement divides it.
  pure subroutine add_segment(contact, memory, s, equations, matrix, has_area)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    logical, intent(inout) :: has_area(:)
    type(varied_point_t) :: point
    type(cover_t) :: cover
    type(piece_t) :: piece, before

    call find_cover(contact, memory, s, cover)
    call first_piece(contact, memory, cover, piece)
    if (contact%strict .and. (piece%is_last .or. .not. all(cover%feet%is_on))) then
      piece = piece_t(high=1.0_wp, is_last=.true.)
      point%nodes(1:2) = cover%ends
      point%area = 0.5_wp*length_between(memory%places, point%nodes, 1, 2)
      call add_both_ends(contact, memory, cover, piece, point, equations, matrix, has_area)
    end if
    do while (.not. piece%is_last)
      before = piece
      call next_piece(contact, memory, cover, piece)
      if (.not. (piece%high > piece%low .and. (contact%strict .or. piece%share > 0.0_wp))) cycle
      point = vary_half(contact, memory, cover, before, piece)
      call add_both_ends(contact, memory, cover, piece, point, equations, matrix, has_area)
    end do
  end subroutine add_segment

  !> Half of a piece as area: slave segment in slots 1, 2, cuts in slots 5, 6, and the master
  !> segment in slots 7, 8 where the share that faces it is not all of the piece.
  pure function vary_half(contact, memory, cover, before, piece) result(point)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t), intent(in) :: before, piece
    type(varied_point_t) :: point
    type(dual_t) :: xi(2), t(2), length

    call take_piece(memory, cover, before, piece, point)
    xi = piece_ends(memory%places, point%nodes, piece)
    point%area = 0.5_wp*((xi(2) - xi(1))*length_between(memory%places, point%nodes, 1, 2))
    if (contact%strict .or. piece%share >= 1.0_wp) return
    point%nodes(7:8) = memory%n_slave + contact%master%segments(:, piece%segment)
    t = apart(memory%places, point%nodes, 8, 7)
    length = sqrt(t(1)*t(1) + t(2)*t(2))
    point%area = point%area*vary_share(memory%places, point%nodes, 1, [t(2)/length, -(t(1)/length)])
  end function vary_half

  !> Give the area of `origin` to whatever stands at either end of a piece.
  pure subroutine add_both_ends(contact, memory, cover, piece, origin, equations, matrix, has_area)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t), intent(in) :: piece
    type(varied_point_t), intent(in) :: origin
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    logical, intent(inout) :: has_area(:)
    type(varied_point_t) :: point
    integer :: k, cuts(2)

    cuts = [piece%low_node, piece%high_node]
    point = origin
    do k = 1, 2
      if (cuts(k) > 0) then
        if (memory%cover%status(cover%segment) /= is_touching) cycle
        call stand_at_master_node(memory, memory%n_slave + cuts(k), point)
      else
        if (memory%slave_tracking%status(cover%ends(k)) /= is_touching) cycle
        has_area(cover%ends(k)) = .true.
        call stand_at_end(contact, memory, cover%ends(k), k, point)
      end if
      if (point%gap%value < memory%closed_gap) &
        call add_spring_point(point, memory%slave_penalty, equations, matrix)
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
