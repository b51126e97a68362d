! SPDX-License-Identifier: MIT
!> Stable step of fully integrated round quads: a lower bound of 2/omega_max of the single element
!> with its row-sum masses in its present shape, u_r = 0 on the axis. With H the matrix of
!> |grad v|^2 and T that of (v_r/r)^2 of nodes off the axis over the masses, their largest row sums
!> bound their eigenvalues, and with D:C:D <= 2G (|grad v|^2 + (v_r/r)^2) + lambda (div v + v_r/r)^2
!>   omega^2 <= 2G (H + T) + lambda (sqrt(2H) + sqrt(T))^2,   K for lambda with mean dilatation.
module round_full_step_m
  use kinds_m, only : wp
  use element_chunk_m, only : element_chunk_t
  use layout_m, only : chunk_size
  use parts_m, only : hourglass_t, material_t
  use quad_full_m, only : has_mean_dilatation
  use quad_points_m, only : n_point, shape_at_points, shift
  use round_points_m, only : round_point_t
  implicit none
  private
  public :: round_full_step, single_round_full_steps

  !> Values at the nodes from those at the points: of its own, of the two beside it, of the far one.
  real(wp), parameter :: root = sqrt(3.0_wp), near = 0.25_wp*(1.0_wp + root)**2, beside = -0.5_wp, &
    far = 0.25_wp*(1.0_wp - root)**2
  !> Radii below this share of those of the points are round-off.
  real(wp), parameter :: on_axis = 1.0e-12_wp

