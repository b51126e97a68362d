! SPDX-License-Identifier: MIT
!> The four Gauss points of a quad, point k beside node k. With xi, eta = +-1/sqrt(3) the gradients
!> of the bilinear map at a point are those of a parallelogram: its diagonals are d31 and d42 of the
!> element, one of them longer or shorter by h.x/sqrt(3); it stands for a quarter of its area.
module quad_points_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use element_chunk_m, only : element_chunk_t, reference_sum
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: n_point, shift, shape_at_points, form_point, add_point_force, point_ratios, &
    point_areas, axisym_point_t, form_radii, add_hoop_strain, add_hoop_force, &
    along_a, along_b, along_h, step_sums_t, add_point_sums, form_row_sums

  !> Points of a quad.
  integer, parameter :: n_point = 4
  real(wp), parameter :: third_root = 0.577350269189625764509148780501957455_wp !! 1/sqrt(3)
  !> shift(:, k): d31 and d42 of point k are those of the element plus this times h.x.
  real(wp), parameter :: shift(2, n_point) = third_root*reshape([-1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, &
    1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp], [2, n_point])
  real(wp), parameter :: near = 0.25_wp*(1.0_wp + third_root)**2, beside = 0.25_wp*2.0_wp/3.0_wp, &
    far = 0.25_wp*(1.0_wp - third_root)**2
  !> shape_at_points(a, k): shape function of node a at point k.
  real(wp), parameter :: shape_at_points(4, n_point) = reshape([near, beside, far, beside, &
    beside, near, beside, far, far, beside, near, beside, beside, far, beside, near], [4, n_point])

  real(wp), parameter :: g = 0.25_wp*third_root !! 1/(4 sqrt(3))
  !> Shape functions at the points in the patterns: a quarter of s, and these factors of a, b and h.
  real(wp), parameter :: along_a(n_point) = 2.0_wp*g*[-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], &
    along_b(n_point) = 2.0_wp*g*[0.0_wp, -1.0_wp, 0.0_wp, 1.0_wp], &
    along_h(n_point) = [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp]/12.0_wp

  !> Data of a point of axisymmetric quads: radius and data of the stable step.
  type :: axisym_point_t
    real(wp), dimension(chunk_size) :: radius, speed     !! r and v_r, now
    real(wp), dimension(chunk_size) :: volume            !! present volume of the point
    real(wp), dimension(chunk_size) :: stretch           !! J - 1
    real(wp), dimension(chunk_size) :: c33, c44, c34     !! products of the gradients of d31, d42
  end type axisym_point_t

  !> Values at the nodes from values at the points: factors of the own point, of the two neighbours,
  !> of the opposite one.
  real(wp), parameter :: own_share = 0.25_wp*(1.0_wp + sqrt(3.0_wp))**2, &
    next_share = -0.5_wp, far_share = 0.25_wp*(1.0_wp - sqrt(3.0_wp))**2
  !> Radii below this share of those of the points are round-off.
  real(wp), parameter :: on_axis = 1.0e-12_wp

  !> Sums over the points for the stable step: of plane quads the scalar matrix in d31, d42 and h.x
  !> (11 22 12 13 23 33), of axisymmetric ones the largest row sums of H and T
  !> (`axisymmetric_full_step`); smallest J.
  type :: step_sums_t
    real(wp) :: h(chunk_size, 6)
    real(wp), dimension(chunk_size) :: plane, hoop
    real(wp) :: volume(chunk_size)
  end type step_sums_t

