! SPDX-License-Identifier: MIT
!> J2 plasticity with linear isotropic, kinematic or mixed hardening: elastic trial stress, then
!> radial return (seed (A4) to (A6)). With flow direction xi = s - alpha and its von Mises value
!> xi_v, d_eps = (xi_v - sigma_Y - beta E_p eps_p)/(3G + E_p), s -= 3G d_eps xi/xi_v, alpha +=
!> (1 - beta) E_p d_eps xi/xi_v: xi ends on the updated yield surface.
module material_j2_m
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use parts_m, only : material_t
  use stress_chunk_m, only : stress_chunk_t, rotate_deviator, stress_point_t, turn, turn_rate
  implicit none
  private
  public :: update_j2_isotropic, update_j2_mixed, tangent_of_return, trial_mises

  !> Round-off of a point on the yield surface, as a share of the yield stress.
  real(wp), parameter :: on_surface = 1.0e-9_wp

contains

  !> Update a chunk; isotropic hardening (beta = 1), no back stress.
  pure subroutine update_j2_isotropic(material, chunk, plastic_strain)
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(inout) :: chunk          !! increments in, deviator in and out,
                                                          !! work out
    real(wp), intent(inout) :: plastic_strain(chunk_size) !! effective plastic strain
    real(wp) :: third, exx, eyy, exy, sxx, syy, sxy, mises, growth, factor, double_shear, inverse, &
      work
    integer :: i

    double_shear = 2.0_wp*material%shear
    inverse = 1.0_wp/(3.0_wp*material%shear + material%hardening)
    !$omp simd private(third, exx, eyy, exy, sxx, syy, sxy, mises, growth, factor, work)
    do i = 1, chunk_size
      exx = chunk%dxx(i)
      eyy = chunk%dyy(i)
      exy = chunk%dxy(i)
      third = (1.0_wp/3.0_wp)*(exx + eyy)
      sxx = chunk%sxx(i)
      syy = chunk%syy(i)
      sxy = chunk%sxy(i)
      work = sxx*exx + syy*eyy + 2.0_wp*sxy*exy
      sxx = sxx + double_shear*(exx - third)
      syy = syy + double_shear*(eyy - third)
      sxy = sxy + double_shear*exy
      mises = sqrt(3.0_wp*(sxx*sxx + syy*syy + sxx*syy + sxy*sxy))
      growth = max(0.0_wp, mises - material%yield - material%hardening*plastic_strain(i))*inverse
      factor = 1.0_wp - 3.0_wp*material%shear*growth/max(mises, tiny(1.0_wp))
      chunk%sxx(i) = factor*sxx
      chunk%syy(i) = factor*syy
      chunk%sxy(i) = factor*sxy
      plastic_strain(i) = plastic_strain(i) + growth
      chunk%work(i) = 0.5_wp*(work + factor*(sxx*exx + syy*eyy + 2.0_wp*sxy*exy))
    end do
  end subroutine update_j2_isotropic

  !> Update a chunk; kinematic or mixed hardening (beta < 1).
  pure subroutine update_j2_mixed(material, chunk, plastic_strain, axx, ayy, axy)
    type(material_t), intent(in) :: material
    type(stress_chunk_t), intent(inout) :: chunk
    real(wp), intent(inout) :: plastic_strain(chunk_size)
    real(wp), intent(inout), dimension(chunk_size) :: axx, ayy, axy !! back stress, a deviator
    real(wp) :: third, exx, eyy, exy, sxx, syy, sxy, mises, growth, flow, inverse, work
    integer :: i

    call rotate_deviator(chunk%cos2, chunk%sin2, axx, ayy, axy)
    inverse = 1.0_wp/(3.0_wp*material%shear + material%hardening)
    !$omp simd private(third, exx, eyy, exy, sxx, syy, sxy, mises, growth, flow, work)
    do i = 1, chunk_size
      exx = chunk%dxx(i)
      eyy = chunk%dyy(i)
      exy = chunk%dxy(i)
      third = (1.0_wp/3.0_wp)*(exx + eyy)
      work = chunk%sxx(i)*exx + chunk%syy(i)*eyy + 2.0_wp*chunk%sxy(i)*exy
      sxx = chunk%sxx(i) + 2.0_wp*material%shear*(exx - third) - axx(i)
      syy = chunk%syy(i) + 2.0_wp*material%shear*(eyy - third) - ayy(i)
      sxy = chunk%sxy(i) + 2.0_wp*material%shear*exy - axy(i)
      mises = sqrt(3.0_wp*(sxx*sxx + syy*syy + sxx*syy + sxy*sxy))
      growth = max(0.0_wp, mises - material%yield &
        - material%beta*material%hardening*plastic_strain(i))*inverse
      flow = growth/max(mises, tiny(1.0_wp))
      chunk%sxx(i) = sxx*(1.0_wp - 3.0_wp*material%shear*flow) + axx(i)
      chunk%syy(i) = syy*(1.0_wp - 3.0_wp*material%shear*flow) + ayy(i)
      chunk%sxy(i) = sxy*(1.0_wp - 3.0_wp*material%shear*flow) + axy(i)
      flow = flow*(1.0_wp - material%beta)*material%hardening
      axx(i) = axx(i) + flow*sxx
      ayy(i) = ayy(i) + flow*syy
      axy(i) = axy(i) + flow*sxy
      plastic_strain(i) = plastic_strain(i) + growth
      chunk%work(i) = 0.5_wp*(work + chunk%sxx(i)*exx + chunk%syy(i)*eyy &
        + 2.0_wp*chunk%sxy(i)*exy)
    end do
  end subroutine update_j2_mixed

  !> Von Mises value of the trial flow direction xi* = Q s Q^T + 2G dev(e) - Q alpha Q^T.
  pure function trial_mises(shear, point) result(mises)
    real(wp), intent(in) :: shear
    type(stress_point_t), intent(in) :: point
    real(wp) :: mises
    real(wp) :: xi(3)

    xi = turn(point, point%old) + 2.0_wp*shear*[1.0_wp/3.0_wp, 1.0_wp, 1.0_wp]*point%strain &
      - turn(point, point%back)
    mises = sqrt(3.0_wp*(3.0_wp*xi(1)**2 + xi(2)**2 + xi(3)**2))
  end function trial_mises

  !> Radial return to a surface of `radius` R with slope `hardening`, at one point, with its
  !> derivative: xi* is scaled by f = 1 - 3G/(3G + E_p) (1 - R/xi_v), d(xi_v) = 3 (3 m, h,
  !> q).d(xi*)/xi_v. A point that flowed in the previous step lies on the surface and has the
  !> plastic tangent, whatever its last digits.
  pure subroutine tangent_of_return(shear, radius, hardening, point)
    real(wp), intent(in) :: shear
    real(wp), intent(in) :: radius    !! yield stress at the plastic strain at the start of the step
    real(wp), intent(in) :: hardening !! E_p
    type(stress_point_t), intent(inout) :: point !! `stress` and `tangent` out
    real(wp) :: turned(3), back(3), moduli(3), xi(3), ratio, mises, factor, slope, scaling(3, 3)
    integer :: i

    moduli = 2.0_wp*shear*[1.0_wp/3.0_wp, 1.0_wp, 1.0_wp]
    turned = turn(point, point%old)
    back = turn(point, point%back)
    xi = turned + moduli*point%strain - back
    mises = trial_mises(shear, point)
    factor = 1.0_wp
    scaling = 0.0_wp
    if (mises > (1.0_wp - on_surface)*radius) then
      ratio = 3.0_wp*shear/(3.0_wp*shear + hardening)
      factor = 1.0_wp - ratio*(1.0_wp - radius/mises)
      slope = -3.0_wp*ratio*radius/mises**3
      scaling(:, 1) = 3.0_wp*slope*xi(1)*xi
      scaling(:, 2) = slope*xi(2)*xi
      scaling(:, 3) = slope*xi(3)*xi
    end if
    do i = 1, 3
      scaling(i, i) = scaling(i, i) + factor
      point%tangent(:, i) = scaling(:, i)*moduli(i)
    end do
    point%stress = factor*xi + back
    point%tangent(:, 4) = matmul(scaling, turn_rate(turned - back)) + turn_rate(back)
  end subroutine tangent_of_return

end module material_j2_m
