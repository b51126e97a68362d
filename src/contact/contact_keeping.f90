! SPDX-License-Identifier: MIT
!> Spots that stay in contact where they are: the common case of the search, many spots at a time.
module contact_keeping_m
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
  pure subroutine keep_contacts(touching, segment, ends, chain, spots, xi, gap, normal, is_kept)
    integer, intent(in), contiguous :: touching(:) !! spots that touched after the last step
    integer, intent(in), contiguous :: segment(:)
    integer, intent(in) :: ends(2, *)
    real(wp), intent(in) :: chain(4, *), spots(4, *)
    real(wp), intent(inout) :: xi(*), gap(*), normal(2, *)
    logical, intent(inout), contiguous :: is_kept(:)
    real(wp), dimension(block_size) :: t_x, t_y, d_x, d_y, along, across, beside
    real(wp), dimension(4) :: edge, way
    integer :: first, n, i, k, a, b

    do first = 1, size(touching), block_size
      n = min(block_size, size(touching) - first + 1)
      !GCC$ NOVECTOR
      do k = 1, n
        i = touching(first + k - 1)
        a = ends(1, segment(i))
        b = ends(2, segment(i))
        edge = chain(:, b) - chain(:, a)
        way = spots(:, i) - chain(:, a)
        t_x(k) = edge(1) + edge(3)
        t_y(k) = edge(2) + edge(4)
        d_x(k) = way(1) + way(3)
        d_y(k) = way(2) + way(4)
      end do
      call project_block(n, t_x, t_y, d_x, d_y, along, across, beside)
      do k = 1, n
        if (beside(k) > 0.0_wp) cycle
        i = touching(first + k - 1)
        is_kept(i) = .true.
        xi(i) = along(k)
        gap(i) = across(k)
        normal(1, i) = t_y(k)
        normal(2, i) = -t_x(k)
      end do
    end do
  end subroutine keep_contacts

  !> Projections of a block. A loop that stores logicals is not vectorised, so that the answer is a real.
  pure subroutine project_block(n, t_x, t_y, d_x, d_y, xi, gap, beside)
    integer, intent(in) :: n
    real(wp), intent(inout) :: t_x(block_size), t_y(block_size) !! in: segments, m; out: unit tangents
    real(wp), intent(in) :: d_x(block_size), d_y(block_size)    !! from the segments' first nodes, m
    real(wp), intent(out) :: xi(block_size), gap(block_size)
    real(wp), intent(out) :: beside(block_size) !! 0: behind the segment, and not nearer to a neighbour; else 1
    real(wp) :: square, along, across, inverse
    integer :: k

    !$omp simd
    do k = 1, n
      square = max(t_x(k)*t_x(k) + t_y(k)*t_y(k), tiny(1.0_wp))
      along = d_x(k)*t_x(k) + d_y(k)*t_y(k)
      across = d_x(k)*t_y(k) - d_y(k)*t_x(k)
      beside(k) = merge(0.0_wp, 1.0_wp, across < 0.0_wp .and. across + along >= 0.0_wp &
        .and. across + square >= along)
      inverse = 1.0_wp/sqrt(square)
      xi(k) = along*(inverse*inverse)
      gap(k) = across*inverse
      t_x(k) = t_x(k)*inverse
      t_y(k) = t_y(k)*inverse
    end do
  end subroutine project_block

end module contact_keeping_m
