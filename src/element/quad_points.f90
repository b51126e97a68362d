! SPDX-License-Identifier: MIT
!> The four Gauss points of a quad, point k beside node k. With xi, eta = +-1/sqrt(3) the gradients
!> of the bilinear map at a point are those of a parallelogram: its diagonals are d31 and d42 of the
!> element, one of them longer or shorter by h.x/sqrt(3); it stands for a quarter of its area.
module quad_points_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use element_chunk_m, only : element_chunk_t
  implicit none
  private
  public :: n_point, shift, shape_at_points, form_point, add_point_force, point_ratios, &
    point_areas, signed_area

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

  !> Add the forces of point `k` to those of its elements.
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

  !> J - 1 at the points of one element, and the initial area that each stands for.
  pure subroutine point_ratios(reference, u, stretch, start)
    real(wp), intent(in) :: reference(6) !! X31 Y31 X42 Y42 h.X h.Y
    real(wp), intent(in) :: u(2, 4)      !! displacement of the nodes
    real(wp), intent(out) :: stretch(n_point), start(n_point)
    real(wp), dimension(2) :: p, q, d, e, h
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
  end subroutine point_ratios

  !> Area that each point of one element stands for.
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

end module quad_points_m
