! SPDX-License-Identifier: MIT
!> Internal force of one element, plane or axisymmetric, in dual numbers: the equations of the
!> kernels for every element form and law. The variables are the patterns of the nodes: a = d31, b =
!> d42, h in x and y, and s, the sum of the radii; an integration point is the parallelogram of its
!> own diagonals at its own radius.
module element_tangent_m
  use kinds_m, only : wp
  use material_dispatch_m, only : form_tangent, has_mean_dilatation
  use parts_m, only : material_t, rubber_t
  use quad_points_m, only : n_point, point_areas, shape_at_points, shift, along_a, along_b, along_h
  use short_dual_m, only : dual_t, n_partial, constant, variable, operator(+), operator(-), &
    operator(*), operator(/)
  use stress_chunk_m, only : stress_point_t
  use volumetric_m, only : log_ratio
  implicit none
  private
  public :: element_t, shape_t, n_pattern, new_element, set_pattern_values, form_full_force, &
    form_gradient, find_stress, find_sheet_stress, pressure_of, start_volumes, twice_area, &
    products, cross

  !> Patterns: a, b and h in x and y, and s.
  integer, parameter :: n_pattern = 7

  !> A shape, or its increment; s of a point is its radius.
  type :: shape_t
    type(dual_t) :: a(2), b(2), h(2), s
  end type shape_t

  !> One element in a step.
  type :: element_t
    logical :: is_axisymmetric
    real(wp) :: x(2, 4)                 !! corners at time zero
    real(wp) :: u(2, 4)                 !! displacement
    type(shape_t) :: now, middle, change !! present and mid-step shape, increment in the step
    type(stress_point_t) :: points(n_point) !! at the start of the step
    real(wp) :: dilatation(n_point)     !! ln(J) of the stage before
    real(wp) :: thinning(n_point)       !! plane stress: t/t0 - 1 at the start of the step
    real(wp) :: pattern_stress(2)       !! of the hourglass, at the start of the step
  end type element_t

