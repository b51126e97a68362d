! SPDX-License-Identifier: MIT
!> Tangents of types 6 and 7: their points; the rest is in contact_nodal_tangent
!> (doc/theory/contact.md, section 9.5).
module tangent_mortar_m
  use contact_nodal_tangent_m, only : varied_list_t, start_list, append_point, add_nodal_tangent
  use contact_local_foot_m, only : local_foot
  use contact_overlap_m, only : cover_t, piece_t, find_cover, first_piece, next_piece
  use contact_placing_m, only : place_on_segment
  use contact_projection_m, only : foot_t
  use contact_state_m, only : contact_state_t
  use contact_variation_m, only : varied_point_t, spot_foot, put_foot, length_between, &
    take_piece, piece_ends, vary_share
  use contacts_m, only : contact_t
  use dual_m, only : dual_t, constant, operator(+), operator(-), operator(*)
  use kinds_m, only : wp
  use points_segmented_mortar_m, only : gauss_xi
  use sparse_m, only : sparse_t
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
    integer :: p

    call start_list(list, contact%slave%n_segment, memory%points%n)
    do p = 1, memory%points%n
      associate (points => memory%points)
        point%nodes(:4) = [points%slave_nodes(:, p), points%master_nodes(:, p)]
        point%slave_xi = constant(points%slave_weights(2, p))
        call put_foot(point, spot_foot(memory%places, point, 3, points%master_weights(2, p), &
          points%gap(p), memory%closed_gap))
        point%area = length_between(memory%places, point%nodes, 1, 2) &
          *vary_share(memory%places, point%nodes, 1, point%normal)
        point%area = (points%area(p)/point%area%value)*point%area
        call append_point(list, contact%slave%outgoing(point%nodes(1)), point)
      end associate
    end do
    call add_nodal_tangent(contact, memory, list, equations, matrix)
  end subroutine add_mortar_tangent

  !> Type 7: the points move with the cuts.
  pure subroutine add_segmented_mortar_tangent(contact, memory, equations, matrix)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in), contiguous :: equations(:, :)
    type(sparse_t), intent(inout) :: matrix
    type(varied_list_t) :: list
    type(cover_t) :: cover
    type(piece_t) :: piece, before
    logical :: is_placed(contact%slave%n_segment)
    integer :: s

    is_placed = .false.
    is_placed(contact%slave%outgoing(memory%points%slave_nodes(1, :memory%points%n))) = .true.
    call start_list(list, contact%slave%n_segment, memory%points%n)
    do s = 1, contact%slave%n_segment
      if (.not. is_placed(s)) cycle
      call find_cover(contact, memory, s, cover)
      call first_piece(contact, memory, cover, piece)
      do while (.not. piece%is_last)
        before = piece
        call next_piece(contact, memory, cover, piece)
        if (piece%high > piece%low .and. piece%share > 0.0_wp) &
          call vary_piece(contact, memory, cover, before, piece, list)
      end do
    end do
    call add_nodal_tangent(contact, memory, list, equations, matrix)
  end subroutine add_segmented_mortar_tangent

  !> Append the points of one piece that counts (share above 0).
  pure subroutine vary_piece(contact, memory, cover, before, piece, list)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t), intent(in) :: before, piece
    type(varied_list_t), intent(inout) :: list
    type(varied_point_t) :: point
    type(dual_t) :: xi(2), share, length
    type(foot_t) :: foot
    integer :: q

    call take_piece(memory, cover, before, piece, point)
    xi = piece_ends(memory%places, point%nodes, piece)
    length = (xi(2) - xi(1))*length_between(memory%places, point%nodes, 1, 2)
    do q = 1, size(gauss_xi)
      foot = local_foot(contact, memory, place_on_segment(memory%places, cover%ends, &
        piece%low + gauss_xi(q)*(piece%high - piece%low)), piece%segment)
      if (.not. foot%is_on) cycle
      point%nodes(3:4) = memory%n_slave + contact%master%segments(:, foot%segment)
      point%slave_xi = xi(1) + gauss_xi(q)*(xi(2) - xi(1))
      call put_foot(point, spot_foot(memory%places, point, 3, foot%xi, foot%gap, &
        memory%closed_gap))
      share = vary_share(memory%places, point%nodes, 1, point%normal)
      if (.not. share%value > 0.0_wp) cycle
      point%area = 0.5_wp*share*length
      call append_point(list, cover%segment, point)
    end do
  end subroutine vary_piece

end module tangent_mortar_m
