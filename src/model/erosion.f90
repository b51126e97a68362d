! SPDX-License-Identifier: MIT
!> When an element of a material leaves the mesh. What no deck asks for is out of reach.
module erosion_m
  use kinds_m, only : wp
  implicit none
  private
  public :: erosion_t, asks_for_strain, asks_for_stress

  !> Criteria of a material: those of its law, of *CONTROL_TIMESTEP, and of *MAT_ADD_EROSION.
  type :: erosion_t
    logical :: by_law = .false.         !! goes once all of its points have failed
    logical :: by_step = .false.        !! goes where its step, or its volume, has vanished (ERODE)
    real(wp) :: least_step = 0.0_wp     !! DTMIN, s
    real(wp) :: most_pressure = huge(1.0_wp)       !! MXPRES
    real(wp) :: least_pressure = -huge(1.0_wp)     !! MNPRES
    real(wp) :: principal_stress = huge(1.0_wp)    !! SIGP1
    real(wp) :: mises = huge(1.0_wp)               !! SIGVM
    real(wp) :: most_strain = huge(1.0_wp)         !! MXEPS, logarithmic as all strains
    real(wp) :: least_strain = -huge(1.0_wp)       !! MNEPS
    real(wp) :: effective_strain = huge(1.0_wp)    !! EFFEPS
    real(wp) :: shear_strain = huge(1.0_wp)        !! EPSSH, half the difference of the outer ones
    real(wp) :: most_volume = huge(1.0_wp)         !! VOLEPS above 0: ln(V/V0)
    real(wp) :: least_volume = -huge(1.0_wp)       !! VOLEPS below 0
    real(wp) :: threshold = 0.0_wp                 !! SIGTH
    real(wp) :: impulse = huge(1.0_wp)             !! IMPULSE
    real(wp) :: time = huge(1.0_wp)                !! FAILTM
    integer :: n_given = 0                         !! criteria of the card that the deck gives
    integer :: n_criteria = 1                      !! NCS: how many must hold at once
    integer :: n_point = 1                         !! NUMFIP: at how many points
  end type erosion_t

contains

  !> Whether some criterion looks at strains.
  pure function asks_for_strain(erosion) result(asks)
    type(erosion_t), intent(in) :: erosion
    logical :: asks

    asks = min(erosion%most_strain, erosion%effective_strain, erosion%shear_strain, &
      -erosion%least_strain) < huge(1.0_wp)
  end function asks_for_strain

  !> Whether some criterion looks at stresses of points.
  pure function asks_for_stress(erosion) result(asks)
    type(erosion_t), intent(in) :: erosion
    logical :: asks

    asks = min(erosion%principal_stress, erosion%mises, erosion%impulse) < huge(1.0_wp)
  end function asks_for_stress

end module erosion_m
