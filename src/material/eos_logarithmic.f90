! SPDX-License-Identifier: MIT
!> p = -K ln(v), without energy: the pressure of laws that have no equation of state.
module eos_logarithmic_m
  use eos_chunk_m, only : eos_chunk_t
  use kinds_m, only : wp
  use layout_m, only : chunk_size
  implicit none
  private
  public :: form_logarithmic

contains

  !> At v = 1 + stretch.
  pure subroutine form_logarithmic(stiffness, stretch, state)
    real(wp), intent(in) :: stiffness           !! K
    real(wp), intent(in) :: stretch(chunk_size) !! v - 1
    type(eos_chunk_t), intent(inout) :: state
    real(wp) :: z
    integer :: i

    do i = 1, chunk_size
      z = stretch(i)/(2.0_wp + stretch(i))
      ! ln(1 + s) = 2 atanh(s/(2 + s)) keeps the digits of a small strain.
      if (stretch(i) > -1.0_wp) then
        state%a(i) = -2.0_wp*stiffness*atanh(z)
      else
        state%a(i) = stiffness*huge(1.0_wp)**0.25_wp
      end if
      state%a_slope(i) = stiffness*(1.0_wp + stretch(i))
      state%b(i) = 0.0_wp
      state%b_slope(i) = 0.0_wp
    end do
  end subroutine form_logarithmic

end module eos_logarithmic_m
