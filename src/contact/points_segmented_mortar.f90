! SPDX-License-Identifier: MIT
!> Type 7, segmented mortar: two Gauss points on each piece of slave segment that faces one master
!> segment, pressure from the slave nodes (doc/theory/contact.md, section 5.7).
module points_segmented_mortar_m
  use contact_admission_m, only : all_asleep, is_asleep, judge_segment, note_next_wake
  use contact_overlap_m, only : cover_t, find_cover
  use contact_piece_list_m, only : plain_points_t, find_points, look_over, is_plain, put_points
  use contact_pieces_m, only : n_gauss, gauss_xi, add_pieces, add_listed_pieces
  use contact_plain_cover_m, only : plain_cover_t, clear_list, list_touching, list_segment, list_other, &
    cut_segments, note_plain_contact
  use contact_state_m, only : contact_state_t, make_room, is_touching
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: place_segmented_mortar, gauss_xi

contains

  !> Place the points: of all segments that may touch, then of their neighbours that can not, since these have a
  !> part in the averaged gaps of common nodes.
  pure subroutine place_segmented_mortar(contact, memory)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t) :: cover
    integer :: s, first

    if (all_asleep(memory)) return
    call clear_list(cover)
    s = 1
    do while (s <= contact%slave%n_segment)
      first = s
      call list_touching(contact, memory, s, cover)
      memory%cover%is_placed(first:s - 1) = .true.
      if (cover%is_full) then
        call place_list(contact, memory, .true., cover)
      else if (s <= contact%slave%n_segment) then
        memory%cover%is_placed(s) = .not. is_asleep(memory, s, contact%slave%segments(:, s))
        if (memory%cover%is_placed(s)) call take_segment(contact, memory, s, .true., cover)
        s = s + 1
      end if
    end do
    call place_list(contact, memory, .true., cover)
    call note_next_wake(memory)
    if (.not. any(memory%mark > 0)) then
      memory%points%n = 0
      return
    end if
    do s = 1, contact%slave%n_segment
      if (memory%cover%is_placed(s)) cycle
      if (memory%mark(contact%slave%segments(1, s)) == 0 &
        .and. memory%mark(contact%slave%segments(2, s)) == 0) cycle
      call take_segment(contact, memory, s, .false., cover)
    end do
    call place_list(contact, memory, .false., cover)
    memory%mark = 0
  end subroutine place_segmented_mortar

  !> Put a segment on the list, and place its points with the list when that is full.
  pure subroutine take_segment(contact, memory, s, may_touch, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: may_touch
    type(plain_cover_t), intent(inout) :: cover
    logical :: is_listed

    call list_segment(contact, memory, s, cover, is_listed)
    if (.not. is_listed) call list_other(s, cover)
    if (cover%is_full) call place_list(contact, memory, may_touch, cover)
  end subroutine take_segment

  !> The points of one segment; one that may touch is judged by them.
  pure subroutine place_segment(contact, memory, s, may_touch)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: may_touch
    type(cover_t) :: cover
    integer :: n_before

    n_before = memory%points%n
    call find_cover(contact, memory, s, cover)
    call add_pieces(contact, memory, cover)
    if (may_touch) call judge_last(contact, memory, s, n_before)
  end subroutine place_segment

  !> The same for a segment on the list whose points are not all where the list has them.
  pure subroutine place_listed(contact, memory, cover, i, may_touch)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: i !! of the list
    logical, intent(in) :: may_touch
    integer :: n_before

    if (.not. cover%is_plain(i)) then
      call place_segment(contact, memory, cover%slave(i), may_touch)
      return
    end if
    n_before = memory%points%n
    call add_listed_pieces(contact, memory, contact%slave%segments(:, cover%slave(i)), &
      cover%master(cover%last(i - 1) + 1:cover%last(i)))
    if (may_touch) call judge_last(contact, memory, cover%slave(i), n_before)
  end subroutine place_listed

  !> Judge a segment by the points that have been appended last, and drop them if they do not count.
  pure subroutine judge_last(contact, memory, s, n_before)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s, n_before
    logical :: counts

    call judge_points(contact, memory, s, .false., minval(memory%points%gap(n_before + 1:memory%points%n)), &
      counts)
    if (.not. counts) memory%points%n = n_before
  end subroutine judge_last

  !> Whether the points of a segment count; marks its nodes if one of them is in contact. Where neither they nor an end of it
  !> is in contact they are left to the second round, like those of a segment that sleeps: so sums over the points
  !> of a node do not depend on who sleeps.
  pure subroutine judge_points(contact, memory, s, touches, deepest, counts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: touches  !! the common case, and both ends are in contact
    real(wp), intent(in) :: deepest !! smallest gap of its points, m
    logical, intent(out) :: counts
    integer :: ends(2)

    counts = .true.
    ends = contact%slave%segments(:, s)
    if (touches) then
      call note_plain_contact(memory, s, deepest < memory%closed_gap)
    else
      call judge_segment(contact, memory, s, ends, deepest, counts)
    end if
    if (counts .and. deepest < memory%closed_gap) then
      memory%mark(ends(1)) = 1
      memory%mark(ends(2)) = 1
    else if (counts .and. .not. touches) then
      counts = any(memory%slave_tracking%status(ends) == is_touching)
      memory%cover%is_placed(s) = counts
    end if
  end subroutine judge_points

  !> Place the points of the segments on a list, and clear it.
  pure subroutine place_list(contact, memory, may_touch, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    logical, intent(in) :: may_touch
    type(plain_cover_t), intent(inout) :: cover
    type(plain_points_t) :: found
    integer :: i, first, last
    logical :: counts

    call cut_segments(contact, memory, cover)
    call find_points(cover%n_piece, cover%own, cover%other, cover%way, cover%low, cover%high, &
      cover%length, found)
    call look_over(contact, memory, cover, found)
    if (memory%points%n + n_gauss*cover%n_piece > size(memory%points%gap)) &
      call make_room(memory%points, n_gauss*cover%n_piece)
    first = 1
    do i = 1, cover%n_segment
      last = cover%last(i)
      if (.not. is_plain(contact, memory, cover, found, i)) then
        call put_points(memory, cover, found, first, cover%last(i - 1))
        call place_listed(contact, memory, cover, i, may_touch)
        if (memory%points%n + n_gauss*(cover%n_piece - last) > size(memory%points%gap)) &
          call make_room(memory%points, n_gauss*(cover%n_piece - last))
        first = last + 1
      else if (may_touch) then
        call judge_points(contact, memory, cover%slave(i), cover%touches(i), &
          minval(found%gap(:, cover%last(i - 1) + 1:last)), counts)
        if (counts) cycle
        call put_points(memory, cover, found, first, cover%last(i - 1))
        first = last + 1
      end if
    end do
    call put_points(memory, cover, found, first, cover%n_piece)
    call clear_list(cover)
  end subroutine place_list

end module points_segmented_mortar_m
