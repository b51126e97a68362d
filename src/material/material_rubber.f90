! SPDX-License-Identifier: MIT
!> Stress, energy and stiffness of W = A (I - 3) + B (II - 3) + U(J) for one chunk, from F - 1.
!> With e = b - 1, b = F F^T, i = tr e, q = (i^2 - e:e)/2 and t = J^2 - 1 = i + q + det e:
!>   tau = (2A + 4B + J U') 1 + 2B i 1 + 2 (A + B) e + 2B (i e - e e)
!>   W   = U + (A + 2B) t - (A + B) q - (A + 2B) det e
!> so that no digit of a small strain is lost (doc/theory/materials.md, "Rubber").
module material_rubber_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : rubber_t
  use stress_chunk_m, only : stress_chunk_t
  use vector_functions_m, only : form_excesses, form_log_ratios
  implicit none
  private
  public :: update_mooney_rivlin, update_blatz_ko

  !> Terms of U at the J of each slot.
  type :: volumetric_t
    real(wp), dimension(chunk_size) :: excess    !! 2A + 4B + J U', 0 at J = 1
    real(wp), dimension(chunk_size) :: potential !! U + (A + 2B)(J^2 - 1), 0 at J = 1
    real(wp), dimension(chunk_size) :: second    !! J^2 U''
  end type volumetric_t

contains

  !> Mooney-Rivlin rubber: U = C (J^-4 - 1) + D (J^2 - 1)^2, C = A/2 + B.
  pure subroutine update_mooney_rivlin(rubber, chunk)
    type(rubber_t), intent(in) :: rubber
    type(stress_chunk_t), intent(inout) :: chunk
    type(volumetric_t) :: volumetric
    real(wp) :: t, inverse
    integer :: i

    !$omp simd private(t, inverse)
    do i = 1, chunk_size
      t = chunk%stretch(i)*(2.0_wp + chunk%stretch(i)) ! J^2 - 1
      inverse = 1.0_wp/(1.0_wp + t)**2                 ! J^-4
      volumetric%excess(i) = 4.0_wp*t*(rubber%c*(2.0_wp + t)*inverse + rubber%d*(1.0_wp + t))
      volumetric%potential(i) = t*t*(rubber%c*(3.0_wp + 2.0_wp*t)*inverse + rubber%d)
      volumetric%second(i) = 20.0_wp*rubber%c*inverse + 4.0_wp*rubber%d*(1.0_wp + t) &
        *(2.0_wp + 3.0_wp*t)
    end do
    call form_hyperelastic(rubber%a, rubber%b, volumetric, chunk)
  end subroutine update_mooney_rivlin

  !> Blatz-Ko rubber: B = 0, U = 2A (J^-m - 1)/m, m = 2 nu/(1 - 2 nu), 2A = G.
  pure subroutine update_blatz_ko(rubber, chunk)
    type(rubber_t), intent(in) :: rubber
    type(stress_chunk_t), intent(inout) :: chunk
    type(volumetric_t) :: volumetric
    real(wp), parameter :: least = -1.0_wp + 1.0e-12_wp !! the run ends before
    real(wp), dimension(chunk_size) :: safe, power, excess
    real(wp) :: shear, share
    integer :: i

    shear = 2.0_wp*rubber%a
    safe = max(chunk%stretch, least)
    call form_log_ratios(chunk_size, safe, power)
    power = -rubber%exponent*power ! ln(J^-m)
    call form_excesses(chunk_size, power, excess)
    !$omp simd private(share)
    do i = 1, chunk_size
      share = -excess(i)
      volumetric%excess(i) = shear*share
      volumetric%potential(i) = shear*(0.5_wp*chunk%stretch(i)*(2.0_wp + chunk%stretch(i)) &
        - share/rubber%exponent)
      volumetric%second(i) = shear*(rubber%exponent + 1.0_wp)*(1.0_wp - share)
    end do
    call form_hyperelastic(rubber%a, 0.0_wp, volumetric, chunk)
  end subroutine update_blatz_ko

  !> Deviator, mean stress, energy and moduli. Where the dilatation is that of an element with
  !> several points, the deviator uses the volume ratio `volume` of the point.
  pure subroutine form_hyperelastic(a, b, volumetric, chunk)
    real(wp), intent(in) :: a, b
    type(volumetric_t), intent(in) :: volumetric
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp) :: exx, eyy, ezz, exy, i1, q, det, txx, tyy, tzz, txy, mean, base
    integer :: i

    !$omp simd private(exx, eyy, ezz, exy, i1, q, det, txx, tyy, tzz, txy, mean, base)
    do i = 1, chunk_size
      exx = 2.0_wp*chunk%hxx(i) + (chunk%hxx(i)**2 + chunk%hxy(i)**2)
      eyy = 2.0_wp*chunk%hyy(i) + (chunk%hyy(i)**2 + chunk%hyx(i)**2)
      ezz = 2.0_wp*chunk%hzz(i) + chunk%hzz(i)**2
      exy = (chunk%hxy(i) + chunk%hyx(i)) + (chunk%hxx(i)*chunk%hyx(i) + chunk%hxy(i)*chunk%hyy(i))
      i1 = exx + eyy + ezz
      det = exx*eyy - exy*exy
      q = det + ezz*(exx + eyy)
      det = ezz*det
      base = volumetric%excess(i) + 2.0_wp*b*i1
      txx = base + 2.0_wp*((a + b)*exx + b*(i1*exx - (exx*exx + exy*exy)))
      tyy = base + 2.0_wp*((a + b)*eyy + b*(i1*eyy - (eyy*eyy + exy*exy)))
      tzz = base + 2.0_wp*((a + b)*ezz + b*(i1 - ezz)*ezz)
      txy = 2.0_wp*((a + b) + b*ezz)*exy
      mean = (txx + tyy + tzz)*(1.0_wp/3.0_wp)
      chunk%sxx(i) = (txx - mean)/chunk%volume(i)
      chunk%syy(i) = (tyy - mean)/chunk%volume(i)
      chunk%sxy(i) = txy/chunk%volume(i)
      chunk%mean(i) = mean/(1.0_wp + chunk%stretch(i))
      chunk%energy(i) = volumetric%potential(i) - (a + b)*q - (a + 2.0_wp*b)*det
      chunk%work(i) = 0.0_wp
    end do
    call bound_stiffness(a, b, volumetric, chunk)
  end subroutine form_hyperelastic

  !> Moduli G and K that bound every second derivative of W along F + s L F by 2G L:L + (K - 2G/3)
  !> (tr L)^2, per present volume. In principal axes of b it is a matrix H of the L_kk and a pair of
  !> L_12, L_21; the part of H beside lambda 1 1^T is bounded by its row sums.
  pure subroutine bound_stiffness(a, b, volumetric, chunk)
    real(wp), intent(in) :: a, b
    type(volumetric_t), intent(in) :: volumetric
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp) :: b1, b2, b3, g1, g2, g3, mean, root, slope, lame, pair, rows
    integer :: i

    !$omp simd private(b1, b2, b3, g1, g2, g3, mean, root, slope, lame, pair, rows)
    do i = 1, chunk_size
      b1 = (1.0_wp + chunk%hxx(i))**2 + chunk%hxy(i)**2
      b2 = (1.0_wp + chunk%hyy(i))**2 + chunk%hyx(i)**2
      b3 = (1.0_wp + chunk%hzz(i))**2
      mean = (1.0_wp + chunk%hxx(i))*chunk%hyx(i) + chunk%hxy(i)*(1.0_wp + chunk%hyy(i))
      root = sqrt((0.5_wp*(b1 - b2))**2 + mean*mean)
      mean = 0.5_wp*(b1 + b2)
      b1 = mean + root
      b2 = mean - root
      g1 = b2*b3
      g2 = b1*b3
      g3 = b1*b2
      mean = (g1 + g2 + g3)*(1.0_wp/3.0_wp)
      slope = volumetric%excess(i) - 2.0_wp*(a + 2.0_wp*b) ! J U'
      lame = volumetric%second(i) + slope + 4.0_wp*b*mean
      pair = 2.0_wp*(a + b*b3)
      root = pair*root
      pair = pair*(0.5_wp*(b1 + b2)) + sqrt(root*root + (slope + 2.0_wp*b*g3)**2)
      rows = max( &
        2.0_wp*a*b1 + 2.0_wp*b*((mean - g1) + 2.0_wp*(abs(g2 - mean) + abs(g3 - mean))), &
        2.0_wp*a*b2 + 2.0_wp*b*((mean - g2) + 2.0_wp*(abs(g1 - mean) + abs(g3 - mean))), &
        2.0_wp*a*b3 + 2.0_wp*b*((mean - g3) + 2.0_wp*(abs(g1 - mean) + abs(g2 - mean)))) - slope
      chunk%shear(i) = 0.5_wp*max(rows, pair)/(1.0_wp + chunk%stretch(i))
      chunk%bulk(i) = max(0.0_wp, lame)/(1.0_wp + chunk%stretch(i)) + 2.0_wp*chunk%shear(i)/3.0_wp
    end do
  end subroutine bound_stiffness

end module material_rubber_m
