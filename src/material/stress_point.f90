! SPDX-License-Identifier: MIT
!> What the tangent of a material law gets and gives at one point. Symmetric tensors
!> of the plane are (mean, half difference, shear) = ((xx + yy)/2, (xx - yy)/2, xy),
!> which a rotation leaves apart.
module stress_point_m
  use kinds_m, only : wp
  implicit none
  private
  public :: stress_point_t, turn, turn_rate

  !> One point in one step.
  type :: stress_point_t
    real(wp) :: strain(3) = 0.0_wp          !! increment of the step, turned as the laws want it
    real(wp) :: cos2 = 1.0_wp, sin2 = 0.0_wp !! of twice the rotation of the step
    real(wp) :: old(3) = 0.0_wp             !! deviator at the start of the step
    real(wp) :: plastic_strain = 0.0_wp     !! at the start of the step
    real(wp) :: back(3) = 0.0_wp            !! back stress at the start of the step
    real(wp) :: stress(3) = 0.0_wp          !! deviator at its end
    real(wp) :: tangent(3, 4) = 0.0_wp      !! its derivative with respect to `strain` and the
                                            !! rotation
  end type stress_point_t

contains

  !> Turn a tensor by the rotation of the step.
  pure function turn(point, tensor) result(turned)
    type(stress_point_t), intent(in) :: point
    real(wp), intent(in) :: tensor(3)
    real(wp) :: turned(3)

    turned = [tensor(1), point%cos2*tensor(2) - point%sin2*tensor(3), &
      point%sin2*tensor(2) + point%cos2*tensor(3)]
  end function turn

  !> Change of a turned tensor with the rotation.
  pure function turn_rate(turned) result(rate)
    real(wp), intent(in) :: turned(3)
    real(wp) :: rate(3)

    rate = [0.0_wp, -2.0_wp*turned(3), 2.0_wp*turned(2)]
  end function turn_rate

end module stress_point_m
