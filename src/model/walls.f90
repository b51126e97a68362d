! SPDX-License-Identifier: MIT
!> Rigid walls: fixed planes that nodes do not pass.
module walls_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: wall_t, wall_distance, wall_tangent, friction_sticks

  !> Coefficient of a wall that lets no node slide.
  real(wp), parameter :: friction_sticks = 1.0_wp

  !> One *RIGIDWALL_PLANAR.
  type, extends(visited_t) :: wall_t
    integer :: id = 0                        !! user id, or one that the deck layer gives
    real(wp) :: point(2) = 0.0_wp             !! a point of the wall (tail)
    real(wp) :: normal(2) = [0.0_wp, 1.0_wp] !! of length 1, into the free side (tail to head)
    real(wp) :: friction = 0.0_wp            !! 0 none, `friction_sticks`, between: of Coulomb
    real(wp) :: birth = 0.0_wp               !! the wall is there from this time
    real(wp) :: death = 1.0e20_wp            !! until this time
    integer, allocatable :: nodes(:)         !! indices of the nodes that see it
    integer, allocatable :: node_index(:)    !! (n_special) where each special node stands in
                                             !! `nodes`, 0 = not there
  contains
    procedure :: visit => visit_wall
  end type wall_t

contains

  !> Distance of a place from the wall, negative behind it.
  pure function wall_distance(wall, coordinates, displacement) result(distance)
    type(wall_t), intent(in) :: wall
    real(wp), intent(in) :: coordinates(2)  !! at time zero
    real(wp), intent(in) :: displacement(2)
    real(wp) :: distance

    distance = dot_product(wall%normal, coordinates - wall%point) &
      + dot_product(wall%normal, displacement)
  end function wall_distance

  !> Direction along the wall: its normal turned by 90 degrees, counter-clockwise.
  pure function wall_tangent(wall) result(tangent)
    type(wall_t), intent(in) :: wall
    real(wp) :: tangent(2)

    tangent = [-wall%normal(2), wall%normal(1)]
  end function wall_tangent

  !> Its components.
  subroutine visit_wall(self, visitor)
    class(wall_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%fixed('point', self%point)
    call visitor%fixed('normal', self%normal)
    call visitor%visit('friction', self%friction)
    call visitor%visit('birth', self%birth)
    call visitor%visit('death', self%death)
    call visitor%visit('nodes', self%nodes)
    call visitor%visit('node_index', self%node_index)
  end subroutine visit_wall

end module walls_m
