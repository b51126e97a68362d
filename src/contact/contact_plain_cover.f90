! SPDX-License-Identifier: MIT
!> The common case of contact_overlap: both ends of a slave segment are in contact or plainly over
!> the master, a few master segments face it entirely and the nodes between these cut it one after
!> the other. What is found is the same; only the decisions that have no part in this case are left
!> out. Segments are listed first and then cut many at a time, so that the roots and quotients of a
!> list are formed together: one by one, waiting for these and for small arrays on their way to
!> memory and back took two thirds of the pairing.
module contact_plain_cover_m
  use contact_piece_cutting_m, only : see_pieces, cut_pieces, order_pieces, n_room
  use contact_plain_ends_m, only : find_ends, is_inside, n_most, short_chain
  use contact_state_m, only : contact_state_t, is_free, is_touching
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: plain_cover_t, clear_list, list_touching, list_pointed, list_segment, list_other, &
    cut_segments, note_plain_contact, n_room

  !> Slave segments cut into pieces, one piece behind the other. Without default values, which would
  !> be written before each use.
  type :: plain_cover_t
    integer :: n_segment
    integer :: n_piece
    logical :: is_full                  !! no other segment may fit
    integer :: slave(n_room)            !! (n_segment) of the slave
    integer :: last(0:n_room)           !! (0:n_segment) last piece of each
    logical :: touches(n_room)          !! (n_segment) both ends are in contact
    logical :: is_plain(n_room)         !! (n_segment) this is the common case indeed
    integer :: ends(2, n_room)          !! (n_piece) nodes of the slave segment
    integer :: master(n_room)           !! (n_piece) segment of the master
    integer :: nodes(2, n_room)         !! (n_piece) local numbers of its nodes
    real(wp) :: is_end(n_room)          !! (n_piece) 1 for the last piece of a segment, else 0
    real(wp) :: own(2, n_room)          !! (n_piece) vector of the slave segment, m
    real(wp) :: other(2, n_room)        !! (n_piece) vector of the master segment, m
    real(wp) :: way(2, n_room)          !! (n_piece) from the master segment's first node to the
                                        !! first end, m
    real(wp) :: length(n_room)          !! (n_piece) of the slave segment, m
    real(wp) :: inverse(n_room)         !! (n_piece) 1/length, 1/m
    real(wp) :: low(n_room)             !! (n_piece) where it starts on the slave segment, 0 to 1
    real(wp) :: high(n_room)            !! (n_piece) where it ends: projection of the master
                                        !! segment's first node, or 1
    real(wp) :: gap(n_room)             !! (n_piece) of that node to the slave segment, m
    real(wp) :: facing(n_room)          !! (n_piece) more than 0 where it faces the slave segment
                                        !! entirely
  end type plain_cover_t

