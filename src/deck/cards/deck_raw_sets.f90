! SPDX-License-Identifier: MIT
!> Sets as the cards give them, by user ids, and lists that grow.
module deck_raw_sets_m
  implicit none
  private
  public :: raw_set_t, append_set, append_member, lengthen, add_all, add_nodes, add_parts, &
    of_part, of_part_set

  !> What a row of a general node set does with its members; with a minus it takes them out.
  integer, parameter :: add_all = 1, add_nodes = 2, add_parts = 3
  !> Whose boundary a segment set is: that of a part, or of a part set.
  integer, parameter :: of_part = 1, of_part_set = 2

  !> One set: user ids, and of each the line and field it stands in. In a generated set
  !> they come as pairs first, last. In a segment set they come as pairs of nodes.
  type :: raw_set_t
    integer :: id = 0
    character(:), allocatable :: title
    integer :: line = 0
    logical :: generate = .false.
    logical :: damaged = .false.        !! some of its cards were refused
    integer :: n = 0
    logical :: of_beams = .false.       !! from beams of a mesh, not from a card of sets
    integer :: boundary = 0             !! of a segment set: `of_part`, `of_part_set`, or its edges
    integer, allocatable :: members(:), lines(:), fields(:)
    integer, allocatable :: actions(:)  !! of general node sets alone: `add_all` and so on
  end type raw_set_t

contains

  !> One more set in a list.
  subroutine append_set(sets, n, set)
    type(raw_set_t), allocatable, intent(inout) :: sets(:)
    integer, intent(inout) :: n
    type(raw_set_t), intent(inout) :: set   !! its members move into the list
    type(raw_set_t), allocatable :: longer(:)
    integer :: i

    if (n == size(sets)) then
      allocate (longer(2*n))
      do i = 1, n
        call move_set(sets(i), longer(i))
      end do
      call move_alloc(longer, sets)
    end if
    n = n + 1
    call move_set(set, sets(n))
  end subroutine append_set

  !> Move a set without copying its members.
  subroutine move_set(from, to)
    type(raw_set_t), intent(inout) :: from
    type(raw_set_t), intent(inout) :: to

    to%id = from%id
    to%line = from%line
    to%generate = from%generate
    to%damaged = from%damaged
    to%of_beams = from%of_beams
    to%boundary = from%boundary
    to%n = from%n
    if (allocated(from%title)) call move_alloc(from%title, to%title)
    if (.not. allocated(from%members)) return
    call move_alloc(from%members, to%members)
    call move_alloc(from%lines, to%lines)
    call move_alloc(from%fields, to%fields)
    if (allocated(from%actions)) call move_alloc(from%actions, to%actions)
  end subroutine move_set

  !> One more member of a set.
  subroutine append_member(set, member, line, field, action)
    type(raw_set_t), intent(inout) :: set
    integer, intent(in) :: member, line, field
    integer, intent(in), optional :: action !! of all members of a set or of none

    if (.not. allocated(set%members)) allocate (set%members(64), set%lines(64), set%fields(64))
    if (set%n == size(set%members)) then
      call lengthen(set%members, 2*set%n)
      call lengthen(set%lines, 2*set%n)
      call lengthen(set%fields, 2*set%n)
      if (present(action)) call lengthen(set%actions, 2*set%n)
    end if
    if (present(action)) then
      if (.not. allocated(set%actions)) allocate (set%actions(size(set%members)))
      set%actions(set%n + 1) = action
    end if
    set%n = set%n + 1
    set%members(set%n) = member
    set%lines(set%n) = line
    set%fields(set%n) = field
  end subroutine append_member

  !> Give a list more room.
  subroutine lengthen(list, n)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: n
    integer, allocatable :: longer(:)

    allocate (longer(n))
    longer(:size(list)) = list
    call move_alloc(longer, list)
  end subroutine lengthen

end module deck_raw_sets_m
