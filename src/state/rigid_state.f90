! SPDX-License-Identifier: MIT
!> State of a rigid body. Arrays of three: x, y and the rotation about z, counter-clockwise.
module rigid_state_m
  use kinds_m, only : wp
  use visitor_m, only : visited_t, visitor_t
  implicit none
  private
  public :: rigid_state_t, rotation_terms, rotation_shift, velocity_of, damping_of, &
    body_scales

  !> One rigid body. Positions of its nodes follow from `displacement` alone, so that its shape
  !> never drifts.
  type, extends(visited_t) :: rigid_state_t
    real(wp) :: inertia(3) = 0.0_wp       !! M, M and the moment of inertia about the centre of mass
    real(wp) :: second(3) = 0.0_wp        !! sums of m r_x^2, m r_y^2, m r_x r_y at time zero
    real(wp) :: centre(2) = 0.0_wp        !! centre of mass at time zero
    real(wp), allocatable :: arms(:, :)   !! (2, n) position of each node relative to the centre of
                                          !! mass at time zero, m
    real(wp) :: displacement(3) = 0.0_wp  !! displacement of the centre of mass, m, and angle, rad
    real(wp) :: velocity(3) = 0.0_wp      !! v(n-1/2)
    real(wp) :: next_velocity(3) = 0.0_wp !! v(n+1/2), once the forces of the cycle are known
    real(wp) :: acceleration(3) = 0.0_wp  !! at t(n)
    real(wp) :: force(3) = 0.0_wp         !! resultants of contact, loads and element forces
    real(wp) :: load(3) = 0.0_wp          !! forces and moment of *LOAD_RIGID_BODY
  contains
    procedure :: visit => visit_rigid
  end type rigid_state_t

contains

  !> Sine of an angle and one minus its cosine. The latter is formed as 2 sin^2(angle/2), so that
  !> small rotations keep their digits.
  pure function rotation_terms(angle) result(turn)
    real(wp), intent(in) :: angle
    real(wp) :: turn(2)

    turn = [sin(angle), 2.0_wp*sin(0.5_wp*angle)**2]
  end function rotation_terms

  !> Displacement of the end of an arm by a rotation; exactly zero without rotation.
  pure function rotation_shift(turn, arm) result(shift)
    real(wp), intent(in) :: turn(2) !! from `rotation_terms`
    real(wp), intent(in) :: arm(2)
    real(wp) :: shift(2)

    shift(1) = -(turn(2)*arm(1) + turn(1)*arm(2))
    shift(2) = turn(1)*arm(1) - turn(2)*arm(2)
  end function rotation_shift

  !> Velocity of a point of the body: v + omega x arm.
  pure function velocity_of(velocity, arm) result(there)
    real(wp), intent(in) :: velocity(3)
    real(wp), intent(in) :: arm(2)   !! position relative to the centre of mass at the same instant
    real(wp) :: there(2)

    there(1) = velocity(1) - velocity(3)*arm(2)
    there(2) = velocity(2) + velocity(3)*arm(1)
  end function velocity_of

  !> D of each degree of freedom at an angle. The rotation is damped by the forces -D m v on the
  !> nodes in their current positions.
  pure function damping_of(rigid, angle, damping) result(rate)
    type(rigid_state_t), intent(in) :: rigid
    real(wp), intent(in) :: angle
    real(wp), intent(in) :: damping(2)
    real(wp) :: rate(3)
    real(wp) :: along_x

    rate(1:2) = damping
    rate(3) = damping(1)
    if (.not. abs(damping(1) - damping(2)) > 0.0_wp) return
    along_x = cos(angle)**2*rigid%second(1) + sin(angle)**2*rigid%second(2) &
      - sin(2.0_wp*angle)*rigid%second(3)
    rate(3) = (damping(2)*along_x + damping(1)*(rigid%inertia(3) - along_x))/rigid%inertia(3)
  end function damping_of

  !> Factors of displacement and turn in the unknowns of the implicit driver: 1, 1 and the radius of
  !> gyration, so that all are lengths.
  pure function body_scales(rigids) result(scales)
    type(rigid_state_t), intent(in) :: rigids(:)
    real(wp) :: scales(3, size(rigids))
    integer :: i

    scales = 1.0_wp
    do i = 1, size(rigids)
      scales(3, i) = sqrt(rigids(i)%inertia(3)/rigids(i)%inertia(1))
    end do
  end function body_scales

  !> Visit the components of the rigid body.
  subroutine visit_rigid(self, visitor)
    class(rigid_state_t), intent(inout), target :: self
    class(visitor_t), intent(inout) :: visitor

    call visitor%fixed('inertia', self%inertia)
    call visitor%fixed('second', self%second)
    call visitor%fixed('centre', self%centre)
    call visitor%visit('arms', self%arms)
    call visitor%fixed('displacement', self%displacement)
    call visitor%fixed('velocity', self%velocity)
    call visitor%fixed('next_velocity', self%next_velocity)
    call visitor%fixed('acceleration', self%acceleration)
    call visitor%fixed('force', self%force)
    call visitor%fixed('load', self%load)
  end subroutine visit_rigid

end module rigid_state_m
