! SPDX-License-Identifier: MIT
!> The general way to the pieces of a slave segment: along the master chain, piece by piece, with
!> its ends and over to another chain.
module piece_walk_m
  use contact_state_m, only : contact_state_t
  use contacts_m, only : contact_t
  use foot_m, only : foot_t, see_segment, turns_gently, round_off
  use geometry_m, only : sight_t, sight_of_segment
  use kinds_m, only : wp
  use piece_table_m, only : piece_table_t, grow_pieces, is_walked_piece
  implicit none
  private
  public :: walk_pieces

  !> Where a walk is.
  type :: walk_t
    integer :: segment = 0      !! of the master, whose piece comes next
    integer :: far_segment = 0  !! below the second end, while that is of another chain; else 0
    integer :: before = 0       !! the one before that
    integer :: node = 0         !! master node that cuts at `at`, 0: none
    real(wp) :: at = 0.0_wp     !! how far along the slave segment, 0 to 1
    logical :: is_over = .false.
  end type walk_t

contains

  !> List the pieces of a slave segment whose ends have the given feet.
  pure subroutine walk_pieces(contact, memory, ends, feet, is_strict, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)     !! its nodes
    type(foot_t), intent(in) :: feet(2)
    logical, intent(in) :: is_strict   !! with an end beyond the master it is a piece without one
    type(piece_table_t), intent(inout) :: table
    type(walk_t) :: walk
    integer :: i_step

    call start_walk(contact, memory, ends, feet, walk)
    if (is_strict .and. (walk%is_over .or. .not. all(feet%is_on))) then
      call add_row(ends, 0, [0.0_wp, 1.0_wp], [0, 0], table)
      return
    end if
    i_step = 0
    do while (.not. walk%is_over)
      if (walk%far_segment > 0 .and. i_step > 0) &
        call cross_over(contact, memory, ends, walk)
      i_step = i_step + 1
      call take_piece(contact, memory, ends, feet, i_step, walk, table)
    end do
  end subroutine walk_pieces

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

  !> Where the walk along a slave segment starts: at its first end, or at the end of the master
  !> chain.
  pure subroutine start_walk(contact, memory, ends, feet, walk)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(foot_t), intent(in) :: feet(2)
    type(walk_t), intent(out) :: walk
    type(sight_t) :: sight
    integer :: node

    walk%is_over = minval(feet%segment) == 0
    if (walk%is_over) return
    walk%segment = feet(1)%segment
    if (contact%master%chain(feet(1)%segment) /= contact%master%chain(feet(2)%segment)) &
      walk%far_segment = feet(2)%segment
    ! Both ends beyond the same end of the master chain: nothing faces the segment.
    if (.not. feet(1)%is_on) walk%is_over = feet(1)%xi < 0.5_wp
    if (.not. feet(2)%is_on) walk%is_over = walk%is_over .or. feet(2)%xi > 0.5_wp
    if (all(feet%is_on) .and. walk%far_segment == 0) &
      walk%is_over = .not. runs_against(contact, feet)
    if (walk%is_over .or. feet(1)%is_on) return
    node = contact%master%segments(2, walk%segment)
    sight = see_master_node(memory, ends, node)
    if (sight%along <= 0.0_wp) return
    walk%is_over = sight%along >= sight%square
    walk%at = sight%along/sight%square
    walk%node = node
  end subroutine start_walk

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

  !> List the next piece, unless it is empty since the chain is bent back.
  pure subroutine take_piece(contact, memory, ends, feet, i_step, walk, table)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(foot_t), intent(in) :: feet(2)
    integer, intent(in) :: i_step !! master segments met
    type(walk_t), intent(inout) :: walk
    type(piece_table_t), intent(inout) :: table
    type(sight_t) :: sight
    integer :: segment, node

    segment = walk%segment
    node = contact%master%segments(1, segment)
    walk%before = segment
    walk%segment = contact%master%previous(segment)
    walk%is_over = feet(2)%is_on .and. segment == feet(2)%segment
    if (.not. walk%is_over) then
      sight = see_master_node(memory, ends, node)
      walk%is_over = sight%along >= sight%square
    end if
    if (walk%is_over) then
      if (walk%at < 1.0_wp) &
        call add_row(ends, segment, [walk%at, 1.0_wp], [walk%node, 0], table)
      return
    end if
    ! Led away: the chain below the first end does not face the segment. That below the other may.
    if (sight%along < -sight%square) walk%segment = 0
    walk%is_over = i_step >= contact%master%n_segment &
      .or. (walk%segment == 0 .and. walk%far_segment == 0)
    if (sight%along <= walk%at*sight%square) return
    call add_row(ends, segment, [walk%at, sight%along/sight%square], [walk%node, node], table)
    walk%at = sight%along/sight%square
    walk%node = node
  end subroutine take_piece

  !> At the end of the chain below the first end of a slave segment, or at a sharp corner of it, go
  !> over to the chain below the other end: to the segment with which that chain, or its stretch up
  !> to a sharp corner, begins.
  pure subroutine cross_over(contact, memory, ends, walk)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    type(walk_t), intent(inout) :: walk
    type(sight_t) :: sight
    integer :: segment, before, i_step

    segment = walk%far_segment
    before = walk%before
    if (contact%master%chain(before) == contact%master%chain(segment)) return
    if (goes_on(before, walk%segment)) return
    do i_step = 1, contact%master%n_segment
      sight = see_master_node(memory, ends, contact%master%segments(2, segment))
      if (sight%along <= walk%at*sight%square) exit
      if (.not. goes_on(segment, contact%master%next(segment))) exit
      segment = contact%master%next(segment)
    end do
    walk%far_segment = 0
    walk%segment = segment
    ! A node that is passed already cuts nothing. Where the chains meet one of either may stand.
    if (sight%along < (walk%at - round_off)*sight%square) return
    walk%at = max(walk%at, min(1.0_wp, sight%along/sight%square))
    walk%node = contact%master%segments(2, segment)

  contains

    !> Whether a master segment has a neighbour across a gentle corner.
    pure function goes_on(segment, neighbour)
      integer, intent(in) :: segment, neighbour !! 0: no neighbour
      logical :: goes_on

      goes_on = neighbour > 0
      if (goes_on) goes_on = turns_gently(see(segment), see(neighbour))
    end function goes_on

    !> The first end of the slave segment seen from a master segment.
    pure function see(segment) result(sight)
      integer, intent(in) :: segment
      type(sight_t) :: sight

      sight = see_segment(contact%master, memory%places(:, memory%n_slave + 1:), &
        memory%places(:, ends(1)), segment)
    end function see

  end subroutine cross_over

  !> A master node seen from a slave segment.
  pure function see_master_node(memory, ends, node) result(sight)
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(in) :: node !! of the master surface
    type(sight_t) :: sight

    sight = sight_of_segment(memory%places(:, memory%n_slave + node), memory%places(:, ends(1)), &
      memory%places(:, ends(2)))
  end function see_master_node

end module piece_walk_m
