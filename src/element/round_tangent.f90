! SPDX-License-Identifier: MIT
!> Exact derivative of the internal force of one fully integrated round quad with respect to its
!> nodal positions, the state at the start of the step held. The force of a point, a quarter of
!> (r sigma B, A s_tt), is that on q = (d31, d42, r) (`quad_tangent` in the plane); its 5x5
!> derivative goes to the nodes by what q is of them.
module round_tangent_m
  use kinds_m, only : wp
  use material_dispatch_m, only : form_tangent
  use parts_m, only : material_t
  use quad_full_m, only : has_mean_dilatation
  use quad_points_m, only : n_point, shape_at_points, shift, signed_area
  use quad_tangent_m, only : d31_of, d42_of, h_of, differences, half_turned, area_gradient, &
    add_geometric
  use stress_point_m, only : stress_point_t
  use volumetric_m, only : log_ratio
  implicit none
  private
  public :: round_tangent

  !> One point: q at time zero, its displacement, and the increment of that in the step.
  type :: place_t
    real(wp) :: start(5), u(5), du(5)
  end type place_t

contains

  !> Matrix of one element, unknowns r1 z1 r2 z2 ... (per radian, N/m).
  pure subroutine round_tangent(material, x, u, du, points, matrix)
    type(material_t), intent(in) :: material
    real(wp), intent(in) :: x(2, 4)                !! corners at time zero
    real(wp), intent(in) :: u(2, 4), du(2, 4)      !! displacement, and its increment in the step
    type(stress_point_t), intent(inout) :: points(n_point) !! at the start of the step
    real(wp), intent(out) :: matrix(8, 8)
    type(place_t) :: places(n_point)
    real(wp) :: small(5, 5, n_point), nodes(5, 8, n_point), slope(8), pressure, modulus
    integer :: k
    logical :: mean

    mean = has_mean_dilatation(material)
    small = 0.0_wp
    do k = 1, n_point
      nodes(:, :, k) = of_nodes(k)
      places(k) = place_t(point_values(k, x), point_values(k, u), point_values(k, du))
      call add_deviator(material, places(k), points(k), small(:, :, k))
      if (mean) cycle
      call volumetric(material%bulk, growth(places(k)), volume(places(k)%start), pressure, modulus)
      call add_pressure(places(k), pressure, small(:, :, k))
      call add_outer(modulus, volume_gradient(places(k)), small(:, :, k))
    end do
    if (mean) then
      call volumetric(material%bulk, 0.25_wp*sum(growth(places)), &
        0.25_wp*sum([(volume(places(k)%start), k=1, n_point)]), pressure, modulus)
      slope = 0.0_wp
      do k = 1, n_point
        call add_pressure(places(k), pressure, small(:, :, k))
        slope = slope + 0.25_wp*matmul(volume_gradient(places(k)), nodes(:, :, k))
      end do
    end if
    matrix = 0.0_wp
    do k = 1, n_point
      matrix = matrix + 0.25_wp*matmul(transpose(nodes(:, :, k)), matmul(small(:, :, k), &
        nodes(:, :, k)))
    end do
    if (mean) call add_outer(modulus, slope, matrix)
  end subroutine round_tangent

  !> What d31 and d42 of point `k` are of the nodes.
  pure function point_pattern(k) result(pattern)
    integer, intent(in) :: k
    real(wp) :: pattern(4, 2)

    pattern(:, 1) = d31_of + shift(1, k)*h_of
    pattern(:, 2) = d42_of + shift(2, k)*h_of
  end function point_pattern

  !> What q of point `k` is of r1 z1 r2 z2 ...
  pure function of_nodes(k) result(nodes)
    integer, intent(in) :: k
    real(wp) :: nodes(5, 8)
    real(wp) :: pattern(4, 2)

    pattern = point_pattern(k)
    nodes = 0.0_wp
    nodes(1, 1::2) = pattern(:, 1)
    nodes(2, 2::2) = pattern(:, 1)
    nodes(3, 1::2) = pattern(:, 2)
    nodes(4, 2::2) = pattern(:, 2)
    nodes(5, 1::2) = shape_at_points(:, k)
  end function of_nodes

  !> q of point `k` of a nodal field.
  pure function point_values(k, field) result(q)
    integer, intent(in) :: k
    real(wp), intent(in) :: field(2, 4)
    real(wp) :: q(5)
    real(wp) :: pattern(4, 2)

    pattern = point_pattern(k)
    q(1:2) = differences(field, pattern(:, 1))
    q(3:4) = differences(field, pattern(:, 2))
    q(5) = dot_product(shape_at_points(:, k), field(1, :))
  end function point_values

  !> A r of a point.
  pure real(wp) function volume(q)
    real(wp), intent(in) :: q(5)

    volume = q(5)*signed_area(q(1:2), q(3:4))
  end function volume

  !> What A r has grown by, to the digits of the displacement.
  elemental real(wp) function growth(place)
    type(place_t), intent(in) :: place

    associate (start => place%start, u => place%u)
      growth = start(5)*(signed_area(start(1:2), u(3:4)) + signed_area(u(1:2), start(3:4) &
        + u(3:4))) + u(5)*signed_area(start(1:2) + u(1:2), start(3:4) + u(3:4))
    end associate
  end function growth

  !> Derivative of A r with respect to q, now.
  pure function volume_gradient(place) result(gradient)
    type(place_t), intent(in) :: place
    real(wp) :: gradient(5)

    associate (q => place%start + place%u)
      gradient(1:4) = q(5)*area_gradient(q(1:2), q(3:4))
      gradient(5) = signed_area(q(1:2), q(3:4))
    end associate
  end function volume_gradient

  !> p = K ln(V/V0) and dp/dV = K/V.
  pure subroutine volumetric(bulk, growth, start, pressure, modulus)
    real(wp), intent(in) :: bulk
    real(wp), intent(in) :: growth, start !! V - V0 and V0
    real(wp), intent(out) :: pressure, modulus

    pressure = bulk*log_ratio(growth/start)
    modulus = bulk/(start + growth)
  end subroutine volumetric

  !> Add `factor` times a vector by itself.
  pure subroutine add_outer(factor, vector, matrix)
    real(wp), intent(in) :: factor
    real(wp), intent(in) :: vector(:)
    real(wp), intent(inout) :: matrix(:, :)
    integer :: j

    do j = 1, size(vector)
      matrix(:, j) = matrix(:, j) + factor*vector(j)*vector
    end do
  end subroutine add_outer

  !> A pressure times the change of the gradient of A r.
  pure subroutine add_pressure(place, pressure, small)
    type(place_t), intent(in) :: place
    real(wp), intent(in) :: pressure
    real(wp), intent(inout) :: small(5, 5)

    call add_stress(place, [pressure, 0.0_wp, pressure, pressure], small)
  end subroutine add_pressure

  !> Stress xx xy yy and tt times the change of r B and of A.
  pure subroutine add_stress(place, stress, small)
    type(place_t), intent(in) :: place
    real(wp), intent(in) :: stress(4)
    real(wp), intent(inout) :: small(5, 5)
    real(wp) :: b(4), plane(4, 4)

    associate (q => place%start + place%u)
      plane = 0.0_wp
      call add_geometric(q(5)*stress(1), q(5)*stress(2), q(5)*stress(3), plane)
      b = area_gradient(q(1:2), q(3:4))
    end associate
    small(:4, :4) = small(:4, :4) + plane
    small(:4, 5) = small(:4, 5) + traction(stress, b)
    small(5, :4) = small(5, :4) + stress(4)*b
  end subroutine add_stress

  !> sigma B of both diagonals.
  pure function traction(stress, b) result(force)
    real(wp), intent(in) :: stress(:) !! xx xy yy
    real(wp), intent(in) :: b(4)
    real(wp) :: force(4)

    force = [stress(1)*b(1) + stress(2)*b(2), stress(2)*b(1) + stress(3)*b(2), &
      stress(1)*b(3) + stress(2)*b(4), stress(2)*b(3) + stress(3)*b(4)]
  end function traction

  !> Deviatoric part of one point. Laws get the strain of the plane less the hoop strain.
  pure subroutine add_deviator(material, place, point, small)
    type(material_t), intent(in) :: material
    type(place_t), intent(in) :: place
    type(stress_point_t), intent(inout) :: point
    real(wp), intent(inout) :: small(5, 5)
    real(wp) :: q(5), rates(4, 5), b(4), s(4), area, radius, hoop
    integer :: j

    q = place%start + place%u
    call step_strain(q(:4), place%du(:4), point, rates)
    radius = q(5) - 0.5_wp*place%du(5)
    hoop = place%du(5)/radius
    point%strain(1) = point%strain(1) - hoop
    rates(:, 5) = [-(1.0_wp - 0.5_wp*hoop)/radius, 0.0_wp, 0.0_wp, 0.0_wp]
    call form_tangent(material, point)
    b = area_gradient(q(1:2), q(3:4))
    area = signed_area(q(1:2), q(3:4))
    do j = 1, 5
      s = plane_and_hoop(matmul(point%tangent, rates(:, j)))
      small(:4, j) = small(:4, j) + q(5)*traction(s, b)
      small(5, j) = small(5, j) + area*s(4)
    end do
    call add_stress(place, plane_and_hoop(point%stress), small)
  end subroutine add_deviator

  !> Strain and rotation of the step in the plane, and their changes with the present d31 and d42:
  !> as in `quad_tangent`, whose last bits change if it shares this (other products are fused).
  pure subroutine step_strain(q, dq, point, rates)
    real(wp), intent(in) :: q(4), dq(4)          !! diagonals, and their increments
    type(stress_point_t), intent(inout) :: point !! `strain` and rotation out
    real(wp), intent(inout) :: rates(4, 5)       !! rows as columns of `point%tangent`, the first
                                                 !! four columns set here
    real(wp) :: g(4), gradient(2, 2), change(2, 2), cosine, sine, tan_half
    integer :: i, j, first

    g = area_gradient(q(1:2) - 0.5_wp*dq(1:2), q(3:4) - 0.5_wp*dq(3:4)) &
      /signed_area(q(1:2) - 0.5_wp*dq(1:2), q(3:4) - 0.5_wp*dq(3:4))
    do j = 1, 2
      gradient(:, j) = dq(1:2)*g(j) + dq(3:4)*g(j + 2)
    end do
    tan_half = 0.25_wp*(gradient(2, 1) - gradient(1, 2))
    cosine = (1.0_wp - tan_half**2)/(1.0_wp + tan_half**2)
    sine = 2.0_wp*tan_half/(1.0_wp + tan_half**2)
    point%cos2 = cosine**2 - sine**2
    point%sin2 = 2.0_wp*cosine*sine
    point%strain = half_turned(cosine, sine, gradient)
    do j = 1, 4
      i = 2 - mod(j, 2)
      first = j - i + 1
      ! d(grad) = (1 - grad/2) L, L having row i alone.
      change = -0.5_wp*spread(gradient(:, i), 2, 2)
      change(i, :) = change(i, :) + 1.0_wp
      change(:, 1) = change(:, 1)*g(first)
      change(:, 2) = change(:, 2)*g(first + 1)
      rates(4, j) = 0.5_wp*(change(2, 1) - change(1, 2))/(1.0_wp + tan_half**2)
      rates(1:3, j) = half_turned(cosine, sine, change) &
        + rates(4, j)*[0.0_wp, -point%strain(3), point%strain(2)]
    end do
  end subroutine step_strain

  !> xx xy yy and tt of a deviator given as (mean, half difference, shear).
  pure function plane_and_hoop(parts) result(stress)
    real(wp), intent(in) :: parts(3)
    real(wp) :: stress(4)

    stress = [parts(1) + parts(2), parts(3), parts(1) - parts(2), -2.0_wp*parts(1)]
  end function plane_and_hoop

end module round_tangent_m
