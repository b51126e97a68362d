! SPDX-License-Identifier: MIT
!> Overlaps of slave and master segments (doc/theory/contact.md, section 3.5). Between two ends that
!> are active on one surface they follow from the projections of the master nodes in between; all
!> others come from the candidate pairs of the slave segment (candidate_overlaps). Some slave
!> segments at a time are listed, then all are cut together.
module pieces_m
  use candidate_overlaps_m, only : list_candidate_overlaps
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use foot_block_m, only : project
  use foot_m, only : facing_share, face_on, round_off
  use kinds_m, only : wp
  use overlap_status_m, only : is_due
  use piece_list_m, only : list_kept, note_segments, may_list
  use piece_table_m, only : piece_table_t, shrink_pieces, n_piece_block, is_last_piece, &
    is_walked_piece
  implicit none
  private
  public :: clear_pieces, list_due, list_segment, cut_pieces

contains

  !> Start a table.
  pure subroutine clear_pieces(table, least_cut)
    type(piece_table_t), intent(inout) :: table
    real(wp), intent(in), optional :: least_cut !! part of a slave segment next to its ends where
                                                !! master nodes need not cut it

    ! A restart knows nothing of room that was once needed, and what is taken together has an order.
    if (size(table%master) > n_piece_block) call shrink_pieces(table)
    table%least_cut = round_off
    if (present(least_cut)) table%least_cut = least_cut
    table%n_segment = 0
    table%n = 0
    table%last(0) = 0
    table%is_full = .false.
  end subroutine clear_pieces

  !> List the slave segments from s on that are due, until the table is full; s is then the next.
  pure subroutine list_due(contact, memory, is_strict, s, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    logical, intent(in) :: is_strict !! a segment with an end beyond the master has no overlaps
    integer, intent(inout) :: s
    type(piece_table_t), intent(inout) :: table

    do while (s <= contact%slave%n_segment .and. .not. table%is_full)
      if (may_list(contact%master)) call list_kept(contact, memory, &
        contact%slave%n_segment, s, table)
      if (s > contact%slave%n_segment .or. table%is_full) return
      if (is_due(memory, s, contact%slave%segments(:, s))) &
        call list_segment(contact, memory, s, is_strict, table)
      s = s + 1
    end do
  end subroutine list_due

  !> List the overlaps of a slave segment.
  pure subroutine list_segment(contact, memory, s, is_strict, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s !! slave segment
    logical, intent(in) :: is_strict
    type(piece_table_t), intent(inout) :: table
    integer :: ends(2), next
    logical :: touches

    ends = contact%slave%segments(:, s)
    touches = all(memory%slave_tracking%status(ends) == is_touching)
    if (touches .and. may_list(contact%master)) then
      next = s
      call list_kept(contact, memory, s, next, table)
      if (next > s) return
    end if
    call list_candidate_overlaps(contact, memory, s, is_strict, table)
    table%last(table%n_segment + 1) = table%n
    call note_segments(s, 1, touches, table)
  end subroutine list_segment

  !> Cut all listed segments: where their pieces start and end, and how much of each counts.
  pure subroutine cut_pieces(contact, memory, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(piece_table_t), intent(inout) :: table
    integer :: first, n

    call see_pieces(table%n, table%ends, table%master, contact%master%segments, memory%n_slave, &
      memory%places, table%nodes, table%own, table%other, table%way)
    do first = 1, table%n, n_piece_block
      n = min(n_piece_block, table%n - first + 1)
      call project_nodes(n, table%own(1, first), table%way(1, first), table%cut(first), &
        table%node_gap(first), table%normal(1, first), table%length(first))
    end do
    call order_pieces(table%n, contact%master%segments, table%master, table%kind, table%cut, &
      table%low, table%high, table%first_cut, table%last_cut)
    call find_shares(table%n, table%own, table%other, table%share)
  end subroutine cut_pieces

  !> Vectors of the pieces.
  pure subroutine see_pieces(n, ends, master, segments, n_slave, places, nodes, own, other, way)
    integer, intent(in) :: n, ends(2, *), master(*), segments(2, *)
    integer, intent(in) :: n_slave !! local number before the first master node
    real(wp), intent(in) :: places(4, *)
    integer, intent(inout) :: nodes(2, *)
    real(wp), intent(inout) :: own(2, *), other(2, *), way(2, *)
    real(wp), dimension(4) :: along_slave, along_master, across
    integer :: k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      a = n_slave + segments(1, max(1, master(k)))
      b = n_slave + segments(2, max(1, master(k)))
      nodes(1, k) = a
      nodes(2, k) = b
      along_slave = places(:, ends(2, k)) - places(:, ends(1, k))
      along_master = places(:, b) - places(:, a)
      across = places(:, ends(1, k)) - places(:, a)
      own(:, k) = along_slave(1:2) + along_slave(3:4)
      other(:, k) = along_master(1:2) + along_master(3:4)
      way(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine see_pieces

  !> Projections of the first nodes of the master segments on the slave segments.
  pure subroutine project_nodes(n, own, way, cut, node_gap, normal, length)
    integer, intent(in) :: n !! at most n_piece_block
    real(wp), intent(in) :: own(2, n), way(2, n)
    real(wp), intent(inout) :: cut(n), node_gap(n), normal(2, n), length(n)
    real(wp) :: odd(n_piece_block), inverse(n_piece_block), from_end(2, n_piece_block)
    integer :: n_odd

    from_end(:, :n) = -way
    call project(n, own, from_end, cut, node_gap, normal, inverse, odd, n_odd)
    length = 1.0_wp/inverse(:n)
  end subroutine project_nodes

  !> Where the overlaps start and end. A node that projects beyond an end of the slave segment cuts
  !> nothing; one that projects behind the last breakpoint leaves an empty overlap.
  pure subroutine order_pieces(n, segments, master, kind, cut, low, high, first_cut, last_cut)
    integer, intent(in) :: n, segments(2, *) !! of the master
    integer, intent(in) :: master(n), kind(n)
    real(wp), intent(in) :: cut(n)
    real(wp), intent(inout) :: low(n), high(n)
    integer, intent(inout) :: first_cut(n), last_cut(n)
    real(wp) :: at
    integer :: k, node

    at = 0.0_wp
    node = 0
    do k = 1, n
      if (kind(k) == is_walked_piece) cycle
      low(k) = at
      first_cut(k) = node
      if (kind(k) == is_last_piece) then
        high(k) = 1.0_wp
        last_cut(k) = 0
        at = 0.0_wp
        node = 0
      else
        if (cut(k) >= 1.0_wp) then
          at = 1.0_wp
          node = 0
        else if (cut(k) > at) then
          at = cut(k)
          node = segments(1, master(k))
        end if
        high(k) = at
        last_cut(k) = node
      end if
    end do
  end subroutine order_pieces

  !> How much of the pieces counts: all where the two segments face each other up to a certain
  !> angle, none from a larger one on.
  pure subroutine find_shares(n, own, other, share)
    integer, intent(in) :: n
    real(wp), intent(in) :: own(2, n), other(2, n)
    real(wp), intent(inout) :: share(n)
    real(wp) :: product, squares, least
    integer :: k

    least = 1.0_wp
    !$omp simd private(product, squares) reduction(min: least)
    do k = 1, n
      product = own(1, k)*other(1, k) + own(2, k)*other(2, k)
      squares = (own(1, k)*own(1, k) + own(2, k)*own(2, k)) &
        *(other(1, k)*other(1, k) + other(2, k)*other(2, k))
      share(k) = merge(1.0_wp, 0.0_wp, product < 0.0_wp .and. product*product >= face_on**2*squares)
      least = min(least, share(k))
    end do
    if (least > 0.0_wp) return
    do k = 1, n
      if (share(k) > 0.0_wp) cycle
      share(k) = facing_share(dot_product(own(:, k), other(:, k)) &
        /sqrt(max(sum(own(:, k)**2)*sum(other(:, k)**2), tiny(1.0_wp))))
    end do
  end subroutine find_shares

end module pieces_m
