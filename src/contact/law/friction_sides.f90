! SPDX-License-Identifier: MIT
!> Both sides of spots between nodes, from the list of points and from the tracking.
module friction_sides_m
  use contact_state_m, only : n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: sides_t, find_portions, take_portions, take_feet, n_block

  !> Places whose tractions are formed together.
  integer, parameter :: n_block = 64

  !> Without default values, which would be written before each use.
  type :: sides_t
    integer, dimension(n_side, n_block) :: slave_nodes, master_nodes
    real(wp), dimension(n_side, n_block) :: slave_weights, master_weights
    real(wp) :: normal(2, n_block), gap(n_block) !! m
  end type sides_t

contains

  !> Where the portions of some spots begin on the list: another spot has another node or stands
  !> elsewhere on its segment.
  pure subroutine find_portions(n, n_point, slave_nodes, slave_weights, portions)
    integer, intent(in) :: n, n_point, slave_nodes(n_side, n_point)
    real(wp), intent(in) :: slave_weights(n_side, n_point)
    integer, intent(inout) :: portions(n + 1) !! in: (1)
    integer :: k, p

    p = portions(1)
    do k = 1, n
      portions(k) = p
      do p = portions(k) + 1, n_point
        if (slave_nodes(1, p) /= slave_nodes(1, p - 1)) exit
        if (slave_weights(2, p) /= slave_weights(2, p - 1)) exit
      end do
    end do
    portions(n + 1) = p
  end subroutine find_portions

  !> Slave sides, normals and gaps of some spots from their first portions.
  pure subroutine take_portions(n, portions, slave_nodes, slave_weights, normal, gap, sides)
    integer, intent(in) :: n, portions(n), slave_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), normal(2, *), gap(*)
    type(sides_t), intent(inout) :: sides
    integer :: k, p

    !GCC$ NOVECTOR
    do k = 1, n
      p = portions(k)
      sides%slave_nodes(:, k) = slave_nodes(:, p)
      sides%slave_weights(:, k) = slave_weights(:, p)
      sides%normal(:, k) = normal(:, p)
      sides%gap(k) = gap(p)
    end do
  end subroutine take_portions

  !> Master sides of some spots at their feet.
  pure subroutine take_feet(n, touching, segment, xi, segments, n_slave, sides)
    integer, intent(in) :: n, touching(n), segment(*), segments(n_side, *)
    real(wp), intent(in) :: xi(*)
    integer, intent(in) :: n_slave !! local number before the first master node
    type(sides_t), intent(inout) :: sides
    integer :: k

    !GCC$ NOVECTOR
    do k = 1, n
      sides%master_nodes(:, k) = n_slave + segments(:, segment(touching(k)))
      sides%master_weights(1, k) = 1.0_wp - xi(touching(k))
      sides%master_weights(2, k) = xi(touching(k))
    end do
  end subroutine take_feet

end module friction_sides_m
