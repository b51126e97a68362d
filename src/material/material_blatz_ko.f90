! SPDX-License-Identifier: MIT
!> Rubber of Blatz and Ko: B = 0, U = 2A (J^-m - 1)/m, m = 2 nu/(1 - 2 nu), 2A = G.
module material_blatz_ko_m
  use hyperelastic_m, only : volumetric_t, form_hyperelastic
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use rubbers_m, only : rubber_t
  use stress_chunk_m, only : stress_chunk_t
  use vector_functions_m, only : form_excesses, form_log_ratios
  implicit none
  private
  public :: update_blatz_ko

contains

  !> Stress, energy and stiffness of a chunk from its F.
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

end module material_blatz_ko_m
