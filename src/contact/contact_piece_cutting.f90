! SPDX-License-Identifier: MIT
!> Projections of master segments on slave segments, a list of pieces at a time: the arithmetic of
!> contact_plain_cover.
module contact_piece_cutting_m
  use contact_overlap_m, only : face_on
  use contact_plain_foot_m, only : well_inside
  use kinds_m, only : wp
  implicit none
  private
  public :: see_pieces, cut_pieces, order_pieces, n_room

  !> Most pieces of a list.
  integer, parameter :: n_room = 64

contains

  !> Vectors of the pieces.
  pure subroutine see_pieces(n, ends, master, segments, n_slave, places, nodes, own, other, way)
    integer, intent(in) :: n, ends(2, *), master(*), segments(2, *)
    integer, intent(in) :: n_slave !! local number before the first master node
    real(wp), intent(in) :: places(4, *)
    integer, intent(inout) :: nodes(2, *)
    real(wp), dimension(2, n_room), intent(inout) :: own, other, way
    real(wp), dimension(4) :: along_slave, along_master, across
    integer :: k, a, b

    !GCC$ NOVECTOR
    do k = 1, n
      a = n_slave + segments(1, master(k))
      b = n_slave + segments(2, master(k))
      nodes(1, k) = a
      nodes(2, k) = b
      along_slave = places(:, ends(2, k)) - places(:, ends(1, k))
      along_master = places(:, b) - places(:, a)
      across = places(:, ends(1, k)) - places(:, a)
      own(:, k) = along_slave(1:2) + along_slave(3:4)
      other(:, k) = along_master(1:2) + along_master(3:4)
      way(:, k) = across(1:2) + across(3:4)
    end do
  end subroutine see_pieces

  !> Projections of the pieces' master nodes on the slave segments.
  pure subroutine cut_pieces(n, own, other, way, length, inverse, high, gap, facing)
    integer, intent(in) :: n
    real(wp), dimension(2, n_room), intent(in) :: own, other, way
    real(wp), dimension(n_room), intent(inout) :: length, inverse, high, gap, facing
    real(wp) :: square, product
    integer :: k

    do k = 1, n
      square = max(own(1, k)*own(1, k) + own(2, k)*own(2, k), tiny(1.0_wp))
      product = own(1, k)*other(1, k) + own(2, k)*other(2, k)
      ! A number, since a loop that keeps logicals is not vectorized.
      facing(k) = min(-product, product*product - face_on**2*(square &
        *(other(1, k)*other(1, k) + other(2, k)*other(2, k))))
      inverse(k) = 1.0_wp/sqrt(square)
      length(k) = square*inverse(k)
      high(k) = -(way(1, k)*own(1, k) + way(2, k)*own(2, k))*(inverse(k)*inverse(k))
      gap(k) = (way(2, k)*own(1, k) - way(1, k)*own(2, k))*inverse(k)
    end do
  end subroutine cut_pieces

  !> Where the pieces start and end, and which of them are odd: not one behind the other, or not
  !> facing the slave segment entirely. All at once: segment by segment it took a tenth of the
  !> pairing.
  pure subroutine order_pieces(n, facing, is_end, low, high, odd, n_odd)
    integer, intent(in) :: n
    real(wp), dimension(n_room), intent(in) :: facing, is_end
    real(wp), dimension(n_room), intent(inout) :: low, high
    real(wp), intent(inout) :: odd(n_room) !! 1, else 0
    integer, intent(out) :: n_odd          !! their sum
    real(wp) :: total
    integer :: k

    low(1) = 0.0_wp
    do k = 1, n - 1
      low(k + 1) = merge(0.0_wp, high(k), is_end(k) > 0.0_wp)
    end do
    total = 0.0_wp
    !$omp simd reduction(+: total)
    do k = 1, n
      high(k) = merge(1.0_wp, high(k), is_end(k) > 0.0_wp)
      odd(k) = merge(0.0_wp, 1.0_wp, facing(k) > 0.0_wp .and. (is_end(k) > 0.0_wp .or. &
        (high(k) > low(k) + well_inside .and. high(k) < 1.0_wp - well_inside)))
      total = total + odd(k)
    end do
    n_odd = nint(total)
  end subroutine order_pieces

end module contact_piece_cutting_m
