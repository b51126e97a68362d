! SPDX-License-Identifier: MIT
!> Exact derivative of the internal force of a one-point quad with hourglass control by assumed
!> strain, plane or round, with respect to its nodal positions, the state at the start of the step
!> held. The kernels are written once more, in dual numbers of the patterns a = d31, b = d42, h and
!> s (the sum of the radii).
module one_point_tangent_m
  use assumed_strain_m, only : form_moduli
  use dual_m, only : dual_t, constant, variable, operator(+), operator(-), operator(*), &
    operator(/), sqrt
  use kinds_m, only : wp
  use material_dispatch_m, only : form_tangent
  use parts_m, only : hourglass_t, material_t
  use stress_point_m, only : stress_point_t
  use volumetric_m, only : log_ratio
  implicit none
  private
  public :: one_point_tangent

  integer, parameter :: n_pattern = 7
  real(wp), parameter :: part = 1.0_wp/24.0_wp
  !> Patterns of the nodes: a and b and h in x and y, and s.
  integer, parameter :: of_nodes(4, 4) = reshape([-1, 0, 1, 0, 0, -1, 0, 1, 1, -1, 1, -1, &
    1, 1, 1, 1], [4, 4])

  !> A shape, or the change of one.
  type :: shape_t
    type(dual_t) :: a(2), b(2), h(2), s
  end type shape_t

  !> Integrals over a round quad of r d/dr, of r d/dz and of 1, pattern by pattern (`round_chunk`).
  type :: integrals_t
    type(dual_t) :: volume, rad(3), axi(3), mean(3)
  end type integrals_t

  !> What a step does to the point: gradient in the plane, increment of the hoop strain, rotation.
  type :: increment_t
    type(dual_t) :: gradient(2, 2), hoop, cosine
  end type increment_t

