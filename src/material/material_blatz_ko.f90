! SPDX-License-Identifier: MIT
!> Rubber of Blatz and Ko: B = 0, U = 2A (J^-m - 1)/m, m = 2 nu/(1 - 2 nu), 2A = G.
module material_blatz_ko_m
  use hyperelastic_m, only : volumetric_t, form_hyperelastic
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use rubbers_m, only : rubber_t
  use stress_chunk_m, only : stress_chunk_t
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
    real(wp) :: shear, s, x, share, half
    integer :: i

    shear = 2.0_wp*rubber%a
    do i = 1, chunk_size
      s = max(chunk%stretch(i), least)
      x = 2.0_wp*rubber%exponent*atanh(s/(2.0_wp + s)) ! m ln(J)
      ! 1 - J^-m keeps the digits of a small strain.
      half = tanh(0.5_wp*max(-1.0_wp, min(1.0_wp, x)))
      share = merge(2.0_wp*half/(1.0_wp + half), 1.0_wp - exp(-x), abs(x) < 1.0_wp)
      volumetric%excess(i) = shear*share
      volumetric%potential(i) = shear*(0.5_wp*chunk%stretch(i)*(2.0_wp + chunk%stretch(i)) &
        - share/rubber%exponent)
      volumetric%second(i) = shear*(rubber%exponent + 1.0_wp)*(1.0_wp - share)
    end do
    call form_hyperelastic(rubber%a, 0.0_wp, volumetric, chunk)
  end subroutine update_blatz_ko

end module material_blatz_ko_m
