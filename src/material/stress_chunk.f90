! SPDX-License-Identifier: MIT
!> Data of a material law for one chunk, and the objective rotation common to all laws.
module stress_chunk_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  implicit none
  private
  public :: stress_chunk_t, rotate_deviator, load_deviator, store_deviator, work_of_deviator, &
    stress_point_t, turn, turn_rate

  !> Strain increments of the step in the mid-step geometry, and the deviatoric stress.
  type :: stress_chunk_t
    real(wp), dimension(chunk_size) :: dxx, dyy, dxy !! dt D_xx, dt D_yy, dt D_xy (D_zz = 0)
    real(wp) :: dt = 0.0_wp                          !! step
    real(wp), dimension(chunk_size) :: cosine, sine  !! of the rotation of the step
    real(wp), dimension(chunk_size) :: cos2, sin2    !! of twice that rotation
    real(wp), dimension(chunk_size) :: sxx, syy, sxy !! deviator, s_zz = -(s_xx + s_yy); rotated old
                                                     !! stress before the law
    real(wp), dimension(chunk_size) :: work          !! work of the deviator per volume in this step
    logical :: has_hoop = .false.                    !! axisymmetric: D_xx and D_yy contain
    real(wp), dimension(chunk_size) :: hoop          !! minus the hoop rate; this is dt times it
    real(wp), dimension(chunk_size) :: mean, ratio   !! mean stress at the start of the step, V/V0
                                                     !! in its middle; only where there is an EOS
    ! What follows is there only for laws that give the pressure too. They leave the mean stress at
    ! the end of the step in `mean`, energy per initial volume and moduli per present one.
    real(wp), dimension(chunk_size) :: stretch, start_stretch !! V/V0 - 1 at the end and start
    real(wp), dimension(chunk_size) :: volume          !! V/V0 of the point itself, at the end
    real(wp), dimension(chunk_size) :: hxx, hxy, hyx, hyy, hzz !! F - 1, det F = 1 + stretch
    real(wp), dimension(chunk_size) :: energy, bulk, shear
  end type stress_chunk_t

  !> Data of the tangent of a material law at one point. Symmetric plane tensors are (mean, half
  !> difference, shear) = ((xx + yy)/2, (xx - yy)/2, xy), which a rotation does not couple to the
  !> mean.
  type :: stress_point_t
    real(wp) :: strain(3) = 0.0_wp          !! increment of the step, rotated into the frame of the
                                            !! laws
    real(wp) :: cos2 = 1.0_wp, sin2 = 0.0_wp !! of twice the rotation of the step
    real(wp) :: old(3) = 0.0_wp             !! deviator at the start of the step
    real(wp) :: plastic_strain = 0.0_wp     !! at the start of the step
    real(wp) :: back(3) = 0.0_wp            !! back stress at the start of the step
    real(wp) :: stress(3) = 0.0_wp          !! deviator at its end
    real(wp) :: tangent(3, 4) = 0.0_wp      !! its derivative with respect to `strain` and the
                                            !! rotation
  end type stress_point_t

contains

  !> Rotate a symmetric deviator by the rotation of the step. In the plane the update of Hughes &
  !> Winget (1980) is a rotation by 2 atan(dt w/2), so a rigid spin is exact for any step; (A4) of
  !> Kang, Lee & Shin (2023) is its first-order form.
  pure subroutine rotate_deviator(cos2, sin2, xx, yy, xy)
    real(wp), intent(in) :: cos2(chunk_size), sin2(chunk_size)
    real(wp), intent(inout) :: xx(chunk_size), yy(chunk_size), xy(chunk_size)
    real(wp) :: mean, half, shear
    integer :: i

    !$omp simd private(mean, half, shear)
    do i = 1, chunk_size
      mean = 0.5_wp*(xx(i) + yy(i))
      half = 0.5_wp*(xx(i) - yy(i))
      shear = xy(i)
      xy(i) = cos2(i)*shear + sin2(i)*half
      half = cos2(i)*half - sin2(i)*shear
      xx(i) = mean + half
      yy(i) = mean - half
    end do
  end subroutine rotate_deviator

  !> Load the deviator of a chunk from its streams, rotated as by `rotate_deviator`: a separate
  !> rotation takes 4 % of the element kernel.
  pure subroutine load_deviator(stream, stride, stress)
    integer, intent(in) :: stride
    real(wp), intent(in) :: stream(stride, *)
    type(stress_chunk_t), intent(inout) :: stress
    real(wp) :: mean, half
    integer :: i

    !$omp simd private(mean, half)
    do i = 1, chunk_size
      mean = 0.5_wp*(stream(i, 1) + stream(i, 2))
      half = 0.5_wp*(stream(i, 1) - stream(i, 2))
      stress%sxy(i) = stress%cos2(i)*stream(i, 3) + stress%sin2(i)*half
      half = stress%cos2(i)*half - stress%sin2(i)*stream(i, 3)
      stress%sxx(i) = mean + half
      stress%syy(i) = mean - half
    end do
  end subroutine load_deviator

  !> Store the deviator of a chunk in its streams.
  pure subroutine store_deviator(stress, stride, stream)
    type(stress_chunk_t), intent(in) :: stress
    integer, intent(in) :: stride
    real(wp), intent(inout) :: stream(stride, *)
    integer :: i

    do i = 1, chunk_size
      stream(i, 1) = stress%sxx(i)
      stream(i, 2) = stress%syy(i)
      stream(i, 3) = stress%sxy(i)
    end do
  end subroutine store_deviator

  !> Work of the deviator over a chunk; padding has no strain and adds nothing.
  pure function work_of_deviator(density, area) result(work)
    real(wp), intent(in) :: density(chunk_size) !! per volume
    real(wp), intent(in) :: area(chunk_size)    !! mid-step
    real(wp) :: work
    integer :: i

    work = 0.0_wp
    !$omp simd reduction(+ : work)
    do i = 1, chunk_size
      work = work + density(i)*area(i)
    end do
  end function work_of_deviator

  !> Rotate a tensor by the rotation of the step.
  pure function turn(point, tensor) result(turned)
    type(stress_point_t), intent(in) :: point
    real(wp), intent(in) :: tensor(3)
    real(wp) :: turned(3)

    turned = [tensor(1), point%cos2*tensor(2) - point%sin2*tensor(3), &
      point%sin2*tensor(2) + point%cos2*tensor(3)]
  end function turn

  !> Derivative of a rotated tensor with respect to the rotation.
  pure function turn_rate(turned) result(rate)
    real(wp), intent(in) :: turned(3)
    real(wp) :: rate(3)

    rate = [0.0_wp, -2.0_wp*turned(3), 2.0_wp*turned(2)]
  end function turn_rate

end module stress_chunk_m
