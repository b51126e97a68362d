! SPDX-License-Identifier: MIT
!> Slip of places in a step (doc/theory/contact.md, section 6.2).
module friction_slips_m
  use contact_state_m, only : n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: find_slips

contains

  !> Slips of a step of the slave sides of places over their master sides, along t = (-n_y, n_x), m:
  !> the motion of the foot over the segment that has the normal, L d(xi)
  !> (doc/theory/contact.md, section 6.2). Its second term takes off what the turn of that segment
  !> moves at a distance; without it a rotation of all would slip. That segment is the master's, or
  !> the slave's where the master side is one node.
  pure subroutine find_slips(n, slave_nodes, slave_weights, master_nodes, master_weights, normal, &
      gap, du, places, slip)
    integer, intent(in) :: n, slave_nodes(n_side, *), master_nodes(n_side, *)
    real(wp), intent(in) :: slave_weights(n_side, *), master_weights(n_side, *)
    real(wp), intent(in) :: normal(2, *), gap(*)
    real(wp), intent(in) :: du(2, *)      !! increments of the nodes, m
    real(wp), intent(in) :: places(4, *)  !! of the nodes
    real(wp), intent(inout) :: slip(*)
    real(wp) :: relative(2), along(4), t(2), turn(2), moment, square
    integer :: p, a, b, c, d, owner(n_side)

    owner = 0
    moment = 0.0_wp
    square = 1.0_wp
    !GCC$ NOVECTOR
    do p = 1, n
      a = slave_nodes(1, p)
      b = slave_nodes(2, p)
      c = master_nodes(1, p)
      d = master_nodes(2, p)
      relative = slave_weights(1, p)*du(:, a) + slave_weights(2, p)*du(:, b) &
        - master_weights(1, p)*du(:, c) - master_weights(2, p)*du(:, d)
      if (c == d) then
        c = a
        d = b
      end if
      ! Points in a row often have one segment.
      if (c /= owner(1) .or. d /= owner(2)) then
        owner = [c, d]
        along = places(:, d) - places(:, c)
        t = along(1:2) + along(3:4)
        turn = du(:, d) - du(:, c)
        moment = t(2)*turn(1) - t(1)*turn(2)
        square = max(t(1)**2 + t(2)**2, tiny(1.0_wp))
      end if
      slip(p) = normal(1, p)*relative(2) - normal(2, p)*relative(1) + gap(p)*moment/square
    end do
  end subroutine find_slips

end module friction_slips_m