contains

  !> Diagonals of point `k` of a chunk: reference shape, displacement and velocity.
  pure subroutine form_point(k, stride, reference, element, point_reference, point)
    integer, intent(in) :: k
    integer, intent(in) :: stride                  !! length of one stream
    real(wp), intent(in) :: reference(stride, *)   !! X31 Y31 X42 Y42 h.X h.Y, first slot of the
                                                   !! chunk
    type(element_chunk_t), intent(in) :: element
    real(wp), intent(out) :: point_reference(chunk_size, 6) !! the same of the point, without h.X,
                                                            !! h.Y
    type(element_chunk_t), intent(inout) :: point
    integer :: i

    !$omp simd
    do i = 1, chunk_size
      point_reference(i, 1) = reference(i, 1) + shift(1, k)*reference(i, 5)
      point_reference(i, 2) = reference(i, 2) + shift(1, k)*reference(i, 6)
      point_reference(i, 3) = reference(i, 3) + shift(2, k)*reference(i, 5)
      point_reference(i, 4) = reference(i, 4) + shift(2, k)*reference(i, 6)
    end do
    point_reference(:, 5:6) = 0.0_wp
    point%u31 = element%u31 + shift(1, k)*element%hu
    point%v31 = element%v31 + shift(1, k)*element%hv
    point%u42 = element%u42 + shift(2, k)*element%hu
    point%v42 = element%v42 + shift(2, k)*element%hv
  end subroutine form_point

  !> Add the forces of point `k` to its elements.
  pure subroutine add_point_force(k, point, element)
    integer, intent(in) :: k
    type(element_chunk_t), intent(in) :: point      !! `force` as of a one-point element
    type(element_chunk_t), intent(inout) :: element !! `force` and `swing`
    integer :: i

    !$omp simd
    do i = 1, chunk_size
      element%force3(1, i) = element%force3(1, i) + 0.25_wp*point%force3(1, i)
      element%force3(2, i) = element%force3(2, i) + 0.25_wp*point%force3(2, i)
      element%force4(1, i) = element%force4(1, i) + 0.25_wp*point%force4(1, i)
      element%force4(2, i) = element%force4(2, i) + 0.25_wp*point%force4(2, i)
      element%swing(1, i) = element%swing(1, i) &
        + (0.25_wp*shift(1, k)*point%force3(1, i) + 0.25_wp*shift(2, k)*point%force4(1, i))
      element%swing(2, i) = element%swing(2, i) &
        + (0.25_wp*shift(1, k)*point%force3(2, i) + 0.25_wp*shift(2, k)*point%force4(2, i))
    end do
  end subroutine add_point_force

  !> J - 1 at the points of one element, and the initial area, or volume per radian, of each.
  pure subroutine point_ratios(is_axisymmetric, reference, u, stretch, start)
    logical, intent(in) :: is_axisymmetric
    real(wp), intent(in) :: reference(reference_sum) !! X31 Y31 X42 Y42 h.X h.Y, and of axisymmetric
                                                     !! quads the sum of the radii
    real(wp), intent(in) :: u(2, 4)                  !! displacement of the nodes
    real(wp), intent(out) :: stretch(n_point), start(n_point)
    real(wp), dimension(2) :: p, q, d, e, h
    real(wp) :: radius
    integer :: k

    h = (u(:, 1) - u(:, 2)) + (u(:, 3) - u(:, 4))
    do k = 1, n_point
      p = reference(1:2) + shift(1, k)*reference(5:6)
      q = reference(3:4) + shift(2, k)*reference(5:6)
      d = (u(:, 3) - u(:, 1)) + shift(1, k)*h
      e = (u(:, 4) - u(:, 2)) + shift(2, k)*h
      start(k) = 0.25_wp*signed_area(p, q)
      ! J - 1 from the displacement, so that no digit of a small strain is lost.
      stretch(k) = 0.25_wp*(signed_area(p, e) + signed_area(d, q + e))/start(k)
    end do
    if (.not. is_axisymmetric) return
    do k = 1, n_point
      radius = 0.25_wp*reference(reference_sum) + along_a(k)*reference(1) &
        + along_b(k)*reference(3) + along_h(k)*reference(5)
      stretch(k) = stretch(k) + (1.0_wp + stretch(k))*dot_product(shape_at_points(:, k), u(1, :)) &
        /radius
      start(k) = start(k)*radius
    end do
  end subroutine point_ratios

  !> Area of each point of one element.
  pure function point_areas(x) result(areas)
    real(wp), intent(in) :: x(2, 4) !! corners
    real(wp) :: areas(n_point)
    real(wp) :: h(2)
    integer :: k

    h = (x(:, 1) - x(:, 2)) + (x(:, 3) - x(:, 4))
    do k = 1, n_point
      areas(k) = 0.25_wp*signed_area((x(:, 3) - x(:, 1)) + shift(1, k)*h, &
        (x(:, 4) - x(:, 2)) + shift(2, k)*h)
    end do
  end function point_areas

  !> Area of a quad with these diagonals.
  pure function signed_area(d31, d42) result(area)
    real(wp), intent(in) :: d31(2), d42(2)
    real(wp) :: area

    area = 0.5_wp*(d31(1)*d42(2) - d42(1)*d31(2))
  end function signed_area

  !> Radius, volume and J - 1 of point `k`, whose plane shape is set.
  pure subroutine form_radii(k, reference, stride, chunk, point, place)
    integer, intent(in) :: k
    integer, intent(in) :: stride
    real(wp), intent(in) :: reference(stride, *) !! first slot of the chunk
    type(element_chunk_t), intent(in) :: chunk
    type(element_chunk_t), intent(inout) :: point !! `volume` and `stretch` out
    type(axisym_point_t), intent(inout) :: place
    real(wp) :: start, growth, factor
    integer :: i

    !$omp simd private(start, growth, factor)
    do i = 1, chunk_size
      start = 0.25_wp*reference(i, reference_sum) + (along_a(k)*reference(i, 1) &
        + along_b(k)*reference(i, 3) + along_h(k)*reference(i, 5))
      growth = 0.25_wp*chunk%us(i) + (along_a(k)*chunk%u31(1, i) + along_b(k)*chunk%u42(1, i) &
        + along_h(k)*chunk%hu(1, i))
      place%radius(i) = start + growth
      place%speed(i) = 0.25_wp*chunk%vs(i) + (along_a(k)*chunk%v31(1, i) &
        + along_b(k)*chunk%v42(1, i) + along_h(k)*chunk%hv(1, i))
      place%volume(i) = 0.25_wp*point%area(i)*place%radius(i)
      ! (1 + A/A0 - 1)(1 + growth/start) - 1.
      place%stretch(i) = point%stretch(i) + (1.0_wp + point%stretch(i))*growth/start
      factor = 0.25_wp*point%inverse_area(i)**2
      place%c33(i) = factor*(point%x42(i)**2 + point%y42(i)**2)
      place%c44(i) = factor*(point%x31(i)**2 + point%y31(i)**2)
      place%c34(i) = -factor*(point%x31(i)*point%x42(i) + point%y31(i)*point%y42(i))
      point%stretch(i) = place%stretch(i)
      point%volume(i) = place%volume(i)
    end do
  end subroutine form_radii

  !> Hoop rate in the mid-step shape, as in `form_axisym_increments`; the area of the point becomes
  !> a volume.
  pure subroutine add_hoop_strain(dt, place, point, stress)
    real(wp), intent(in) :: dt
    type(axisym_point_t), intent(in) :: place
    type(element_chunk_t), intent(inout) :: point
    type(stress_chunk_t), intent(inout) :: stress
    real(wp) :: radius, hoop
    integer :: i

    stress%has_hoop = .true.
    !$omp simd private(radius, hoop)
    do i = 1, chunk_size
      radius = place%radius(i) - 0.5_wp*dt*place%speed(i)
      hoop = dt*place%speed(i)/radius
      stress%hoop(i) = hoop
      stress%dxx(i) = stress%dxx(i) - hoop
      stress%dyy(i) = stress%dyy(i) - hoop
      point%mid_area(i) = point%mid_area(i)*radius
    end do
  end subroutine add_hoop_strain

  !> Weight the plane force of point `k` with its radius and add the force of the hoop stress.
  pure subroutine add_hoop_force(k, place, stress, point, chunk)
    integer, intent(in) :: k
    type(axisym_point_t), intent(in) :: place
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: point   !! pressure in; force in and out
    type(element_chunk_t), intent(inout) :: chunk
    real(wp) :: force
    integer :: i

    !$omp simd private(force)
    do i = 1, chunk_size
      point%force3(1, i) = place%radius(i)*point%force3(1, i)
      point%force3(2, i) = place%radius(i)*point%force3(2, i)
      point%force4(1, i) = place%radius(i)*point%force4(1, i)
      point%force4(2, i) = place%radius(i)*point%force4(2, i)
      force = 0.25_wp*point%area(i)*(point%pressure(i) - (stress%sxx(i) + stress%syy(i)))
      chunk%force3(1, i) = chunk%force3(1, i) + along_a(k)*force
      chunk%force4(1, i) = chunk%force4(1, i) + along_b(k)*force
      chunk%swing(1, i) = chunk%swing(1, i) + along_h(k)*force
      chunk%hoop(i) = chunk%hoop(i) + 0.25_wp*force
    end do
  end subroutine add_hoop_force

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

  !> Largest row sums of the matrices H and T (`axisymmetric_full_step`) of the elements, over the
  !> volumes of the nodes. H is that of the patterns (s11 s22 s12 s13 s23 s33), of which the nodes
  !> have (-1, 0, 1), (0, -1, -1), (1, 0, 1) and (0, 1, -1); rows of T sum to the integral of
  !> N_a/r dA, but for what is held on the axis.
  pure subroutine form_row_sums(inverse_mass, stride, points, sums)
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *)
    type(axisym_point_t), intent(in) :: points(n_point)
    type(step_sums_t), intent(inout) :: sums
    real(wp), dimension(chunk_size, 6) :: s
    real(wp), dimension(chunk_size, 4) :: t, is_off
    real(wp) :: v, h11, h22, h33, h44, h12, h13, h14, h23, h24, h34, w3, only
    integer :: i, k

    s = 0.0_wp
    t = 0.0_wp
    sums%volume = huge(1.0_wp)
    call mark_off_axis(points, is_off)
    do k = 1, n_point
      associate (place => points(k))
        !$omp simd private(v)
        do i = 1, chunk_size
          v = place%volume(i)
          s(i, 1) = s(i, 1) + v*place%c33(i)
          s(i, 2) = s(i, 2) + v*place%c44(i)
          s(i, 3) = s(i, 3) + v*place%c34(i)
          s(i, 4) = s(i, 4) + v*(shift(1, k)*place%c33(i) + shift(2, k)*place%c34(i))
          s(i, 5) = s(i, 5) + v*(shift(1, k)*place%c34(i) + shift(2, k)*place%c44(i))
          s(i, 6) = s(i, 6) + v*(shift(1, k)**2*place%c33(i) + shift(2, k)**2*place%c44(i))
          v = v/(place%radius(i)*place%radius(i))*((is_off(i, 1)*shape_at_points(1, k) &
            + is_off(i, 2)*shape_at_points(2, k)) + (is_off(i, 3)*shape_at_points(3, k) &
            + is_off(i, 4)*shape_at_points(4, k)))
          t(i, 1) = t(i, 1) + v*shape_at_points(1, k)
          t(i, 2) = t(i, 2) + v*shape_at_points(2, k)
          t(i, 3) = t(i, 3) + v*shape_at_points(3, k)
          t(i, 4) = t(i, 4) + v*shape_at_points(4, k)
          sums%volume(i) = min(sums%volume(i), place%stretch(i) + 1.0_wp, sign(1.0e3_wp, &
            place%radius(i)))
        end do
      end associate
    end do
    t = t*is_off
    !$omp simd private(h11, h22, h33, h44, h12, h13, h14, h23, h24, h34, w3, only)
    do i = 1, chunk_size
      h11 = s(i, 1) - 2.0_wp*s(i, 4) + s(i, 6)
      h33 = s(i, 1) + 2.0_wp*s(i, 4) + s(i, 6)
      h22 = s(i, 2) + 2.0_wp*s(i, 5) + s(i, 6)
      h44 = s(i, 2) - 2.0_wp*s(i, 5) + s(i, 6)
      h12 = (s(i, 3) + s(i, 4)) - (s(i, 5) + s(i, 6))
      h13 = s(i, 6) - s(i, 1)
      h14 = (s(i, 4) - s(i, 3)) + (s(i, 5) - s(i, 6))
      h23 = -((s(i, 3) + s(i, 5)) + (s(i, 4) + s(i, 6)))
      h24 = s(i, 6) - s(i, 2)
      h34 = (s(i, 3) - s(i, 4)) + (s(i, 5) - s(i, 6))
      w3 = inverse_mass(i, 3)
      ! A triangle's fourth node equals its third: merge row and column.
      only = merge(1.0_wp, 0.0_wp, inverse_mass(i, 4) <= 0.0_wp)
      t(i, 3) = t(i, 3) + only*t(i, 4)
      h33 = h33 + only*(2.0_wp*h34 + h44)
      h13 = h13 + only*h14
      h23 = h23 + only*h24
      h14 = (1.0_wp - only)*h14
      h24 = (1.0_wp - only)*h24
      h34 = (1.0_wp - only)*h34
      sums%plane(i) = max(inverse_mass(i, 1)*(h11 + abs(h12) + abs(h13) + abs(h14)), &
        inverse_mass(i, 2)*(h22 + abs(h12) + abs(h23) + abs(h24)), &
        w3*(h33 + abs(h13) + abs(h23) + abs(h34)), &
        inverse_mass(i, 4)*(h44 + abs(h14) + abs(h24) + abs(h34)))
      sums%hoop(i) = max(inverse_mass(i, 1)*t(i, 1), inverse_mass(i, 2)*t(i, 2), w3*t(i, 3), &
        inverse_mass(i, 4)*t(i, 4))
    end do
  end subroutine form_row_sums

  !> 1 at nodes off the axis, 0 on it.
  pure subroutine mark_off_axis(points, is_off)
    type(axisym_point_t), intent(in) :: points(n_point)
    real(wp), intent(out) :: is_off(chunk_size, 4)
    real(wp) :: least
    integer :: i, a

    do a = 1, 4
      associate (own => points(a)%radius, next => points(1 + modulo(a, 4))%radius, &
        opposite => points(1 + modulo(a + 1, 4))%radius, &
        last => points(1 + modulo(a + 2, 4))%radius)
        !$omp simd private(least)
        do i = 1, chunk_size
          least = on_axis*((own(i) + opposite(i)) + (next(i) + last(i)))
          is_off(i, a) = merge(0.0_wp, 1.0_wp, abs(own_share*own(i) + far_share*opposite(i) &
            + next_share*(next(i) + last(i))) <= least)
        end do
      end associate
    end do
  end subroutine mark_off_axis

end module quad_points_m
