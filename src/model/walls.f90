! SPDX-License-Identifier: MIT
!> Rigid walls: planes that nodes cannot penetrate, fixed or moving along their normal.
module walls_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: wall_t, wall_distance, wall_tangent, friction_sticks

  !> FRIC of a wall without sliding.
  real(wp), parameter :: friction_sticks = 1.0_wp

  !> One *RIGIDWALL_PLANAR, with _MOVING one that moves along its normal.
  type, extends(visited_t) :: wall_t
    integer :: id = 0                        !! user id, or assigned by the deck layer
    real(wp) :: point(2) = 0.0_wp             !! a point of the wall (tail)
    real(wp) :: normal(2) = [0.0_wp, 1.0_wp] !! unit normal, from tail to head
    real(wp) :: friction = 0.0_wp            !! coefficient of friction, or `friction_sticks`
    real(wp) :: birth = 0.0_wp               !! birth time, s
    real(wp) :: death = 1.0e20_wp            !! death time, s
    real(wp) :: mass = 0.0_wp                !! of a moving wall, kg/m; 0: fixed
    real(wp) :: velocity = 0.0_wp            !! along the normal at time zero, m/s
    character(:), allocatable :: source      !! file and line, for messages
    integer, allocatable :: nodes(:)         !! indices of its nodes
    integer, allocatable :: node_index(:)    !! (n_special) index in `nodes`, 0 = not in it
  contains
    procedure :: visit => visit_wall
  end type wall_t

contains

  !> Distance of a position from the wall, m, negative behind it.
  pure function wall_distance(wall, coordinates, displacement) result(distance)
    type(wall_t), intent(in) :: wall
    real(wp), intent(in) :: coordinates(2)  !! at time zero
    real(wp), intent(in) :: displacement(2)
    real(wp) :: distance

    distance = dot_product(wall%normal, coordinates - wall%point) &
      + dot_product(wall%normal, displacement)
  end function wall_distance

  !> Unit tangent of the wall: its normal rotated by 90 degrees counter-clockwise.
  pure function wall_tangent(wall) result(tangent)
    type(wall_t), intent(in) :: wall
    real(wp) :: tangent(2)

    tangent = [-wall%normal(2), wall%normal(1)]
  end function wall_tangent

  !> Visit the components of a wall.
  subroutine visit_wall(self, visitor)
    class(wall_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%visit('id', self%id)
    call visitor%fixed('point', self%point)
    call visitor%fixed('normal', self%normal)
    call visitor%visit('friction', self%friction)
    call visitor%visit('birth', self%birth)
    call visitor%visit('death', self%death)
    call visitor%visit('mass', self%mass)
    call visitor%visit('velocity', self%velocity)
    call visitor%visit('source', self%source)
    call visitor%visit('nodes', self%nodes)
    call visitor%visit('node_index', self%node_index)
  end subroutine visit_wall

end module walls_m
