! SPDX-License-Identifier: MIT
!> Spots that stay in contact where they are: the common case of the search, many spots at a time.
module contact_keeping_m
  use contact_state_m, only : tracking_t
  use kinds_m, only : wp
  implicit none
  private
  public :: keep_contacts, list_kept

  !> Spots projected together.
  integer, parameter :: block_size = 64

contains

  !> Put the spots kept from i + 1 to the first one that is not on the list of those in contact; i is then the last one.
  pure subroutine list_kept(n, is_kept, i, touching, n_touching)
    integer, intent(in) :: n              !! spots
    logical, intent(inout) :: is_kept(n)
    integer, intent(inout) :: i, touching(n), n_touching
    integer :: k, first

    first = i
    do while (i < n)
      if (.not. is_kept(i + 1)) exit
      i = i + 1
    end do
    do k = first + 1, i
      touching(n_touching + (k - first)) = k
    end do
    is_kept(first + 1:i) = .false.
    n_touching = n_touching + (i - first)
  end subroutine list_kept

  !> The common case of spots in contact: still over their segment, behind it, and no nearer to a
  !> neighbour than to it. Of others nothing is changed. In blocks, so that the roots and quotients
  !> of a block are formed together.
  pure subroutine keep_contacts(ends, chain, spots, tracking, n_kept)
    integer, intent(in) :: ends(2, *) !! of the segments of the chain
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    type(tracking_t), intent(inout) :: tracking
    integer, intent(out) :: n_kept
    real(wp) :: edge(2, block_size), way(2, block_size)
    real(wp), dimension(block_size) :: t_x, t_y, along, across, beside
    integer :: first, n, i, k, n_beside

    n_kept = tracking%n_touching
    do first = 1, tracking%n_touching, block_size
      n = min(block_size, tracking%n_touching - first + 1)
      call see_block(n, tracking%touching(first), tracking%segment, ends, chain, spots, edge, way)
      call project_block(n, edge, way, t_x, t_y, along, across, beside, n_beside)
      n_kept = n_kept - n_beside
      i = tracking%touching(first)
      if (n_beside == 0 .and. tracking%touching(first + n - 1) == i + n - 1) then
        call keep_run(n, t_x, t_y, along, across, tracking%xi(i), tracking%gap(i), tracking%normal(1, i), &
          tracking%is_kept(i))
        cycle
      end if
      do k = 1, n
        if (beside(k) > 0.0_wp) cycle
        i = tracking%touching(first + k - 1)
        tracking%is_kept(i) = .true.
        tracking%xi(i) = along(k)
        tracking%gap(i) = across(k)
        tracking%normal(1, i) = t_y(k)
        tracking%normal(2, i) = -t_x(k)
      end do
    end do
  end subroutine keep_contacts

  !> Vectors of a block of spots.
  pure subroutine see_block(n, touching, segment, ends, chain, spots, edge, way)
    integer, intent(in) :: n, touching(n), segment(*), ends(2, *)
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    real(wp), intent(inout) :: edge(2, block_size) !! segments, m
    real(wp), intent(inout) :: way(2, block_size)  !! from the segments' first nodes, m
    real(wp), dimension(4) :: along, across
    integer :: i, k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      i = touching(k)
      a = ends(1, segment(i))
      b = ends(2, segment(i))
      along = chain(:, b) - chain(:, a)
      across = spots(:, i) - chain(:, a)
      edge(:, k) = along(1:2) + along(3:4)
      way(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine see_block

  !> Projections of a block. A loop that stores logicals is not vectorised, so that the answer is a real.
  pure subroutine project_block(n, edge, way, t_x, t_y, xi, gap, beside, n_beside)
    integer, intent(in) :: n
    real(wp), intent(in) :: edge(2, block_size), way(2, block_size)
    real(wp), intent(inout) :: t_x(block_size), t_y(block_size) !! unit tangents
    real(wp), intent(inout) :: xi(block_size), gap(block_size)
    real(wp), intent(inout) :: beside(block_size) !! 0: behind the segment, and not nearer to a neighbour; else 1
    integer, intent(out) :: n_beside              !! sum of these
    real(wp) :: square, along, across, inverse, total
    integer :: k

    total = 0.0_wp
    !$omp simd reduction(+: total)
    do k = 1, n
      square = max(edge(1, k)*edge(1, k) + edge(2, k)*edge(2, k), tiny(1.0_wp))
      along = way(1, k)*edge(1, k) + way(2, k)*edge(2, k)
      across = way(1, k)*edge(2, k) - way(2, k)*edge(1, k)
      beside(k) = merge(0.0_wp, 1.0_wp, across < 0.0_wp .and. across + along >= 0.0_wp &
        .and. across + square >= along)
      total = total + beside(k)
      inverse = 1.0_wp/sqrt(square)
      xi(k) = along*(inverse*inverse)
      gap(k) = across*inverse
      t_x(k) = edge(1, k)*inverse
      t_y(k) = edge(2, k)*inverse
    end do
    n_beside = nint(total)
  end subroutine project_block

  !> Keep a block of spots that follow each other.
  pure subroutine keep_run(n, t_x, t_y, along, across, xi, gap, normal, is_kept)
    integer, intent(in) :: n
    real(wp), intent(in), dimension(n) :: t_x, t_y, along, across
    real(wp), intent(inout) :: xi(n), gap(n), normal(2, n)
    logical, intent(inout) :: is_kept(n)
    integer :: k

    do k = 1, n
      xi(k) = along(k)
      gap(k) = across(k)
      normal(1, k) = t_y(k)
      normal(2, k) = -t_x(k)
      is_kept(k) = .true.
    end do
  end subroutine keep_run

end module contact_keeping_m
