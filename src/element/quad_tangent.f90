! SPDX-License-Identifier: MIT
!> Exact derivative of the internal force of one fully integrated quad with respect to its nodal
!> positions, the state at the start of the step held. At each point the force is that of a
!> parallelogram with diagonals d31, d42: F31 = sigma B3, F42 = sigma B4; its 4x4 derivative goes to
!> the nodes by the pattern of the point.
module quad_tangent_m
  use kinds_m, only : wp
  use material_dispatch_m, only : form_tangent
  use parts_m, only : material_t
  use quad_full_m, only : has_mean_dilatation
  use quad_points_m, only : n_point, shift, signed_area
  use stress_point_m, only : stress_point_t
  use volumetric_m, only : log_ratio
  implicit none
  private
  public :: quad_tangent, d31_of, d42_of, h_of, differences, half_turned, area_gradient, &
    add_geometric

  !> Node patterns of d31, d42 and h.x.
  real(wp), parameter :: d31_of(4) = [-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], &
    d42_of(4) = [0.0_wp, -1.0_wp, 0.0_wp, 1.0_wp], h_of(4) = [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp]

contains

  !> Matrix of one element, unknowns x1 y1 x2 y2 ... (per metre of thickness, N/m^2).
  pure subroutine quad_tangent(material, reference, u, du, points, matrix)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: reference(6)           !! X31 Y31 X42 Y42 h.X h.Y
    real(wp), intent(in) :: u(2, 4), du(2, 4)      !! displacement, and its increment in the step
    type(stress_point_t), intent(inout) :: points(n_point) !! at the start of the step
    real(wp), intent(out) :: matrix(8, 8)
    real(wp) :: d31(2), d42(2), start(2, 2), small(4, 4), pattern(4, 2)
    integer :: k
    logical :: mean

    mean = has_mean_dilatation(material)
    matrix = 0.0_wp
    do k = 1, n_point
      pattern(:, 1) = d31_of + shift(1, k)*h_of
      pattern(:, 2) = d42_of + shift(2, k)*h_of
      start(:, 1) = reference(1:2) + shift(1, k)*reference(5:6)
      start(:, 2) = reference(3:4) + shift(2, k)*reference(5:6)
      d31 = differences(u, pattern(:, 1))
      d42 = differences(u, pattern(:, 2))
      small = 0.0_wp
      if (.not. mean) call add_volumetric(material%bulk, start, d31, d42, small)
      call add_deviatoric(material, start(:, 1) + d31, start(:, 2) + d42, &
        differences(du, pattern(:, 1)), differences(du, pattern(:, 2)), points(k), small)
      call add_pattern(pattern, 0.25_wp, small, matrix)
    end do
    if (.not. mean) return
    small = 0.0_wp
    pattern(:, 1) = d31_of
    pattern(:, 2) = d42_of
    call add_volumetric(material%bulk, reshape(reference(1:4), [2, 2]), differences(u, d31_of), &
      differences(u, d42_of), small)
    call add_pattern(pattern, 1.0_wp, small, matrix)
  end subroutine quad_tangent

  !> Sum over the nodes; the pattern has no mean, so that it is a sum of differences.
  pure function differences(u, pattern) result(d)
    real(wp), intent(in) :: u(2, 4)
    real(wp), intent(in) :: pattern(4)
    real(wp) :: d(2)

    d = pattern(2)*(u(:, 2) - u(:, 1)) + pattern(3)*(u(:, 3) - u(:, 1)) &
      + pattern(4)*(u(:, 4) - u(:, 1))
  end function differences

  !> Volumetric part of a parallelogram: p B with p = K ln(A/A0), dp = K dA/A, dA = B.d.
  pure subroutine add_volumetric(bulk, start, d31, d42, small)
    real(wp), intent(in) :: bulk
    real(wp), intent(in) :: start(2, 2)      !! diagonals d31, d42 at time zero
    real(wp), intent(in) :: d31(2), d42(2)   !! of the displacement
    real(wp), intent(inout) :: small(4, 4)   !! rows and columns d31 x, y, d42 x, y
    real(wp) :: now(2, 2), b(4), pressure, modulus, area, stretch
    integer :: j

    now = start + reshape([d31, d42], [2, 2])
    area = signed_area(now(:, 1), now(:, 2))
    stretch = (signed_area(start(:, 1), d42) + signed_area(d31, now(:, 2))) &
      /signed_area(start(:, 1), start(:, 2))
    pressure = bulk*log_ratio(stretch)
    modulus = bulk/area
    b = area_gradient(now(:, 1), now(:, 2))
    do j = 1, 4
      small(:, j) = small(:, j) + modulus*b(j)*b
    end do
    call add_geometric(pressure, 0.0_wp, pressure, small)
  end subroutine add_volumetric

  !> Deviatoric part of one point.
  pure subroutine add_deviatoric(material, d31, d42, step31, step42, point, small)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: d31(2), d42(2)       !! present diagonals
    real(wp), intent(in) :: step31(2), step42(2) !! their increments
    type(stress_point_t), intent(inout) :: point
    real(wp), intent(inout) :: small(4, 4)
    real(wp) :: g(4), gradient(2, 2), change(2, 2), cosine, sine, tan_half, b(4), d(4), s(3)
    integer :: i, j, first

    ! Gradients and displacement gradient of the step in the mid-step shape.
    g = area_gradient(d31 - 0.5_wp*step31, d42 - 0.5_wp*step42) &
      /signed_area(d31 - 0.5_wp*step31, d42 - 0.5_wp*step42)
    do j = 1, 2
      gradient(:, j) = step31*g(j) + step42*g(j + 2)
    end do
    tan_half = 0.25_wp*(gradient(2, 1) - gradient(1, 2))
    cosine = (1.0_wp - tan_half**2)/(1.0_wp + tan_half**2)
    sine = 2.0_wp*tan_half/(1.0_wp + tan_half**2)
    point%cos2 = cosine**2 - sine**2
    point%sin2 = 2.0_wp*cosine*sine
    point%strain = half_turned(cosine, sine, gradient)
    call form_tangent(material, point)
    b = area_gradient(d31, d42)
    do j = 1, 4
      i = 2 - mod(j, 2)
      first = j - i + 1
      ! d(grad) = (1 - grad/2) L, L having row i alone.
      change = -0.5_wp*spread(gradient(:, i), 2, 2)
      change(i, :) = change(i, :) + 1.0_wp
      change(:, 1) = change(:, 1)*g(first)
      change(:, 2) = change(:, 2)*g(first + 1)
      d(4) = 0.5_wp*(change(2, 1) - change(1, 2))/(1.0_wp + tan_half**2)
      d(1:3) = half_turned(cosine, sine, change) + d(4)*[0.0_wp, -point%strain(3), point%strain(2)]
      s = matmul(point%tangent, d)
      small(:, j) = small(:, j) + [(s(1) + s(2))*b(1) + s(3)*b(2), s(3)*b(1) + (s(1) - s(2))*b(2), &
        (s(1) + s(2))*b(3) + s(3)*b(4), s(3)*b(3) + (s(1) - s(2))*b(4)]
    end do
    call add_geometric(point%stress(1) + point%stress(2), point%stress(3), &
      point%stress(1) - point%stress(2), small)
  end subroutine add_deviatoric

  !> Strain (mean, half difference, shear) of a displacement gradient,
  !> turned by half of the rotation.
  pure function half_turned(cosine, sine, gradient) result(strain)
    real(wp), intent(in) :: cosine, sine !! of the whole rotation
    real(wp), intent(in) :: gradient(2, 2)
    real(wp) :: strain(3)
    real(wp) :: half, shear

    half = 0.5_wp*(gradient(1, 1) - gradient(2, 2))
    shear = 0.5_wp*(gradient(1, 2) + gradient(2, 1))
    strain = [0.5_wp*(gradient(1, 1) + gradient(2, 2)), cosine*half - sine*shear, &
      sine*half + cosine*shear]
  end function half_turned

  !> B3 and B4: gradient of the area with respect to d31 and d42.
  pure function area_gradient(d31, d42) result(b)
    real(wp), intent(in) :: d31(2), d42(2)
    real(wp) :: b(4)

    b = 0.5_wp*[d42(2), -d42(1), -d31(2), d31(1)]
  end function area_gradient

  !> Stress times the change of B: dB3 = (y, -x)/2 of the change of d42,
  !> dB4 = (-y, x)/2 of that of d31.
  pure subroutine add_geometric(xx, xy, yy, small)
    real(wp), intent(in) :: xx, xy, yy
    real(wp), intent(inout) :: small(4, 4)
    real(wp) :: corner(2, 2)

    corner = 0.5_wp*reshape([-xy, -yy, xx, xy], [2, 2])
    small(1:2, 3:4) = small(1:2, 3:4) + corner
    small(3:4, 1:2) = small(3:4, 1:2) - corner
  end subroutine add_geometric

  !> Add a weighted matrix in d31, d42 to that of the nodes.
  pure subroutine add_pattern(pattern, weight, small, matrix)
    real(wp), intent(in) :: pattern(4, 2) !! of d31, of d42
    real(wp), intent(in) :: weight
    real(wp), intent(in) :: small(4, 4)
    real(wp), intent(inout) :: matrix(8, 8)
    real(wp) :: columns(4, 8)
    integer :: a

    do a = 1, 4
      columns(:, 2*a - 1) = weight*(small(:, 1)*pattern(a, 1) + small(:, 3)*pattern(a, 2))
      columns(:, 2*a) = weight*(small(:, 2)*pattern(a, 1) + small(:, 4)*pattern(a, 2))
    end do
    do a = 1, 4
      matrix(2*a - 1, :) = matrix(2*a - 1, :) + (pattern(a, 1)*columns(1, :) &
        + pattern(a, 2)*columns(3, :))
      matrix(2*a, :) = matrix(2*a, :) + (pattern(a, 1)*columns(2, :) + pattern(a, 2)*columns(4, :))
    end do
  end subroutine add_pattern

end module quad_tangent_m
