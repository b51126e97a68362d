! SPDX-License-Identifier: MIT
!> Rubber of Mooney and Rivlin: U = C (J^-4 - 1) + D (J^2 - 1)^2, C = A/2 + B.
module material_mooney_rivlin_m
  use hyperelastic_m, only : volumetric_t, form_hyperelastic
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  use rubbers_m, only : rubber_t
  use stress_chunk_m, only : stress_chunk_t
  implicit none
  private
  public :: update_mooney_rivlin

contains

  !> Stress, energy and stiffness of a chunk from its F.
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

end module material_mooney_rivlin_m
