! SPDX-License-Identifier: MIT
!> Rubber of Ogden for one chunk, from F - 1: W = sum_p mu_p/alpha_p (sum_i l_i^alpha_p - 3)
!> + K (J - 1 - ln J), l_i the principal stretches over J^(1/3). Principal Kirchhoff stresses
!> T_i = sum_p mu_p (l_i^alpha_p - mean over i) + K (J - 1), in the axes of b = F F^T.
module material_ogden_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : rubber_t
  use stress_chunk_m, only : stress_chunk_t
  use vector_functions_m, only : form_excesses, form_log_ratios
  implicit none
  private
  public :: update_ogden

contains

  !> Deviator, mean stress, energy and moduli.
  pure subroutine update_ogden(rubber, chunk)
    type(rubber_t), intent(in) :: rubber
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp), parameter :: least = -1.0_wp + 1.0e-12_wp !! the run ends before
    real(wp), dimension(chunk_size) :: cosine, sine, root, log_volume, safe, energy, x
    real(wp), dimension(chunk_size, 3) :: strain, stress, slope !! principal: b - 1, T, sum mu alpha
                                                                !! l_i^alpha
    real(wp) :: excess(chunk_size, 3), exx, eyy, exy, half, mean
    integer :: i, k, p

    !$omp simd private(exx, eyy, exy, half)
    do i = 1, chunk_size
      exx = 2.0_wp*chunk%hxx(i) + (chunk%hxx(i)**2 + chunk%hxy(i)**2)
      eyy = 2.0_wp*chunk%hyy(i) + (chunk%hyy(i)**2 + chunk%hyx(i)**2)
      exy = (chunk%hxy(i) + chunk%hyx(i)) + (chunk%hxx(i)*chunk%hyx(i) + chunk%hxy(i)*chunk%hyy(i))
      half = 0.5_wp*(exx - eyy)
      root(i) = sqrt(half*half + exy*exy)
      cosine(i) = half/max(root(i), tiny(1.0_wp))
      sine(i) = exy/max(root(i), tiny(1.0_wp))
      strain(i, 1) = max(0.5_wp*(exx + eyy) + root(i), least)
      strain(i, 2) = max(0.5_wp*(exx + eyy) - root(i), least)
      strain(i, 3) = max(2.0_wp*chunk%hzz(i) + chunk%hzz(i)**2, least)
      safe(i) = max(chunk%stretch(i), least)
    end do
    call form_log_ratios(chunk_size, safe, log_volume)
    stress = 0.0_wp
    slope = 0.0_wp
    energy = rubber%bulk*(chunk%stretch - log_volume)
    do p = 1, rubber%n_term
      do k = 1, 3
        call form_log_ratios(chunk_size, strain(:, k), x)
        x = rubber%alpha(p)*(0.5_wp*x - log_volume/3.0_wp)
        call form_excesses(chunk_size, x, excess(:, k))
        energy = energy + rubber%mu(p)/rubber%alpha(p)*excess(:, k)
        slope(:, k) = slope(:, k) + rubber%mu(p)*rubber%alpha(p)*(1.0_wp + excess(:, k))
      end do
      do i = 1, chunk_size
        mean = (excess(i, 1) + excess(i, 2) + excess(i, 3))*(1.0_wp/3.0_wp)
        stress(i, :) = stress(i, :) + rubber%mu(p)*(excess(i, :) - mean)
      end do
    end do
    do i = 1, chunk_size
      mean = 0.5_wp*(stress(i, 1) + stress(i, 2))
      half = 0.5_wp*(stress(i, 1) - stress(i, 2))
      chunk%sxx(i) = (mean + half*cosine(i))/chunk%volume(i)
      chunk%syy(i) = (mean - half*cosine(i))/chunk%volume(i)
      chunk%sxy(i) = half*sine(i)/chunk%volume(i)
      chunk%mean(i) = rubber%bulk*chunk%stretch(i)/(1.0_wp + chunk%stretch(i))
      chunk%energy(i) = energy(i)
      chunk%work(i) = 0.0_wp
    end do
    call bound_moduli(rubber%bulk, strain, root, stress, slope, chunk)
  end subroutine update_ogden

  !> Moduli G and K that bound every second derivative of W along F + s L F by 2G L:L + (K - 2G/3)
  !> (tr L)^2, per present volume: row sums of the matrix H of the L_kk beside K J 1 1^T, and the
  !> pair L_12, L_21 with b_1 B and b_2 B on its diagonal, b_1 B - T_1 beside it, B = (T_1 - T_2)/
  !> (b_1 - b_2) (Ogden 1984, section 6.1).
  pure subroutine bound_moduli(bulk, strain, root, stress, slope, chunk)
    real(wp), intent(in) :: bulk, strain(chunk_size, 3), root(chunk_size), stress(chunk_size, 3), &
      slope(chunk_size, 3)
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp) :: h(3, 3), a(3), t(3), ratio, pair, volumetric
    integer :: i, k

    do i = 1, chunk_size
      volumetric = bulk*chunk%stretch(i)
      a = slope(i, :)
      t = stress(i, :) + volumetric
      do k = 1, 3
        h(:, k) = sum(a)/9.0_wp - (a + a(k))/3.0_wp
        h(k, k) = h(k, k) + a(k) - t(k)
      end do
      ! At equal stretches B is dT_1/db_1.
      ratio = 0.25_wp*(a(1) + a(2))/(1.0_wp + 0.5_wp*(strain(i, 1) + strain(i, 2)))
      if (root(i) > 1.0e-6_wp) ratio = 0.5_wp*(t(1) - t(2))/root(i)
      pair = ratio*(1.0_wp + 0.5_wp*(strain(i, 1) + strain(i, 2))) &
        + sqrt((ratio*root(i))**2 + (ratio*(1.0_wp + strain(i, 1)) - t(1))**2)
      chunk%shear(i) = 0.5_wp*max(maxval(sum(abs(h), dim=1)), pair)/(1.0_wp + chunk%stretch(i))
      chunk%bulk(i) = bulk + 2.0_wp*chunk%shear(i)/3.0_wp
    end do
  end subroutine bound_moduli

end module material_ogden_m
