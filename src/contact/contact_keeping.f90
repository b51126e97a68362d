! SPDX-License-Identifier: MIT
!> Spots that stay in contact where they are: the common case of the search, many spots at a time.
module contact_keeping_m
  use kinds_m, only : wp
  implicit none
  private
  public :: keep_contacts, list_kept, n_together

  !> Spots projected together.
  integer, parameter :: block_size = 64
  !> Spots listed together.
  integer, parameter :: n_together = 16

contains

  !> Keep spots i + 1 .. i + n_together on the list of those in contact.
  pure subroutine list_kept(touching, is_kept, i, n_touching)
    integer, intent(inout), contiguous :: touching(:)
    logical, intent(inout), contiguous :: is_kept(:)
    integer, intent(inout) :: i, n_touching
    integer :: k

    do k = 1, n_together
      touching(n_touching + k) = i + k
      is_kept(i + k) = .false.
    end do
    i = i + n_together
    n_touching = n_touching + n_together
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
    real(wp), dimension(block_size) :: tx, ty, dx, dy, along, across
    logical :: kept(block_size)
    integer :: first, n, i, k, a, b

    do first = 1, size(touching), block_size
      n = min(block_size, size(touching) - first + 1)
      !GCC$ NOVECTOR
      do k = 1, n
        i = touching(first + k - 1)
        a = ends(1, segment(i))
        b = ends(2, segment(i))
        tx(k) = (chain(1, b) - chain(1, a)) + (chain(3, b) - chain(3, a))
        ty(k) = (chain(2, b) - chain(2, a)) + (chain(4, b) - chain(4, a))
        dx(k) = (spots(1, i) - chain(1, a)) + (spots(3, i) - chain(3, a))
        dy(k) = (spots(2, i) - chain(2, a)) + (spots(4, i) - chain(4, a))
      end do
      call project_block(n, tx, ty, dx, dy, along, across, kept)
      do k = 1, n
        if (.not. kept(k)) cycle
        i = touching(first + k - 1)
        is_kept(i) = .true.
        xi(i) = along(k)
        gap(i) = across(k)
        normal(1, i) = ty(k)
        normal(2, i) = -tx(k)
      end do
    end do
  end subroutine keep_contacts

  !> Projections of a block.
  pure subroutine project_block(n, tx, ty, dx, dy, xi, gap, kept)
    integer, intent(in) :: n
    real(wp), intent(inout) :: tx(block_size), ty(block_size) !! in: segments, m; out: unit tangents
    real(wp), intent(in) :: dx(block_size), dy(block_size)    !! from the segments' first nodes, m
    real(wp), intent(out) :: xi(block_size), gap(block_size)
    logical, intent(out) :: kept(block_size) !! behind the segment, and not nearer to a neighbour
    real(wp) :: square, along, across, inverse
    integer :: k

    do k = 1, n
      square = max(tx(k)*tx(k) + ty(k)*ty(k), tiny(1.0_wp))
      along = dx(k)*tx(k) + dy(k)*ty(k)
      across = dx(k)*ty(k) - dy(k)*tx(k)
      kept(k) = across < 0.0_wp .and. across + along >= 0.0_wp .and. across + square >= along
      inverse = 1.0_wp/sqrt(square)
      xi(k) = along*(inverse*inverse)
      gap(k) = across*inverse
      tx(k) = tx(k)*inverse
      ty(k) = ty(k)*inverse
    end do
  end subroutine project_block

end module contact_keeping_m
