! SPDX-License-Identifier: MIT
!> Slave segments with both ends in contact: the master segments between their feet, listed for many
!> of them at a time and without a walk. On arrays of known shape: half of the work.
module piece_list_m
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  use piece_table_m, only : piece_table_t, n_piece_block, is_listed_piece, is_last_piece
  use surfaces_m, only : surface_t
  implicit none
  private
  public :: list_kept, note_segments, may_list

  !> Most pieces of a slave segment that are listed without a walk, and length of a closed master
  !> chain up to which the way forwards may be the shorter one.
  integer, parameter :: n_most = 6, short_chain = 2*n_most + 2
  !> Part of a segment within which a foot is on its node where a list or a walk starts or ends.
  real(wp), parameter :: hair = 1.0e-9_wp

contains

  !> Whether pieces upon this chain may be listed at all.
  pure function may_list(master)
    type(surface_t), intent(in) :: master
    logical :: may_list

    may_list = master%n_segment > short_chain
  end function may_list

  !> List the slave segments from s to the last with both ends in contact, until the table is full;
  !> s is then the first that is of another kind, needs a walk, or has no room.
  pure subroutine list_kept(contact, memory, last, s, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: last
    integer, intent(inout) :: s
    type(piece_table_t), intent(inout) :: table
    integer :: feet(2, n_piece_block), n, n_listed

    do while (s <= last .and. .not. table%is_full)
      ! Of most segments there are two pieces.
      n = min(n_piece_block, (size(table%master) - table%n + 1)/2, &
        size(table%slave) - table%n_segment, last - s + 1)
      associate (tracking => memory%slave_tracking)
        call find_ends(contact%slave%segments(1, s), tracking%status, tracking%segment, &
          tracking%xi, table%least_cut, contact%master, memory%n_slave, memory%places, n, feet)
      end associate
      if (n == 0) return
      n_listed = n
      call list_runs(contact%slave%segments(1, s), feet, contact%master%previous, &
        size(table%master), n_listed, table%n, table%ends, table%master, table%kind, &
        table%last(table%n_segment + 1))
      call note_segments(s, n_listed, .true., table)
      s = s + n_listed
      if (n_listed < n) return
    end do
  end subroutine list_kept

  !> Master segments below both ends of slave segments, up to the first with an end that is not in
  !> contact.
  pure subroutine find_ends(ends, status, segment, xi, least_cut, master, n_slave, places, n, feet)
    integer, intent(in) :: ends(2, *)            !! nodes of the segments
    integer, intent(in) :: status(*), segment(*) !! of the slave nodes
    real(wp), intent(in) :: xi(*)
    real(wp), intent(in) :: least_cut            !! of the table
    type(surface_t), intent(in) :: master
    integer, intent(in) :: n_slave               !! local number before the first master node
    real(wp), intent(in) :: places(4, *)
    integer, intent(inout) :: n                  !! segments; those that have feet
    integer, intent(inout) :: feet(2, *)
    real(wp) :: near_node
    integer :: i, k, node
    logical :: is_near(2)

    near_node = max(hair, least_cut)
    do i = 1, n
      do k = 1, 2
        node = ends(k, i)
        if (status(node) /= is_touching) then
          n = i - 1
          return
        end if
        feet(k, i) = segment(node)
        is_near(k) = min(xi(node), 1.0_wp - xi(node)) <= near_node
      end do
      if (is_near(1) .or. is_near(2)) call leave_nodes(ends(1, i), is_near, xi, least_cut, master, &
        n_slave, places, feet(1, i))
    end do
  end subroutine find_ends

  !> Master segment of the first or the last piece of a slave segment where the foot of that end is
  !> a master node, or next to it. Of the two at that node the outer one has a piece only where the
  !> node projects on the slave segment.
  pure subroutine leave_nodes(ends, is_near, xi, least_cut, master, n_slave, places, feet)
    integer, intent(in) :: ends(2)     !! nodes of the slave segment
    logical, intent(in) :: is_near(2)  !! which ends
    real(wp), intent(in) :: xi(*)      !! places on the master segments, of all slave nodes
    real(wp), intent(in) :: least_cut  !! of the table
    type(surface_t), intent(in) :: master
    integer, intent(in) :: n_slave     !! local number before the first master node
    real(wp), intent(in) :: places(4, *)
    integer, intent(inout) :: feet(2)  !! master segments; 0: a walk has to tell
    integer :: before, behind          !! the two, on the way along the slave segment
    integer :: node, outer, k
    real(wp) :: own(4), way(4), t(2), square, along
    logical :: is_inside

    own = places(:, ends(2)) - places(:, ends(1))
    t = own(1:2) + own(3:4)
    square = t(1)*t(1) + t(2)*t(2)
    do k = 1, 2
      if (.not. is_near(k)) cycle
      before = feet(k)
      behind = feet(k)
      if (xi(ends(k)) < 0.5_wp) then
        behind = master%previous(feet(k))
        node = master%segments(1, feet(k))
      else
        before = master%next(feet(k))
        node = master%segments(2, feet(k))
      end if
      way = places(:, n_slave + node) - places(:, ends(1))
      along = t(1)*(way(1) + way(3)) + t(2)*(way(2) + way(4))
      is_inside = merge(along > least_cut*square, along < (1.0_wp - least_cut)*square, k == 1)
      outer = merge(before, behind, is_inside .eqv. k == 1)
      if (outer > 0) feet(k) = outer
    end do
  end subroutine leave_nodes

  !> List the pieces of slave segments, each from the master segment below its first end back to
  !> that below the second one, up to one where these are too many.
  pure subroutine list_runs(ends, feet, previous, room, n_segment, n, piece_ends, master, kind, &
      last)
    integer, intent(in) :: ends(2, *), feet(2, *)
    integer, intent(in) :: previous(*)  !! of the master
    integer, intent(in) :: room         !! for pieces
    integer, intent(inout) :: n_segment !! slave segments; those that have been listed
    integer, intent(inout) :: n         !! pieces in use
    integer, intent(inout) :: piece_ends(2, *), master(*), kind(*)
    integer, intent(inout) :: last(*)   !! piece of each segment
    integer :: i, j, k, segment

    do i = 1, n_segment
      if (n + n_most > room) exit
      k = n
      segment = feet(1, i)
      do j = 1, n_most
        if (segment == 0) exit
        k = k + 1
        piece_ends(1, k) = ends(1, i)
        piece_ends(2, k) = ends(2, i)
        master(k) = segment
        kind(k) = is_listed_piece
        if (segment == feet(2, i)) exit
        segment = previous(segment)
      end do
      if (j > n_most .or. segment == 0) exit
      if (segment /= feet(2, i)) exit
      kind(k) = is_last_piece
      last(i) = k
      n = k
    end do
    n_segment = i - 1
  end subroutine list_runs

  !> Note slave segments from s on whose pieces, up to the last of each, have been listed.
  pure subroutine note_segments(s, n, touch, table)
    integer, intent(in) :: s, n
    logical, intent(in) :: touch !! both ends are in contact
    type(piece_table_t), intent(inout) :: table
    integer :: i

    do i = 1, n
      table%slave(table%n_segment + i) = s + i - 1
      table%touches(table%n_segment + i) = touch
    end do
    table%n_segment = table%n_segment + n
    table%is_full = max(table%n + n_most, table%n_segment + 1) > size(table%master)
  end subroutine note_segments

end module piece_list_m
