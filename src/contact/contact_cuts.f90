! SPDX-License-Identifier: MIT
!> Points at the master nodes between the pieces of slave segments, written array by array.
module contact_cuts_m
  use contact_plain_cover_m, only : plain_cover_t, n_room
  use contact_state_m, only : contact_state_t, make_room, n_side
  use kinds_m, only : wp
  implicit none
  private
  public :: add_cuts

contains

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