contains

  !> Matrix of one element, unknowns x1 y1 x2 y2 ... (per metre of thickness, or per radian).
  pure subroutine one_point_tangent(material, hourglass, is_round, x, moved, point, &
    pattern_stress, matrix)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    logical, intent(in) :: is_round
    real(wp), intent(in) :: x(2, 4)              !! corners at time zero
    real(wp), intent(in) :: moved(2, 4, 2)       !! displacement, and its increment in the step
    type(stress_point_t), intent(inout) :: point !! at the start of the step
    real(wp), intent(in) :: pattern_stress(2)    !! of the hourglass, at the start of the step
    real(wp), intent(out) :: matrix(8, 8)
    type(shape_t) :: now, change, middle
    type(increment_t) :: increment
    type(dual_t) :: force(n_pattern), stress(4), q(2)
    real(wp) :: small(n_pattern, n_pattern), nodes(n_pattern, 8), start
    integer :: k

    now = shape_of(x + moved(:, :, 1))
    change = shape_of(moved(:, :, 2))
    middle = half_way_back(now, change)
    start = start_volume(x, is_round)
    call find_increment(is_round, middle, change, increment)
    call find_stress(material, increment, point, stress)
    call add_pressure(material%bulk, start, volume_of(now, is_round), stress)
    call find_resistance(material, hourglass, pattern_stress, now, middle, change, &
      increment%cosine, q)
    if (is_round) then
      call form_round_force(now, stress, q, force)
    else
      call form_plane_force(now, stress, q, force)
    end if
    nodes = 0.0_wp
    do k = 1, 3
      nodes(2*k - 1, 1::2) = of_nodes(:, k)
      nodes(2*k, 2::2) = of_nodes(:, k)
    end do
    nodes(7, 1::2) = of_nodes(:, 4)
    do k = 1, n_pattern
      small(k, :) = force(k)%slope(:n_pattern)
    end do
    matrix = matmul(transpose(nodes), matmul(small, nodes))
  end subroutine one_point_tangent

  !> Patterns of a nodal field. All that depend on the displacement have the same variables.
  pure function shape_of(field) result(shape)
    real(wp), intent(in) :: field(2, 4)
    type(shape_t) :: shape

    shape%a = variable(field(:, 3) - field(:, 1), [1, 2])
    shape%b = variable(field(:, 4) - field(:, 2), [3, 4])
    shape%h = variable((field(:, 1) - field(:, 2)) + (field(:, 3) - field(:, 4)), [5, 6])
    shape%s = variable(sum(field(1, :)), 7)
  end function shape_of

  !> The shape half a step ago.
  pure function half_way_back(now, change) result(middle)
    type(shape_t), intent(in) :: now, change
    type(shape_t) :: middle

    middle%a = now%a - 0.5_wp*change%a
    middle%b = now%b - 0.5_wp*change%b
    middle%h = now%h - 0.5_wp*change%h
    middle%s = now%s - 0.5_wp*change%s
  end function half_way_back

  !> Twice the area of a parallelogram of two vectors, with its sign.
  pure function cross(p, q) result(product)
    type(dual_t), intent(in) :: p(2), q(2)
    type(dual_t) :: product

    product = p(1)*q(2) - p(2)*q(1)
  end function cross

  !> Area, or volume per radian.
  pure function volume_of(shape, is_round) result(volume)
    type(shape_t), intent(in) :: shape
    logical, intent(in) :: is_round
    type(dual_t) :: volume

    volume = 0.5_wp*cross(shape%a, shape%b)
    if (is_round) volume = 0.25_wp*shape%s*volume + part*(shape%h(1)*(shape%a(1)*shape%b(2) &
      + shape%b(1)*shape%a(2)) - 2.0_wp*(shape%a(1)*shape%b(1)*shape%h(2)))
  end function volume_of

  !> The same at time zero.
  pure function start_volume(x, is_round) result(start)
    real(wp), intent(in) :: x(2, 4)
    logical, intent(in) :: is_round
    real(wp) :: start
    type(dual_t) :: volume

    volume = volume_of(shape_of(x), is_round)
    start = volume%value
  end function start_volume

  !> Integrals over a round quad.
  pure subroutine form_integrals(shape, integrals)
    type(shape_t), intent(in) :: shape
    type(integrals_t), intent(out) :: integrals
    type(dual_t) :: s

    s = 0.125_wp*shape%s
    associate (a => shape%a, b => shape%b, h => shape%h)
      integrals%volume = volume_of(shape, .true.)
      integrals%rad(1) = s*b(2) - part*(b(1)*h(2))
      integrals%rad(2) = -(s*a(2) + part*(a(1)*h(2)))
      integrals%rad(3) = part*(a(1)*b(2) + b(1)*a(2))
      integrals%axi(1) = -(b(1)*(s - part*h(1)))
      integrals%axi(2) = a(1)*(s + part*h(1))
      integrals%axi(3) = (-2.0_wp*part)*(a(1)*b(1))
      integrals%mean(1) = part*(h(1)*b(2) - h(2)*b(1))
      integrals%mean(2) = part*(h(1)*a(2) - h(2)*a(1))
      integrals%mean(3) = 0.125_wp*cross(a, b)
    end associate
  end subroutine form_integrals

  !> Gradient of a change in the plane, at the centre.
  pure subroutine form_gradient(shape, change, gradient)
    type(shape_t), intent(in) :: shape, change
    type(dual_t), intent(out) :: gradient(2, 2)
    type(dual_t) :: inverse
    integer :: i

    inverse = constant(1.0_wp)/cross(shape%a, shape%b)
    do i = 1, 2
      gradient(i, 1) = inverse*(change%a(i)*shape%b(2) - change%b(i)*shape%a(2))
      gradient(i, 2) = inverse*(change%b(i)*shape%a(1) - change%a(i)*shape%b(1))
    end do
  end subroutine form_gradient

  !> Gradient and rotation of the step, from the mid-step shape.
  pure subroutine find_increment(is_round, middle, change, increment)
    logical, intent(in) :: is_round
    type(shape_t), intent(in) :: middle, change
    type(increment_t), intent(out) :: increment
    type(integrals_t) :: over
    integer :: i

    increment%hoop = constant(0.0_wp)
    if (is_round) then
      call form_integrals(middle, over)
      do i = 1, 2
        increment%gradient(i, 1) = (over%rad(1)*change%a(i) + over%rad(2)*change%b(i) &
          + over%rad(3)*change%h(i))/over%volume
        increment%gradient(i, 2) = (over%axi(1)*change%a(i) + over%axi(2)*change%b(i) &
          + over%axi(3)*change%h(i))/over%volume
      end do
      increment%hoop = (over%mean(1)*change%a(1) + over%mean(2)*change%b(1) &
        + over%mean(3)*change%s)/over%volume
    else
      call form_gradient(middle, change, increment%gradient)
    end if
  end subroutine find_increment

  !> Deviator xx yy xy and zz (hoop) at the end of the step, and the cosine of its rotation.
  pure subroutine find_stress(material, increment, point, stress)
    type(material_t), intent(in) :: material
    type(increment_t), intent(inout) :: increment !! `cosine` out
    type(stress_point_t), intent(inout) :: point
    type(dual_t), intent(out) :: stress(4)
    type(dual_t) :: tan_half, square, sine, strain(3), half, shear, parts(3)
    integer :: i, j

    associate (g => increment%gradient)
      tan_half = 0.25_wp*(g(2, 1) - g(1, 2))
      square = tan_half*tan_half
      increment%cosine = (1.0_wp - square)/(square + 1.0_wp)
      sine = 2.0_wp*tan_half/(square + 1.0_wp)
      half = 0.5_wp*(g(1, 1) - g(2, 2))
      shear = 0.5_wp*(g(1, 2) + g(2, 1))
      strain(1) = 0.5_wp*(g(1, 1) + g(2, 2)) - increment%hoop
      strain(2) = increment%cosine*half - sine*shear
      strain(3) = sine*half + increment%cosine*shear
    end associate
    point%strain = strain%value
    point%cos2 = increment%cosine%value**2 - sine%value**2
    point%sin2 = 2.0_wp*increment%cosine%value*sine%value
    call form_tangent(material, point)
    do i = 1, 3
      parts(i)%value = point%stress(i)
      ! The angle is twice atan(tan_half).
      parts(i)%slope = point%tangent(i, 4)*2.0_wp/(1.0_wp + square%value)*tan_half%slope
      do j = 1, 3
        parts(i)%slope = parts(i)%slope + point%tangent(i, j)*strain(j)%slope
      end do
    end do
    stress(1) = parts(1) + parts(2)
    stress(2) = parts(1) - parts(2)
    stress(3) = parts(3)
    stress(4) = (-2.0_wp)*parts(1)
  end subroutine find_stress

  !> Add K ln(V/V0) to xx, yy and zz.
  pure subroutine add_pressure(bulk, start, volume, stress)
    real(wp), intent(in) :: bulk, start
    type(dual_t), intent(in) :: volume
    type(dual_t), intent(inout) :: stress(4)
    type(dual_t) :: pressure

    pressure%value = bulk*log_ratio((volume%value - start)/start)
    pressure%slope = bulk/volume%value*volume%slope
    stress(1) = stress(1) + pressure
    stress(2) = stress(2) + pressure
    stress(4) = stress(4) + pressure
  end subroutine add_pressure

  !> Hourglass force q_x, q_y per unit of depth (`assumed_strain`).
  pure subroutine find_resistance(material, hourglass, old, now, middle, change, cosine, q)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: hourglass
    real(wp), intent(in) :: old(2)          !! stress at the start of the step
    type(shape_t), intent(in) :: now, middle, change
    type(dual_t), intent(in) :: cosine      !! of the rotation in the step
    type(dual_t), intent(out) :: q(2)
    type(dual_t) :: gradient(2, 2), growth(2), a(2), b(2), frame(2), weight, stress(2), mixed
    real(wp) :: factor, lateral
    integer :: i

    call form_moduli(material, hourglass, factor, lateral)
    call form_gradient(middle, change, gradient)
    do i = 1, 2
      growth(i) = change%h(i) - (gradient(i, 1)*middle%h(1) + gradient(i, 2)*middle%h(2))
    end do
    frame = frame_of(middle)
    weight = sqrt(0.5_wp*(cosine + 1.0_wp))
    a = into(frame, middle%a)
    b = into(frame, middle%b)
    growth = into(frame, growth)
    growth(1) = weight*growth(1)
    growth(2) = weight*growth(2)
    weight = constant(4.0_wp*factor/3.0_wp)/cross(a, b)
    mixed = lateral*(weight*(a(1)*a(2) + b(1)*b(2)))
    stress(1) = weight*(a(2)*a(2) + b(2)*b(2))*growth(1) + mixed*growth(2) + old(1)
    stress(2) = weight*(a(1)*a(1) + b(1)*b(1))*growth(2) + mixed*growth(1) + old(2)
    frame = frame_of(now)
    q(1) = frame(1)*stress(1) - frame(2)*stress(2)
    q(2) = frame(2)*stress(1) + frame(1)*stress(2)
  end subroutine find_resistance

  !> First axis of the element's frame.
  pure function frame_of(shape) result(frame)
    type(shape_t), intent(in) :: shape
    type(dual_t) :: frame(2)
    type(dual_t) :: length

    frame(1) = (shape%a(1) - shape%b(1)) + (shape%a(2) + shape%b(2))
    frame(2) = (shape%a(2) - shape%b(2)) - (shape%a(1) + shape%b(1))
    length = sqrt(frame(1)*frame(1) + frame(2)*frame(2))
    frame(1) = frame(1)/length
    frame(2) = frame(2)/length
  end function frame_of

  !> Components of a vector in a frame.
  pure function into(frame, vector) result(found)
    type(dual_t), intent(in) :: frame(2), vector(2)
    type(dual_t) :: found(2)

    found(1) = frame(1)*vector(1) + frame(2)*vector(2)
    found(2) = frame(1)*vector(2) - frame(2)*vector(1)
  end function into

  !> What h contributes to a and b in gamma, in a first.
  pure function pattern_shares(shape) result(shares)
    type(shape_t), intent(in) :: shape
    type(dual_t) :: shares(2)
    type(dual_t) :: inverse

    inverse = constant(1.0_wp)/cross(shape%a, shape%b)
    shares(1) = inverse*cross(shape%b, shape%h)
    shares(2) = inverse*cross(shape%h, shape%a)
  end function pattern_shares

  !> Forces of the plane quad on the patterns.
  pure subroutine form_plane_force(now, stress, q, force)
    type(shape_t), intent(in) :: now
    type(dual_t), intent(in) :: stress(4), q(2)
    type(dual_t), intent(out) :: force(n_pattern)
    type(dual_t) :: shares(2)

    shares = pattern_shares(now)
    force(1) = 0.5_wp*(stress(1)*now%b(2) - stress(3)*now%b(1)) + shares(1)*q(1)
    force(2) = 0.5_wp*(stress(3)*now%b(2) - stress(2)*now%b(1)) + shares(1)*q(2)
    force(3) = 0.5_wp*(stress(3)*now%a(1) - stress(1)*now%a(2)) + shares(2)*q(1)
    force(4) = 0.5_wp*(stress(2)*now%a(1) - stress(3)*now%a(2)) + shares(2)*q(2)
    force(5:6) = q
    force(7) = constant(0.0_wp)
  end subroutine form_plane_force

  !> Forces of the round quad on the patterns, per radian.
  pure subroutine form_round_force(now, stress, q, force)
    type(shape_t), intent(in) :: now
    type(dual_t), intent(in) :: stress(4), q(2)
    type(dual_t), intent(out) :: force(n_pattern)
    type(integrals_t) :: over
    type(dual_t) :: shares(3), radius, rest(2)
    integer :: k

    call form_integrals(now, over)
    shares(1:2) = pattern_shares(now)
    shares(3) = constant(1.0_wp)
    radius = 2.0_wp*over%volume/cross(now%a, now%b)
    rest(1) = radius*q(1)
    rest(2) = radius*q(2)
    do k = 1, 3
      force(2*k - 1) = over%rad(k)*stress(1) + over%axi(k)*stress(3) + shares(k)*rest(1)
      force(2*k) = over%rad(k)*stress(3) + over%axi(k)*stress(2) + shares(k)*rest(2)
      if (k < 3) force(2*k - 1) = force(2*k - 1) + over%mean(k)*stress(4)
    end do
    force(7) = over%mean(3)*stress(4)
  end subroutine form_round_force

end module one_point_tangent_m