contains

  !> Smallest step of the chunk, and its smallest volume ratio at a point.
  pure subroutine round_full_step(material, viscosity, inverse_mass, stride, chunk, points, limit, &
    volume)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity      !! its Q1 and Q2 count
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *) !! density over mass, first slot of the chunk; 0
                                                    !! at the fourth node of a triangle
    type(element_chunk_t), intent(in) :: chunk
    type(round_point_t), intent(in) :: points(n_point)
    real(wp), intent(out) :: limit                  !! s
    real(wp), intent(out) :: volume                 !! smallest J
    real(wp) :: modulus, squared, rate, length, largest, step
    real(wp), dimension(chunk_size) :: plane, hoop, both
    integer :: i, k

    modulus = material%bulk
    if (.not. has_mean_dilatation(material)) &
      modulus = max(0.0_wp, material%bulk - 2.0_wp*material%shear/3.0_wp)
    call row_sums(inverse_mass, stride, points, plane, hoop)
    volume = huge(1.0_wp)
    do k = 1, n_point
      volume = min(volume, minval(points(k)%stretch) + 1.0_wp, &
        sign(1.0e3_wp, minval(points(k)%radius)))
    end do
    largest = 0.0_wp
    !$omp simd private(squared) reduction(max : largest)
    do i = 1, chunk_size
      both(i) = 2.0_wp*plane(i) + hoop(i) + 2.0_wp*sqrt(2.0_wp*plane(i)*hoop(i))
      squared = 2.0_wp*material%shear*(plane(i) + hoop(i)) + modulus*both(i)
      largest = max(largest, squared)
    end do
    limit = 2.0_wp/sqrt(largest/material%density)
    if (.not. (viscosity%quadratic > 0.0_wp .or. viscosity%linear > 0.0_wp)) return
    step = limit
    do i = 1, chunk_size
      length = sqrt(abs(chunk%area(i)))
      rate = length/abs(1.0_wp + chunk%stretch(i))*(viscosity%linear*material%sound_speed &
        + viscosity%quadratic*length*abs(chunk%trace(i)))*both(i)
      limit = min(limit, step/(1.0_wp + 0.5_wp*step*rate))
    end do
  end subroutine round_full_step

  !> The steps of the elements, each by the same bound alone.
  pure subroutine single_round_full_steps(material, viscosity, inverse_mass, stride, chunk, &
      points, single)
    type(material_t), intent(in) :: material
    type(hourglass_t), intent(in) :: viscosity
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *) !! as above
    type(element_chunk_t), intent(in) :: chunk
    type(round_point_t), intent(in) :: points(n_point)
    real(wp), intent(out) :: single(chunk_size)     !! s
    real(wp), dimension(chunk_size) :: plane, hoop, both, rate, length
    real(wp) :: modulus

    modulus = material%bulk
    if (.not. has_mean_dilatation(material)) &
      modulus = max(0.0_wp, material%bulk - 2.0_wp*material%shear/3.0_wp)
    call row_sums(inverse_mass, stride, points, plane, hoop)
    both = 2.0_wp*plane + hoop + 2.0_wp*sqrt(2.0_wp*plane*hoop)
    single = 2.0_wp/sqrt((2.0_wp*material%shear*(plane + hoop) + modulus*both)/material%density)
    if (.not. (viscosity%quadratic > 0.0_wp .or. viscosity%linear > 0.0_wp)) return
    length = sqrt(abs(chunk%area))
    rate = length/abs(1.0_wp + chunk%stretch)*(viscosity%linear*material%sound_speed &
      + viscosity%quadratic*length*abs(chunk%trace))*both
    single = single/(1.0_wp + 0.5_wp*single*rate)
  end subroutine single_round_full_steps

  !> Largest row sums of H and T of the elements, over the volumes of the nodes. H is that of the
  !> patterns (s11 s22 s12 s13 s23 s33), of which the nodes have (-1, 0, 1), (0, -1, -1), (1, 0, 1)
  !> and (0, 1, -1); rows of T sum to the integral of N_a/r dA, but for what is held on the axis.
  pure subroutine row_sums(inverse_mass, stride, points, plane, hoop)
    integer, intent(in) :: stride
    real(wp), intent(in) :: inverse_mass(stride, *)
    type(round_point_t), intent(in) :: points(n_point)
    real(wp), intent(out), dimension(chunk_size) :: plane, hoop
    real(wp), dimension(chunk_size, 6) :: s
    real(wp), dimension(chunk_size, 4) :: t, is_off
    real(wp) :: v, h11, h22, h33, h44, h12, h13, h14, h23, h24, h34, w3, only
    integer :: i, k

    s = 0.0_wp
    t = 0.0_wp
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
      ! The third node of a triangle has the place of the fourth too, whose row and column go.
      only = merge(1.0_wp, 0.0_wp, inverse_mass(i, 4) <= 0.0_wp)
      t(i, 3) = t(i, 3) + only*t(i, 4)
      h33 = h33 + only*(2.0_wp*h34 + h44)
      h13 = h13 + only*h14
      h23 = h23 + only*h24
      h14 = (1.0_wp - only)*h14
      h24 = (1.0_wp - only)*h24
      h34 = (1.0_wp - only)*h34
      plane(i) = max(inverse_mass(i, 1)*(h11 + abs(h12) + abs(h13) + abs(h14)), &
        inverse_mass(i, 2)*(h22 + abs(h12) + abs(h23) + abs(h24)), &
        w3*(h33 + abs(h13) + abs(h23) + abs(h34)), &
        inverse_mass(i, 4)*(h44 + abs(h14) + abs(h24) + abs(h34)))
      hoop(i) = max(inverse_mass(i, 1)*t(i, 1), inverse_mass(i, 2)*t(i, 2), w3*t(i, 3), &
        inverse_mass(i, 4)*t(i, 4))
    end do
  end subroutine row_sums

  !> 1 at nodes off the axis, 0 on it.
  pure subroutine mark_off_axis(points, is_off)
    type(round_point_t), intent(in) :: points(n_point)
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
          is_off(i, a) = merge(0.0_wp, 1.0_wp, abs(near*own(i) + far*opposite(i) &
            + beside*(next(i) + last(i))) <= least)
        end do
      end associate
    end do
  end subroutine mark_off_axis

end module round_full_step_m
