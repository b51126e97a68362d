! SPDX-License-Identifier: MIT
!> Slip of places in a step (doc/theory/contact.md, section 6.2).
module friction_slips_m
  use contact_state_m, only : n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: find_slips

  !> Places whose slips are formed together.
  integer, parameter :: n_block = 64

contains

  !> Slips of a step of the slave sides of places over their master sides, along t = (-n_y, n_x), m:
  !> the motion of the foot over the segment that has the normal, L d(xi)
  !> (doc/theory/contact.md, section 6.2). Its second term takes off what the turn of that segment
  !> moves at a distance; without it a rotation of all would slip.
  pure subroutine find_slips(n, slave_nodes, slave_weights, master_nodes, master_weights, normal, &
      gap, du, places, slip)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: normal(2, *), gap(*)
    real(wp), intent(in) :: du(2, *)      !! increments of the nodes, m
    real(wp), intent(in) :: places(4, *)  !! of the nodes
    real(wp), intent(inout) :: slip(*)
    real(wp), dimension(2, n_block) :: relative, t, change
    integer :: first, m, p

    do first = 1, n, n_block
      m = min(n_block, n - first + 1)
      call take_motions(m, slave_nodes(1, first), slave_weights(1, first), master_nodes(1, first), &
        master_weights(1, first), du, places, relative, t, change)
      !$omp simd
      do p = 1, m
        slip(first + p - 1) = normal(1, first + p - 1)*relative(2, p) &
          - normal(2, first + p - 1)*relative(1, p) + gap(first + p - 1)*(t(2, p)*change(1, p) &
          - t(1, p)*change(2, p))/max(t(1, p)*t(1, p) + t(2, p)*t(2, p), tiny(1.0_wp))
      end do
    end do
  end subroutine find_slips

  !> Motions of the slave sides of some places relative to their master sides; vectors of their
  !> segments and what these have changed by. That segment is the master's, or the slave's where the
  !> master side is one node.
  pure subroutine take_motions(n, slave_nodes, slave_weights, master_nodes, master_weights, du, &
      places, relative, t, change)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: du(2, *), places(4, *)
    real(wp), intent(inout), dimension(2, *) :: relative, t, change
    real(wp) :: along(4)
    integer :: p, a, b, c, d

    !GCC$ NOVECTOR
    do p = 1, n
      a = slave_nodes(1, p)
      b = slave_nodes(2, p)
      c = master_nodes(1, p)
      d = master_nodes(2, p)
      relative(:, p) = slave_weights(1, p)*du(:, a) + slave_weights(2, p)*du(:, b) &
        - master_weights(1, p)*du(:, c) - master_weights(2, p)*du(:, d)
      if (c == d) then
        c = a
        d = b
      end if
      along = places(:, d) - places(:, c)
      t(:, p) = along(1:2) + along(3:4)
      change(:, p) = du(:, d) - du(:, c)
    end do
  end subroutine take_motions

end module friction_slips_m