contains

  !> An element whose shapes have the slopes of the patterns, and no values.
  pure function new_element(is_axisymmetric) result(element)
    logical, intent(in) :: is_axisymmetric
    type(element_t) :: element

    element%is_axisymmetric = is_axisymmetric
    associate (now => element%now, middle => element%middle)
      now%a = variable([0.0_wp, 0.0_wp], [1, 2])
      now%b = variable([0.0_wp, 0.0_wp], [3, 4])
      now%h = variable([0.0_wp, 0.0_wp], [5, 6])
      now%s = variable(0.0_wp, 7)
      element%change = now
      middle%a = 0.5_wp*now%a
      middle%b = 0.5_wp*now%b
      middle%h = 0.5_wp*now%h
      middle%s = 0.5_wp*now%s
    end associate
  end function new_element

  !> Set the values of a nodal field in the patterns.
  pure subroutine set_pattern_values(field, shape)
    real(wp), intent(in) :: field(2, 4)
    type(shape_t), intent(inout) :: shape

    shape%a%value = field(:, 3) - field(:, 1)
    shape%b%value = field(:, 4) - field(:, 2)
    shape%h%value = (field(:, 1) - field(:, 2)) + (field(:, 3) - field(:, 4))
    shape%s%value = sum(field(1, :))
  end subroutine set_pattern_values

  !> Diagonals of point `k`, and its radius in axisymmetric models.
  pure subroutine form_place(k, is_axisymmetric, shape, place)
    integer, intent(in) :: k
    logical, intent(in) :: is_axisymmetric
    type(shape_t), intent(in) :: shape
    type(shape_t), intent(inout) :: place

    place%a = along(shape%a, shift(1, k), shape%h)
    place%b = along(shape%b, shift(2, k), shape%h)
    if (.not. is_axisymmetric) return
    place%s%value = 0.25_wp*shape%s%value + along_a(k)*shape%a(1)%value &
      + along_b(k)*shape%b(1)%value + along_h(k)*shape%h(1)%value
    place%s%slope = 0.25_wp*shape%s%slope + along_a(k)*shape%a(1)%slope &
      + along_b(k)*shape%b(1)%slope + along_h(k)*shape%h(1)%slope
  end subroutine form_place

  !> p + factor q
  elemental function along(p, factor, q) result(c)
    type(dual_t), intent(in) :: p, q
    real(wp), intent(in) :: factor
    type(dual_t) :: c

    c%value = p%value + factor*q%value
    c%slope = p%slope + factor*q%slope
  end function along

  !> p q + r s
  pure function products(p, q, r, s) result(c)
    type(dual_t), intent(in) :: p, q, r, s
    type(dual_t) :: c

    c%value = p%value*q%value + r%value*s%value
    c%slope = (p%value*q%slope + q%value*p%slope) + (r%value*s%slope + s%value*r%slope)
  end function products

  !> p q - r s: twice the area of a parallelogram (p, r) (s, q), with its sign.
  pure function cross(p, q, r, s) result(c)
    type(dual_t), intent(in) :: p, q, r, s
    type(dual_t) :: c

    c%value = p%value*q%value - r%value*s%value
    c%slope = (p%value*q%slope + q%value*p%slope) - (r%value*s%slope + s%value*r%slope)
  end function cross

  !> Twice the area of the quad with these diagonals.
  pure function twice_area(shape) result(area)
    type(shape_t), intent(in) :: shape
    type(dual_t) :: area

    area = cross(shape%a(1), shape%b(2), shape%a(2), shape%b(1))
  end function twice_area

  !> Forces of a fully integrated quad on the patterns: at each point those of a parallelogram.
  pure subroutine form_full_force(material, element, force)
    type(material_t), intent(in) :: material
    type(element_t), intent(inout) :: element
    type(dual_t), intent(out) :: force(n_pattern)
    type(shape_t) :: places(n_point)
    type(dual_t) :: volumes(n_point), volume, stress(4, n_point), pressure
    real(wp) :: start(n_point)
    integer :: k

    start = start_volumes(element)
    volume = constant(0.0_wp)
    do k = 1, n_point
      call form_place(k, element%is_axisymmetric, element%now, places(k))
      volumes(k) = twice_area(places(k))
      if (element%is_axisymmetric) volumes(k) = volumes(k)*places(k)%s
      volumes(k) = 0.125_wp*volumes(k)
      volume = along(volume, 1.0_wp, volumes(k))
    end do
    if (allocated(material%rubber) .and. .not. material%is_plane_stress) then
      call find_rubber_stress(material%rubber, element, start, volumes, volume, stress)
    else
      pressure = pressure_of(material%bulk, element%dilatation(1), sum(start), volume)
      do k = 1, n_point
        if (material%is_plane_stress .or. .not. has_mean_dilatation(material)) &
          pressure = pressure_of(material%bulk, element%dilatation(k), start(k), volumes(k))
        call find_point_stress(material, k, places(k), element, pressure, stress(:, k))
      end do
    end if
    force = constant(0.0_wp)
    do k = 1, n_point
      call add_point_force(k, element%is_axisymmetric, places(k), stress(:, k), force)
    end do
  end subroutine form_full_force

  !> Areas or volumes per radian of the points at time zero.
  pure function start_volumes(element) result(start)
    type(element_t), intent(in) :: element
    real(wp) :: start(n_point)

    start = point_areas(element%x)
    if (element%is_axisymmetric) start = start*matmul(element%x(1, :), shape_at_points)
  end function start_volumes

  !> Cauchy stress xx yy xy and zz (hoop) of an integration point.
  pure subroutine find_point_stress(material, k, place, element, pressure, stress)
    type(material_t), intent(in) :: material
    integer, intent(in) :: k
    type(shape_t), intent(in) :: place
    type(element_t), intent(inout) :: element
    type(dual_t), intent(in) :: pressure
    type(dual_t), intent(out) :: stress(4)
    type(dual_t) :: gradient(2, 2), hoop, cosine
    real(wp) :: radius, growth

    associate (change => element%change)
      call form_gradient(place, change%a%value + shift(1, k)*change%h%value, &
        change%b%value + shift(2, k)*change%h%value, gradient)
      if (material%is_plane_stress) then
        call find_sheet_stress(material, k, gradient, pressure, element, stress, cosine)
        return
      end if
      hoop = constant(0.0_wp)
      if (element%is_axisymmetric) then
        growth = 0.25_wp*change%s%value + along_a(k)*change%a(1)%value &
          + along_b(k)*change%b(1)%value + along_h(k)*change%h(1)%value
        radius = place%s%value - 0.5_wp*growth
        hoop%value = growth/radius
        hoop%slope = (1.0_wp - 0.5_wp*hoop%value)/radius*place%s%slope
      end if
    end associate
    call find_stress(material, gradient, hoop, pressure, element%points(k), stress, cosine)
  end subroutine find_point_stress

  !> Add the forces sigma B of a point, with a quarter of the area and the radius as weight, and the
  !> force of the hoop stress.
  pure subroutine add_point_force(k, is_axisymmetric, place, stress, force)
    integer, intent(in) :: k
    logical, intent(in) :: is_axisymmetric
    type(shape_t), intent(in) :: place
    type(dual_t), intent(in) :: stress(4)
    type(dual_t), intent(inout) :: force(n_pattern)
    real(wp), parameter :: weight = 0.125_wp
    type(dual_t) :: f(4), hoop
    integer :: i

    f(1) = cross(stress(1), place%b(2), stress(3), place%b(1))
    f(2) = cross(stress(3), place%b(2), stress(2), place%b(1))
    f(3) = cross(stress(3), place%a(1), stress(1), place%a(2))
    f(4) = cross(stress(2), place%a(1), stress(3), place%a(2))
    if (is_axisymmetric) then
      hoop = stress(4)*twice_area(place)
      force(1) = along(force(1), weight*along_a(k), hoop)
      force(3) = along(force(3), weight*along_b(k), hoop)
      force(5) = along(force(5), weight*along_h(k), hoop)
      force(7) = along(force(7), 0.25_wp*weight, hoop)
      do i = 1, 4
        f(i) = f(i)*place%s
      end do
    end if
    do i = 1, 4
      force(i) = along(force(i), weight, f(i))
    end do
    do i = 1, 2
      force(i + 4) = along(along(force(i + 4), weight*shift(1, k), f(i)), weight*shift(2, k), &
        f(i + 2))
    end do
  end subroutine add_point_force

  !> Gradient G of the step in its mid-step shape, of a parallelogram or at the centre. With D the
  !> increment of the displacement gradient in that shape, dG = (1 - G/2) D.
  pure subroutine form_gradient(now, change_a, change_b, gradient)
    type(shape_t), intent(in) :: now
    real(wp), intent(in) :: change_a(2), change_b(2)
    type(dual_t), intent(out) :: gradient(2, 2)
    real(wp) :: a(2), b(2), g(2, 2), change(n_partial, 2)
    integer :: i, j

    a = now%a%value - 0.5_wp*change_a
    b = now%b%value - 0.5_wp*change_b
    g(1, :) = [b(2), -b(1)]/(a(1)*b(2) - a(2)*b(1))
    g(2, :) = [-a(2), a(1)]/(a(1)*b(2) - a(2)*b(1))
    do j = 1, 2
      gradient(:, j)%value = g(1, j)*change_a + g(2, j)*change_b
    end do
    do j = 1, 2
      do i = 1, 2
        change(:, i) = g(1, j)*now%a(i)%slope + g(2, j)*now%b(i)%slope
      end do
      do i = 1, 2
        gradient(i, j)%slope = change(:, i) - (0.5_wp*gradient(i, 1)%value)*change(:, 1) &
          - (0.5_wp*gradient(i, 2)%value)*change(:, 2)
      end do
    end do
  end subroutine form_gradient

  !> Cauchy stress xx yy xy and zz (hoop) at the end of the step, and the cosine of its rotation.
  pure subroutine find_stress(material, gradient, hoop, pressure, point, stress, cosine)
    type(material_t), intent(in) :: material
    type(dual_t), intent(in) :: gradient(2, 2), hoop !! of the step, in the mid-step shape
    type(dual_t), intent(in) :: pressure             !! tension positive
    type(stress_point_t), intent(inout) :: point
    type(dual_t), intent(out) :: stress(4), cosine
    real(wp) :: g(2, 2), tan_half, half, shear, rates(4, 5), sine
    type(dual_t) :: parts(3)
    integer :: i

    g = gradient%value
    tan_half = 0.25_wp*(g(2, 1) - g(1, 2))
    cosine%value = (1.0_wp - tan_half**2)/(1.0_wp + tan_half**2)
    sine = 2.0_wp*tan_half/(1.0_wp + tan_half**2)
    half = 0.5_wp*(g(1, 1) - g(2, 2))
    shear = 0.5_wp*(g(1, 2) + g(2, 1))
    point%strain = [0.5_wp*(g(1, 1) + g(2, 2)) - hoop%value, cosine%value*half - sine*shear, &
      sine*half + cosine%value*shear]
    point%cos2 = cosine%value**2 - sine**2
    point%sin2 = 2.0_wp*cosine%value*sine
    call form_tangent(material, point)
    ! Derivatives of strain and angle 2 atan(tan_half) with respect to xx yx xy yy of the gradient
    ! and the hoop strain.
    rates(4, :) = 0.5_wp/(1.0_wp + tan_half**2)*[0.0_wp, 1.0_wp, -1.0_wp, 0.0_wp, 0.0_wp]
    rates(1, :) = [0.5_wp, 0.0_wp, 0.0_wp, 0.5_wp, -1.0_wp]
    rates(2, :) = 0.5_wp*[cosine%value, -sine, -sine, -cosine%value, 0.0_wp] &
      - point%strain(3)*rates(4, :)
    rates(3, :) = 0.5_wp*[sine, cosine%value, cosine%value, -sine, 0.0_wp] &
      + point%strain(2)*rates(4, :)
    cosine%slope = -sine*rates(4, 2)*(gradient(2, 1)%slope - gradient(1, 2)%slope)
    rates(1:3, :) = matmul(point%tangent, rates)
    do i = 1, 3
      parts(i)%value = point%stress(i)
      parts(i)%slope = rates(i, 1)*gradient(1, 1)%slope + rates(i, 2)*gradient(2, 1)%slope &
        + rates(i, 3)*gradient(1, 2)%slope + rates(i, 4)*gradient(2, 2)%slope &
        + rates(i, 5)*hoop%slope
    end do
    stress(4) = along(pressure, 1.0_wp, parts(1))
    stress(1) = along(stress(4), 1.0_wp, parts(2))
    stress(2) = along(stress(4), -1.0_wp, parts(2))
    stress(3) = parts(3)
    stress(4) = along(pressure, -2.0_wp, parts(1))
  end subroutine find_stress

  !> Stress of a point in plane stress, times t/t0 where forces follow the thickness. The strain
  !> increment of the thickness is one more variable, in the place of the radius, until sigma_zz = 0
  !> eliminates it (static condensation).
  pure subroutine find_sheet_stress(material, k, gradient, pressure, element, stress, cosine)
    type(material_t), intent(in) :: material
    integer, intent(in) :: k
    type(dual_t), intent(in) :: gradient(2, 2)
    type(dual_t), intent(in) :: pressure     !! K ln(A/A0)
    type(element_t), intent(inout) :: element
    type(dual_t), intent(out) :: stress(4), cosine
    integer, parameter :: most_rounds = 60
    type(dual_t) :: strain, ratio, mean
    real(wp) :: stiffness, change
    integer :: i, round

    stiffness = material%bulk + 4.0_wp*material%shear/3.0_wp
    strain = variable(-(stiffness - 2.0_wp*material%shear)/stiffness &
      *(gradient(1, 1)%value + gradient(2, 2)%value), n_pattern)
    do round = 1, most_rounds
      ratio = (1.0_wp + element%thinning(k))*((strain + 2.0_wp)/(2.0_wp - strain))
      mean = along(pressure, material%bulk, logarithm(ratio))
      call find_stress(material, gradient, strain, mean, element%points(k), stress, cosine)
      if (allocated(material%rubber)) call find_sheet_rubber(material%rubber, k, element, ratio, &
        stress)
      change = -stress(4)%value/stress(4)%slope(n_pattern)
      if (abs(change) <= 1.0e-12_wp*abs(strain%value) + 1.0e-15_wp) exit
      strain%value = max(-1.9_wp, min(1.9_wp, strain%value + max(-0.5_wp, min(0.5_wp, change))))
    end do
    call eliminate(stress(4), ratio)
    do i = 1, 3
      call eliminate(stress(4), stress(i))
      if (material%follows_strain) stress(i) = stress(i)*ratio
    end do
    stress(4) = constant(0.0_wp)
  end subroutine find_sheet_stress

  !> Eliminate the last variable by the condition that `rest` stays 0.
  pure subroutine eliminate(rest, of)
    type(dual_t), intent(in) :: rest
    type(dual_t), intent(inout) :: of

    of%slope = of%slope - of%slope(n_pattern)/rest%slope(n_pattern)*rest%slope
    of%slope(n_pattern) = 0.0_wp
  end subroutine eliminate

  !> Logarithm of a positive number.
  pure function logarithm(a) result(c)
    type(dual_t), intent(in) :: a
    type(dual_t) :: c

    c%value = log_ratio(a%value - 1.0_wp)
    c%slope = a%slope/a%value
  end function logarithm

  !> Cauchy stress xx yy xy and zz of rubber at a point with a stretch of the thickness.
  pure subroutine find_sheet_rubber(rubber, k, element, stretch, stress)
    type(rubber_t), intent(in) :: rubber
    integer, intent(in) :: k
    type(element_t), intent(in) :: element
    type(dual_t), intent(in) :: stretch
    type(dual_t), intent(out) :: stress(4)
    type(shape_t) :: moved, place
    type(dual_t) :: theta
    real(wp) :: areas(n_point)
    integer :: i

    moved = element%now
    call set_pattern_values(element%u, moved)
    call form_place(k, .false., element%now, place)
    areas = point_areas(element%x)
    theta = (0.125_wp/areas(k)*twice_area(place))*stretch
    call form_place(k, .false., moved, place)
    call find_kirchhoff_stress(rubber, constant(1.0_wp), k, element, place, stress, stretch)
    do i = 1, 4
      if (i /= 3) stress(i) = stress(i) + volumetric_part(rubber, theta)
      stress(i) = stress(i)/theta
    end do
  end subroutine find_sheet_rubber

  !> J U'(J) of rubber.
  pure function volumetric_part(rubber, theta) result(part)
    type(rubber_t), intent(in) :: rubber
    type(dual_t), intent(in) :: theta !! J
    type(dual_t) :: part
    type(dual_t) :: square

    if (rubber%exponent > 0.0_wp) then
      part = (-2.0_wp*rubber%a)*power(theta, -rubber%exponent)
    else
      square = theta*theta
      part = 4.0_wp*rubber%d*(square*(square + (-1.0_wp))) - 4.0_wp*rubber%c*power(square, -2.0_wp)
    end if
  end function volumetric_part

  !> K ln(V/V0), with ln(J) of the stage before.
  pure function pressure_of(bulk, dilatation, start, volume) result(pressure)
    real(wp), intent(in) :: bulk, dilatation, start
    type(dual_t), intent(in) :: volume
    type(dual_t) :: pressure

    pressure%value = bulk*(log_ratio((volume%value - start)/start) + dilatation)
    pressure%slope = bulk/volume%value*volume%slope
  end function pressure_of

  !> Cauchy stress of the points of rubber, the derivative of the energy sum of w_k W(F_k): w_k the
  !> initial volume of a point and F_k its F scaled to the dilatation of the element.
  pure subroutine find_rubber_stress(rubber, element, start, volumes, volume, stress)
    type(rubber_t), intent(in) :: rubber
    type(element_t), intent(in) :: element
    real(wp), intent(in) :: start(n_point)         !! initial volumes
    type(dual_t), intent(in) :: volumes(n_point), volume !! present ones, and their sum
    type(dual_t), intent(out) :: stress(4, n_point)
    type(shape_t) :: moved, place
    type(dual_t) :: mean, middle, theta, ratio
    integer :: i, k

    moved = element%now
    call set_pattern_values(element%u, moved)
    theta = (1.0_wp/sum(start))*volume
    ! J U'(J), common to all points.
    mean = sum(start)*volumetric_part(rubber, theta)
    do k = 1, n_point
      ratio = (1.0_wp/start(k))*volumes(k)
      call form_place(k, element%is_axisymmetric, moved, place)
      call find_kirchhoff_stress(rubber, power(theta/ratio, 2.0_wp/3.0_wp), k, element, place, &
        stress(:, k))
      middle = (1.0_wp/3.0_wp)*((stress(1, k) + stress(2, k)) + stress(4, k))
      mean = along(mean, start(k), middle)
      do i = 1, 4
        if (i /= 3) stress(i, k) = stress(i, k) - middle
        stress(i, k) = stress(i, k)/ratio
      end do
    end do
    ! All points share the mean stress.
    mean = mean/volume
    do k = 1, n_point
      stress([1, 2, 4], k) = stress([1, 2, 4], k) + mean
    end do
  end subroutine find_rubber_stress

  !> Kirchhoff's stress xx yy xy and zz of a point, of (2A + 2B I) b - 2B b b.
  pure subroutine find_kirchhoff_stress(rubber, scale, k, element, moved, stress, stretch)
    type(rubber_t), intent(in) :: rubber
    type(dual_t), intent(in) :: scale    !! of b
    integer, intent(in) :: k
    type(element_t), intent(in) :: element
    type(shape_t), intent(in) :: moved   !! displacement of the point
    type(dual_t), intent(out) :: stress(4)
    type(dual_t), intent(in), optional :: stretch !! of the thickness
    type(dual_t) :: f(2, 2), b(4), factor
    real(wp) :: p(2), q(2), h(2), inverse
    integer :: i

    associate (x => element%x)
      h = (x(:, 1) - x(:, 2)) + (x(:, 3) - x(:, 4))
      p = (x(:, 3) - x(:, 1)) + shift(1, k)*h
      q = (x(:, 4) - x(:, 2)) + shift(2, k)*h
      inverse = 1.0_wp/(p(1)*q(2) - p(2)*q(1))
      do i = 1, 2
        f(i, 1) = along((inverse*q(2))*moved%a(i), -inverse*p(2), moved%b(i))
        f(i, 2) = along((inverse*p(1))*moved%b(i), -inverse*q(1), moved%a(i))
        f(i, i) = f(i, i) + 1.0_wp
      end do
      b(1) = scale*products(f(1, 1), f(1, 1), f(1, 2), f(1, 2))
      b(2) = scale*products(f(2, 1), f(2, 1), f(2, 2), f(2, 2))
      b(3) = scale*products(f(1, 1), f(2, 1), f(1, 2), f(2, 2))
      b(4) = scale
      if (present(stretch)) b(4) = stretch*stretch
      if (element%is_axisymmetric) then
        factor = (1.0_wp/dot_product(shape_at_points(:, k), x(1, :)))*moved%s + 1.0_wp
        b(4) = scale*(factor*factor)
      end if
    end associate
    factor = (2.0_wp*rubber%b)*(b(1) + b(2) + b(4)) + 2.0_wp*rubber%a
    stress(1) = along(factor*b(1), -2.0_wp*rubber%b, products(b(1), b(1), b(3), b(3)))
    stress(2) = along(factor*b(2), -2.0_wp*rubber%b, products(b(2), b(2), b(3), b(3)))
    stress(3) = along(factor*b(3), -2.0_wp*rubber%b, products(b(1), b(3), b(3), b(2)))
    stress(4) = along(factor*b(4), -2.0_wp*rubber%b, b(4)*b(4))
  end subroutine find_kirchhoff_stress

  !> a^p of a positive number.
  pure function power(a, p) result(c)
    type(dual_t), intent(in) :: a
    real(wp), intent(in) :: p
    type(dual_t) :: c

    c%value = a%value**p
    c%slope = (p*c%value/a%value)*a%slope
  end function power

end module element_tangent_m
