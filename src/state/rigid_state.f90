! SPDX-License-Identifier: MIT
!> What a rigid body is and where it is. In arrays of three: x, y and the turn
!> about z, counter-clockwise.
module rigid_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: rigid_state_t, turn_of, shift_by_turn, velocity_of

  !> One body. The places of its nodes follow from `place` alone, so that its shape never drifts.
  type, extends(visited_t) :: rigid_state_t
    real(wp) :: inertia(3) = 0.0_wp       !! M, M and the moment of inertia about the centre of mass
    real(wp) :: second(3) = 0.0_wp        !! sums of m r_x^2, m r_y^2, m r_x r_y at time zero
    real(wp) :: centre(2) = 0.0_wp        !! centre of mass at time zero
    real(wp), allocatable :: arms(:, :)   !! (2, n) nodes minus centre at time zero
    real(wp) :: place(3) = 0.0_wp         !! displacement of the centre, angle
    real(wp) :: velocity(3) = 0.0_wp      !! v(n-1/2)
    real(wp) :: next_velocity(3) = 0.0_wp !! v(n+1/2), once the forces of the cycle are known
    real(wp) :: acceleration(3) = 0.0_wp  !! of the present instant
    real(wp) :: force(3) = 0.0_wp         !! resultants of contact, loads and deformable elements
    real(wp) :: load(3) = 0.0_wp          !! forces and moment of *LOAD_RIGID_BODY
  contains
    procedure :: visit => visit_rigid
  end type rigid_state_t

contains

  !> Sine of an angle and one less its cosine, formed without a difference:
  !> small turns keep their digits.
  pure function turn_of(angle) result(turn)
    real(wp), intent(in) :: angle
    real(wp) :: turn(2)

    turn = [sin(angle), 2.0_wp*sin(0.5_wp*angle)**2]
  end function turn_of

  !> How far a turn takes the end of an arm; exactly nowhere when there is no turn.
  pure function shift_by_turn(turn, arm) result(shift)
    real(wp), intent(in) :: turn(2) !! from turn_of
    real(wp), intent(in) :: arm(2)
    real(wp) :: shift(2)

    shift(1) = -(turn(2)*arm(1) + turn(1)*arm(2))
    shift(2) = turn(1)*arm(1) - turn(2)*arm(2)
  end function shift_by_turn

  !> Velocity of a point of the body.
  pure function velocity_of(velocity, arm) result(there)
    real(wp), intent(in) :: velocity(3)
    real(wp), intent(in) :: arm(2)   !! from the centre, at that instant
    real(wp) :: there(2)

    there(1) = velocity(1) - velocity(3)*arm(2)
    there(2) = velocity(2) + velocity(3)*arm(1)
  end function velocity_of

  !> Its components.
  subroutine visit_rigid(self, visitor)
    class(rigid_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%fixed('inertia', self%inertia)
    call visitor%fixed('second', self%second)
    call visitor%fixed('centre', self%centre)
    call visitor%visit('arms', self%arms)
    call visitor%fixed('place', self%place)
    call visitor%fixed('velocity', self%velocity)
    call visitor%fixed('next_velocity', self%next_velocity)
    call visitor%fixed('acceleration', self%acceleration)
    call visitor%fixed('force', self%force)
    call visitor%fixed('load', self%load)
  end subroutine visit_rigid

end module rigid_state_m
