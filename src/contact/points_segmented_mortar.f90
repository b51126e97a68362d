! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each piece of slave segment that faces one master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module points_segmented_mortar_m
  use contact_admission_m, only : all_asleep, pass_asleep, judge_segment, note_next_wake
  use contact_overlap_m, only : cover_t, find_cover
  use contact_piece_list_m, only : look_at_segments, put_points, put_pieces
  use contact_piece_points_m, only : plain_points_t, find_points, look_over
  use contact_pieces_m, only : gauss_xi, add_pieces
  use contact_plain_cover_m, only : plain_cover_t, clear_list, list_touching, list_segment, &
    list_other, cut_segments, note_plain_contact
  use contact_placing_m, only : forget_other_stiffness
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: place_segmented_mortar, gauss_xi

contains

  !> Place the points: of all segments that may touch, then of their neighbours that can not, since
  !> these have a part in the averaged gaps of common nodes.
  pure subroutine place_segmented_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t) :: cover
    integer :: n_edge !! segments noted in memory%mark: in contact, beside others that may sleep

    if (all_asleep(memory)) return
    call forget_other_stiffness(memory%slave_penalty, memory%points)
    call clear_list(cover)
    n_edge = 0
    call place_awake(contact, memory, n_edge, cover)
    call note_next_wake(memory)
    if (any(memory%points%gap(:memory%points%n) < memory%closed_gap)) then
      call place_neighbours(contact, memory, n_edge, cover)
    else
      memory%points%n = 0
    end if
    memory%mark(:n_edge) = 0
  end subroutine place_segmented_mortar

  !> All segments that may touch.
  pure subroutine place_awake(contact, memory, n_edge, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(inout) :: n_edge
    type(plain_cover_t), intent(inout) :: cover
    integer :: s, first

    memory%cover%is_placed = .true.
    s = 1
    do while (s <= contact%slave%n_segment)
      call list_touching(contact, memory, s, cover)
      if (cover%is_full) call place_list(contact, memory, .true., n_edge, cover)
      first = s
      call pass_asleep(memory, contact%slave%segments, s)
      memory%cover%is_placed(first:s - 1) = .false.
      if (s > first .or. s > contact%slave%n_segment) cycle
      call take_segment(contact, memory, s, .true., n_edge, cover)
      s = s + 1
    end do
    call place_list(contact, memory, .true., n_edge, cover)
  end subroutine place_awake

  !> Neighbours of segments in contact that have not been placed. A segment with both ends in
  !> contact has none.
  pure subroutine place_neighbours(contact, memory, n_edge, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(inout) :: n_edge
    type(plain_cover_t), intent(inout) :: cover
    integer :: neighbours(2), i, k

    do i = 1, n_edge
      associate (s => memory%mark(i))
        neighbours = [contact%slave%previous(s), contact%slave%next(s)]
      end associate
      do k = 1, 2
        if (neighbours(k) == 0) cycle
        if (memory%cover%is_placed(neighbours(k))) cycle
        memory%cover%is_placed(neighbours(k)) = .true.
        call take_segment(contact, memory, neighbours(k), .false., n_edge, cover)
      end do
    end do
    call place_list(contact, memory, .false., n_edge, cover)
  end subroutine place_neighbours

  !> Put a segment on the list, and place its points with the list when that is full.
  pure subroutine take_segment(contact, memory, s, may_touch, n_edge, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: may_touch
    integer, intent(inout) :: n_edge
    type(plain_cover_t), intent(inout) :: cover
    logical :: is_listed

    call list_segment(contact, memory, s, .true., cover, is_listed)
    if (.not. is_listed) call list_other(s, cover)
    if (cover%is_full) call place_list(contact, memory, may_touch, n_edge, cover)
  end subroutine take_segment

  !> Place the points of the segments on a list, and clear it. Those of segments that may touch are
  !> judged by them.
  pure subroutine place_list(contact, memory, may_touch, n_edge, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    logical, intent(in) :: may_touch
    integer, intent(inout) :: n_edge
    type(plain_cover_t), intent(inout) :: cover
    type(plain_points_t) :: found
    integer :: i, first, n_before
    logical :: counts

    call cut_segments(contact, memory, cover)
    call find_points(cover%n_piece, cover%own, cover%other, cover%way, cover%low, cover%high, &
      cover%length, found)
    call look_over(contact, memory, cover, found)
    call look_at_segments(cover, memory, found)
    first = 1
    do i = 1, cover%n_segment
      if (found%stays(i)) cycle
      if (.not. found%is_plain(i)) then
        call put_points(memory, cover, found, first, cover%last(i - 1))
        first = cover%last(i) + 1
        n_before = memory%points%n
        call place_segment(contact, memory, cover, found, i)
        if (may_touch) found%deepest(i) = minval(memory%points%gap(n_before + 1:memory%points%n))
      end if
      if (.not. may_touch) cycle
      call judge_points(contact, memory, cover%slave(i), cover%touches(i), found%deepest(i), &
        n_edge, counts)
      if (counts) cycle
      if (found%is_plain(i)) then
        call put_points(memory, cover, found, first, cover%last(i - 1))
        first = cover%last(i) + 1
      else
        memory%points%n = n_before
      end if
    end do
    call put_points(memory, cover, found, first, cover%n_piece)
    call clear_list(cover)
  end subroutine place_list

  !> The points of a segment on the list that are not all where the list has them.
  pure subroutine place_segment(contact, memory, list, found, i)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: list
    type(plain_points_t), intent(in) :: found
    integer, intent(in) :: i !! of the list
    type(cover_t) :: cover

    if (list%is_plain(i)) then
      call put_pieces(contact, memory, list, found, i)
    else
      call find_cover(contact, memory, list%slave(i), cover)
      call add_pieces(contact, memory, cover)
    end if
  end subroutine place_segment

  !> Whether the points of a segment count. Where neither they nor an end of it is in contact they
  !> are left to the second round, like those of a segment that sleeps: so sums over the points of a
  !> node do not depend on who sleeps.
  pure subroutine judge_points(contact, memory, s, touches, deepest, n_edge, counts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: touches  !! both ends are in contact
    real(wp), intent(in) :: deepest !! smallest gap of its points, m
    integer, intent(inout) :: n_edge
    logical, intent(out) :: counts

    counts = .true.
    if (touches) then
      call note_plain_contact(deepest < memory%closed_gap, memory%travel, memory%cover%status(s), &
        memory%cover%wake(s))
      return
    end if
    associate (ends => contact%slave%segments(:, s))
      call judge_segment(contact, memory, s, ends, deepest, counts)
      if (.not. counts) return
      if (deepest < memory%closed_gap) then
        n_edge = n_edge + 1
        memory%mark(n_edge) = s
      else
        counts = any(memory%slave_tracking%status(ends) == is_touching)
        memory%cover%is_placed(s) = counts
      end if
    end associate
  end subroutine judge_points

end module points_segmented_mortar_m
