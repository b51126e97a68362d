! SPDX-License-Identifier: MIT
!> The common case of contact_overlap: both ends of a slave segment are in contact, a few master segments face it
!> entirely and the nodes between these cut it one after the other. What is found is the same; only
!> the decisions that have no part in this case are left out.
module contact_plain_cover_m
  use contact_overlap_m, only : face_on
  use contact_state_m, only : contact_state_t, is_free, is_touching
  use contacts_m, only : contact_t
  use geometry_m, only : sight_t, sight_of_segment
  use kinds_m, only : wp
  implicit none
  private
  public :: plain_cover_t, find_plain_cover, note_plain_contact

  !> Most pieces of a segment.
  integer, parameter :: n_most = 6

  !> A slave segment cut into pieces. Without default values, which would be written before each use.
  type :: plain_cover_t
    integer :: n_piece             !! 0: this is not the common case
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
    integer :: segment, last, n

    cover%n_piece = 0
    cover%ends = contact%slave%segments(:, s)
    associate (tracking => memory%slave_tracking, a => cover%ends(1), b => cover%ends(2))
      if (tracking%status(a) /= is_touching .or. tracking%status(b) /= is_touching) return
      if (min(tracking%xi(a), 1.0_wp - tracking%xi(a), tracking%xi(b), 1.0_wp - tracking%xi(b)) &
        <= 0.0_wp) return
      segment = tracking%segment(a)
      last = tracking%segment(b)
    end associate
    ! In a short closed chain the way forwards may be the shorter one.
    if (segment /= last .and. contact%master%n_segment <= 2*n_most) return
    cover%cuts(0) = 0.0_wp
    do n = 1, n_most
      cover%segments(n) = segment
      sight = sight_of_segment(memory%places(:, memory%n_slave + contact%master%segments(1, segment)), &
        memory%places(:, cover%ends(1)), memory%places(:, cover%ends(2)))
      if (.not. faces(contact, memory, segment, sight)) return
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

  !> Whether a master segment faces the slave segment entirely.
  pure function faces(contact, memory, segment, sight)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(in) :: memory
    integer, intent(in) :: segment       !! of the master
    type(sight_t), intent(in) :: sight   !! of its first node from the slave segment
    logical :: faces
    real(wp) :: t(2), product

    associate (a => memory%places(:, memory%n_slave + contact%master%segments(1, segment)), &
      b => memory%places(:, memory%n_slave + contact%master%segments(2, segment)))
      t(1) = (b(1) - a(1)) + (b(3) - a(3))
      t(2) = (b(2) - a(2)) + (b(4) - a(4))
    end associate
    product = sight%t(1)*t(1) + sight%t(2)*t(2)
    faces = product < 0.0_wp .and. product*product >= face_on**2*(sight%square &
      *(t(1)*t(1) + t(2)*t(2)))
  end function faces

  !> What contact_admission notes of such a segment: it stays in contact, since its ends are.
  pure subroutine note_plain_contact(memory, s, is_deep)
    type(contact_state_t), intent(inout) :: memory
    integer, intent(in) :: s
    logical, intent(in) :: is_deep !! one of its points counts as closed

    memory%cover%status(s) = merge(is_touching, is_free, is_deep)
    memory%cover%wake(s) = merge(-huge(1.0_wp), memory%travel, is_deep)
  end subroutine note_plain_contact

end module contact_plain_cover_m
