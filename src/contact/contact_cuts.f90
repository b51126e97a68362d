! SPDX-License-Identifier: MIT
!> Slave segments cut into pieces as type 5 shares them: lengths for the slave nodes, and points at the master nodes
!> between the pieces, written array by array.
module contact_cuts_m
  use contact_admission_m, only : judge_segment
  use contact_plain_cover_m, only : plain_cover_t, note_plain_contact, n_room
  use contact_state_m, only : contact_state_t, make_room, n_side
  use contacts_m, only : contact_t
  use kinds_m, only : wp
  implicit none
  private
  public :: share_ends, list_cuts, add_cuts

contains

  !> Half of the first and of the last piece of each of a run of segments to its ends. The sum at the last end is kept at
  !> hand for the next segment, since a sum in memory has to be stored before it can be read again.
  pure subroutine share_ends(cover, first, last, mark, area)
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: first, last     !! of the list
    integer, intent(in) :: mark(*)         !! point at each slave node, or 0
    real(wp), intent(inout) :: area(*)     !! m
    real(wp) :: total, held
    integer :: i, k, p, at

    at = 0
    held = 0.0_wp
    do i = first, last
      k = cover%last(i - 1) + 1
      p = mark(cover%ends(1, k))
      if (p > 0) then
        total = held
        if (p /= at) total = area(p)
        area(p) = total + 0.5_wp*cover%high(k)*cover%length(k)
      end if
      at = mark(cover%ends(2, k))
      if (at == 0) cycle
      held = area(at) + 0.5_wp*(1.0_wp - cover%low(cover%last(i)))*cover%length(k)
      area(at) = held
    end do
  end subroutine share_ends

  !> List the pieces of some segments that end at a master node in contact, and note which segments of the common case
  !> touch.
  pure subroutine list_cuts(contact, memory, cover, first, last, n, cuts)
    type(contact_t), intent(in) :: contact
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: first, last     !! of the list
    integer, intent(out) :: n
    integer, intent(inout) :: cuts(n_room)
    real(wp) :: deepest, limit
    logical :: counts
    integer :: i, k, n_before

    limit = max(0.0_wp, memory%closed_gap)
    n = 0
    do i = first, last
      n_before = n
      deepest = huge(1.0_wp)
      !GCC$ UNROLL 1
      do k = cover%last(i - 1) + 1, cover%last(i) - 1
        if (cover%gap(k) >= limit) cycle
        deepest = min(deepest, cover%gap(k))
        n = n + 1
        cuts(n) = k
      end do
      if (cover%touches(i)) then
        call note_plain_contact(memory, cover%slave(i), deepest < memory%closed_gap)
        cycle
      end if
      call judge_segment(contact, memory, cover%slave(i), cover%ends(:, cover%last(i)), deepest, counts)
      if (.not. counts) n = n_before
    end do
  end subroutine list_cuts

  !> Points at the master nodes where some pieces end, with the normal of the slave segment and half of the pieces on
  !> either side.
  pure subroutine add_cuts(memory, cover, n, cuts)
    type(contact_state_t), intent(inout) :: memory
    type(plain_cover_t), intent(in) :: cover
    integer, intent(in) :: n, cuts(n_room) !! pieces

    call make_room(memory%points, n)
    associate (points => memory%points, p => memory%points%n + 1)
      call put_sides(n, cuts, cover, points%slave_nodes(1, p), points%slave_weights(1, p), &
        points%master_nodes(1, p), points%master_weights(1, p))
      call put_springs(n, cuts, cover, points%normal(1, p), points%gap(p), points%area(p))
      points%stiffness(p:points%n + n) = memory%slave_penalty
      points%n = points%n + n
    end associate
  end subroutine add_cuts

  !> Both sides of these points.
  pure subroutine put_sides(n, cuts, cover, slave_nodes, slave_weights, master_nodes, master_weights)
    integer, intent(in) :: n, cuts(n)
    type(plain_cover_t), intent(in) :: cover
    integer, intent(inout) :: slave_nodes(n_side, n), master_nodes(n_side, n)
    real(wp), intent(inout) :: slave_weights(n_side, n), master_weights(n_side, n)
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
      master_weights(1, p) = 1.0_wp
      master_weights(2, p) = 0.0_wp
    end do
  end subroutine put_sides

  !> Their normals, gaps (m) and areas (m).
  pure subroutine put_springs(n, cuts, cover, normal, gap, area)
    integer, intent(in) :: n, cuts(n)
    type(plain_cover_t), intent(in) :: cover
    real(wp), intent(inout) :: normal(2, n), gap(n), area(n)
    integer :: p, k

    !GCC$ NOVECTOR
    do p = 1, n
      k = cuts(p)
      normal(1, p) = -cover%own(2, k)*cover%inverse(k)
      normal(2, p) = cover%own(1, k)*cover%inverse(k)
      gap(p) = cover%gap(k)
      area(p) = 0.5_wp*(cover%high(k + 1) - cover%low(k))*cover%length(k)
    end do
  end subroutine put_springs

end module contact_cuts_m
