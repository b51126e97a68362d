! SPDX-License-Identifier: MIT
!> Stable step of fully integrated round quads: a lower bound of 2/omega_max of the single element
!> with its row-sum masses in its present shape, u_r = 0 on the axis. With H the matrix of
!> |grad v|^2 and T that of (v_r/r)^2 over the masses, their largest row sums bound their
!> eigenvalues, and D:C:D <= 2G (|grad v|^2 + (v_r/r)^2) + lambda (div v + v_r/r)^2 gives
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
  public :: round_full_step

  !> Node patterns of d31, d42 and h.x.
  real(wp), parameter :: d31_of(4) = [-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], &
    d42_of(4) = [0.0_wp, -1.0_wp, 0.0_wp, 1.0_wp], h_of(4) = [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp]

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
    real(wp) :: modulus, plane, hoop, squared, step, rate, length
    integer :: i, k

    modulus = material%bulk
    if (.not. has_mean_dilatation(material)) &
      modulus = max(0.0_wp, material%bulk - 2.0_wp*material%shear/3.0_wp)
    limit = huge(1.0_wp)
    volume = huge(1.0_wp)
    do i = 1, chunk_size
      do k = 1, n_point
        volume = min(volume, 1.0_wp + points(k)%stretch(i), sign(1.0e3_wp, points(k)%radius(i)))
      end do
      call row_sums(i, inverse_mass(i, 1), inverse_mass(i, 2), inverse_mass(i, 3), &
        inverse_mass(i, 4), points, plane, hoop)
      squared = (2.0_wp*material%shear*(plane + hoop) + modulus*(sqrt(2.0_wp*plane) &
        + sqrt(hoop))**2)/material%density
      step = 2.0_wp/sqrt(squared)
      if (chunk%trace(i) < 0.0_wp) then
        length = sqrt(abs(chunk%area(i)))
        rate = length/(1.0_wp + chunk%stretch(i))*(viscosity%linear*material%sound_speed &
          - viscosity%quadratic*length*chunk%trace(i))*(sqrt(2.0_wp*plane) + sqrt(hoop))**2
        step = step/(1.0_wp + 0.5_wp*step*rate)
      end if
      limit = min(limit, step)
    end do
  end subroutine round_full_step

  !> Largest row sums of H and T of element `i`, over the volumes of the nodes.
  pure subroutine row_sums(i, w1, w2, w3, w4, points, plane, hoop)
    integer, intent(in) :: i
    real(wp), intent(in) :: w1, w2, w3, w4 !! density over mass
    type(round_point_t), intent(in) :: points(n_point)
    real(wp), intent(out) :: plane, hoop
    real(wp) :: h(4, 4), t(4, 4), p(4), q(4), n(4), w(4)
    integer :: b, k

    w = [w1, w2, w3, w4]
    h = 0.0_wp
    t = 0.0_wp
    do k = 1, n_point
      p = d31_of + shift(1, k)*h_of
      q = d42_of + shift(2, k)*h_of
      n = shape_at_points(:, k)
      associate (place => points(k))
        do b = 1, 4
          h(:, b) = h(:, b) + place%volume(i)*((place%c33(i)*p(b) + place%c34(i)*q(b))*p &
            + (place%c34(i)*p(b) + place%c44(i)*q(b))*q)
          t(:, b) = t(:, b) + place%volume(i)/place%radius(i)**2*n(b)*n
        end do
      end associate
    end do
    if (w4 <= 0.0_wp) then
      ! The third node of a triangle has the place of the fourth too.
      h(:, 3) = h(:, 3) + h(:, 4)
      t(:, 3) = t(:, 3) + t(:, 4)
      h(3, :) = h(3, :) + h(4, :)
      t(3, :) = t(3, :) + t(4, :)
      h(:, 4) = 0.0_wp
      t(:, 4) = 0.0_wp
    end if
    plane = maxval(w*sum(abs(h), 2))
    hoop = maxval(w*sum(t, 2))
  end subroutine row_sums

end module round_full_step_m
