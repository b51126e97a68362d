! SPDX-License-Identifier: MIT
!> Exact derivative of the internal force of one fully integrated quad of rubber, plane or round:
!> the second derivative of its energy, sum of w_k W(F_k), w_k the initial volume of a point and F_k
!> its F scaled to the dilatation of the element. Written in dual numbers.
module rubber_tangent_m
  use dual_m, only : dual_t, constant, variable, operator(+), operator(-), operator(*), operator(/)
  use kinds_m, only : wp
  use quad_points_m, only : n_point, shape_at_points, shift
  use quad_tangent_m, only : d31_of, d42_of, h_of, differences
  use rubbers_m, only : rubber_t
  implicit none
  private
  public :: rubber_tangent

  !> One point: initial volume, gradients of the shape functions at time zero, present ones, F.
  type :: place_t
    real(wp) :: start
    real(wp) :: initial(2, 4)
    type(dual_t) :: gradient(2, 4), hoop(4) !! of d/dx_i; N_a/r
    type(dual_t) :: f(2, 2), f33, ratio     !! ratio J
  end type place_t

contains

  !> Matrix of one element, unknowns x1 y1 x2 y2 ... (per metre of thickness or per radian).
  pure subroutine rubber_tangent(rubber, is_round, x, u, matrix)
    type(rubber_t), intent(in) :: rubber
    logical, intent(in) :: is_round
    real(wp), intent(in) :: x(2, 4), u(2, 4)   !! corners at time zero, displacements
    real(wp), intent(out) :: matrix(8, 8)
    type(place_t) :: places(n_point)
    type(dual_t) :: force(2, 4), theta, slope(2, 4), mean, stress(2, 2), hoop
    real(wp) :: total
    integer :: a, i, k

    do k = 1, n_point
      places(k) = place_of(k, is_round, x, u)
    end do
    total = sum(places%start)
    theta = constant(0.0_wp)
    mean = constant(0.0_wp)
    force = constant(0.0_wp)
    slope = constant(0.0_wp)
    do k = 1, n_point
      theta = theta + (places(k)%start/total)*places(k)%ratio
    end do
    do k = 1, n_point
      associate (p => places(k))
        call find_stress(rubber, theta, p, stress, hoop, mean)
        do a = 1, 4
          do i = 1, 2
            force(i, a) = force(i, a) + p%start*(stress(i, 1)*p%gradient(1, a) &
              + stress(i, 2)*p%gradient(2, a))
            slope(i, a) = slope(i, a) + (p%start/total)*(p%ratio*p%gradient(i, a))
          end do
          force(1, a) = force(1, a) + p%start*(hoop*p%hoop(a))
          slope(1, a) = slope(1, a) + (p%start/total)*(p%ratio*p%hoop(a))
        end do
      end associate
    end do
    mean = mean/theta
    do a = 1, 4
      do i = 1, 2
        force(i, a) = force(i, a) + mean*slope(i, a)
        matrix(2*a - 2 + i, :) = force(i, a)%slope(:8)
      end do
    end do
  end subroutine rubber_tangent

  !> F and gradients of point `k`; variables are the eight displacements.
  pure function place_of(k, is_round, x, u) result(place)
    integer, intent(in) :: k
    logical, intent(in) :: is_round
    real(wp), intent(in) :: x(2, 4), u(2, 4)
    type(place_t) :: place
    real(wp) :: p(4), q(4), d31(2), d42(2), area, radius
    type(dual_t) :: move(2, 4), det, r
    integer :: a, i, j

    p = d31_of + shift(1, k)*h_of
    q = d42_of + shift(2, k)*h_of
    d31 = differences(x, p)
    d42 = differences(x, q)
    area = 0.5_wp*(d31(1)*d42(2) - d42(1)*d31(2))
    place%initial(1, :) = (p*d42(2) - q*d31(2))/(2.0_wp*area)
    place%initial(2, :) = (d31(1)*q - d42(1)*p)/(2.0_wp*area)
    place%start = 0.25_wp*area
    do a = 1, 4
      do i = 1, 2
        move(i, a) = variable(u(i, a), 2*a - 2 + i)
      end do
    end do
    do j = 1, 2
      do i = 1, 2
        place%f(i, j) = constant(merge(1.0_wp, 0.0_wp, i == j))
        do a = 1, 4
          place%f(i, j) = place%f(i, j) + place%initial(j, a)*move(i, a)
        end do
      end do
    end do
    det = place%f(1, 1)*place%f(2, 2) - place%f(1, 2)*place%f(2, 1)
    place%f33 = constant(1.0_wp)
    place%hoop = constant(0.0_wp)
    if (is_round) then
      radius = dot_product(shape_at_points(:, k), x(1, :))
      r = constant(radius)
      do a = 1, 4
        r = r + shape_at_points(a, k)*move(1, a)
      end do
      place%f33 = (1.0_wp/radius)*r
      do a = 1, 4
        place%hoop(a) = constant(shape_at_points(a, k))/r
      end do
      place%start = place%start*radius
    end if
    place%ratio = det*place%f33
    do a = 1, 4
      place%gradient(1, a) = (place%initial(1, a)*place%f(2, 2) - place%initial(2, a) &
        *place%f(2, 1))/det
      place%gradient(2, a) = (place%initial(2, a)*place%f(1, 1) - place%initial(1, a) &
        *place%f(1, 2))/det
    end do
  end function place_of

  !> Deviator of Kirchhoff's stress of a point, and its volume times its mean stress to the sum.
  pure subroutine find_stress(rubber, theta, place, stress, hoop, mean)
    type(rubber_t), intent(in) :: rubber
    type(dual_t), intent(in) :: theta             !! dilatation of the element
    type(place_t), intent(in) :: place
    type(dual_t), intent(out) :: stress(2, 2), hoop
    type(dual_t), intent(inout) :: mean
    type(dual_t) :: b(2, 2), b33, scale, first, factor, middle
    integer :: i, j

    scale = power(theta/place%ratio, 2.0_wp/3.0_wp)
    do j = 1, 2
      do i = 1, 2
        b(i, j) = scale*(place%f(i, 1)*place%f(j, 1) + place%f(i, 2)*place%f(j, 2))
      end do
    end do
    b33 = scale*(place%f33*place%f33)
    first = b(1, 1) + b(2, 2) + b33
    factor = constant(2.0_wp*rubber%a) + 2.0_wp*rubber%b*first
    do j = 1, 2
      do i = 1, 2
        stress(i, j) = factor*b(i, j) - 2.0_wp*rubber%b*(b(i, 1)*b(1, j) + b(i, 2)*b(2, j))
      end do
    end do
    hoop = factor*b33 - 2.0_wp*rubber%b*(b33*b33)
    middle = (1.0_wp/3.0_wp)*(stress(1, 1) + stress(2, 2) + hoop)
    stress(1, 1) = stress(1, 1) - middle
    stress(2, 2) = stress(2, 2) - middle
    hoop = hoop - middle
    mean = mean + place%start*(middle + volumetric_slope(rubber, theta))
  end subroutine find_stress

  !> J U'(J).
  pure function volumetric_slope(rubber, ratio) result(slope)
    type(rubber_t), intent(in) :: rubber
    type(dual_t), intent(in) :: ratio
    type(dual_t) :: slope
    type(dual_t) :: squared

    if (rubber%exponent > 0.0_wp) then
      slope = (-2.0_wp*rubber%a)*power(ratio, -rubber%exponent)
    else
      squared = ratio*ratio
      slope = 4.0_wp*rubber%d*(squared*(squared + (-1.0_wp))) - 4.0_wp*rubber%c*power(squared, &
        -2.0_wp)
    end if
  end function volumetric_slope

  !> a^p of a positive number.
  pure function power(a, p) result(c)
    type(dual_t), intent(in) :: a
    real(wp), intent(in) :: p
    type(dual_t) :: c

    c%value = a%value**p
    c%slope = (p*c%value/a%value)*a%slope
  end function power

end module rubber_tangent_m