contains

  !> Start a list.
  pure subroutine clear_list(cover)
    type(plain_cover_t), intent(inout) :: cover

    cover%n_segment = 0
    cover%n_piece = 0
    cover%last(0) = 0
    cover%is_full = .false.
  end subroutine clear_list

  !> Put slave segments from s on with both ends in contact on the list, up to the first that is of
  !> another kind or has no room: s is then that one.
  pure subroutine list_touching(contact, memory, s, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(inout) :: s
    type(plain_cover_t), intent(inout) :: cover

    if (contact%master%n_segment <= short_chain) return
    associate (tracking => memory%slave_tracking)
      call list_run(contact%slave%n_segment, contact%slave%segments, tracking%status, &
        tracking%segment, tracking%xi, contact%master%previous, s, cover)
    end associate
  end subroutine list_touching

  !> The same on arrays of known shape.
  pure subroutine list_run(n_segment, ends, status, segment, xi, previous, s, cover)
    integer, intent(in) :: n_segment, ends(2, n_segment)   !! of the slave
    integer, intent(in) :: status(*), segment(*)           !! of the slave nodes
    real(wp), intent(in) :: xi(*)
    integer, intent(in) :: previous(*)                     !! of the master
    integer, intent(inout) :: s
    type(plain_cover_t), intent(inout) :: cover
    integer :: one, two
    logical :: is_listed

    do while (s <= n_segment .and. .not. cover%is_full)
      one = ends(1, s)
      two = ends(2, s)
      if (status(one) /= is_touching .or. status(two) /= is_touching) return
      if (.not. (is_inside(xi(one)) .and. is_inside(xi(two)))) return
      call list_pieces(s, ends(1, s), segment(one), segment(two), previous, .true., cover, &
        is_listed)
      if (.not. is_listed) return
      s = s + 1
    end do
  end subroutine list_run

  !> The same where points stand at the slave nodes in contact: `mark` says which, and their weights
  !> where the feet are.
  pure subroutine list_pointed(contact, memory, s, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(inout) :: s
    type(plain_cover_t), intent(inout) :: cover

    if (contact%master%n_segment <= short_chain) return
    call list_run_of_points(contact%slave%n_segment, contact%slave%segments, memory%mark, &
      memory%points%master_weights, memory%slave_tracking%segment, contact%master%previous, s, &
      cover)
  end subroutine list_pointed

  !> The same on arrays of known shape.
  pure subroutine list_run_of_points(n_segment, ends, mark, weights, segment, previous, s, cover)
    integer, intent(in) :: n_segment, ends(2, n_segment)   !! of the slave
    integer, intent(in) :: mark(*), segment(*)             !! of the slave nodes
    real(wp), intent(in) :: weights(2, *)                  !! of the points, on their master
                                                           !! segments
    integer, intent(in) :: previous(*)                     !! of the master
    integer, intent(inout) :: s
    type(plain_cover_t), intent(inout) :: cover
    integer :: k, p, node, before, first, last
    logical :: is_listed

    before = 0
    last = 0
    do while (s <= n_segment .and. .not. cover%is_full)
      first = last
      do k = 1, 2
        node = ends(k, s)
        if (node == before) cycle
        p = mark(node)
        if (p == 0) return
        if (.not. min(weights(1, p), weights(2, p)) > 0.0_wp) return
        if (k == 1) first = segment(node)
      end do
      before = node
      last = segment(node)
      call list_pieces(s, ends(1, s), first, last, previous, .true., cover, is_listed)
      if (.not. is_listed) return
      s = s + 1
    end do
  end subroutine list_run_of_points

  !> Put the pieces of a slave segment on the list, from the master segment below its first end back
  !> to that below the second one, if these are not too many.
  pure subroutine list_pieces(s, ends, first, last, previous, touches, cover, is_listed)
    integer, intent(in) :: s, ends(2)   !! slave segment and its nodes
    integer, intent(in) :: first, last
    integer, intent(in) :: previous(*)  !! of the master
    logical, intent(in) :: touches      !! both ends are in contact
    type(plain_cover_t), intent(inout) :: cover
    logical, intent(out) :: is_listed
    integer :: segment, n, k

    is_listed = .false.
    segment = first
    k = cover%n_piece
    do n = 1, n_most
      k = k + 1
      cover%ends(1, k) = ends(1)
      cover%ends(2, k) = ends(2)
      cover%master(k) = segment
      cover%is_end(k) = 0.0_wp
      if (segment == last) exit
      segment = previous(segment)
      if (segment == 0) return
    end do
    if (n > n_most) return
    is_listed = .true.
    cover%is_end(k) = 1.0_wp
    cover%n_segment = cover%n_segment + 1
    cover%slave(cover%n_segment) = s
    cover%last(cover%n_segment) = k
    cover%touches(cover%n_segment) = touches
    cover%n_piece = k
    cover%is_full = k > n_room - n_most .or. cover%n_segment == n_room
  end subroutine list_pieces

  !> Put any other slave segment on the list if the master segments below its ends can be told:
  !> corners, and whatever else needs a decision, are left to contact_overlap.
  pure subroutine list_segment(contact, memory, s, with_nodes, cover, is_listed)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s           !! slave segment
    logical, intent(in) :: with_nodes  !! also where the foot of an end in contact is a node, which
                                       !! is common in valleys
    type(plain_cover_t), intent(inout) :: cover
    logical, intent(out) :: is_listed
    integer :: first, last
    logical :: touches

    is_listed = .false.
    associate (ends => contact%slave%segments(:, s))
      call find_ends(contact, memory, ends(1), ends(2), with_nodes, first, last, touches)
      if (first == 0 .or. last == 0) return
      if (first /= last .and. contact%master%n_segment <= short_chain) return
      call list_pieces(s, ends, first, last, contact%master%previous, touches, cover, is_listed)
    end associate
  end subroutine list_segment

  !> Put a slave segment that is not the common case on the list, without pieces, so that its points
  !> keep their place among those of the others.
  pure subroutine list_other(s, cover)
    integer, intent(in) :: s
    type(plain_cover_t), intent(inout) :: cover

    cover%n_segment = cover%n_segment + 1
    cover%slave(cover%n_segment) = s
    cover%last(cover%n_segment) = cover%n_piece
    cover%touches(cover%n_segment) = .false.
    cover%is_full = cover%is_full .or. cover%n_segment == n_room
  end subroutine list_other

  !> Cut the segments on the list.
  pure subroutine cut_segments(contact, memory, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    type(plain_cover_t), intent(inout) :: cover
    integer :: i, n_odd
    real(wp) :: odd(n_room)

    call see_pieces(cover%n_piece, cover%ends, cover%master, contact%master%segments, &
      memory%n_slave, memory%places, cover%nodes, cover%own, cover%other, cover%way)
    call cut_pieces(cover%n_piece, cover%own, cover%other, cover%way, cover%length, cover%inverse, &
      cover%high, cover%gap, cover%facing)
    call order_pieces(cover%n_piece, cover%facing, cover%is_end, cover%low, cover%high, odd, n_odd)
    do i = 1, cover%n_segment
      cover%is_plain(i) = cover%last(i) > cover%last(i - 1)
      if (n_odd > 0 .and. cover%is_plain(i)) &
        cover%is_plain(i) = maxval(odd(cover%last(i - 1) + 1:cover%last(i))) < 1.0_wp
    end do
  end subroutine cut_segments

  !> What contact_admission notes of a segment with both ends in contact: it stays, whatever its
  !> gaps. One in contact is awake: nothing is written again.
  pure subroutine note_plain_contact(is_deep, travel, status, wake)
    logical, intent(in) :: is_deep   !! some gap of it is closed
    real(wp), intent(in) :: travel   !! m
    integer, intent(inout) :: status !! of the segment
    real(wp), intent(inout) :: wake  !! m

    if (is_deep .and. status == is_touching) return
    status = merge(is_touching, is_free, is_deep)
    wake = merge(-huge(1.0_wp), travel, is_deep)
  end subroutine note_plain_contact

end module contact_plain_cover_m
