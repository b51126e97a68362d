! SPDX-License-Identifier: MIT
!> Which part of a slave segment faces which master segments. Both chains are ordered and run
!> against each other: going back along the master chain from the foot of one end of a slave segment
!> to that of the other meets every master node in between. Projected on the slave segment these
!> nodes cut it into pieces, each facing one master segment; there is no search
!> (doc/theory/contact.md, section 3.5). Some slave segments at a time are listed, then all are cut
!> together. Where an end has no foot, or the feet are on two chains, piece_walk lists the pieces.
module pieces_m
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use foot_block_m, only : project
  use foot_m, only : foot_t, nearest_foot, nearer_run, facing_share, face_on, round_off
  use kinds_m, only : wp
  use pairing_m, only : present_pair, has_chains
  use piece_list_m, only : list_kept, list_run, note_segments, may_list, hair
  use piece_order_m, only : level_cuts, name_cuts
  use piece_table_m, only : piece_table_t, shrink_pieces, n_piece_block, is_last_piece, &
    is_walked_piece
  use piece_walk_m, only : walk_pieces
  use sleep_m, only : is_asleep
  implicit none
  private
  public :: clear_pieces, list_awake, list_segment, cut_pieces, tracked_foot

  !> Deepest piece of a surface in contact with itself, by the depth of a first contact, like that
  !> of what is looked for (self_search).
  real(wp), parameter :: behind = 1.5_wp
  !> Share of a piece on the back of a wall: it counts nowhere, whatever faces whom.
  real(wp), parameter :: is_back = -1.0_wp

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

  !> List the slave segments from s on that may touch, until the table is full; s is then the next.
  pure subroutine list_awake(contact, memory, is_strict, s, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    logical, intent(in) :: is_strict !! a segment with an end beyond the master has no pieces
    integer, intent(inout) :: s
    type(piece_table_t), intent(inout) :: table

    do while (s <= contact%slave%n_segment .and. .not. table%is_full)
      if (may_list(contact%master)) call list_kept(contact, memory, &
        contact%slave%n_segment, s, table)
      if (s > contact%slave%n_segment .or. table%is_full) return
      if (.not. is_asleep(memory, s, contact%slave%segments(:, s))) &
        call list_segment(contact, memory, s, is_strict, table)
      s = s + 1
    end do
  end subroutine list_awake

  !> List a slave segment. Ends in contact are where the tracking has them; others are looked for
  !> from the foot of the other end, so that both are on the same stretch of the chain.
  pure subroutine list_segment(contact, memory, s, is_strict, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s !! slave segment
    logical, intent(in) :: is_strict
    type(piece_table_t), intent(inout) :: table
    type(foot_t) :: feet(2)
    integer :: ends(2), next
    logical :: touches, is_listed

    ends = contact%slave%segments(:, s)
    touches = all(memory%slave_tracking%status(ends) == is_touching)
    if (touches .and. may_list(contact%master)) then
      next = s
      call list_kept(contact, memory, s, next, table)
      if (next > s) return
    end if
    call find_feet(contact, memory, ends, feet)
    is_listed = .false.
    if (.not. touches .and. all(feet%is_on) .and. may_list(contact%master)) &
      call list_run(ends, feet%segment, contact%master%previous, table, is_listed)
    if (.not. is_listed) call walk_pieces(contact, memory, ends, feet, is_strict, table)
    table%last(table%n_segment + 1) = table%n
    call note_segments(s, 1, touches, table)
  end subroutine list_segment

  !> Feet of both ends of a slave segment; segment 0 where no master segment is near. A foot on a
  !> master node belongs to two segments: it takes the outer one, so that the node lies between the
  !> feet whatever round-off decided. Where ends of closed surfaces meet exactly, a hair off the
  !> node would count otherwise: what stands over the end of a slave would gain or lose half of the
  !> side of its body under the strict rule of type 5.
  pure subroutine find_feet(contact, memory, ends, feet)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(foot_t), intent(out) :: feet(2)
    integer :: own(2), k
    logical :: touch(2)

    associate (tracking => memory%slave_tracking)
      own = tracking%segment(ends)
      if (has_chains(memory, contact%master)) then
        do k = 1, 2
          own(k) = present_pair(tracking, contact%master, memory%places(:, memory%n_slave + 1:), &
            memory%places(:, :memory%n_slave), ends(k), memory%travel)
        end do
      end if
      if (memory%facing%is_used) call take_nearer_runs(contact, memory, ends, own)
      if (all(own == 0)) return
      touch = tracking%status(ends) == is_touching
      do k = 1, 2
        if (touch(k)) feet(k) = tracked_foot(tracking%segment(ends(k)), tracking%xi(ends(k)), &
          tracking%gap(ends(k)), tracking%normal(:, ends(k)))
      end do
      if (.not. any(touch)) then
        call find_free_feet(contact, memory, ends, own, feet)
      else
        do k = 1, 2
          if (.not. touch(k)) &
            feet(k) = foot_from(contact, memory, ends(k), k, own(k), feet(3 - k)%segment)
        end do
      end if
    end associate
    associate (next => contact%master%next(feet(1)%segment))
      if (abs(feet(1)%xi - 1.0_wp) <= hair .and. next > 0) then
        feet(1)%segment = next
        feet(1)%xi = 0.0_wp
      end if
    end associate
    associate (previous => contact%master%previous(feet(2)%segment))
      if (abs(feet(2)%xi) <= hair .and. previous > 0) then
        feet(2)%segment = previous
        feet(2)%xi = 1.0_wp
      end if
    end associate
  end subroutine find_feet

  !> Master segments that ends which are not in contact are paired with, where runs meet.
  pure subroutine take_nearer_runs(contact, memory, ends, own)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(inout) :: own(2) !! 0: none
    integer :: k

    do k = 1, 2
      if (own(k) == 0 .or. memory%slave_tracking%status(ends(k)) == is_touching) cycle
      own(k) = nearer_run(contact%master, memory%places(:, memory%n_slave + 1:), &
        memory%places(:, ends(k)), own(k))
    end do
  end subroutine take_nearer_runs

  !> Feet of two ends neither of which is in contact: each where it is paired. An end that is not,
  !> or that stands beyond its chain with nothing below the slave segment, has its foot on the chain
  !> of the other one.
  pure subroutine find_free_feet(contact, memory, ends, own, feet)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(in) :: own(2) !! master segments that they are paired with, 0: none
    type(foot_t), intent(inout) :: feet(2)
    logical :: is_used(2)
    integer :: k

    associate (places => memory%places(:, memory%n_slave + 1:))
      do k = 1, 2
        if (own(k) > 0) &
          feet(k) = nearest_foot(contact%master, places, memory%places(:, ends(k)), own(k))
        is_used(k) = own(k) > 0 .and. (feet(k)%is_on .or. (feet(k)%xi > 0.5_wp .eqv. k == 1))
      end do
      do k = 1, 2
        if (.not. is_used(k) .and. (is_used(3 - k) .or. own(k) == 0)) feet(k) = nearest_foot( &
          contact%master, places, memory%places(:, ends(k)), feet(3 - k)%segment)
      end do
    end associate
  end subroutine find_free_feet

  !> Foot of an end that is not in contact, looked for from a master segment, or on the chain that
  !> it is paired with if that is another one and nearer: at a sharp corner one run ends and the
  !> next begins, and a slave segment above the corner stands on both.
  pure function foot_from(contact, memory, node, k, own, start) result(foot)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: node, start
    integer, intent(in) :: k   !! which end of its segment
    integer, intent(in) :: own !! master segment that it is paired with, 0: none
    type(foot_t) :: foot, other

    associate (places => memory%places(:, memory%n_slave + 1:), place => memory%places(:, node))
      foot = nearest_foot(contact%master, places, place, start)
      if (own == 0) return
      if (contact%master%chain(own) == contact%master%chain(start)) return
      other = nearest_foot(contact%master, places, place, own)
      ! At a corner in common both are as near: what it is paired with has been decided.
      if (.not. other%distance*(1.0_wp - round_off) < foot%distance) return
      ! Beyond the end that the way along the slave segment comes to first, nothing lies below it.
      if (other%is_on .or. (other%xi > 0.5_wp .eqv. k == 1)) foot = other
    end associate
  end function foot_from

  !> Foot of a spot in contact.
  pure function tracked_foot(segment, xi, gap, normal) result(foot)
    integer, intent(in) :: segment
    real(wp), intent(in) :: xi, gap, normal(2)
    type(foot_t) :: foot

    foot%segment = segment
    foot%is_on = .true.
    foot%xi = xi
    foot%gap = gap
    foot%normal = normal
  end function tracked_foot

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
    if (contact%is_self) call drop_backs(memory%slave_tracking%segment_depth, table)
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

  !> Where the pieces start and end. A node that projects beyond an end of the slave segment cuts
  !> nothing. Where one projects behind the last cut the pieces of its segment are put in order.
  pure subroutine order_pieces(n, segments, master, kind, cut, low, high, first_cut, last_cut)
    integer, intent(in) :: n, segments(2, *) !! of the master
    integer, intent(in) :: master(n), kind(n)
    real(wp), intent(in) :: cut(n)
    real(wp), intent(inout) :: low(n), high(n)
    integer, intent(inout) :: first_cut(n), last_cut(n)
    real(wp) :: at
    integer :: k, node, first
    logical :: is_bent

    at = 0.0_wp
    node = 0
    first = 0
    is_bent = .false.
    do k = 1, n
      if (kind(k) == is_walked_piece) cycle
      if (first == 0) first = k
      low(k) = at
      first_cut(k) = node
      if (kind(k) == is_last_piece) then
        high(k) = 1.0_wp
        last_cut(k) = 0
        at = 0.0_wp
        node = 0
        if (is_bent) call order_bent(k - first + 1, segments, master(first), cut(first), &
          low(first), high(first), first_cut(first), last_cut(first))
        first = 0
        is_bent = .false.
      else
        is_bent = is_bent .or. (cut(k) <= at .and. at > 0.0_wp)
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

  !> The pieces of one slave segment in order, where a node of the master projects behind another
  !> that comes before it.
  pure subroutine order_bent(n, segments, master, cut, low, high, first_cut, last_cut)
    integer, intent(in) :: n, segments(2, *), master(n)
    real(wp), intent(in) :: cut(n)
    real(wp), intent(inout) :: low(n), high(n)
    integer, intent(inout) :: first_cut(n), last_cut(n)
    integer :: k

    do k = 1, n - 1
      high(k) = max(0.0_wp, min(1.0_wp, cut(k)))
      last_cut(k) = merge(segments(1, master(k)), 0, cut(k) > 0.0_wp .and. cut(k) < 1.0_wp)
    end do
    low(2:) = high(:n - 1)
    first_cut(2:) = last_cut(:n - 1)
    call level_cuts(n, low, high)
    call name_cuts(n, low, high, first_cut, last_cut)
  end subroutine order_bent

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

  !> In contact of a surface with itself the way along a run may lead round the tip of a fold: what
  !> lies that deep behind a slave segment is the back of its own wall, or of another one.
  pure subroutine drop_backs(segment_depth, table)
    real(wp), intent(in) :: segment_depth(:) !! (segments of the master) m
    type(piece_table_t), intent(inout) :: table
    real(wp) :: place(2), gap
    integer :: i, k

    i = 1
    do k = 1, table%n
      do while (table%last(i) < k)
        i = i + 1
      end do
      if (table%touches(i) .or. table%master(k) == 0 .or. .not. table%share(k) > 0.0_wp) cycle
      place = table%way(:, k) + 0.5_wp*(table%low(k) + table%high(k))*table%own(:, k)
      gap = table%other(2, k)*place(1) - table%other(1, k)*place(2)
      if (gap < -behind*segment_depth(table%master(k))*norm2(table%other(:, k))) &
        table%share(k) = is_back
    end do
  end subroutine drop_backs

end module pieces_m
