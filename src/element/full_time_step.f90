! SPDX-License-Identifier: MIT
!> Stable step of fully integrated quads: a lower bound of 2/omega_max of the single element with
!> lumped mass, and so of every mesh of them. With the largest modulus C of the plane,
!> v.K v <= C sum_p A_p |grad v|^2, so omega^2 <= 4 C lambda/(rho A0) with lambda the largest
!> eigenvalue of the scalar matrix sum_p A_p (grad N)(grad N)^T, and lambda <= (trace of its 16th
!> power)^(1/16). A triangle has three nodes and one gradient; there lambda <= trace.
module full_time_step_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use element_chunk_m, only : element_chunk_t
  use parts_m, only : hourglass_t, material_t
  use quad_points_m, only : shift
  implicit none
  private
  public :: step_sums_t, start_sums, add_point_sums, full_step

  !> Of one chunk: the scalar matrix in d31, d42 and h.x (11 22 12 13 23 33), smallest J of a point.
  type :: step_sums_t
    real(wp) :: h(chunk_size, 6)
    real(wp) :: volume(chunk_size)
  end type step_sums_t

contains

  !> Nothing summed yet.
  pure subroutine start_sums(sums)
    type(step_sums_t), intent(out) :: sums

    sums%h = 0.0_wp
    sums%volume = huge(1.0_wp)
  end subroutine start_sums

  !> Add point `k`: B_3.B_3, B_4.B_4 and B_3.B_4 of its parallelogram over four times its area.
  pure subroutine add_point_sums(k, point, sums)
    integer, intent(in) :: k
    type(element_chunk_t), intent(in) :: point
    type(step_sums_t), intent(inout) :: sums
    real(wp) :: weight, b33, b44, b34
    integer :: i

    !$omp simd private(weight, b33, b44, b34)
    do i = 1, chunk_size
      weight = 0.0625_wp*abs(point%inverse_area(i))
      b33 = weight*(point%x42(i)**2 + point%y42(i)**2)
      b44 = weight*(point%x31(i)**2 + point%y31(i)**2)
      b34 = -weight*(point%x31(i)*point%x42(i) + point%y31(i)*point%y42(i))
      sums%h(i, 1) = sums%h(i, 1) + b33
      sums%h(i, 2) = sums%h(i, 2) + b44
      sums%h(i, 3) = sums%h(i, 3) + b34
      sums%h(i, 4) = sums%h(i, 4) + (shift(1, k)*b33 + shift(2, k)*b34)
      sums%h(i, 5) = sums%h(i, 5) + (shift(1, k)*b34 + shift(2, k)*b44)
      sums%h(i, 6) = sums%h(i, 6) + (shift(1, k)**2*b33 + shift(2, k)**2*b44)
      sums%volume(i) = min(sums%volume(i), 1.0_wp + point%stretch(i))
    end do
  end subroutine add_point_sums

  !> Smallest step of the chunk, and its smallest volume ratio at a point.
  pure subroutine full_step(material, viscosity, nodes, chunk, sums, limit, volume, single)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity  !! its Q1 and Q2 count
    integer, intent(in) :: nodes(4, chunk_size) !! a triangle repeats its third
    type(element_chunk_t), intent(in) :: chunk
    type(step_sums_t), intent(in) :: sums
    real(wp), intent(out) :: limit              !! s
    real(wp), intent(out) :: volume             !! smallest J
    real(wp), intent(out), optional :: single(chunk_size) !! steps of the elements
    real(wp) :: squared(chunk_size), step(chunk_size), modulus
    integer :: i

    modulus = 2.0_wp*max(material%bulk + material%shear/3.0_wp, material%shear)
    call squared_frequency(sums%h, squared)
    volume = huge(1.0_wp)
    do i = 1, chunk_size
      if (nodes(4, i) == nodes(3, i)) squared(i) = triangle_part(chunk, i)
    end do
    !$omp simd reduction(min : volume)
    do i = 1, chunk_size
      squared(i) = squared(i)*modulus/material%density &
        *abs(chunk%inverse_area(i)*(1.0_wp + chunk%stretch(i)))
      step(i) = 2.0_wp/sqrt(squared(i))
      volume = min(volume, sums%volume(i))
    end do
    if (viscosity%quadratic > 0.0_wp .or. viscosity%linear > 0.0_wp) &
      step = viscous_step(step, 2.0_wp*material%density/modulus/(1.0_wp + chunk%stretch) &
      *sqrt(abs(chunk%area))*(viscosity%linear*material%sound_speed &
      + viscosity%quadratic*sqrt(abs(chunk%area))*abs(chunk%trace)))
    limit = minval(step)
    if (present(single)) single = step
  end subroutine full_step

  !> Step under viscous pressure: damping of the fastest mode at most zeta = (2 viscosity/C)/step.
  !> It counts in expansion too: two steps later the fastest mode is in compression.
  pure elemental function viscous_step(step, viscosity) result(limit)
    real(wp), intent(in) :: step      !! without viscosity
    real(wp), intent(in) :: viscosity !! 2 q/(|t| C), s
    real(wp) :: limit
    real(wp) :: zeta

    zeta = viscosity/step
    limit = step/(zeta + sqrt(zeta*zeta + 1.0_wp))
  end function viscous_step

  !> 4 lambda of quads: with orthonormal patterns d31/sqrt(2), d42/sqrt(2), h/2 the matrix is
  !> symmetric 3x3; scaled by its trace it is squared four times.
  pure subroutine squared_frequency(h, squared)
    real(wp), intent(in) :: h(chunk_size, 6)
    real(wp), intent(out) :: squared(chunk_size)
    real(wp), parameter :: root_eight = sqrt(8.0_wp)
    real(wp) :: trace, scale, a11, a22, a33, a12, a13, a23, b11, b22, b33, b12, b13, b23
    integer :: i, k

    !$omp simd private(trace, scale, a11, a22, a33, a12, a13, a23, b11, b22, b33, b12, b13, b23, k)
    do i = 1, chunk_size
      trace = 2.0_wp*(h(i, 1) + h(i, 2)) + 4.0_wp*h(i, 6)
      scale = 1.0_wp/trace
      a11 = 2.0_wp*h(i, 1)*scale
      a22 = 2.0_wp*h(i, 2)*scale
      a12 = 2.0_wp*h(i, 3)*scale
      a13 = root_eight*h(i, 4)*scale
      a23 = root_eight*h(i, 5)*scale
      a33 = 4.0_wp*h(i, 6)*scale
      do k = 1, 3
        b11 = a11*a11 + a12*a12 + a13*a13
        b22 = a12*a12 + a22*a22 + a23*a23
        b33 = a13*a13 + a23*a23 + a33*a33
        b12 = a11*a12 + a12*a22 + a13*a23
        b13 = a11*a13 + a12*a23 + a13*a33
        b23 = a12*a13 + a22*a23 + a23*a33
        a11 = b11
        a22 = b22
        a33 = b33
        a12 = b12
        a13 = b13
        a23 = b23
      end do
      ! The trace of the square is the sum of the squares.
      squared(i) = 4.0_wp*trace*sqrt(sqrt(sqrt(sqrt(a11*a11 + a22*a22 + a33*a33 &
        + 2.0_wp*(a12*a12 + a13*a13 + a23*a23)))))
    end do
  end subroutine squared_frequency

  !> 3 lambda of a triangle, by the trace of A (grad N)(grad N)^T.
  pure function triangle_part(chunk, i) result(squared)
    type(element_chunk_t), intent(in) :: chunk
    integer, intent(in) :: i
    real(wp) :: squared
    real(wp) :: sides

    ! Sides x3 - x1, x3 - x2 and x2 - x1.
    sides = (chunk%x31(i)**2 + chunk%y31(i)**2) + (chunk%x42(i)**2 + chunk%y42(i)**2) &
      + ((chunk%x31(i) - chunk%x42(i))**2 + (chunk%y31(i) - chunk%y42(i))**2)
    squared = 0.75_wp*sides*abs(chunk%inverse_area(i))
  end function triangle_part

end module full_time_step_m
