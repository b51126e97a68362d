! SPDX-License-Identifier: MIT
!> The common case of contact_overlap: both ends of a slave segment are in contact or plainly over the master, a few
!> master segments face it entirely and the nodes between these cut it one after the other. What is found is the
!> same; only the decisions that have no part in this case are left out. (In sliding, the two segments at the
!> edges of the contact and their neighbours took 80 % of the pairing while they went the general way.)
module contact_plain_cover_m
  use contact_overlap_m, only : face_on
  use contact_plain_foot_m, only : see_plain_segment
  use contact_state_m, only : contact_state_t, is_free, is_touching
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment, separation
  use kinds_m, only : wp
  implicit none
  private
  public :: plain_cover_t, find_plain_cover, note_plain_contact

  !> Most pieces of a segment.
  integer, parameter :: n_most = 6

  !> A slave segment cut into pieces. Without default values, which would be written before each use.
  type :: plain_cover_t
    integer :: n_piece             !! 0: this is not the common case
    logical :: touches             !! both ends are in contact
    integer :: ends(2)             !! nodes of the slave segment
    integer :: segments(n_most)    !! (n_piece) of the master
    integer :: nodes(n_most)       !! (n_piece - 1) master node behind each piece but the last
    real(wp) :: cuts(0:n_most)     !! (0:n_piece) 0, projections of these nodes, 1
    real(wp) :: across(n_most)     !! (n_piece - 1) gaps of these nodes times the length
    real(wp) :: t(2)               !! vector of the slave segment, m
    real(wp) :: square             !! its square, m^2
  end type plain_cover_t

contains

  !> Cut a slave segment. Feet on a node, corners, and whatever else needs a decision is left to contact_overlap.
  pure subroutine find_plain_cover(contact, memory, s, cover)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: s !! slave segment
    type(plain_cover_t), intent(out) :: cover
    type(sight_t) :: sight
    real(wp), dimension(4) :: one, two, a !! places of nodes, in registers
    integer :: segment, last, n

    cover%n_piece = 0
    cover%ends = contact%slave%segments(:, s)
    call find_ends(contact, memory, cover%ends, segment, last, cover%touches)
    if (segment == 0 .or. last == 0) return
    ! In a short closed chain the way forwards may be the shorter one.
    if (segment /= last .and. contact%master%n_segment <= 2*n_most) return
    cover%cuts(0) = 0.0_wp
    one = memory%places(:, cover%ends(1))
    two = memory%places(:, cover%ends(2))
    do n = 1, n_most
      cover%segments(n) = segment
      a = memory%places(:, memory%n_slave + contact%master%segments(1, segment))
      sight = sight_of_segment(a, one, two)
      if (.not. faces(sight, separation(memory%places(:, memory%n_slave &
        + contact%master%segments(2, segment)), a))) return
      if (segment == last) exit
      cover%cuts(n) = sight%along/sight%square
      if (.not. (cover%cuts(n) > cover%cuts(n - 1) .and. cover%cuts(n) < 1.0_wp)) return
      cover%nodes(n) = contact%master%segments(1, segment)
      cover%across(n) = sight%across
      segment = contact%master%previous(segment)
      if (segment == 0) return
    end do
    if (n > n_most) return
    cover%cuts(n) = 1.0_wp
    cover%t = sight%t
    cover%square = sight%square
    cover%n_piece = n
  end subroutine find_plain_cover

  !> Master segments below both ends of a slave segment; free ends are looked for from where contact_overlap does.
  pure subroutine find_ends(contact, memory, ends, first, second, touch)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: ends(2)
    integer, intent(out) :: first, second !! 0: a decision is needed
    logical, intent(out) :: touch         !! both ends are in contact
    type(sight_t) :: sight
    logical :: touches(2)
    integer :: start

    associate (tracking => memory%slave_tracking, chain => memory%places(:, memory%n_slave + 1:))
      touches = tracking%status(ends) == is_touching
      touch = all(touches)
      first = tracking%segment(ends(1))
      second = tracking%segment(ends(2))
      if (touches(1) .and. .not. is_inside(tracking%xi(ends(1)))) first = 0
      if (touches(2) .and. .not. is_inside(tracking%xi(ends(2)))) second = 0
      if (touch .or. (touches(1) .and. first == 0) .or. (touches(2) .and. second == 0)) return
      if (.not. touches(1)) then
        start = merge(second, first, touches(2) .or. first == 0)
        if (start == 0) return
        call see_plain_segment(contact%master, chain, memory%places(:, ends(1)), start, first, sight)
      end if
      if (first == 0 .or. touches(2)) return
      start = first
      call see_plain_segment(contact%master, chain, memory%places(:, ends(2)), start, second, sight)
    end associate
  end subroutine find_ends

  !> Whether a foot is between the ends of its segment.
  pure function is_inside(xi)
    real(wp), intent(in) :: xi
    logical :: is_inside

    is_inside = min(xi, 1.0_wp - xi) > 0.0_wp
  end function is_inside

  !> Whether a master segment faces the slave segment entirely.
  pure function faces(sight, t)
    type(sight_t), intent(in) :: sight !! from the slave segment
    real(wp), intent(in) :: t(2)       !! vector of the master segment
    logical :: faces
    real(wp) :: product

    product = sight%t(1)*t(1) + sight%t(2)*t(2)
    faces = product < 0.0_wp .and. product*product >= face_on**2*(sight%square &
      *(t(1)*t(1) + t(2)*t(2)))
  end function faces

  !> What contact_admission notes of a segment with both ends in contact: it stays.
  pure subroutine note_plain_contact(memory, s, is_deep)
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: is_deep !! one of its points counts as closed

    memory%cover%status(s) = merge(is_touching, is_free, is_deep)
    memory%cover%wake(s) = merge(-huge(1.0_wp), memory%travel, is_deep)
  end subroutine note_plain_contact

end module contact_plain_cover_m
