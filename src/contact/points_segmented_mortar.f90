! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each piece of slave segment that faces one master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module points_segmented_mortar_m
  use contact_admission_m, only : all_asleep, is_asleep, judge_segment, note_next_wake
  use contact_overlap_m, only : cover_t, piece_t, find_cover, first_piece, next_piece, &
    local_foot, facing_share
  use contact_placing_m, only : add_segment_point, place_on_segment
  use contact_projection_m, only : foot_t
  use contact_state_m, only : contact_state_t, make_room
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, sight_normal
  use kinds_m, only : wp
  implicit none
  private
  public :: place_segmented_mortar, gauss_xi

  !> Gauss points of a piece on 0 .. 1; both have weight one half. They integrate the product of shape
  !> functions and a linear gap exactly up to the curvature of the chain.
  real(wp), parameter :: gauss_xi(2) = [0.5_wp - sqrt(1.0_wp/12.0_wp), &
    0.5_wp + sqrt(1.0_wp/12.0_wp)]

contains

  !> Place the points: of all segments that may touch, then of their neighbours that can not, since these have a
  !> part in the averaged gaps of common nodes.
  pure subroutine place_segmented_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(cover_t) :: cover
    integer :: s

    if (all_asleep(memory)) return
    do s = 1, contact%slave%n_segment
      memory%cover%is_placed(s) = .not. is_asleep(memory, s, contact%slave%segments(:, s))
      if (memory%cover%is_placed(s)) call place_segment(contact, memory, s)
    end do
    call note_next_wake(memory)
    if (.not. any(memory%mark > 0)) then
      memory%points%n = 0
      return
    end if
    do s = 1, contact%slave%n_segment
      if (memory%cover%is_placed(s)) cycle
      if (memory%mark(contact%slave%segments(1, s)) == 0 &
        .and. memory%mark(contact%slave%segments(2, s)) == 0) cycle
      call find_cover(contact, memory, s, cover)
      call add_pieces(contact, memory, cover)
    end do
    memory%mark = 0
  end subroutine place_segmented_mortar

  !> The points of a segment that may touch; marks its nodes if it does.
  pure subroutine place_segment(contact, memory, s)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    type(cover_t) :: cover
    real(wp) :: deepest
    logical :: counts
    integer :: n_before

    n_before = memory%points%n
    call find_cover(contact, memory, s, cover)
    call add_pieces(contact, memory, cover)
    deepest = minval(memory%points%gap(n_before + 1:memory%points%n))
    call judge_segment(contact, memory, s, cover%ends, deepest, counts)
    if (.not. counts) then
      memory%points%n = n_before
    else if (deepest < memory%closed_gap) then
      memory%mark(cover%ends(1)) = 1
      memory%mark(cover%ends(2)) = 1
    end if
  end subroutine place_segment

  !> The points of one segment.
  pure subroutine add_pieces(contact, memory, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t) :: piece
    type(sight_t) :: sight
    type(foot_t) :: foot
    real(wp) :: xi, share, place(4)
    integer :: q

    call first_piece(contact, memory, cover, piece)
    do while (.not. piece%is_last)
      call next_piece(contact, memory, cover, piece)
      if (.not. (piece%high > piece%low .and. piece%share > 0.0_wp)) cycle
      call make_room(memory%points, size(gauss_xi))
      do q = 1, size(gauss_xi)
        xi = piece%low + gauss_xi(q)*(piece%high - piece%low)
        place = place_on_segment(memory%places, cover%ends, xi)
        foot = local_foot(contact, memory, place, piece%segment)
        sight = sight_of_segment(place, memory%places(:, cover%ends(1)), &
          memory%places(:, cover%ends(2)))
        if (.not. foot%is_on) cycle
        share = facing_share(dot_product(sight_normal(sight), foot%normal))
        if (.not. share > 0.0_wp) cycle
        call add_segment_point(contact%master, memory%n_slave, cover%ends, xi, foot, &
          memory%points)
        associate (p => memory%points%n)
          memory%points%area(p) = 0.5_wp*share*(piece%high - piece%low)*sqrt(sight%square)
          memory%points%stiffness(p) = memory%slave_penalty
        end associate
      end do
    end do
  end subroutine add_pieces

end module points_segmented_mortar_m
