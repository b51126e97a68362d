! SPDX-License-Identifier: MIT
!> Master segments below the ends of a slave segment, where these can be told without a walk.
module contact_plain_ends_m
  use contact_plain_foot_m, only : see_plain_segment, well_inside
  use contact_state_m, only : contact_state_t, is_touching
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment
  use kinds_m, only : wp
  implicit none
  private
  public :: find_ends, is_inside, n_most, short_chain

  !> Most pieces of a slave segment in the common case.
  integer, parameter :: n_most = 6
  !> In a closed chain of so many segments the way forwards may be the shorter one.
  integer, parameter :: short_chain = 2*n_most

contains

  !> Master segments below both ends of a slave segment; free ends are looked for from where
  !> contact_overlap does.
  pure subroutine find_ends(contact, memory, one, two, with_nodes, first, second, touch)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: one, two       !! the ends
    logical, intent(in) :: with_nodes     !! also where the foot of an end in contact is a node
    integer, intent(out) :: first, second !! 0: a decision is needed
    logical, intent(out) :: touch         !! both ends are in contact
    type(sight_t) :: sight
    logical :: one_touches, two_touches
    integer :: start

    associate (tracking => memory%slave_tracking, chain => memory%places(:, memory%n_slave + 1:))
      one_touches = tracking%status(one) == is_touching
      two_touches = tracking%status(two) == is_touching
      touch = one_touches .and. two_touches
      first = tracking%segment(one)
      second = tracking%segment(two)
      if (one_touches .and. .not. is_inside(tracking%xi(one))) then
        first = 0
        if (with_nodes) first = segment_at_node(contact, memory, one, two, one)
      end if
      if (two_touches .and. .not. is_inside(tracking%xi(two))) then
        second = 0
        if (with_nodes) second = segment_at_node(contact, memory, one, two, two)
      end if
      if (touch .or. (one_touches .and. first == 0) .or. (two_touches .and. second == 0)) return
      if (.not. one_touches) then
        start = merge(second, first, two_touches .or. first == 0)
        if (start == 0) return
        call see_plain_segment(contact%master, chain, memory%places(:, one), start, first, sight)
      end if
      if (first == 0 .or. two_touches) return
      start = first
      call see_plain_segment(contact%master, chain, memory%places(:, two), start, second, sight)
    end associate
  end subroutine find_ends

  !> Master segment of the first or the last piece of a slave segment where the foot of that end is
  !> a node. Of the two at that node the outer one has a piece only where the node projects on the
  !> slave segment. In a closed chain it may lie one segment beyond the others at either end: hence
  !> two more than a short chain has.
  pure function segment_at_node(contact, memory, one, two, node) result(segment)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: one, two !! the ends
    integer, intent(in) :: node     !! which of them
    integer :: segment              !! 0: a decision is needed
    integer :: before, behind       !! the two, on the way along the slave segment
    real(wp) :: part
    type(sight_t) :: sight

    segment = 0
    if (contact%master%n_segment <= short_chain + 2) return
    before = memory%slave_tracking%segment(node)
    behind = before
    associate (xi => memory%slave_tracking%xi(node))
      if (.not. abs(xi) > 0.0_wp) behind = contact%master%previous(behind)
      if (.not. abs(xi - 1.0_wp) > 0.0_wp) before = contact%master%next(before)
    end associate
    if (before == behind .or. min(before, behind) == 0) return
    sight = sight_of_segment(memory%places(:, memory%n_slave &
      + contact%master%segments(1, before)), memory%places(:, one), memory%places(:, two))
    part = sight%along/sight%square
    if (node == two) part = 1.0_wp - part
    if (abs(part) > well_inside .and. abs(part) < 1.0_wp) &
      segment = merge(before, behind, (part > 0.0_wp) .eqv. node == one)
  end function segment_at_node

  !> Whether a foot is between the ends of its segment.
  pure function is_inside(xi)
    real(wp), intent(in) :: xi
    logical :: is_inside

    is_inside = min(xi, 1.0_wp - xi) > 0.0_wp
  end function is_inside

end module contact_plain_ends_m
