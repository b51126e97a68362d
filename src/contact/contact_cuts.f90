! SPDX-License-Identifier: MIT
!> Slave segments cut into pieces as type 5 shares them: lengths for the slave nodes, and points at
!> the master nodes between the pieces. What a segment needs is done in one pass over a list, the
!> points are then written array by array.
module contact_cuts_m
  use contact_admission_m, only : judge_segment
  use contact_plain_cover_m, only : plain_cover_t, note_plain_contact, n_room
  use contact_state_m, only : contact_points_t, contact_state_t, make_room, n_side
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: share_cuts

  !> Pieces that end at a master node in contact. Without default values, which would be written
  !> before each use.
  type :: cuts_t
    integer :: n
    integer :: piece(n_room) !! on the list
  end type cuts_t

contains

  !> Half of each piece of a run of segments to either of its ends.
  pure subroutine share_cuts(contact, memory, cover, first, last)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: first, last !! of the list
    type(cuts_t) :: cuts
    integer :: i

    cuts%n = 0
    i = first
    do
      call share_touching(cover, last, memory%closed_gap, memory%travel, memory%mark, &
        memory%points%area, memory%cover%status, memory%cover%wake, i, cuts)
      if (i > last) exit
      call share_other(contact, memory, cover, i, cuts)
      i = i + 1
    end do
    if (cuts%n > 0) call add_cuts(memory, cover, cuts%n, cuts%piece)
  end subroutine share_cuts

  !> Segments from i on with both ends in contact: i is then the first of another kind. The sum at
  !> the last end is kept at hand for the next segment, since a sum in memory has to be stored
  !> before it can be read again. On arrays of known shape: through the memory it took 2 % of the
  !> whole contact more.
  pure subroutine share_touching(cover, last, closed_gap, travel, mark, area, status, wake, i, cuts)
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: last                !! of the list
    real(wp), intent(in) :: closed_gap, travel !! m
    integer, intent(in) :: mark(*)             !! point at each slave node
    real(wp), intent(inout) :: area(*)         !! m
    integer, intent(inout) :: status(*)        !! of the slave segments
    real(wp), intent(inout) :: wake(*)         !! m
    integer, intent(inout) :: i
    type(cuts_t), intent(inout) :: cuts
    real(wp) :: held
    integer :: k, p, at, n_before

    at = 0
    held = 0.0_wp
    do while (i <= last)
      if (.not. cover%touches(i)) return
      k = cover%last(i - 1) + 1
      p = mark(cover%ends(1, k))
      if (p /= at) held = area(p)
      area(p) = held + 0.5_wp*cover%high(k)*cover%length(k)
      at = mark(cover%ends(2, k))
      held = area(at) + 0.5_wp*(1.0_wp - cover%low(cover%last(i)))*cover%length(k)
      area(at) = held
      n_before = cuts%n
      call list_cuts(k, cover%last(i) - 1, cover%gap, closed_gap, cuts)
      call note_plain_contact(cuts%n > n_before, travel, status(cover%slave(i)), &
        wake(cover%slave(i)))
      i = i + 1
    end do
  end subroutine share_touching

  !> Any other segment.
  pure subroutine share_other(contact, memory, cover, i, cuts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: i !! on the list
    type(cuts_t), intent(inout) :: cuts
    integer :: k, p, n_before
    logical :: counts

    k = cover%last(i - 1) + 1
    associate (ends => cover%ends(:, k), area => memory%points%area)
      p = memory%mark(ends(1))
      if (p > 0) area(p) = area(p) + 0.5_wp*cover%high(k)*cover%length(k)
      p = memory%mark(ends(2))
      if (p > 0) area(p) = area(p) + 0.5_wp*(1.0_wp - cover%low(cover%last(i)))*cover%length(k)
      n_before = cuts%n
      call list_cuts(k, cover%last(i) - 1, cover%gap, memory%closed_gap, cuts)
      call judge_segment(contact, memory, cover%slave(i), ends, &
        minval(cover%gap(cuts%piece(n_before + 1:cuts%n))), counts)
    end associate
    if (.not. counts) cuts%n = n_before
  end subroutine share_other

  !> List those of some pieces that end at a master node in contact, without a decision at each.
  pure subroutine list_cuts(first, last, gap, closed_gap, cuts)
    integer, intent(in) :: first, last
    real(wp), intent(in) :: gap(n_room), closed_gap !! m
    type(cuts_t), intent(inout) :: cuts
    integer :: k

    !GCC$ UNROLL 1
    do k = first, last
      cuts%piece(cuts%n + 1) = k
      cuts%n = cuts%n + merge(1, 0, gap(k) < closed_gap)
    end do
  end subroutine list_cuts

  !> Points at the master nodes where some pieces end, with the normal of the slave segment and half
  !> of the pieces on either side.
  pure subroutine add_cuts(memory, cover, n, cuts)
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: n, cuts(n_room) !! pieces

    call make_room(memory%points, n)
    associate (points => memory%points, p => memory%points%n + 1)
      call put_cuts(n, cuts, cover, points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%normal(1, p), points%gap(p), points%area(p))
      call put_constants(p, points%n + n, memory%slave_penalty, points)
      points%n = points%n + n
    end associate
  end subroutine add_cuts

  !> What is the same for all cuts: not written again where a cut stood at the placement before.
  pure subroutine put_constants(first, last, stiffness, points)
    integer, intent(in) :: first, last
    real(wp), intent(in) :: stiffness
    type(contact_points_t), intent(inout) :: points
    integer :: p

    do p = max(first, points%n_former + 1), last
      points%master_weights(1, p) = 1.0_wp
      points%master_weights(2, p) = 0.0_wp
      points%stiffness(p) = stiffness
    end do
  end subroutine put_constants

  !> The rest on arrays of known shape.
  pure subroutine put_cuts(n, cuts, cover, slave_nodes, slave_weights, master_nodes, normal, gap, &
      area)
    integer, intent(in) :: n, cuts(n)
    type(plain_cover_t), intent(in) :: cover
    integer, intent(inout) :: slave_nodes(n_side, n), master_nodes(n_side, n)
    real(wp), intent(inout) :: slave_weights(n_side, n), normal(2, n)
    real(wp), intent(inout) :: gap(n), area(n) !! m
    integer :: p, k

    !GCC$ NOVECTOR
    do p = 1, n
      k = cuts(p)
      slave_nodes(1, p) = cover%ends(1, k)
      slave_nodes(2, p) = cover%ends(2, k)
      slave_weights(1, p) = 1.0_wp - cover%high(k)
      slave_weights(2, p) = cover%high(k)
      master_nodes(1, p) = cover%nodes(1, k)
      master_nodes(2, p) = cover%nodes(1, k)
      normal(1, p) = -cover%own(2, k)*cover%inverse(k)
      normal(2, p) = cover%own(1, k)*cover%inverse(k)
      gap(p) = cover%gap(k)
      area(p) = 0.5_wp*(cover%high(k + 1) - cover%low(k))*cover%length(k)
    end do
  end subroutine put_cuts

end module contact_cuts_m
