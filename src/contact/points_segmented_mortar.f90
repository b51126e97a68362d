! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each piece of slave segment that faces one master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module points_segmented_mortar_m
  use contact_admission_m, only : all_asleep, is_asleep, judge_segment, note_next_wake
  use contact_overlap_m, only : cover_t, piece_t, find_cover, first_piece, next_piece, &
    local_foot, facing_share
  use contact_plain_cover_m, only : plain_cover_t, find_plain_cover, note_plain_contact
  use contact_placing_m, only : add_segment_point, add_plain_point, place_on_segment
  use contact_plain_foot_m, only : is_plainly_behind, is_plainly_over
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
    logical :: touches
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
      call cover_segment(contact, memory, s, touches)
    end do
    memory%mark = 0
  end subroutine place_segmented_mortar

  !> The points of a segment that may touch; marks its nodes if it does.
  pure subroutine place_segment(contact, memory, s)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    real(wp) :: deepest
    logical :: counts, touches
    integer :: n_before, ends(2)

    n_before = memory%points%n
    ends = contact%slave%segments(:, s)
    call cover_segment(contact, memory, s, touches)
    deepest = minval(memory%points%gap(n_before + 1:memory%points%n))
    if (touches) then
      counts = .true.
      call note_plain_contact(memory, s, deepest < memory%closed_gap)
    else
      call judge_segment(contact, memory, s, ends, deepest, counts)
    end if
    if (.not. counts) then
      memory%points%n = n_before
    else if (deepest < memory%closed_gap) then
      memory%mark(ends(1)) = 1
      memory%mark(ends(2)) = 1
    end if
  end subroutine place_segment

  !> Cut a segment and place its points.
  pure subroutine cover_segment(contact, memory, s, touches)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(out) :: touches !! the common case, and both ends are in contact
    type(plain_cover_t) :: plain
    type(cover_t) :: cover

    call find_plain_cover(contact, memory, s, plain)
    touches = plain%n_piece > 0 .and. plain%touches
    if (plain%n_piece > 0) then
      call add_plain_pieces(contact, memory, plain)
    else
      call find_cover(contact, memory, s, cover)
      call add_pieces(contact, memory, cover)
    end if
  end subroutine cover_segment

  !> The points of one segment.
  pure subroutine add_pieces(contact, memory, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(cover_t), intent(in) :: cover
    type(piece_t) :: piece
    type(sight_t) :: slave
    integer :: q

    if (.not. cover%exists) return
    slave = sight_of_segment(memory%places(:, cover%ends(2)), memory%places(:, cover%ends(1)), &
      memory%places(:, cover%ends(2)))
    call first_piece(contact, memory, cover, piece)
    do while (.not. piece%is_last)
      call next_piece(contact, memory, cover, piece)
      if (.not. (piece%high > piece%low .and. piece%share > 0.0_wp)) cycle
      call make_room(memory%points, size(gauss_xi))
      do q = 1, size(gauss_xi)
        call add_gauss_point(contact, memory, cover%ends, slave, piece%segment, &
          piece%low + gauss_xi(q)*(piece%high - piece%low), 0.5_wp*(piece%high - piece%low))
      end do
    end do
  end subroutine add_pieces

  !> One Gauss point on a piece, over whatever master segment is closest there.
  pure subroutine add_gauss_point(contact, memory, ends, slave, segment, xi, weight)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: ends(2)  !! nodes of the slave segment
    type(sight_t), intent(in) :: slave !! some place seen from it
    integer, intent(in) :: segment  !! master segment of the piece
    real(wp), intent(in) :: xi      !! place on the slave segment
    real(wp), intent(in) :: weight  !! part of its length
    type(foot_t) :: foot
    real(wp) :: share

    foot = local_foot(contact, memory, place_on_segment(memory%places, ends, xi), segment)
    if (.not. foot%is_on) return
    share = facing_share(dot_product(sight_normal(slave), foot%normal))
    if (.not. share > 0.0_wp) return
    call add_segment_point(contact%master, memory%n_slave, ends, xi, foot, memory%points)
    associate (p => memory%points%n)
      memory%points%area(p) = weight*share*sqrt(slave%square)
      memory%points%stiffness(p) = memory%slave_penalty
    end associate
  end subroutine add_gauss_point

  !> The common case of `add_pieces`: a Gauss point not nearer to a neighbour of the master segment of its piece than to
  !> that has its foot there (as contact_projection has it); others are left to `add_gauss_point`. Two roots and
  !> two quotients a piece instead of ten.
  pure subroutine add_plain_pieces(contact, memory, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    type(sight_t) :: sight, slave
    real(wp) :: length, master_length, weight, xi, normal(2)
    real(wp), dimension(4) :: one, two, a, b !! places of the nodes, in registers
    integer :: k, q, nodes(2)
    logical :: is_plain

    length = sqrt(cover%square)
    one = memory%places(:, cover%ends(1))
    two = memory%places(:, cover%ends(2))
    call make_room(memory%points, cover%n_piece*size(gauss_xi))
    do k = 1, cover%n_piece
      nodes = contact%master%segments(:, cover%segments(k)) + memory%n_slave
      a = memory%places(:, nodes(1))
      b = memory%places(:, nodes(2))
      weight = 0.5_wp*(cover%cuts(k) - cover%cuts(k - 1))
      do q = 1, size(gauss_xi)
        xi = cover%cuts(k - 1) + gauss_xi(q)*(cover%cuts(k) - cover%cuts(k - 1))
        sight = sight_of_segment((1.0_wp - xi)*one + xi*two, a, b)
        if (q == 1) then
          master_length = sqrt(sight%square)
          normal = [sight%t(2), -sight%t(1)]/master_length
        end if
        is_plain = is_plainly_behind(sight)
        if (.not. is_plain) is_plain = is_plainly_over(contact%master, &
          memory%places(:, memory%n_slave + 1:), sight, cover%segments(k))
        if (is_plain) then
          call add_plain_point(cover%ends, xi, nodes, sight%along/sight%square, normal, &
            sight%across/master_length, memory%points)
          memory%points%area(memory%points%n) = weight*length
          memory%points%stiffness(memory%points%n) = memory%slave_penalty
        else
          slave = sight_of_segment(two, one, two)
          call add_gauss_point(contact, memory, cover%ends, slave, cover%segments(k), xi, weight)
        end if
      end do
    end do
  end subroutine add_plain_pieces

end module points_segmented_mortar_m
