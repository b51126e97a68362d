! SPDX-License-Identifier: MIT
!> The general way to the pieces of a slave segment: along the master chain from the foot of one end
!> to that of the other, with the ends of chains and over to another chain.
module piece_walk_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use foot_m, only : foot_t, see_segment, turns_gently
  use geometry_m, only : sight_t, sight_of_segment
  use kinds_m, only : wp
  use piece_order_m, only : level_cuts, name_cuts
  use piece_table_m, only : piece_table_t, grow_pieces, is_walked_piece
  implicit none
  private
  public :: walk_pieces

contains

  !> List the pieces of a slave segment whose ends have the given feet.
  pure subroutine walk_pieces(contact, memory, ends, feet, is_strict, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)     !! its nodes
    type(foot_t), intent(in) :: feet(2)
    logical, intent(in) :: is_strict   !! with an end beyond the master it is a piece without one
    type(piece_table_t), intent(inout) :: table
    integer :: n_before
    logical :: faces

    faces = is_faced(contact, feet)
    if (is_strict .and. .not. (faces .and. all(feet%is_on))) then
      call add_row(ends, 0, [0.0_wp, 1.0_wp], [0, 0], table)
      return
    end if
    if (.not. faces) return
    n_before = table%n
    if (contact%master%chain(feet(1)%segment) == contact%master%chain(feet(2)%segment)) then
      call walk_between(contact, memory, ends, feet, table)
    else
      call walk_to_end(contact, memory, ends, feet(1), table)
      call walk_from_start(contact, memory, ends, feet(2), table)
    end if
    call order_rows(n_before, table)
  end subroutine walk_pieces

  !> Whether something of the master may lie below a slave segment: not where an end is beyond that
  !> end of the master chain to which the way along the slave segment comes last.
  pure function is_faced(contact, feet) result(faced)
    type(contact_t), intent(in) :: contact
    type(foot_t), intent(in) :: feet(2)
    logical :: faced

    faced = minval(feet%segment) > 0
    if (.not. faced) return
    if (.not. feet(1)%is_on) faced = feet(1)%xi >= 0.5_wp
    if (.not. feet(2)%is_on) faced = faced .and. feet(2)%xi <= 0.5_wp
    if (all(feet%is_on) .and. contact%master%chain(feet(1)%segment) &
      == contact%master%chain(feet(2)%segment)) faced = runs_against(contact, feet)
  end function is_faced

  !> Whether the way along the master chain from the first foot to the second is shorter backwards.
  !> Otherwise slave and master do not face: the side of a body, seen from the chain, runs along
  !> with it.
  pure function runs_against(contact, feet) result(against)
    type(contact_t), intent(in) :: contact
    type(foot_t), intent(in) :: feet(2)
    logical :: against
    integer :: back, forth

    back = feet(1)%segment
    forth = feet(1)%segment
    do
      against = back == feet(2)%segment
      if (against .or. forth == feet(2)%segment) return
      if (back > 0) back = contact%master%previous(back)
      if (forth > 0) forth = contact%master%next(forth)
      if (back == 0 .and. forth == 0) return
    end do
  end function runs_against

  !> Both feet on one chain: all segments from one to the other.
  pure subroutine walk_between(contact, memory, ends, feet, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(foot_t), intent(in) :: feet(2)
    type(piece_table_t), intent(inout) :: table
    integer :: segment, i_step
    logical :: is_last

    segment = feet(1)%segment
    do i_step = 1, contact%master%n_segment
      is_last = segment == feet(2)%segment .or. contact%master%previous(segment) == 0
      call add_segment(contact, memory, ends, segment, i_step == 1 .and. feet(1)%is_on, &
        is_last .and. feet(2)%is_on, table)
      if (is_last) return
      segment = contact%master%previous(segment)
    end do
  end subroutine walk_between

  !> From the foot of the first end to the end of its chain, to a sharp corner, or beyond the other
  !> end of the slave segment; not on what leads away and does not face it.
  pure subroutine walk_to_end(contact, memory, ends, foot, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(foot_t), intent(in) :: foot
    type(piece_table_t), intent(inout) :: table
    integer :: segment, i_step
    real(wp) :: at

    segment = foot%segment
    do i_step = 1, contact%master%n_segment
      at = place_of(memory, ends, contact%master%segments(1, segment))
      if (at < -1.0_wp) return
      call add_segment(contact, memory, ends, segment, i_step == 1 .and. foot%is_on, .false., table)
      if (at >= 1.0_wp) return
      if (.not. goes_on(contact, memory, ends, segment, contact%master%previous(segment))) return
      segment = contact%master%previous(segment)
    end do
  end subroutine walk_to_end

  !> The same seen from the second end, up to the foot of that.
  pure subroutine walk_from_start(contact, memory, ends, foot, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(foot_t), intent(in) :: foot
    type(piece_table_t), intent(inout) :: table
    integer :: segment, i_step, n_step
    real(wp) :: at

    segment = foot%segment
    n_step = 0
    do i_step = 1, contact%master%n_segment
      at = place_of(memory, ends, contact%master%segments(2, segment))
      if (at > 2.0_wp) exit
      n_step = n_step + 1
      if (at <= 0.0_wp) exit
      if (.not. goes_on(contact, memory, ends, segment, contact%master%next(segment))) exit
      segment = contact%master%next(segment)
    end do
    if (n_step < i_step .and. n_step > 0) segment = contact%master%previous(segment)
    do i_step = 1, n_step
      call add_segment(contact, memory, ends, segment, .false., &
        i_step == n_step .and. foot%is_on, table)
      segment = contact%master%previous(segment)
    end do
  end subroutine walk_from_start

  !> Append a master segment from where its second node projects on the slave segment to where its
  !> first one does; below an end that has its foot on it, from or to that.
  pure subroutine add_segment(contact, memory, ends, segment, has_first, has_last, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2), segment
    logical, intent(in) :: has_first, has_last !! the foot of the first end, of the second
    type(piece_table_t), intent(inout) :: table
    real(wp) :: range(2)
    integer :: cuts(2)

    range = [0.0_wp, 1.0_wp]
    cuts = 0
    if (.not. has_first) then
      cuts(1) = contact%master%segments(2, segment)
      range(1) = place_of(memory, ends, cuts(1))
    end if
    if (.not. has_last) then
      cuts(2) = contact%master%segments(1, segment)
      range(2) = place_of(memory, ends, cuts(2))
    end if
    ! Beyond its ends the slave segment is not cut.
    where (.not. (range > 0.0_wp .and. range < 1.0_wp)) cuts = 0
    call add_row(ends, segment, max(0.0_wp, min(1.0_wp, range)), cuts, table)
  end subroutine add_segment

  !> Append a piece to the table.
  pure subroutine add_row(ends, master, range, cuts, table)
    integer, intent(in) :: ends(2), master
    real(wp), intent(in) :: range(2) !! where it starts and ends
    integer, intent(in) :: cuts(2)   !! master nodes that cut there, 0: none
    type(piece_table_t), intent(inout) :: table

    if (table%n + 1 >= size(table%master)) call grow_pieces(table)
    associate (k => table%n + 1)
      table%ends(:, k) = ends
      table%master(k) = master
      table%low(k) = range(1)
      table%high(k) = range(2)
      table%first_cut(k) = cuts(1)
      table%last_cut(k) = cuts(2)
      table%kind(k) = is_walked_piece
    end associate
    table%n = table%n + 1
  end subroutine add_row

  !> Put the pieces behind the first n of a table in order, and drop those that are empty.
  pure subroutine order_rows(n_before, table)
    integer, intent(in) :: n_before
    type(piece_table_t), intent(inout) :: table
    integer :: k, n

    associate (first => n_before + 1, last => table%n)
      call level_cuts(last - n_before, table%low(first:last), table%high(first:last))
      call name_cuts(last - n_before, table%low(first:last), table%high(first:last), &
        table%first_cut(first:last), table%last_cut(first:last))
    end associate
    n = n_before
    do k = n_before + 1, table%n
      if (.not. table%high(k) > table%low(k)) cycle
      n = n + 1
      if (n == k) cycle
      table%master(n) = table%master(k)
      table%low(n) = table%low(k)
      table%high(n) = table%high(k)
      table%first_cut(n) = table%first_cut(k)
      table%last_cut(n) = table%last_cut(k)
    end do
    table%n = n
  end subroutine order_rows

  !> Whether a master segment has a neighbour across a gentle corner.
  pure function goes_on(contact, memory, ends, segment, neighbour)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(in) :: segment, neighbour !! 0: no neighbour
    logical :: goes_on

    goes_on = neighbour > 0
    if (.not. goes_on) return
    associate (chain => memory%places(:, memory%n_slave + 1:), place => memory%places(:, ends(1)))
      goes_on = turns_gently(see_segment(contact%master, chain, place, segment), &
        see_segment(contact%master, chain, place, neighbour))
    end associate
  end function goes_on

  !> Where a master node projects on a slave segment, 0 to 1 between its ends.
  pure function place_of(memory, ends, node) result(at)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(in) :: node !! of the master surface
    real(wp) :: at
    type(sight_t) :: sight

    sight = sight_of_segment(memory%places(:, memory%n_slave + node), memory%places(:, ends(1)), &
      memory%places(:, ends(2)))
    at = sight%along/sight%square
  end function place_of

end module piece_walk_m
