! SPDX-License-Identifier: MIT
!> The overlap of a slave segment with a master segment, and which one is left where those with
!> different bodies lie over each other (doc/theory/contact.md, section 3.5).
module overlap_m
  use kinds_m, only : wp
  implicit none
  private
  public :: overlap_t, gap_at, order_overlaps

  !> One overlap. Without default values, which would be written before each use.
  type :: overlap_t
    integer :: master        !! segment; 0: none
    real(wp) :: low, high    !! range of the slave segment, 0 to 1; not above `low`: empty
    integer :: first, last   !! master nodes at its breakpoints, 0: a slave node
    real(wp) :: gap(2)       !! of the master segment at both ends of the slave segment, m
    real(wp) :: share        !! how much of it counts: 0 where the segments are not opposed
    real(wp) :: part         !! how much of it the sides at vertices leave; in `share` too
  end type overlap_t

contains

  !> Order overlaps along the slave segment; of those that lie over each other the nearest
  !> penetrated one wins.
  pure subroutine order_overlaps(overlaps, n)
    type(overlap_t), intent(inout) :: overlaps(:) !! with room for twice as many
    integer, intent(inout) :: n

    call sort_overlaps(overlaps(:n))
    if (any(overlaps(2:n)%low < overlaps(:n - 1)%high)) call resolve_overlaps(overlaps, n)
  end subroutine order_overlaps

  !> Gap of the master segment over the slave segment at a local coordinate of that, m.
  pure function gap_at(overlap, xi) result(gap)
    type(overlap_t), intent(in) :: overlap
    real(wp), intent(in) :: xi
    real(wp) :: gap

    gap = (1.0_wp - xi)*overlap%gap(1) + xi*overlap%gap(2)
  end function gap_at

  !> Order overlaps along the slave segment.
  pure subroutine sort_overlaps(overlaps)
    type(overlap_t), intent(inout) :: overlaps(:)
    type(overlap_t) :: next
    integer :: i, k

    do i = 2, size(overlaps)
      next = overlaps(i)
      k = i - 1
      do while (k >= 1)
        if (overlaps(k)%low <= next%low) exit
        overlaps(k + 1) = overlaps(k)
        k = k - 1
      end do
      overlaps(k + 1) = next
    end do
  end subroutine sort_overlaps

  !> Split overlaps that lie over each other: between any two breakpoints one is left.
  pure subroutine resolve_overlaps(overlaps, n)
    type(overlap_t), intent(inout) :: overlaps(:) !! with room for twice as many
    integer, intent(inout) :: n
    type(overlap_t) :: previous(n)
    real(wp) :: points(2*n), low, high
    integer :: nodes(2*n), i, winner, n_previous

    n_previous = n
    previous = overlaps(:n)
    call list_breakpoints(previous, points, nodes)
    n = 0
    do i = 1, 2*n_previous - 1
      low = points(i)
      high = points(i + 1)
      if (.not. high > low) cycle
      winner = nearest_penetrated(previous, low, high)
      if (winner == 0) cycle
      if (n > 0) then
        if (overlaps(n)%master == previous(winner)%master .and. .not. low > overlaps(n)%high) then
          overlaps(n)%high = high
          overlaps(n)%last = nodes(i + 1)
          cycle
        end if
      end if
      n = n + 1
      overlaps(n) = previous(winner)
      overlaps(n)%low = low
      overlaps(n)%high = high
      overlaps(n)%first = nodes(i)
      overlaps(n)%last = nodes(i + 1)
    end do
  end subroutine resolve_overlaps

  !> All breakpoints in order, with the master nodes that stand there.
  pure subroutine list_breakpoints(overlaps, points, nodes)
    type(overlap_t), intent(in) :: overlaps(:)
    real(wp), intent(out) :: points(2*size(overlaps))
    integer, intent(out) :: nodes(2*size(overlaps))
    real(wp) :: point
    integer :: i, k, node

    do i = 1, 2*size(overlaps)
      associate (overlap => overlaps((i + 1)/2))
        point = merge(overlap%low, overlap%high, modulo(i, 2) == 1)
        node = merge(overlap%first, overlap%last, modulo(i, 2) == 1)
      end associate
      k = i - 1
      do while (k >= 1)
        if (points(k) <= point) exit
        points(k + 1) = points(k)
        nodes(k + 1) = nodes(k)
        k = k - 1
      end do
      points(k + 1) = point
      nodes(k + 1) = node
    end do
  end subroutine list_breakpoints

  !> Of the overlaps that cover a stretch the nearest that is penetrated, or the nearest if none is.
  pure function nearest_penetrated(overlaps, low, high) result(nearest)
    type(overlap_t), intent(in) :: overlaps(:)
    real(wp), intent(in) :: low, high
    integer :: nearest
    real(wp) :: gap, best
    integer :: k

    nearest = 0
    best = 0.0_wp
    do k = 1, size(overlaps)
      if (overlaps(k)%low > low .or. overlaps(k)%high < high) cycle
      gap = gap_at(overlaps(k), 0.5_wp*(low + high))
      if (nearest > 0) then
        if (gap < 0.0_wp .and. best < 0.0_wp) then
          if (gap <= best) cycle
        else if (gap >= best) then
          cycle
        end if
      end if
      nearest = k
      best = gap
    end do
  end function nearest_penetrated

end module overlap_m
