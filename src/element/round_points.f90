! SPDX-License-Identifier: MIT
!> What the four Gauss points of a round quad have besides those of a plane one: their radius, and
!> the hoop strain and force that go with it.
module round_points_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use quad_points_m, only : n_point, point_ratios, shape_at_points
  use round_chunk_m, only : round_chunk_t, reference_sum
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: round_point_t, form_radii, add_hoop_strain, add_hoop_force, round_point_ratios, &
    along_a, along_b, along_h

  real(wp), parameter :: g = 0.25_wp*0.577350269189625764509148780501957455_wp !! 1/(4 sqrt(3))
  !> Shape functions at the points in the patterns: a quarter of s, and of a, b and h these.
  real(wp), parameter :: along_a(n_point) = 2.0_wp*g*[-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], &
    along_b(n_point) = 2.0_wp*g*[0.0_wp, -1.0_wp, 0.0_wp, 1.0_wp], &
    along_h(n_point) = [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp]/12.0_wp

  !> One point of a chunk.
  type :: round_point_t
    real(wp), dimension(chunk_size) :: radius, speed     !! r and v_r, now
    real(wp), dimension(chunk_size) :: volume            !! that it stands for, now
    real(wp), dimension(chunk_size) :: stretch           !! J - 1
    real(wp), dimension(chunk_size) :: c33, c44, c34     !! products of the gradients of d31, d42
  end type round_point_t

contains

  !> Radius, volume and J - 1 of point `k`, whose plane shape is there.
  pure subroutine form_radii(k, reference, stride, chunk, round, point, place)
    integer, intent(in) :: k
    integer, intent(in) :: stride
    real(wp), intent(in) :: reference(stride, *) !! first slot of the chunk
    type(element_chunk_t), intent(in) :: chunk
    type(round_chunk_t), intent(in) :: round
    type(element_chunk_t), intent(in) :: point
    type(round_point_t), intent(inout) :: place
    real(wp) :: start, growth, factor
    integer :: i

    !$omp simd private(start, growth, factor)
    do i = 1, chunk_size
      start = 0.25_wp*reference(i, reference_sum) + (along_a(k)*reference(i, 1) &
        + along_b(k)*reference(i, 3) + along_h(k)*reference(i, 5))
      growth = 0.25_wp*round%us(i) + (along_a(k)*chunk%u31(1, i) + along_b(k)*chunk%u42(1, i) &
        + along_h(k)*chunk%hu(1, i))
      place%radius(i) = start + growth
      place%speed(i) = 0.25_wp*round%vs(i) + (along_a(k)*chunk%v31(1, i) &
        + along_b(k)*chunk%v42(1, i) + along_h(k)*chunk%hv(1, i))
      place%volume(i) = 0.25_wp*point%area(i)*place%radius(i)
      ! (1 + A/A0 - 1)(1 + growth/start) - 1.
      place%stretch(i) = point%stretch(i) + (1.0_wp + point%stretch(i))*growth/start
      factor = 0.25_wp*point%inverse_area(i)**2
      place%c33(i) = factor*(point%x42(i)**2 + point%y42(i)**2)
      place%c44(i) = factor*(point%x31(i)**2 + point%y31(i)**2)
      place%c34(i) = -factor*(point%x31(i)*point%x42(i) + point%y31(i)*point%y42(i))
    end do
  end subroutine form_radii

  !> The hoop rate in the mid-step shape, as `form_round_increments` has it; the mid-step area
  !> becomes the volume.
  pure subroutine add_hoop_strain(dt, place, point, stress)
    real(wp), intent(in) :: dt
    type(round_point_t), intent(in) :: place
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
      point%mid_area(i) = 0.25_wp*point%mid_area(i)*radius
    end do
  end subroutine add_hoop_strain

  !> Weigh the plane force of point `k` with its radius and add the force of the hoop stress.
  pure subroutine add_hoop_force(k, place, stress, point, chunk, round)
    integer, intent(in) :: k
    type(round_point_t), intent(in) :: place
    type(stress_chunk_t), intent(in) :: stress
    type(element_chunk_t), intent(inout) :: point   !! pressure in; force in and out
    type(element_chunk_t), intent(inout) :: chunk
    type(round_chunk_t), intent(inout) :: round
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
      round%hoop(i) = round%hoop(i) + 0.25_wp*force
    end do
  end subroutine add_hoop_force

  !> J - 1 at the points of one element and the initial volume that each stands for.
  pure subroutine round_point_ratios(x, u, stretch, start)
    real(wp), intent(in) :: x(2, 4), u(2, 4)  !! corners at the start, displacements
    real(wp), intent(out) :: stretch(n_point), start(n_point)
    real(wp) :: reference(6), radius, growth
    integer :: k

    reference = [x(:, 3) - x(:, 1), x(:, 4) - x(:, 2), (x(:, 1) - x(:, 2)) + (x(:, 3) - x(:, 4))]
    call point_ratios(reference, u, stretch, start)
    do k = 1, n_point
      radius = dot_product(shape_at_points(:, k), x(1, :))
      growth = dot_product(shape_at_points(:, k), u(1, :))
      stretch(k) = stretch(k) + (1.0_wp + stretch(k))*growth/radius
      start(k) = start(k)*radius
    end do
  end subroutine round_point_ratios

end module round_points_m
